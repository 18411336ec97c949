"""Knitted and woven cloth as yarn curves, in metres, Z up."""

from collections.abc import Sequence

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
        pattern, *_counts(courses=courses, wales=wales), arguments.number("yarn_radius", yarn_radius)
    )


def knit_tube(
    pattern: str = "stockinette", courses: int = 24, wales: int = 48, yarn_radius: float = YARN_RADIUS_M
) -> Yarns:
    """A tube about the Z axis, standing on z = 0; each course is a closed yarn. Arguments as of `knit_swatch`."""
    return _native.knit_tube(
        pattern, *_counts(courses=courses, wales=wales), arguments.number("yarn_radius", yarn_radius)
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
        pattern,
        *_counts(courses=courses, wales=wales),
        arguments.number("yarn_radius", yarn_radius),
    )


def sweater(points: int = 200_000) -> Yarns:
    """A sweater of at most so many control points and nearly as many; more of them mean thinner yarn."""
    if points < 0:
        raise InputError(f"points: {points} is less than 0")
    return _native.sweater(int(points))


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
        weave,
        *_counts(warp=warp, weft=weft),
        arguments.number("yarn_radius", yarn_radius),
        arguments.number("spacing", spacing),
    )


def _counts(**counts: int) -> tuple[int, ...]:
    for name, value in counts.items():
        if not 0 <= value < 2**32:
            raise InputError(f"{name}: {value} is not from 1 to 2³² − 1")
    return tuple(int(value) for value in counts.values())
