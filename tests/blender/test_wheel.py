"""The extension with the real native module: whole pictures, from curves to pixels."""

import importlib.util
import inspect
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import scenes

HERE = Path(__file__).parent

pytestmark = pytest.mark.blender("wheel")


def lit_yarns(radius=0.4):
    """Two yarns side by side under a sun, in the test camera of 8 by 6 metres."""
    import bpy

    scenes.curves("Upper", scenes.line(40, (-5, 1, 0), (5, 1, 0)), radius=radius)
    scenes.curves("Lower", scenes.line(40, (-5, -1, 0), (5, -1, 0)), radius=radius)
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy, sun.rotation_euler = 3, (0.5, 0.3, 0)
    bpy.context.scene.lisle.samples = 2


def test_the_stand_in_has_the_real_signatures(addon, lisle):
    spec = importlib.util.spec_from_file_location("stand_in", HERE / "fake_lisle" / "lisle.py")
    stand_in = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(stand_in)
    for name in ("Error", "InputError", "DeviceError", "Cancelled"):
        assert issubclass(getattr(lisle, name), lisle.Error)
    for kind in ("Yarn", "Material"):
        real, fake = getattr(lisle, kind), getattr(stand_in, kind)
        assert set(inspect.signature(real).parameters) == set(fake.FIELDS)
        assert set(real.presets()) == set(fake.PRESETS)
    for path in ("Camera", "Scene", "Scene.add", "Renderer.render"):
        real, fake = lisle, stand_in
        for name in path.split("."):
            real, fake = getattr(real, name), getattr(fake, name)
        fake_names = {n for n, p in inspect.signature(fake).parameters.items() if p.kind != p.VAR_KEYWORD}
        assert fake_names - {"what"} <= set(inspect.signature(real).parameters), path


def test_yarn_covers_what_it_should(lisle, tmp_path):
    lit_yarns()
    picture = scenes.render_rgba(tmp_path / "a.exr")
    assert np.isfinite(picture).all()
    rows = (3 - (np.arange(48) + 0.5) / 8)[:, None] * np.ones(64)
    core = np.abs(np.abs(rows) - 1) < 0.2
    outside = np.abs(np.abs(rows) - 1) > 0.9
    assert picture[core, 3].mean() > 0.95 and picture[core, :3].mean() > 0.02
    assert picture[outside, 3].mean() < 0.05


def test_passes_are_in_world_space(lisle, tmp_path):
    import bpy

    lit_yarns()
    bpy.data.objects["Upper"].pass_index, bpy.data.objects["Lower"].pass_index = 3, 5
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_object_index = True
    layer.lisle.use_pass_tangent = layer.lisle.use_pass_coverage = True
    channels = scenes.render_channels(tmp_path / "a.exr", multilayer=True)
    channels = {name.partition(".")[2]: picture for name, picture in channels.items()}
    rows = (3 - (np.arange(48) + 0.5) / 8)[:, None] * np.ones(64)
    index = channels["Object Index.X" if bpy.app.version >= (5, 0, 0) else "IndexOB.X"]
    for centre, number in ((1, 3), (-1, 5)):
        core = np.abs(rows - centre) < 0.15
        assert (index[core] == number).mean() > 0.95
        # The camera is 10 m up, the yarn's upper side 0.4 m.
        assert np.median(channels["Depth.Z"][core]) == pytest.approx(9.6, abs=0.15)
        assert channels["Normal.Z"][core].mean() > 0.5
        assert np.abs(channels["Tangent.X"][core]).mean() > 0.5
    np.testing.assert_array_equal(channels["Coverage.A"], channels["Combined.A"])
    assert channels["Depth.Z"][0, 0] == pytest.approx(1e10) and index[0, 0] == 0


def test_twice_the_light_is_twice_the_picture(lisle, tmp_path):
    import bpy

    lit_yarns()
    once = scenes.render_rgba(tmp_path / "a.exr")
    bpy.data.lights["Sun"].energy *= 2
    twice = scenes.render_rgba(tmp_path / "b.exr")
    np.testing.assert_allclose(twice[..., :3], 2 * once[..., :3], rtol=1e-3, atol=1e-5)
    assert once[..., :3].max() > 0.05


def test_ambient_light_alone(lisle, tmp_path):
    import bpy

    lit_yarns()
    bpy.data.objects.remove(bpy.data.objects["Sun"])
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.color = (0.5, 0.5, 0.5)
    else:
        world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.5, 0.5, 1)
    first, second = (scenes.render_rgba(tmp_path / f"{name}.exr") for name in "ab")
    np.testing.assert_array_equal(first, second)
    assert first[..., :3].max() > 0.05


