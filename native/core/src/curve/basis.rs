//! The bases a curve can have, and the cubic ones as matrices.

use super::Nurbs;

/// How control points make a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Basis {
    /// Uniform Catmull-Rom: passes through all its points. The ends of an open curve are extrapolated by reflection,
    /// `2 p0 - p1` (USD's "pinned"). At least 2 points open, 3 closed.
    CatmullRom,
    /// Uniform cubic B-spline (USD's "nonperiodic": an open curve does not reach its end points). At least 4 points
    /// open, 3 closed.
    BSpline,
    /// Cubic Bézier spline as a control polygon anchor, handle, handle, anchor, …: 3k + 1 points open, 3k closed.
    Bezier,
    /// Straight segments. At least 2 points open, 3 closed.
    Linear,
    /// Non-uniform rational B-spline of any order up to [`MAX_ORDER`](super::MAX_ORDER); at least `order` points.
    Nurbs(Box<Nurbs>),
}

/// One segment of a uniform basis: the polynomial coefficients of its four control points.
pub(super) struct CubicBasis {
    /// `coefficients[power][point]`.
    pub coefficients: [[f64; 4]; 4],
    /// Control points from one segment's first to the next segment's first.
    pub stride: usize,
    /// The first control point of segment 0, -1 or 0; open and closed.
    pub first: [isize; 2],
}

impl CubicBasis {
    pub fn first(&self, closed: bool) -> isize {
        self.first[usize::from(closed)]
    }
}

pub(super) static CATMULL_ROM: CubicBasis = CubicBasis {
    coefficients: [[0.0, 1.0, 0.0, 0.0], [-0.5, 0.0, 0.5, 0.0], [1.0, -2.5, 2.0, -0.5], [-0.5, 1.5, -1.5, 0.5]],
    stride: 1,
    first: [-1, -1],
};

/// A closed B-spline starts where its first control point has the most weight, so that lengths start there as well.
pub(super) static B_SPLINE: CubicBasis = CubicBasis {
    coefficients: [
        [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
        [-0.5, 0.0, 0.5, 0.0],
        [0.5, -1.0, 0.5, 0.0],
        [-1.0 / 6.0, 0.5, -0.5, 1.0 / 6.0],
    ],
    stride: 1,
    first: [0, -1],
};

pub(super) static BEZIER: CubicBasis = CubicBasis {
    coefficients: [[1.0, 0.0, 0.0, 0.0], [-3.0, 3.0, 0.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]],
    stride: 3,
    first: [0, 0],
};

pub(super) static LINEAR: CubicBasis = CubicBasis {
    coefficients: [[1.0, 0.0, 0.0, 0.0], [-1.0, 1.0, 0.0, 0.0], [0.0; 4], [0.0; 4]],
    stride: 1,
    first: [0, 0],
};

impl Basis {
    /// A word for messages.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Basis::CatmullRom => "Catmull-Rom",
            Basis::BSpline => "B-spline",
            Basis::Bezier => "Bézier",
            Basis::Linear => "linear",
            Basis::Nurbs(_) => "NURBS",
        }
    }
}
