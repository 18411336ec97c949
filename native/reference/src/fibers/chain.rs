//! One fiber of one curve as chains of points, as close as its bends ask for.

use std::ops::Range;

use glam::{DMat4, DVec3};
use lisle_core::yarn::{Fiber, FiberTable, Segment, Twist, Yarn, YarnPoint, breaks, fiber_point};

use super::detail::CurveDetail;

/// Angle that a fiber turns through between two points that the test of [`Walk::refine`] sees, radians: within it, the cubic
/// through both with their velocities is the curve to a few hundredths of a fiber's radius.
const MOST_TURN_RAD: f64 = 1.0;

/// Halvings of one step: a chord error that is not reached by then is below the resolution of f32.
const MOST_HALVINGS: u32 = 12;

/// Share of a segment that keeps an evaluation at a break on its own side.
const ASIDE: f64 = 1e-9;

/// What all fibers of a curve have in common.
pub(super) struct Curve<'a> {
    pub yarn: &'a Yarn,
    pub table: &'a FiberTable,
    pub twist: Twist,
    pub segments: Vec<Segment>,
    /// To the space of the points; radii grow by its mean scale.
    pub to_space: DMat4,
    pub scale: f64,
    /// How far a chord may depart from its curve, fiber radii.
    pub chord_error: f64,
    pub detail: Option<CurveDetail>,
}

/// A point on a fiber; the velocity is per segment parameter.
#[derive(Clone, Copy)]
struct Sample {
    t: f64,
    position: DVec3,
    velocity: DVec3,
    radius: f64,
    /// Radius without taper and level of detail: what errors are measured in.
    full_radius: f64,
}

/// Chains of one fiber: points, and where each chain ends.
#[derive(Default)]
pub(super) struct Chains {
    pub points: Vec<[f32; 4]>,
    pub ends: Vec<u32>,
}

impl Chains {
    /// Adds a point. A stretch without width is none.
    fn push(&mut self, sample: &Sample) {
        let open = self.points.len() - self.start();
        if sample.radius == 0.0 && open > 0 && self.points[self.points.len() - 1][3] == 0.0 {
            self.end();
        }
        let [x, y, z] = sample.position.as_vec3().to_array();
        self.points.push([x, y, z, sample.radius as f32]);
    }

    fn start(&self) -> usize {
        self.ends.last().map_or(0, |end| *end as usize)
    }

    /// Ends the chain; a single point is none.
    fn end(&mut self) {
        if self.points.len() - self.start() >= 2 {
            self.ends.push(self.points.len() as u32);
        } else {
            self.points.truncate(self.start());
        }
    }
}

struct Walk<'a> {
    curve: &'a Curve<'a>,
    fiber: Fiber,
    /// Of the segment.
    number: usize,
    chains: &'a mut Chains,
}

impl Curve<'_> {
    /// Goes on with the chains of one fiber over the next segments; at the curve's end they end.
    pub fn extend(&self, chains: &mut Chains, fiber: Fiber, segments: Range<usize>) {
        let is_end = segments.end == self.segments.len();
        for number in segments {
            Walk { curve: self, fiber, number, chains }.segment(number == 0);
        }
        if is_end {
            chains.end();
        }
    }
}

impl Walk<'_> {
    fn segment_at(&self, t: f64) -> YarnPoint {
        self.curve.segments[self.number].at(t)
    }

    fn sample(&self, t: f64) -> Sample {
        let curve = self.curve;
        let at = self.segment_at(t);
        let width = curve.detail.as_ref().map_or(1.0, |detail| detail.width(self.number, t, self.fiber.index));
        let point = fiber_point(curve.yarn, &curve.twist, curve.table, &at, self.fiber);
        let full_radius = at.radius * curve.scale * curve.yarn.fiber_radius / curve.yarn.outer_radius();
        Sample {
            t,
            position: curve.to_space.transform_point3(point.position),
            velocity: curve.to_space.transform_vector3(point.velocity),
            radius: full_radius * point.taper * width,
            full_radius,
        }
    }

    /// Adds the points of the segment, its start only if it is the curve's.
    fn segment(&mut self, first: bool) {
        if self.curve.detail.as_ref().is_some_and(|detail| detail.is_hidden(self.number, self.fiber.index)) {
            let end = self.sample(1.0);
            self.chains.push(&end);
            return;
        }
        let lengths = (self.segment_at(0.0).length, self.segment_at(1.0).length);
        let mut start = self.sample(0.0);
        if first {
            self.chains.push(&start);
        }
        for b in breaks(self.curve.yarn, &self.curve.twist, self.curve.table, self.fiber, lengths) {
            let t = self.parameter(b.length);
            let side = |offset: f64| Sample { t, ..self.sample((t + offset).clamp(0.0, 1.0)) };
            let (mut before, mut after) = (side(-ASIDE), side(ASIDE));
            if b.tip {
                (before.radius, after.radius) = (0.0, 0.0);
            }
            self.stretch(start, before);
            if b.tip {
                self.chains.end();
                self.chains.push(&after);
            }
            start = after;
        }
        let end = self.sample(1.0);
        self.stretch(start, end);
    }

    /// Where the segment has a length coordinate, which grows along it.
    fn parameter(&self, length: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if self.segment_at(middle).length < length { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Adds the points after `a` up to `b`; the fiber is smooth in between.
    fn stretch(&mut self, a: Sample, b: Sample) {
        if b.t - a.t <= 4.0 * ASIDE {
            // A break on a knot: nothing lies in between.
            return;
        }
        let lengths = self.segment_at(b.t).length - self.segment_at(a.t).length;
        let twist = &self.curve.twist;
        let turn = std::f64::consts::TAU * lengths * (twist.ply + twist.fiber + twist.migration);
        let steps = (turn / MOST_TURN_RAD).ceil().clamp(1.0, 1e6) as u32;
        let mut from = a;
        for step in 1..=steps {
            let to =
                if step == steps { b } else { self.sample(a.t + (b.t - a.t) * f64::from(step) / f64::from(steps)) };
            self.refine(&from, &to, MOST_HALVINGS);
            from = to;
        }
    }

    /// Halves a step until its chord is close enough to the cubic with the same ends and velocities.
    ///
    /// A cubic lies within ¾ of the distance of its inner control points from the chord, and twice as near if those lie on either side.
    fn refine(&mut self, a: &Sample, b: &Sample, halvings: u32) {
        let step = (b.t - a.t) / 3.0;
        let chord = b.position - a.position;
        let along = chord.normalize_or_zero();
        let off = |v: DVec3| v - along * v.dot(along);
        let (from_a, from_b) = (off(a.velocity * step), off(-b.velocity * step));
        let most = 0.75 * from_a.length().max(from_b.length());
        let seen = self.curve.detail.as_ref().map_or(0.0, |detail| detail.chord_error(self.number));
        let allowed = (self.curve.chord_error * a.full_radius.min(b.full_radius)).max(seen);
        let tapers = a.radius != a.full_radius || b.radius != b.full_radius;
        if halvings == 0 || (most <= allowed && !tapers) {
            self.chains.push(b);
            return;
        }
        let middle = self.sample(0.5 * (a.t + b.t));
        let taper_error = (middle.radius - 0.5 * (a.radius + b.radius)).abs();
        if most <= allowed && taper_error <= allowed {
            self.chains.push(b);
        } else {
            self.refine(a, &middle, halvings - 1);
            self.refine(&middle, b, halvings - 1);
        }
    }
}
