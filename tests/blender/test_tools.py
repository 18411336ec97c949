"""Operators: what they make, that scripts can call them, and what they say where they cannot."""

import struct

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender("wheel")


def points_of(data):
    values = np.empty(len(data.points) * 3, np.float32)
    data.position_data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def values_of(data, name):
    attribute = data.attributes[name]
    return np.array([item.value for item in attribute.data])


@pytest.mark.parametrize("kind", ["swatch", "tube"])
def test_knitted_pieces_are_added(lisle, kind):
    import bpy

    add, make = getattr(bpy.ops.lisle, f"add_knit_{kind}"), getattr(lisle, f"knit_{kind}")
    assert add(pattern="rib-1-1", courses=6, wales=12, yarn_radius=0.002, location=(1, 2, 3)) == {"FINISHED"}
    obj = bpy.context.active_object
    yarns = make("rib-1-1", 6, 12, 0.002)
    # Properties are in single precision.
    np.testing.assert_allclose(points_of(obj.data), yarns.points, atol=1e-8)
    np.testing.assert_allclose(values_of(obj.data, "radius"), yarns.radii, rtol=1e-6)
    assert len(obj.data.curves) == 6 and tuple(obj.location) == (1, 2, 3) and obj.type == "CURVES"
    if kind == "tube":
        assert values_of(obj.data, "cyclic").all()


def test_a_chart_and_a_material_of_ones_own(lisle):
    import bpy

    bpy.ops.lisle.add_knit_swatch(pattern="CHART", chart="kp pk", courses=4, wales=4, yarn="silk-1", fiber="fleece")
    obj = bpy.context.active_object
    np.testing.assert_allclose(points_of(obj.data), lisle.knit_swatch("kp pk", 4, 4).points, atol=1e-8)
    settings = obj.data.materials[0].lisle
    assert (settings.yarn.preset, settings.fiber.preset) == ("silk-1", "fleece")


def test_a_woven_piece_is_added(lisle):
    import bpy

    bpy.ops.lisle.add_woven_swatch(
        weave="twill-3-1", warp=9, weft=7, yarn_radius=0.002, spacing=2, use_weft_fiber=True, weft_fiber="rayon-3"
    )
    data = bpy.context.active_object.data
    np.testing.assert_allclose(points_of(data), lisle.woven_swatch("twill-3-1", 9, 7, 0.002, 2.0).points, atol=1e-8)
    assert values_of(data, "material_index").tolist() == [0] * 9 + [1] * 7
    assert [material.lisle.fiber.preset for material in data.materials] == ["cotton-1", "rayon-3"]
    bpy.ops.lisle.add_woven_swatch(weave="CHART", chart="ox xo", warp=3, weft=3)
    data = bpy.context.active_object.data
    assert len(data.materials) == 1 and "material_index" not in data.attributes
    np.testing.assert_allclose(points_of(data), lisle.woven_swatch("plain", 3, 3).points, atol=1e-8)
    with pytest.raises(RuntimeError, match="nothing holds it"):
        bpy.ops.lisle.add_woven_swatch(weave="CHART", chart="xx xo")


def test_a_chart_with_other_letters_is_refused(lisle):
    import bpy

    before = len(bpy.data.objects)
    with pytest.raises(RuntimeError, match="pattern"):
        bpy.ops.lisle.add_knit_swatch(pattern="CHART", chart="kx")
    assert len(bpy.data.objects) == before and not bpy.data.hair_curves


def test_objects_are_added_in_object_mode_alone(lisle, tmp_path):
    import bpy

    bpy.ops.mesh.primitive_grid_add()
    bpy.ops.object.mode_set(mode="EDIT")
    before = len(bpy.data.hair_curves)
    for add, arguments in (
        (bpy.ops.lisle.add_knit_swatch, {}),
        (bpy.ops.lisle.add_knit_tube, {}),
        (bpy.ops.lisle.add_woven_swatch, {}),
        (bpy.ops.lisle.import_bcc, {"filepath": str(tmp_path / "a.bcc")}),
        (bpy.ops.lisle.knit_from_mesh, {}),
        (bpy.ops.lisle.fibers_to_curves, {}),
    ):
        with pytest.raises(RuntimeError, match="poll"):
            add(**arguments)
    assert len(bpy.data.hair_curves) == before


