//! Yarns: a rest shape, a current shape, and the strands that the renderer draws.

use super::Layout;
use super::closest_approach::{mean_edge, radius_by_closest_approach};
use super::current_normals::{Shapes, current_normals};
use super::resample::Plan;
use super::rest_normals::rest_normals;
use super::tangents::tangents;
use crate::curve::{Basis, Curves};
use crate::error::Error;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// A radius of zero, as at the tip of a hair, is drawn as this part of its curve's largest radius.
pub const ZERO_RADIUS: f32 = 1e-3;

/// Yarn radius of a set whose strands never come close to each other and that has no radii, in mean distances of
/// neighbouring points.
const LONE_RADIUS: f64 = 0.25;

/// Yarn curves in a rest shape and a current shape. Cloning shares all arrays.
///
/// `n` is the number of control points, `c` of curves; lengths are in the units of the points.
#[derive(Debug, Clone)]
pub struct Yarns {
    rest: Arc<Rest>,
    points: Arc<Vec<[f32; 3]>>,
    strands: OnceLock<Strands>,
}

/// What all frames share.
#[derive(Debug, Clone)]
struct Rest {
    /// The rest control points are here; radii are there and valid.
    curves: Arc<Curves>,
    radii: Arc<Vec<f32>>,
    /// `None`: all curves are Catmull-Rom, and their control points are the knots.
    plan: Option<Arc<Plan>>,
    positions: Arc<Vec<[f32; 3]>>,
    tangents: Arc<Vec<[f32; 3]>>,
    normals: Arc<Vec<[f32; 3]>>,
    knots: Arc<Knots>,
    length_coordinates: Arc<Vec<f32>>,
}

/// What strands share between frames.
#[derive(Debug, Clone)]
struct Knots {
    offsets: Vec<u32>,
    closed: Vec<bool>,
    lengths: Vec<f64>,
    total_lengths: Vec<f64>,
    radii: Vec<f32>,
    reference_radii: Vec<f64>,
}

impl Knots {
    fn layout(&self) -> Layout<'_> {
        Layout { offsets: &self.offsets, closed: &self.closed }
    }
}

/// Uniform Catmull-Rom knots of all curves, `k` in all, as the renderer takes them. The ends of an open curve continue by
/// reflection, `2 p0 - p1`. Units are those of the points.
#[derive(Debug, Clone)]
pub struct Strands {
    positions: Arc<Vec<[f32; 3]>>,
    normals: Arc<Vec<[f32; 3]>>,
    knots: Arc<Knots>,
}

impl Strands {
    /// `k` positions in the current shape.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// `k` unit normals in the current shape, perpendicular to the Catmull-Rom tangent at the knot; where that vanishes
    /// (repeated points, a reversal), to the tangent of the knot before.
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    /// `k` length coordinates: arc length of the rest curve from its start.
    pub fn lengths(&self) -> &[f64] {
        &self.knots.lengths
    }

    /// `k` yarn radii, positive.
    pub fn radii(&self) -> &[f32] {
        &self.knots.radii
    }

    /// `c + 1` entries: curve `i` owns the knots `offsets[i]..offsets[i + 1]`, at least 2, a closed one at least 3.
    pub fn offsets(&self) -> &[u32] {
        &self.knots.offsets
    }

    /// `c` entries: whether a segment leads from the curve's last knot to its first.
    pub fn closed(&self) -> &[bool] {
        &self.knots.closed
    }

    /// `c` rest lengths, with the closing segment of a closed curve: the length coordinate at the curve's end.
    pub fn total_lengths(&self) -> &[f64] {
        &self.knots.total_lengths
    }

    /// `c` mean radii of the curves' control points. They set the scale of the twist.
    pub fn reference_radii(&self) -> &[f64] {
        &self.knots.reference_radii
    }
}

