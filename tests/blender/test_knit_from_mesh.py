"""Knit from Mesh: where the yarn is, that it follows the mesh in every engine and frame, and what is refused."""

import itertools

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender("wheel")

ATTRIBUTES = ("lisle_vertex_1", "lisle_vertex_2", "lisle_vertex_3", "lisle_weights", "lisle_height")


def vectors(collection, name):
    values = np.empty(len(collection) * 3, np.float32)
    collection.foreach_get(name, values)
    return values.reshape(-1, 3)


def evaluated_points(obj):
    import bpy

    geometry = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).evaluated_geometry()
    return vectors(geometry.curves.position_data, "vector")


def expected_points(obj, mesh_object):
    """Where the bound points are by numpy, in the space of `obj`."""
    import bpy

    evaluated = mesh_object.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.data.copy()
    mesh.transform(obj.matrix_world.inverted() @ evaluated.matrix_world)
    positions, normals = vectors(mesh.vertices, "co"), vectors(mesh.vertex_normals, "vector")
    attributes = obj.data.attributes
    numbers = np.array([[item.value for item in attributes[name].data] for name in ATTRIBUTES[:3]]).T
    weights = vectors(attributes["lisle_weights"].data, "vector")
    heights = np.array([item.value for item in attributes["lisle_height"].data])
    normal = (weights[..., None] * normals[numbers]).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return (weights[..., None] * positions[numbers]).sum(axis=1) + heights[:, None] * normal


def grid(size=0.1, cells=8):
    import bpy

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=size)
    return bpy.context.active_object


def knit(**options):
    import bpy

    assert bpy.ops.lisle.knit_from_mesh(**options) == {"FINISHED"}
    return bpy.context.active_object


def swing(obj):
    """Keyframes that bend a mesh from frame 1 to 5."""
    obj.shape_key_add(name="Basis")
    bent = obj.shape_key_add(name="Bent")
    for point in bent.data:
        point.co.z += 8 * point.co.x**2 + point.co.y
    scenes.keyframes(bent, "value", {5: 1.0, 1: 0.0})
    return bent


def test_yarn_lies_on_the_mesh_and_follows_it(lisle):
    import bpy

    mesh_object = grid()
    bent = swing(mesh_object)
    obj = knit(pattern="rib-1-1", yarn_radius=0.001)
    assert obj.parent == mesh_object and bpy.context.selected_objects == [obj]
    rest = vectors(obj.data.position_data, "vector")
    assert len(obj.data.curves) > 15 and np.ptp(rest[:, 2]) > 0.003
    np.testing.assert_allclose(evaluated_points(obj), rest, atol=1e-7)
    bpy.context.scene.frame_set(4)
    moved = evaluated_points(obj)
    assert bent.value > 0.5 and np.abs(moved - rest).max() > 0.02
    np.testing.assert_allclose(moved, expected_points(obj, mesh_object), atol=1e-7)
    # One that is bound wrongly would be noticed.
    heights = obj.data.attributes["lisle_height"].data
    heights.foreach_set("value", -np.array([item.value for item in heights]))
    assert np.abs(moved - expected_points(obj, mesh_object)).max() > 1e-3


def test_scaled_turned_and_subdivided_meshes(lisle):
    import bpy

    mesh_object = grid(cells=3)
    mesh_object.scale, mesh_object.rotation_euler, mesh_object.location = (2, 1, 1), (0.3, 0.2, 0.1), (5, -4, 3)
    mesh_object.modifiers.new("Subdivision", "SUBSURF").levels = 2
    mesh_object.modifiers["Subdivision"].render_levels = 2
    bpy.context.view_layer.update()
    obj = knit(yarn_radius=0.002)
    # Twice as wide as high; stitches keep their natural size.
    assert len(obj.data.points) / len(obj.data.curves) == pytest.approx(20 * 0.2 / (8.15 * 0.002), rel=0.05)
    np.testing.assert_allclose(obj.matrix_world.to_scale(), (1, 1, 1), atol=1e-6)
    np.testing.assert_allclose(evaluated_points(obj), expected_points(obj, mesh_object), atol=1e-6)
    np.testing.assert_allclose(evaluated_points(obj), vectors(obj.data.position_data, "vector"), atol=1e-4)
    mesh_object.location.x += 2
    bpy.context.view_layer.update()
    assert obj.matrix_world.translation.x == pytest.approx(7, abs=1e-5)
    np.testing.assert_allclose(evaluated_points(obj), expected_points(obj, mesh_object), atol=1e-6)


