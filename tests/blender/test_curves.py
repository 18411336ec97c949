"""Curves of every kind, as they reach the native module."""

import math

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender

CATMULL_ROM, POLY, BEZIER, NURBS = range(4)
POINTS = np.array([(-2, 0, 0), (-1, 1, 0), (0, 0, 1), (1, 1, 0), (2, 0, 0)], np.float32)


@pytest.fixture
def entries(lisle):
    """Renders, and returns what was given to the native scene."""

    def render():
        import bpy

        bpy.ops.render.render()
        return lisle.scenes[-1][0].entries

    return render


def bezier_polygon(points, closed):
    """Control polygon of `scenes.add_spline('BEZIER')`, point by point."""
    polygon = []
    for x, y, z in points:
        polygon += [(x - 0.1, y, z + 1), (x, y, z), (x + 0.1, y, z - 1)]
    return polygon[1:] + polygon[:1] if closed else polygon[1:-1]


def test_curves_object(entries):
    obj = scenes.curves("Yarn", POINTS, POINTS[:3] + 5, radius=0.25)
    obj.location.x = 3
    (entry,) = entries()
    np.testing.assert_array_equal(entry.yarns.points, np.concatenate((POINTS, POINTS[:3] + 5)))
    assert entry.yarns.offsets.tolist() == [0, 5, 8] and entry.yarns.offsets.dtype == np.uint32
    assert entry.yarns.basis.tolist() == [CATMULL_ROM] * 2 and not entry.yarns.closed.any()
    assert np.all(entry.yarns.radii == 0.25)
    assert entry.transform[0, 3] == 3 and entry.name == "Yarn"


def test_curves_without_radius_get_blenders_default(entries):
    scenes.curves("Yarn", POINTS, radius=None)
    (entry,) = entries()
    np.testing.assert_allclose(entry.yarns.radii, 0.01)


def test_cyclic_and_type_attributes(entries):
    data = scenes.curves("Yarn", POINTS, POINTS).data
    for name, kind, values in (("cyclic", "BOOLEAN", [False, True]), ("curve_type", "INT8", [1, 0])):
        attribute = data.attributes.get(name) or data.attributes.new(name, kind, "CURVE")
        attribute.data.foreach_set("value", values)
    (entry,) = entries()
    assert entry.yarns.closed.tolist() == [False, True] and entry.yarns.basis.tolist() == [POLY, CATMULL_ROM]


@pytest.mark.parametrize("bevel", [0.0, 0.125])
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("kind", ["POLY", "BEZIER", "NURBS"])
def test_legacy_curve(entries, kind, closed, bevel):
    obj = scenes.legacy("Yarn", kind, POINTS.tolist(), closed, bevel_depth=bevel)
    spline = obj.data.splines[0]
    points = spline.bezier_points if kind == "BEZIER" else spline.points
    for index, point in enumerate(points):
        point.radius = 1 + index
    if kind == "NURBS":
        spline.order_u = 3
        spline.use_endpoint_u = not closed
        spline.points[2].co[3] = 5
    (entry,) = entries()
    yarns = entry.yarns
    radii = np.arange(1, 6) * (bevel or 0.01)
    assert yarns.closed.tolist() == [closed]
    if kind == "BEZIER":
        np.testing.assert_allclose(yarns.points, bezier_polygon(POINTS, closed), atol=1e-6)
        np.testing.assert_allclose(yarns.radii[::3], radii, rtol=1e-6)
        np.testing.assert_allclose(yarns.radii[1], radii[0] + (radii[1] - radii[0]) / 3, rtol=1e-6)
        assert yarns.basis.tolist() == [BEZIER]
    else:
        np.testing.assert_array_equal(yarns.points, POINTS)
        np.testing.assert_allclose(yarns.radii, radii, rtol=1e-6)
        assert yarns.basis.tolist() == [{"POLY": POLY, "NURBS": NURBS}[kind]]
    if kind == "NURBS":
        assert yarns.nurbs_order.tolist() == [3] and yarns.nurbs_knots_mode.tolist() == [0 if closed else 1]
        np.testing.assert_array_equal(yarns.nurbs_weights, [1, 1, 5, 1, 1])
    else:
        assert yarns.nurbs_order is None