impl Yarns {
    /// Yarns at rest in the shape of `curves`. `yarn_radius`, if given, replaces the radii of `curves`; without either,
    /// the radius is half the distance at which strands touch, estimated from the closest approach of neighbouring
    /// strands, or a quarter of the mean distance between points if none come close.
    ///
    /// # Errors
    /// [`Error`] for curves or a radius that cannot be drawn, naming curve, index and reason.
    pub fn new(mut curves: Curves, yarn_radius: Option<f32>) -> Result<Self, Error> {
        if let Some(value) = yarn_radius.filter(|r| !(r.is_finite() && *r > 0.0)) {
            return Err(Error::YarnRadius { value });
        }
        curves.validate()?;
        let radii = match (yarn_radius, curves.radii.take()) {
            (Some(radius), _) => vec![radius; curves.points.len()],
            (None, Some(radii)) => raise_zeros(&curves, radii),
            (None, None) => vec![estimate_radius(&curves)?; curves.points.len()],
        };
        let reference: Vec<f64> = (0..curves.len()).into_par_iter().map(|i| mean(&radii[curves.range(i)])).collect();
        let plan = if curves.basis.iter().all(|b| *b == Basis::CatmullRom) {
            None
        } else {
            Some(Arc::new(Plan::new(&curves, &reference)?))
        };
        let points = Arc::new(curves.points.clone());
        let rest = Rest::new(curves, radii, reference, plan, &points);
        let strands =
            Strands { positions: rest.positions.clone(), normals: rest.normals.clone(), knots: rest.knots.clone() };
        Ok(Self { rest: Arc::new(rest), points, strands: OnceLock::from(strands) })
    }

    /// The same yarns in another shape: lengths, radii and rest frames stay. A curve may collapse to a point; it then keeps its
    /// rest directions.
    ///
    /// # Errors
    /// [`Error::PointCountChanged`], or [`Error::Point`] for a coordinate that is not finite.
    pub fn with_points(&self, points: &[[f32; 3]]) -> Result<Self, Error> {
        let old = self.points.len();
        if points.len() != old {
            let new = points.len();
            let curves = &self.rest.curves;
            let is_before = |curve: &usize| curves.range(*curve).end <= new;
            let curve = (0..curves.len() - 1).find(|curve| !is_before(curve)).unwrap_or(curves.len() - 1);
            let index = new.min(old) - curves.range(curve).start;
            return Err(Error::PointCountChanged { curve, index, old, new });
        }
        self.rest.curves.validate_points(points)?;
        Ok(Self { rest: self.rest.clone(), points: Arc::new(points.to_vec()), strands: OnceLock::new() })
    }

    /// The same yarns with length coordinates from a file, one per control point. They never decrease along a curve. The
    /// closing segment of a closed curve keeps its own length, scaled as the rest of the curve.
    ///
    /// # Errors
    /// [`Error::ArrayLength`], or [`Error::LengthCoordinate`] for one that is not finite or decreases, and for a curve
    /// whose coordinates are all equal.
    pub fn with_length_coordinates(&self, coordinates: &[f32]) -> Result<Self, Error> {
        let curves = &self.rest.curves;
        if coordinates.len() != self.points.len() {
            let (expected, found) = (self.points.len(), coordinates.len());
            return Err(Error::ArrayLength { array: "length coordinates", expected, found });
        }
        for curve in 0..curves.len() {
            validate_coordinates(&coordinates[curves.range(curve)])
                .map_err(|(index, value, reason)| Error::LengthCoordinate { curve, index, value, reason })?;
        }
        let mut knots = Knots::clone(&self.rest.knots);
        for curve in 0..curves.len() {
            let points = curves.range(curve);
            let range = knots.layout().range(curve);
            let own: Vec<f64> = match &self.rest.plan {
                None => knots.lengths[range.clone()].to_vec(),
                Some(_) => control_lengths(curves, &self.rest.plan, curve, &knots.lengths[range.clone()]),
            };
            let map = LengthMap { own, given: &coordinates[points] };
            for length in &mut knots.lengths[range] {
                *length = map.at(*length);
            }
            knots.total_lengths[curve] = map.at(knots.total_lengths[curve]);
        }
        let mut rest = Rest::clone(&self.rest);
        rest.knots = Arc::new(knots);
        rest.length_coordinates = Arc::new(coordinates.to_vec());
        let strands = self.strands.get().map(|s| Strands { knots: rest.knots.clone(), ..s.clone() });
        Ok(Self {
            rest: Arc::new(rest),
            points: self.points.clone(),
            strands: strands.map_or_else(OnceLock::new, OnceLock::from),
        })
    }

