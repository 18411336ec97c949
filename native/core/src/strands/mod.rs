//! Yarns as the renderer takes them: Catmull-Rom knots with a frame and a length coordinate at each.
//!
//! [`Yarns`] pairs a rest shape with a current shape. What the twist of a yarn depends on (length coordinate, rest
//! normals, radii) belongs to the rest shape; [`Yarns::with_points`] makes the next frame of an animation. The
//! current normals depend on rest and current shape alone, never on another frame.

mod closest_approach;
mod current_normals;
mod resample;
mod rest_normals;
mod rotation;
mod tangents;
mod yarns;

pub use resample::{MAX_DEPTH, MAX_KNOTS_PER_SEGMENT, TOLERANCE};
pub use yarns::{Strands, Yarns, ZERO_RADIUS};

use std::ops::Range;

/// Which knots are a curve, and whether it is closed.
#[derive(Clone, Copy)]
pub(crate) struct Layout<'a> {
    pub offsets: &'a [u32],
    pub closed: &'a [bool],
}

impl Layout<'_> {
    pub fn len(&self) -> usize {
        self.closed.len()
    }

    pub fn range(&self, curve: usize) -> Range<usize> {
        self.offsets[curve] as usize..self.offsets[curve + 1] as usize
    }

    /// Stretches of at most `longest` knots that together cover all knots in order, none of two curves.
    pub fn stretches(&self, longest: usize) -> Vec<Stretch> {
        let mut stretches = Vec::with_capacity(self.len());
        for curve in 0..self.len() {
            let range = self.range(curve);
            let mut start = range.start;
            while start < range.end {
                let end = range.end.min(start + longest);
                stretches.push(Stretch { curve, start, end });
                start = end;
            }
        }
        stretches
    }
}

/// Consecutive knots `start..end` of one curve.
#[derive(Clone, Copy)]
pub(crate) struct Stretch {
    pub curve: usize,
    pub start: usize,
    pub end: usize,
}

/// Cuts an array over all knots into the parts that the stretches own.
pub(crate) fn split_mut<'a, T>(mut values: &'a mut [T], stretches: &[Stretch]) -> Vec<&'a mut [T]> {
    let mut parts = Vec::with_capacity(stretches.len());
    for stretch in stretches {
        let (part, rest) = values.split_at_mut(stretch.end - stretch.start);
        parts.push(part);
        values = rest;
    }
    parts
}