@pytest.mark.parametrize("bevel", [0.0, 0.1])
def test_legacy_splines_of_three_kinds_in_one_object(entries, bevel):
    obj = scenes.legacy("Yarn", "BEZIER", POINTS.tolist(), bevel_depth=bevel)
    scenes.add_spline(obj.data, "POLY", POINTS[:2].tolist())
    nurbs = scenes.add_spline(obj.data, "NURBS", POINTS.tolist())
    nurbs.use_bezier_u = nurbs.use_endpoint_u = True
    (entry,) = entries()
    assert entry.yarns.offsets.tolist() == [0, 13, 15, 20]
    assert entry.yarns.basis.tolist() == [BEZIER, POLY, NURBS]
    assert entry.yarns.nurbs_knots_mode.tolist()[2] == 3


def test_yarn_radius_of_the_object(entries):
    scenes.curves("New", POINTS).lisle.yarn_radius = 0.5
    obj = scenes.legacy("Old", "POLY", POINTS.tolist(), bevel_depth=0.1)
    obj.data.splines[0].points[1].radius = 2
    obj.lisle.yarn_radius = 0.5
    new, old = entries()
    np.testing.assert_array_equal(new.yarns.radii, np.full(5, 0.5))
    np.testing.assert_array_equal(old.yarns.radii, [0.5, 1, 0.5, 0.5, 0.5])


def lattice(obj, on_spline):
    """A lattice that scales by 2 and lifts by 3."""
    import bpy

    data = bpy.data.lattices.new("Lattice")
    for axis in "uvw":
        setattr(data, f"interpolation_type_{axis}", "KEY_LINEAR")
    for point in data.points:
        point.co_deform = [2 * c for c in point.co_deform[:2]] + [2 * point.co_deform[2] + 3]
    modifier = obj.modifiers.new("Lattice", "LATTICE")
    modifier.object = scenes.link(bpy.data.objects.new("Lattice", data))
    modifier.use_apply_on_spline = on_spline
    return np.array([(2 * x, 2 * y, 2 * z + 3) for x, y, z in POINTS * 0.1], np.float32)


@pytest.mark.parametrize("bevel", [0.0, 0.1])
def test_lattice_on_splines(entries, bevel):
    obj = scenes.legacy("Yarn", "POLY", (POINTS * 0.1).tolist(), bevel_depth=bevel)
    expected = lattice(obj, True)
    (entry,) = entries()
    np.testing.assert_allclose(entry.yarns.points, expected, atol=1e-5)


@pytest.mark.parametrize("closed", [False, True])
def test_lattice_on_the_wire_of_an_unbevelled_curve(entries, closed):
    obj = scenes.legacy("Yarn", "POLY", (POINTS * 0.1).tolist(), closed)
    obj.data.splines[0].points[3].radius = 4
    expected = lattice(obj, False)
    (entry,) = entries()
    np.testing.assert_allclose(entry.yarns.points, expected, atol=1e-5)
    assert entry.yarns.closed.tolist() == [closed] and entry.yarns.basis.tolist() == [POLY]
    np.testing.assert_allclose(entry.yarns.radii, [0.01, 0.01, 0.01, 0.04, 0.01])


def test_lattice_on_a_tube_is_refused_with_advice(entries):
    obj = scenes.legacy("Yarn", "POLY", POINTS.tolist(), bevel_depth=0.1)
    lattice(obj, False)
    with pytest.raises(RuntimeError, match=r"'Yarn': its modifier 'Lattice'.*Apply on Spline"):
        entries()
    obj.modifiers["Lattice"].show_render = False
    assert len(entries()) == 1


