"""Yarn curves from USD stages: every BasisCurves prim that a renderer would draw.

Needs `usd-core`, which is not a dependency: `pip install lisle[usd]`. Inside Blender, its own importer reads USD.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ._native import Yarns
from .errors import InputError

CATMULL_ROM, LINEAR, BEZIER, B_SPLINE = 0, 1, 2, 4

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class _Curve:
    """One curve in a basis that `Yarns` has."""

    points: Floats
    radii: Floats | None
    closed: bool
    basis: int


@dataclass(frozen=True)
class _PerCurve:
    """Widths or radii of one curve."""

    values: Floats
    at_segment_ends: bool
    """One per end of a segment ("varying"), otherwise one per control point."""


@dataclass(frozen=True)
class _Shape:
    """All curves of a stage at one time, in metres, Z up."""

    points: npt.NDArray[np.float32]
    offsets: npt.NDArray[np.uint32]
    closed: npt.NDArray[np.bool_]
    basis: npt.NDArray[np.uint8]
    radii: npt.NDArray[np.float32] | None
    paths: tuple[tuple[str, int], ...]
    """Prim and number of curves, in order."""


class Animation:
    """The yarn curves of a stage over time.

    Length coordinates and rest frames belong to the first time sample, whichever frame is asked for, so that a frame is
    the same alone and within a sequence.
    """

    def __init__(self, path: str | Path, yarn_radius: float | None = None) -> None:
        self._path = Path(path)
        self._stage = _open(self._path)
        self.frames = self._frames()
        """First and last time sample of the curves, in the stage's time codes; `None` for a still."""
        self._first = self._read(None if self.frames is None else self.frames[0])
        self.reference = Yarns(
            self._first.points,
            self._first.offsets,
            closed=self._first.closed,
            basis=self._first.basis,
            radii=self._first.radii if yarn_radius is None else None,
            yarn_radius=yarn_radius,
            name=self._path.name,
        )
        """The yarns at the first time sample."""

    def check(self, frame: float) -> None:
        """Raises an `InputError` unless the curves are animated and a frame lies within their time samples."""
        if self.frames is None:
            raise InputError(f"{self._path}: frame {frame:g} was asked for, but no curve in it is animated")
        first, last = self.frames
        if not first <= frame <= last:
            raise InputError(f"{self._path}: frame {frame:g} is outside of the time samples {first:g} to {last:g}")

    def at(self, frame: float) -> Yarns:
        """The yarns at a time code; between time samples they are interpolated."""
        self.check(frame)
        shape = self._read(frame)
        if shape.paths != self._first.paths or not np.array_equal(shape.offsets, self._first.offsets):
            raise InputError(f"{self._path}: {_topology_change(self._first, shape)} by frame {frame:g}")
        return self.reference.with_points(shape.points)

    def _frames(self) -> tuple[float, float] | None:
        from pxr import Usd, UsdGeom

        times: set[float] = set()
        for prim in self._stage.Traverse(Usd.TraverseInstanceProxies()):
            if prim.IsA(UsdGeom.BasisCurves):
                times.update(UsdGeom.BasisCurves(prim).GetPointsAttr().GetTimeSamples())
                ancestor = prim
                while ancestor:
                    if xformable := UsdGeom.Xformable(ancestor):
                        times.update(xformable.GetTimeSamples())
                    ancestor = ancestor.GetParent()
            elif prim.IsA(UsdGeom.PointInstancer):
                instancer = UsdGeom.PointInstancer(prim)
                for attribute in (
                    instancer.GetPositionsAttr(),
                    instancer.GetOrientationsAttr(),
                    instancer.GetScalesAttr(),
                ):
                    times.update(attribute.GetTimeSamples())
        return (min(times), max(times)) if times else None

    def _read(self, frame: float | None) -> _Shape:
        from pxr import Usd

        time = Usd.TimeCode.Default() if frame is None else Usd.TimeCode(frame)
        curves: list[_Curve] = []
        paths: list[tuple[str, int]] = []
        for path, found in _walk(self._path, self._stage, time):
            curves.extend(found)
            paths.append((path, len(found)))
        radii = [curve.radii for curve in curves if curve.radii is not None]
        return _Shape(
            points=np.concatenate([curve.points for curve in curves]).astype(np.float32),
            offsets=np.concatenate([[0], np.cumsum([len(curve.points) for curve in curves])]).astype(np.uint32),
            closed=np.array([curve.closed for curve in curves]),
            basis=np.array([curve.basis for curve in curves], np.uint8),
            # Curves without widths among others with them: all get the estimated radius.
            radii=np.concatenate(radii).astype(np.float32) if len(radii) == len(curves) else None,
            paths=tuple(paths),
        )