    /// `n` control points of the current shape.
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// `n` control points of the rest shape.
    pub fn rest_points(&self) -> &[[f32; 3]] {
        &self.rest.curves.points
    }

    /// `c + 1` entries: curve `i` owns the control points `offsets[i]..offsets[i + 1]`.
    pub fn offsets(&self) -> &[u32] {
        &self.rest.curves.offsets
    }

    /// `c` entries: whether the curve returns to its start.
    pub fn closed(&self) -> &[bool] {
        &self.rest.curves.closed
    }

    /// `c` bases.
    pub fn basis(&self) -> &[Basis] {
        &self.rest.curves.basis
    }

    /// `n` yarn radii, positive.
    pub fn radii(&self) -> &[f32] {
        &self.rest.radii
    }

    /// `n` length coordinates: arc length of the rest yarn up to the control point, from 0 for each curve, or those of
    /// [`with_length_coordinates`](Self::with_length_coordinates). A control point beside its curve has that of its mean knot.
    pub fn length_coordinates(&self) -> &[f32] {
        &self.rest.length_coordinates
    }

    /// The yarns as the renderer takes them, computed at the first call.
    pub fn strands(&self) -> &Strands {
        self.strands.get_or_init(|| {
            let rest = &self.rest;
            let positions = match &rest.plan {
                None => self.points.clone(),
                Some(plan) => Arc::new(plan.positions(&rest.curves, &self.points)),
            };
            let layout = rest.knots.layout();
            let normals = current_normals(&Shapes {
                layout,
                rest_positions: &rest.positions,
                rest_tangents: &rest.tangents,
                rest_normals: &rest.normals,
                positions: &positions,
                tangents: &tangents(&positions, layout, Some(&rest.tangents)),
            });
            Strands { positions, normals: Arc::new(normals), knots: rest.knots.clone() }
        })
    }
}

impl Rest {
    fn new(
        curves: Curves,
        radii: Vec<f32>,
        reference_radii: Vec<f64>,
        plan: Option<Arc<Plan>>,
        points: &Arc<Vec<[f32; 3]>>,
    ) -> Self {
        let (positions, knot_radii, offsets) = match &plan {
            None => (points.clone(), radii.clone(), curves.offsets.clone()),
            Some(plan) => {
                (Arc::new(plan.positions(&curves, points)), plan.radii(&curves, &radii), plan.offsets.clone())
            }
        };
        let (lengths, total_lengths) = rest_lengths(&curves, &plan, &offsets);
        let closed = curves.closed.clone();
        let knots = Knots { offsets, closed, lengths, total_lengths, radii: knot_radii, reference_radii };
        let tangents = tangents(&positions, knots.layout(), None);
        let normals = rest_normals(&positions, &tangents, &knots.lengths, &knots.total_lengths, knots.layout());
        let length_coordinates = match &plan {
            None => knots.lengths.par_iter().map(|&s| s as f32).collect(),
            Some(_) => (0..curves.len())
                .into_par_iter()
                .flat_map_iter(|i| {
                    let lengths = control_lengths(&curves, &plan, i, &knots.lengths[knots.layout().range(i)]);
                    lengths.into_iter().map(|s| s as f32)
                })
                .collect(),
        };
        Self {
            curves: Arc::new(curves),
            radii: Arc::new(radii),
            plan,
            positions,
            tangents: Arc::new(tangents),
            normals: Arc::new(normals),
            knots: Arc::new(knots),
            length_coordinates: Arc::new(length_coordinates),
        }
    }
}

