//! Random sections through explicit fibers, against which the tables are checked.

use std::f64::consts::TAU;

use glam::{DMat2, DVec2, DVec3};
use lisle_core::sampling::{hash_combine, hash_u32, unit_from_hash};
use lisle_core::yarn::{Fiber, FiberTable, Twist, Yarn, YarnPoint, fiber_point};

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
}

impl SectionFiber {
    /// Distance of the point from the fiber's axis (its tangent line).
    pub fn distance(&self, q: DVec2) -> f64 {
        (q - self.center).extend(0.0).cross(self.tangent).length()
    }

    /// Whether a ray in the section from q meets the fiber's tangent cylinder of that radius ahead of q.
    pub fn blocks(&self, q: DVec2, direction: DVec2, radius: f64) -> bool {
        let (w, d) = ((self.center - q).extend(0.0), direction.extend(0.0));
        let normal = d.cross(self.tangent);
        // Where the ray is nearest to the axis: w − l d + s t is perpendicular to both.
        let ahead = w.cross(self.tangent).dot(normal) > 0.0;
        ahead && w.dot(normal).abs() < radius * normal.length()
    }
}

/// A pool of drawn fibers, from which independent plies are dealt.
pub struct Sections {
    yarn: Yarn,
    twist: Twist,
    pool: FiberTable,
}

impl Sections {
    const DECKS: u32 = 1000;

    pub fn new(yarn: &Yarn) -> Self {
        let many = Yarn { fibers_per_ply: yarn.fibers_per_ply * Self::DECKS, ..yarn.clone() };
        Self { yarn: yarn.clone(), twist: Twist::new(yarn, 1000.0, 1.0, false), pool: FiberTable::new(&many) }
    }

    /// The table of one ply, outermost first.
    fn deal(&self, random: &mut Random) -> FiberTable {
        let pool = &self.pool;
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
        let at = YarnPoint {
            position: DVec3::ZERO,
            velocity: DVec3::Z,
            tangent: DVec3::Z,
            normal: DVec3::X,
            binormal: DVec3::Y,
            normal_rate: DVec3::ZERO,
            binormal_rate: DVec3::ZERO,
            length,
            length_rate: 1.0,
            radius: 1.0,
            radius_rate: 0.0,
        };
        let turned = if self.yarn.plies > 1 { self.yarn.ply_twist.signum() * length * self.twist.ply } else { 0.0 };
        let section_from_yarn = DMat2::from_angle(-TAU * turned);
        let mut fibers = Vec::new();
        for ply in 0..self.yarn.plies {
            let seed = (random.unit() * 1e9) as u32;
            let table = self.deal(random);
            for index in 0..self.yarn.fibers_per_ply {
                let point = fiber_point(&self.yarn, &self.twist, &table, &at, Fiber { seed, ply, index });
                let tangent = point.velocity.normalize();
                fibers.push(SectionFiber {
                    center: section_from_yarn * point.position.truncate(),
                    tangent: (section_from_yarn * tangent.truncate()).extend(tangent.z),
                });
            }
        }
        fibers
    }
}
