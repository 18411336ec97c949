use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::{FiberTable, Yarn, YarnPoint};
use crate::sampling::{hash_combine, normal_from_hash, unit_from_hash};

/// Turns per unit of length coordinate of one curve: plies, fibers, and migration periods (all ≥ 0; signs are the yarn's).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    /// Turns of the plies around the yarn.
    pub ply: f64,
    /// Turns of the fibers around the ply.
    pub fiber: f64,
    /// Migration periods.
    pub migration: f64,
    /// Periods along a closed curve, after which they repeat; `None` for an open one.
    pub closed_periods: Option<u32>,
}

impl Twist {
    /// Twist of a curve of rest length `total_length` and mean rest radius `reference_radius` (same unit).
    ///
    /// A closed curve gets whole numbers of turns and periods, so that it has no seam.
    pub fn new(yarn: &Yarn, total_length: f64, reference_radius: f64, closed: bool) -> Self {
        let [ply, fiber, migration] = Self::turns(yarn, total_length, reference_radius, closed);
        Self {
            ply: ply / total_length,
            fiber: fiber / total_length,
            migration: migration / total_length,
            closed_periods: closed.then_some(migration as u32),
        }
    }

    /// Turns of plies, fibers and migration over the whole curve.
    pub fn turns(yarn: &Yarn, total_length: f64, reference_radius: f64, closed: bool) -> [f64; 3] {
        let table_length = total_length * yarn.outer_radius() / reference_radius;
        let turns = [
            table_length / yarn.ply_twist.abs(),
            table_length / yarn.fiber_twist.abs(),
            table_length / yarn.migration_period(),
        ];
        if closed { turns.map(|turns| turns.round().max(1.0)) } else { turns }
    }
}

/// What a fiber is during one migration period [WuYuksel2018 §3.1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FiberType {
    /// Wanders between R_min and its own radius (Eq. 2).
    Migration,
    /// The same with a larger outer radius.
    Loop,
    /// Leaves the ply and ends in the open.
    Hair,
}

/// Which fiber: the hash of these decides its type in each period.
#[derive(Clone, Copy, Debug)]
pub struct Fiber {
    /// Hash of object and curve.
    pub seed: u32,
    /// Ply, 0 ≤ ply < K.
    pub ply: u32,
    /// Rank in the ply's [`FiberTable`].
    pub index: u32,
}

/// A point of a ply's centre line; rates are per segment parameter t.
#[derive(Clone, Copy, Debug)]
pub struct PlyPoint {
    /// Centre, object space.
    pub position: DVec3,
    /// d position / dt.
    pub velocity: DVec3,
    /// Unit direction from the yarn centre to the ply, N_ply.
    pub radial: DVec3,
    /// tangent × radial, B_ply.
    pub tangential: DVec3,
    /// d radial / dt.
    pub radial_rate: DVec3,
    /// d tangential / dt.
    pub tangential_rate: DVec3,
}

/// A point of a fiber's centre line.
#[derive(Clone, Copy, Debug)]
pub struct FiberPoint {
    /// Position, object space.
    pub position: DVec3,
    /// d position / dt.
    pub velocity: DVec3,
    /// What the fiber is here.
    pub kind: FiberType,
    /// Factor on the width: a hair thins out towards its tip, and so does the end that it leaves in the ply.
    pub taper: f64,
    /// Whether this is the part of a hair's period on the other side of its tip, where the fiber begins anew.
    pub beyond_tip: bool,
}

/// Where a fiber's curve breaks: third derivatives jump there, and at a hair's tip the fiber ends and another begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Break {
    /// Length coordinate.
    pub length: f64,
    /// Whether it is the tip of a hair.
    pub tip: bool,
}

/// Centre of a ply [WuYuksel2018, equation after Fig. 3], with N_ply = N for a yarn of one ply.
pub fn ply_point(yarn: &Yarn, twist: &Twist, at: &YarnPoint, ply: u32) -> PlyPoint {
    let (angle, angle_rate) = if yarn.plies > 1 {
        let sign = yarn.ply_twist.signum();
        let start = f64::from(ply) / f64::from(yarn.plies);
        (TAU * (sign * at.length * twist.ply + start), TAU * sign * at.length_rate * twist.ply)
    } else {
        (0.0, 0.0)
    };
    let (sin, cos) = angle.sin_cos();
    let radial = at.normal * cos + at.binormal * sin;
    let tangential = at.binormal * cos - at.normal * sin;
    let radial_rate = tangential * angle_rate + at.normal_rate * cos + at.binormal_rate * sin;
    let tangential_rate = -radial * angle_rate - at.normal_rate * sin + at.binormal_rate * cos;
    let distance = yarn.ply_distance() / yarn.outer_radius();
    PlyPoint {
        position: at.position + radial * (distance * at.radius),
        velocity: at.velocity + radial * (distance * at.radius_rate) + radial_rate * (distance * at.radius),
        radial,
        tangential,
        radial_rate,
        tangential_rate,
    }
}

