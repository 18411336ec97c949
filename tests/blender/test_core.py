"""The logic that needs no Blender."""

import math

import numpy as np
import pytest
from lisle_blender.core.camera import border_pixels, without_scale
from lisle_blender.core.curves import (
    BEZIER,
    CATMULL_ROM,
    CurveArrays,
    bezier_polygons,
    interpolate,
    polylines_of_wire,
)
from lisle_blender.core.lights import area_m2, unnormalized_factor
from lisle_blender.core.pixels import look_up, pass_rect, stable_id
from lisle_blender.core.threads import asked_for


def arrays(counts, **changes):
    offsets = np.cumsum([0, *counts]).astype(np.uint32)
    n, c = int(offsets[-1]), len(counts)
    values = {
        "points": np.arange(n * 3, dtype=np.float32).reshape(n, 3),
        "offsets": offsets,
        "closed": np.zeros(c, bool),
        "basis": np.zeros(c, np.uint8),
        "radii": np.full(n, 0.1, np.float32),
    }
    return CurveArrays(**values | changes)


def test_bezier_polygons_run_anchor_handle_handle_anchor():
    # One open Bézier of 3 anchors, a poly line of 2 points, one closed Bézier of 2 anchors.
    anchors = np.arange(7, dtype=np.float32)[:, None] * 10 * np.ones(3, np.float32)
    left, right = anchors - 1, anchors + 1
    offsets = np.array([0, 3, 5, 7], np.uint32)
    closed = np.array([False, False, True])
    is_bezier = np.array([True, False, True])
    points, new_offsets, between = bezier_polygons(anchors, left, right, offsets, closed, is_bezier)
    assert new_offsets.tolist() == [0, 7, 9, 15]
    assert points[:, 0].tolist() == [0, 1, 9, 10, 11, 19, 20, 30, 40, 50, 51, 59, 60, 61, 49]
    radii = interpolate(np.array([0, 3, 6, 1, 2, 0, 9], np.float32), between)
    np.testing.assert_allclose(radii, [0, 1, 2, 3, 4, 5, 6, 1, 2, 0, 3, 6, 9, 6, 3], atol=1e-6)


def test_bezier_polygon_of_a_single_point():
    one = np.zeros((1, 3), np.float32)
    points, offsets, _ = bezier_polygons(one, one, one, np.array([0, 1]), np.array([False]), np.array([True]))
    assert points.shape == (1, 3) and offsets.tolist() == [0, 1]


def test_wire_is_cut_into_polylines():
    # Vertices 0-3 open, 4-6 closed, 7-8 open.
    edges = np.array([(0, 1), (2, 1), (2, 3), (4, 5), (5, 6), (6, 4), (7, 8)])
    offsets, closed = polylines_of_wire(np.zeros((9, 3)), edges)
    assert offsets.tolist() == [0, 4, 7, 9]
    assert closed.tolist() == [False, True, False]


def test_digest_changes_with_every_array_and_not_with_materials():
    base = arrays([3, 4])
    assert base.digest() == arrays([3, 4]).digest()
    assert base.digest() == arrays([3, 4], material_index=np.array([0, 1])).digest()
    for change in (
        {"points": base.points + 1},
        {"offsets": np.array([0, 4, 7], np.uint32)},
        {"closed": np.array([True, False])},
        {"basis": np.array([0, 1], np.uint8)},
        {"radii": base.radii * 2},
        {"nurbs_order": np.array([4, 4], np.uint8)},
        {"nurbs_weights": base.radii},
        {"nurbs_knots_mode": np.array([0, 1], np.uint8)},
        {"length_coordinates": base.radii},
    ):
        assert arrays([3, 4], **change).digest() != base.digest(), change


def test_selecting_curves_keeps_their_points():
    chosen = arrays([3, 4, 2], length_coordinates=np.arange(9, dtype=np.float32)).select(np.array([True, False, True]))
    assert chosen.offsets.tolist() == [0, 3, 5]
    assert chosen.length_coordinates.tolist() == [0, 1, 2, 7, 8]
    assert chosen.points[:, 0].tolist() == [0, 3, 6, 21, 24]


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (arrays([3, 4, 2]), "2 curves, 3 at rest"),
        (arrays([3, 5]), "curve 1 has 4 points, 5 at rest"),
        (arrays([4, 3]), "curve 0 has 3 points, 4 at rest"),
        (arrays([3, 4], closed=np.array([False, True])), "cyclic setting of curve 1 differs"),
        (arrays([3, 4], basis=np.array([BEZIER, CATMULL_ROM], np.uint8)), "curve type of curve 0 differs"),
        (arrays([3, 4], nurbs_order=np.array([4, 4], np.uint8)), "NURBS order is set at one"),
    ],
)
def test_other_topology_than_at_rest_is_named(other, words):
    assert words in arrays([3, 4]).difference_from_rest(other)