def _open(path: Path) -> Any:
    try:
        from pxr import Tf, Usd
    except ImportError:
        raise InputError(f"{path}: reading USD needs the package usd-core: pip install usd-core") from None
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        return Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        reason = str(error).strip().splitlines()[-1].strip()
        raise InputError(f"{path}: not readable as USD: {reason}") from None


def _topology_change(old: _Shape, new: _Shape) -> str:
    if old.paths != new.paths:
        return "the prims or their numbers of curves change"
    curve = int(np.argmax(np.diff(old.offsets) != np.diff(new.offsets)))
    before, after = (int(np.diff(shape.offsets)[curve]) for shape in (old, new))
    return f"curve {curve} changes from {before} to {after} points"


def _walk(path: Path, stage: Any, time: Any) -> Iterator[tuple[str, list[_Curve]]]:
    """Every drawn BasisCurves prim with its curves in metres, Z up."""
    from pxr import UsdGeom

    metres_from_stage = np.eye(4) * UsdGeom.GetStageMetersPerUnit(stage)
    metres_from_stage[3, 3] = 1.0
    if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y:
        metres_from_stage = metres_from_stage @ np.array(
            [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], dtype=np.float64
        )
    hidden: list[str] = []
    other: Counter[str] = Counter()
    drawn = 0
    for prim, world_from_prim in _prims(stage.GetPseudoRoot(), np.eye(4), time):
        if not prim.IsA(UsdGeom.BasisCurves):
            if prim.IsA(UsdGeom.Gprim):
                other[prim.GetTypeName()] += 1
            continue
        imageable = UsdGeom.Imageable(prim)
        if imageable.ComputeVisibility(time) == UsdGeom.Tokens.invisible:
            hidden.append(f"{prim.GetPath()} is invisible")
        elif (purpose := imageable.ComputePurpose()) in (UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide):
            hidden.append(f"{prim.GetPath()} has the purpose {purpose}")
        else:
            drawn += 1
            where = f"{path}: {prim.GetPath()}"
            yield str(prim.GetPath()), _curves(where, prim, time, metres_from_stage @ world_from_prim)
    if not drawn:
        reason = "; ".join(hidden) or ", ".join(f"{count} {kind}" for kind, count in other.items()) or "no geometry"
        raise InputError(f"{path}: no BasisCurves to draw: {reason}")


def _prims(root: Any, world_from_parent: Floats, time: Any) -> Iterator[tuple[Any, Floats]]:
    """Prims below a root with their transforms; instances as often as they are drawn, prototypes not."""
    from pxr import Usd, UsdGeom

    cache = UsdGeom.XformCache(time)
    root_from_world = np.linalg.inv(_matrix(cache.GetParentToWorldTransform(root)))
    walk = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    for prim in walk:
        world_from_prim = world_from_parent @ root_from_world @ _matrix(cache.GetLocalToWorldTransform(prim))
        if not prim.IsA(UsdGeom.PointInstancer):
            yield prim, world_from_prim
            continue
        walk.PruneChildren()
        instancer = UsdGeom.PointInstancer(prim)
        if UsdGeom.Imageable(prim).ComputeVisibility(time) == UsdGeom.Tokens.invisible:
            continue
        targets = instancer.GetPrototypesRel().GetForwardedTargets()
        prototypes = [prim.GetStage().GetPrimAtPath(target) for target in targets]
        indices = instancer.GetProtoIndicesAttr().Get(time) or []
        mask = instancer.ComputeMaskAtTime(time)
        transforms = instancer.ComputeInstanceTransformsAtTime(
            time, time, UsdGeom.PointInstancer.ExcludeProtoXform, UsdGeom.PointInstancer.IgnoreMask
        )
        for instance, (index, transform) in enumerate(zip(indices, transforms, strict=True)):
            if not mask or mask[instance]:
                yield from _prims(prototypes[index], world_from_prim @ _matrix(transform), time)


