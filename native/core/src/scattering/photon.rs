use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use super::Material;
use super::physical::fresnel;
use crate::sampling::Random;

/// How the physically based model sends a photon on: along the way of the light, for walks that start at it.
///
/// S scatters the share F + (1 − F) C_TT of the light from θ_i, with density ∝ S cos θ_o ([`super::albedo`]); the Lambert term that is mixed in
/// ([`super::physical_reflected`]) its albedo, from an even place of the width that faces the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonScattering {
    color_r: DVec3,
    color_tt: DVec3,
    beta_r_rad: f64,
    beta_tt_rad: f64,
    /// κ = γ_TT⁻².
    concentration: f64,
    lambert_weight: f64,
    lambert_albedo: DVec3,
}

impl PhotonScattering {
    /// Of a valid material ([`Material::validate`]).
    pub fn new(material: &Material) -> Self {
        Self {
            color_r: material.color_r,
            color_tt: material.color_tt,
            beta_r_rad: material.beta_r_rad,
            beta_tt_rad: material.beta_tt_rad,
            concentration: material.gamma_tt_rad.powi(-2),
            lambert_weight: material.diffuse_weight,
            lambert_albedo: material.diffuse,
        }
    }

    /// Draws where a photon goes that came from `wi`, and dims its `power` by what is absorbed.
    ///
    /// Both directions point away from the fiber, in axes whose z is its tangent. The lobe is drawn by how much of the power it takes on.
    pub fn scatter(&self, wi: DVec3, power: DVec3, random: &mut Random) -> (DVec3, DVec3) {
        if random.unit() < self.lambert_weight {
            return (lambert(wi, random), power * self.lambert_albedo);
        }
        let cos_theta_i = wi.truncate().length().min(1.0);
        let theta_i = wi.z.atan2(cos_theta_i);
        let f = fresnel(self.color_r, cos_theta_i);
        let (reflected, transmitted) = (power * f, power * (DVec3::ONE - f) * self.color_tt);
        let (r, tt) = (reflected.element_sum(), transmitted.element_sum());
        if r + tt <= 0.0 {
            return (wi, DVec3::ZERO);
        }
        let chance_r = r / (r + tt);
        let is_r = random.unit() < chance_r;
        let (theta_o, phi, power) = if is_r {
            (longitude(theta_i, self.beta_r_rad, random), TAU * random.unit(), reflected / chance_r)
        } else {
            let phi = PI + von_mises(self.concentration, random);
            (longitude(theta_i, self.beta_tt_rad, random), phi, transmitted / (1.0 - chance_r))
        };
        let across = wi.truncate().normalize_or(DVec2::X).rotate(DVec2::from_angle(phi));
        // The cosine is the sine of what is left to the pole, which keeps its digits.
        ((across * (FRAC_PI_2 - theta_o.abs()).sin()).extend(theta_o.sin()), power)
    }
}

/// A direction off the surface of a round fiber that light from `wi` meets evenly over its width.
fn lambert(wi: DVec3, random: &mut Random) -> DVec3 {
    let facing = wi.truncate().normalize_or(DVec2::X);
    let beside = 2.0 * random.unit() - 1.0;
    let normal = (facing * (1.0 - beside * beside).sqrt() + facing.perp() * beside).extend(0.0);
    let (height, turn) = (random.unit().sqrt(), TAU * random.unit());
    let across = (1.0 - height * height).sqrt();
    normal * height + (DVec3::Z.cross(normal) * turn.cos() + DVec3::Z * turn.sin()) * across
}

/// θ_o with density ∝ g cos²θ_o: a Gaussian about −θ_i, thinned by cos² relative to about its greatest.
fn longitude(theta_i: f64, beta: f64, random: &mut Random) -> f64 {
    let greatest = (theta_i.abs() - 4.0 * beta).max(0.0).cos().powi(2);
    loop {
        let theta_o = beta * normal(random) - theta_i;
        if theta_o.abs() < FRAC_PI_2 && random.unit() * greatest < theta_o.cos().powi(2) {
            return theta_o;
        }
    }
}

/// Box and Muller's.
fn normal(random: &mut Random) -> f64 {
    (-2.0 * (1.0 - random.unit()).ln()).sqrt() * (TAU * random.unit()).cos()
}

