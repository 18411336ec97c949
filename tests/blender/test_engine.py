"""What comes out of the engine: pixels, passes, borders, layers."""

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender


def dots(points, size=(64, 48)):
    """Pixels (row from the top, column) that points cover in the test camera."""
    x = np.floor((points[:, 0] / 8 + 0.5) * size[0]).astype(int)
    row = np.floor((0.5 - points[:, 1] / (8 * size[1] / size[0])) * size[1]).astype(int)
    return row, x


def test_picture_lands_the_right_way_up(lisle, tmp_path):
    points = np.array([(-3, 2, 0), (-3, 1, 0), (2, -2.5, 0)], np.float32)
    scenes.curves("Yarn", points)
    picture = scenes.render_rgba(tmp_path / "a.exr")
    expected = np.zeros((48, 64, 4), np.float32)
    lengths = np.array([0, 1, 1 + np.hypot(5, 3.5)], np.float32)
    expected[dots(points)] = np.stack((lengths, lengths / 2, np.ones(3), np.ones(3)), axis=-1)
    np.testing.assert_array_equal(picture, expected)


def test_opaque_film_shows_the_world(lisle, tmp_path):
    import bpy

    scenes.curves("Yarn", scenes.line())
    world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    background = world.node_tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    background.inputs["Color"].default_value = (0.2, 0.4, 0.6, 1)
    background.inputs["Strength"].default_value = 2
    bpy.context.scene.world = world
    bpy.context.scene.render.film_transparent = False
    picture = scenes.render_rgba(tmp_path / "a.exr")
    np.testing.assert_allclose(picture[0, 0], (0.4, 0.8, 1.2, 1), rtol=1e-6)
    assert lisle.scenes[-1][1]["transparent"] is False


@pytest.mark.parametrize("crop", [False, True])
@pytest.mark.parametrize("border", [(0.25, 0.25, 0.75, 0.75), (0.1, 0.3, 0.77, 0.81), (0.51, 0.0, 1.0, 0.34)])
def test_border_is_the_same_part_of_the_whole_picture(lisle, tmp_path, border, crop):
    import bpy

    random = np.random.default_rng(1)
    scenes.curves("Yarn", random.uniform((-4, -3, 0), (4, 3, 0), (400, 3)))
    whole = scenes.render_rgba(tmp_path / "whole.exr")
    render = bpy.context.scene.render
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y = border
    part = scenes.render_rgba(tmp_path / "part.exr")
    x0, y0, x1, y1 = lisle.scenes[-1][1]["region"]
    rows, columns = slice(48 - y1, 48 - y0), slice(x0, x1)
    assert (whole[rows, columns, 3] > 0).sum() > 20
    if crop:
        np.testing.assert_array_equal(part, whole[rows, columns])
    else:
        np.testing.assert_array_equal(part[rows, columns], whole[rows, columns])
        part[rows, columns] = 0
        assert not part.any()


def test_many_borders_fit_the_pixels_that_blender_wants(lisle):
    import bpy

    scenes.curves("Yarn", scenes.line())
    render, random = bpy.context.scene.render, np.random.default_rng(0)
    render.use_border = True
    for _ in range(40):
        render.resolution_x, render.resolution_y = (int(n) for n in random.integers(50, 500, 2))
        size = np.array([render.resolution_x, render.resolution_y])
        begin, end = np.sort(random.integers(0, size + 1, (2, 2)), axis=0) / size
        render.border_min_x, render.border_min_y = begin
        render.border_max_x, render.border_max_y = np.maximum(end, begin + 2 / size)
        bpy.ops.render.render()


def test_passes_arrive_in_a_multilayer_file(lisle, tmp_path):
    import bpy

    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_object_index = True
    layer.lisle.use_pass_tangent = layer.lisle.use_pass_coverage = True
    yarn = scenes.curves("Yarn", scenes.line())
    yarn.pass_index = 7
    channels = scenes.render_channels(tmp_path / "a.exr", multilayer=True)
    index = "Object Index" if bpy.app.version >= (5, 0, 0) else "IndexOB"
    row, x = dots(scenes.line())
    covered = np.zeros((48, 64), bool)
    covered[row, x] = True
    expected = {
        "Combined.A": (1, 0), "Depth.Z": (10, 1e10), "Normal.Z": (1, 0), "Normal.X": (0, 0), "Tangent.X": (1, 0),
        "Tangent.Z": (0, 0), "Coverage.A": (1, 0), f"{index}.X": (7, 0),
    }  # fmt: skip
    for name, (inside, outside) in expected.items():
        picture = channels[f"{layer.name}.{name}"]
        np.testing.assert_allclose(picture, np.where(covered, inside, outside), rtol=1e-5, err_msg=name)


