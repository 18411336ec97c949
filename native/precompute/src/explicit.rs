//! Random sections through explicit fibers, against which the tables are checked.

use std::f64::consts::TAU;

use glam::{DMat2, DVec2, DVec3};
use lisle_core::sampling::{hash_combine, hash_u32, unit_from_hash};
use lisle_core::yarn::{Fiber, FiberTable, Twist, Yarn, fiber_point};

use crate::straight;

/// Uniform numbers from a counter.
pub struct Random(u32);

impl Random {
    pub fn new(seed: u32) -> Self {
        Self(hash_u32(seed))
    }

    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        unit_from_hash(hash_combine(0x1234_5678, self.0))
    }
}

/// A yarn without loops and hairs: what the tables model.
pub fn without_flyaways(yarn: &Yarn) -> Yarn {
    let mut yarn = yarn.clone();
    yarn.flyaways.loop_density = 0.0;
    yarn.flyaways.hair_density = 0.0;
    yarn
}

/// Yarns at the borders of what is valid.
pub fn extreme_yarns() -> [Yarn; 4] {
    let base = Yarn::preset("silk-1").expect("preset");
    let yarns = [
        Yarn { plies: 1, fibers_per_ply: 1, ..base.clone() },
        Yarn { r_min: 0.0, ..base.clone() },
        Yarn { plies: 8, fibers_per_ply: 500, density_beta: 0.0, ..base.clone() },
        Yarn { fiber_radius: 0.05, density_epsilon: 0.5, ..base },
    ];
    yarns.iter().for_each(|yarn| yarn.validate().expect("valid"));
    yarns
}

/// A fiber where it crosses a section, section coordinates; the tangent's z is along the yarn.
pub struct SectionFiber {
    pub center: DVec2,
    pub tangent: DVec3,
    /// Factor on the radius.
    pub width: f64,
}

impl SectionFiber {
    /// Whether the point lies in the fiber's tangent cylinder, whose radius where the fiber does not thin out is that.
    pub fn holds(&self, q: DVec2, radius: f64) -> bool {
        self.holds_in_space(q.extend(0.0), radius)
    }

    /// The same of a point before or behind the section.
    pub fn holds_in_space(&self, point: DVec3, radius: f64) -> bool {
        (point - self.center.extend(0.0)).cross(self.tangent).length() < radius * self.width
    }

    /// Whether a ray in the section from q meets the same cylinder ahead of q.
    pub fn blocks(&self, q: DVec2, direction: DVec2, radius: f64) -> bool {
        let (w, d) = ((self.center - q).extend(0.0), direction.extend(0.0));
        let normal = d.cross(self.tangent);
        // Where the ray is nearest to the axis: w − l d + s t is perpendicular to both.
        let ahead = w.cross(self.tangent).dot(normal) > 0.0;
        ahead && w.dot(normal).abs() < radius * self.width * normal.length()
    }
}

/// Random sections of yarns.
pub struct Sections {
    yarn: Yarn,
    twist: Twist,
    /// What every ply has, or where its fibers are dealt from.
    table: FiberTable,
    is_dealt: bool,
}

impl Sections {
    const DECKS: u32 = 1000;

    /// Of a yarn: its plies have the same fibers everywhere.
    pub fn of(yarn: &Yarn) -> Self {
        let twist = Twist::new(yarn, 1000.0, 1.0, false);
        Self { yarn: yarn.clone(), twist, table: FiberTable::new(yarn), is_dealt: false }
    }

    /// Of many yarns of that kind: the fibers of each ply are independent.
    pub fn of_kind(yarn: &Yarn) -> Self {
        let many = Yarn { fibers_per_ply: yarn.fibers_per_ply * Self::DECKS, ..yarn.clone() };
        Self { table: FiberTable::new(&many), is_dealt: true, ..Self::of(yarn) }
    }

    /// The table of one ply, outermost first.
    fn deal(&self, random: &mut Random) -> FiberTable {
        let pool = &self.table;
        let mut hand: Vec<_> =
            (0..self.yarn.fibers_per_ply).map(|_| (random.unit() * pool.radius.len() as f64) as usize).collect();
        hand.sort_unstable();
        FiberTable {
            radius: hand.iter().map(|k| pool.radius[*k]).collect(),
            angle_turns: hand.iter().map(|k| pool.angle_turns[*k]).collect(),
            migration_turns: hand.iter().map(|k| pool.migration_turns[*k]).collect(),
            acceptance: pool.acceptance,
        }
    }

    /// Fibers of one random section, all plies.
    pub fn draw(&self, random: &mut Random) -> Vec<SectionFiber> {
        let length = 1000.0 * random.unit();
        let at = straight(length);
        let turned = if self.yarn.plies > 1 { self.yarn.ply_twist.signum() * length * self.twist.ply } else { 0.0 };
        let section_from_yarn = DMat2::from_angle(-TAU * turned);
        let mut fibers = Vec::new();
        for ply in 0..self.yarn.plies {
            let seed = (random.unit() * 1e9) as u32;
            let dealt = self.is_dealt.then(|| self.deal(random));
            let table = dealt.as_ref().unwrap_or(&self.table);
            for index in 0..self.yarn.fibers_per_ply {
                let point = fiber_point(&self.yarn, &self.twist, table, &at, Fiber { seed, ply, index });
                let tangent = point.velocity.normalize();
                fibers.push(SectionFiber {
                    center: section_from_yarn * point.position.truncate(),
                    tangent: (section_from_yarn * tangent.truncate()).extend(tangent.z),
                    width: point.taper,
                });
            }
        }
        fibers
    }
}
