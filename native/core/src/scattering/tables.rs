use std::f64::consts::FRAC_PI_2;

use super::azimuthal::von_mises_scale;
use super::longitudinal::{gaussian, gaussian_integral};
use super::physical::schlick;
use super::quadrature::simpson;
use super::{AmbientFactors, Material, Normalizers};

/// Entries of every table, at |θ| = k π/2 / (size − 1).
pub const TABLE_SIZE: usize = 128;

/// The 1D tables of one material [WuYuksel2018 §4.3], each over |θ| in [0, π/2], read with linear interpolation.
///
/// All are even in θ, so that half the range has twice the resolution. The normalisers are kept as square roots of
/// ∫ g cos²: the integral falls to β³ at grazing angles and its reciprocal is far from linear between entries there,
/// while the root is nearly straight. Bounds for the presets (β ≥ 1°), tested: |error of M's normaliser| below 4 % within 2° of
/// grazing and 0.5 % elsewhere; ambient factors within 0.01.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatteringTables {
    /// √ ∫ g cos²θ_o dθ_o over θ_i, for β_R.
    pub root_integral_r: [f64; TABLE_SIZE],
    /// The same for β_TT.
    pub root_integral_tt: [f64; TABLE_SIZE],
    /// [`AmbientFactors::reflect`] over θ_o.
    pub ambient_reflect: [f64; TABLE_SIZE],
    /// [`AmbientFactors::reflect_grazing`] over θ_o.
    pub ambient_reflect_grazing: [f64; TABLE_SIZE],
    /// [`AmbientFactors::transmit`] over θ_o.
    pub ambient_transmit: [f64; TABLE_SIZE],
    /// [`von_mises_scale`] of γ_TT.
    pub azimuthal_tt: f64,
}

/// ∫ weight(θ_i) M(θ_o; θ_i, β) cos²θ_i dθ_i.
fn ambient_integral(theta_o: f64, beta: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let reach = 8.0 * beta;
    let (from, to) = ((-theta_o - reach).max(-FRAC_PI_2), (-theta_o + reach).min(FRAC_PI_2));
    simpson(from, to, 48, |theta_i| {
        let m = gaussian(theta_o + theta_i, beta) / gaussian_integral(theta_i, beta);
        weight(theta_i.cos()) * m * theta_i.cos().powi(2)
    })
}

/// Linear interpolation at |θ|; angles beyond π/2 read the last entry.
pub(super) fn lookup(table: &[f64], theta_rad: f64) -> f64 {
    let last = table.len() - 1;
    let x = (theta_rad.abs() / FRAC_PI_2).min(1.0) * last as f64;
    let k = (x as usize).min(last - 1);
    table[k] + (table[k + 1] - table[k]) * (x - k as f64)
}

impl ScatteringTables {
    /// Fills the tables; about 20 ms.
    pub fn new(material: &Material) -> Self {
        let fill = |f: &dyn Fn(f64) -> f64| std::array::from_fn(|k| f(FRAC_PI_2 * k as f64 / (TABLE_SIZE - 1) as f64));
        let (beta_r, beta_tt) = (material.beta_r_rad, material.beta_tt_rad);
        Self {
            root_integral_r: fill(&|theta_i| gaussian_integral(theta_i, beta_r).sqrt()),
            root_integral_tt: fill(&|theta_i| gaussian_integral(theta_i, beta_tt).sqrt()),
            ambient_reflect: fill(&|theta_o| ambient_integral(theta_o, beta_r, |_| 1.0)),
            ambient_reflect_grazing: fill(&|theta_o| ambient_integral(theta_o, beta_r, schlick)),
            ambient_transmit: fill(&|theta_o| ambient_integral(theta_o, beta_tt, |cos| 1.0 - schlick(cos))),
            azimuthal_tt: von_mises_scale(material.gamma_tt_rad),
        }
    }

    /// Normalisers for light from θ_i.
    pub fn normalizers(&self, theta_i_rad: f64) -> Normalizers {
        Normalizers {
            integral_r: lookup(&self.root_integral_r, theta_i_rad).powi(2),
            integral_tt: lookup(&self.root_integral_tt, theta_i_rad).powi(2),
            azimuthal_tt: self.azimuthal_tt,
        }
    }

