//! All fibers of a scene, and what rays meet among them.

use std::ops::ControlFlow;

use glam::DVec3;
use rayon::prelude::*;

use crate::Error;
use crate::cone::{Entry, RoundCone};
use crate::fibers::{Fibers, position};
use crate::hierarchy::{Extent, Hierarchy, NOTHING, union};
use crate::tangent::{direction_along, tangent_at};

pub use crate::hierarchy::Ray;

/// Leaves at most. A leaf is a run of neighbouring round cones of a fiber: one for scenes with fewer cones than this, more for larger ones.
/// Runs of 2, 4 and 8 instead of 1 take 26, 21 and 19 bytes a cone instead of 36, and rays take 1.3, 2.4 and 5 times as long
/// (`examples/rays.rs`, 9 M cones).
const MOST_LEAVES: usize = 25_000_000;

/// Longest run.
const MOST_RUN: usize = 8;

/// A hit within this share of a radius below the neighbour's surface is on it.
const JOINT: f64 = 1e-6;

/// Fibers with a bounding volume hierarchy over runs of them.
pub struct Assembly {
    /// Chains one after another; the radius of a chain's last point has its sign bit set.
    points: Vec<[f32; 4]>,
    /// Most segments of a run.
    run: usize,
    /// Over the first segments of all runs.
    hierarchy: Hierarchy,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance.
    pub t: f64,
    /// Number of the round cone: that of its first point.
    pub segment: u32,
    /// Place along it, 0 to 1.
    pub along: f64,
}

/// The surface at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// On the surface.
    pub position: DVec3,
    /// Unit normal of the fiber that the chords stand for: perpendicular to its tangent, but for its round ends.
    pub normal: DVec3,
    /// Unit normal of the round cone.
    pub cone_normal: DVec3,
    /// Unit tangent, interpolated along the fiber, towards growing length coordinates.
    pub tangent: DVec3,
    /// Radius of the fiber.
    pub radius: f64,
}

impl Assembly {
    /// Builds the hierarchy. `progress` is called several times a second and can stop the work.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn new(fibers: Fibers, progress: &mut dyn FnMut() -> ControlFlow<()>) -> Result<Self, Error> {
        let Fibers { mut points, offsets } = fibers;
        let run = (points.len() / MOST_LEAVES + 1).min(MOST_RUN);
        let ends = offsets.windows(2).map(|w| w[0] as usize..w[1] as usize);
        let mut runs = Vec::new();
        for chain in ends {
            runs.extend(chain.clone().take(chain.len() - 1).step_by(run).map(|first| first as u32));
            let last = &mut points[chain.end - 1][3];
            *last = -last.abs();
        }
        let about = |point: &[f32; 4]| -> Extent {
            let (at, reach) = (position(*point), f64::from(point[3].abs()));
            (at - reach, at + reach)
        };
        let extent = points.par_iter().map(about).reduce(|| NOTHING, union);
        let place = |first: u32| position(points[first as usize]);
        let bounds = |first: u32| run_of(&points, first as usize, run).iter().map(about).fold(NOTHING, union);
        let hierarchy = Hierarchy::new(runs, extent, place, bounds, progress)?;
        Ok(Self { points, run, hierarchy })
    }

    /// Bytes of fibers and hierarchy.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.points[..]) + self.hierarchy.bytes()
    }

    /// Number of round cones.
    pub fn segments(&self) -> usize {
        self.points.iter().filter(|p| p[3].is_sign_positive()).count()
    }

    /// All points: position and radius, with the sign bit set at the end of a chain.
    pub(crate) fn points(&self) -> &[[f32; 4]] {
        &self.points
    }

    /// Centre and radius of a sphere that holds everything.
    pub fn bounds(&self) -> (DVec3, f64) {
        self.hierarchy.bounds()
    }

    fn cone(&self, segment: usize) -> RoundCone {
        let (a, b) = (self.points[segment], self.points[segment + 1]);
        RoundCone { a: position(a), b: position(b), radius_a: a[3].abs().into(), radius_b: b[3].abs().into() }
    }

    fn has_next(&self, segment: usize) -> bool {
        self.points[segment + 1][3].is_sign_positive()
    }

    fn has_previous(&self, segment: usize) -> bool {
        segment > 0 && self.points[segment - 1][3].is_sign_positive()
    }

    /// The nearest surface that the ray enters between the distances 0 and `reach`. A ray that starts inside of a fiber leaves it unhindered.
    pub fn nearest(&self, ray: &Ray, reach: f64) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.hierarchy.nearest(ray, reach, |first| {
            for segment in self.run_at(first) {
                let most = best.map_or(reach, |hit| hit.t);
                if let Some(entry) = self.enter(ray, segment, most) {
                    best = Some(Hit { t: entry.t, segment: segment as u32, along: entry.along });
                }
            }
            best.map_or(reach, |hit| hit.t)
        });
        best
    }

    /// Whether the ray enters any fiber between the distances 0 and `reach`.
    pub fn is_blocked(&self, ray: &Ray, reach: f64) -> bool {
        let is_blocked_by = |first: u32| self.run_at(first).any(|segment| self.enter(ray, segment, reach).is_some());
        self.hierarchy.any(ray, reach, is_blocked_by)
    }

    fn enter(&self, ray: &Ray, segment: usize, most: f64) -> Option<Entry> {
        let entry = self.cone(segment).enter(ray.origin, ray.direction)?;
        let counts = entry.t > 0.0 && entry.t < most && !self.is_inside_joint(ray, segment, entry.t);
        counts.then_some(entry)
    }

    /// Segments of the run that begins with one.
    fn run_at(&self, first: u32) -> impl Iterator<Item = usize> {
        let first = first as usize;
        first..first + run_of(&self.points, first, self.run).len() - 1
    }

    /// Whether the entry lies within the next or the previous round cone of the same fiber: no surface of the fiber.
    fn is_inside_joint(&self, ray: &Ray, segment: usize, t: f64) -> bool {
        let point = ray.origin + ray.direction * t;
        (self.has_next(segment) && self.cone(segment + 1).holds(point, JOINT))
            || (self.has_previous(segment) && self.cone(segment - 1).holds(point, JOINT))
    }

    /// The surface at a hit.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let segment = hit.segment as usize;
        let cone = self.cone(segment);
        let position = ray.origin + ray.direction * hit.t;
        let axis_point = cone.a.lerp(cone.b, hit.along);
        let from_axis = position - axis_point;
        let ends = [segment, segment + 1].map(|point| tangent_at(&self.points, point));
        let tangent = direction_along(cone.b - cone.a, ends, hit.along);
        let across = from_axis - tangent * from_axis.dot(tangent);
        let cone_normal = from_axis.normalize_or(-ray.direction);
        let is_end = (hit.along <= 0.0 && !self.has_previous(segment)) || (hit.along >= 1.0 && !self.has_next(segment));
        Surface {
            position,
            normal: if is_end { cone_normal } else { across.normalize_or(cone_normal) },
            cone_normal,
            tangent,
            radius: cone.radius_a + (cone.radius_b - cone.radius_a) * hit.along,
        }
    }
}

/// Points of the run of at most `most` segments that begins with a segment.
fn run_of(points: &[[f32; 4]], first: usize, most: usize) -> &[[f32; 4]] {
    let mut last = first + 1;
    while last < first + most && points[last][3].is_sign_positive() {
        last += 1;
    }
    &points[first..=last]
}
