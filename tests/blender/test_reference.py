"""Final pictures by the path tracer."""

import time

import numpy as np
import pytest
import scenes
from impatience import stopping


def settings():
    import bpy

    return bpy.context.scene.lisle


@pytest.mark.blender
def test_its_settings_arrive(lisle):
    import bpy

    scenes.curves("Yarn", scenes.line())
    settings().method, settings().reference_samples, settings().reference_bounces = "REFERENCE", 7, 3
    settings().seed, settings().shading = 5, "simple"
    bpy.ops.render.render()
    _, given = lisle.scenes[-1]
    expected = {"samples": 7, "bounces": 3, "seed": 5, "shading": "simple", "transparent": True}
    assert given.items() >= expected.items() and "occlusion" not in given
    settings().reference_bounces = 0
    bpy.ops.render.render()
    assert lisle.scenes[-1][1]["bounces"] is None
    settings().method = "REAL_TIME"
    bpy.ops.render.render()
    assert "bounces" not in lisle.scenes[-1][1]


@pytest.mark.blender
@pytest.mark.parametrize("name", ["InputError", "DeviceError", "Error"])
def test_its_errors_stop_the_job(lisle, tmp_path, name):
    import bpy

    scenes.curves("Yarn", scenes.line())
    settings().method = "REFERENCE"
    lisle.fail["reference"] = getattr(lisle, name)("the fibers have too many points")
    scenes.use_exr(tmp_path / "a.exr")
    with pytest.raises(RuntimeError, match="Lisle: the fibers have too many points"):
        bpy.ops.render.render(write_still=True)
    assert list(tmp_path.iterdir()) == []


def lit_yarn():
    """A yarn across the picture, under a sun."""
    import bpy

    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy = 3
    settings().reference_samples = settings().samples = 4
    return scenes.curves("Yarn", scenes.line(30), radius=0.5)


@pytest.mark.blender("wheel")
def test_it_draws_what_the_renderer_draws(lisle, tmp_path):
    lit_yarn()
    settings().lod = 0
    ours = scenes.render_rgba(tmp_path / "a.exr")
    settings().method, settings().reference_bounces = "REFERENCE", 1
    single = scenes.render_rgba(tmp_path / "b.exr")
    np.testing.assert_allclose(single[..., 3].mean(), ours[..., 3].mean(), rtol=0.05)
    settings().reference_bounces = 0
    many = scenes.render_rgba(tmp_path / "c.exr")
    np.testing.assert_array_equal(many[..., 3], single[..., 3])
    assert many[20:28, :, :3].mean() == pytest.approx(ours[20:28, :, :3].mean(), rel=0.25)
    assert single[20:28, :, :3].mean() < 0.7 * many[20:28, :, :3].mean()


@pytest.mark.blender("wheel")
@pytest.mark.parametrize("method", ["REAL_TIME", "REFERENCE"])
def test_meshes_and_motion_blur_are_drawn_without_a_note(lisle, tmp_path, capfd, method):
    import bpy

    yarn = lit_yarn()
    settings().method, settings().motion_steps = method, 2
    settings().reference_samples = settings().samples = 16
    data = bpy.data.meshes.new("Plate")
    data.from_pydata([(0.5, -9, 1), (9, -9, 1), (9, 9, 1), (0.5, 9, 1)], [], [(0, 1, 2, 3)])
    scenes.link(bpy.data.objects.new("Plate", data))
    still = scenes.render_rgba(tmp_path / "still.exr")
    scenes.keyframes(yarn, "location", {1: (0, -1, 0), 3: (0, 1, 0)})
    bpy.context.scene.frame_set(2)
    bpy.context.scene.render.use_motion_blur, bpy.context.scene.render.motion_blur_shutter = True, 1.0
    blurred = scenes.render_rgba(tmp_path / "blurred.exr")
    said = "".join(capfd.readouterr())
    assert "path tracer" not in said and "not draw" not in said
    left, right = slice(10, 28), slice(44, 60)
    for picture in (still, blurred):
        assert (picture[:, right, 3] == 1).all(), "the plate"
    rows, still_rows = (picture[:, left, 3].mean(axis=1) for picture in (blurred, still))
    # As much yarn, over a way as long as its width: everywhere paler, and farther.
    assert rows.sum() == pytest.approx(still_rows.sum(), rel=0.1)
    assert (rows > 0.05).sum() > (still_rows > 0.05).sum() + 3
    assert still_rows.max() > 0.95 and rows[still_rows > 0.95].min() < 0.9


@pytest.mark.blender("wheel")
def test_borders_and_passes(lisle, tmp_path):
    import bpy

    lit_yarn()
    settings().method = "REFERENCE"
    layer, render = bpy.context.view_layer, bpy.context.scene.render
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_object_index = layer.lisle.use_pass_coverage = True
    whole = scenes.render_channels(tmp_path / "whole.exr", multilayer=True)
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.25, 0.75
    part = scenes.render_channels(tmp_path / "part.exr", multilayer=True)
    assert part.keys() == whole.keys() and len(part) >= 10
    for name, picture in part.items():
        np.testing.assert_array_equal(picture, whole[name][12:36, 16:48], err_msg=name)


@pytest.mark.blender("wheel")
def test_it_can_be_stopped_at_any_time(addon, lisle, tmp_path):
    """While fibers are made, while their hierarchy is built, and while it draws."""
    import bpy

    lit_yarn()
    settings().method = "REFERENCE"
    before = scenes.render_rgba(tmp_path / "a.exr")
    asked = []

    def stops_at(number):
        asked.clear()

        def test_break():
            asked.append(time.monotonic())
            return len(asked) >= number

        return stopping(addon, test_break)

    with stops_at(10**9):
        bpy.ops.render.render()
    assert len(asked) > 4, "fibers, hierarchy, and some samples"
    for number in (1, 2, 3, 4):
        with stops_at(number):
            bpy.ops.render.render()
        assert len(asked) == number, "it went on"
    np.testing.assert_array_equal(scenes.render_rgba(tmp_path / "b.exr"), before)
