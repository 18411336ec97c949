"""Knitted and woven cloth as yarn curves, in metres, Z up."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _native
from ._arguments import Vector
from ._native import Yarns
from .errors import InputError

YARN_RADIUS_M = 1e-3

WEAVE_SPACING = 1.01
"""Spacing of tight woven cloth."""


def knit_swatch(
    pattern: str = "stockinette", courses: int = 24, wales: int = 24, yarn_radius: float = YARN_RADIUS_M
) -> Yarns:
    """A flat piece, upright, centred on the origin, its front towards −Y; each course is an open yarn.

    Args:
        pattern: "stockinette", "garter", "rib-K-P" (K knit and P purl wales in turn), or a chart of k and p with its
            rows separated by spaces, the top row first.
        courses: rows of stitches.
        wales: columns of stitches.
        yarn_radius: m.
    """
    return _native.knit_flat(
        arguments.text("pattern", pattern),
        _count("courses", courses),
        _count("wales", wales),
        arguments.number("yarn_radius", yarn_radius),
    )


def knit_tube(
    pattern: str = "stockinette", courses: int = 24, wales: int = 48, yarn_radius: float = YARN_RADIUS_M
) -> Yarns:
    """A tube about the Z axis, standing on z = 0; each course is a closed yarn. Arguments as of `knit_swatch`."""
    return _native.knit_tube(
        arguments.text("pattern", pattern),
        _count("courses", courses),
        _count("wales", wales),
        arguments.number("yarn_radius", yarn_radius),
    )


def knit_sleeve(
    centre_line: Sequence[Vector],
    radius: float,
    pattern: str = "stockinette",
    courses: int = 48,
    wales: int = 48,
    yarn_radius: float = YARN_RADIUS_M,
    seam_direction: Vector = (1, 0, 0),
) -> Yarns:
    """A tube about a smooth curve through points; each course is a closed yarn.

    To bend it, make it again with another centre line, and give its points to the first one's `with_points`.

    Args:
        centre_line: two points or more, m.
        radius: of the tube, m.
        seam_direction: the side where the stitches begin.
    """
    return _native.knit_sleeve(
        [arguments.triple(f"centre_line, point {index}", point) for index, point in enumerate(centre_line)],
        arguments.number("radius", radius),
        arguments.direction("seam_direction", seam_direction),
        arguments.text("pattern", pattern),
        _count("courses", courses),
        _count("wales", wales),
        arguments.number("yarn_radius", yarn_radius),
    )


@dataclass(frozen=True, eq=False)
class MeshKnit:
    """Knitted cloth bound to a mesh. What its n control points are bound to stays the same when the mesh moves."""

    yarns: Yarns
    """On the mesh as it was given."""
    vertices: npt.NDArray[np.uint32]
    """(n, 3): the mesh's vertices about each point."""
    weights: npt.NDArray[np.float32]
    """(n, 3): their weights, which add up to one."""
    heights: npt.NDArray[np.float32]
    """(n,): metres along the weighted mean of the vertices' normals."""

    def follow(self, positions: npt.ArrayLike, normals: npt.ArrayLike) -> Yarns:
        """The yarns on the moved mesh, measured at rest as before: (v, 3) vertices and their unit normals."""
        return self.yarns.with_points(
            self._mean(positions) + self.heights[:, None] * _unit(self._mean(normals)),
        )

    def _mean(self, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
        corners: npt.NDArray[np.float64] = np.asarray(values, np.float64)[self.vertices]
        mean: npt.NDArray[np.float64] = (self.weights[:, :, None] * corners).sum(axis=1)
        return mean


def knit_on_mesh(
    positions: npt.ArrayLike,
    normals: npt.ArrayLike,
    triangles: npt.ArrayLike,
    uvs: npt.ArrayLike,
    pattern: str = "stockinette",
    yarn_radius: float = YARN_RADIUS_M,
) -> MeshKnit:
    """Knits on a mesh with a UV map: courses run along u, wales along v, and the front faces along the normals.

    As many stitches as have their natural size on average are spread evenly over the map's bounding rectangle. Courses
    end where the map has no triangle; where its right border is the left one again, as round a sleeve, they are closed.

    Args:
        positions: (v, 3), m.
        normals: (v, 3), unit length.
        triangles: (t, 3), numbers of vertices.
        uvs: (t, 3, 2), of the triangles' corners. No place of the map may be covered twice.
        pattern: as of `knit_swatch`.
        yarn_radius: m.

    Raises:
        InputError: the mesh or its map cannot be knitted on, or no stitch fits on it.
    """
    corners, map_ = np.asarray(triangles), np.asarray(uvs)
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise InputError(f"triangles: expected shape (t, 3), got {corners.shape}")
    if map_.shape != (*corners.shape, 2):
        raise InputError(f"uvs: expected shape {(*corners.shape, 2)}, got {map_.shape}")
    radius = arguments.number("yarn_radius", yarn_radius)
    stitches = arguments.text("pattern", pattern)
    return MeshKnit(*_native.knit_mesh(positions, normals, corners.ravel(), map_.ravel(), stitches, radius))


def _unit(vectors: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: npt.NDArray[np.float64] = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return unit


def sweater(points: int = 200_000) -> Yarns:
    """A sweater of at most so many control points and nearly as many; more of them mean thinner yarn."""
    count = arguments.integer("points", points)
    if count < 0:
        raise InputError(f"points: {count} is less than 0")
    return _native.sweater(count)


def woven_swatch(
    weave: str = "plain",
    warp: int = 48,
    weft: int = 48,
    yarn_radius: float = YARN_RADIUS_M,
    spacing: float = WEAVE_SPACING,
) -> Yarns:
    """A flat woven piece, upright, centred on the origin, its front towards −Y.

    Each yarn is a curve: first the warp, which runs upwards, from left to right; then the weft, from the bottom up.

    Args:
        weave: "plain", "twill-F-B" (each warp yarn passes in front of F weft yarns and behind B), "satin-N" (behind one
            of N), or a chart of x (warp in front) and o (weft in front) with its rows separated by spaces, the top row
            first.
        warp: yarns that run upwards.
        weft: yarns that run across.
        yarn_radius: m.
        spacing: from yarn to yarn, at least 1, where round yarns jam: √3 diameters both ways if the weave shows as much
            warp as weft; in satins yarns of the warp touch, and those of the weft are two diameters apart.
    """
    return _native.woven_flat(
        arguments.text("weave", weave),
        _count("warp", warp),
        _count("weft", weft),
        arguments.number("yarn_radius", yarn_radius),
        arguments.number("spacing", spacing),
    )


def _count(name: str, value: int) -> int:
    count = arguments.integer(name, value)
    if not 0 <= count < 2**32:
        raise InputError(f"{name}: {count} is not from 1 to 2³² − 1")
    return count
