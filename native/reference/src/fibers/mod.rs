//! Explicit fibers: the procedural yarn as curves of points and radii.

mod chain;
mod detail;
mod generate;

pub use detail::Detail;
pub(crate) use generate::append;
pub use generate::{FibersError, Options, fibers};

use glam::{DVec3, Vec3};

/// Fibers as chains of round cones. A hair, and what begins beyond its tip, are chains of their own.
///
/// Memory: 16 bytes a point and 4 a chain; while it is made, a little more for the fibers in progress.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fibers {
    /// Position and radius of every point, in the space and unit that was asked for.
    pub points: Vec<[f32; 4]>,
    /// Chain `i` owns the points `offsets[i]..offsets[i + 1]`, at least 2.
    pub offsets: Vec<u32>,
}

impl Fibers {
    /// Number of chains.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of round cones.
    pub fn segments(&self) -> usize {
        self.points.len() - self.len()
    }

    /// Points of one chain.
    pub fn chain(&self, index: usize) -> &[[f32; 4]] {
        &self.points[self.offsets[index] as usize..self.offsets[index + 1] as usize]
    }
}

/// Where a point lies.
pub(crate) fn position([x, y, z, _]: [f32; 4]) -> DVec3 {
    Vec3::new(x, y, z).as_dvec3()
}
