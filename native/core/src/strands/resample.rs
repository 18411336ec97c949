//! Catmull-Rom knots for curves of any basis.
//!
//! # How it works
//! The renderer draws uniform Catmull-Rom curves only. A curve of another basis is replaced by knots on it: first one
//! per segment (three in a Bézier segment, so that knots are about as dense as control points), then the intervals
//! between knots are halved, in their parameter, until the Catmull-Rom curve through the knots stays within
//! [`TOLERANCE`] of the yarn radius from the exact curve, and neighbouring intervals differ at most twofold in length.
//! The corners of a polyline end up rounded at that tolerance. All this happens once, on the rest shape; other frames
//! put their knots at the same parameters.

use crate::curve::{Curve, Curves, to_f32};
use crate::error::Error;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Distance allowed between the drawn and the exact rest curve, in mean yarn radii of the curve.
pub const TOLERANCE: f64 = 0.02;

/// Intervals are halved this often at most. Beyond, as beyond [`MAX_KNOTS_PER_SEGMENT`], the drawn curve keeps the
/// deviation that it has then.
pub const MAX_DEPTH: u8 = 14;

/// The refinement of a curve ends when it would exceed this many knots per segment on average (or 4096 in all, for a
/// short curve).
pub const MAX_KNOTS_PER_SEGMENT: usize = 64;

/// Where the knots of all curves lie.
#[derive(Debug)]
pub(super) struct Plan {
    /// Knots of curve `i`: `offsets[i]..offsets[i + 1]`.
    pub offsets: Vec<u32>,
    /// Per knot.
    places: Vec<Place>,
}

/// A segment of a curve and a parameter in `[0, 1]` on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    segment: u32,
    t: f32,
}

impl Plan {
    /// Knots for valid curves; `radii` holds a mean radius per curve.
    pub fn new(curves: &Curves, radii: &[f64]) -> Result<Self, Error> {
        Self::of((0..curves.len()).into_par_iter().map(|i| refine(&curves.curve(i), TOLERANCE * radii[i])).collect())
    }

    /// A first approximation, for curves whose radius is not known.
    pub fn coarse(curves: &Curves) -> Result<Self, Error> {
        Self::of((0..curves.len()).into_par_iter().map(|i| refine(&curves.curve(i), f64::INFINITY)).collect())
    }

