"""How fibers scatter light."""

from dataclasses import dataclass, replace
from typing import Any

from . import _native
from ._arguments import Triple


@dataclass(frozen=True, kw_only=True)
class Material:
    """Scattering of one fiber [Khungurn2015; WuYuksel2018 §4]. Colours are scene-linear Rec.709, angles degrees.

    Args:
        color_r: C_R, reflectance of the surface at normal incidence, 0 to 1.
        color_tt: C_TT, transmittance, 0 to 1.
        beta_r_deg: β_R, longitudinal width of the reflection.
        beta_tt_deg: β_TT, longitudinal width of the transmission.
        gamma_tt_deg: γ_TT, azimuthal width of the transmission.
        diffuse: colour of the diffuse part.
        diffuse_weight: its weight, 0 to 1.
        specular: colour of the simple shading's lobe.
        specular_beta_deg: its longitudinal width.
    """

    color_r: Triple
    color_tt: Triple
    beta_r_deg: float
    beta_tt_deg: float
    gamma_tt_deg: float
    diffuse: Triple
    diffuse_weight: float
    specular: Triple
    specular_beta_deg: float

    def __post_init__(self) -> None:
        _native.check_material(self)

    @staticmethod
    def presets() -> tuple[str, ...]:
        """Names that `preset` takes: the fits of Khungurn 2015 and of Zhao 2016."""
        return _native.material_presets()

    @classmethod
    def preset(cls, name: str) -> "Material":
        """A fitted material by name."""
        return cls(**_native.material_preset(name))

    def replace(self, **fields: Any) -> "Material":
        """This material with other values in some fields."""
        return replace(self, **fields)
