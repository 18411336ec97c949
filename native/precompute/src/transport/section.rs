//! Fibers of a yarn where they cross a section of it, through which rays are traced.

use std::f64::consts::TAU;

use glam::{DMat2, DVec2, DVec3};
use lisle_core::yarn::{Fiber, FiberTable, Twist, Yarn, fiber_point};

use crate::straight;

/// At most so many fibers are in a section: where a yarn has more, each of some of them is as thick as those that it stands for.
const MOST_FIBERS: usize = 1024;

/// Of a yarn in which sections lie, outer radii: long enough for loops and hairs to differ.
const LENGTH: f64 = 1000.0;

/// A kind of yarn, of which sections are made.
pub(super) struct Sections {
    yarn: Yarn,
    twist: Twist,
    table: FiberTable,
    /// One of so many fibers is in a section.
    step: usize,
}

impl Sections {
    pub fn of(yarn: &Yarn) -> Self {
        let fibers = (yarn.plies * yarn.fibers_per_ply) as usize;
        Self {
            yarn: yarn.clone(),
            twist: Twist::new(yarn, LENGTH, 1.0, false),
            table: FiberTable::new(yarn),
            step: fibers.div_ceil(MOST_FIBERS),
        }
    }

    /// Turn of a section's fibers, all together, per length along the yarn: that of the plies, or of the only one's fibers. Radians per outer radius.
    pub fn turn_rate(&self) -> f64 {
        if self.yarn.plies > 1 {
            self.yarn.ply_twist.signum() * TAU * self.twist.ply
        } else {
            self.yarn.fiber_twist.signum() * TAU * self.twist.fiber
        }
    }

    /// The section at a share of the yarn, with the flyaways that `seed` decides.
    pub fn cut(&self, share: f64, seed: u32) -> Section {
        let length = LENGTH * share;
        let at = straight(length);
        let section_from_yarn = DMat2::from_angle(-self.turn_rate() * length);
        let radius = self.yarn.fiber_radius / self.yarn.outer_radius() * self.step as f64;
        let mut section = Section::default();
        for ply in 0..self.yarn.plies {
            for index in (0..self.yarn.fibers_per_ply).skip(ply as usize % self.step).step_by(self.step) {
                let point = fiber_point(&self.yarn, &self.twist, &self.table, &at, Fiber { seed, ply, index });
                let slope = section_from_yarn * (point.velocity.truncate() / point.velocity.z);
                section.push(section_from_yarn * point.position.truncate(), slope, radius * point.taper);
            }
        }
        section
    }
}

/// Fibers as straight round cylinders, in arrays that are searched at one go. Outer radii; z is along the yarn, 0 in the section.
#[derive(Default)]
pub(super) struct Section {
    x: Vec<f32>,
    y: Vec<f32>,
    /// Way across per way along the yarn.
    slope_x: Vec<f32>,
    slope_y: Vec<f32>,
    radius_squared: Vec<f32>,
}

impl Section {
    fn push(&mut self, center: DVec2, slope: DVec2, radius: f64) {
        self.x.push(center.x as f32);
        self.y.push(center.y as f32);
        self.slope_x.push(slope.x as f32);
        self.slope_y.push(slope.y as f32);
        self.radius_squared.push((radius * radius) as f32);
    }

    /// Centre of a fiber, at z = 0.
    pub fn center(&self, fiber: usize) -> DVec2 {
        DVec2::new(self.x[fiber].into(), self.y[fiber].into())
    }

    pub fn slope(&self, fiber: usize) -> DVec2 {
        DVec2::new(self.slope_x[fiber].into(), self.slope_y[fiber].into())
    }

    pub fn radius(&self, fiber: usize) -> f64 {
        f64::from(self.radius_squared[fiber]).sqrt()
    }