/// What a fiber does within a migration period.
#[derive(Clone, Copy, Debug)]
pub struct FiberProfile {
    /// Distance from the ply's centre in its normalised section, where the half axes are 1.
    pub radius: f64,
    /// d radius / d phase.
    pub radius_rate: f64,
    /// By which it departs from the regular twist, turns in the direction of the twist.
    pub angle_turns: f64,
    /// d angle_turns / d phase.
    pub angle_rate: f64,
    /// What the fiber is here.
    pub kind: FiberType,
    /// Factor on the width, 0 to 1.
    pub taper: f64,
    /// See [`FiberPoint::beyond_tip`].
    pub beyond_tip: bool,
}

/// Narrowest and widest hair, as a share of its period.
pub const HAIR_WIDTH: (f64, f64) = (0.04, 0.45);

/// Share of a period over which the fiber regains its width beyond a hair's tip, or what is left of the period there.
const REGROWTH: f64 = 0.15;

fn variate(v: super::Variate, hash: u32, key: u32) -> f64 {
    v.mean + v.deviation * normal_from_hash(hash_combine(hash, key))
}

/// What a fiber is in the period with that hash.
pub fn period_type(yarn: &Yarn, index: u32, hash: u32) -> FiberType {
    if index >= yarn.flyaway_fibers() { FiberType::Migration } else { flyaway_type(yarn, unit_from_hash(hash)) }
}

/// What one that may fly away is in a period, by a number that is even in [0, 1).
pub fn flyaway_type(yarn: &Yarn, choice: f64) -> FiberType {
    let (loop_chance, hair_chance) = yarn.flyaway_chances();
    if choice < loop_chance {
        FiberType::Loop
    } else if choice < loop_chance + hair_chance {
        FiberType::Hair
    } else {
        FiberType::Migration
    }
}

/// Direction (±1) and width, as a share of the period, of the hair in the period with that hash.
fn hair_extent(yarn: &Yarn, hash: u32) -> (f64, f64) {
    let span = variate(yarn.flyaways.hair_z_span, hash, 2);
    (1.0_f64.copysign(span), (span.abs() / yarn.migration_period()).clamp(HAIR_WIDTH.0, HAIR_WIDTH.1))
}

/// Fiber `index` of a ply's [`FiberTable`], whose radius is `fiber_radius`, in the period with that hash. `phase` runs from 0 to 1 over the period, whose ends
/// lie at the least radius: types join there to first order. `periods_per_turn` of the fiber's twist.
///
/// Eq. 2 with its phase moved by half a period. A hair leaves at the middle, where a migrating fiber is
/// outermost, from that radius rather than from R_min^hair, so that it stays attached, and in a parabola rather than a line, so that
/// it has no kink; its tip lies at R_min^hair + R_span after an angle of theta_span.
pub fn fiber_profile(
    yarn: &Yarn,
    periods_per_turn: f64,
    index: u32,
    fiber_radius: f64,
    phase: f64,
    hash: u32,
) -> FiberProfile {
    let wave = 0.5 - 0.5 * (TAU * phase).cos();
    let wave_rate = PI * (TAU * phase).sin();
    let inner = fiber_radius * yarn.r_min;
    let between = |outer: f64, kind| FiberProfile {
        radius: inner + (outer - inner) * wave,
        radius_rate: (outer - inner) * wave_rate,
        angle_turns: 0.0,
        angle_rate: 0.0,
        kind,
        taper: 1.0,
        beyond_tip: false,
    };
    let fly = &yarn.flyaways;
    match period_type(yarn, index, hash) {
        FiberType::Migration => between(fiber_radius, FiberType::Migration),
        FiberType::Loop => {
            let outer = variate(fly.loop_r_max, hash, 1) / yarn.mean_axis();
            between(outer.max(fiber_radius), FiberType::Loop)
        }
        FiberType::Hair => {
            let (direction, width) = hair_extent(yarn, hash);
            let along = (phase - 0.5) * direction / width;
            if along < 0.0 {
                return between(fiber_radius, FiberType::Migration);
            }
            if along > 1.0 {
                let x = ((along - 1.0) * width / REGROWTH.min(0.5 - width)).min(1.0);
                let taper = x * x * (3.0 - 2.0 * x);
                return FiberProfile { taper, beyond_tip: true, ..between(fiber_radius, FiberType::Migration) };
            }
            let tip = (variate(fly.hair_r_min, hash, 3) + variate(fly.hair_r_span, hash, 4)) / yarn.mean_axis();
            let rise = tip.max(fiber_radius) - fiber_radius;
            let turns = variate(fly.hair_theta_span, hash, 5) / TAU;
            let astray = direction * (turns - width / periods_per_turn);
            FiberProfile {
                radius: fiber_radius + rise * along * along,
                radius_rate: 2.0 * along * rise * direction / width,
                angle_turns: astray * along * along,
                angle_rate: 2.0 * along * astray * direction / width,
                kind: FiberType::Hair,
                taper: 1.0 - along.powi(4),
                beyond_tip: false,
            }
        }
    }
}

