//! Which triangle of a UV map covers a place.

use crate::Error;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// A place counts as inside of a triangle up to this much outside, in barycentric weights: neighbours leave no gap.
const MARGIN: f64 = 1e-6;
/// A place this deep inside of two triangles is on an overlap.
const OVERLAP: f64 = 1e-3;

/// A rectangle of bins: its first and last columns and rows.
#[derive(Clone, Copy)]
struct Bins {
    left: usize,
    right: usize,
    bottom: usize,
    top: usize,
}

impl Bins {
    fn count(self) -> usize {
        (self.right - self.left + 1) * (self.top - self.bottom + 1)
    }

    /// Of a grid with so many in a row.
    fn numbers(self, row_length: usize) -> impl Iterator<Item = usize> {
        (self.bottom..=self.top).flat_map(move |row| (self.left..=self.right).map(move |i| row * row_length + i))
    }
}

/// Triangles in the plane, sorted into bins.
pub(crate) struct UvGrid<'a> {
    triangles: &'a [[DVec2; 3]],
    low: DVec2,
    bin: DVec2,
    size: [usize; 2],
    /// Triangles of bin `i`: `members[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// Entries of all bins, as a multiple of the triangles: where these lie on each other or reach far, bins get larger instead.
const MOST_ENTRIES: usize = 16;

impl<'a> UvGrid<'a> {
    /// About as many bins as triangles, or fewer. `low` and `high` hold all triangles.
    ///
    /// # Errors
    /// [`Error::OverlappingUvs`] if the triangles have more area than there is between `low` and `high`.
    pub fn new(triangles: &'a [[DVec2; 3]], low: DVec2, high: DVec2) -> Result<Self, Error> {
        let side = (triangles.len() as f64).sqrt().clamp(1.0, 4096.0) as usize;
        let mut grid = Self { triangles, low, bin: DVec2::ZERO, size: [0; 2], starts: Vec::new(), members: Vec::new() };
        grid.divide(side, high);
        while grid.size[0] > 1 && grid.entries() > MOST_ENTRIES * triangles.len() {
            grid.divide(grid.size[0] / 2, high);
        }
        grid.fill();
        let area: f64 = triangles.iter().map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a).abs()).sum();
        let extent = high - low;
        if area > (1.0 + OVERLAP) * extent.x * extent.y {
            let overlap = triangles.par_iter().find_map_first(|[a, b, c]| grid.find((a + b + c) / 3.0).err());
            overlap.map_or(Ok(()), Err)?;
        }
        Ok(grid)
    }

    fn divide(&mut self, side: usize, high: DVec2) {
        self.size = [side, side];
        self.bin = (high - self.low) / side as f64;
    }

    /// How often triangles are in bins.
    fn entries(&self) -> usize {
        self.triangles.par_iter().map(|triangle| self.bins_of(triangle).map_or(0, Bins::count)).sum()
    }

    /// Sorts the triangles into the bins, after counting those of each.
    fn fill(&mut self) {
        let all = || self.triangles.iter().enumerate().filter_map(|(i, triangle)| Some((i, self.bins_of(triangle)?)));
        let row = self.size[0];
        let mut starts = vec![0; row * row + 1];
        all().flat_map(|(_, bins)| bins.numbers(row)).for_each(|bin| starts[bin + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut members = vec![0; starts[row * row] as usize];
        for (triangle, bins) in all() {
            for bin in bins.numbers(row) {
                members[next[bin] as usize] = triangle as u32;
                next[bin] += 1;
            }
        }
        (self.starts, self.members) = (starts, members);
    }

    fn column_row(&self, place: DVec2) -> [usize; 2] {
        let place = (place - self.low) / self.bin;
        [place.x, place.y].map(|x| x as usize).map(|i| i.min(self.size[0] - 1))
    }

    /// Bins that a triangle's box touches; none for one without area.
    fn bins_of(&self, [a, b, c]: &[DVec2; 3]) -> Option<Bins> {
        if (b - a).perp_dot(c - a) == 0.0 {
            return None;
        }
        let margin = MARGIN * self.bin;
        let [left, bottom] = self.column_row(a.min(*b).min(*c) - margin);
        let [right, top] = self.column_row(a.max(*b).max(*c) + margin);
        Some(Bins { left, right, bottom, top })
    }

    /// The triangle that covers a place, the first of several along an edge, and the weights of its corners.
    ///
    /// # Errors
    /// [`Error::OverlappingUvs`] where two triangles do.
    pub fn find(&self, place: DVec2) -> Result<Option<(usize, DVec3)>, Error> {
        let [column, row] = self.column_row(place);
        let bin = row * self.size[0] + column;
        let mut found: Option<(usize, DVec3)> = None;
        for &triangle in &self.members[self.starts[bin] as usize..self.starts[bin + 1] as usize] {
            let weights = weights(&self.triangles[triangle as usize], place);
            let depth = weights.min_element();
            if depth < -MARGIN {
                continue;
            }
            match found {
                Some((first, others)) if depth > OVERLAP && others.min_element() > OVERLAP => {
                    let triangles = [first, triangle as usize];
                    return Err(Error::OverlappingUvs { triangles, uv: place.to_array() });
                }
                // On a shared edge either will do.
                Some(_) => {}
                None => found = Some((triangle as usize, weights.max(DVec3::ZERO))),
            }
        }
        Ok(found.map(|(triangle, weights)| (triangle, weights / weights.element_sum())))
    }
}

fn weights([a, b, c]: &[DVec2; 3], place: DVec2) -> DVec3 {
    let area = (b - a).perp_dot(c - a);
    let second = (place - a).perp_dot(c - a) / area;
    let third = (b - a).perp_dot(place - a) / area;
    DVec3::new(1.0 - second - third, second, third)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_that_all_take_the_whole_square_are_refused() {
        // As a new UV map has them.
        let (low, high) = (DVec2::ZERO, DVec2::ONE);
        let square = [[low, DVec2::X, high], [low, high, DVec2::Y]];
        let alone = UvGrid::new(&square, low, high).expect("no overlap");
        assert_eq!(alone.find(DVec2::new(0.3, 0.1)).expect("no overlap").map(|(triangle, _)| triangle), Some(0));
        let all: Vec<_> = square.into_iter().cycle().take(50_000).collect();
        let error = UvGrid::new(&all, low, high).err().expect("an overlap");
        assert!(matches!(error, Error::OverlappingUvs { triangles: [0, 2], .. }), "{error}");
    }

    #[test]
    fn triangles_that_reach_far_take_little_memory() {
        // Slivers beside each other, all along the diagonal.
        let n = 20_000;
        let across = DVec2::new(1.0, -1.0) / f64::from(n);
        let triangles: Vec<_> = (0..n)
            .map(|i| [DVec2::splat(0.5) * f64::from(i % 2), DVec2::ONE, DVec2::ZERO].map(|p| p + across * f64::from(i)))
            .map(|[a, b, c]| [a + across, b, c])
            .collect();
        let corners = triangles.iter().flatten();
        let (low, high) = corners.fold((DVec2::MAX, DVec2::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
        let grid = UvGrid::new(&triangles, low, high).expect("no overlap");
        assert!(grid.members.len() <= MOST_ENTRIES * triangles.len(), "{}", grid.members.len());
        for i in [0, 777, n - 1] {
            let [a, b, c] = triangles[i as usize];
            let found = grid.find((a + b + c) / 3.0).expect("no overlap");
            assert_eq!(found.map(|(triangle, _)| triangle), Some(i as usize));
        }
    }
}