def _matrix(row_vector_matrix: Any) -> Floats:
    """USD's matrices act on row vectors, ours on columns."""
    return np.array(row_vector_matrix, dtype=np.float64).T


def _curves(where: str, prim: Any, time: Any, world_from_prim: Floats) -> list[_Curve]:
    from pxr import UsdGeom

    schema = UsdGeom.BasisCurves(prim)
    kind, basis, wrap = (
        str(attribute.Get(time)) for attribute in (schema.GetTypeAttr(), schema.GetBasisAttr(), schema.GetWrapAttr())
    )
    if kind not in ("linear", "cubic"):
        raise InputError(f"{where}: curves of type {kind!r}: expected linear or cubic")
    if kind == "cubic" and basis not in ("bezier", "bspline", "catmullRom"):
        raise InputError(f"{where}: cubic basis {basis!r}: expected bezier, bspline or catmullRom")
    if wrap not in ("nonperiodic", "periodic", "pinned"):
        raise InputError(f"{where}: wrap {wrap!r}: expected nonperiodic, periodic or pinned")
    if kind == "linear":
        basis = "linear"

    points = np.array(schema.GetPointsAttr().Get(time) or [], dtype=np.float64).reshape(-1, 3)
    counts = np.array(schema.GetCurveVertexCountsAttr().Get(time) or [], dtype=np.int64)
    if not len(counts):
        raise InputError(f"{where}: no curves at time {time}: points or curveVertexCounts hold no value")
    if (counts < 0).any() or counts.sum() != len(points):
        raise InputError(f"{where}: curveVertexCounts sum up to {counts.sum()}, but there are {len(points)} points")
    for curve, count in enumerate(counts):
        _check_count(f"{where}: curve {curve}", int(count), basis, wrap)
    with np.errstate(invalid="ignore"):
        # Infinite coordinates are for `Yarns` to refuse: it names them.
        points = points @ world_from_prim[:3, :3].T + world_from_prim[:3, 3]
    scale = abs(np.linalg.det(world_from_prim[:3, :3])) ** (1 / 3)
    widths = _widths(where, schema, time, basis, wrap, counts)

    parts = np.split(points, np.cumsum(counts)[:-1])
    if widths is None:
        return [_curve(part, None, basis, wrap) for part in parts]
    return [
        _curve(part, _PerCurve(0.5 * scale * width.values, width.at_segment_ends), basis, wrap)
        for part, width in zip(parts, widths, strict=True)
    ]


def _check_count(where: str, count: int, basis: str, wrap: str) -> None:
    least = {"linear": 2, "bezier": 4}.get(basis, 2 if wrap == "pinned" else 4)
    if wrap == "periodic":
        least = 3
    if count < least:
        raise InputError(f"{where} has {count} points: {wrap} {basis} needs at least {least}")
    if basis == "bezier" and count % 3 != (0 if wrap == "periodic" else 1):
        form = "3k" if wrap == "periodic" else "3k + 1"
        raise InputError(f"{where} has {count} points: {wrap} bezier needs {form}")


def _segments(count: int, basis: str, wrap: str) -> int:
    """Segments of a curve; https://openusd.org/release/api/class_usd_geom_basis_curves.html, "Vertex count"."""
    if basis == "bezier":
        return count // 3
    if wrap == "periodic":
        return count
    if basis == "linear" or wrap == "pinned":
        return count - 1
    return count - 3


