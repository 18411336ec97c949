use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use thiserror::Error;

use super::multiple::cloth_color;

/// Names of the fitted materials, as [`Material::preset`] takes them.
pub const MATERIAL_NAMES: [&str; 13] = [
    "fleece",
    "gabardine",
    "silk",
    "cotton",
    "cotton-1",
    "cotton-2",
    "rayon-1",
    "rayon-2",
    "rayon-3",
    "rayon-4",
    "silk-1",
    "silk-2",
    "polyester-1",
];

/// How one fiber scatters light. Colours are scene-linear Rec.709, each channel in [0, 1].
///
/// | field | model | meaning |
/// |---|---|---|
/// | `color_r`, `color_tt` | physical | C_R, C_TT of the R and TT modes [Khungurn2015] |
/// | `beta_r_rad`, `beta_tt_rad` | physical | their longitudinal widths β, standard deviations in θ_o |
/// | `gamma_tt_rad` | physical | azimuthal width of TT: von Mises concentration γ⁻² |
/// | `diffuse`, `diffuse_weight` | both, physical | albedo of the Lambert term, and its share w of the mix |
/// | `specular`, `specular_beta_rad` | simple | k_specular and β of [WuYuksel2018, Eq. 5] |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Reflectance C_R at normal incidence.
    pub color_r: DVec3,
    /// Transmittance C_TT through the fiber.
    pub color_tt: DVec3,
    /// Longitudinal width of R, radians, above 0.
    pub beta_r_rad: f64,
    /// Longitudinal width of TT, radians, above 0.
    pub beta_tt_rad: f64,
    /// Azimuthal width of TT, radians, above 0.
    pub gamma_tt_rad: f64,
    /// Albedo of the Lambert term on the fiber's surface.
    pub diffuse: DVec3,
    /// Share w of the Lambert term in the physically based model, in [0, 1].
    pub diffuse_weight: f64,
    /// Albedo of the simple model's highlight; with `diffuse` at most 1 per channel.
    pub specular: DVec3,
    /// Longitudinal width of the simple model's highlight in the half angle θ_h, radians, above 0.
    pub specular_beta_rad: f64,
}

/// A material parameter outside its range.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("material parameter `{parameter}` is {value}: expected {expected}")]
pub struct MaterialError {
    /// Name of the field.
    pub parameter: &'static str,
    /// What it was set to.
    pub value: f64,
    /// What would be right.
    pub expected: &'static str,
}

/// C_R, C_TT, then β_R, β_TT, γ_TT in degrees.
type Row = ([f64; 3], [f64; 3], [f64; 3]);

/// Four fits to measured fabrics [Khungurn2015], then nine to photographs of yarns [Zhao2016, Table 3].
#[rustfmt::skip]
const FITS: [Row; 13] = [
    ([0.040, 0.087, 0.087], [0.452, 0.725, 0.948], [7.238, 10.0, 25.989]),
    ([0.185, 0.047, 0.069], [0.999, 0.330, 0.354], [2.141, 10.0, 23.548]),
    ([0.745, 0.008, 0.070], [0.620, 0.553, 0.562], [1.000, 10.0, 19.823]),
    ([0.989, 0.959, 0.874], [0.999, 0.999, 0.999], [1.000, 27.197, 38.269]),
    ([0.90, 0.90, 0.93], [0.90, 0.90, 0.93], [1.0, 27.0, 38.0]),
    ([0.10, 0.10, 0.05], [0.93, 0.53, 0.01], [1.0, 27.0, 38.0]),
    ([0.15, 0.25, 0.25], [0.45, 0.82, 0.95], [1.2, 10.0, 26.0]),
    ([0.25, 0.25, 0.30], [0.45, 0.86, 0.95], [1.2, 10.0, 26.0]),
    ([0.20, 0.20, 0.20], [0.05, 0.05, 0.05], [1.0, 10.0, 26.0]),
    ([0.05, 0.05, 0.10], [0.95, 0.91, 0.60], [1.5, 10.0, 26.0]),
    ([0.10, 0.10, 0.10], [0.73, 0.50, 0.67], [1.0, 10.0, 20.0]),
    ([0.10, 0.10, 0.10], [0.05, 0.55, 0.70], [1.0, 10.0, 20.0]),
    ([0.10, 0.10, 0.05], [0.88, 0.83, 0.01], [4.0, 10.0, 20.0]),
];

