use std::f64::consts::PI;

use lisle_core::yarn::{HAIR_WIDTH, Variate, Yarn, acceptance, radial_density};

/// Relative distance from the ply centre up to which the profile goes. Longer hairs are rare and left out beyond it.
pub const PROFILE_REACH: f64 = 2.5;
/// Cells of the profile: rings of equal area, so that the innermost are not starved.
pub const PROFILE_SIZE: usize = 1024;

const RING_AREA: f64 = PI * PROFILE_REACH * PROFILE_REACH / PROFILE_SIZE as f64;

/// Start radii R_i, phases and variates that are averaged.
const STARTS: usize = 128;
const PHASES: u32 = 96;
const UNIFORMS: u32 = 4;
const VARIATES: u32 = UNIFORMS * UNIFORMS * UNIFORMS;

/// Fibers per area of a ply's unit disc, for one fiber, in rings of equal area up to [`PROFILE_REACH`].
///
/// The fiber's radius over all phases of a period [WuYuksel2018, Eq. 2] and all types. The paper's tables leave loops and hairs out; here they count, since
/// without them the transmittance of rays comes out too high by up to 0.2.
pub fn radial_profile(yarn: &Yarn) -> Vec<f64> {
    let starts = Starts::new(yarn);
    let (loop_chance, hair_chance) = yarn.flyaway_chances();
    let accepted = acceptance(yarn.density_beta, yarn.density_epsilon);
    let mut rings = Rings(vec![0.0; PROFILE_SIZE]);
    for (start, share) in starts.flyaways() {
        loops(yarn, start, |rho, part| rings.add(rho, share * loop_chance * part));
        hairs(yarn, start, |rho, part| rings.add(rho, share * hair_chance * part));
    }
    (0..PROFILE_SIZE)
        .map(|k| {
            let rho = PROFILE_REACH * ((k as f64 + 0.5) / PROFILE_SIZE as f64).sqrt();
            rings.0[k] / RING_AREA + migrating_density(yarn, &starts, accepted, loop_chance + hair_chance, rho)
        })
        .collect()
}

/// Start radii at even steps of R², the disc's area.
struct Starts {
    /// Share of all fibers at each.
    share: Vec<f64>,
    /// Chance that a fiber that starts there is one of the [`Yarn::flyaway_fibers`] outermost.
    outermost: Vec<f64>,
}

impl Starts {
    fn new(yarn: &Yarn) -> Self {
        let density = |k: usize| radial_density(radius(k), yarn.density_beta, yarn.density_epsilon);
        let total: f64 = (0..STARTS).map(density).sum();
        let share: Vec<f64> = (0..STARTS).map(|k| density(k) / total).collect();
        let mut farther = 0.0;
        let mut outermost: Vec<f64> = share
            .iter()
            .rev()
            .map(|share| {
                let chance = at_most(yarn.flyaway_fibers(), yarn.fibers_per_ply - 1, farther + 0.5 * share);
                farther += share;
                chance
            })
            .collect();
        outermost.reverse();
        Self { share, outermost }
    }

    /// Radius, and share of all fibers that start there and may fly away.
    fn flyaways(&self) -> impl Iterator<Item = (f64, f64)> {
        let share = self.share.iter().zip(&self.outermost).map(|(share, chance)| share * chance);
        share.enumerate().filter(|(_, share)| *share > 1e-9).map(|(k, share)| (radius(k), share))
    }

    /// [`Self::outermost`] at any radius in [0, 1].
    fn outermost_at(&self, radius: f64) -> f64 {
        let x = (radius * radius * STARTS as f64 - 0.5).clamp(0.0, (STARTS - 1) as f64);
        let k = (x as usize).min(STARTS - 2);
        self.outermost[k] + (self.outermost[k + 1] - self.outermost[k]) * (x - k as f64)
    }
}

fn radius(start: usize) -> f64 {
    ((start as f64 + 0.5) / STARTS as f64).sqrt()
}

/// Chance that fewer than `limit` of `count` fibers lie farther out, each with chance p: the binomial distribution.
fn at_most(limit: u32, count: u32, p: f64) -> f64 {
    if limit > count {
        return 1.0;
    }
    let odds = (p / (1.0 - p)).ln();
    let mut log_term = f64::from(count) * (1.0 - p).ln();
    let mut sum = 0.0;
    for k in 0..limit {
        sum += log_term.exp();
        log_term += odds + (f64::from(count - k) / f64::from(k + 1)).ln();
    }
    sum.min(1.0)
}

