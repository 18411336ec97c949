//! A yarn's fibers as a medium through which photons walk: expected numbers in place of fibers, the same all along the yarn.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use lisle_core::sampling::Random;

use crate::self_shadow::in_common;
use crate::{SHARED_OVER_WIDTH, SectionDensity, SelfShadow};

/// Steps across the section at which the density is bounded.
const STEPS: u32 = 256;

pub(super) struct Medium {
    density: SectionDensity,
    shadow: SelfShadow,
    /// Bounds of the extinction within the plies' circle, and of the fuzz around it, per outer radius.
    most_inside: f64,
    most_outside: f64,
}

/// The way by which a photon came to a fiber.
pub(super) struct Way {
    /// Back along it, in the section.
    back: DVec2,
    /// Optical depth of it.
    depth: f64,
}

/// Where a photon meets a fiber.
pub(super) struct Collision {
    pub q: DVec2,
    /// The fiber's direction, a unit vector; z is the yarn's.
    pub tangent: DVec3,
}

impl Medium {
    pub fn new(density: SectionDensity) -> Self {
        let shadow = SelfShadow::new(&density);
        let mut medium = Self { density, shadow, most_inside: 0.0, most_outside: 0.0 };
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

    /// Share of the fibers at q that a viewer in that direction of the section sees.
    pub fn seen(&self, q: DVec2, toward_viewer: DVec2) -> f64 {
        (-self.shadow.at(toward_viewer.to_angle(), q)).exp()
    }

    /// Fibers that a photon meets per length of its way at q.
    fn extinction(&self, q: DVec2, direction: DVec3) -> f64 {
        self.extinctions(q, direction).map(|(sigma, _)| sigma).sum()
    }

    /// Depth of the way that is free since no fiber contains a photon's start: the part of a fiber's section, half of which lies on either side.
    ///
    /// Along a ray that meets a fiber under an angle γ that way is πr / (4 sin γ) on average, so that its depth does not depend on the direction.
    fn free_depth(&self, q: DVec2) -> f64 {
        let share_of_volume = PI * self.density.fiber_radius.powi(2) * self.length_density(q);
        // Fibers of a yarn that anyone could make have room beside each other.
        0.5 * share_of_volume.min(1.0)
    }

    /// The same of a photon that goes there, whose way to q is known to be free.
    pub fn seen_after(&self, q: DVec2, toward_viewer: DVec2, came: &Way) -> f64 {
        self.seen(q, toward_viewer) * self.depth_in_common(q, toward_viewer, came).exp()
    }

    /// The way from one place to another in a direction; from outside the yarn if it begins nowhere.
    pub fn way(&self, from: Option<DVec2>, to: DVec2, direction: DVec3) -> Way {
        let back = -direction.truncate();
        let depth = |q: DVec2| self.shadow.at(back.to_angle(), q);
        Way { back, depth: (depth(to) - from.map_or(0.0, depth)).max(0.0) }
    }

    /// Depth of the beginning of a photon's way on that has no fibers since there were none on the way by which it came ([`SelfShadow::over_width_of_seen`]).
    fn depth_in_common(&self, q: DVec2, across: DVec2, came: &Way) -> f64 {
        let angle = across.angle_to(came.back).abs();
        let most = came.depth.min(self.shadow.at(across.to_angle(), q));
        in_common(0.5 * self.density.extinction(q) * self.density.fiber_radius, angle, SHARED_OVER_WIDTH * most)
    }

    /// The next fiber on the way of a photon, and the photon's weight there; `None` with its weight if it leaves the yarn. By null collisions
    /// [Woodcock1965]. `came`: how it came to the fiber that it leaves, if it leaves one.
    ///
    /// A ray *from* a fiber towards the light meets none that contain its start ([`crate::SelfShadow`]). A photon goes the other way. On its way from fiber a
    /// to b, the last stretch before b is free, not the first after a; one
    /// that leaves the yarn has none. Here the first stretch is skipped, since all of it lies among fibers, and weights make up for the difference.
    pub fn next(
        &self,
        from: DVec2,
        direction: DVec3,
        came: Option<&Way>,
        random: &mut Random,
    ) -> (f64, Option<Collision>) {
        let across = direction.truncate();
        let (mut q, mut log_weight) = (from, 0.0);
        if let Some(came) = came {
            let sigma = self.extinction(from, direction).max(1e-12);
            let free = (self.free_depth(from) / sigma).min(self.reach());
            let common = (self.depth_in_common(from, across, came) / sigma).min(self.reach());
            q += across * (free + common);
            log_weight = -self.extinction(from + across * (0.5 * free), direction) * free;
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
                    let before = q - across.normalize_or_zero() * (0.125 * PI * self.density.fiber_radius);
                    let weight = (log_weight + self.free_depth(before)).exp();
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
    // Along the yarn, nothing is ever met: such photons count as having left, a set of measure 0.
    (a > 1e-18 && root > 0.0).then(|| ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a))
}
