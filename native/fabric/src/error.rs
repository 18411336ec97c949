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
}
