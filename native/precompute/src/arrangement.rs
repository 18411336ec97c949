use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use lisle_core::sampling::hash_combine;
use lisle_core::yarn::{FiberProfile, FiberTable, FiberType, Yarn, fiber_profile, flyaway_type, period_type};
use rayon::prelude::*;

/// Turns of a ply's fibers after which their arrangement repeats.
pub const TURNS: usize = 4;

/// What each period of a fiber that may fly away is chosen from, and phases that are looked at.
const CHOICES: u32 = 128;
const PHASES: usize = 16;

/// Periods beyond which chance alone has enough of every kind.
const MANY_PERIODS: f64 = 4000.0;

/// Groups of fibers, from the outermost inwards, of which each is as even as all: the outermost ones may be drawn one by one.
const GROUPS: usize = 3;

/// Steps of a sequence that fills the unit square evenly: powers of the reciprocal of the root of x³ = x + 1.
pub(crate) const EVEN_STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];

/// Sequences that one is chosen from.
const STARTS: usize = 128;

/// What the fibers of a ply do along [`TURNS`] turns of it, so that it repeats after them.
///
/// The migration rate of Eq. 2 is rounded to an odd number of periods, which repeats in no fewer turns. Which periods are loops and hairs is left to chance in a
/// yarn. Here there are some dozens of them, always seen on the same side: chance would have up to half of them more or fewer than a yarn has on the whole, or
/// most of them where they are hidden. So they are spread evenly, by kind, by how far out they go, and over the sides: each period is what it might be by chance,
/// with the same odds. (Chosen one after the other to keep moments at the mean, they
/// would be unusual ones: their glints were two to three times as far off as those by chance.)
#[derive(Clone, Debug)]
pub struct Arrangement<'a> {
    pub yarn: &'a Yarn,
    pub table: &'a FiberTable,
    seed: u32,
    /// Of each period of each fiber that may fly away; none where all are left to chance.
    chosen: Vec<u32>,
}

/// A period of a fiber as one of [`CHOICES`].
#[derive(Clone, Copy, Debug)]
struct Period {
    choice: u32,
    kind: FiberType,
    /// Radius that it goes out to.
    reach: f64,
    /// How much of it is outside of the ply, and how much of that towards either axis of the section.
    outside: DVec3,
}

impl<'a> Arrangement<'a> {
    /// Of a valid yarn, and its table.
    pub fn even(yarn: &'a Yarn, table: &'a FiberTable) -> Self {
        let any = Self::by_chance(yarn, table, 0);
        let places = f64::from(yarn.flyaway_fibers()) * Self::periods_of(yarn);
        if places > MANY_PERIODS {
            return any;
        }
        let places = places as u32;
        let choices: Vec<Vec<Period>> = (0..places)
            .into_par_iter()
            .map(|place| {
                let mut of: Vec<_> = (0..CHOICES).map(|choice| any.period(place, choice)).collect();
                of.sort_by(|a, b| a.reach.total_cmp(&b.reach));
                of
            })
            .collect();
        let usual = |of: &[Period]| of.iter().map(|period| period.outside).sum::<DVec3>() / f64::from(CHOICES);
        let usual: Vec<DVec3> = choices.iter().map(|of| usual(of)).collect();
        let group = |place: u32| place as usize * GROUPS / places as usize;
        let mut order: Vec<u32> = (0..places).collect();
        order.sort_by(|a, b| group(*a).cmp(&group(*b)).then(any.side(*a).total_cmp(&any.side(*b))));
        let from = |start: usize| -> Vec<Period> {
            let mut chosen: Vec<Period> = choices.iter().map(|of| of[0]).collect();
            for (number, place) in order.iter().enumerate() {
                let number = (start * order.len() + number) as f64 + 0.5;
                let [kind, reach] = EVEN_STEPS.map(|step| (number * step).fract());
                chosen[*place as usize] = choice(&choices[*place as usize], flyaway_type(yarn, kind), reach);
            }
            chosen
        };
        // From each group inwards, since those before may be drawn one by one.
        let strangeness = |chosen: &[Period]| -> f64 {
            let of_inner = |first: usize| {
                let inner = || (0..places).filter(|place| group(*place) >= first).map(|place| place as usize);
                let off: DVec3 = inner().map(|k| chosen[k].outside - usual[k]).sum();
                off.length_squared() / inner().map(|k| usual[k].x).sum::<f64>().powi(2).max(f64::MIN_POSITIVE)
            };
            (0..GROUPS).map(of_inner).sum()
        };
        let best = (0..STARTS).map(from).min_by(|a, b| strangeness(a).total_cmp(&strangeness(b)));
        let chosen = best.into_iter().flatten().map(|period| period.choice).collect();
        Self { chosen, ..any }
    }

