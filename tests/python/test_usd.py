"""USD stages, made here with usd-core; expected shapes come from the definition of the bases, not from the reader."""

import lisle
import numpy as np
import pytest
from conftest import line

Usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
from pxr import Gf, UsdGeom, Vt  # noqa: E402

WAVE = np.column_stack([np.arange(7.0), [0, 1, 0, -1, 0, 1, 0], [0, 0, 1, 1, 0, 0, 2]])

MATRICES = {
    "catmullRom": np.array([[-1, 3, -3, 1], [2, -5, 4, -1], [-1, 0, 1, 0], [0, 2, 0, 0]]) / 2,
    "bspline": np.array([[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 0, 3, 0], [1, 4, 1, 0]]) / 6,
    "bezier": np.array([[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 3, 0, 0], [1, 0, 0, 0]]),
}


@pytest.fixture
def stage(tmp_path):
    stage = Usd.Stage.CreateNew(str(tmp_path / "cloth.usda"))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    return stage


def add_curves(stage, path, *curves, kind="cubic", basis="catmullRom", wrap="pinned", widths=0.2, interpolation=None):
    prim = UsdGeom.BasisCurves.Define(stage, path)
    prim.CreateTypeAttr(kind)
    prim.CreateBasisAttr(basis)
    prim.CreateWrapAttr(wrap)
    prim.CreateCurveVertexCountsAttr([len(curve) for curve in curves])
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.vstack(curves).astype(np.float32)))
    if widths is not None:
        prim.CreateWidthsAttr([float(width) for width in np.atleast_1d(widths)])
        prim.SetWidthsInterpolation(interpolation or ("constant" if np.ndim(widths) == 0 else "vertex"))
    return prim


def load(stage, **options):
    stage.Save()
    return lisle.load(stage.GetRootLayer().realPath, **options)


def segment_windows(count, basis, wrap):
    """Control points of every segment; -1 and `count` are the phantom points of pinned curves."""
    if basis == "bezier":
        starts = range(0, count if wrap == "periodic" else count - 1, 3)
    elif wrap == "periodic":
        starts = range(-1, count - 1)
    elif wrap == "pinned":
        starts = range(-1, count - 2)
    else:
        starts = range(count - 3)
    return [[start + k for k in range(4)] for start in starts]


def expected_segments(points, basis, wrap):
    """(segments, 9, 3): samples of the curve, by the basis matrix."""
    count = len(points)

    def point(index):
        if wrap == "periodic":
            return points[index % count]
        if index == -1:
            return 2 * points[0] - points[1]
        if index == count:
            return 2 * points[-1] - points[-2]
        return points[index]

    powers = np.linspace(0, 1, 9)[:, None] ** np.array([3, 2, 1, 0])
    return np.array(
        [
            powers @ MATRICES[basis] @ np.array([point(i) for i in window])
            for window in segment_windows(count, basis, wrap)
        ]
    )


def shape_of(yarns, curve=0):
    """The same samples of a loaded curve, by the basis that it was given."""
    basis = {0: "catmullRom", 2: "bezier", 4: "bspline"}[int(yarns.basis[curve])]
    start, end = yarns.offsets[curve : curve + 2]
    wrap = "periodic" if yarns.closed[curve] else "pinned" if basis == "catmullRom" else "nonperiodic"
    points, radii = yarns.points[start:end].astype(float), yarns.radii[start:end].astype(float)
    return expected_segments(points, basis, wrap), expected_segments(radii[:, None], basis, wrap)[..., 0]


@pytest.mark.parametrize("wrap", ["nonperiodic", "periodic", "pinned"])
@pytest.mark.parametrize("basis", ["catmullRom", "bspline", "bezier"])
def test_cubic_curves_keep_their_shape(stage, basis, wrap):
    points = WAVE[:6] if (basis, wrap) == ("bezier", "periodic") else WAVE
    add_curves(stage, "/Yarns", points, basis=basis, wrap=wrap)
    yarns = load(stage)
    shape, radii = shape_of(yarns)
    np.testing.assert_allclose(shape, expected_segments(points, basis, wrap), atol=1e-5)
    np.testing.assert_allclose(radii, 0.1, atol=1e-6)


def test_the_comparison_of_shapes_can_fail(stage):
    add_curves(stage, "/Yarns", WAVE, basis="bspline", wrap="pinned")
    shape, _ = shape_of(load(stage))
    assert not np.allclose(shape, expected_segments(WAVE, "catmullRom", "pinned"), atol=1e-2)
    assert shape.shape != expected_segments(WAVE, "bspline", "nonperiodic").shape


