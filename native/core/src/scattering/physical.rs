use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::azimuthal::{UNIFORM, von_mises, von_mises_scale};
use super::longitudinal::{gaussian, gaussian_integral};
use super::{FiberAngles, Material};

/// What the two lobes are divided or multiplied by so that they conserve energy; the first two depend on θ_i.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normalizers {
    /// ∫ g cos²θ_o dθ_o for β_R.
    pub integral_r: f64,
    /// The same for β_TT.
    pub integral_tt: f64,
    /// [`von_mises_scale`] of γ_TT.
    pub azimuthal_tt: f64,
}

impl Normalizers {
    /// Computed afresh; a renderer reads them from [`super::ScatteringTables`].
    pub fn exact(material: &Material, theta_i_rad: f64) -> Self {
        Self {
            integral_r: gaussian_integral(theta_i_rad, material.beta_r_rad),
            integral_tt: gaussian_integral(theta_i_rad, material.beta_tt_rad),
            azimuthal_tt: von_mises_scale(material.gamma_tt_rad),
        }
    }
}

/// 5th power of 1 − cos θ_i, the angular part of [`fresnel`].
pub fn schlick(cos_theta_i: f64) -> f64 {
    (1.0 - cos_theta_i).max(0.0).powi(5)
}

/// F = C_R + (1 − C_R)(1 − cos θ_i)⁵ [Khungurn2015].
pub fn fresnel(color_r: DVec3, cos_theta_i: f64) -> DVec3 {
    color_r + (DVec3::ONE - color_r) * schlick(cos_theta_i)
}

/// Share of light from θ_i that a fiber scatters, ∫ S cos θ_o dω_o = F + (1 − F) C_TT.
pub fn albedo(material: &Material, cos_theta_i: f64) -> DVec3 {
    let f = fresnel(material.color_r, cos_theta_i);
    f + (DVec3::ONE - f) * material.color_tt
}

/// S = F/(2π) M_R + (1 − F) C_TT M_TT N_TT [Khungurn2015; WuYuksel2018 Eq. 6].
pub fn fiber_scattering(material: &Material, normalizers: &Normalizers, angles: &FiberAngles) -> DVec3 {
    let f = fresnel(material.color_r, angles.cos_theta_i);
    let offset = angles.cone_offset_rad();
    let m_r = gaussian(offset, material.beta_r_rad) / normalizers.integral_r;
    let m_tt = gaussian(offset, material.beta_tt_rad) / normalizers.integral_tt;
    let n_tt = von_mises(angles.cos_phi, material.gamma_tt_rad, normalizers.azimuthal_tt);
    f * (UNIFORM * m_r) + (DVec3::ONE - f) * material.color_tt * (m_tt * n_tt)
}

/// Radiance at a pixel of the fiber per irradiance of a light (on a plane that faces it):
/// (1 − w) S cos θ_i + w diffuse/π max(n·l, 0), with n the fiber's surface normal at the pixel.
///
/// [WuYuksel2018 §4.3] adds the diffuse term to S, which can give back more light than came in; mixing by w cannot.
pub fn physical_reflected(
    material: &Material,
    normalizers: &Normalizers,
    angles: &FiberAngles,
    cos_normal_light: f64,
) -> DVec3 {
    let w = material.diffuse_weight;
    fiber_scattering(material, normalizers, angles) * ((1.0 - w) * angles.cos_theta_i)
        + material.diffuse * (w * FRAC_1_PI * cos_normal_light.max(0.0))
}

/// The three scalars of the ambient term for one θ_o, from which any colours follow [WuYuksel2018, Eq. 8].
///
/// F depends on θ_i and stays inside the integral. With s = (1 − cos θ_i)⁵ it is C_R + (1 − C_R) s, and 1 − F is (1 − C_R)(1 − s), so
/// ∫ S cos θ_i dω_i = C_R `reflect` + (1 − C_R) (`reflect_grazing` + C_TT `transmit`); both azimuthal integrals are 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmbientFactors {
    /// ∫ M_R cos²θ_i dθ_i.
    pub reflect: f64,
    /// ∫ s M_R cos²θ_i dθ_i.
    pub reflect_grazing: f64,
    /// ∫ (1 − s) M_TT cos²θ_i dθ_i.
    pub transmit: f64,
}

