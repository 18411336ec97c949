//! Yarn curves, the procedural yarn and fiber scattering, in f64: no GPU, no files, no Python.

pub mod sampling;
pub mod scattering;
pub mod yarn;