@pytest.mark.parametrize("wrap", ["nonperiodic", "periodic", "pinned"])
def test_linear_curves(stage, wrap):
    add_curves(stage, "/Yarns", WAVE, kind="linear", wrap=wrap)
    yarns = load(stage)
    assert yarns.basis.tolist() == [1]
    assert yarns.closed.tolist() == [wrap == "periodic"]
    np.testing.assert_array_equal(yarns.points, WAVE.astype(np.float32))


@pytest.mark.parametrize("wrap", ["nonperiodic", "periodic", "pinned"])
@pytest.mark.parametrize("basis", ["catmullRom", "bspline", "bezier"])
@pytest.mark.parametrize("interpolation", ["varying", "faceVarying", "vertex", "uniform", "constant"])
def test_widths_are_diameters_of_every_interpolation(stage, basis, wrap, interpolation):
    points = WAVE[:6] if (basis, wrap) == ("bezier", "periodic") else WAVE
    curves = [points, points + [0, 0, 9]]
    segments = len(segment_windows(len(points), basis, wrap))
    ends = segments if wrap == "periodic" else segments + 1
    count = {"constant": 1, "uniform": 2, "vertex": 2 * len(points)}.get(interpolation, 2 * ends)
    widths = 1 + np.arange(count) % 5 + 0.1 * np.arange(count)
    add_curves(stage, "/Yarns", *curves, basis=basis, wrap=wrap, widths=widths, interpolation=interpolation)
    yarns = load(stage)
    for curve in range(2):
        _, radii = shape_of(yarns, curve)
        if interpolation in ("constant", "uniform"):
            expected = np.full_like(radii, 0.5 * widths[min(curve, count - 1)])
        elif interpolation == "vertex":
            expected = 0.5 * expected_segments(widths.reshape(2, -1)[curve][:, None], basis, wrap)[..., 0]
        elif basis == "catmullRom" and wrap != "nonperiodic":
            # Ours go through the widths smoothly: they agree at the ends of the segments.
            own = 0.5 * widths.reshape(2, -1)[curve]
            own = np.append(own, own[0]) if wrap == "periodic" else own
            radii, expected = radii[:, [0, -1]], np.column_stack([own[:-1], own[1:]])
        else:
            own = 0.5 * widths.reshape(2, -1)[curve]
            own = np.append(own, own[0]) if wrap == "periodic" else own
            t = np.linspace(0, 1, 9)
            expected = own[:-1, None] * (1 - t) + own[1:, None] * t
        np.testing.assert_allclose(radii, expected, rtol=1e-5)


def test_without_widths_the_radius_is_estimated_or_given(stage):
    add_curves(stage, "/Yarns", WAVE, WAVE + [0, 0, 0.5], widths=None)
    assert load(stage).radii[0] > 0
    np.testing.assert_array_equal(load(stage, yarn_radius=0.25).radii, np.full(14, 0.25, np.float32))


def test_transforms_units_and_up_axis(stage):
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    UsdGeom.Xform.Define(stage, "/World").AddTranslateOp().Set(Gf.Vec3d(100, 0, 0))
    UsdGeom.Xform.Define(stage, "/World/Arm").AddRotateZOp().Set(90)
    add_curves(stage, "/World/Arm/Yarns", WAVE).AddScaleOp().Set(Gf.Vec3f(2, 2, 2))
    yarns = load(stage)
    # Scaled, turned about Z, moved along X; centimetres; (x, y, z) → (x, −z, y).
    x, y, z = 2 * WAVE.T
    expected = 0.01 * np.column_stack([100 - y, -z, x])
    np.testing.assert_allclose(yarns.points, expected, atol=1e-6)
    np.testing.assert_allclose(yarns.radii, 0.01 * 2 * 0.1, rtol=1e-6)


def test_instances_are_read_as_often_as_they_are_drawn(stage):
    stage.CreateClassPrim("/Ball")
    add_curves(stage, "/Ball/Yarns", WAVE)
    for index in range(3):
        prim = UsdGeom.Xform.Define(stage, f"/Copy{index}")
        prim.AddTranslateOp().Set(Gf.Vec3d(0, 10 * index, 0))
        prim.GetPrim().GetReferences().AddInternalReference("/Ball")
        prim.GetPrim().SetInstanceable(True)
    yarns = load(stage)
    np.testing.assert_allclose(yarns.points, np.vstack([WAVE, WAVE + [0, 10, 0], WAVE + [0, 20, 0]]), atol=1e-6)


