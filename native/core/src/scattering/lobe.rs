use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use super::azimuthal::UNIFORM;

/// A density of directions about a fiber, given one direction, that random numbers turn into directions in closed form.
///
/// Directions are in the axes of [`super::FiberFrame`]. A cone's longitude follows a logistic density about −θ, cut off at ±π/2, which
/// stands for a Gaussian; every density of the models divided by its lobe is bounded, so that weights are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// About the specular cone.
    Cone {
        /// Standard deviation of the Gaussian that the longitude stands for, radians.
        sigma_rad: f64,
        /// Density of the azimuth to the given direction.
        azimuth: Azimuth,
    },
    /// ∝ cosine to the surface normal.
    Lambert,
    /// Uniform in longitude and azimuth.
    Even,
}

/// Densities of the azimuth φ about the fiber.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Azimuth {
    /// 1 / 2π.
    Uniform,
    /// ¼ cos(φ/2).
    HalfCosine,
    /// Wrapped Cauchy about π, √(r² − 1) / (2π (r + cos φ)), with `excess` = r − 1.
    Straight {
        /// r − 1 > 0.
        excess: f64,
    },
}

impl Azimuth {
    /// The wrapped Cauchy density that a von Mises density of concentration γ⁻² exceeds the least: by at most 1.53 [BestFisher1979].
    ///
    /// Their r = (1 + √(1 + 4κ²)) / 2κ with κ = γ⁻², rearranged so that r − 1 keeps its digits.
    pub fn straight(gamma_rad: f64) -> Self {
        let half = 0.5 * gamma_rad * gamma_rad;
        let square = half * half;
        Self::Straight { excess: half + square / (1.0 + (1.0 + square).sqrt()) }
    }

    fn sample(self, u: f64) -> f64 {
        match self {
            Self::Uniform => TAU * u,
            Self::HalfCosine => 2.0 * (2.0 * u - 1.0).asin(),
            Self::Straight { excess } => PI + 2.0 * ((excess / (excess + 2.0)).sqrt() * (PI * (u - 0.5)).tan()).atan(),
        }
    }

    fn density(self, cos_phi: f64) -> f64 {
        match self {
            Self::Uniform => UNIFORM,
            Self::HalfCosine => 0.25 * (0.5 + 0.5 * cos_phi).max(0.0).sqrt(),
            Self::Straight { excess } => UNIFORM * (excess * (excess + 2.0)).sqrt() / (excess + 1.0 + cos_phi),
        }
    }
}

/// Scale of the logistic density whose ratio to a Gaussian of σ = 1 is least at its greatest: 1.08.
const LOGISTIC_SCALE: f64 = 0.65;

/// A logistic density cut off at ±π/2.
struct Longitude {
    center: f64,
    scale: f64,
    below: f64,
    inside: f64,
}

impl Longitude {
    fn new(center: f64, sigma: f64) -> Self {
        let scale = LOGISTIC_SCALE * sigma;
        let cumulative = |x: f64| 1.0 / (1.0 + ((center - x) / scale).exp());
        let below = cumulative(-FRAC_PI_2);
        Self { center, scale, below, inside: cumulative(FRAC_PI_2) - below }
    }

    fn sample(&self, u: f64) -> f64 {
        let p = self.below + u * self.inside;
        (self.center + self.scale * (p / (1.0 - p)).ln()).clamp(-FRAC_PI_2, FRAC_PI_2)
    }

    fn density(&self, theta: f64) -> f64 {
        let e = (-((theta - self.center) / self.scale).abs()).exp();
        e / (self.scale * (1.0 + e).powi(2) * self.inside)
    }
}

fn longitude_rad(direction: DVec3) -> f64 {
    direction.z.atan2(direction.truncate().length())
}

impl Lobe {
    /// A direction for two numbers in [0, 1).
    pub fn sample(self, given: DVec3, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Cone { sigma_rad, azimuth } => {
                let theta = Longitude::new(-longitude_rad(given), sigma_rad).sample(u[0]);
                let across = given.truncate().try_normalize().unwrap_or(DVec2::X);
                (across.rotate(DVec2::from_angle(azimuth.sample(u[1]))) * theta.cos()).extend(theta.sin())
            }
            Self::Lambert => {
                let across = DVec2::from_angle(TAU * u[1]) * u[0].sqrt();
                DVec3::new((1.0 - u[0]).sqrt(), across.x, across.y)
            }
            Self::Even => {
                let theta = PI * (u[0] - 0.5);
                (DVec2::from_angle(TAU * u[1]) * theta.cos()).extend(theta.sin())
            }
        }
    }

    /// Density of [`Lobe::sample`] over the solid angle, 1/sr.
    pub fn density(self, given: DVec3, direction: DVec3) -> f64 {
        let cos_theta = direction.truncate().length();
        if cos_theta <= 0.0 {
            // The cosine of the solid angle is 0, and so is what any model scatters into it.
            return 0.0;
        }
        match self {
            Self::Cone { sigma_rad, azimuth } => {
                // The azimuth to a direction along the fiber is that to the normal.
                let across = given.truncate().try_normalize().unwrap_or(DVec2::X);
                let cos_phi = direction.truncate().dot(across) / cos_theta;
                let longitude = Longitude::new(-longitude_rad(given), sigma_rad);
                longitude.density(longitude_rad(direction)) / cos_theta * azimuth.density(cos_phi.clamp(-1.0, 1.0))
            }
            Self::Lambert => FRAC_1_PI * direction.x.max(0.0),
            Self::Even => FRAC_1_PI * UNIFORM / cos_theta,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{gaussian, von_mises, von_mises_scale};
    use super::*;

    #[test]
    fn the_straight_azimuth_bounds_a_von_mises_density_of_any_width() {
        let mut worst = 0.0_f64;
        for gamma in [0.001, 0.01, 0.1, 0.35, 0.67, 1.0, 1.57] {
            let (scale, azimuth) = (von_mises_scale(gamma), Azimuth::straight(gamma));
            for k in 0..=2000 {
                let cos_phi = -(gamma * 8.0 * f64::from(k) / 2000.0).min(PI).cos();
                worst = worst.max(von_mises(cos_phi, gamma, scale) / azimuth.density(cos_phi));
            }
        }
        assert!((1.5..1.53).contains(&worst), "{worst}");
    }

    #[test]
    fn the_logistic_longitude_bounds_a_gaussian() {
        let sigma = 0.02;
        let longitude = Longitude::new(0.1, sigma);
        let ratio = |x: f64| gaussian(x, sigma) / (TAU.sqrt() * sigma) / longitude.density(0.1 + x);
        let worst = (0..=1000).map(|k| ratio(8.0 * sigma * f64::from(k) / 1000.0)).fold(0.0, f64::max);
        assert!((1.08..1.085).contains(&worst), "{worst}");
    }
}
