"""The length coordinate and the rest shape: from the reference frame, whatever was drawn before."""

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender


def stretching(name="Yarn", y=0.0):
    """A yarn that its geometry nodes lengthen with every frame: x runs to 1 + frame / 10 times its length."""
    obj = scenes.curves(name, scenes.line(end=(0, 0, 0)))
    obj.location.y = y
    nodes = scenes.Nodes(obj)
    time = nodes.new("InputSceneTime").outputs["Frame"]
    position = nodes.new("InputPosition").outputs[0]
    scale = nodes.tree.nodes.new("ShaderNodeVectorMath")
    scale.operation = "SCALE"
    factor = nodes.tree.nodes.new("ShaderNodeMath")
    factor.operation = "MULTIPLY_ADD"
    factor.inputs[1].default_value, factor.inputs[2].default_value = 0.1, 1
    nodes.tree.links.new(time, factor.inputs[0])
    nodes.tree.links.new(position, scale.inputs[0])
    nodes.tree.links.new(factor.outputs[0], scale.inputs["Scale"])
    nodes.finish(nodes.new("SetPosition", Geometry=nodes.input, Position=scale.outputs[0]).outputs[0])
    return obj


def growing(name="Yarn"):
    """A yarn with as many points as the frame's number, plus two."""
    obj = scenes.empty_mesh(name)
    nodes = scenes.Nodes(obj)
    count = nodes.tree.nodes.new("ShaderNodeMath")
    count.inputs[1].default_value = 2
    nodes.tree.links.new(nodes.new("InputSceneTime").outputs["Frame"], count.inputs[0])
    line = nodes.new("CurvePrimitiveLine", End=(3, 0, 0)).outputs[0]
    nodes.finish(nodes.new("ResampleCurve", Curve=line, Count=count.outputs[0]).outputs[0])
    return obj


def frame_channels(folder, frames, animation=True):
    """Renders frames as one animation, or each alone; {frame: bytes of the file's pixels}."""
    import bpy
    import exr

    scene = bpy.context.scene
    if animation:
        scenes.use_exr(folder / "f_")
        start, end = scene.frame_start, scene.frame_end
        bpy.ops.render.render(animation=True, **_range(frames))
        assert (scene.frame_start, scene.frame_end) == (start, end)
    else:
        for frame in frames:
            scene.frame_set(frame)
            scenes.use_exr(folder / f"f_{frame:04}.exr")
            bpy.ops.render.render(write_still=True)
    return {frame: exr.read_exr(folder / f"f_{frame:04}.exr") for frame in frames}


def _range(frames):
    import bpy

    if bpy.app.version >= (5, 0, 0):
        return {"frame_start": frames[0], "frame_end": frames[-1]}
    scene = bpy.context.scene
    assert [*frames] == [*range(scene.frame_start, scene.frame_end + 1)], "4.5 renders the scene's range only"
    return {}


def test_a_frame_alone_is_identical_to_the_same_frame_of_an_animation(lisle, tmp_path):
    import bpy

    stretching()
    scene = bpy.context.scene
    in_sequence = frame_channels(tmp_path, range(1, 6))
    (tmp_path / "alone").mkdir()
    for frame in (5, 2, 4):
        alone = frame_channels(tmp_path / "alone", [frame], animation=False)[frame]
        for name, picture in alone.items():
            np.testing.assert_array_equal(picture, in_sequence[frame][name])
    assert not np.array_equal(in_sequence[5]["R"], in_sequence[2]["R"])
    entry = lisle.scenes[-1][0].entries[0]
    assert scene.frame_current == 4
    np.testing.assert_allclose(entry.yarns.rest_points[0, 0], -3.3)
    np.testing.assert_allclose(entry.yarns.points[0, 0], -4.2)