def test_point_instancers_draw_their_prototypes_and_nothing_else(stage):
    UsdGeom.Xform.Define(stage, "/World").AddTranslateOp().Set(Gf.Vec3d(0, 0, 5))
    instancer = UsdGeom.PointInstancer.Define(stage, "/World/Many")
    UsdGeom.Xform.Define(stage, "/World/Many/Two").AddTranslateOp().Set(Gf.Vec3d(1, 0, 0))
    add_curves(stage, "/World/Many/One", WAVE)
    add_curves(stage, "/World/Many/Two/Yarns", WAVE)
    instancer.CreatePrototypesRel().SetTargets(["/World/Many/One", "/World/Many/Two"])
    instancer.CreateProtoIndicesAttr([1, 0, 0])
    instancer.CreatePositionsAttr([(0, 0, 0), (0, 10, 0), (0, 20, 0)])
    instancer.CreateInvisibleIdsAttr([1])
    yarns = load(stage)
    np.testing.assert_allclose(yarns.points, np.vstack([WAVE + [1, 0, 5], WAVE + [0, 20, 5]]), atol=1e-5)


def test_hidden_curves_and_those_for_other_purposes_are_left_out(stage):
    add_curves(stage, "/Drawn", WAVE)
    UsdGeom.Imageable(add_curves(stage, "/Rendered", WAVE + 50)).CreatePurposeAttr("render")
    UsdGeom.Imageable(add_curves(stage, "/Proxy", WAVE)).CreatePurposeAttr("proxy")
    UsdGeom.Imageable(add_curves(stage, "/Guide", WAVE)).CreatePurposeAttr("guide")
    UsdGeom.Xform.Define(stage, "/Hidden")
    add_curves(stage, "/Hidden/Yarns", WAVE)
    UsdGeom.Imageable(stage.GetPrimAtPath("/Hidden")).MakeInvisible()
    np.testing.assert_allclose(load(stage).points, np.vstack([WAVE, WAVE + 50]), atol=1e-5)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda prim: UsdGeom.Imageable(prim).MakeInvisible(), ["/Yarns is invisible"]),
        (lambda prim: UsdGeom.Imageable(prim).CreatePurposeAttr("proxy"), ["/Yarns has the purpose proxy"]),
        (lambda prim: prim.GetStage().RemovePrim("/Yarns"), ["no BasisCurves"]),
        (lambda prim: UsdGeom.BasisCurves(prim).GetBasisAttr().Set("hermite"), ["/Yarns", "hermite"]),
        (lambda prim: UsdGeom.BasisCurves(prim).GetTypeAttr().Set("quintic"), ["/Yarns", "quintic"]),
        (lambda prim: UsdGeom.BasisCurves(prim).GetWrapAttr().Set("segmented"), ["/Yarns", "segmented"]),
        (
            lambda prim: UsdGeom.BasisCurves(prim).GetBasisAttr().Set("bezier"),
            ["/Yarns: curve 1", "6 points", "3k + 1"],
        ),
        (lambda prim: UsdGeom.BasisCurves(prim).GetCurveVertexCountsAttr().Set([7, 7]), ["/Yarns", "14", "13 points"]),
        (
            lambda prim: UsdGeom.BasisCurves(prim).GetCurveVertexCountsAttr().Set([12, 1]),
            ["/Yarns: curve 1", "1 points"],
        ),
        (lambda prim: UsdGeom.BasisCurves(prim).GetPointsAttr().Clear(), ["/Yarns", "points"]),
        (lambda prim: UsdGeom.BasisCurves(prim).GetWidthsAttr().Set([1.0, 2.0, 3.0]), ["/Yarns", "3 widths"]),
        (lambda prim: UsdGeom.BasisCurves(prim).GetWidthsAttr().Set([-1.0]), ["/Yarns", "width 0 is -1"]),
    ],
)
def test_what_cannot_be_drawn_is_named(stage, change, words):
    change(add_curves(stage, "/Yarns", WAVE, WAVE[:6]).GetPrim())
    with pytest.raises(lisle.InputError) as caught:
        load(stage)
    for word in ["cloth.usda", *words]:
        assert word in str(caught.value)


def test_infinite_coordinates_are_named(stage):
    points = WAVE.copy()
    points[3, 1] = np.inf
    add_curves(stage, "/Yarns", WAVE, points)
    with pytest.raises(lisle.InputError, match=r"cloth.usda: curve 1, point 3"):
        load(stage)


def test_other_geometry_is_named(stage):
    UsdGeom.Mesh.Define(stage, "/Shirt")
    UsdGeom.Mesh.Define(stage, "/Hat")
    with pytest.raises(lisle.InputError, match="2 Mesh"):
        load(stage)