impl Material {
    /// The fitted material of that name ([`MATERIAL_NAMES`]), or `None`.
    ///
    /// The fits hold R and TT only: their colour comes from many scatterings between fibers. For the simple model, which has none,
    /// `diffuse` stands in for those: the colour of a cloth of such fibers.
    pub fn preset(name: &str) -> Option<Self> {
        let index = MATERIAL_NAMES.iter().position(|preset| *preset == name)?;
        let (color_r, color_tt, [beta_r, beta_tt, gamma_tt]) = FITS[index];
        let (color_r, color_tt) = (DVec3::from(color_r), DVec3::from(color_tt));
        let gamma_tt_rad = gamma_tt.to_radians();
        let diffuse = cloth_color(color_r, color_tt, gamma_tt_rad);
        Some(Self {
            color_r,
            color_tt,
            beta_r_rad: beta_r.to_radians(),
            beta_tt_rad: beta_tt.to_radians(),
            gamma_tt_rad,
            diffuse,
            diffuse_weight: 0.0,
            specular: color_r.min(DVec3::ONE - diffuse),
            // One lobe stands for R and TT; the wider one gives cloth its sheen. Half of it, in the half angle.
            specular_beta_rad: 0.5 * beta_tt.to_radians(),
        })
    }

    /// Checks every parameter against its range.
    pub fn validate(&self) -> Result<(), MaterialError> {
        let check = |ok: bool, parameter, value, expected| {
            if ok { Ok(()) } else { Err(MaterialError { parameter, value, expected }) }
        };
        for (parameter, color) in [
            ("color_r", self.color_r),
            ("color_tt", self.color_tt),
            ("diffuse", self.diffuse),
            ("specular", self.specular),
        ] {
            for value in color.to_array() {
                check((0.0..=1.0).contains(&value), parameter, value, "every channel from 0 to 1")?;
            }
        }
        for value in (self.diffuse + self.specular).to_array() {
            check(value <= 1.0 + 1e-6, "diffuse + specular", value, "at most 1 in every channel")?;
        }
        for (parameter, value) in [
            ("beta_r_rad", self.beta_r_rad),
            ("beta_tt_rad", self.beta_tt_rad),
            ("gamma_tt_rad", self.gamma_tt_rad),
            ("specular_beta_rad", self.specular_beta_rad),
        ] {
            check((MIN_WIDTH_RAD..=FRAC_PI_2).contains(&value), parameter, value, "an angle from 0.001 to π/2")?;
        }
        check((0.0..=1.0).contains(&self.diffuse_weight), "diffuse_weight", self.diffuse_weight, "a number from 0 to 1")
    }
}

/// Narrowest lobe, radians: below it f32 no longer resolves the von Mises exponent.
pub const MIN_WIDTH_RAD: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_valid_and_unknown_names_are_refused() {
        for name in MATERIAL_NAMES {
            Material::preset(name).expect(name).validate().expect(name);
        }
        assert_eq!(Material::preset("wool"), None);
    }

    #[test]
    fn a_wrong_parameter_is_named() {
        let silk = Material::preset("silk").expect("preset");
        let wrong = [
            (Material { beta_r_rad: 0.0, ..silk }, "beta_r_rad"),
            (Material { gamma_tt_rad: f64::NAN, ..silk }, "gamma_tt_rad"),
            (Material { color_tt: DVec3::new(0.2, 1.2, 0.2), ..silk }, "color_tt"),
            (Material { diffuse: DVec3::splat(0.7), specular: DVec3::splat(0.5), ..silk }, "diffuse + specular"),
            (Material { diffuse_weight: -0.1, ..silk }, "diffuse_weight"),
        ];
        for (material, parameter) in wrong {
            assert_eq!(material.validate().expect_err(parameter).parameter, parameter);
        }
    }
}
