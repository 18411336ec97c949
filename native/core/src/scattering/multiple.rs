use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;

use super::azimuthal::{von_mises, von_mises_scale};
use super::physical::fresnel;
use super::quadrature::simpson;

/// Fibers that a straight path through the cloth meets: two or three yarns of the presets.
const CLOTH_DEPTH: f64 = 20.0;

/// Colour of a cloth of such fibers under light from all directions, all orders of scattering.
///
/// Two-stream reflectance of a layer, r (1 − e) / (1 − r² e), r = (1 − γ)/(1 + γ), γ = √(1 − a'), e = exp(−4 γ τ'), where similarity turns
/// albedo a, mean cosine g and depth τ into those of isotropic scatterers: τ' = (1 − a g) τ, a' = a (1 − g)/(1 − a g). Here
/// a = F + (1 − F) C_TT with F at its mean over all light; TT goes straight on by the mean cosine of its von Mises density, R to all sides.
///
/// Within 0.06 of random walks for every preset (tested).
pub fn cloth_color(color_r: DVec3, color_tt: DVec3, gamma_tt_rad: f64) -> DVec3 {
    // Light from all sides meets a fiber with density ∝ cos²θ.
    let over_light = |c: usize| {
        simpson(0.0, FRAC_PI_2, 64, |theta| fresnel(color_r, theta.cos())[c] * theta.cos().powi(2)) / FRAC_PI_4
    };
    let scale = von_mises_scale(gamma_tt_rad);
    let reach = PI - (12.0 * gamma_tt_rad).min(PI);
    let straight = 2.0 * simpson(reach, PI, 400, |phi| -phi.cos() * von_mises(phi.cos(), gamma_tt_rad, scale));
    let channel = |c: usize| {
        let f = over_light(c);
        let transmitted = (1.0 - f) * color_tt[c];
        let albedo = f + transmitted;
        // a g is what goes straight on; 0 where nothing is scattered.
        let forward = transmitted * straight;
        let depth = (1.0 - forward) * CLOTH_DEPTH;
        // 1 − a' = (1 − a)/(1 − a g), kept above 0: the layer's limit for a' → 1 is then reached without a division by 0.
        let root = ((1.0 - albedo) / (1.0 - forward)).max(1e-12).sqrt();
        let deep = (1.0 - root) / (1.0 + root);
        let through = (-4.0 * root * depth).exp();
        deep * (1.0 - through) / (1.0 - deep * deep * through)
    };
    DVec3::new(channel(0), channel(1), channel(2)).clamp(DVec3::ZERO, DVec3::ONE)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec2;

    use super::super::{MATERIAL_NAMES, Material};
    use super::*;
    use crate::sampling::{hash_combine, unit_from_hash};

    struct Random(u32);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(1);
            unit_from_hash(hash_combine(77, self.0))
        }

        fn normal(&mut self) -> f64 {
            (-2.0 * (1.0 - self.unit()).ln()).sqrt() * (TAU * self.unit()).cos()
        }

        /// θ_o with density M cos²θ_o: a Gaussian, thinned by the cosines relative to about their greatest.
        fn longitude(&mut self, theta_i: f64, beta: f64) -> f64 {
            let greatest = (theta_i.abs() - 4.0 * beta).max(0.0).cos();
            loop {
                let theta_o = beta * self.normal() - theta_i;
                if theta_o.abs() < FRAC_PI_2 && self.unit() * greatest.powi(2) < theta_o.cos().powi(2) {
                    return theta_o;
                }
            }
        }

        fn azimuth(&mut self, gamma: f64) -> f64 {
            loop {
                let phi = TAU * self.unit();
                if self.unit() < von_mises(phi.cos(), gamma, 1.0) {
                    return phi;
                }
            }
        }
    }

    /// Reflectance of a layer of fibers with random directions in its plane, one channel, by random walks.
    fn walk(material: &Material, channel: usize, random: &mut Random) -> f64 {
        const WALKS: u32 = 2000;
        let mut reflected = 0.0;
        for _ in 0..WALKS {
            let (cos, azimuth) = (random.unit().sqrt(), TAU * random.unit());
            let across = (1.0 - cos * cos).sqrt();
            let mut direction = DVec3::new(across * azimuth.cos(), across * azimuth.sin(), -cos);
            let (mut height, mut weight) = (0.0, 1.0);
            while weight > 1e-3 {
                height -= direction.z * (1.0 - random.unit()).ln();
                if height > 0.0 {
                    reflected += weight;
                    break;
                }
                if height < -CLOTH_DEPTH {
                    break;
                }
                // Fibers are met in proportion to their projected length.
                let to_light = -direction;
                let tangent = loop {
                    let tangent = DVec2::from_angle(TAU * random.unit()).extend(0.0);
                    if random.unit() < to_light.cross(tangent).length() {
                        break tangent;
                    }
                };
                let theta_i = to_light.dot(tangent).clamp(-1.0, 1.0).asin();
                let f = fresnel(material.color_r, theta_i.cos())[channel];
                let albedo = f + (1.0 - f) * material.color_tt[channel];
                let (theta_o, phi) = if random.unit() < f / albedo {
                    (random.longitude(theta_i, material.beta_r_rad), TAU * random.unit())
                } else {
                    (random.longitude(theta_i, material.beta_tt_rad), random.azimuth(material.gamma_tt_rad))
                };
                let across = (to_light - tangent * theta_i.sin()).normalize();
                let side = tangent.cross(across);
                direction = tangent * theta_o.sin() + (across * phi.cos() + side * phi.sin()) * theta_o.cos();
                weight *= albedo;
            }
        }
        reflected / f64::from(WALKS)
    }

    #[test]
    fn the_colour_is_that_of_random_walks_among_fibers() {
        let mut random = Random(1);
        let (mut worst, mut worst_without_similarity) = (0.0_f64, 0.0_f64);
        for name in MATERIAL_NAMES {
            let material = Material::preset(name).expect(name);
            let color = cloth_color(material.color_r, material.color_tt, material.gamma_tt_rad);
            // As if TT scattered to all sides, which the same check rejects.
            let isotropic = cloth_color(material.color_r, material.color_tt, 100.0);
            for channel in 0..3 {
                let walked = walk(&material, channel, &mut random);
                worst = worst.max((color[channel] - walked).abs());
                worst_without_similarity = worst_without_similarity.max((isotropic[channel] - walked).abs());
            }
            println!("{name}: {color:.3}");
        }
        println!("within {worst:.3}; without similarity {worst_without_similarity:.3}");
        assert!(worst < 0.06 && worst_without_similarity > 0.06, "{worst} {worst_without_similarity}");
    }

    #[test]
    fn extreme_colours_stay_in_range() {
        for (c_r, c_tt) in [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0)] {
            for gamma in [0.001, 0.3, 1.5] {
                let color = cloth_color(DVec3::splat(c_r), DVec3::splat(c_tt), gamma);
                assert!(color.is_finite() && color.min_element() >= 0.0 && color.max_element() <= 1.0, "{color}");
            }
        }
    }
}