def test_round_a_cylinder_courses_are_closed(lisle):
    import bpy

    bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.03, depth=0.05, end_fill_type="NOTHING")
    mesh_object = bpy.context.active_object
    # Its own map leaves a margin; one that fills the square in u has its borders on the seam.
    layer = mesh_object.data.uv_layers.active.uv
    uvs = np.array([item.vector[:] for item in layer], np.float32)
    uvs = (uvs - uvs.min(axis=0)) / np.ptp(uvs, axis=0)
    layer.foreach_set("vector", uvs.ravel())
    obj = knit(pattern="rib-2-2")
    cyclic = [item.value for item in obj.data.attributes["cyclic"].data]
    assert all(cyclic) and len(cyclic) > 8
    assert all(curve.points_length % (4 * 20) == 0 for curve in obj.data.curves)
    points = vectors(obj.data.position_data, "vector")
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), 0.03, atol=0.004)


def test_a_frame_alone_is_the_same_as_in_the_animation(lisle, tmp_path):
    import bpy

    mesh_object = grid(size=6)
    swing(mesh_object).data.foreach_set(
        "co", np.array([(p.co.x, p.co.y, 0.1 * p.co.x**2 + p.co.y * 0.2) for p in mesh_object.data.vertices]).ravel()
    )
    obj = knit(yarn_radius=0.1)
    assert mesh_object.hide_render and mesh_object.display_type == "WIRE"
    assert mesh_object.lisle.mesh_kind == "INVISIBLE"
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy = 3
    scene = bpy.context.scene
    scene.lisle.samples = 1
    assert "length_coordinate" in obj.data.attributes
    scenes.use_exr(tmp_path / "all_")
    bpy.ops.render.render(animation=True)
    scene.frame_set(1)
    scene.frame_set(4)
    alone = scenes.render_rgba(tmp_path / "alone.exr")
    frames = [scenes.exr.read_exr(tmp_path / f"all_{frame:04}.exr") for frame in (1, 4)]
    first, fourth = (np.stack([channels[name] for name in "RGBA"], axis=-1) for channels in frames)
    np.testing.assert_array_equal(alone, fourth)
    assert np.abs(first - fourth).mean() > 0.02 and fourth[..., 3].mean() > 0.3


def test_a_cloth_simulation_moves_the_yarn(lisle):
    import bpy

    mesh_object = grid(size=0.2, cells=6)
    mesh_object.modifiers.new("Cloth", "CLOTH")
    obj = knit(yarn_radius=0.002)
    heights = []
    for frame in (1, 2, 3, 4, 5):
        bpy.context.scene.frame_set(frame)
        points = evaluated_points(obj)
        np.testing.assert_allclose(points, expected_points(obj, mesh_object), atol=1e-6)
        heights.append(float(points[:, 2].mean()))
    assert all(b < a for a, b in itertools.pairwise(heights[1:])), heights


def test_the_binding_is_saved_and_shared(lisle, tmp_path):
    import bpy

    for _ in range(2):
        mesh_object = grid()
        swing(mesh_object)
        knit()
    groups = [group for group in bpy.data.node_groups if "lisle_follow_mesh" in group]
    assert len(groups) == 1
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    mesh_object, obj = bpy.data.objects["Grid.001"], bpy.data.objects["Grid.001 Knit"]
    bpy.context.scene.frame_set(5)
    np.testing.assert_allclose(evaluated_points(obj), expected_points(obj, mesh_object), atol=1e-7)


def test_knitting_can_be_undone_and_done_otherwise(lisle):
    import bpy

    grid()
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.lisle.knit_from_mesh("EXEC_DEFAULT", True, yarn_radius=0.001)
    fine = len(bpy.data.objects["Grid Knit"].data.points)
    bpy.ops.ed.undo()
    assert "Grid Knit" not in bpy.data.objects and not bpy.data.objects["Grid"].hide_render
    bpy.context.view_layer.objects.active = bpy.data.objects["Grid"]
    bpy.ops.lisle.knit_from_mesh("EXEC_DEFAULT", True, yarn_radius=0.002, hide_mesh=False)
    assert len(bpy.data.objects["Grid Knit"].data.points) < 0.4 * fine
    assert not bpy.data.objects["Grid"].hide_render


