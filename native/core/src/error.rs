//! The one error type of this crate.

/// Why yarn curves were refused. Every message names the curve, the index within it and the reason.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A curve set without a single curve.
    #[error("the curve set holds no curves")]
    NoCurves,

    /// Curve offsets that do not partition the points.
    #[error("curve offsets: entry {index} is {value}: {reason}")]
    Offsets {
        /// Entry of the offsets.
        index: usize,
        /// The value found there.
        value: u32,
        /// What was expected of it.
        reason: String,
    },

    /// Two arrays that belong together differ in length.
    #[error("{array} has {found} entries, expected {expected}")]
    ArrayLength {
        /// The array with the wrong length.
        array: &'static str,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },

    /// More points, or more knots after resampling, than 32-bit indices can address.
    #[error("{count} points or knots are too many: at most {max} can be addressed")]
    TooManyPoints {
        /// Points or knots asked for.
        count: usize,
        /// The limit.
        max: usize,
    },

    /// A curve with fewer points than its basis needs.
    #[error("curve {curve} has {points} points; {kind} curve needs {needed}")]
    PointCount {
        /// Index of the curve.
        curve: usize,
        /// Its number of points.
        points: usize,
        /// Its kind, such as "a closed Bézier".
        kind: String,
        /// The counts that are allowed.
        needed: String,
    },

    /// A coordinate that is NaN, infinite, or too large to compute with.
    #[error("curve {curve}, point {index}: coordinates {value:?} are not finite or exceed 1e15")]
    Point {
        /// Index of the curve.
        curve: usize,
        /// Point within the curve.
        index: usize,
        /// The coordinates.
        value: [f32; 3],
    },

    /// A rest curve whose points all coincide has no direction.
    #[error("curve {curve}: all its {points} points coincide, so it has no direction")]
    Coincident {
        /// Index of the curve.
        curve: usize,
        /// Its number of points.
        points: usize,
    },

    /// A radius that cannot be drawn.
    #[error("curve {curve}, point {index}: radius {value}: {reason}")]
    Radius {
        /// Index of the curve.
        curve: usize,
        /// Point within the curve.
        index: usize,
        /// The radius.
        value: f32,
        /// What is wrong with it.
        reason: &'static str,
    },

    /// A yarn radius for the whole set that cannot be drawn.
    #[error("yarn radius {value}: it must be finite and positive")]
    YarnRadius {
        /// The radius that was given.
        value: f32,
    },

    /// A frame with another number of points than the rest shape. Points alone do not tell the curve that lost or gained them: named is the first
    /// point of the rest shape that the frame has none for, or the one after its last.
    #[error("curve {curve}, point {index}: the number of points changed: {new} in this frame, {old} in the rest shape")]
    PointCountChanged {
        /// Curve of the rest shape.
        curve: usize,
        /// Point within the curve.
        index: usize,
        /// Points of the rest shape.
        old: usize,
        /// Points of the refused frame.
        new: usize,
    },

    /// A stored length coordinate that is not finite, decreases along its curve, or never increases.
    #[error("curve {curve}, point {index}: length coordinate {value}: {reason}")]
    LengthCoordinate {
        /// Index of the curve.
        curve: usize,
        /// Point within the curve.
        index: usize,
        /// The coordinate.
        value: f32,
        /// What is wrong with it.
        reason: &'static str,
    },

    /// A NURBS curve with an order, weight or knot vector that defines no curve.
    #[error("curve {curve}: NURBS {reason}")]
    Nurbs {
        /// Index of the curve.
        curve: usize,
        /// What is wrong, with the index and value found.
        reason: String,
    },
}