def test_passes_have_compositor_sockets(lisle):
    import bpy

    scene, layer = bpy.context.scene, bpy.context.view_layer
    if bpy.app.version >= (5, 0, 0):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
    node = tree.nodes.new("CompositorNodeRLayers")
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_object_index = True
    layer.lisle.use_pass_tangent = layer.lisle.use_pass_coverage = True
    sockets = {socket.name: socket.type for socket in node.outputs if socket.enabled}
    index = "Object Index" if bpy.app.version >= (5, 0, 0) else "IndexOB"
    assert sockets.items() >= {
        "Image": "RGBA", "Depth": "VALUE", "Normal": "VECTOR", "Tangent": "VECTOR", index: "VALUE",
    }.items()  # fmt: skip
    assert {"Alpha", "Coverage"} <= sockets.keys()
    layer.lisle.use_pass_tangent = False
    assert "Tangent" not in {socket.name for socket in node.outputs if socket.enabled}


def test_view_layers_show_their_own_collections(lisle, tmp_path):
    import bpy

    scene = bpy.context.scene
    upper, lower = scenes.line(20, (-3, 2, 0), (3, 2, 0)), scenes.line(20, (-3, -2, 0), (3, -2, 0))
    for name, points in (("Upper", upper), ("Lower", lower)):
        obj = scenes.curves(name, points)
        collection = bpy.data.collections.new(name)
        scene.collection.children.link(collection)
        collection.objects.link(obj)
        scene.collection.objects.unlink(obj)
    first = scene.view_layers[0]
    second = scene.view_layers.new("Second")
    second.use_pass_z = True
    first.layer_collection.children["Lower"].exclude = True
    second.layer_collection.children["Upper"].exclude = True
    channels = scenes.render_channels(tmp_path / "a.exr", multilayer=True)
    for layer, points in ((first, upper), (second, lower)):
        expected = np.zeros((48, 64))
        expected[dots(points)] = 1
        np.testing.assert_array_equal(channels[f"{layer.name}.Combined.A"], expected)
    assert "Second.Depth.Z" in channels and f"{first.name}.Depth.Z" not in channels


def test_settings_reach_the_renderer(lisle):
    import bpy

    scene = bpy.context.scene
    scenes.curves("Yarn", scenes.line())
    settings = scene.lisle
    settings.samples, settings.seed, settings.lod = 33, 5, 0.5
    settings.shading, settings.occlusion, settings.multiple_scattering = "simple", "table", False
    scene.render.resolution_percentage = 50
    bpy.ops.render.render()
    assert lisle.scenes[-1][1] == {
        "size": (32, 24), "samples": 33, "seed": 5, "lod_pixels": 0.5, "shading": "simple", "occlusion": "table",
        "region": None, "transparent": True, "filter": "blackman-harris", "filter_width": 1.5, "noise_threshold": 0.0,
        "time_limit_s": None, "transport_photons": 0,
    }  # fmt: skip


@pytest.mark.parametrize(("patience", "drawn"), [(0, 0), (1, 0), (2, 1)])
def test_cancelled_render_ends_quietly(addon, lisle, monkeypatch, patience, drawn):
    """It is asked after the scene and its rest shapes are read, and while it is drawn."""
    import bpy

    class Stopped:
        """The engine of a user who has pressed Escape; Blender's own methods cannot be replaced."""

        def __init__(self, engine):
            self.engine = engine

        def __getattr__(self, name):
            return getattr(self.engine, name)

        def test_break(self):
            nonlocal asked
            asked += 1
            return asked > patience

    asked, ends = 0, []

    def draw(engine, *args):
        try:
            return frame.draw(Stopped(engine), *args)
        except addon.core.errors.Cancelled:
            ends.append("cancelled")
            raise

    frame = addon.engine.frame
    scenes.curves("Yarn", scenes.line())
    monkeypatch.setattr(addon.engine.engine, "draw", draw)
    bpy.ops.render.render()
    assert ends == ["cancelled"] and len(lisle.scenes) == drawn and asked == patience + 1


def test_empty_scene_renders_an_empty_picture(lisle, tmp_path):
    assert not scenes.render_rgba(tmp_path / "a.exr").any()