OPERATORS = {
    "add_knit_swatch": {"courses": 2, "wales": 2},
    "add_knit_tube": {"courses": 2, "wales": 8},
    "add_woven_swatch": {"warp": 3, "weft": 3},
    "import_bcc": {"filepath": "a.bcc"},
    "knit_from_mesh": {"yarn_radius": 0.1},
    "store_length_coordinate": {},
    "fibers_to_curves": {},
    "toggle_overlay": {},
}
"""By name: arguments."""


def state():
    """What operators change, by name."""
    import bpy

    return (
        sorted((obj.name, obj.hide_render, obj.select_get()) for obj in bpy.context.scene.objects),
        sorted((data.name, len(data.points), sorted(data.attributes.keys())) for data in bpy.data.hair_curves),
        sorted(bpy.data.materials.keys()),
        sorted(bpy.data.collections.keys()),
        bpy.context.scene.lisle.show_overlay,
    )


@pytest.mark.parametrize("name", OPERATORS)
def test_everything_can_be_undone_and_done_again(lisle, tmp_path, name):
    """From a script, in the background: what its redo panel does."""
    import bpy

    (tmp_path / "a.bcc").write_bytes(bcc((np.linspace((0, 0, 0), (5, 0, 0), 6), False)))
    scenes.curves("Yarn", scenes.line()).select_set(True)
    if name == "knit_from_mesh":
        bpy.ops.mesh.primitive_grid_add()
    bpy.ops.ed.undo_push(message="before")
    before = state()
    arguments = OPERATORS[name] | ({"filepath": str(tmp_path / "a.bcc")} if name == "import_bcc" else {})
    operator = getattr(bpy.ops.lisle, name)
    assert operator("EXEC_DEFAULT", True, **arguments) == {"FINISHED"}
    after = state()
    assert after != before
    bpy.ops.ed.undo()
    assert state() == before
    bpy.ops.ed.redo()
    assert state() == after


def test_every_operator_is_known_here_and_has_a_redo_panel(addon):
    import bpy

    found = {name for name in dir(bpy.ops.lisle) if not name.endswith("_preset_add")}
    assert found == set(OPERATORS)
    for name in found:
        operator = getattr(bpy.types, f"LISLE_OT_{name}")
        assert {"REGISTER", "UNDO"} <= operator.bl_options, name
        assert operator.__doc__ and all(
            each.description for each in operator.bl_rna.properties if each.identifier in operator.__annotations__
        ), name


def test_a_knitted_piece_renders(lisle, tmp_path):
    import bpy

    bpy.ops.lisle.add_knit_swatch(courses=6, wales=8, yarn_radius=0.1, rotation=(-1.5708, 0, 0))
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy = 3
    bpy.context.scene.lisle.samples = 1
    picture = scenes.render_rgba(tmp_path / "a.exr")
    assert picture[20:28, 24:40, 3].mean() > 0.5 and picture[20:28, 24:40, :3].mean() > 0.05


def bcc(*curves, kind=b"C0"):
    """A BCC file of curves: (points, closed)."""
    total = sum(len(points) for points, _ in curves)
    header = b"BCC\x44" + kind + bytes([3, 2]) + struct.pack("<QQ", len(curves), total) + b"\0" * 40
    parts = [header]
    for points, closed in curves:
        parts.append(struct.pack("<i", -len(points) if closed else len(points)))
        parts.append(np.asarray(points, "<f4").tobytes())
    return b"".join(parts)


def test_bcc_files_are_imported(lisle, tmp_path):
    import bpy

    straight = np.linspace((0, 0, 0), (5, 0, 0), 6)
    ring = [(np.cos(angle), np.sin(angle), 1) for angle in np.arange(8) * np.pi / 4]
    (tmp_path / "a.bcc").write_bytes(bcc((straight, False), (ring, True)))
    assert bpy.ops.lisle.import_bcc(filepath=str(tmp_path / "a.bcc"), scale=0.1, yarn_radius=0.02) == {"FINISHED"}
    data = bpy.context.active_object.data
    assert [curve.points_length for curve in data.curves] == [6, 8]
    np.testing.assert_allclose(points_of(data), 0.1 * np.concatenate((straight, ring)), atol=1e-6)
    np.testing.assert_allclose(values_of(data, "radius"), 0.02, rtol=1e-6)
    assert values_of(data, "cyclic").tolist() == [False, True]