@pytest.mark.parametrize("bevel", [0.0, 0.1])
@pytest.mark.parametrize("kind", ["POLY", "BEZIER"])
def test_shape_key(entries, kind, bevel):
    obj = scenes.legacy("Yarn", kind, POINTS.tolist(), bevel_depth=bevel)
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Lift")
    for point in key.data:
        point.co[2] += 2
        if kind == "BEZIER":
            point.handle_left[2] += 2
            point.handle_right[2] += 2
    key.value = 0.5
    (entry,) = entries()
    expected = POINTS if kind == "POLY" else bezier_polygon(POINTS, False)
    np.testing.assert_allclose(entry.yarns.points, np.add(expected, (0, 0, 1)), atol=1e-6)


def test_armature(entries):
    import bpy

    obj = scenes.legacy("Yarn", "POLY", POINTS.tolist())
    data = bpy.data.armatures.new("Armature")
    armature = scenes.link(bpy.data.objects.new("Armature", data))
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bone = data.edit_bones.new("Bone")
    bone.tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    armature.pose.bones["Bone"].location = (0, 4, 0)
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object, modifier.use_bone_envelopes, modifier.use_apply_on_spline = armature, True, True
    bone = data.bones["Bone"]
    bone.envelope_distance = 100
    (entry,) = entries()
    np.testing.assert_allclose(entry.yarns.points, np.add(POINTS, (0, 0, 4)), atol=1e-5)


def test_geometry_nodes_on_curves(entries):
    obj = scenes.curves("Yarn", POINTS)
    nodes = scenes.Nodes(obj)
    moved = nodes.new("SetPosition", Geometry=nodes.input, Offset=(0, 0, 2))
    radius = nodes.new("SetCurveRadius", Curve=moved.outputs[0], Radius=0.75)
    nodes.finish(radius.outputs[0])
    (entry,) = entries()
    np.testing.assert_array_equal(entry.yarns.points, POINTS + np.float32([0, 0, 2]))
    assert np.all(entry.yarns.radii == 0.75)


@pytest.mark.parametrize("set_radius", [False, True])
def test_geometry_nodes_on_a_legacy_curve(entries, set_radius):
    obj = scenes.legacy("Yarn", "POLY", POINTS.tolist())
    nodes = scenes.Nodes(obj)
    geometry = nodes.new("SetPosition", Geometry=nodes.input, Offset=(0, 0, 2)).outputs[0]
    if set_radius:
        geometry = nodes.new("SetCurveRadius", Curve=geometry, Radius=0.75).outputs[0]
    nodes.finish(geometry)
    (entry,) = entries()
    np.testing.assert_array_equal(entry.yarns.points, POINTS + np.float32([0, 0, 2]))
    np.testing.assert_allclose(entry.yarns.radii, 0.75 if set_radius else 0.01)


def test_geometry_nodes_curves_on_a_mesh_are_counted_once(entries):
    obj = scenes.empty_mesh("Maker")
    nodes = scenes.Nodes(obj)
    circle = nodes.new("CurvePrimitiveCircle", Resolution=12, Radius=2.0).outputs[0]
    nodes.finish(nodes.input, circle, nodes.new("MeshCube").outputs[0])
    (entry,) = entries()
    assert entry.yarns.offsets.tolist() == [0, 12] and entry.yarns.closed.all()
    np.testing.assert_allclose(np.linalg.norm(entry.yarns.points, axis=1), 2, rtol=1e-6)


def matrices(entries):
    return sorted(tuple(np.round(entry.transform[:3, 3], 5)) for entry in entries)


def test_collection_instances(entries):
    obj = scenes.curves("Yarn", POINTS)
    obj.location = (0, 1, 0)
    first = scenes.collection_instance("First", obj, location=(5, 0, 0))
    second = scenes.link(first.copy())
    second.location = (7, 0, 0)
    found = entries()
    assert matrices(found) == [(5, 1, 0), (7, 1, 0)]
    assert found[0].yarns is found[1].yarns
    # Copies of a yarn differ in their fibers, the same way in every frame and process.
    assert sorted(entry.object_id for entry in found) == sorted(entry.object_id for entry in entries())
    assert found[0].object_id != found[1].object_id


