import lisle
import numpy as np
import pytest
from conftest import line


def test_arrays_have_the_promised_shapes_and_types():
    yarns = lisle.Yarns(np.vstack([line(4), line(6) + 1]), [0, 4, 10], closed=[False, True], yarn_radius=0.02)
    for name, dtype, shape in [
        ("points", np.float32, (10, 3)),
        ("rest_points", np.float32, (10, 3)),
        ("offsets", np.uint32, (3,)),
        ("closed", np.bool_, (2,)),
        ("basis", np.uint8, (2,)),
        ("radii", np.float32, (10,)),
        ("length_coordinates", np.float32, (10,)),
    ]:
        array = getattr(yarns, name)
        assert (array.dtype, array.shape) == (dtype, shape), name
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    assert len(yarns) == 2
    assert yarns.closed.tolist() == [False, True]


def test_length_coordinates_run_along_each_curve():
    yarns = lisle.Yarns(np.vstack([line(4), line(6)]), [0, 4, 10], basis="linear", yarn_radius=0.02)
    expected = np.concatenate([0.1 * np.arange(4), 0.1 * np.arange(6)])
    np.testing.assert_allclose(yarns.length_coordinates, expected, atol=1e-6)
    assert yarns.length == pytest.approx(0.8, rel=1e-6)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32])
def test_points_of_any_number_type_and_layout_are_taken(dtype):
    points = (10 * line()).astype(dtype)
    for layout in (points, np.asfortranarray(points), np.repeat(points, 2, axis=0)[::2], points.tolist()):
        yarns = lisle.Yarns(layout, [0, 5], yarn_radius=0.1)
        np.testing.assert_array_equal(yarns.points, points.astype(np.float32))


def test_moving_keeps_what_belongs_to_the_rest_shape():
    yarns = lisle.Yarns(line(), [0, 5], yarn_radius=0.02, name="cuff")
    moved = yarns.with_points(3 * yarns.points + 1)
    np.testing.assert_array_equal(moved.points, 3 * yarns.points + 1)
    np.testing.assert_array_equal(moved.rest_points, yarns.points)
    np.testing.assert_array_equal(moved.length_coordinates, yarns.length_coordinates)
    np.testing.assert_array_equal(moved.radii, yarns.radii)
    assert moved.name == "cuff"


def test_given_length_coordinates_are_kept():
    lengths = np.array([5, 6, 7.5, 8, 9], np.float32)
    yarns = lisle.Yarns(line(), [0, 5], yarn_radius=0.02, length_coordinates=lengths)
    np.testing.assert_array_equal(yarns.length_coordinates, lengths)


def test_bases_by_name_and_by_code():
    points = np.vstack([line(7), line(7) + 1, line(7) + 2, line(7) + 3, line(7) + 4])
    points[1::2, 1] += 0.05
    yarns = lisle.Yarns(points, np.arange(0, 36, 7), basis=np.array([0, 1, 2, 3, 4], np.uint8), yarn_radius=0.02)
    assert yarns.basis.tolist() == [0, 1, 2, 3, 4]
    for code, name in enumerate(["catmull-rom", "linear", "bezier", "nurbs", "b-spline"]):
        assert lisle.Yarns(points[:14], [0, 7, 14], basis=name, yarn_radius=0.02).basis.tolist() == [code, code]


def test_nurbs_of_order_two_is_a_polyline_and_weights_count():
    points = line(5)
    points[2, 1] = 0.3
    polyline = lisle.Yarns(points, [0, 5], basis="linear", yarn_radius=0.02)
    straight = lisle.Yarns(points, [0, 5], basis="nurbs", nurbs_order=2, nurbs_knots_mode=1, yarn_radius=0.02)
    assert straight.length == pytest.approx(polyline.length, rel=1e-5)
    pulled, loose = (
        lisle.Yarns(
            points, [0, 5], basis="nurbs", nurbs_order=3, nurbs_knots_mode=1, nurbs_weights=[1, 1, w, 1, 1],
            yarn_radius=0.02,
        ).length
        for w in (50, 1)
    )  # fmt: skip
    assert loose < pulled < polyline.length + 1e-6


