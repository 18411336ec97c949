//! The class `Adapter`.

use lisle_gpu::AdapterInfo;
use pyo3::prelude::*;

/// A graphics adapter.
#[pyclass(module = "lisle", frozen, eq, get_all)]
#[derive(Clone, PartialEq)]
pub struct Adapter {
    name: String,
    driver: String,
    backend: String,
    device_type: String,
    has_int64_atomics: bool,
}

impl From<AdapterInfo> for Adapter {
    fn from(info: AdapterInfo) -> Self {
        Self {
            name: info.name,
            driver: info.driver,
            backend: info.backend,
            device_type: info.device_type,
            has_int64_atomics: info.wide_atomics,
        }
    }
}

#[pymethods]
impl Adapter {
    fn __repr__(&self) -> String {
        format!("Adapter({:?}, {:?})", self.name, self.backend)
    }
}

/// All usable adapters, the one that a renderer takes by default first.
#[pyfunction]
pub fn adapters(py: Python<'_>) -> Vec<Adapter> {
    py.detach(lisle_gpu::adapters).into_iter().map(Adapter::from).collect()
}
