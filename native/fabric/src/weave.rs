//! Weave patterns: at which crossings the warp lies in front of the weft.

use crate::Error;

/// The repeat of a weave as seen from the front, repeated over the cloth: warp yarns are its columns and run upwards,
/// weft yarns are its rows.
///
/// Row 0 lies at the bottom; column 0 is at the left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Weave {
    rows: usize,
    columns: usize,
    warp_in_front: Vec<bool>,
}

impl Weave {
    /// Over one, under one: the densest interlacing.
    #[must_use]
    pub fn plain() -> Self {
        Self { rows: 2, columns: 2, warp_in_front: vec![true, false, false, true] }
    }

    /// Each warp yarn passes in front of `over` weft yarns and behind `under`, its neighbour to the right one row
    /// higher: diagonal ribs.
    ///
    /// # Errors
    /// [`Error::EmptyPattern`] if both counts are zero, [`Error::LooseYarn`] if one is.
    pub fn twill(over: usize, under: usize) -> Result<Self, Error> {
        let repeat = over + under;
        Self::from_crossings(repeat, repeat, |row, column| (row + repeat - column) % repeat < over)
    }

    /// Each warp yarn passes behind a single weft yarn of `ends`, and no two neighbours do so next to each other: a
    /// face of warp floats. The step from row to row is the smallest that has no divisor in common with `ends`.
    ///
    /// # Errors
    /// [`Error::Satin`] where there is no such step: for less than 5 yarns and for 6.
    pub fn satin(ends: usize) -> Result<Self, Error> {
        let divides_both = |step: usize, divisor: usize| step.is_multiple_of(divisor) && ends.is_multiple_of(divisor);
        let step = (2..ends.saturating_sub(1)).find(|&step| !(2..=step).any(|divisor| divides_both(step, divisor)));
        let step = step.ok_or(Error::Satin { ends })?;
        Self::from_crossings(ends, ends, |row, column| step * row % ends != column)
    }

    /// A weave from text, the top row first; `x` or `X` has the warp in front, `o` or `O` the weft.
    ///
    /// # Errors
    /// [`Error::EmptyPattern`], [`Error::RaggedPattern`], [`Error::UnknownCrossing`] or [`Error::LooseYarn`].
    pub fn from_chart(chart: &str) -> Result<Self, Error> {
        let lines: Vec<Vec<char>> = chart.split_whitespace().rev().map(|line| line.chars().collect()).collect();
        let columns = lines.first().map_or(0, Vec::len);
        for (row, line) in lines.iter().enumerate() {
            if line.len() != columns {
                return Err(Error::RaggedPattern { row, found: line.len(), expected: columns });
            }
            if let Some(column) = line.iter().position(|symbol| !"xXoO".contains(*symbol)) {
                return Err(Error::UnknownCrossing { row, column, symbol: line[column] });
            }
        }
        Self::from_crossings(lines.len(), columns, |row, column| "xX".contains(lines[row][column]))
    }

    fn from_crossings(
        rows: usize,
        columns: usize,
        warp_in_front: impl Fn(usize, usize) -> bool,
    ) -> Result<Self, Error> {
        if rows * columns == 0 {
            return Err(Error::EmptyPattern);
        }
        let crossings = (0..rows * columns).map(|i| warp_in_front(i / columns, i % columns)).collect();
        let weave = Self { rows, columns, warp_in_front: crossings };
        let in_front_in = |column: usize| (0..rows).filter(|&row| weave.at(row, column)).count();
        if let Some(index) = (0..columns).find(|&column| in_front_in(column).is_multiple_of(rows)) {
            return Err(Error::LooseYarn { family: "warp", index });
        }
        let in_front_of = |row: usize| (0..columns).filter(|&column| weave.at(row, column)).count();
        if let Some(index) = (0..rows).find(|&row| in_front_of(row).is_multiple_of(columns)) {
            return Err(Error::LooseYarn { family: "weft", index });
        }
        Ok(weave)
    }

    fn at(&self, row: usize, column: usize) -> bool {
        self.warp_in_front[row * self.columns + column]
    }

    /// Weft yarns in the repeat.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Warp yarns in the repeat.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Which yarns the front shows: 1 for those of the warp, −1 for those of the weft, 0 for both alike. Three of four
    /// crossings count as all.
    #[must_use]
    pub fn balance(&self) -> f64 {
        let warp = self.warp_in_front.iter().filter(|&&in_front| in_front).count() as f64;
        (4.0 * warp / self.warp_in_front.len() as f64 - 2.0).clamp(-1.0, 1.0)
    }

    /// Whether the warp lies in front where any two yarns of the endless cloth cross.
    #[must_use]
    pub fn warp_is_in_front(&self, weft: usize, warp: usize) -> bool {
        self.at(weft % self.rows, warp % self.columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_weaves_match_their_charts() {
        assert_eq!(Weave::from_chart("ox xo"), Ok(Weave::plain()));
        assert_eq!(Weave::twill(1, 1), Ok(Weave::plain()));
        assert_eq!(Weave::from_chart("oxx xxo xox"), Weave::twill(2, 1));
        assert_eq!(Weave::from_chart("xxoox xooxx ooxxx oxxxo xxxoo").map(|weave| weave.rows()), Ok(5));
        assert_eq!(Weave::from_chart("xxxox xoxxx xxxxo xxoxx oxxxx"), Weave::satin(5));
    }

    #[test]
    fn satins_have_one_crossing_a_yarn_and_no_neighbours() {
        for ends in [5, 7, 8, 9, 10, 12] {
            let weave = Weave::satin(ends).expect("a regular satin");
            let behind = |row: usize, column: usize| !weave.warp_is_in_front(row, column);
            for k in 0..ends {
                assert_eq!((0..ends).filter(|&column| behind(k, column)).count(), 1, "satin {ends}, row {k}");
                let row = (0..ends).find(|&row| behind(row, k)).expect("a crossing");
                for [up, right] in [[0, 1], [1, 1], [ends - 1, 1], [1, 0]] {
                    assert!(!behind(row + up, k + right), "satin {ends}: crossings of ({row}, {k}) touch");
                }
            }
        }
        for ends in [0, 1, 2, 3, 4, 6] {
            assert_eq!(Weave::satin(ends), Err(Error::Satin { ends }));
        }
    }

    #[test]
    fn satins_show_their_warp() {
        assert_eq!(Weave::plain().balance(), 0.0);
        assert_eq!(Weave::twill(2, 2).map(|weave| weave.balance()), Ok(0.0));
        assert_eq!(Weave::satin(5).map(|weave| weave.balance()), Ok(1.0));
        assert_eq!(Weave::twill(1, 3).map(|weave| weave.balance()), Ok(-1.0));
    }

    #[test]
    fn weaves_that_fall_apart_are_refused_with_their_place() {
        assert_eq!(Weave::from_chart(""), Err(Error::EmptyPattern));
        assert_eq!(Weave::twill(0, 0), Err(Error::EmptyPattern));
        assert_eq!(Weave::twill(3, 0), Err(Error::LooseYarn { family: "warp", index: 0 }));
        assert_eq!(Weave::from_chart("xxo oxo"), Err(Error::LooseYarn { family: "warp", index: 1 }));
        assert_eq!(Weave::from_chart("oxo xox xxx"), Err(Error::LooseYarn { family: "weft", index: 0 }));
        assert_eq!(Weave::from_chart("xo x"), Err(Error::RaggedPattern { row: 1, found: 2, expected: 1 }));
        assert_eq!(Weave::from_chart("xo xk"), Err(Error::UnknownCrossing { row: 0, column: 1, symbol: 'k' }));
    }
}
