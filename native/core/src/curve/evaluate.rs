//! Evaluation of one curve.

use super::arc_length::arc_length;
use super::basis::{B_SPLINE, BEZIER, CATMULL_ROM, CubicBasis, LINEAR};
use super::nurbs::{MAX_ORDER, Weights, basis_functions, rationalise};
use super::{Basis, Nurbs, to_f64};
use glam::DVec3;

/// Position and derivatives with respect to the parameter `t` in `[0, 1]` of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// Position.
    pub position: DVec3,
    /// First derivative.
    pub first: DVec3,
    /// Second derivative.
    pub second: DVec3,
}

/// One curve of a valid set, ready to be evaluated. A curve is a chain of segments, each with a parameter in `[0, 1]`.
pub struct Curve<'a> {
    points: &'a [[f32; 3]],
    closed: bool,
    form: Form<'a>,
}

enum Form<'a> {
    Cubic(&'static CubicBasis),
    Nurbs {
        nurbs: &'a Nurbs,
        knots: Vec<f64>,
        /// Knot spans with a positive width: the segments.
        spans: Vec<u32>,
    },
}

/// One segment, with what all its evaluations share.
pub(super) enum Segment<'a> {
    Polynomial([DVec3; 4]),
    Rational { curve: &'a Curve<'a>, segment: usize },
}

impl<'a> Curve<'a> {
    /// The curve through `points`, which [`Curves::validate`](super::Curves::validate) has accepted.
    pub(super) fn new(points: &'a [[f32; 3]], closed: bool, basis: &'a Basis) -> Self {
        let form = match basis {
            Basis::CatmullRom => Form::Cubic(&CATMULL_ROM),
            Basis::BSpline => Form::Cubic(&B_SPLINE),
            Basis::Bezier => Form::Cubic(&BEZIER),
            Basis::Linear => Form::Cubic(&LINEAR),
            Basis::Nurbs(nurbs) => {
                let knots = nurbs.knot_vector(points.len(), closed);
                let spans = (nurbs.order - 1..knots.len() - nurbs.order)
                    .filter(|&i| knots[i + 1] > knots[i])
                    .map(|i| i as u32)
                    .collect();
                Form::Nurbs { nurbs, knots, spans }
            }
        };
        Self { points, closed, form }
    }

    /// Whether the curve returns to its start.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Number of segments, at least 1.
    pub fn segment_count(&self) -> usize {
        let n = self.points.len();
        match &self.form {
            Form::Cubic(basis) if self.closed => n / basis.stride,
            Form::Cubic(basis) if basis.stride == 3 => (n - 1) / 3,
            Form::Cubic(basis) if std::ptr::eq(*basis, &B_SPLINE) => n - 3,
            Form::Cubic(_) => n - 1,
            Form::Nurbs { spans, .. } => spans.len(),
        }
    }

    /// Pieces per segment that are about as many as its control points.
    pub(crate) fn initial_pieces(&self) -> usize {
        match &self.form {
            Form::Cubic(basis) => basis.stride,
            Form::Nurbs { spans, .. } => self.points.len().div_ceil(spans.len()),
        }
    }

    /// Position, first and second derivative at `t` in `[0, 1]` of a segment.
    pub fn jet(&self, segment: usize, t: f64) -> Jet {
        self.segment(segment).jet(t)
    }

    /// Position at `t` in `[0, 1]` of a segment.
    pub fn position(&self, segment: usize, t: f64) -> DVec3 {
        self.jet(segment, t).position
    }

    /// A value per control point, such as a radius, blended like the positions.
    pub fn blend(&self, segment: usize, t: f64, values: &[f32]) -> f64 {
        match &self.form {
            Form::Cubic(basis) => {
                let v = self.support(basis, segment, |i| f64::from(values[i]));
                let [a, b, c, d] = basis.coefficients.map(|row| (0..4).map(|i| row[i] * v[i]).sum::<f64>());
                a + t * (b + t * (c + t * d))
            }
            Form::Nurbs { nurbs, .. } => {
                let (w, first, _) = self.rational(segment, t);
                (0..nurbs.order).map(|j| w.value[j] * f64::from(values[(first + j) % self.points.len()])).sum()
            }
        }
    }

    /// Arc length between two parameters of one segment, to a relative error of 1e-6.
    pub fn length(&self, segment: usize, t0: f64, t1: f64) -> f64 {
        arc_length(&self.segment(segment), t0, t1)
    }