/// Seed of a curve's fibers in an object: what [`Fiber::seed`] holds.
pub fn fiber_seed(object_id: u32, curve: u32) -> u32 {
    hash_combine(hash_combine(0x00b1_ec70, object_id), hash_combine(0x11c5_1e00, curve))
}

/// Migration periods before a length coordinate: the whole part counts periods, the rest is the phase.
fn migration_phase(twist: &Twist, table: &FiberTable, length: f64, fiber: Fiber) -> f64 {
    // Every ply is turned by its own angle and phase, so that plies are not copies of each other.
    let own = unit_from_hash(hash_combine(hash_combine(fiber.seed, fiber.ply), 0x0fff_fff1));
    length * twist.migration + table.migration_turns[fiber.index as usize] + own
}

fn period_hash(twist: &Twist, fiber: Fiber, whole_phase: f64) -> u32 {
    let mut period = whole_phase as u32;
    if let Some(count) = twist.closed_periods {
        period %= count.max(1);
    }
    hash_combine(hash_combine(hash_combine(fiber.seed, fiber.ply), fiber.index), period)
}

/// The breaks of a fiber strictly between two length coordinates, in order.
pub fn breaks(yarn: &Yarn, twist: &Twist, table: &FiberTable, fiber: Fiber, lengths: (f64, f64)) -> Vec<Break> {
    let mut found = Vec::new();
    if fiber.index >= yarn.flyaway_fibers() {
        return found;
    }
    let start = migration_phase(twist, table, 0.0, fiber);
    let phases = (start + lengths.0 * twist.migration, start + lengths.1 * twist.migration);
    let mut period = phases.0.floor();
    while period < phases.1 {
        let hash = period_hash(twist, fiber, period);
        let mut add = |phase: f64, tip| found.push(Break { length: (period + phase - start) / twist.migration, tip });
        add(0.0, false);
        if period_type(yarn, fiber.index, hash) == FiberType::Hair {
            let (direction, width) = hair_extent(yarn, hash);
            if direction < 0.0 {
                add(0.5 - width, true);
                add(0.5, false);
            } else {
                add(0.5, false);
                add(0.5 + width, true);
            }
        }
        period += 1.0;
    }
    found.retain(|b| b.length > lengths.0 && b.length < lengths.1);
    found
}

