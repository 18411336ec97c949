//! Directions about an axis by a spherical Gaussian.

use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;

use glam::DVec3;

use crate::sampling::basis;

/// A density over the sphere proportional to exp(λ (ω·d − 1)): the density of Fisher's distribution [Fisher1953, §2], and the radiance of a
/// spherical-Gaussian light [Khungurn2017].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Unit, its brightest direction.
    axis: DVec3,
    axes: (DVec3, DVec3),
    sharpness: f64,
}

impl Lobe {
    /// Sharpnesses that a lobe can have: from all but even to one that is narrower than any sun, with densities that stay finite.
    pub const SHARPNESS: RangeInclusive<f64> = 1e-6..=1e12;

    /// A lobe about a direction of any length but 0, with λ in [`Self::SHARPNESS`].
    pub fn new(toward: DVec3, sharpness: f64) -> Self {
        let axis = toward.normalize();
        Self { axis, axes: basis(axis), sharpness }
    }

    /// A direction for two numbers in [0, 1), with the density [`Self::pdf`].
    ///
    /// The share of directions within 1 − cos θ = h of the axis is (1 − e^(−λh)) / (1 − e^(−2λ)); solved for h.
    pub fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        let lowered = (-(u * (-2.0 * self.sharpness).exp_m1()).ln_1p() / self.sharpness).clamp(0.0, 2.0);
        // sin² θ = (1 − cos θ) (1 + cos θ)
        let sine = (lowered * (2.0 - lowered)).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        (self.axis * (1.0 - lowered) + (self.axes.0 * cos + self.axes.1 * sin) * sine).normalize()
    }

    /// Density over the solid angle at a unit direction: λ exp(λ (ω·d − 1)) / (2π (1 − e^(−2λ))).
    pub fn pdf(&self, direction: DVec3) -> f64 {
        // 1 − ω·d without the loss of digits where both are near.
        let lowered = 0.5 * (direction - self.axis).length_squared();
        -self.sharpness * (-self.sharpness * lowered).exp() / (2.0 * PI * (-2.0 * self.sharpness).exp_m1())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Use, pair};

    const SHARPNESSES: [f64; 8] = [1e-6, 1e-3, 0.3, 1.0, 5.0, 100.0, 1e6, 1e12];

    fn lobe(sharpness: f64) -> Lobe {
        Lobe::new(DVec3::new(0.4, -2.0, 1.0), sharpness)
    }

    /// 1 − cos θ and the angle about the axis, in turns.
    fn polar(lobe: &Lobe, direction: DVec3) -> [f64; 2] {
        let around = direction.dot(lobe.axes.1).atan2(direction.dot(lobe.axes.0)) / TAU;
        [0.5 * (direction - lobe.axis).length_squared(), around.rem_euclid(1.0).min(1.0 - 1e-12)]
    }

    /// ∫ of the density over 1 − cos θ from a to b and all around, by Simpson's rule.
    fn quadrature(lobe: &Lobe, a: f64, b: f64) -> f64 {
        const STEPS: u32 = 200;
        let at = |i: u32| {
            let lowered = a + (b - a) * f64::from(i) / f64::from(STEPS);
            let sine = (lowered * (2.0 - lowered)).max(0.0).sqrt();
            lobe.pdf(lobe.axis * (1.0 - lowered) + lobe.axes.0 * sine)
        };
        let weight = |i| if i == 0 || i == STEPS { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        (0..=STEPS).map(|i| weight(i) * at(i)).sum::<f64>() * (b - a) / f64::from(STEPS) / 3.0 * TAU
    }

    /// Where 1 − cos θ is cut into bins: even ones over the part that has all but e⁻³⁰ of the light.
    fn edges(sharpness: f64) -> Vec<f64> {
        let reach = (30.0 / sharpness).min(2.0);
        (0..=24).map(|i| reach * f64::from(i) / 24.0).collect()
    }

    #[test]
    fn the_density_integrates_to_one() {
        for sharpness in SHARPNESSES {
            let total: f64 = edges(sharpness).windows(2).map(|bin| quadrature(&lobe(sharpness), bin[0], bin[1])).sum();
            // Where λ is 1e12, axis and direction of 53 bits leave 1e-4 of h.
            let bound = if sharpness > 1e9 { 1e-3 } else { 1e-7 };
            assert!((total - 1.0).abs() < bound, "λ {sharpness}: {total}");
        }
    }

    /// χ² of directions by one lobe in bins about its axis, with the shares that the density of another has there, in standard deviations
    /// beyond its mean.
    fn deviation(drawn: impl Fn([f64; 2]) -> DVec3, density: &Lobe) -> f64 {
        const SAMPLES: u32 = 40_000;
        const TURNS: usize = 6;
        let edges = edges(density.sharpness);
        let mut counts = vec![0.0_f64; (edges.len() - 1) * TURNS];
        // Independent numbers: even ones have a χ² far below that of any distribution.
        let mut random = crate::sampling::Random::new(1, 2, 3);
        for _ in 0..SAMPLES {
            let [lowered, around] = polar(density, drawn(random.pair()));
            let bin = edges.partition_point(|edge| *edge <= lowered).clamp(1, edges.len() - 1) - 1;
            counts[bin * TURNS + (around * TURNS as f64) as usize] += 1.0;
        }
        let (mut sum, mut freedoms, mut rest) = (0.0, -1.0, [0.0, 0.0]);
        for (bin, counts) in counts.chunks(TURNS).enumerate() {
            let share = quadrature(density, edges[bin], edges[bin + 1]) / TURNS as f64;
            let expected = share * f64::from(SAMPLES);
            for count in counts {
                // Rare bins go together.
                if expected >= 8.0 {
                    sum += (count - expected).powi(2) / expected;
                    freedoms += 1.0;
                } else {
                    rest = [rest[0] + count, rest[1] + expected];
                }
            }
        }
        if rest[1] >= 8.0 {
            sum += (rest[0] - rest[1]).powi(2) / rest[1];
            freedoms += 1.0;
        }
        (sum - freedoms) / (2.0_f64 * freedoms).sqrt()
    }

    #[test]
    fn samples_have_their_density() {
        for sharpness in SHARPNESSES.into_iter().filter(|sharpness| *sharpness < 1e9) {
            let lobe = lobe(sharpness);
            let found = deviation(|uniform| lobe.sample(uniform), &lobe);
            println!("λ {sharpness}: {found:.2} σ");
            assert!(found.abs() < 4.0, "λ {sharpness}: {found} σ");
        }
        // Samplers that are nearly right: another λ, an axis a little aside, and (1 + cos θ)ⁿ, which has the same slope at the axis.
        let right = lobe(5.0);
        let aside = Lobe::new(DVec3::new(0.4, -2.0, 1.1), 5.0);
        let power = |[u, v]: [f64; 2]| {
            let (sin, cos) = (TAU * v).sin_cos();
            let height = 2.0 * (1.0 - u).powf(1.0 / 11.0) - 1.0;
            right.axis * height + (right.axes.0 * cos + right.axes.1 * sin) * (1.0 - height * height).sqrt()
        };
        for wrong in [
            deviation(|uniform| lobe(5.3).sample(uniform), &right),
            deviation(|uniform| aside.sample(uniform), &right),
            deviation(power, &right),
        ] {
            assert!(wrong > 6.0, "{wrong} σ pass");
        }
    }

    #[test]
    fn its_ends_are_a_sphere_and_a_direction() {
        let mean = |sharpness: f64| {
            (0..4096).map(|i| lobe(sharpness).sample(pair(i, 0, Use::Light(0)))).sum::<DVec3>() / 4096.0
        };
        assert!(mean(1e-6).length() < 1e-3, "{}", mean(1e-6));
        let axis = lobe(1.0).axis;
        assert!((lobe(1e-6).pdf(-axis) * 4.0 * PI - 1.0).abs() < 1e-5);
        // The mean cosine is coth λ − 1/λ.
        for sharpness in [0.3_f64, 5.0, 100.0] {
            let expected = 1.0 / sharpness.tanh() - 1.0 / sharpness;
            let found = mean(sharpness).dot(axis);
            assert!((found - expected).abs() < 1e-3, "λ {sharpness}: {found}, {expected}");
        }
        for i in 0..1000 {
            let away = (lobe(1e12).sample(pair(i, 0, Use::Light(0))) - axis).length();
            assert!(away < 1e-5, "{away}");
        }
    }
}
