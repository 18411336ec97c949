//! What can be wrong with a request for knitted cloth.

/// Why a piece of cloth could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A pattern needs at least one stitch.
    #[error("the stitch pattern is empty: it needs at least one stitch")]
    EmptyPattern,
    /// Every row of a pattern has as many stitches as the first.
    #[error("pattern row {row} (from the bottom) has {found} stitches, but row 0 has {expected}")]
    RaggedPattern {
        /// Row, counted from the bottom.
        row: usize,
        /// Stitches in that row.
        found: usize,
        /// Stitches in row 0.
        expected: usize,
    },
    /// Charts are written with `k` and `p`.
    #[error("pattern row {row} (from the bottom), column {column}: '{symbol}' is neither 'k' (knit) nor 'p' (purl)")]
    UnknownStitch {
        /// Row, counted from the bottom.
        row: usize,
        /// Column, counted from the left.
        column: usize,
        /// The symbol found.
        symbol: char,
    },
    /// Cloth needs courses and wales.
    #[error("{courses} courses of {wales} wales: cloth needs at least one of each (three wales in the round)")]
    EmptyCloth {
        /// Courses asked for.
        courses: usize,
        /// Wales asked for.
        wales: usize,
    },
    /// In the round, the last wale meets the first.
    #[error("{wales} wales in the round do not hold a whole number of the pattern's {columns} columns")]
    BrokenRound {
        /// Wales asked for.
        wales: usize,
        /// Columns of the pattern.
        columns: usize,
    },
    /// Points are counted with 32 bits.
    #[error("{courses} courses of {wales} wales have more than 2^32 - 1 control points")]
    TooManyPoints {
        /// Courses asked for.
        courses: usize,
        /// Wales asked for.
        wales: usize,
    },
    /// The yarn must have a thickness.
    #[error("yarn radius {value_m} m: it must be finite and positive")]
    YarnRadius {
        /// The radius given, in metres.
        value_m: f64,
    },
    /// A surface must have a finite position and a normal wherever there is yarn.
    #[error("course {course}, point {index}: the surface has no finite position or no normal at u = {u}, v = {v}")]
    Surface {
        /// Course of the cloth.
        course: usize,
        /// Control point within the course.
        index: usize,
        /// Where on the surface.
        u: f64,
        /// Where on the surface.
        v: f64,
    },
    /// A sleeve needs a usable centre line.
    #[error("centre line, point {index}: {reason}")]
    CentreLine {
        /// The point at fault.
        index: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A garment needs enough points for its smallest pieces.
    #[error("a garment of {points} control points is too coarse: at least {least} are needed")]
    CoarseGarment {
        /// Control points asked for.
        points: usize,
        /// The least possible number.
        least: usize,
    },
}
