//! A yarn's fibers as a medium through which photons walk: expected numbers in place of fibers, the same all along the yarn.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use lisle_core::sampling::Random;

use crate::SectionDensity;

/// Steps across the section at which the density is bounded.
const STEPS: u32 = 256;

pub(super) struct Medium {
    density: SectionDensity,
    /// Bounds of the extinction within the plies' circle, and of the fuzz around it, per outer radius.
    most_inside: f64,
    most_outside: f64,
}

/// Where a photon meets a fiber.
pub(super) struct Collision {
    pub q: DVec2,
    /// The fiber's direction, a unit vector; z is the yarn's.
    pub tangent: DVec3,
}

impl Medium {
    pub fn new(density: SectionDensity) -> Self {
        let mut medium = Self { density, most_inside: 0.0, most_outside: 0.0 };
        let cell = 2.0 * medium.reach() / f64::from(STEPS);
        for k in 0..STEPS * STEPS {
            let at = |i: u32| (f64::from(i) + 0.5) * cell - medium.reach();
            let q = DVec2::new(at(k % STEPS), at(k / STEPS));
            // A fiber's projection is never wider than its length.
            let most = medium.length_density(q) * medium.diameter();
            // Half a cell of tolerance, since what lies between two steps counts for both.
            if q.length() < 1.0 + cell {
                medium.most_inside = medium.most_inside.max(most);
            }
            if q.length() > 1.0 - cell {
                medium.most_outside = medium.most_outside.max(most);
            }
        }
        medium.most_inside *= 1.05;
        medium.most_outside *= 1.05;
        medium
    }

    /// Radius that no fiber leaves, in outer radii.
    pub fn reach(&self) -> f64 {
        self.density.reach
    }

    /// Of a fiber, in outer radii.
    pub fn diameter(&self) -> f64 {
        2.0 * self.density.fiber_radius
    }

    /// Length of fibers per volume, without the one that a photon comes from.
    pub fn length_density(&self, q: DVec2) -> f64 {
        let length = |(fibers, slope): (f64, DVec2)| fibers * slope.extend(1.0).length();
        self.density.others * self.density.plies_at(q).map(length).sum::<f64>()
    }

    /// Each ply's fibers that a photon meets per length of its way at q, and their slope.
    fn extinctions(&self, q: DVec2, direction: DVec3) -> impl Iterator<Item = (f64, DVec2)> {
        let width = self.density.others * self.diameter();
        self.density
            .plies_at(q)
            .map(move |(fibers, slope)| (width * fibers * direction.cross(slope.extend(1.0)).length(), slope))
    }

    /// Depth of the way of π/4 of a fiber's radius that begins at q; backwards that ends there.
    fn depth_beside(&self, q: DVec2, direction: DVec3, backwards: bool) -> f64 {
        let across = direction.truncate();
        let size = across.length().max(1e-9);
        let way = 0.25 * PI * self.density.fiber_radius;
        let middle = q + across * (0.5 * way / size * if backwards { -1.0 } else { 1.0 });
        // The way in space is longer than that in the section.
        self.extinctions(middle, direction).map(|(sigma, _)| sigma).sum::<f64>() * (way / size).min(1.0)
    }

    /// The next fiber on the way of a photon, and the photon's weight there; `None` with its weight if it leaves the yarn. By null collisions
    /// [Woodcock1965].
    ///
    /// A ray *from* a fiber towards the light meets none that contain its start: none within π/4 of a fiber's radius, on average ([`crate::SelfShadow`]).
    /// A photon goes the other way. On its way from fiber a to b, the last stretch before b is free, not the first after a; one
    /// that leaves the yarn has none. Here the first stretch is skipped, since all of it lies among fibers, and weights make up for the difference.
    pub fn next(
        &self,
        from: DVec2,
        direction: DVec3,
        leaves_fiber: bool,
        random: &mut Random,
    ) -> (f64, Option<Collision>) {
        let across = direction.truncate();
        let (mut q, mut log_weight) = (from, 0.0);
        if leaves_fiber {
            q += across.normalize_or_zero() * (0.25 * PI * self.density.fiber_radius);
            log_weight = -self.depth_beside(from, direction, false);
        }
        loop {
            let inside = q.length_squared() < 1.0;
            let most = if inside { self.most_inside } else { self.most_outside };
            let step = -(1.0 - random.unit()).ln() / most.max(1e-12);
            // The bound holds as far as the circle that it is for.
            let border =
                if inside { way_to_circle(q, across, 1.0).map(|(_, out)| out) } else { self.way_outside(q, across) };
            let Some(border) = border else { return (log_weight.exp(), None) };
            if step >= border {
                // Just beyond it, so that rounding cannot leave the photon where it was.
                q += across * (border * (1.0 + 1e-9) + 1e-9);
                continue;
            }
            q += across * step;
            let mut left = random.unit() * most;
            for (sigma, slope) in self.extinctions(q, direction) {
                left -= sigma;
                if left < 0.0 {
                    let weight = (log_weight + self.depth_beside(q, direction, true)).exp();
                    return (weight, Some(Collision { q, tangent: slope.extend(1.0).normalize() }));
                }
            }
        }
    }

    /// Way from a point of the fuzz to the plies' circle or out of the yarn; `None` outside.
    fn way_outside(&self, q: DVec2, across: DVec2) -> Option<f64> {
        if q.length() >= self.reach() {
            return None;
        }
        let out = way_to_circle(q, across, self.reach())?.1;
        Some(match way_to_circle(q, across, 1.0) {
            Some((enter, _)) if enter > 0.0 => enter,
            _ => out,
        })
    }
}

/// Ways at which a ray across the section enters and leaves a circle about the centre.
fn way_to_circle(q: DVec2, across: DVec2, radius: f64) -> Option<(f64, f64)> {
    let a = across.length_squared();
    let b = q.dot(across);
    let root = b * b - a * (q.length_squared() - radius * radius);
    // Along the yarn, nothing is ever left: such photons are lost, a set of measure 0.
    (a > 1e-18 && root > 0.0).then(|| ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a))
}
