use std::f64::consts::TAU;

use glam::DVec2;
use lisle_core::yarn::Yarn;

use crate::profile::{PROFILE_REACH, PROFILE_SIZE, radial_profile};

/// Expected number of fiber centres per unit area of a yarn's section, in units of the outer radius.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionDensity {
    /// Plies, K.
    pub plies: u32,
    /// Fiber radius, in units of the outer radius.
    pub fiber_radius: f64,
    /// Distance from the centre beyond which the density is zero, in units of the outer radius.
    pub reach: f64,
    ply_distance: f64,
    /// From the yarn's centre to each ply's.
    ply_directions: Vec<DVec2>,
    /// Slopes at distance 1 by the twist of the plies, and of the fibers in them; signed.
    ply_slope: f64,
    fiber_slope: f64,
    /// 1/e_N and 1/e_B, in units of the outer radius.
    inverse_half_axes: DVec2,
    /// [`share_of_others`].
    pub(crate) others: f64,
    /// Fibers per area of the section, at even steps of the squared relative distance from the ply centre.
    profile: Vec<f64>,
}

/// Share of a yarn's fibers that are others than the one a point lies on.
pub(crate) fn share_of_others(yarn: &Yarn) -> f64 {
    1.0 - 1.0 / f64::from(yarn.plies * yarn.fibers_per_ply)
}

impl SectionDensity {
    /// Density of a yarn's section.
    pub fn new(yarn: &Yarn) -> Self {
        let outer = yarn.outer_radius();
        let half_axes = DVec2::new(yarn.ellipse_short, yarn.ellipse_long) / outer;
        let per_disc = f64::from(yarn.fibers_per_ply) / (half_axes.x * half_axes.y);
        let ply_distance = yarn.ply_distance() / outer;
        Self {
            plies: yarn.plies,
            fiber_radius: yarn.fiber_radius / outer,
            reach: ply_distance + PROFILE_REACH * half_axes.max_element(),
            ply_distance,
            ply_directions: (0..yarn.plies)
                .map(|ply| DVec2::from_angle(TAU * f64::from(ply) / f64::from(yarn.plies)))
                .collect(),
            ply_slope: if yarn.plies > 1 { TAU * outer / yarn.ply_twist } else { 0.0 },
            fiber_slope: TAU * outer / yarn.fiber_twist,
            inverse_half_axes: half_axes.recip(),
            others: share_of_others(yarn),
            profile: radial_profile(yarn).into_iter().map(|density| per_disc * density).collect(),
        }
    }

    /// Fibers per unit area at q.
    pub fn at(&self, q: DVec2) -> f64 {
        self.plies_at(q).map(|(fibers, _)| fibers).sum()
    }

    /// Fibers that a ray in the section meets per length at q, other than the one it starts on: fibers per area × diameter × stretch.
    ///
    /// A fiber of lateral slope t crosses the section in an ellipse, whose width across the ray is √(1 + (t × ray)²)
    /// diameters; √(1 + t²/2) on average over rays.
    pub fn extinction(&self, q: DVec2) -> f64 {
        let stretched = |(fibers, slope): (f64, DVec2)| fibers * (1.0 + 0.5 * slope.length_squared()).sqrt();
        self.plies_at(q).map(stretched).sum::<f64>() * (2.0 * self.fiber_radius * self.others)
    }

    /// Each ply's fibers per unit area at q, and their slope: how far they move across the section per length along the yarn.
    fn plies_at(&self, q: DVec2) -> impl Iterator<Item = (f64, DVec2)> {
        self.ply_directions.iter().map(move |direction| {
            let from_yarn = DVec2::new(direction.dot(q), direction.perp_dot(q));
            let relative = (from_yarn - DVec2::new(self.ply_distance, 0.0)) * self.inverse_half_axes;
            let slope = from_yarn.perp() * self.ply_slope + relative.perp() / self.inverse_half_axes * self.fiber_slope;
            (self.at_squared_distance(relative.length_squared()), direction.rotate(slope))
        })
    }

    fn at_squared_distance(&self, rho_squared: f64) -> f64 {
        let x = rho_squared / (PROFILE_REACH * PROFILE_REACH) * PROFILE_SIZE as f64 - 0.5;
        let k = x.max(0.0) as usize;
        if k + 1 >= PROFILE_SIZE {
            return 0.0;
        }
        self.profile[k] + (self.profile[k + 1] - self.profile[k]) * (x - k as f64).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use lisle_core::yarn::PRESET_NAMES;

    use super::*;
    use crate::explicit::{Random, Sections};

    /// Shares of all fibers in rings of width 0.1 around the yarn's centre; the last one is open.
    const RINGS: usize = 13;

    fn ring(q: DVec2) -> usize {
        ((q.length() * 10.0) as usize).min(RINGS - 1)
    }

    fn expected_shares(density: &SectionDensity) -> ([f64; RINGS], f64) {
        const N: u32 = 600;
        let mut shares = [0.0; RINGS];
        let cell = 2.0 * density.reach / f64::from(N);
        for k in 0..N * N {
            let at = |i: u32| (f64::from(i) + 0.5) * cell - density.reach;
            let q = DVec2::new(at(k % N), at(k / N));
            shares[ring(q)] += density.at(q) * cell * cell;
        }
        let total: f64 = shares.iter().sum();
        (shares.map(|s| s / total), total)
    }

    fn explicit_shares(yarn: &Yarn) -> [f64; RINGS] {
        let (dealer, mut random) = (Sections::of_kind(yarn), Random::new(1));
        let mut shares = [0.0; RINGS];
        let sections = 400_000 / (yarn.plies * yarn.fibers_per_ply);
        for _ in 0..sections {
            for fiber in dealer.draw(&mut random) {
                shares[ring(fiber.center)] += 1.0;
            }
        }
        let total: f64 = shares.iter().sum();
        shares.map(|s| s / total)
    }

    fn worst(a: &[f64; RINGS], b: &[f64; RINGS]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_density_counts_every_fiber_and_puts_it_where_it_is() {
        for name in PRESET_NAMES {
            let yarn = Yarn::preset(name).expect(name);
            let (shares, total) = expected_shares(&SectionDensity::new(&yarn));
            let fibers = f64::from(yarn.plies * yarn.fibers_per_ply);
            let explicit = explicit_shares(&yarn);
            println!("{name}: {:.5} of the fibers, shares within {:.4}", total / fibers, worst(&shares, &explicit));
            assert!((total / fibers - 1.0).abs() < 0.005, "{name}: {total} fibers of {fibers}");
            assert!(worst(&shares, &explicit) < 0.005, "{name}: {shares:.4?} for {explicit:.4?}");
        }
    }

    #[test]
    fn a_density_without_migration_or_flyaways_is_rejected_by_the_same_check() {
        for name in ["rayon-4", "silk-2"] {
            let yarn = Yarn::preset(name).expect(name);
            let explicit = explicit_shares(&yarn);
            let mut bare = yarn.clone();
            bare.flyaways.loop_density = 0.0;
            bare.flyaways.hair_density = 0.0;
            for wrong in [Yarn { r_min: 1.0, ..yarn }, bare] {
                let (shares, _) = expected_shares(&SectionDensity::new(&wrong));
                assert!(worst(&shares, &explicit) > 0.01, "{name}: {}", worst(&shares, &explicit));
            }
        }
    }
}
