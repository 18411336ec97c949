"""Legacy curves of which the bevel's Start and End leave a part."""

import itertools

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender

POINTS = [(0, 0, 0), (1, 0, 0), (3, 0.5, 0), (3, 1, 0), (4, 1, 0)]
SHARES = [(0, 1), (0, 0.5), (0.3, 0.8), (0.8, 0.3), (0.95, 1), (0.26, 0.27)]


def bevelled(kind, closed=False, points=POINTS):
    obj = scenes.legacy("Yarn", "POLY" if kind == "POLY" else kind, points, closed, bevel_depth=0.01)
    obj.data.bevel_resolution, obj.data.resolution_u = 0, 64
    if kind == "BEZIER":
        for point in obj.data.splines[0].bezier_points:
            point.handle_left_type = point.handle_right_type = "AUTO"
    return obj


def shorten(obj, start, end, mapping="RESOLUTION"):
    data = obj.data
    data.bevel_factor_mapping_start = data.bevel_factor_mapping_end = mapping
    data.bevel_factor_start, data.bevel_factor_end = start, end


def tube_ends(obj):
    """Where the tube begins and ends that Blender makes."""
    import bpy

    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    rings = np.array([vertex.co for vertex in mesh.vertices]).reshape(-1, 4, 3).mean(axis=1)
    return rings[[0, -1]]


def drawn(lisle):
    import bpy

    bpy.ops.render.render()
    return [entry.yarns for entry in lisle.scenes[-1][0].entries]


@pytest.mark.parametrize("kind", ["POLY", "BEZIER"])
def test_yarn_is_as_long_as_blenders_tube(lisle, kind):
    obj = bevelled(kind)
    for mapping, (start, end) in itertools.product(("RESOLUTION", "SEGMENTS", "SPLINE"), SHARES):
        shorten(obj, start, end, mapping)
        (yarns,) = drawn(lisle)
        np.testing.assert_allclose(yarns.points[[0, -1]], tube_ends(obj), atol=2e-3, err_msg=f"{mapping} {start} {end}")


def test_a_part_of_a_bezier_curve_is_on_it(lisle):
    obj = bevelled("BEZIER")

    def on_curve(polygon):
        t = np.linspace(0, 1, 400)[:, None]
        pieces = [polygon[i : i + 4] for i in range(0, len(polygon) - 3, 3)]
        a = [
            (1 - t) ** 3 * p[0] + 3 * (1 - t) ** 2 * t * p[1] + 3 * (1 - t) * t**2 * p[2] + t**3 * p[3] for p in pieces
        ]
        return np.concatenate(a)

    (whole,) = drawn(lisle)
    shorten(obj, 0.1, 0.6)
    (part,) = drawn(lisle)
    assert len(part.points) < len(whole.points)
    far = np.linalg.norm(on_curve(part.points)[:, None] - on_curve(whole.points)[None], axis=2).min(axis=1)
    assert far.max() < 5e-3
    shorten(obj, 0.26, 0.27)  # within one segment
    (part,) = drawn(lisle)
    assert len(part.points) == 4


def test_closed_curves_are_whole_and_nurbs_are_noted(lisle):
    from test_guides import collected

    closed = bevelled("POLY", closed=True)
    shorten(closed, 0.2, 0.7)
    assert len(drawn(lisle)[0].points) == len(POINTS) and not collected(lisle)[1]
    scenes.add_spline(closed.data, "NURBS", POINTS)
    assert "do not shorten NURBS" in collected(lisle)[1][0]
    closed.data.bevel_depth = 0
    assert not collected(lisle)[1], "a line has no bevel to be shortened"


def test_nothing_is_left_of_what_ends_where_it_begins(lisle):
    obj = bevelled("POLY")
    scenes.add_spline(obj.data, "POLY", POINTS[:2], closed=False)
    for share in (0, 0.5, 1):
        shorten(obj, share, share)
        assert drawn(lisle) == []
    shorten(obj, 0, 0.25)
    assert drawn(lisle)[0].offsets.tolist() == [0, 2, 4]


def test_yarn_that_grows_keeps_its_fibers_and_its_lengths(lisle, capfd):
    """From nothing at the reference frame; moved by its points, too."""
    import bpy

    obj = bevelled("POLY", points=[(x, 0, 0) for x in range(5)])
    scene = bpy.context.scene
    scene.frame_end = 11
    for frame in (1, 11):
        obj.data.bevel_factor_end = (frame - 1) / 10
        obj.data.keyframe_insert("bevel_factor_end", frame=frame)
    lengths = []
    for frame in (1, 3, 6, 11):
        scene.frame_set(frame)
        entries = drawn(lisle)
        assert bool(entries) == (frame > 1)
        lengths.append(entries[0].length_coordinates[-1] if entries else 0)
        if entries:
            np.testing.assert_array_equal(entries[0].length_coordinates[:2], [0, min(lengths[-1], 1)])
    assert 0 == lengths[0] < lengths[1] < lengths[2] < lengths[3] == 4
    obj.data.animation_data_clear()
    shorten(obj, 0.375, 1)
    scene.frame_set(6)
    (yarns,) = drawn(lisle)
    np.testing.assert_allclose(yarns.length_coordinates, [1.5, 2, 3, 4])
    np.testing.assert_allclose(yarns.points[:, 0], [1.5, 2, 3, 4])
    assert "Traceback" not in capfd.readouterr().err


def test_growing_yarn_is_blurred_by_its_motion_alone(lisle):
    """All steps of the shutter show the same part."""
    import bpy
    from test_film import use_motion_blur

    obj = bevelled("BEZIER")
    scene = bpy.context.scene
    for frame, share in ((1, 0.1), (5, 0.9)):
        obj.data.bevel_factor_end = share
        obj.data.keyframe_insert("bevel_factor_end", frame=frame)
        obj.location.x = frame
        obj.keyframe_insert("location", frame=frame)
    scene.frame_set(3)
    use_motion_blur(1.0)
    bpy.ops.render.render()
    steps, _ = lisle.scenes[-1]
    points = [step.entries[0].yarns.points for step in steps]
    assert len({array.shape for array in points}) == 1
    assert len({float(step.entries[0].transform[0, 3]) for step in steps}) == len(steps)


@pytest.mark.blender("wheel")
def test_a_part_is_drawn_as_in_the_whole(lisle, tmp_path):
    """The same fibers at the same places, where a part is there."""
    import bpy

    obj = scenes.legacy("Yarn", "POLY", scenes.line(13).tolist(), bevel_depth=0.5)
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy = 3
    bpy.context.scene.lisle.samples = 16
    whole = scenes.render_rgba(tmp_path / "a.exr")
    for shares, empty, there in (
        ((0, 0.5), np.s_[:, 34:], np.s_[:, 10:28]),
        ((0.5, 1), np.s_[:, :30], np.s_[:, 36:54]),
    ):
        shorten(obj, *shares)
        part = scenes.render_rgba(tmp_path / "b.exr")
        assert not part[empty][..., 3].any() and whole[there][20:28, :, 3].mean() > 0.5
        assert np.abs(part[there] - whole[there]).mean() < 0.05 * np.abs(whole[there]).mean()
        assert np.abs(part[there] - whole[there][:, ::-1]).mean() > 0.1 * np.abs(whole[there]).mean()
