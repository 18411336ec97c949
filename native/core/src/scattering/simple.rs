use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;

use super::longitudinal::gaussian;
use super::{FiberAngles, Material};

/// Factor of Eq. 5 that makes k_specular the highlight's albedo: 1 / (4 √(2π) β (1 + e^{−8β²})).
///
/// The albedo is k ∫ cos(φ/2) dφ ∫ exp(−θ_h²/2β²) cos²θ_o dθ_o. The first integral, over −π..π, is 4. As θ_h = (θ_o + θ_i)/2, the second is a
/// Gaussian of σ = 2β; over all θ_o it is √(2π) β (1 + cos 2θ_i e^{−8β²}), greatest at θ_i = 0, and a fiber's half circle of θ_o has less.
pub fn highlight_scale(beta_rad: f64) -> f64 {
    (4.0 * TAU.sqrt() * beta_rad * (1.0 + (-8.0 * beta_rad * beta_rad).exp())).recip()
}

/// cos(φ/2) exp(−θ_h²/2β²) [WuYuksel2018, Eq. 5] without colour and scale; θ_h is half the offset from the specular cone.
pub fn highlight(angles: &FiberAngles, beta_rad: f64) -> f64 {
    let cos_half_phi = (0.5 + 0.5 * angles.cos_phi).max(0.0).sqrt();
    cos_half_phi * gaussian(0.5 * angles.cone_offset_rad(), beta_rad)
}

/// Radiance at a pixel of the fiber per irradiance of a light (on a plane that faces it):
/// specular × scale × highlight × cos θ_i + diffuse/π max(n·l, 0), with n the fiber's surface normal at the pixel.
pub fn simple_reflected(material: &Material, angles: &FiberAngles, cos_normal_light: f64) -> DVec3 {
    let beta = material.specular_beta_rad;
    material.specular * (highlight_scale(beta) * highlight(angles, beta) * angles.cos_theta_i)
        + material.diffuse * (FRAC_1_PI * cos_normal_light.max(0.0))
}

/// Radiance of the fiber under unit radiance from all directions.
///
/// The highlight's part is (1 + cos 2θ_o e^{−8β²}) / (1 + e^{−8β²}) of its albedo, from the untruncated integral of [`highlight_scale`]: never
/// more than 1, and above the true value by at most ½ tanh 4β² (reached at θ_o = ±π/2).
pub fn simple_ambient(material: &Material, sin_theta_o: f64) -> DVec3 {
    let narrowing = (-8.0 * material.specular_beta_rad.powi(2)).exp();
    let cos_2theta_o = 1.0 - 2.0 * sin_theta_o * sin_theta_o;
    material.specular * ((1.0 + cos_2theta_o * narrowing) / (1.0 + narrowing)) + material.diffuse
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::super::MATERIAL_NAMES;
    use super::super::quadrature::simpson;
    use super::*;

    /// Albedo of the highlight for unit k_specular.
    fn furnace(beta: f64, scale: f64, theta_i: f64) -> f64 {
        simpson(-FRAC_PI_2, FRAC_PI_2, 2000, |theta_o| {
            let ring = simpson(-PI, PI, 32, |phi| highlight(&FiberAngles::from_radians(theta_i, theta_o, phi), beta));
            scale * ring * theta_o.cos().powi(2)
        })
    }

    #[test]
    fn the_highlight_gives_back_at_most_its_colour_and_all_of_it_across_the_fiber() {
        for beta in [0.0175, 0.087, 0.236] {
            let scale = highlight_scale(beta);
            for theta_i in [0.0, 0.3, -0.9, 1.4, FRAC_PI_2] {
                let albedo = furnace(beta, scale, theta_i);
                assert!(albedo <= 1.0 + 1e-6, "β {beta}, θ_i {theta_i}: {albedo}");
            }
            assert!(furnace(beta, scale, 0.0) > 0.999, "β {beta}");
        }
        // Without the factor the same check fails.
        assert!(furnace(0.236, 1.0, 0.0) > 1.5);
    }

    #[test]
    fn diffuse_and_highlight_together_conserve_energy() {
        for name in MATERIAL_NAMES {
            let material = Material::preset(name).expect(name);
            let scale = highlight_scale(material.specular_beta_rad);
            let share = furnace(material.specular_beta_rad, scale, 0.0);
            assert!((material.specular * share + material.diffuse).max_element() <= 1.0 + 1e-6, "{name}");
        }
    }

    #[test]
    fn a_lambert_cylinder_gives_back_its_diffuse_colour() {
        // Radiance averaged over the fiber's width as seen from φ_o = 0, then over all viewers: the contract's unit for `diffuse`.
        let theta_i = 0.6_f64;
        let surface = |phi_o: f64| {
            // A point at angle a on the surface covers cos(a − φ_o)/2 of the width; n·l = cos θ_i cos a.
            simpson(-FRAC_PI_2, FRAC_PI_2, 200, |a| {
                0.5 * (a - phi_o).cos().max(0.0) * FRAC_1_PI * theta_i.cos() * a.cos()
            })
        };
        let over_azimuth = simpson(-PI, PI, 200, surface);
        let over_longitude = simpson(-FRAC_PI_2, FRAC_PI_2, 50, |theta_o| theta_o.cos().powi(2));
        let albedo = over_azimuth * over_longitude / theta_i.cos();
        assert!((albedo - 1.0).abs() < 1e-4, "{albedo}");
    }

    #[test]
    fn the_ambient_term_is_the_integral_over_all_light() {
        for beta in [0.0175, 0.087, 0.236_f64] {
            let bound = 0.5 * (4.0 * beta * beta).tanh() + 1e-4;
            let white = Material {
                specular: DVec3::ONE,
                diffuse: DVec3::ZERO,
                specular_beta_rad: beta,
                ..Material::preset("silk").expect("preset")
            };
            for theta_o in [0.0, 0.5, -1.2, 1.5, FRAC_PI_2] {
                // The highlight is symmetric in θ_i and θ_o, so its furnace in one is that in the other.
                let exact = furnace(beta, highlight_scale(beta), theta_o);
                let closed = simple_ambient(&white, theta_o.sin()).x;
                assert!((-1e-6..bound).contains(&(closed - exact)), "β {beta}, θ_o {theta_o}: {closed} for {exact}");
            }
        }
    }
}
