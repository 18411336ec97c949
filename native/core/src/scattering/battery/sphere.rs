//! Integrals over all directions, by Gauss–Legendre quadrature between cuts where a model is narrow or has a kink.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use glam::DVec3;

use super::Case;

/// Nodes and weights of Gauss–Legendre quadrature on [−1, 1], by Newton's method on the Legendre polynomial.
fn gauss_legendre<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|k| {
        let mut x = (PI * (k as f64 + 0.75) / (N as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..50 {
            let (mut p, mut before) = (x, 1.0);
            for n in 2..=N {
                let n = n as f64;
                (p, before) = (((2.0 * n - 1.0) * x * p - (n - 1.0) * before) / n, p);
            }
            slope = N as f64 * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// Nodes and weights over the intervals between sorted cuts.
pub fn nodes(cuts: Vec<f64>) -> Vec<(f64, f64)> {
    nodes_of_order::<8>(cuts)
}

/// The same with N nodes to an interval.
pub fn nodes_of_order<const N: usize>(mut cuts: Vec<f64>) -> Vec<(f64, f64)> {
    cuts.sort_by(f64::total_cmp);
    let rule = gauss_legendre::<N>();
    let intervals = cuts.windows(2).filter(|pair| pair[1] - pair[0] > 1e-12);
    let nodes = intervals.flat_map(|pair| {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        rule.map(|(x, w)| (middle + half * x, half * w))
    });
    nodes.collect()
}

impl Case {
    /// Nodes over θ for a direction at `theta`: dense about the specular cone and, where normalisers change quickly, the poles.
    pub fn longitudes(&self, theta: f64) -> Vec<(f64, f64)> {
        let mut cuts = vec![-FRAC_PI_2, FRAC_PI_2, 0.0, -FRAC_PI_4, FRAC_PI_4];
        // Fresnel terms change within the angle that is left to the pole.
        let left = (FRAC_PI_2 - theta.abs()).max(1e-6);
        for width in self.widths.iter().chain([&left]) {
            for k in [-9.0, -6.0, -4.0, -2.5, -1.2, 0.0, 1.2, 2.5, 4.0, 6.0, 9.0] {
                cuts.push((k * width - theta).clamp(-FRAC_PI_2, FRAC_PI_2));
            }
            for k in [0.5, 1.0, 2.0, 4.0] {
                let near = (FRAC_PI_2 - k * width).max(0.0);
                cuts.extend([-near, near]);
            }
        }
        nodes(cuts)
    }

    /// Nodes over φ about the fiber for a direction at azimuth `phi`, with cuts where the Lambert term of normal 0 begins.
    pub fn azimuths(&self, phi: f64) -> Vec<(f64, f64)> {
        let wrap = |x: f64| (x + PI).rem_euclid(TAU) - PI;
        let mut cuts = vec![-PI, -FRAC_PI_2, 0.0, FRAC_PI_2, PI, wrap(phi)];
        cuts.extend(
            [-8.0, -5.0, -3.0, -1.5, 0.0, 1.5, 3.0, 5.0, 8.0].map(|k| wrap(phi + PI + (k * self.gamma).clamp(-PI, PI))),
        );
        nodes(cuts)
    }

    /// ∫ f over the sphere, with θ and φ about the fiber, for a function that is narrow where this case's is for the direction `given`.
    pub fn integrate(&self, given: DVec3, f: impl Fn(DVec3) -> DVec3) -> DVec3 {
        let theta_given = given.z.atan2(given.truncate().length());
        let azimuths = self.azimuths(given.y.atan2(given.x));
        let mut sum = DVec3::ZERO;
        for (theta, weight_theta) in self.longitudes(theta_given) {
            for (phi, weight_phi) in &azimuths {
                let d = DVec3::new(theta.cos() * phi.cos(), theta.cos() * phi.sin(), theta.sin());
                sum += f(d) * (weight_theta * weight_phi * theta.cos());
            }
        }
        sum
    }
}

#[test]
fn the_quadrature_is_right_for_a_polynomial_and_a_sphere() {
    let integral: f64 = nodes(vec![0.0, 0.3, 1.0]).iter().map(|(x, w)| w * x.powi(9)).sum();
    assert!((integral - 0.1).abs() < 1e-14, "{integral}");
    for case in super::cases() {
        for given in super::viewers() {
            // Area, and the Lambert cosine's π.
            let area = case.integrate(given, |d| DVec3::new(1.0, d.x.max(0.0), d.z * d.z)) / PI;
            assert!((area - DVec3::new(4.0, 1.0, 4.0 / 3.0)).abs().max_element() < 1e-9, "{}: {area}", case.name);
        }
    }
}