    /// One period with one choice.
    fn period(&self, place: u32, choice: u32) -> Period {
        let fiber = self.fiber_of(place);
        let (mut reach, mut outside) = (0.0_f64, DVec3::ZERO);
        for k in 0..PHASES {
            let phase = (k as f64 + 0.5) / PHASES as f64;
            let at = self.profile_at(fiber, place, phase, choice);
            let astray = self.yarn.fiber_twist.signum() * at.angle_turns;
            let side = DVec2::from_angle(TAU * (self.turns(place, phase) + astray));
            reach = reach.max(at.radius);
            outside += at.taper * self::outside(at.radius) * DVec3::new(1.0, side.x, side.y);
        }
        let kind = period_type(self.yarn, fiber as u32, self.hash(place, choice));
        Period { choice, kind, reach, outside }
    }

    fn fiber_of(&self, place: u32) -> usize {
        (place / Self::periods_of(self.yarn) as u32) as usize
    }

    /// Angle of a fiber of the regular twist from the viewer, turns.
    fn turns(&self, place: u32, phase: f64) -> f64 {
        let (fiber, periods) = (self.fiber_of(place), Self::periods_of(self.yarn));
        let migrated = f64::from(place % periods as u32) + phase - self.table.migration_turns[fiber];
        self.yarn.fiber_twist.signum() * migrated / periods * TURNS as f64 + self.table.angle_turns[fiber]
    }

    /// The same where a period is half over, 0 to 1.
    fn side(&self, place: u32) -> f64 {
        self.turns(place, 0.5).rem_euclid(1.0)
    }

    /// As chance has it.
    fn by_chance(yarn: &'a Yarn, table: &'a FiberTable, seed: u32) -> Self {
        Self { yarn, table, seed, chosen: Vec::new() }
    }

    /// What a fiber does after so many turns of the bundle. On a curve, it migrates in the direction of the curve.
    pub fn profile(&self, fiber: usize, turns: f64) -> FiberProfile {
        let periods = Self::periods_of(self.yarn);
        let migrated = self.yarn.fiber_twist.signum() * periods / TURNS as f64 * turns;
        let phase = migrated + self.table.migration_turns[fiber];
        // Of more places than there are numbers, some share one: those are left to chance.
        let place = (fiber as u32).wrapping_mul(periods as u32).wrapping_add(phase.floor().rem_euclid(periods) as u32);
        let choice = self.chosen.get(place as usize).copied().unwrap_or(0);
        self.profile_at(fiber, place, phase - phase.floor(), choice)
    }

    /// Of one period; `place` counts the periods of all fibers.
    fn profile_at(&self, fiber: usize, place: u32, phase: f64, choice: u32) -> FiberProfile {
        let hash = self.hash(place, choice);
        fiber_profile(self.yarn, self.yarn.migration_rate, fiber as u32, self.table.radius[fiber], phase, hash)
    }

    fn hash(&self, place: u32, choice: u32) -> u32 {
        hash_combine(hash_combine(self.seed, place), choice)
    }

    /// In all turns.
    fn periods_of(yarn: &Yarn) -> f64 {
        2.0 * (0.5 * (yarn.migration_rate * TURNS as f64 - 1.0)).round().max(0.0) + 1.0
    }
}

/// The one of that kind that goes out farther than such a share of all of that kind, of those sorted by how far they go; any if there is none.
fn choice(sorted: &[Period], kind: FiberType, share: f64) -> Period {
    let of_kind = || sorted.iter().filter(|period| period.kind == kind);
    let number = share * of_kind().count() as f64;
    *of_kind().nth(number as usize).unwrap_or(&sorted[0])
}