def test_meshes_that_cannot_be_knitted_are_refused(lisle):
    import bpy

    mesh_object = grid()
    layer = mesh_object.data.uv_layers.active.uv
    uvs = np.array([item.vector[:] for item in layer], np.float32)
    mirrored = np.minimum(uvs, 1 - uvs)
    for values, message in ((mirrored, "object 'Grid': the UV map overlaps"), (0 * uvs, "its UV map has no area")):
        layer.foreach_set("vector", values.ravel())
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.lisle.knit_from_mesh()
    layer.foreach_set("vector", uvs.ravel())
    with pytest.raises(RuntimeError, match="no stitch fits"):
        bpy.ops.lisle.knit_from_mesh(yarn_radius=0.1)
    with pytest.raises(RuntimeError, match="neither 'k'"):
        bpy.ops.lisle.knit_from_mesh(pattern="CHART", chart="kz")
    mesh_object.data.uv_layers.remove(mesh_object.data.uv_layers[0])
    mesh_object.data.update()
    with pytest.raises(RuntimeError, match="object 'Grid': it has no UV map"):
        bpy.ops.lisle.knit_from_mesh()
    bpy.context.view_layer.objects.active = scenes.empty_mesh("Bare")
    bpy.context.active_object.data.uv_layers.new()
    with pytest.raises(RuntimeError, match="object 'Bare'"):
        bpy.ops.lisle.knit_from_mesh()
    bpy.context.view_layer.objects.active = scenes.curves("Yarn", scenes.line())
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.lisle.knit_from_mesh()
    assert not any(" Knit" in obj.name for obj in bpy.data.objects)


def test_a_mesh_that_was_changed_or_removed_stops_the_render(lisle):
    import bpy

    mesh_object = grid(size=6)
    knit(yarn_radius=0.2)
    bpy.context.scene.lisle.samples = 1
    bpy.ops.render.render()
    modifier = mesh_object.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 0, 1
    with pytest.raises(RuntimeError, match="the mesh 'Grid' has 289 vertices, 81 when it was knitted on"):
        bpy.ops.render.render()
    mesh_object.modifiers.remove(modifier)
    bpy.ops.render.render()
    bpy.data.objects.remove(mesh_object)
    with pytest.raises(RuntimeError, match="is gone"):
        bpy.ops.render.render()


def test_a_modifier_that_is_off_is_not_checked(lisle):
    import bpy
    from lisle_blender.export.scene import collect

    mesh_object = grid(size=6)
    obj = knit(yarn_radius=0.2)
    mesh_object.modifiers.new("Subdivision", "SUBSURF").render_levels = 1
    modifier = obj.modifiers["Follow Mesh"]
    bpy.context.scene.lisle.samples = 1

    def view():
        collect(lisle, bpy.context.evaluated_depsgraph_get(), print)

    modifier.show_render = False
    bpy.ops.render.render()
    with pytest.raises(Exception, match="vertices, 81 when"):
        view()
    modifier.show_render, modifier.show_viewport = True, False
    view()
    with pytest.raises(RuntimeError, match="vertices, 81 when"):
        bpy.ops.render.render()


@pytest.mark.parametrize("in_edit_mode", [True, False])
def test_the_mesh_may_be_in_edit_mode(lisle, in_edit_mode):
    import bpy
    from lisle_blender.core.errors import GeometryError
    from lisle_blender.export.scene import collect

    mesh_object = grid(size=6)
    modifier = mesh_object.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    modifier.show_in_editmode = in_edit_mode
    knit(yarn_radius=0.2)
    bpy.context.view_layer.objects.active = mesh_object
    bpy.ops.object.mode_set(mode="EDIT")
    if in_edit_mode:
        assert collect(lisle, bpy.context.evaluated_depsgraph_get(), print).placements
    else:
        with pytest.raises(GeometryError, match="leave Edit Mode") as raised:
            collect(lisle, bpy.context.evaluated_depsgraph_get(), print)
        assert "the same levels" not in str(raised.value)