def test_reference_frame_is_evaluated_once_per_job(addon, lisle, tmp_path):
    import bpy

    stretching()
    scene = bpy.context.scene
    scene.lisle.use_reference_frame, scene.lisle.reference_frame = True, 20
    visited = []
    bpy.app.handlers.frame_change_post.append(lambda scene, *_: visited.append(scene.frame_current))
    frame_channels(tmp_path, range(1, 6))
    assert visited.count(20) == 1
    for given, _ in lisle.scenes:
        np.testing.assert_allclose(given.entries[0].yarns.rest_points[0, 0], -9)
    frame_channels(tmp_path, [3], animation=False)
    assert visited.count(20) == 2, "between jobs the curve may have been edited"


def test_object_has_its_own_reference_frame(lisle):
    import bpy

    stretching("A")
    b = stretching("B", 1)
    b.lisle.use_reference_frame, b.lisle.reference_frame = True, 10
    bpy.context.scene.frame_set(3)
    bpy.ops.render.render()
    a, b = lisle.scenes[-1][0].entries
    np.testing.assert_allclose((a.yarns.rest_points[0, 0], b.yarns.rest_points[0, 0]), (-3.3, -6))
    np.testing.assert_allclose((a.yarns.points[0, 0], b.yarns.points[0, 0]), (-3.9, -3.9))


def test_edits_between_jobs_count(lisle):
    import bpy

    obj = stretching()
    bpy.context.scene.frame_set(3)
    bpy.ops.render.render()
    obj.data.position_data.foreach_set("vector", scenes.line(begin=(-1, 0, 0), end=(0, 0, 0)).ravel())
    bpy.ops.render.render()
    np.testing.assert_allclose(lisle.scenes[-1][0].entries[0].yarns.rest_points[0, 0], -1.1)