/// How far a fiber is outside of its ply: by halves at the border, so that a moment hangs on more than the few phases next to it.
fn outside(radius: f64) -> f64 {
    (5.0 * (radius - 0.9)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean over all turns of the flyaways from `first` on of a number of a fiber and its angle to the viewer, radians.
    fn mean(of: &Arrangement, first: usize, number: impl Fn(&FiberProfile, f64) -> f64) -> f64 {
        const STEPS: usize = 800;
        let fibers = of.yarn.flyaway_fibers() as usize;
        let at = |fiber: usize, k: usize| {
            let turns = k as f64 * TURNS as f64 / STEPS as f64;
            let shape = of.profile(fiber, turns);
            let astray = of.yarn.fiber_twist.signum() * shape.angle_turns;
            number(&shape, TAU * (turns + of.table.angle_turns[fiber] + astray))
        };
        let sum: f64 = (first..fibers).map(|fiber| (0..STEPS).map(|k| at(fiber, k)).sum::<f64>()).sum();
        sum / ((fibers - first) * STEPS) as f64
    }

    /// How far off the mean of 256 left to chance is what an arrangement has, and what any of those has at most; in shares of the first number.
    fn off(
        yarn: &Yarn,
        first: usize,
        of: impl Fn(&FiberProfile) -> f64,
        number: impl Fn(&FiberProfile, f64) -> f64,
    ) -> [f64; 2] {
        let table = FiberTable::new(yarn);
        let all: Vec<_> = (0..256).map(|seed| Arrangement::by_chance(yarn, &table, 1 + seed)).collect();
        let mean_of = |number: &dyn Fn(&FiberProfile, f64) -> f64| {
            all.iter().map(|of| mean(of, first, number)).sum::<f64>() / all.len() as f64
        };
        let (share, expected) = (mean_of(&|at, _| of(at)), mean_of(&number));
        let off = |of: &Arrangement| (mean(of, first, &number) - expected).abs() / share;
        [off(&Arrangement::even(yarn, &table)), all.iter().map(off).fold(0.0, f64::max)]
    }

    #[test]
    fn as_much_of_an_arrangement_is_outside_of_its_ply_as_of_all_and_on_every_side() {
        for (name, inner) in [("cotton-1", false), ("cotton-1", true), ("rayon-2", true), ("silk-1", false)] {
            let yarn = Yarn::preset(name).expect(name);
            // Where a third of them are drawn one by one, the others are as typical.
            let first = if inner { yarn.flyaway_fibers() as usize / 3 } else { 0 };
            let astray = |at: &FiberProfile| at.taper * outside(at.radius);
            let figures = [
                ("outside", 0.07, off(&yarn, first, astray, |at, _| astray(at))),
                ("in front", 0.08, off(&yarn, first, astray, |at, angle| astray(at) * angle.cos())),
                ("to a side", 0.08, off(&yarn, first, astray, |at, angle| astray(at) * angle.sin())),
            ];
            for (figure, goal, [found, any]) in figures {
                println!("{name} from {first}, {figure}: {found:.3}, any {any:.3}");
                assert!(found < goal, "{name} from {first}, {figure}: {found}");
                assert!(any > goal, "{name} from {first}, {figure}: any arrangement passes: {any}");
            }
        }
    }

    #[test]
    fn an_arrangement_repeats_after_its_turns_and_not_before() {
        let yarn = Yarn::preset("cotton-2").expect("preset");
        let table = FiberTable::new(&yarn);
        let arrangement = Arrangement::even(&yarn, &table);
        let differs = |by: f64| {
            let at = |fiber: usize, turns: f64| arrangement.profile(fiber, turns).radius;
            let off = |fiber: usize, turns: f64| (at(fiber, turns) - at(fiber, turns + by)).abs();
            let of_fiber = |fiber: usize| (0..50).map(move |k| off(fiber, 0.08 * f64::from(k)));
            (0..yarn.flyaway_fibers() as usize).flat_map(of_fiber).fold(0.0, f64::max)
        };
        assert!(differs(TURNS as f64) < 1e-9 && differs(-(TURNS as f64)) < 1e-9);
        assert!(differs(0.5 * TURNS as f64) > 0.1);
    }

    #[test]
    fn any_valid_rate_of_migration_has_an_arrangement() {
        for (fibers_per_ply, migration_rate) in [(1, 1e300), (60_000 / 3, 40.0), (20, 1e-300), (37, 1e9)] {
            let yarn = Yarn { fibers_per_ply, migration_rate, ..Yarn::preset("cotton-2").expect("preset") };
            yarn.validate().expect("valid");
            let table = FiberTable::new(&yarn);
            let arrangement = Arrangement::even(&yarn, &table);
            for fiber in 0..fibers_per_ply as usize {
                let at = arrangement.profile(fiber, 1.3);
                assert!((0.0..10.0).contains(&at.radius), "{fibers_per_ply} fibers, rate {migration_rate}: {at:?}");
            }
        }
    }
}