    fn of(places: Vec<Vec<Place>>) -> Result<Self, Error> {
        let count = places.iter().map(Vec::len).sum();
        if count > u32::MAX as usize {
            return Err(Error::TooManyPoints { count, max: u32::MAX as usize });
        }
        let ends = places.iter().scan(0, |end, curve| {
            *end += curve.len() as u32;
            Some(*end)
        });
        Ok(Self { offsets: std::iter::once(0).chain(ends).collect(), places: places.concat() })
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    pub fn range(&self, curve: usize) -> Range<usize> {
        self.offsets[curve] as usize..self.offsets[curve + 1] as usize
    }

    /// Positions of all knots on the curves through `points`.
    pub fn positions(&self, curves: &Curves, points: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.map(curves, points, |_, curve, place| to_f32(curve.position(place.segment as usize, f64::from(place.t))))
    }

    /// Radii of all knots from those of the control points.
    pub fn radii(&self, curves: &Curves, radii: &[f32]) -> Vec<f32> {
        self.map(curves, &curves.points, |i, curve, place| {
            curve.blend(place.segment as usize, f64::from(place.t), &radii[curves.range(i)]) as f32
        })
    }

    fn map<T: Default + Clone + Send>(
        &self,
        curves: &Curves,
        points: &[[f32; 3]],
        value: impl Fn(usize, &Curve<'_>, Place) -> T + Sync,
    ) -> Vec<T> {
        const BLOCK: usize = 1024;
        let mut values = vec![T::default(); self.len()];
        let mut parts = Vec::with_capacity(curves.len());
        let mut rest = values.as_mut_slice();
        for curve in 0..curves.len() {
            let (part, tail) = rest.split_at_mut(self.range(curve).len());
            parts.push(part);
            rest = tail;
        }
        parts.into_par_iter().enumerate().for_each(|(i, part)| {
            let curve = curves.curve_through(i, points);
            let places = &self.places[self.range(i)];
            part.par_chunks_mut(BLOCK).zip(places.par_chunks(BLOCK)).for_each(|(part, places)| {
                for (slot, place) in part.iter_mut().zip(places) {
                    *slot = value(i, &curve, *place);
                }
            });
        });
        values
    }

    /// Segment and parameter range between a knot of a curve (counted within it) and the next; the last one of a closed
    /// curve ends with the curve.
    pub fn interval(&self, curve: usize, knot: usize) -> (usize, f64, f64) {
        let places = &self.places[self.range(curve)];
        let Place { segment, t } = places[knot];
        let end = places.get(knot + 1).filter(|next| next.segment == segment).map_or(1.0, |next| f64::from(next.t));
        (segment as usize, f64::from(t), end)
    }

    /// The last knot of a curve, counted within it, at or before a place.
    pub fn knot_before(&self, curve: usize, segment: usize, t: f64) -> usize {
        let places = &self.places[self.range(curve)];
        places.partition_point(|p| (p.segment as usize, f64::from(p.t)) <= (segment, t)).saturating_sub(1)
    }
}

/// A knot during refinement, with the state of the interval that it begins.
#[derive(Clone, Copy)]
struct Knot {
    place: Place,
    position: DVec3,
    depth: u8,
    /// Whether the interval is known to need no halving. A change next to it makes this unknown again.
    settled: bool,
}

/// Places of the knots of one curve; `tolerance` in the units of its points.
fn refine(curve: &Curve<'_>, tolerance: f64) -> Vec<Place> {
    let knot = |segment: u32, t: f32, depth: u8| Knot {
        place: Place { segment, t },
        position: curve.position(segment as usize, f64::from(t)),
        depth,
        settled: false,
    };
    let segments = curve.segment_count();
    let mut knots = Vec::with_capacity(segments + 1);
    for segment in 0..segments as u32 {
        let pieces = curve.initial_pieces();
        knots.extend((0..pieces).map(|i| knot(segment, i as f32 / pieces as f32, 0)));
    }
    if !curve.closed() {
        knots.push(Knot { settled: true, ..knot(segments as u32 - 1, 1.0, 0) });
    }
    let budget = (MAX_KNOTS_PER_SEGMENT * segments).max(4096);
    loop {
        let split: Vec<bool> = (0..knots.len())
            .map(|i| !knots[i].settled && knots[i].depth < MAX_DEPTH && needs_halving(curve, &knots, i, tolerance))
            .collect();
        let halvings = split.iter().filter(|s| **s).count();
        if halvings == 0 || knots.len() + halvings > budget {
            return knots.iter().map(|k| k.place).collect();
        }
        let n = knots.len();
        let near = |i: usize| split[i] || split[(i + 1) % n] || split[(i + n - 1) % n];
        let mut finer = Vec::with_capacity(n + halvings);
        for i in 0..n {
            let Knot { place, depth, .. } = knots[i];
            if split[i] {
                let end = interval_end(&knots, i);
                finer.push(Knot { depth: depth + 1, settled: false, ..knots[i] });
                finer.push(knot(place.segment, 0.5 * (place.t + end), depth + 1));
            } else {
                let last_of_open = i + 1 == n && !curve.closed();
                finer.push(Knot { settled: last_of_open || !near(i), ..knots[i] });
            }
        }
        knots = finer;
    }
}

fn interval_end(knots: &[Knot], i: usize) -> f32 {
    let segment = knots[i].place.segment;
    knots.get(i + 1).filter(|next| next.place.segment == segment).map_or(1.0, |next| next.place.t)
}

/// Whether the interval that knot `i` begins deviates too much from the curve, or is too long beside a neighbour.
fn needs_halving(curve: &Curve<'_>, knots: &[Knot], i: usize, tolerance: f64) -> bool {
    let n = knots.len() as isize;
    let p: [DVec3; 4] = std::array::from_fn(|k| {
        let at = |j: isize| knots[j.rem_euclid(n) as usize].position;
        let j = i as isize + k as isize - 1;
        match j {
            _ if curve.closed() => at(j),
            -1 => 2.0 * at(0) - at(1),
            j if j == n => 2.0 * at(n - 1) - at(n - 2),
            j => at(j),
        }
    });
    let [before, length, after] = [p[1] - p[0], p[2] - p[1], p[3] - p[2]].map(DVec3::length);
    // Lengths near the tolerance do not count: repeated points must not split their neighbours without end.
    if length > 2.001 * before.max(tolerance) || length > 2.001 * after.max(tolerance) {
        return true;
    }
    let (start, end) = (f64::from(knots[i].place.t), f64::from(interval_end(knots, i)));
    [0.25, 0.5, 0.75].iter().any(|&t: &f64| {
        let (t2, t3) = (t * t, t * t * t);
        let drawn = 0.5
            * (p[0] * (2.0 * t2 - t - t3)
                + p[1] * (3.0 * t3 - 5.0 * t2 + 2.0)
                + p[2] * (t + 4.0 * t2 - 3.0 * t3)
                + p[3] * (t3 - t2));
        distance(curve, knots[i].place.segment as usize, start, end, t, drawn) > tolerance
    })
}

/// Distance from a point to the exact curve on an interval, searched by Newton's iteration from a fraction of it.
fn distance(curve: &Curve<'_>, segment: usize, start: f64, end: f64, fraction: f64, point: DVec3) -> f64 {
    let mut t = start + fraction * (end - start);
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let jet = curve.jet(segment, t);
        best = best.min(jet.position.distance(point));
        let square = jet.first.length_squared();
        if square == 0.0 {
            break;
        }
        t = (t + (point - jet.position).dot(jet.first) / square).clamp(start, end);
    }
    best
}