def test_camera_and_lights_are_those_of_the_present_frame(lisle):
    import bpy

    stretching()
    light = scenes.link(bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT")))
    for obj in (light, bpy.context.scene.camera):
        scenes.keyframes(obj, "location", {1: (0, 0, 10), 3: (1, 2, 30)})
    bpy.context.scene.frame_set(3)
    bpy.ops.render.render()
    scene = lisle.scenes[-1][0]
    np.testing.assert_allclose(scene.camera.world_from_camera[:3, 3], (1, 2, 30))
    np.testing.assert_allclose(scene.lights[0].position, (1, 2, 30))


def test_frame_is_restored_after_an_error_at_the_reference_frame(addon, lisle, tmp_path):
    import bpy

    stretching()
    collect = addon.engine.rest.collect
    addon.engine.rest.collect = lambda *_args, **_options: 1 / 0
    bpy.context.scene.frame_set(4)
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        bpy.ops.render.render()
    assert bpy.context.scene.frame_current == 4
    addon.engine.rest.collect = collect
    bpy.ops.render.render()
    np.testing.assert_allclose(lisle.scenes[-1][0].entries[0].yarns.points[0, 0], -4.2)


def test_subframes_are_not_the_reference_frame(lisle):
    import bpy

    stretching()
    bpy.context.scene.frame_set(1, subframe=0.5)
    bpy.ops.render.render()
    yarns = lisle.scenes[-1][0].entries[0].yarns
    np.testing.assert_allclose((yarns.rest_points[0, 0], yarns.points[0, 0]), (-3.3, -3.45), rtol=1e-6)


def test_changing_point_counts_are_an_error_that_names_them(lisle, tmp_path):
    import bpy

    growing()
    scenes.use_exr(tmp_path / "f_")
    words = r"object 'Yarn': its curve 0 has 4 points, 3 at rest \(frame 2 against reference frame 1\).*Re-measure"
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.render.render(animation=True)
    assert [path.name for path in tmp_path.iterdir()] == ["f_0001.exr"]


def test_changing_point_counts_can_be_remeasured(lisle):
    import bpy

    growing().lisle.remeasure = True
    bpy.context.scene.frame_set(4)
    bpy.ops.render.render()
    yarns = lisle.scenes[-1][0].entries[0].yarns
    assert len(yarns.points) == 6
    np.testing.assert_array_equal(yarns.rest_points, yarns.points)


def test_an_object_hidden_at_its_reference_frame_is_an_error(lisle):
    import bpy

    obj = stretching()
    for frame, hidden in ((1, True), (2, False)):
        obj.hide_render = hidden
        obj.keyframe_insert("hide_render", frame=frame)
    bpy.context.scene.frame_set(4)
    with pytest.raises(RuntimeError, match="'Yarn': it shows no such curves at its reference frame"):
        bpy.ops.render.render()


def test_stored_length_coordinate_wins(lisle):
    import bpy

    obj = stretching()
    stored = np.linspace(0, 7, 20, dtype=np.float32)
    obj.data.attributes.new("length_coordinate", "FLOAT", "POINT").data.foreach_set("value", stored)
    for frame in (1, 4):
        bpy.context.scene.frame_set(frame)
        bpy.ops.render.render()
        np.testing.assert_array_equal(lisle.scenes[-1][0].entries[0].yarns.length_coordinates, stored)


def test_animated_radius_is_this_frames(lisle):
    import bpy

    obj = scenes.curves("Yarn", scenes.line())
    nodes = scenes.Nodes(obj)
    time = nodes.new("InputSceneTime").outputs["Frame"]
    nodes.finish(nodes.new("SetCurveRadius", Curve=nodes.input, Radius=time).outputs[0])
    bpy.context.scene.frame_set(3)
    bpy.ops.render.render()
    assert np.all(lisle.scenes[-1][0].entries[0].yarns.radii == 3)


def test_instanced_geometry_keeps_its_rest_shape(lisle):
    import bpy

    maker = scenes.empty_mesh("Maker", [(0, 0, 0), (0, 1, 0)])
    nodes = scenes.Nodes(maker)
    time = nodes.new("InputSceneTime").outputs["Frame"]
    circle = nodes.new("CurvePrimitiveCircle", Resolution=8, Radius=time).outputs[0]
    nodes.finish(nodes.new("InstanceOnPoints", Points=nodes.input, Instance=circle).outputs[0])
    bpy.context.scene.frame_set(3)
    bpy.ops.render.render()
    for entry in lisle.scenes[-1][0].entries:
        np.testing.assert_allclose(np.linalg.norm(entry.yarns.points, axis=1), 3, rtol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(entry.yarns.rest_points, axis=1), 1, rtol=1e-6)


def test_two_view_layers_and_persistent_data(lisle, tmp_path):
    import bpy

    stretching()
    scene = bpy.context.scene
    scene.view_layers.new("Second")
    scene.render.use_persistent_data = True
    frame_channels(tmp_path, range(1, 6))
    assert len(lisle.scenes) == 10
    for index, (given, _) in enumerate(lisle.scenes):
        yarns = given.entries[0].yarns
        np.testing.assert_allclose(yarns.rest_points[0, 0], -3.3)
        np.testing.assert_allclose(yarns.points[0, 0], -3 * (1 + (index // 2 + 1) / 10), rtol=1e-6)


def test_views_forget_the_rest_shapes_of_removed_objects(addon, lisle):
    import bpy

    rest_shapes = addon.engine.rest.RestShapes()

    def see():
        depsgraph = bpy.context.evaluated_depsgraph_get()
        content = addon.export.scene.collect(lisle, depsgraph, lambda _: None)
        at_rest = rest_shapes.known(bpy.context.scene, bpy.context.view_layer, content)
        for key, geometry in content.geometries.items():
            rest_shapes.yarns(lisle, key, geometry.curves, at_rest[key])
        return len(rest_shapes._curves), len(rest_shapes._yarns)

    kept, removed = scenes.curves("Kept", scenes.line()), scenes.curves("Removed", scenes.line())
    assert see() == (2, 2)
    kept.hide_viewport = True
    assert see() == (2, 2), "what is hidden may come back"
    bpy.data.objects.remove(removed)
    assert see() == (1, 1)