def _widths(
    where: str, schema: Any, time: Any, basis: str, wrap: str, counts: npt.NDArray[np.int64]
) -> list[_PerCurve] | None:
    """Widths of every curve: diameters in prim space; `None` if the prim has none."""
    authored = schema.GetWidthsAttr().Get(time)
    if authored is None or not len(authored):
        return None
    widths = np.array(authored, dtype=np.float64)
    if not (widths >= 0.0).all():
        index = int(np.argmax(~(widths >= 0.0)))
        raise InputError(f"{where}: width {index} is {widths[index]}: expected at least 0")
    segments = np.array([_segments(int(count), basis, wrap) for count in counts])
    varying = segments if wrap == "periodic" else segments + 1
    sizes = {"constant": 1, "uniform": len(counts), "vertex": int(counts.sum()), "varying": int(varying.sum())}
    sizes["faceVarying"] = sizes["varying"]
    interpolation = str(schema.GetWidthsInterpolation())
    if len(widths) != sizes.get(interpolation):
        # Not authored, the interpolation follows from the number of widths, as in UsdGeom.
        matching = [name for name, size in sizes.items() if size == len(widths)]
        if schema.GetWidthsAttr().HasAuthoredMetadata("interpolation") or not matching:
            expected = ", ".join(f"{size} ({name})" for name, size in sizes.items())
            raise InputError(f"{where}: {len(widths)} widths of interpolation {interpolation}: expected {expected}")
        interpolation = matching[0]
    if interpolation in ("constant", "uniform"):
        each = np.broadcast_to(widths, len(counts))
        return [_PerCurve(np.full(count, width), False) for count, width in zip(counts, each, strict=True)]
    if interpolation == "vertex":
        return [_PerCurve(part, False) for part in np.split(widths, np.cumsum(counts)[:-1])]
    return [_PerCurve(part, True) for part in np.split(widths, np.cumsum(varying)[:-1])]


def _curve(points: Floats, radii: _PerCurve | None, basis: str, wrap: str) -> _Curve:
    """One curve of the stage in a basis of ours, exactly: where ours ends an open curve in another way, by the Bézier
    control points of the same segments, or by the phantom points that "pinned" means."""
    closed = wrap == "periodic"
    values = None if radii is None else radii.values
    ends = radii.values if radii is not None and radii.at_segment_ends else None
    if basis == "linear":
        return _Curve(points, values, closed, LINEAR)
    if basis == "bezier":
        return _Curve(points, values if ends is None else _handles(ends, closed), closed, BEZIER)
    if basis == "catmullRom":
        if wrap != "nonperiodic":
            # Segments end at the control points.
            return _Curve(points, values, closed, CATMULL_ROM)
        if values is not None:
            values = np.maximum(_bezier_of_catmull_rom(values), 0.0) if ends is None else _handles(ends, closed)
        return _Curve(_bezier_of_catmull_rom(points), values, closed, BEZIER)
    if wrap == "pinned":
        points = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
        if values is not None and ends is None:
            values = np.concatenate([2 * values[:1] - values[1:2], values, 2 * values[-1:] - values[-2:-1]])
            # A phantom's radius may be negative where those of the curve are not.
            return _Curve(_bezier_of_b_spline(points, closed), _bezier_of_b_spline(values, closed), closed, BEZIER)
    if ends is not None:
        # They interpolate linearly, which a B-spline's own radii do not.
        return _Curve(_bezier_of_b_spline(points, closed), _handles(ends, closed), closed, BEZIER)
    return _Curve(points, values, closed, B_SPLINE)


def _handles(at_ends: Floats, closed: bool) -> Floats:
    """Bézier control values that interpolate linearly between the ends of segments."""
    ends = np.append(at_ends, at_ends[:1]) if closed else at_ends
    inner = [ends[:-1], (2 * ends[:-1] + ends[1:]) / 3, (ends[:-1] + 2 * ends[1:]) / 3]
    result = np.stack(inner, axis=1).reshape(-1)
    return result if closed else np.append(result, ends[-1])


def _bezier_of_catmull_rom(values: Floats) -> Floats:
    """Bézier control values of a nonperiodic Catmull-Rom curve: it runs from its second point to the last but one."""
    start, end = values[1:-2], values[2:-1]
    inner = [start, start + (end - values[:-3]) / 6, end - (values[3:] - start) / 6]
    return np.concatenate([np.stack(inner, axis=1).reshape(-1, *values.shape[1:]), values[-2:-1]])


def _bezier_of_b_spline(values: Floats, closed: bool) -> Floats:
    """Bézier control values of a uniform cubic B-spline."""
    if closed:
        values = np.concatenate([values[-1:], values, values[:2]])
    before, start, end = values[:-3], values[1:-2], values[2:-1]
    inner = [(before + 4 * start + end) / 6, (2 * start + end) / 3, (start + 2 * end) / 3]
    result = np.stack(inner, axis=1).reshape(-1, *values.shape[1:])
    return result if closed else np.concatenate([result, (values[-3:-2] + 4 * values[-2:-1] + values[-1:]) / 6])