/// A fiber's point [WuYuksel2018 Eq. 1, 2 and §3.1].
pub fn fiber_point(yarn: &Yarn, twist: &Twist, table: &FiberTable, at: &YarnPoint, fiber: Fiber) -> FiberPoint {
    let ply = ply_point(yarn, twist, at, fiber.ply);
    let index = fiber.index as usize;
    let ply_hash = hash_combine(fiber.seed, fiber.ply);

    let phase = migration_phase(twist, table, at.length, fiber);
    let hash = period_hash(twist, fiber, phase.floor());
    let periods_per_turn = twist.migration / twist.fiber;
    let shape = fiber_profile(yarn, periods_per_turn, fiber.index, table.radius[index], phase.fract(), hash);
    let phase_rate = at.length_rate * twist.migration;

    let sign = yarn.fiber_twist.signum();
    let angle = TAU
        * (sign * (at.length * twist.fiber + shape.angle_turns)
            + table.angle_turns[index]
            + unit_from_hash(hash_combine(ply_hash, 0x0fff_fff2)));
    let angle_rate = TAU * sign * (at.length_rate * twist.fiber + shape.angle_rate * phase_rate);

    let scale = at.radius / yarn.outer_radius();
    let scale_rate = at.radius_rate / yarn.outer_radius();
    let (sin, cos) = angle.sin_cos();
    let (short, long) = (yarn.ellipse_short, yarn.ellipse_long);
    let spoke = ply.radial * (cos * short) + ply.tangential * (sin * long);
    let spoke_rate = ply.radial_rate * (cos * short)
        + ply.tangential_rate * (sin * long)
        + (ply.tangential * (cos * long) - ply.radial * (sin * short)) * angle_rate;
    FiberPoint {
        position: ply.position + spoke * (shape.radius * scale),
        velocity: ply.velocity
            + spoke_rate * (shape.radius * scale)
            + spoke * (shape.radius * scale_rate + shape.radius_rate * phase_rate * scale),
        kind: shape.kind,
        taper: shape.taper,
        beyond_tip: shape.beyond_tip,
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::{Knot, Segment};
    use super::*;
    use crate::yarn::PRESET_NAMES;

    const TURNS: f64 = 40.0;

    /// A helix with a radius that varies and knots at uneven distances; `knot(i)` for any integer i.
    fn knot(i: i32) -> Knot {
        let a = f64::from(i) * 0.31 + 0.11 * f64::from(i).sin();
        let position = DVec3::new(a.cos(), a.sin(), 0.2 * a);
        let tangent = DVec3::new(-a.sin(), a.cos(), 0.2).normalize();
        let out = DVec3::new(a.cos(), a.sin(), 0.0);
        let normal = (out - tangent * out.dot(tangent)).normalize();
        Knot { position, normal, length: a * 1.04_f64.sqrt() + 5.0, radius: 0.1 + 0.02 * (0.7 * f64::from(i)).cos() }
    }

    fn segment(i: i32) -> Segment {
        Segment::new([knot(i - 1), knot(i), knot(i + 1), knot(i + 2)])
    }

    #[test]
    fn positions_and_tangents_are_continuous_across_segments() {
        for name in PRESET_NAMES {
            let yarn = Yarn::preset(name).expect(name);
            let table = FiberTable::new(&yarn);
            let twist = Twist::new(&yarn, TURNS, 0.1, false);
            for i in 1..40 {
                for index in 0..yarn.fibers_per_ply {
                    let fiber = Fiber { seed: 7, ply: i as u32 % yarn.plies, index };
                    let a = fiber_point(&yarn, &twist, &table, &segment(i).at(1.0), fiber);
                    let b = fiber_point(&yarn, &twist, &table, &segment(i + 1).at(0.0), fiber);
                    assert!(a.position.distance(b.position) < 1e-5 * 0.1, "{name} segment {i} fiber {index}");
                    assert!(a.velocity.angle_between(b.velocity) < 1e-5, "{name} segment {i} fiber {index}");
                }
            }
        }
    }

    #[test]
    fn velocity_is_the_derivative_of_position() {
        let yarn = Yarn::preset("cotton-1").expect("preset");
        let table = FiberTable::new(&yarn);
        let twist = Twist::new(&yarn, TURNS, 0.1, false);
        let (mut worst, mut seen) = (0.0_f64, [0; 3]);
        for i in 1..60 {
            for index in 0..yarn.fibers_per_ply {
                let fiber = Fiber { seed: 3, ply: 1, index };
                let h = 1e-6;
                let point = |t: f64| fiber_point(&yarn, &twist, &table, &segment(i).at(t), fiber);
                let (a, b, c) = (point(0.4 - h), point(0.4), point(0.4 + h));
                if a.kind != c.kind || a.position.distance(c.position) > 1e-4 {
                    continue; // A root or a tip lies between: no derivative there.
                }
                seen[b.kind as usize] += 1;
                let difference = (c.position - a.position) / (2.0 * h);
                worst = worst.max(difference.distance(b.velocity) / b.velocity.length());
            }
        }
        assert!(seen.iter().all(|n| *n > 50), "every type is met: {seen:?}");
        assert!(worst < 1e-6, "relative error {worst}");
    }

    #[test]
    fn a_closed_yarn_has_no_seam() {
        let yarn = Yarn::preset("rayon-2").expect("preset");
        let table = FiberTable::new(&yarn);
        let total = 17.3;
        let at = |length: f64| {
            let mut point = segment(3).at(0.5);
            point.length = length;
            point
        };
        let gap = |twist: &Twist| {
            (0..yarn.fibers_per_ply)
                .map(|index| {
                    let fiber = Fiber { seed: 1, ply: 0, index };
                    let a = fiber_point(&yarn, twist, &table, &at(0.0), fiber);
                    let b = fiber_point(&yarn, twist, &table, &at(total), fiber);
                    a.position.distance(b.position)
                })
                .fold(0.0, f64::max)
        };
        assert!(gap(&Twist::new(&yarn, total, 0.1, true)) < 1e-10);
        // The check sees a seam where there is one.
        assert!(gap(&Twist::new(&yarn, total, 0.1, false)) > 1e-3);
    }

    #[test]
    fn flyaway_densities_match_the_table() {
        for name in PRESET_NAMES {
            let yarn = Yarn::preset(name).expect(name);
            let (loops, hairs) = yarn.flyaway_chances();
            let per_length = f64::from(yarn.flyaway_fibers()) / yarn.migration_period();
            assert!((loops * per_length - yarn.flyaways.loop_density).abs() < 1e-9, "{name}");
            assert!((hairs * per_length - yarn.flyaways.hair_density).abs() < 1e-9, "{name}");
        }
    }
}
