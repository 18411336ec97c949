//! Stitch patterns: which loops are pulled through to the front and which to the back.

use crate::Error;

/// How a loop is pulled through the loop below it, seen from the front of the cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stitch {
    /// From the back to the front: the legs show as a "V".
    Knit,
    /// From the front to the back: the head and the sinker arcs show as a ridge.
    Purl,
}

impl Stitch {
    /// +1 for knit, −1 for purl: the sign of the height of the legs where they cross the head of the loop below.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Knit => 1.0,
            Self::Purl => -1.0,
        }
    }
}

/// The repeat of a knitted pattern: a grid of stitches as seen from the front, repeated over the cloth.
///
/// Row 0 is knitted first and lies at the bottom; column 0 is at the left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    rows: usize,
    columns: usize,
    stitches: Vec<Stitch>,
}

impl Pattern {
    /// Smooth cloth: knit stitches only.
    #[must_use]
    pub fn stockinette() -> Self {
        Self { rows: 1, columns: 1, stitches: vec![Stitch::Knit] }
    }

    /// Courses of knit and of purl stitches in turn: ridges across, on both sides.
    #[must_use]
    pub fn garter() -> Self {
        Self { rows: 2, columns: 1, stitches: vec![Stitch::Knit, Stitch::Purl] }
    }

    /// Wales of `knit` knit and `purl` purl stitches in turn: ribs along the cloth.
    ///
    /// # Errors
    /// [`Error::EmptyPattern`] if both counts are zero.
    pub fn rib(knit: usize, purl: usize) -> Result<Self, Error> {
        let mut stitches = vec![Stitch::Knit; knit];
        stitches.resize(knit + purl, Stitch::Purl);
        Self::from_stitches(1, knit + purl, stitches)
    }

    /// A pattern from text, the top row first as in a knitting chart; `k` or `K` is knit, `p` or `P` is purl.
    ///
    /// # Errors
    /// [`Error::EmptyPattern`], [`Error::RaggedPattern`] or [`Error::UnknownStitch`].
    pub fn from_chart(chart: &str) -> Result<Self, Error> {
        let lines: Vec<&str> = chart.split_whitespace().rev().collect();
        let columns = lines.first().map_or(0, |line| line.chars().count());
        let mut stitches = Vec::new();
        for (row, line) in lines.iter().enumerate() {
            let found = line.chars().count();
            if found != columns {
                return Err(Error::RaggedPattern { row, found, expected: columns });
            }
            for (column, symbol) in line.chars().enumerate() {
                stitches.push(match symbol {
                    'k' | 'K' => Stitch::Knit,
                    'p' | 'P' => Stitch::Purl,
                    _ => return Err(Error::UnknownStitch { row, column, symbol }),
                });
            }
        }
        Self::from_stitches(lines.len(), columns, stitches)
    }

    fn from_stitches(rows: usize, columns: usize, stitches: Vec<Stitch>) -> Result<Self, Error> {
        if stitches.is_empty() {
            return Err(Error::EmptyPattern);
        }
        Ok(Self { rows, columns, stitches })
    }

    /// Courses in the repeat.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Wales in the repeat.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The stitch of any course and wale of the endless cloth.
    #[must_use]
    pub fn stitch(&self, course: usize, wale: usize) -> Stitch {
        self.stitches[(course % self.rows) * self.columns + wale % self.columns]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charts_are_read_from_the_bottom() {
        let pattern = Pattern::from_chart("kkp\npkk").expect("a valid chart");
        assert_eq!((pattern.rows(), pattern.columns()), (2, 3));
        assert_eq!(pattern.stitch(0, 0), Stitch::Purl);
        assert_eq!(pattern.stitch(1, 0), Stitch::Knit);
        assert_eq!(pattern.stitch(3, 5), Stitch::Purl);
    }

    #[test]
    fn named_patterns_match_their_charts() {
        assert_eq!(Pattern::from_chart("k"), Ok(Pattern::stockinette()));
        assert_eq!(Pattern::from_chart("p k"), Ok(Pattern::garter()));
        assert_eq!(Pattern::from_chart("kkpp"), Pattern::rib(2, 2));
    }

    #[test]
    fn bad_charts_are_refused_with_their_place() {
        assert_eq!(Pattern::from_chart(" \n"), Err(Error::EmptyPattern));
        assert_eq!(Pattern::rib(0, 0), Err(Error::EmptyPattern));
        assert_eq!(Pattern::from_chart("kk\nk"), Err(Error::RaggedPattern { row: 1, found: 2, expected: 1 }));
        assert_eq!(Pattern::from_chart("kx"), Err(Error::UnknownStitch { row: 0, column: 1, symbol: 'x' }));
    }
}