/// Radiance of the fiber under unit radiance from all directions: (1 − w) ∫ S cos θ_i dω_i + w diffuse.
pub fn physical_ambient(material: &Material, factors: &AmbientFactors) -> DVec3 {
    let (c_r, w) = (material.color_r, material.diffuse_weight);
    let fiber = c_r * factors.reflect
        + (DVec3::ONE - c_r) * (DVec3::splat(factors.reflect_grazing) + material.color_tt * factors.transmit);
    fiber * (1.0 - w) + material.diffuse * w
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::super::MATERIAL_NAMES;
    use super::super::quadrature::simpson;
    use super::*;

    /// ∫ S cos θ_o dω_o for light from θ_i, by the two integrals in turn.
    fn furnace(material: &Material, normalizers: &Normalizers, theta_i: f64) -> DVec3 {
        let channel = |c: usize| {
            let at = |theta_o: f64, phi: f64| {
                let angles = FiberAngles::from_radians(theta_i, theta_o, phi);
                fiber_scattering(material, normalizers, &angles)[c] * theta_o.cos().powi(2)
            };
            // The lobes are narrow in θ_o and symmetric in φ.
            let ring = |theta_o: f64| 2.0 * simpson(0.0, PI, 40, |phi| at(theta_o, phi));
            let reach = 8.0 * material.beta_tt_rad;
            let narrow = 8.0 * material.beta_r_rad;
            let cuts = [-reach, -narrow, narrow, reach].map(|d| (d - theta_i).clamp(-FRAC_PI_2, FRAC_PI_2));
            cuts.windows(2).map(|w| simpson(w[0], w[1], 60, ring)).sum::<f64>()
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }

    const THETA_I_DEG: [f64; 6] = [0.0, 20.0, -45.0, 80.0, -89.0, 90.0];

    #[test]
    fn every_material_gives_back_its_albedo() {
        for name in MATERIAL_NAMES {
            let material = Material::preset(name).expect(name);
            for theta_i in THETA_I_DEG.map(f64::to_radians) {
                let normalizers = Normalizers::exact(&material, theta_i);
                let expected = albedo(&material, theta_i.cos());
                let error = (furnace(&material, &normalizers, theta_i) - expected).abs().max_element();
                assert!(error < 1e-5, "{name}, θ_i {theta_i}: {error}");
            }
        }
    }

    #[test]
    fn wrong_normalisations_are_rejected_by_the_furnace() {
        let material = Material::preset("silk-2").expect("preset");
        let theta_i = 45_f64.to_radians();
        let exact = Normalizers::exact(&material, theta_i);
        let expected = albedo(&material, theta_i.cos());
        let unprojected = |beta: f64| simpson(-FRAC_PI_2, FRAC_PI_2, 4000, |t| gaussian(t + theta_i, beta) * t.cos());
        for wrong in [
            // Normalised at θ_i = 0 for all θ_i; by one cosine; the von Mises factor without 2π.
            Normalizers { azimuthal_tt: exact.azimuthal_tt, ..Normalizers::exact(&material, 0.0) },
            Normalizers { integral_r: unprojected(material.beta_r_rad), ..exact },
            Normalizers { azimuthal_tt: exact.azimuthal_tt * 2.0 * PI, ..exact },
        ] {
            let error = (furnace(&material, &wrong, theta_i) - expected).abs().max_element();
            assert!(error > 0.02, "{wrong:?}: {error}");
        }
    }

    #[test]
    fn the_mix_with_the_diffuse_term_never_gives_back_more_than_came_in() {
        // Averaged over a fiber's width and all directions, Lambert gives back exactly `diffuse`.
        for name in MATERIAL_NAMES {
            let material = Material::preset(name).expect(name);
            let w = material.diffuse_weight;
            let total = albedo(&material, 1.0) * (1.0 - w) + material.diffuse * w;
            assert!(total.max_element() <= 1.0, "{name}: {total}");
        }
    }
}
