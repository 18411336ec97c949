"""An error anywhere must stop the job with a message: no crash, no blank frame on disk."""

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender


def break_native_yarns(addon, lisle):
    lisle.fail["Yarns"] = lisle.InputError("curve 3 of 'Yarn' is broken")
    return "curve 3 of 'Yarn' is broken"


def break_native_render(addon, lisle):
    lisle.fail["render"] = lisle.DeviceError("the GPU was lost")
    return "the GPU was lost"


def break_export(addon, lisle):
    def collect(*_args, **_options):
        raise ZeroDivisionError("a bug")

    addon.engine.frame.collect = collect
    return "ZeroDivisionError: a bug"


def break_system_exit(addon, lisle):
    lisle.fail["render"] = SystemExit(3)
    return "SystemExit"


def break_pass_size(addon, lisle):
    render = lisle.Renderer.render

    def too_small(self, *args, **options):
        image = render(self, *args, **options)
        return type(image)((name, picture[:-1]) for name, picture in image.items())

    lisle.Renderer.render = too_small
    return "picture of shape"


def break_pass_name(addon, lisle):
    passes = addon.engine.passes
    passes.PASSES += (passes.Pass("Unknown", "X", "VALUE", "nowhere"),)
    return "nowhere"


def break_camera(addon, lisle):
    import bpy

    bpy.context.scene.camera.data.type = "PANO"
    return "of type PANO"


def break_points(addon, lisle):
    import bpy

    points = scenes.line()
    points[4] = np.nan
    bpy.data.objects["Yarn"].data.position_data.foreach_set("vector", points.ravel())
    return "point 4 is not finite"


def break_yarn(addon, lisle):
    import bpy

    def refuse(self, **values):
        raise lisle.InputError("yarn parameter `ply_twist` is 0")

    lisle.Yarn.replace = refuse
    material = bpy.data.materials.new("Wool")
    bpy.data.objects["Yarn"].data.materials.append(material)
    material.lisle.yarn.customize = True
    return "object 'Yarn': material 'Wool': yarn parameter `ply_twist` is 0"


BREAKS = [value for name, value in sorted(globals().items()) if name.startswith("break_")]


@pytest.mark.parametrize("break_it", BREAKS, ids=lambda function: function.__name__)
@pytest.mark.parametrize("multilayer", [False, True], ids=["plain", "multilayer"])
def test_a_failing_still_raises_and_saves_nothing(addon, lisle, tmp_path, break_it, multilayer):
    import bpy

    scenes.curves("Yarn", scenes.line())
    words = break_it(addon, lisle)
    scenes.use_exr(tmp_path / "a.exr", multilayer)
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.render.render(write_still=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("break_it", BREAKS, ids=lambda function: function.__name__)
def test_a_failing_frame_stops_the_animation(addon, lisle, tmp_path, break_it):
    import bpy

    scenes.curves("Yarn", scenes.line())
    scenes.use_exr(tmp_path / "f_")
    words = []

    def break_third_frame(scene, *_):
        if scene.frame_current == 3 and not words:
            words.append(break_it(addon, lisle))

    bpy.app.handlers.render_pre.append(break_third_frame)
    with pytest.raises(RuntimeError) as raised:
        bpy.ops.render.render(animation=True)
    assert words[0] in str(raised.value)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["f_0001.exr", "f_0002.exr"]


def test_after_an_error_the_next_render_is_right(addon, lisle, tmp_path):
    import bpy

    scenes.curves("Yarn", scenes.line())
    before = scenes.render_rgba(tmp_path / "a.exr")
    break_native_render(addon, lisle)
    with pytest.raises(RuntimeError):
        bpy.ops.render.render()
    lisle.fail.clear()
    np.testing.assert_array_equal(scenes.render_rgba(tmp_path / "b.exr"), before)


def test_a_lost_device_gets_a_new_renderer(addon, lisle):
    import bpy

    scenes.curves("Yarn", scenes.line())
    bpy.ops.render.render()
    old = addon.engine.renderer.renderer(lisle)
    break_native_render(addon, lisle)
    with pytest.raises(RuntimeError):
        bpy.ops.render.render()
    lisle.fail.clear()
    bpy.ops.render.render()
    assert addon.engine.renderer.renderer(lisle) is not old


def test_no_camera_is_an_error_of_blender_or_ours(lisle):
    import bpy

    scenes.curves("Yarn", scenes.line())
    bpy.context.scene.camera = None
    with pytest.raises(RuntimeError, match=r"[Cc]amera"):
        bpy.ops.render.render()


def test_one_failing_layer_of_two_saves_nothing(addon, lisle, tmp_path):
    import bpy

    scenes.curves("Yarn", scenes.line())
    bpy.context.scene.view_layers.new("Second")
    draw = addon.engine.engine.draw

    def fail_second(engine, depsgraph, *args):
        if depsgraph.view_layer.name == "Second":
            raise ValueError("second layer")
        return draw(engine, depsgraph, *args)

    addon.engine.engine.draw = fail_second
    scenes.use_exr(tmp_path / "a.exr", multilayer=True)
    with pytest.raises(RuntimeError, match="second layer"):
        bpy.ops.render.render(write_still=True)
    assert list(tmp_path.iterdir()) == []
