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
    #[error("yarn {yarn}, point {index}: the surface has no finite position or no normal at u = {u}, v = {v}")]
    Surface {
        /// Curve of the cloth: the course of knitted cloth.
        yarn: usize,
        /// Control point within the curve.
        index: usize,
        /// Where on the surface.
        u: f64,
        /// Where on the surface.
        v: f64,
    },
    /// A chart of a weave is written with `x` and `o`.
    #[error(
        "weave row {row} (from the bottom), column {column}: '{symbol}' is neither 'x' (warp in front) nor 'o' (weft in front)"
    )]
    UnknownCrossing {
        /// Row, counted from the bottom.
        row: usize,
        /// Column, counted from the left.
        column: usize,
        /// The symbol found.
        symbol: char,
    },
    /// A yarn that stays on one side of all others falls off the cloth.
    #[error("{family} yarn {index} of the weave stays on one side of all yarns that it crosses: nothing holds it")]
    LooseYarn {
        /// "warp" or "weft".
        family: &'static str,
        /// Column of a warp yarn, counted from the left; row of a weft yarn, from the bottom.
        index: usize,
    },
    /// The crossings of a satin are spread by steps that meet every yarn and no neighbour.
    #[error("there is no regular satin of {ends} yarns: take 5, or 7 or more")]
    Satin {
        /// Yarns of the repeat.
        ends: usize,
    },
    /// Woven cloth needs yarns both ways.
    #[error(
        "{warp} warp and {weft} weft yarns: woven cloth needs at least one of each, and 2^32 - 1 control points at most"
    )]
    WovenSize {
        /// Warp yarns asked for.
        warp: usize,
        /// Weft yarns asked for.
        weft: usize,
    },
    /// Yarns that pass between each other need room.
    #[error("spacing {value}: it must be finite and at least 1, where the yarns jam")]
    Spacing {
        /// The spacing given.
        value: f64,
    },
    /// A mesh must be drawable.
    #[error("the mesh cannot be knitted on: {reason}")]
    Mesh {
        /// What is wrong.
        reason: String,
    },
    /// Each place of the UV map belongs to one place on the mesh.
    #[error(
        "the UV map overlaps: triangles {} and {} both cover (u, v) = ({:.4}, {:.4})", triangles[0], triangles[1], uv[0], uv[1]
    )]
    OverlappingUvs {
        /// Two of the triangles, ascending.
        triangles: [usize; 2],
        /// A place on both.
        uv: [f64; 2],
    },
    /// No run of the UV map holds a stitch.
    #[error(
        "no stitch fits on the mesh: it measures {width_m:.4} m × {height_m:.4} m along u and v, a stitch {wale_m:.4} m × {course_m:.4} m"
    )]
    NoStitches {
        /// Mean extent of the mesh along u.
        width_m: f64,
        /// Mean extent of the mesh along v.
        height_m: f64,
        /// Width of a stitch.
        wale_m: f64,
        /// Height of a stitch.
        course_m: f64,
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
