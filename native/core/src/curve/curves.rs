//! A set of curves, and what makes it valid.

use super::nurbs::Nurbs;
use super::{Basis, Curve, KnotMode, MAX_ORDER};
use crate::error::Error;
use rayon::prelude::*;
use std::ops::Range;

/// Coordinates beyond this would overflow f32 arithmetic on the GPU.
const MAX_COORDINATE: f32 = 1e15;

/// Control points of `c` curves with `n` points in all. Plain data: [`validate`](Self::validate) says whether it is drawable.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// `n` control points.
    pub points: Vec<[f32; 3]>,
    /// `c + 1` entries: curve `i` owns the points `offsets[i]..offsets[i + 1]`.
    pub offsets: Vec<u32>,
    /// `c` entries: whether the curve returns to its start.
    pub closed: Vec<bool>,
    /// `c` entries.
    pub basis: Vec<Basis>,
    /// `n` yarn radii in the units of the points, when the source has them.
    pub radii: Option<Vec<f32>>,
}

impl Curves {
    /// Catmull-Rom curves, one per list of points, without radii.
    pub fn catmull_rom(points: Vec<Vec<[f32; 3]>>, closed: bool) -> Self {
        Self::of_basis(points, closed, Basis::CatmullRom)
    }

    /// Curves of one basis, one per list of points, without radii.
    pub fn of_basis(points: Vec<Vec<[f32; 3]>>, closed: bool, basis: Basis) -> Self {
        let offsets = std::iter::once(0)
            .chain(points.iter().scan(0, |end, curve| {
                *end += curve.len() as u32;
                Some(*end)
            }))
            .collect();
        let count = points.len();
        Self { points: points.concat(), offsets, closed: vec![closed; count], basis: vec![basis; count], radii: None }
    }

    /// Number of curves.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no curve.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The points of a curve.
    pub fn range(&self, curve: usize) -> Range<usize> {
        self.offsets[curve] as usize..self.offsets[curve + 1] as usize
    }

    /// One curve of a valid set.
    ///
    /// # Panics
    /// When the set has not passed [`validate`](Self::validate).
    pub fn curve(&self, curve: usize) -> Curve<'_> {
        self.curve_through(curve, &self.points)
    }

    /// The same curve through other points of the whole set.
    pub(crate) fn curve_through<'a>(&'a self, curve: usize, points: &'a [[f32; 3]]) -> Curve<'a> {
        Curve::new(&points[self.range(curve)], self.closed[curve], &self.basis[curve])
    }

    /// The curve that owns a point, and the point's index in it.
    pub(crate) fn locate(&self, point: usize) -> (usize, usize) {
        let curve = self.offsets.partition_point(|&o| o as usize <= point) - 1;
        (curve, point - self.offsets[curve] as usize)
    }

    /// Checks everything that evaluation relies on.
    ///
    /// # Errors
    /// The first fault found, by curve and index: see [`Error`].
    pub fn validate(&self) -> Result<(), Error> {
        self.validate_layout()?;
        self.validate_points(&self.points)?;
        if let Some(radii) = &self.radii {
            self.validate_radii(radii)?;
        }
        for curve in 0..self.len() {
            self.validate_curve(curve)?;
        }
        Ok(())
    }

    fn validate_layout(&self) -> Result<(), Error> {
        let count = self.points.len();
        if count > u32::MAX as usize {
            return Err(Error::TooManyPoints { count, max: u32::MAX as usize });
        }
        if self.is_empty() {
            return Err(Error::NoCurves);
        }
        for (index, &value) in self.offsets.iter().enumerate() {
            let fault = if index == 0 && value != 0 {
                Some("the first must be 0".to_owned())
            } else if index > 0 && value < self.offsets[index - 1] {
                Some(format!("it must not be less than the {} before it", self.offsets[index - 1]))
            } else if index == self.len() && value as usize != count {
                Some(format!("the last must be the number of points, {count}"))
            } else {
                None
            };
            if let Some(reason) = fault {
                return Err(Error::Offsets { index, value, reason });
            }
        }
        check_length("closed", self.len(), self.closed.len())?;
        check_length("basis", self.len(), self.basis.len())?;
        if let Some(radii) = &self.radii {
            check_length("radii", count, radii.len())?;
        }
        Ok(())
    }

    /// Refuses coordinates that are not finite or too large.
    pub(crate) fn validate_points(&self, points: &[[f32; 3]]) -> Result<(), Error> {
        let valid = |x: f32| x.abs() <= MAX_COORDINATE;
        match points.par_iter().position_first(|p| !p.iter().all(|&x| valid(x))) {
            None => Ok(()),
            Some(point) => {
                let (curve, index) = self.locate(point);
                Err(Error::Point { curve, index, value: points[point] })
            }
        }
    }

    fn validate_radii(&self, radii: &[f32]) -> Result<(), Error> {
        if let Some(point) = radii.par_iter().position_first(|r| !(0.0..=MAX_COORDINATE).contains(r)) {
            let (curve, index) = self.locate(point);
            return Err(Error::Radius {
                curve,
                index,
                value: radii[point],
                reason: "it must be finite and not negative",
            });
        }
        let zero =
            |curve: &usize| radii[self.range(*curve)].iter().all(|&r| r == 0.0) && !self.range(*curve).is_empty();
        match (0..self.len()).into_par_iter().find_first(zero) {
            Some(curve) => {
                Err(Error::Radius { curve, index: 0, value: 0.0, reason: "all radii of the curve are zero" })
            }
            None => Ok(()),
        }
    }

    fn validate_curve(&self, curve: usize) -> Result<(), Error> {
        let (basis, closed) = (&self.basis[curve], self.closed[curve]);
        let points = &self.points[self.range(curve)];
        let n = points.len();
        let (enough, needed) = match basis {
            Basis::CatmullRom | Basis::Linear if !closed => (n >= 2, "at least 2".to_owned()),
            Basis::BSpline if !closed => (n >= 4, "at least 4".to_owned()),
            Basis::CatmullRom | Basis::Linear | Basis::BSpline => (n >= 3, "at least 3".to_owned()),
            Basis::Bezier if closed => (n >= 3 && n.is_multiple_of(3), "3, 6, 9, … points".to_owned()),
            Basis::Bezier => (n >= 4 && n % 3 == 1, "4, 7, 10, … points".to_owned()),
            Basis::Nurbs(nurbs) => {
                let least = nurbs.order.max(if closed { 3 } else { 2 });
                (n >= least, format!("at least {least} for its order, {}", nurbs.order))
            }
        };
        if !enough {
            let kind = format!("{} {}", if closed { "a closed" } else { "an open" }, basis.name());
            return Err(Error::PointCount { curve, points: n, kind, needed });
        }
        if let Basis::Nurbs(nurbs) = basis {
            validate_nurbs(nurbs, n, closed).map_err(|reason| Error::Nurbs { curve, reason })?;
        }
        if points.iter().all(|p| p == &points[0]) {
            return Err(Error::Coincident { curve, points: n });
        }
        Ok(())
    }
}

