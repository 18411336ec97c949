//! Yarn files.

use std::path::PathBuf;

use pyo3::prelude::*;

use crate::error::Failure;
use crate::gil::detached;
use crate::yarns::Yarns;

/// Reads a BCC or glTF file.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf, yarn_radius: Option<f32>) -> Result<Yarns, Failure> {
    let curves = detached(py, || lisle_formats::load(&path))?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Yarns::of_curves(py, curves, yarn_radius, name)
}