    /// The first fiber that a ray from a point of the section enters, and the way there: not `own`, nor any that holds the start.
    ///
    /// `ways` is written over.
    pub fn nearest(
        &self,
        from: DVec2,
        direction: DVec3,
        own: Option<usize>,
        ways: &mut Vec<f32>,
    ) -> Option<(usize, f64)> {
        let (from, d) = (from.as_vec2(), direction.as_vec3());
        let count = self.x.len();
        ways.resize(count, 0.0);
        let (x, y, radius_squared) = (&self.x[..count], &self.y[..count], &self.radius_squared[..count]);
        let (slope_x, slope_y, ways) = (&self.slope_x[..count], &self.slope_y[..count], &mut ways[..count]);
        for k in 0..count {
            let (wx, wy, sx, sy) = (x[k] - from.x, y[k] - from.y, slope_x[k], slope_y[k]);
            // d × t and w × t with t = (s, 1).
            let (nx, ny, nz) = (d.y - d.z * sy, d.z * sx - d.x, d.x * sy - d.y * sx);
            let n_squared = nx * nx + ny * ny + nz * nz;
            let inverse = 1.0 / n_squared.max(1e-20);
            let aside = wx * nx + wy * ny;
            let to_axis = (wy * nx - wx * ny + (wx * sy - wy * sx) * nz) * inverse;
            let inside = radius_squared[k] - aside * aside * inverse;
            let half_chord = (inside.max(0.0) * (1.0 + sx * sx + sy * sy) * inverse).sqrt();
            let way = to_axis - half_chord;
            ways[k] = if inside > 0.0 && way > 0.0 { way } else { f32::INFINITY };
        }
        if let Some(own) = own {
            ways[own] = f32::INFINITY;
        }
        let least = ways.iter().copied().fold(f32::INFINITY, f32::min);
        let fiber = ways.iter().position(|way| *way == least && least < f32::INFINITY)?;
        Some((fiber, least.into()))
    }
}

#[cfg(test)]
mod tests {
    use lisle_core::sampling::{Random, sphere};

    use super::*;
    use crate::explicit::SectionFiber;

    impl Section {
        /// Which fibers hold a point, by the other description of them.
        fn around(&self, point: DVec3) -> Vec<usize> {
            let holds = |k: &usize| {
                let fiber = SectionFiber {
                    center: self.center(*k),
                    tangent: self.slope(*k).extend(1.0).normalize(),
                    width: 1.0,
                };
                fiber.holds_in_space(point, self.radius(*k))
            };
            (0..self.x.len()).filter(holds).collect()
        }
    }

    /// Whether the way of a ray before what it meets leads through fibers that do not hold its start.
    fn passes_through_others(section: &Section, from: DVec2, direction: DVec3, way: f64) -> bool {
        const STEPS: u32 = 300;
        let at = |share: f64| from.extend(0.0) + direction * (way * share);
        let own = section.around(at(0.0));
        (1..STEPS).any(|k| {
            let point = at(f64::from(k) / f64::from(STEPS) * 0.999);
            section.around(point).iter().any(|fiber| !own.contains(fiber))
        })
    }

    #[test]
    fn a_ray_meets_the_first_fiber_that_it_enters() {
        let section = Sections::of(&Yarn::preset("silk-1").expect("preset")).cut(0.37, 5);
        let (mut random, mut ways, mut met) = (Random::new(1, 2, 3), Vec::new(), 0);
        for _ in 0..200 {
            let from = DVec2::from_angle(TAU * random.unit()) * random.unit().sqrt();
            let direction = sphere(random.pair());
            match section.nearest(from, direction, None, &mut ways) {
                Some((fiber, way)) => {
                    met += 1;
                    let axis = section.slope(fiber).extend(1.0).normalize();
                    let apart = from.extend(0.0) + direction * way - section.center(fiber).extend(0.0);
                    let distance = apart.cross(axis).length();
                    assert!((distance / section.radius(fiber) - 1.0).abs() < 0.02, "on the fiber's surface");
                    assert!(!passes_through_others(&section, from, direction, way));
                    assert!(
                        passes_through_others(&section, from, direction, way * 1.2 + 0.01),
                        "a check that sees none"
                    );
                }
                None => assert!(!passes_through_others(&section, from, direction, 3.0)),
            }
        }
        assert!((50..200).contains(&met), "{met}");
    }

    #[test]
    fn many_fibers_are_few_thick_ones() {
        let many = Yarn { plies: 8, fibers_per_ply: 2000, ..Yarn::preset("silk-1").expect("preset") };
        let (many, few) = (Sections::of(&many), Sections::of(&Yarn { fibers_per_ply: 120, ..many }));
        let width = |section: &Section| (0..section.x.len()).map(|k| section.radius(k)).sum::<f64>();
        let (many, few) = (many.cut(0.2, 1), few.cut(0.2, 1));
        assert!(many.x.len() <= MOST_FIBERS && few.x.len() == 960);
        assert!((width(&many) / width(&few) / (2000.0 / 120.0) - 1.0).abs() < 0.05);
    }
}
