//! Yarn curves, the procedural yarn and fiber scattering, in f64: no GPU, no files, no Python.

pub mod curve;
mod error;
pub mod sampling;
pub mod scattering;
pub mod scene;
pub mod strands;
pub mod view;
pub mod yarn;

pub use curve::{Basis, Curves, KnotMode, Nurbs};
pub use error::Error;
pub use strands::{Strands, Yarns};