def test_moved_points_are_no_difference():
    assert arrays([3, 4], points=np.ones((7, 3), np.float32)).difference_from_rest(arrays([3, 4])) is None


def test_at_rest_takes_points_and_lengths_from_rest_and_radii_from_now():
    rest = arrays([3], length_coordinates=np.arange(3, dtype=np.float32))
    now = arrays([3], points=rest.points + 5, radii=rest.radii * 2)
    mixed = now.at_rest(rest)
    assert (mixed.points == rest.points).all() and (mixed.radii == now.radii).all()
    assert mixed.length_coordinates is rest.length_coordinates


def test_pass_rect_turns_the_picture_upside_down():
    image = np.arange(2 * 3 * 4, dtype=np.float64).reshape(2, 3, 4)
    rect = pass_rect(image, 4, (3, 2))
    assert rect.dtype == np.float32 and rect.flags.c_contiguous and rect.shape == (24,)
    assert rect[:4].tolist() == image[1, 0].tolist()
    assert pass_rect(image[:, :, 0], 1, (3, 2)).tolist() == [12, 16, 20, 0, 4, 8]
    for wrong in ((2, 3), (3, 3)):
        with pytest.raises(ValueError, match="picture of shape"):
            pass_rect(image, 4, wrong)
    with pytest.raises(ValueError, match="picture of shape"):
        pass_rect(image, 3, (3, 2))


def test_border_is_cut_in_single_precision():
    assert border_pixels((0.25, 0.5, 0.75, 1.0), (100, 50)) == (25, 25, 75, 50)
    # Stored as floats, 103 / 336 × 336 is 102.999998 in double precision and 103 in single: Blender takes 103.
    border = [float(np.float32(edge)) for edge in (116 / 432, 13 / 336, 220 / 432, 103 / 336)]
    assert int(border[3] * 336) == 102
    assert border_pixels(border, (432, 336)) == (115, 13, 220, 103)


def test_scale_is_taken_out_of_a_matrix():
    matrix = np.diag([2.0, 3.0, -4.0, 1.0])
    matrix[:3, 3] = 1, 2, 3
    expected = np.diag([1.0, 1.0, -1.0, 1.0])
    expected[:3, 3] = 1, 2, 3
    assert (without_scale(matrix) == expected).all()
    assert np.isfinite(without_scale(np.zeros((4, 4)))).all()


def test_unnormalized_lights_are_what_cycles_makes_of_them():
    # Irradiance with 'Normalize' off over that with it on, measured with Cycles on a small white plane 2 m away.
    cycles = {"point": 0.0062460 / 0.1988183, "area": 0.0079511 / 0.7951054, "sun": 0.0235423 / 3.0000020}
    assert unnormalized_factor("POINT", radius_m=0.05) == pytest.approx(cycles["point"], rel=2e-3)
    assert unnormalized_factor("SPOT", radius_m=0.05) == pytest.approx(cycles["point"], rel=2e-3)
    assert unnormalized_factor("AREA", area_m2=area_m2((0.1, 0.1), False)) == pytest.approx(cycles["area"], rel=2e-3)
    assert unnormalized_factor("SUN", angle_rad=0.1) == pytest.approx(cycles["sun"], rel=2e-3)
    assert area_m2((2, 3), True) == pytest.approx(1.5 * math.pi)


def test_ids_are_looked_up_by_pixel():
    ids = np.array([[7, 0, 3], [4_000_000_000, 5, 3]], np.uint32)
    indices = look_up(ids, {3: 30, 7: 70, 4_000_000_000: 40})
    assert indices.dtype == np.float32 and indices.tolist() == [[70, 0, 30], [40, 0, 30]]
    assert not look_up(ids, {}).any()


def test_stable_ids_are_the_same_in_every_process():
    assert stable_id(("Yarn",), 3) == 6636771
    assert stable_id(("Yarn",), 4) != stable_id(("Yarn",), 3)


def test_threads_of_the_command_line():
    assert asked_for(["blender", "-b", "-t", "3", "scene.blend"]) == 3
    assert asked_for(["blender", "--threads", "12"]) == 12
    assert asked_for(["blender", "-b", "-t", "0"]) is None, "all"
    assert asked_for(["blender", "-b"]) is asked_for(["blender", "-t"]) is asked_for(["blender", "-t", "x"]) is None
    assert asked_for(["blender", "-b", "--python", "x.py", "--", "-t", "3"]) is None, "the script's own"