def test_b_splines_become_blenders_own(lisle, tmp_path):
    import bpy

    points = [(-3, 0, 0), (-1, 2, 0), (0, -2, 0), (1, 2, 0), (3, 0, 0)]
    (tmp_path / "a.bcc").write_bytes(bcc((points, False), kind=b"BS"))
    bpy.ops.lisle.import_bcc(filepath=str(tmp_path / "a.bcc"), scale=1, yarn_radius=0.2)
    obj = bpy.context.active_object
    assert values_of(obj.data, "curve_type").tolist() == [3] and values_of(obj.data, "nurbs_order").tolist() == [4]
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy = 3
    alpha = scenes.render_rgba(tmp_path / "a.exr")[..., 3]
    # Half-way from the second to the third point it is at (p0 + 23 p1 + 23 p2 + p3) / 48, and never at the second,
    # in the test camera of 8 by 6 metres and 64 by 48 pixels.
    assert alpha[23, 27] > 0.9 and alpha[24 - 16, 32 - 8] == 0


def test_several_files_at_once_and_a_broken_one(lisle, tmp_path):
    import bpy

    (tmp_path / "a.bcc").write_bytes(bcc((np.linspace((0, 0, 0), (5, 0, 0), 6), False)))
    (tmp_path / "b.bcc").write_bytes((tmp_path / "a.bcc").read_bytes())
    (tmp_path / "c.bcc").write_bytes(b"BCC")
    names = [{"name": f"{name}.bcc"} for name in "ab"]
    bpy.ops.lisle.import_bcc(directory=str(tmp_path), files=names, yarn_radius=0.01)
    assert {"a", "b"} <= {obj.name for obj in bpy.data.objects}
    with pytest.raises(RuntimeError, match=r"c\.bcc"):
        bpy.ops.lisle.import_bcc(filepath=str(tmp_path / "c.bcc"))
    assert "c" not in bpy.data.objects


def stretched(factor_by_frame):
    """A yarn that its object's modifier stretches, not its data."""
    import bpy

    obj = scenes.curves("Yarn", scenes.line(10))
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    with_nodes = scenes.Nodes(obj)
    scale = with_nodes.new("Transform", Geometry=with_nodes.input)
    with_nodes.finish(scale.outputs[0])
    for frame, factor in factor_by_frame.items():
        scale.inputs["Scale"].default_value = (factor, 1, 1)
        scale.inputs["Scale"].keyframe_insert("default_value", frame=frame)
    return obj


def test_lengths_are_stored_at_the_frame_that_is_asked_for(lisle):
    import bpy

    obj = stretched({1: 1.0, 5: 3.0})
    bpy.context.scene.frame_set(3)
    assert bpy.ops.lisle.store_length_coordinate(use_current=False, frame=5) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 3
    np.testing.assert_allclose(values_of(obj.data, "length_coordinate"), np.linspace(0, 18, 10), rtol=1e-4)
    bpy.ops.lisle.store_length_coordinate(use_current=False, frame=1)
    np.testing.assert_allclose(values_of(obj.data, "length_coordinate"), np.linspace(0, 6, 10), rtol=1e-4)


def test_lengths_of_other_points_are_refused(lisle):
    import bpy

    obj = scenes.curves("Yarn", scenes.line(10))
    obj.select_set(True)
    nodes = scenes.Nodes(obj)
    nodes.finish(nodes.new("ResampleCurve", Curve=nodes.input).outputs[0])
    nodes.tree.nodes["Resample Curve"].inputs["Count"].default_value = 7
    with pytest.raises(RuntimeError, match="object 'Yarn': its modifiers make 7 points of 10"):
        bpy.ops.lisle.store_length_coordinate()
    assert "length_coordinate" not in obj.data.attributes


def test_nothing_selected_is_said(lisle):
    import bpy

    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.lisle.store_length_coordinate()


def select(obj):
    import bpy

    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj


def test_fibers_become_curves_where_they_are_drawn(lisle, tmp_path):
    """What another engine makes of them covers the same pixels."""
    import bpy

    obj = select(scenes.curves("Yarn", scenes.line(30), radius=0.5))
    obj.location, obj.rotation_euler = (0.5, -0.5, 0), (0, 0, 0.4)
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy = 3
    scene = bpy.context.scene
    scene.lisle.samples, scene.lisle.lod = 64, 0
    ours = scenes.render_rgba(tmp_path / "a.exr")[..., 3]
    assert bpy.ops.lisle.fibers_to_curves(for_camera=False) == {"FINISHED"}
    fibers = bpy.data.objects["Yarn Fibers"]
    expected = lisle.Yarn.preset("cotton-1")
    assert len(fibers.data.curves) >= expected.plies * expected.fibers_per_ply
    assert bpy.context.selected_objects == [fibers]
    obj.hide_render = True
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.max_bounces = 32, False, 0
    theirs = scenes.render_rgba(tmp_path / "b.exr")[..., 3]
    assert np.abs(ours - theirs).mean() < 0.01 and (ours > 0.5).mean() > 0.05
    assert np.abs(ours - theirs[:, ::-1]).mean() > 0.03


def test_a_camera_asks_for_fewer_fibers(lisle):
    import bpy

    obj = select(scenes.curves("Yarn", scenes.line(30), radius=0.05))
    bpy.ops.lisle.fibers_to_curves(for_camera=True)
    few = len(bpy.data.objects["Yarn Fibers"].data.points)
    bpy.data.objects["Yarn Fibers"].select_set(False)
    select(obj)
    bpy.ops.lisle.fibers_to_curves(for_camera=False)
    assert few < 0.2 * len(bpy.context.selected_objects[0].data.points)


def test_fibers_of_warp_and_weft_have_their_own_materials(lisle):
    import bpy

    bpy.ops.lisle.add_woven_swatch(
        warp=3, weft=2, yarn="silk-1", fiber="cotton-1", use_weft_fiber=True, weft_fiber="rayon-3"
    )
    bpy.context.active_object.data.materials[1].lisle.yarn.preset = "rayon-1"
    bpy.ops.lisle.fibers_to_curves(for_camera=False)
    made = sorted(bpy.context.selected_objects, key=lambda obj: obj.name)
    colors, counts = [], []
    for obj in made:
        (material,) = obj.data.materials
        hair = material.node_tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
        colors.append(tuple(hair.inputs["Color"].default_value)[:3])
        counts.append(len(obj.data.curves))
    expected = [lisle.Material.preset(name).color_tt for name in ("cotton-1", "rayon-3")]
    np.testing.assert_allclose(colors, expected, rtol=1e-6)
    yarns = lisle.woven_swatch("plain", 3, 2, 0.001, 1.01)
    for count, number, name in zip(counts, (3, 2), ("silk-1", "rayon-1"), strict=True):
        yarn = lisle.Yarn.preset(name)
        assert count >= number * yarn.plies * yarn.fibers_per_ply
    assert len(yarns) == 5


def test_fibers_that_cannot_be_made_are_said(lisle):
    import bpy

    obj = select(scenes.curves("Yarn", scenes.line()))
    obj.data.materials.append(bpy.data.materials.new("Wool"))
    obj.data.materials[0].lisle.yarn.customize = True
    obj.data.materials[0].lisle.yarn.ply_twist = 0
    with pytest.raises(RuntimeError, match="object 'Yarn': material 'Wool': ") as raised:
        bpy.ops.lisle.fibers_to_curves()
    assert "Traceback" not in str(raised.value)


def test_fibers_of_nothing_and_too_many_are_refused(lisle):
    import bpy

    select(scenes.empty_mesh("Mesh"))
    with pytest.raises(RuntimeError, match="None of the selected objects has curves"):
        bpy.ops.lisle.fibers_to_curves()
    select(scenes.curves("Yarn", *[scenes.line(400, (-3, y, 0), (3, y, 0)) for y in range(20)], radius=0.01))
    with pytest.raises(RuntimeError, match="More than 1 million points"):
        bpy.ops.lisle.fibers_to_curves(for_camera=False, most_points=1)
    assert "Fibers" not in bpy.data.collections
