"""Lights, with the conventions of Blender: powers in watts, irradiance of the sun in W/m²."""

from dataclasses import dataclass
from math import pi
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from ._arguments import Triple, Vector
from .errors import InputError

WHITE: Triple = (1.0, 1.0, 1.0)


def _at_least_zero(name: str, value: object) -> float:
    result = arguments.number(name, value)
    if result < 0.0:
        raise InputError(f"{name}: {result} is less than 0")
    return result


@dataclass(frozen=True)
class Sun:
    """A light infinitely far away.

    Args:
        direction: in which the light travels, world space; of any length.
        strength: irradiance on a surface that faces it, W/m².
        color: scene-linear Rec.709.
        angle_rad: apparent diameter.
    """

    direction: Vector
    strength: float = 1.0
    color: Vector = WHITE
    angle_rad: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", arguments.direction("Sun.direction", self.direction))
        object.__setattr__(self, "strength", _at_least_zero("Sun.strength", self.strength))
        object.__setattr__(self, "color", arguments.triple("Sun.color", self.color))
        object.__setattr__(self, "angle_rad", _at_least_zero("Sun.angle_rad", self.angle_rad))


LEAST_SHARPNESS = 1e-6
MOST_SHARPNESS = 1e12


@dataclass(frozen=True)
class Gaussian:
    """Light from everywhere, infinitely far away, that is brightest about a direction: a spherical Gaussian.

    The radiance from a unit direction w is A exp(sharpness (w·d - 1)), where d points against `direction` and
    A = strength sharpness / (2π (1 - exp(-2 sharpness))). A sharp one is a `Sun` of the same strength, one of next to
    no sharpness an even sky of radiance strength / 4π. The camera does not see it.

    Args:
        direction: in which the brightest light travels, world space; of any length.
        strength: the radiance over all directions, W/m²; of a sharp one, the irradiance on a surface that faces it.
        sharpness: from 1e-6 to 1e12. Where it is large, radiance falls to 61 % at 1/√sharpness radians from the middle.
        color: scene-linear Rec.709.
    """

    direction: Vector
    strength: float = 1.0
    sharpness: float = 10.0
    color: Vector = WHITE

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", arguments.direction("Gaussian.direction", self.direction))
        object.__setattr__(self, "strength", _at_least_zero("Gaussian.strength", self.strength))
        sharpness = arguments.number("Gaussian.sharpness", self.sharpness)
        if not LEAST_SHARPNESS <= sharpness <= MOST_SHARPNESS:
            raise InputError(f"Gaussian.sharpness: {sharpness} is not from {LEAST_SHARPNESS} to {MOST_SHARPNESS}")
        object.__setattr__(self, "sharpness", sharpness)
        object.__setattr__(self, "color", arguments.triple("Gaussian.color", self.color))


@dataclass(frozen=True)
class Point:
    """A glowing sphere.

    Args:
        position: centre, world space.
        power: W; the irradiance at distance d is power / (4π d²).
        color: scene-linear Rec.709.
        radius: m.
    """

    position: Vector
    power: float = 10.0
    color: Vector = WHITE
    radius: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", arguments.triple("Point.position", self.position))
        object.__setattr__(self, "power", _at_least_zero("Point.power", self.power))
        object.__setattr__(self, "color", arguments.triple("Point.color", self.color))
        object.__setattr__(self, "radius", _at_least_zero("Point.radius", self.radius))


@dataclass(frozen=True)
class Spot:
    """A point light that shines into a cone.

    Args:
        position: apex, world space.
        direction: axis of the cone, world space; of any length.
        power: W, of the point light that the cone is cut from.
        color: scene-linear Rec.709.
        radius: m.
        cone_angle_rad: full opening angle, above 0 and at most π.
        blend: share of the cone over which it softens, 0 to 1.
    """

    position: Vector
    direction: Vector
    power: float = 10.0
    color: Vector = WHITE
    radius: float = 0.0
    cone_angle_rad: float = pi / 4
    blend: float = 0.15

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", arguments.triple("Spot.position", self.position))
        object.__setattr__(self, "direction", arguments.direction("Spot.direction", self.direction))
        object.__setattr__(self, "power", _at_least_zero("Spot.power", self.power))
        object.__setattr__(self, "color", arguments.triple("Spot.color", self.color))
        object.__setattr__(self, "radius", _at_least_zero("Spot.radius", self.radius))
        cone_angle_rad = arguments.number("Spot.cone_angle_rad", self.cone_angle_rad)
        if not 0.0 < cone_angle_rad <= pi + 1e-6:
            raise InputError(f"Spot.cone_angle_rad: {cone_angle_rad} is not above 0 and at most π")
        object.__setattr__(self, "cone_angle_rad", cone_angle_rad)
        blend = arguments.number("Spot.blend", self.blend)
        if not 0.0 <= blend <= 1.0:
            raise InputError(f"Spot.blend: {blend} is not from 0 to 1")
        object.__setattr__(self, "blend", blend)


@dataclass(frozen=True, eq=False)
class Area:
    """A one-sided emitter that shines along its −Z.

    Args:
        world_from_light: 4×4, light to world.
        size: extents along X and Y, m.
        power: W; its radiance is power / (π area).
        color: scene-linear Rec.709.
        shape: "rectangle", or "disk" (an ellipse if the extents differ).
    """

    world_from_light: npt.ArrayLike
    size: tuple[float, float] = (1.0, 1.0)
    power: float = 10.0
    color: Vector = WHITE
    shape: str = "rectangle"

    def __post_init__(self) -> None:
        matrix = arguments.matrix("Area.world_from_light", self.world_from_light)
        if abs(np.linalg.det(matrix[:3, :3])) == 0.0:
            raise InputError("Area.world_from_light: the matrix is singular")
        object.__setattr__(self, "world_from_light", matrix)
        try:
            x, y = (arguments.number("Area.size", extent) for extent in self.size)
        except (TypeError, ValueError):
            raise InputError(f"Area.size: expected two numbers, got {self.size!r}") from None
        if x <= 0.0 or y <= 0.0:
            raise InputError(f"Area.size: {x} × {y} m has no area")
        object.__setattr__(self, "size", (x, y))
        object.__setattr__(self, "power", _at_least_zero("Area.power", self.power))
        object.__setattr__(self, "color", arguments.triple("Area.color", self.color))
        if self.shape not in ("rectangle", "disk"):
            raise InputError(f'Area.shape: {self.shape!r} is neither "rectangle" nor "disk"')


Light: TypeAlias = Sun | Gaussian | Point | Spot | Area