/// Expected number of fibers in each ring.
struct Rings(Vec<f64>);

impl Rings {
    fn add(&mut self, rho: f64, share: f64) {
        let ring = (rho / PROFILE_REACH).powi(2) * PROFILE_SIZE as f64;
        if let Some(cell) = self.0.get_mut(ring as usize) {
            *cell += share;
        }
    }
}

/// Loops migrate farther out [WuYuksel2018 §3.1]: calls `add` with relative radii and the share of a loop's period at each.
fn loops(yarn: &Yarn, start: f64, mut add: impl FnMut(f64, f64)) {
    let inner = start * yarn.r_min;
    for variate in 0..VARIATES {
        let outer = (sample(yarn.flyaways.loop_r_max, variate) / yarn.mean_axis()).max(start);
        for wave in waves() {
            add(inner + (outer - inner) * wave, 1.0 / f64::from(VARIATES * PHASES));
        }
    }
}

/// Hairs leave the ply for a part of their period, from phase ½ on, and migrate in the rest. As [`loops`].
fn hairs(yarn: &Yarn, start: f64, mut add: impl FnMut(f64, f64)) {
    let fly = &yarn.flyaways;
    for variate in 0..VARIATES {
        // Strides through the variates make the three independent of each other.
        let span = sample(fly.hair_z_span, variate * 13 % VARIATES).abs();
        let width = (span / yarn.migration_period()).clamp(HAIR_WIDTH.0, HAIR_WIDTH.1);
        let tip = sample(fly.hair_r_min, variate) + sample(fly.hair_r_span, variate * 29 % VARIATES);
        let rise = (tip / yarn.mean_axis()).max(start) - start;
        for k in 0..PHASES {
            let share = 1.0 / f64::from(VARIATES * PHASES);
            let along = (f64::from(k) + 0.5) / f64::from(PHASES);
            add(start + rise * along * along, share * width);
            let phase = 0.5 + width + (1.0 - width) * along;
            let wave = 0.5 - 0.5 * (2.0 * PI * phase).cos();
            add(start * (yarn.r_min + (1.0 - yarn.r_min) * wave), share * (1.0 - width));
        }
    }
}

/// (1 − cos 2πp)/2 over half a period of phases p; the other half mirrors it.
fn waves() -> impl Iterator<Item = f64> {
    (0..PHASES).map(|k| 0.5 - 0.5 * (PI * (f64::from(k) + 0.5) / f64::from(PHASES)).cos())
}

/// Density of the migrating fibers over all phases, per area of the unit disc.
///
/// A fiber drawn at R with density 2R p(R)/A sits at ρ = cR, where c runs from R_min to 1 with the phase. The density of ρ is
/// the mean of 2(ρ/c) p(ρ/c) / (A c); per area, over 2πρ, that of p(ρ/c) / (π A c²).
fn migrating_density(yarn: &Yarn, starts: &Starts, accepted: f64, flyaway_chance: f64, rho: f64) -> f64 {
    let at_phase = |wave: f64| {
        let c = yarn.r_min + (1.0 - yarn.r_min) * wave;
        if rho >= c {
            return 0.0;
        }
        let regular = 1.0 - flyaway_chance * starts.outermost_at(rho / c);
        regular * radial_density(rho / c, yarn.density_beta, yarn.density_epsilon) / (PI * accepted * c * c)
    };
    waves().map(at_phase).sum::<f64>() / f64::from(PHASES)
}

/// The k-th of [`VARIATES`] even samples of what `normal_from_hash` draws: a sum of three uniforms.
fn sample(variate: Variate, k: u32) -> f64 {
    let digits = k % UNIFORMS + k / UNIFORMS % UNIFORMS + k / (UNIFORMS * UNIFORMS);
    let sum = (f64::from(digits) + 1.5) / f64::from(UNIFORMS);
    variate.mean + variate.deviation * (2.0 * sum - 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_binomial_distribution_has_its_values() {
        assert!((at_most(1, 3, 0.25) - 0.75_f64.powi(3)).abs() < 1e-12);
        assert!((at_most(2, 2, 0.5) - 0.75).abs() < 1e-12);
        assert_eq!(at_most(5, 4, 0.3), 1.0);
        assert_eq!(at_most(0, 4, 0.3), 0.0);
        // 3000 fibers: the terms do not underflow to nothing.
        assert!((at_most(1501, 3000, 0.5) - 0.5).abs() < 0.01);
    }
}