/// Arc length from the curve's start to each knot, and to the end of each curve.
fn rest_lengths(curves: &Curves, plan: &Option<Arc<Plan>>, offsets: &[u32]) -> (Vec<f64>, Vec<f64>) {
    let per_curve: Vec<(Vec<f64>, f64)> = (0..curves.len())
        .into_par_iter()
        .map(|i| {
            let curve = curves.curve(i);
            let count = (offsets[i + 1] - offsets[i]) as usize;
            let intervals = if curve.closed() { count } else { count - 1 };
            let mut lengths: Vec<f64> = (0..intervals)
                .into_par_iter()
                .with_min_len(1024)
                .map(|k| {
                    let (segment, t0, t1) = plan.as_ref().map_or((k, 0.0, 1.0), |plan| plan.interval(i, k));
                    curve.length(segment, t0, t1)
                })
                .collect();
            let mut total = 0.0;
            for length in &mut lengths {
                total += std::mem::replace(length, total);
            }
            if !curve.closed() {
                lengths.push(total);
            }
            (lengths, total)
        })
        .collect();
    let totals = per_curve.iter().map(|(_, total)| *total).collect();
    let mut lengths = Vec::with_capacity(offsets.last().map_or(0, |&n| n as usize));
    for (curve, _) in per_curve {
        lengths.extend(curve);
    }
    (lengths, totals)
}

/// Arc length from the curve's start to each of its control points, given that to its knots.
fn control_lengths(curves: &Curves, plan: &Option<Arc<Plan>>, index: usize, knot_lengths: &[f64]) -> Vec<f64> {
    let curve = curves.curve(index);
    let Some(plan) = plan else {
        return knot_lengths.to_vec();
    };
    (0..curves.range(index).len())
        .map(|point| {
            let (segment, t) = curve.control_parameter(point);
            let knot = plan.knot_before(index, segment, t);
            let (knot_segment, start, _) = plan.interval(index, knot);
            let rest = if knot_segment == segment && t > start { curve.length(segment, start, t) } else { 0.0 };
            knot_lengths[knot] + rest
        })
        .collect()
}

/// Takes the curve's own lengths to given ones: linear between control points, beyond them scaled as on average.
struct LengthMap<'a> {
    own: Vec<f64>,
    given: &'a [f32],
}

impl LengthMap<'_> {
    fn at(&self, length: f64) -> f64 {
        let given = |i: usize| f64::from(self.given[i]);
        let last = self.own.len() - 1;
        let i = self.own.partition_point(|&own| own <= length);
        if i == 0 || i > last {
            let end = if i == 0 { 0 } else { last };
            let scale = (given(last) - given(0)) / (self.own[last] - self.own[0]);
            return given(end) + (length - self.own[end]) * scale;
        }
        let t = (length - self.own[i - 1]) / (self.own[i] - self.own[i - 1]);
        given(i - 1) + t * (given(i) - given(i - 1))
    }
}

fn validate_coordinates(coordinates: &[f32]) -> Result<(), (usize, f32, &'static str)> {
    let mut before = f32::NEG_INFINITY;
    for (index, &value) in coordinates.iter().enumerate() {
        if !value.is_finite() {
            return Err((index, value, "it must be finite"));
        }
        if value < before {
            return Err((index, value, "it must not be less than the one before it"));
        }
        before = value;
    }
    let last = coordinates.len() - 1;
    if coordinates[last] > coordinates[0] {
        Ok(())
    } else {
        Err((last, before, "the curve's coordinates are all equal"))
    }
}

fn raise_zeros(curves: &Curves, mut radii: Vec<f32>) -> Vec<f32> {
    for curve in 0..curves.len() {
        let radii = &mut radii[curves.range(curve)];
        let least = ZERO_RADIUS * radii.iter().copied().fold(0.0, f32::max);
        for radius in radii {
            *radius = radius.max(least);
        }
    }
    radii
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64
}

/// A yarn radius for curves without one.
fn estimate_radius(curves: &Curves) -> Result<f32, Error> {
    let sampled;
    let (positions, offsets) = if curves.basis.iter().all(|b| matches!(b, Basis::CatmullRom | Basis::Linear)) {
        (&curves.points, &curves.offsets)
    } else {
        sampled = Plan::coarse(curves)?;
        (&sampled.positions(curves, &curves.points), &sampled.offsets)
    };
    let layout = Layout { offsets, closed: &curves.closed };
    let radius =
        radius_by_closest_approach(positions, layout).unwrap_or_else(|| LONE_RADIUS * mean_edge(positions, layout));
    Ok(radius.max(f64::from(f32::MIN_POSITIVE)) as f32)
}