    /// Ambient factors for a viewer at θ_o.
    pub fn ambient(&self, theta_o_rad: f64) -> AmbientFactors {
        AmbientFactors {
            reflect: lookup(&self.ambient_reflect, theta_o_rad),
            reflect_grazing: lookup(&self.ambient_reflect_grazing, theta_o_rad),
            transmit: lookup(&self.ambient_transmit, theta_o_rad),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec3;

    use super::super::{FiberAngles, MATERIAL_NAMES, fiber_scattering, physical_ambient};
    use super::*;

    /// Odd steps fall between the entries.
    fn angles() -> impl Iterator<Item = f64> {
        (-1000..=1000).map(|k| FRAC_PI_2 * f64::from(k) / 1000.0)
    }

    #[test]
    fn normalisers_stay_within_their_bound_between_entries() {
        let (mut near_grazing, mut elsewhere) = (0.0_f64, 0.0_f64);
        for name in MATERIAL_NAMES {
            let material = Material::preset(name).expect(name);
            let tables = ScatteringTables::new(&material);
            for theta in angles() {
                let (table, exact) = (tables.normalizers(theta), Normalizers::exact(&material, theta));
                let error = (table.integral_r / exact.integral_r - 1.0)
                    .abs()
                    .max((table.integral_tt / exact.integral_tt - 1.0).abs());
                let worst = if theta.abs() > 88_f64.to_radians() { &mut near_grazing } else { &mut elsewhere };
                *worst = worst.max(error);
            }
        }
        println!("normalisers: {near_grazing} near grazing, {elsewhere} elsewhere");
        assert!(near_grazing < 0.04 && elsewhere < 0.005, "{near_grazing} {elsewhere}");
    }

    #[test]
    fn ambient_factors_stay_within_their_bound_between_entries() {
        let mut worst = 0.0_f64;
        for name in ["fleece", "silk", "cotton", "rayon-4"] {
            let material = Material::preset(name).expect(name);
            let tables = ScatteringTables::new(&material);
            for theta in angles().skip(1000) {
                let factors = tables.ambient(theta);
                let (beta_r, beta_tt) = (material.beta_r_rad, material.beta_tt_rad);
                for (table, exact) in [
                    (factors.reflect, ambient_integral(theta, beta_r, |_| 1.0)),
                    (factors.reflect_grazing, ambient_integral(theta, beta_r, schlick)),
                    (factors.transmit, ambient_integral(theta, beta_tt, |cos| 1.0 - schlick(cos))),
                ] {
                    worst = worst.max((table - exact).abs());
                }
            }
        }
        println!("ambient factors: {worst}");
        assert!(worst < 0.01, "{worst}");
    }

    /// ∫ S cos θ_i dω_i by brute force over both angles, with S as the renderer evaluates it.
    fn brute_force(material: &Material, theta_o: f64, drop_cosine: bool) -> DVec3 {
        const N: u32 = 6000;
        const N_PHI: u32 = 60;
        let mut sum = DVec3::ZERO;
        for k in 0..N {
            let theta_i = -FRAC_PI_2 + PI * (f64::from(k) + 0.5) / f64::from(N);
            let normalizers = Normalizers::exact(material, theta_i);
            for j in 0..N_PHI {
                let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(N_PHI);
                let angles = FiberAngles::from_radians(theta_i, theta_o, phi);
                let cosine = if drop_cosine { 1.0 } else { theta_i.cos() };
                sum += fiber_scattering(material, &normalizers, &angles) * (cosine * theta_i.cos());
            }
        }
        sum * (PI / f64::from(N)) * (2.0 * PI / f64::from(N_PHI))
    }

    #[test]
    fn the_ambient_colour_is_the_integral_over_all_light() {
        for name in ["gabardine", "cotton", "silk-2"] {
            let material = Material { diffuse_weight: 0.0, ..Material::preset(name).expect(name) };
            let tables = ScatteringTables::new(&material);
            for theta_o in [0.0, 0.6, -1.2, 1.54] {
                let ambient = physical_ambient(&material, &tables.ambient(theta_o));
                let error = (ambient - brute_force(&material, theta_o, false)).abs().max_element();
                assert!(error < 0.01, "{name}, θ_o {theta_o}: {error}");
                // Eq. 7 as printed, without the light's cosine, is something else.
                if theta_o.abs() > 1.0 {
                    assert!((ambient - brute_force(&material, theta_o, true)).abs().max_element() > 0.1, "{name}");
                }
            }
        }
    }
}