@pytest.mark.parametrize("owner", ["MESH", "CURVES", "LEGACY", "BEVELLED"])
@pytest.mark.parametrize("instanced", [False, True])
def test_geometry_nodes_instances_of_geometry(entries, owner, instanced):
    """Own curves once, and a circle on each of 2 × 3 nested points; meshes among them are not curves."""
    obj = {
        "MESH": lambda: scenes.empty_mesh("Maker"),
        "CURVES": lambda: scenes.curves("Maker", POINTS),
        "LEGACY": lambda: scenes.legacy("Maker", "POLY", POINTS.tolist()),
        "BEVELLED": lambda: scenes.legacy("Maker", "POLY", POINTS.tolist(), bevel_depth=0.1),
    }[owner]()
    nodes = scenes.Nodes(obj)
    circle = nodes.new("CurvePrimitiveCircle", Resolution=9).outputs[0]
    inner = nodes.new(
        "InstanceOnPoints",
        Points=nodes.new("MeshLine", Count=2, Offset=(0, 10, 0)).outputs[0],
        Instance=circle,
        Rotation=(0, 0, math.pi / 2),
    )
    outer = nodes.new(
        "InstanceOnPoints",
        Points=nodes.new("MeshLine", Count=3, Offset=(1, 0, 0)).outputs[0],
        Instance=inner.outputs[0],
        Scale=(2, 2, 2),
    )
    cubes = nodes.new(
        "InstanceOnPoints",
        Points=nodes.new("MeshLine", Count=2).outputs[0],
        Instance=nodes.new("MeshCube").outputs[0],
    )
    nodes.finish(nodes.input, nodes.new("CurvePrimitiveLine").outputs[0], outer.outputs[0], cubes.outputs[0])
    shift = 0
    if instanced:
        scenes.collection_instance("Collection", obj, location=(100, 0, 0))
        shift = 100
    found = entries()
    circles = [entry for entry in found if len(entry.yarns.points) == 9]
    assert matrices(circles) == sorted((x + shift, y, 0) for x in (0, 1, 2) for y in (0, 20))
    # Instances turn by a right angle and double.
    np.testing.assert_allclose(circles[0].transform[:3, :3], [[0, -2, 0], [2, 0, 0], [0, 0, 2]], atol=1e-6)
    own = [entry for entry in found if len(entry.yarns.points) != 9]
    assert len(own) == 1 and len(circles) == 6
    assert len(own[0].yarns.offsets) == {"MESH": 2, "CURVES": 3, "LEGACY": 3, "BEVELLED": 2}[owner]


def test_geometry_nodes_instances_of_an_object(entries):
    yarn = scenes.curves("Yarn", POINTS)
    maker = scenes.empty_mesh("Maker", [(0, 0, 1), (1, 0, 1), (2, 0, 1)])
    nodes = scenes.Nodes(maker)
    info = nodes.new("ObjectInfo", Object=yarn, As_Instance=True)
    nodes.finish(nodes.new("InstanceOnPoints", Points=nodes.input, Instance=info.outputs["Geometry"]).outputs[0])
    assert matrices(entries()) == [(0, 0, 0), (0, 0, 1), (1, 0, 1), (2, 0, 1)]


def test_hidden_objects_are_not_drawn(entries):
    import bpy

    scenes.curves("Shown", POINTS)
    scenes.curves("Hidden", POINTS).hide_render = True
    scenes.curves("Unseen", POINTS).visible_camera = False
    scenes.curves("Scaled away", POINTS).scale.x = 0
    scenes.link(bpy.data.objects.new("Empty", bpy.data.hair_curves.new("Empty")))
    assert [entry.name for entry in entries()] == ["Shown"]
    bpy.data.objects["Shown"].hide_viewport = True
    assert [entry.name for entry in entries()] == ["Shown"]


