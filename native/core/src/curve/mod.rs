//! Curves as a file or Blender holds them, evaluated exactly in f64.
//!
//! [`Curves`] is a set of control points with a [`Basis`] per curve. [`Curve`] evaluates one of them: position and
//! derivatives by segment and parameter, and arc length.

mod arc_length;
mod basis;
mod curves;
mod evaluate;
mod nurbs;

pub use basis::Basis;
pub use curves::Curves;
pub use evaluate::{Curve, Jet};
pub use nurbs::{KnotMode, MAX_ORDER, Nurbs};

/// A point in f64. Unlike a cast inside f32 arithmetic, differences of such points are exact at any distance from the origin.
pub(crate) fn to_f64(point: [f32; 3]) -> glam::DVec3 {
    glam::DVec3::new(f64::from(point[0]), f64::from(point[1]), f64::from(point[2]))
}

/// The nearest f32 point.
pub(crate) fn to_f32(point: glam::DVec3) -> [f32; 3] {
    point.as_vec3().to_array()
}
