//! Yarn files.

use std::path::PathBuf;

use pyo3::prelude::*;

use crate::error::Failure;
use crate::gil::detached;
use crate::yarns::Yarns;

/// Reads a BCC or glTF file, turned to Z up.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf, yarn_radius: Option<f32>) -> Result<Yarns, Failure> {
    let file = detached(py, || lisle_formats::load(&path))?.into_z_up();
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Yarns::at_rest(py, file.curves, yarn_radius, file.length_coordinates, name)
}