def test_a_broken_file_is_named(tmp_path):
    (tmp_path / "broken.usda").write_text("#usda 1.0\ndef {")
    with pytest.raises(lisle.InputError, match=r"broken\.usda"):
        lisle.load(tmp_path / "broken.usda")
    with pytest.raises(lisle.InputError, match=r"missing\.usdc.*no such file"):
        lisle.load(tmp_path / "missing.usdc")


@pytest.fixture
def animated(stage):
    """Moves along Z: 0 at frame 1, 2 at frame 3, and stretches, so that lengths would change."""
    prim = add_curves(stage, "/Yarns", WAVE)
    attribute = prim.GetPointsAttr()
    attribute.Clear()
    for frame, stretch in [(1, 1.0), (3, 2.0)]:
        moved = WAVE * [stretch, 1, 1] + [0, 0, frame - 1]
        attribute.Set(Vt.Vec3fArray.FromNumpy(moved.astype(np.float32)), frame)
    return stage


def test_time_samples(animated):
    at_rest = load(animated)
    np.testing.assert_allclose(at_rest.points, WAVE, atol=1e-6)
    between, last = load(animated, frame=2), load(animated, frame=3)
    np.testing.assert_allclose(between.points, WAVE * [1.5, 1, 1] + [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(last.points, WAVE * [2, 1, 1] + [0, 0, 2], atol=1e-6)
    for yarns in (between, last):
        np.testing.assert_array_equal(yarns.length_coordinates, at_rest.length_coordinates)
        np.testing.assert_array_equal(yarns.rest_points, at_rest.points)
    for frame in (0, 3.5, 60):
        with pytest.raises(lisle.InputError, match=f"frame {frame:g}.*1 to 3"):
            load(animated, frame=frame)


def test_animated_transforms(stage):
    prim = add_curves(stage, "/Yarns", WAVE)
    move = prim.AddTranslateOp()
    move.Set(Gf.Vec3d(0, 0, 0), 10)
    move.Set(Gf.Vec3d(0, 4, 0), 14)
    np.testing.assert_allclose(load(stage, frame=12).points, WAVE + [0, 2, 0], atol=1e-6)


def test_a_still_has_no_frames(stage):
    add_curves(stage, "/Yarns", WAVE)
    with pytest.raises(lisle.InputError, match=r"frame 1.*animated"):
        load(stage, frame=1)


def test_point_counts_that_change_are_named(stage):
    prim = add_curves(stage, "/Yarns", WAVE, WAVE)
    for frame, counts in [(1, [7, 7]), (2, [7, 6])]:
        prim.GetCurveVertexCountsAttr().Set(counts, frame)
        prim.GetPointsAttr().Set(
            Vt.Vec3fArray.FromNumpy(np.vstack([WAVE, WAVE])[: sum(counts)].astype(np.float32)), frame
        )
    with pytest.raises(lisle.InputError, match="curve 1 changes from 7 to 6 points by frame 2"):
        load(stage, frame=2)


def test_curves_that_appear_are_refused(stage):
    for path in ("/Yarns", "/More"):
        prim = add_curves(stage, path, WAVE)
        prim.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(WAVE.astype(np.float32)), 1)
        prim.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(WAVE.astype(np.float32)), 2)
    visibility = UsdGeom.Imageable(stage.GetPrimAtPath("/More")).CreateVisibilityAttr()
    visibility.Set("invisible", 1)
    visibility.Set("inherited", 2)
    with pytest.raises(lisle.InputError, match="prims or their numbers of curves change by frame 2"):
        load(stage, frame=2)


@pytest.mark.parametrize(
    ("name", "curves", "points"), [("yarn_stock_stretchX", 43, 25_757), ("yarn_satin_stretchX", 141, 25_845)]
)
def test_real_animations(data, name, curves, points):
    path = data / "animated" / f"{name}.usdc"
    at_rest, late = lisle.load(path), lisle.load(path, frame=25)
    assert (len(at_rest), len(at_rest.points)) == (curves, points)
    np.testing.assert_allclose(at_rest.radii, 1e-3, rtol=1e-6)
    assert np.abs(late.points - at_rest.points).max() > 0.01
    np.testing.assert_array_equal(late.length_coordinates, at_rest.length_coordinates)


def test_without_usd_core_the_message_says_so(monkeypatch, stage):
    add_curves(stage, "/Yarns", line(7))
    stage.Save()
    monkeypatch.setitem(__import__("sys").modules, "pxr", None)
    with pytest.raises(lisle.InputError, match="pip install usd-core"):
        lisle.load(stage.GetRootLayer().realPath)