    /// Segment and parameter that belong to a control point: where it lies (Catmull-Rom, linear, Bézier anchors),
    /// else its mean knot (Greville abscissa), clamped to the curve.
    pub fn control_parameter(&self, point: usize) -> (usize, f64) {
        let segments = self.segment_count();
        let at = |segment: usize, t: f64| if segment < segments { (segment, t) } else { (segments - 1, 1.0) };
        match &self.form {
            Form::Cubic(basis) if basis.stride == 3 => at(point / 3, (point % 3) as f64 / 3.0),
            Form::Cubic(basis) if std::ptr::eq(*basis, &B_SPLINE) && !self.closed => at(point.saturating_sub(1), 0.0),
            Form::Cubic(_) => at(point, 0.0),
            Form::Nurbs { nurbs, knots, spans } => {
                let degree = nurbs.order - 1;
                let u = knots[point + 1..=point + degree].iter().sum::<f64>() / degree as f64;
                let segment = spans.partition_point(|&s| knots[s as usize + 1] <= u);
                if segment == segments {
                    return (segments - 1, 1.0);
                }
                let span = spans[segment] as usize;
                (segment, ((u - knots[span]) / (knots[span + 1] - knots[span])).max(0.0))
            }
        }
    }

    pub(super) fn segment(&'a self, segment: usize) -> Segment<'a> {
        match &self.form {
            Form::Cubic(basis) => {
                let p = self.support(basis, segment, |i| to_f64(self.points[i]));
                Segment::Polynomial(
                    basis.coefficients.map(|row| p[0] * row[0] + p[1] * row[1] + p[2] * row[2] + p[3] * row[3]),
                )
            }
            Form::Nurbs { .. } => Segment::Rational { curve: self, segment },
        }
    }

    /// Values of the four control points of a segment of a uniform basis. Beyond the ends of an open curve they are
    /// reflected, `2 v0 - v1`; the bases that never look there give them no weight.
    fn support<T>(&self, basis: &CubicBasis, segment: usize, value: impl Fn(usize) -> T) -> [T; 4]
    where
        T: Copy + std::ops::Sub<Output = T> + std::ops::Add<Output = T>,
    {
        let n = self.points.len();
        let first = (segment * basis.stride) as isize + basis.first(self.closed);
        std::array::from_fn(|k| {
            let i = first + k as isize;
            if self.closed {
                value(i.rem_euclid(n as isize) as usize)
            } else if i < 0 {
                value(0) + (value(0) - value(1))
            } else if i as usize >= n {
                value(n - 1) + (value(n - 1) - value(n - 2))
            } else {
                value(i as usize)
            }
        })
    }

    /// Rational basis functions, first control point, and the width of the knot span.
    fn rational(&self, segment: usize, t: f64) -> (Weights, usize, f64) {
        let Form::Nurbs { nurbs, knots, spans } = &self.form else {
            unreachable!("only NURBS segments are rational");
        };
        let span = spans[segment] as usize;
        let width = knots[span + 1] - knots[span];
        let first = span + 1 - nurbs.order;
        let mut w = basis_functions(knots, span, nurbs.order, knots[span] + t * width);
        if let Some(weights) = &nurbs.weights {
            let mut local = [0.0; MAX_ORDER];
            for (j, slot) in local[..nurbs.order].iter_mut().enumerate() {
                *slot = f64::from(weights[(first + j) % self.points.len()]);
            }
            rationalise(&mut w, &local[..nurbs.order]);
        }
        (w, first, width)
    }

    fn rational_jet(&self, segment: usize, t: f64) -> Jet {
        let Form::Nurbs { nurbs, .. } = &self.form else {
            unreachable!("only NURBS segments are rational");
        };
        let (w, first, width) = self.rational(segment, t);
        let mut jet = Jet { position: DVec3::ZERO, first: DVec3::ZERO, second: DVec3::ZERO };
        for j in 0..nurbs.order {
            let p = to_f64(self.points[(first + j) % self.points.len()]);
            jet.position += p * w.value[j];
            jet.first += p * (w.first[j] * width);
            jet.second += p * (w.second[j] * width * width);
        }
        jet
    }
}

impl Segment<'_> {
    pub(super) fn jet(&self, t: f64) -> Jet {
        match self {
            Segment::Polynomial([a, b, c, d]) => Jet {
                position: a + t * (b + t * (c + t * d)),
                first: b + t * (2.0 * c + t * (3.0 * d)),
                second: 2.0 * c + t * (6.0 * d),
            },
            Segment::Rational { curve, segment } => curve.rational_jet(*segment, t),
        }
    }

    /// Length of the first derivative.
    pub(super) fn speed(&self, t: f64) -> f64 {
        match self {
            Segment::Polynomial([_, b, c, d]) => (b + t * (2.0 * c + t * (3.0 * d))).length(),
            Segment::Rational { curve, segment } => curve.rational_jet(*segment, t).first.length(),
        }
    }
}
