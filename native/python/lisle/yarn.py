"""The procedural yarn."""

from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from . import _native

Variate: TypeAlias = tuple[float, float]
"""Mean and standard deviation."""


@dataclass(frozen=True, kw_only=True)
class Yarn:
    """Parameters of one kind of yarn [Zhao2016, Table 2; WuYuksel2018 §3.1].

    Lengths are in the table's unit; only their ratios matter, since a yarn is scaled to the radius of its curve.

    Args:
        plies: plies per yarn, K ≥ 1.
        fibers_per_ply: m ≥ 1; plies × fibers_per_ply ≤ 60,000.
        density_beta: exponent β of the radial fiber density, ≥ 0.
        density_epsilon: floor ε of the radial fiber density, 0 to 0.5.
        fiber_twist: ply length per full turn of its fibers; the sign is the handedness.
        ply_twist: yarn length per full turn of its plies; the sign is the handedness.
        r_min: least relative radius of a migrating fiber, 0 to 1.
        migration_rate: migration periods per turn of the fibers, above 0.
        ellipse_long: long half axis of a ply's section (tangential).
        ellipse_short: short half axis of a ply's section (towards the yarn centre).
        ply_radius: diameter parameter of the ply helix: ply centres sit at half of it.
        fiber_radius: radius of one fiber.
        loop_density: loop fibers per unit of ply length.
        hair_density: hair fibers per unit of ply length.
        loop_r_max: largest distance of a loop from the ply centre, (mean, deviation).
        hair_r_min: distance at which a hair leaves the ply.
        hair_r_span: how much farther out its tip is.
        hair_z_span: its extent along the ply; the sign is the direction.
        hair_theta_span: angle that it turns around the ply on the way, radians.
    """

    plies: int
    fibers_per_ply: int
    density_beta: float
    density_epsilon: float
    fiber_twist: float
    ply_twist: float
    r_min: float
    migration_rate: float
    ellipse_long: float
    ellipse_short: float
    ply_radius: float
    fiber_radius: float
    loop_density: float
    hair_density: float
    loop_r_max: Variate
    hair_r_min: Variate
    hair_r_span: Variate
    hair_z_span: Variate
    hair_theta_span: Variate

    def __post_init__(self) -> None:
        _native.check_yarn(self)

    @staticmethod
    def presets() -> tuple[str, ...]:
        """Names that `preset` takes: the nine measured yarns of Zhao 2016."""
        return _native.yarn_presets()

    @classmethod
    def preset(cls, name: str) -> "Yarn":
        """A measured yarn by name."""
        return cls(**_native.yarn_preset(name))

    def replace(self, **fields: Any) -> "Yarn":
        """This yarn with other values in some fields."""
        return replace(self, **fields)