fn check_length(array: &'static str, expected: usize, found: usize) -> Result<(), Error> {
    if expected == found { Ok(()) } else { Err(Error::ArrayLength { array, expected, found }) }
}

fn validate_nurbs(nurbs: &Nurbs, points: usize, closed: bool) -> Result<(), String> {
    let order = nurbs.order;
    if !(2..=MAX_ORDER).contains(&order) {
        return Err(format!("order {order} is not in 2 to {MAX_ORDER}"));
    }
    if let Some(weights) = &nurbs.weights {
        if weights.len() != points {
            return Err(format!("has {} weights for {points} points", weights.len()));
        }
        if let Some(i) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
            return Err(format!("weight {i} is {}: it must be finite and positive", weights[i]));
        }
    }
    let bezier = matches!(nurbs.knots, KnotMode::Bezier | KnotMode::EndpointBezier);
    if bezier && closed && !points.is_multiple_of(order - 1) {
        return Err(format!(
            "of order {order} is closed with Bézier knots: {points} points are not a multiple of {}",
            order - 1
        ));
    }
    if let KnotMode::Explicit(knots) = &nurbs.knots {
        let expected = nurbs.knot_count(points, closed);
        if knots.len() != expected {
            return Err(format!("has {} knots, expected {expected}", knots.len()));
        }
        if let Some(i) = knots.iter().position(|k| !k.is_finite()) {
            return Err(format!("knot {i} is {}: it must be finite", knots[i]));
        }
        if let Some(i) = (1..knots.len()).find(|&i| knots[i] < knots[i - 1]) {
            return Err(format!("knot {i} is {}, less than the {} before it", knots[i], knots[i - 1]));
        }
    }
    let knots = nurbs.knot_vector(points, closed);
    let (start, end) = (knots[order - 1], knots[knots.len() - order]);
    if end > start && (knots[knots.len() - 1] - knots[0]).is_finite() {
        Ok(())
    } else {
        Err(format!("its knots leave no domain, {start} to {end}"))
    }
}
