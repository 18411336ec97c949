//! Which triangle of a UV map covers a place.

use crate::Error;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// A place counts as inside of a triangle up to this much outside, in barycentric weights: neighbours leave no gap.
const MARGIN: f64 = 1e-6;
/// A place this deep inside of two triangles is on an overlap.
const OVERLAP: f64 = 1e-3;

/// Triangles in the plane, sorted into square bins.
pub(crate) struct UvGrid<'a> {
    triangles: &'a [[DVec2; 3]],
    low: DVec2,
    bin: DVec2,
    size: [usize; 2],
    /// Triangles of bin `i`: `members[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl<'a> UvGrid<'a> {
    /// About as many bins as triangles. `low` and `high` hold all triangles.
    pub fn new(triangles: &'a [[DVec2; 3]], low: DVec2, high: DVec2) -> Self {
        let side = (triangles.len() as f64).sqrt().clamp(1.0, 4096.0) as usize;
        let size = [side, side];
        let bin = (high - low) / side as f64;
        let mut grid = Self { triangles, low, bin, size, starts: vec![0; side * side + 1], members: Vec::new() };
        let bins: Vec<Vec<usize>> = triangles.par_iter().map(|triangle| grid.bins_of(triangle)).collect();
        for bin in bins.iter().flatten() {
            grid.starts[bin + 1] += 1;
        }
        for i in 1..grid.starts.len() {
            grid.starts[i] += grid.starts[i - 1];
        }
        let mut next = grid.starts.clone();
        grid.members = vec![0; *grid.starts.last().unwrap_or(&0) as usize];
        for (triangle, bins) in bins.iter().enumerate() {
            for &bin in bins {
                grid.members[next[bin] as usize] = triangle as u32;
                next[bin] += 1;
            }
        }
        grid
    }

    fn column_row(&self, place: DVec2) -> [usize; 2] {
        let place = (place - self.low) / self.bin;
        [place.x, place.y].map(|x| x as usize).map(|i| i.min(self.size[0] - 1))
    }

    /// Bins that a triangle's box touches; none for one without area.
    fn bins_of(&self, [a, b, c]: &[DVec2; 3]) -> Vec<usize> {
        if (b - a).perp_dot(c - a) == 0.0 {
            return Vec::new();
        }
        let margin = MARGIN * self.bin;
        let [left, bottom] = self.column_row(a.min(*b).min(*c) - margin);
        let [right, top] = self.column_row(a.max(*b).max(*c) + margin);
        (bottom..=top).flat_map(|row| (left..=right).map(move |column| row * self.size[0] + column)).collect()
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