NAN = np.where(np.arange(15).reshape(5, 3) == 7, np.nan, line())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (dict(points=NAN, offsets=[0, 5]), ["curve 0", "point 2", "finite"]),
        (dict(points=line() + np.inf, offsets=[0, 5]), ["curve 0", "point 0", "finite"]),
        (dict(points=line(), offsets=[0, 1, 5]), ["curve 0", "1 points"]),
        (dict(points=line(), offsets=[0, 5, 5]), ["curve 1", "0 points"]),
        (dict(points=np.zeros((5, 3)), offsets=[0, 5]), ["curve 0", "coincide"]),
        (dict(points=line(), offsets=[0, 4]), ["offsets", "entry 1"]),
        (dict(points=line(), offsets=[0, -5]), ["offsets", "entry 1 is -5"]),
        (dict(points=line(), offsets=[0, 2.5]), ["offsets", "whole numbers"]),
        (dict(points=line(), offsets=[]), ["no curves"]),
        (dict(points=line()[:, :2], offsets=[0, 5]), ["points", "(n, 3)"]),
        (dict(points=line().ravel(), offsets=[0, 5]), ["points", "(n, 3)"]),
        (dict(points="five", offsets=[0, 5]), ["points"]),
        (dict(points=line(), offsets=[0, 5], radii=[1, 1, -1, 1, 1]), ["curve 0", "point 2", "radius -1"]),
        (dict(points=line(), offsets=[0, 5], radii=[1, 1]), ["radii", "2 entries", "expected 5"]),
        (dict(points=line(), offsets=[0, 5], yarn_radius=0), ["radius 0"]),
        (dict(points=line(), offsets=[0, 5], yarn_radius=np.nan), ["radius NaN"]),
        (dict(points=line(), offsets=[0, 5], closed=[True, False]), ["closed", "2 entries"]),
        (dict(points=line(), offsets=[0, 5], basis="spline"), ["basis", "spline", "catmull-rom"]),
        (dict(points=line(), offsets=[0, 5], basis=[9]), ["curve 0", "basis 9"]),
        (dict(points=line(), offsets=[0, 5], basis="bezier"), ["curve 0", "5 points"]),
        (dict(points=line(), offsets=[0, 5], basis="nurbs", nurbs_order=99), ["curve 0", "order, 99"]),
        (dict(points=line(), offsets=[0, 5], basis="nurbs", nurbs_weights=[1]), ["nurbs_weights", "expected 5"]),
        (dict(points=line(), offsets=[0, 5], basis="nurbs", nurbs_knots_mode=7), ["curve 0", "nurbs_knots_mode 7"]),
        (dict(points=line(), offsets=[0, 5], length_coordinates=[0, 1, 2, 1, 4]), ["curve 0", "point 3"]),
    ],
)
def test_bad_input_is_named(arguments, words):
    with pytest.raises(lisle.InputError) as caught:
        lisle.Yarns(**arguments, name="left cuff")
    assert isinstance(caught.value, ValueError)
    for word in ["left cuff", *words]:
        assert word in str(caught.value)


def test_a_frame_with_other_points_is_refused():
    yarns = lisle.Yarns(line(), [0, 5], yarn_radius=0.02, name="cuff")
    with pytest.raises(lisle.InputError, match=r"cuff: curve 0, point 5: .*6 in this frame, 5 in the rest shape"):
        yarns.with_points(line(6))
    with pytest.raises(lisle.InputError, match=r"cuff: curve 0, point 2"):
        yarns.with_points(NAN)


def test_ten_million_points_are_taken():
    points = np.zeros((10_000_000, 3), np.float32)
    points[:, 0] = np.arange(len(points)) % 1000
    points[:, 1] = np.arange(len(points)) // 1000
    yarns = lisle.Yarns(points, np.arange(0, len(points) + 1, 1000), yarn_radius=0.2)
    assert yarns.length == pytest.approx(999 * 10_000, rel=1e-6)