def test_a_million_points_are_read_quickly(entries):
    import time

    import bpy
    from lisle_blender.export.curves import read_curves

    obj = scenes.curves("Yarn", np.random.default_rng(0).random((1_000_000, 3), np.float32))
    geometry = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).evaluated_geometry()
    begin = time.perf_counter()
    arrays = read_curves(geometry.curves, obj.name)
    assert len(arrays.points) == 1_000_000
    # About 15 ms; a Python loop over the points takes more than a second.
    assert time.perf_counter() - begin < 0.3


def test_usd_curves(entries, data):
    import bpy

    for name, kind, points in (
        ("yarn_stock_stretchX", CATMULL_ROM, 25757),
        ("yarn_satin_stretchX", CATMULL_ROM, 25845),
    ):
        bpy.ops.wm.usd_import(filepath=str(data / "animated" / f"{name}.usdc"))
        obj = next(obj for obj in bpy.data.objects if obj.type == "CURVES")
        bpy.context.scene.frame_set(1)
        (first,) = entries()
        bpy.context.scene.frame_set(30)
        (later,) = entries()
        assert len(first.yarns.points) == points and np.all(first.yarns.basis == kind)
        np.testing.assert_allclose(first.yarns.radii, 0.001, rtol=1e-5)
        assert np.abs(later.yarns.points - first.yarns.points).max() > 0.01
        np.testing.assert_array_equal(later.yarns.rest_points, first.yarns.points)
        bpy.data.objects.remove(obj)


def test_an_attribute_of_another_type_is_named(lisle):
    import bpy

    scenes.curves("Yarn", scenes.line()).data.attributes.new("length_coordinate", "FLOAT_VECTOR", "POINT")
    found = "object 'Yarn': its attribute 'length_coordinate' is of type FLOAT_VECTOR: store it as FLOAT"
    with pytest.raises(RuntimeError, match=found):
        bpy.ops.render.render()


def notes_of_drawing(addon, lisle):
    """[(entries, notes)] of two frames of an animation."""
    import bpy

    told, say = [], addon.engine.job.not_said_before
    addon.engine.engine.job.not_said_before = lambda sentences: told.append(say(sentences)) or told[-1]
    bpy.context.scene.frame_end = 2
    bpy.ops.render.render(animation=True)
    return [(scene.entries, notes) for (scene, _), notes in zip(lisle.scenes[-2:], told, strict=True)]


def test_curves_without_length_are_left_out_and_said_once(addon, lisle):
    point, dot = scenes.line(1), np.zeros((4, 3))
    scenes.curves("Yarn", point, scenes.line(5), dot, scenes.line(3))
    scenes.curves("Dust", point, dot)
    (first, notes), (second, later) = notes_of_drawing(addon, lisle)
    for entries in (first, second):
        assert [(entry.name, np.diff(entry.yarns.offsets).tolist()) for entry in entries] == [("Yarn", [5, 3])]
    assert later == [] and len(notes) == 2
    assert any("object 'Yarn': 2 of its 4 curves are not drawn, curve 0 first" in note for note in notes)
    assert any("object 'Dust': 2 of its 2 curves" in note for note in notes)


def test_what_is_no_number_is_never_left_out(lisle):
    import bpy

    scenes.curves("Yarn", scenes.line(5), np.full((4, 3), np.nan))
    with pytest.raises(RuntimeError, match="point 5 is not finite"):
        bpy.ops.render.render()


def test_short_nurbs_and_rings_of_two_are_as_blender_draws_them(entries):
    obj = scenes.curves("Yarn", scenes.line(3), scenes.line(2), scenes.line(4))
    obj.data.set_types(type="NURBS", indices=[0, 2])
    obj.data.attributes.new("cyclic", "BOOLEAN", "CURVE").data.foreach_set("value", [False, True, True])
    (entry,) = entries()
    assert entry.yarns.basis.tolist() == [POLY, CATMULL_ROM, NURBS]
    assert entry.yarns.closed.tolist() == [False, False, True]