def test_no_light_at_all_is_a_dark_picture(lisle, tmp_path):
    import bpy

    lit_yarns()
    bpy.data.objects.remove(bpy.data.objects["Sun"])
    picture = scenes.render_rgba(tmp_path / "a.exr")
    assert picture[..., 3].max() > 0.9 and not picture[..., :3].any()


@pytest.mark.parametrize("crop", [False, True])
def test_border_is_a_part_of_the_whole_picture(lisle, tmp_path, crop):
    import bpy

    lit_yarns()
    whole = scenes.render_rgba(tmp_path / "whole.exr")
    render = bpy.context.scene.render
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_max_x = 0.25, 0.75
    render.border_min_y, render.border_max_y = 0.5, 0.875
    part = scenes.render_rgba(tmp_path / "part.exr")
    rows, columns = slice(6, 24), slice(16, 48)
    assert whole[rows, columns, 3].max() > 0.9
    # Pixel positions are rounded relative to the part's corner: equal up to single precision, not bit by bit.
    np.testing.assert_allclose(part if crop else part[rows, columns], whole[rows, columns], rtol=1e-4, atol=1e-4)
    if not crop:
        part[rows, columns] = 0
        assert not part.any()


def test_bad_points_are_an_error_with_the_objects_name(lisle, tmp_path):
    import bpy

    points = scenes.line()
    points[4] = np.nan
    scenes.curves("Torn", points)
    scenes.use_exr(tmp_path / "a.exr")
    with pytest.raises(RuntimeError, match="Torn"):
        bpy.ops.render.render(write_still=True)
    assert not list(tmp_path.iterdir())


def test_every_curve_type_renders(lisle, tmp_path):
    points = [(-3, 0, 0), (-1, 1, 0), (1, -1, 0), (3, 0, 0)]
    lit_yarns()
    for kind in ("POLY", "BEZIER", "NURBS"):
        for closed in (False, True):
            scenes.legacy(f"{kind} {closed}", kind, points, closed, bevel_depth=0.2)
    assert scenes.render_rgba(tmp_path / "a.exr")[..., 3].mean() > 0.3


ALONE = """
import importlib.util, os, sys
import bpy
sys.path.insert(0, {here!r})
import conftest, scenes
conftest._load_package("lisle_blender", conftest.REPOSITORY / "addon").register()
bpy.ops.wm.open_mainfile(filepath={blend!r})
bpy.context.scene.frame_set(5)
scenes.use_exr({picture!r})
bpy.ops.render.render(write_still=True)
sys.stdout.flush()
os._exit(0)
"""


def test_a_frame_alone_in_another_process_is_bit_identical(lisle, tmp_path):
    import bpy
    import exr
    from test_rest import frame_channels, stretching

    lit_yarns()
    # Not between two rows of pixels, where a yarn as thin as one of them is seldom met by few samples.
    stretching(y=0.05)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    in_sequence = frame_channels(tmp_path, range(1, 6))
    script = ALONE.format(here=str(HERE), blend=str(tmp_path / "scene.blend"), picture=str(tmp_path / "alone.exr"))
    environment = {name: value for name, value in os.environ.items() if not name.startswith("LISLE_TEST")}
    subprocess.run([sys.executable, "-c", script], check=True, env=environment, timeout=200)
    alone = exr.read_exr(tmp_path / "alone.exr")
    assert alone["A"].max() == 1
    for name, picture in alone.items():
        np.testing.assert_array_equal(picture, in_sequence[5][name])
    assert not np.array_equal(in_sequence[5]["R"], in_sequence[2]["R"])


def test_usd_animation(lisle, data, tmp_path):
    import bpy
    import exr

    bpy.ops.wm.usd_import(filepath=str(data / "animated" / "yarn_stock_stretchX.usdc"))
    scene = bpy.context.scene
    scene.camera.data.ortho_scale = 0.1
    scene.lisle.samples = 1
    scene.frame_start, scene.frame_end, scene.frame_step = 1, 21, 10
    lit = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    lit.rotation_euler.x = 0.5
    scenes.use_exr(tmp_path / "f_")
    bpy.ops.render.render(animation=True)
    pictures = [exr.read_exr(tmp_path / f"f_{frame:04}.exr") for frame in (1, 11, 21)]
    for picture in pictures:
        assert 0.5 < picture["A"].mean() <= 1 and picture["R"].mean() > 0.01
    assert not np.array_equal(pictures[0]["R"], pictures[2]["R"])


def test_fixed_threads_of_the_scene_count(lisle):
    import bpy

    lit_yarns()
    render = bpy.context.scene.render
    render.threads_mode, render.threads = "FIXED", 1
    bpy.ops.render.render()
    assert lisle.threads() == 1