/// An angle about 0 with density ∝ exp(κ cos x): a wrapped Cauchy one, thinned [BestFisher1979].
fn von_mises(concentration: f64, random: &mut Random) -> f64 {
    let k = concentration;
    let tau = 1.0 + (1.0 + 4.0 * k * k).sqrt();
    let rho = (tau - (2.0 * tau).sqrt()) / (2.0 * k);
    let r = (1.0 + rho * rho) / (2.0 * rho);
    loop {
        let z = (PI * random.unit()).cos();
        let cos = (1.0 + r * z) / (r + z);
        let c = k * (r - cos);
        let u = random.unit();
        if c * (2.0 - c) > u || (c / u.max(1e-300)).ln() + 1.0 >= c {
            let angle = cos.clamp(-1.0, 1.0).acos();
            return if random.unit() < 0.5 { angle } else { -angle };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FiberAngles, MATERIAL_NAMES, Normalizers, albedo, physical_reflected};
    use super::*;

    /// Steps of sin θ_o, and of φ_o over a half turn: the model is even in φ.
    const CELLS: (usize, usize) = (12, 6);

    fn cell(w: DVec3) -> usize {
        let step = |x: f64, cells: usize| ((x * cells as f64) as usize).min(cells - 1);
        step(0.5 * w.z + 0.5, CELLS.0) * CELLS.1 + step(w.y.abs().atan2(w.x) / PI, CELLS.1)
    }

    /// Share of the light that the model sends to each cell, by quadrature in θ_o and φ.
    fn expected(material: &Material, wi: DVec3) -> Vec<DVec3> {
        const N: usize = 2400;
        let theta_i = wi.z.atan2(wi.x);
        let normalizers = Normalizers::exact(material, theta_i);
        let mut shares = vec![DVec3::ZERO; CELLS.0 * CELLS.1];
        for k in 0..N {
            let theta = PI * ((k as f64 + 0.5) / N as f64 - 0.5);
            for j in 0..60 {
                let phi = PI * (f64::from(j) + 0.5) / 60.0;
                let wo = DVec3::new(theta.cos() * phi.cos(), theta.cos() * phi.sin(), theta.sin());
                let angles = FiberAngles::from_directions(DVec3::Z, wi, wo);
                // Both signs of φ; one cosine is the solid angle's, the other that of the fiber's length.
                let weight = 2.0 * (PI / N as f64) * (PI / 60.0) * theta.cos().powi(2);
                let facing = DVec2::from_angle(phi);
                let across_width = [-0.9, -0.7, -0.5, -0.3, -0.1, 0.1, 0.3, 0.5, 0.7, 0.9].map(|beside: f64| {
                    let normal = facing * (1.0 - beside * beside).sqrt() + facing.perp() * beside;
                    let cos_normal = normal.dot(wi.truncate());
                    physical_reflected(material, &normalizers, &angles, cos_normal) / (10.0 * wi.x)
                });
                shares[cell(wo)] += across_width.iter().sum::<DVec3>() * weight;
            }
        }
        shares
    }

    fn drawn(material: &Material, wi: DVec3, photons: u32) -> Vec<DVec3> {
        let (scattering, mut random) = (PhotonScattering::new(material), Random::new(3, 1, 4));
        let mut shares = vec![DVec3::ZERO; CELLS.0 * CELLS.1];
        for _ in 0..photons {
            let (wo, power) = scattering.scatter(wi, DVec3::ONE, &mut random);
            assert!((wo.length() - 1.0).abs() < 1e-9);
            shares[cell(wo)] += power / f64::from(photons);
        }
        shares
    }

    fn worst(a: &[DVec3], b: &[DVec3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs().max_element()).fold(0.0, f64::max)
    }

    const PHOTONS: u32 = 60_000;
    /// Four standard errors of a share of one half, and of the quadrature's cells.
    const BOUND: f64 = 0.012;

    #[test]
    fn photons_go_where_the_model_sends_them() {
        let presets = MATERIAL_NAMES.map(|name| (name, Material::preset(name).expect(name)));
        let coated = ("coated", Material { diffuse_weight: 0.7, ..presets[2].1 });
        for (name, material) in presets.into_iter().chain([coated]) {
            for theta_i in [0.0_f64, 0.5, -1.0, 1.4] {
                let wi = DVec3::new(theta_i.cos(), 0.0, theta_i.sin());
                let (expected, drawn) = (expected(&material, wi), drawn(&material, wi, PHOTONS));
                let error = worst(&expected, &drawn);
                assert!(error < BOUND, "{name} at {theta_i}: {error}");
                let total: DVec3 = drawn.iter().sum();
                let w = material.diffuse_weight;
                let albedo = albedo(&material, wi.x) * (1.0 - w) + material.diffuse * w;
                assert!((total - albedo).abs().max_element() < BOUND, "{name} at {theta_i}: {total} of {albedo}");
            }
        }
    }

    #[test]
    fn photons_of_another_material_or_on_the_other_cone_are_rejected_by_the_same_check() {
        let material = Material::preset("cotton-2").expect("preset");
        let wi = DVec3::new(0.5_f64.cos(), 0.0, 0.5_f64.sin());
        let expected = expected(&material, wi);
        let wider = Material { gamma_tt_rad: 1.3 * material.gamma_tt_rad, ..material };
        let coated = Material { diffuse_weight: 0.3, ..material };
        assert!(worst(&expected, &drawn(&coated, wi, PHOTONS)) > BOUND, "Lambert's term");
        assert!(worst(&expected, &drawn(&wider, wi, PHOTONS)) > BOUND, "wider TT");
        assert!(worst(&expected, &drawn(&material, wi * DVec3::new(1.0, 1.0, -1.0), PHOTONS)) > BOUND, "other cone");
    }
}
