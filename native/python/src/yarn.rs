//! Presets and checks of the procedural yarn, which is a dataclass in Python.

use lisle_core::yarn::{Flyaways, PRESET_NAMES, Variate, Yarn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::error::Failure;

/// `lisle.Yarn`, by its attributes.
#[derive(FromPyObject)]
pub struct YarnFields {
    plies: u32,
    fibers_per_ply: u32,
    density_beta: f64,
    density_epsilon: f64,
    fiber_twist: f64,
    ply_twist: f64,
    r_min: f64,
    migration_rate: f64,
    ellipse_long: f64,
    ellipse_short: f64,
    ply_radius: f64,
    fiber_radius: f64,
    loop_density: f64,
    hair_density: f64,
    loop_r_max: (f64, f64),
    hair_r_min: (f64, f64),
    hair_r_span: (f64, f64),
    hair_z_span: (f64, f64),
    hair_theta_span: (f64, f64),
}

impl From<YarnFields> for Yarn {
    fn from(fields: YarnFields) -> Self {
        let variate = |(mean, deviation)| Variate { mean, deviation };
        Self {
            plies: fields.plies,
            fibers_per_ply: fields.fibers_per_ply,
            density_beta: fields.density_beta,
            density_epsilon: fields.density_epsilon,
            fiber_twist: fields.fiber_twist,
            ply_twist: fields.ply_twist,
            r_min: fields.r_min,
            migration_rate: fields.migration_rate,
            ellipse_long: fields.ellipse_long,
            ellipse_short: fields.ellipse_short,
            ply_radius: fields.ply_radius,
            fiber_radius: fields.fiber_radius,
            flyaways: Flyaways {
                loop_density: fields.loop_density,
                hair_density: fields.hair_density,
                loop_r_max: variate(fields.loop_r_max),
                hair_r_min: variate(fields.hair_r_min),
                hair_r_span: variate(fields.hair_r_span),
                hair_z_span: variate(fields.hair_z_span),
                hair_theta_span: variate(fields.hair_theta_span),
            },
        }
    }
}

/// Fields of wrong type are input too.
pub fn extract_yarn(yarn: &Bound<'_, PyAny>) -> Result<Yarn, Failure> {
    let fields: YarnFields =
        yarn.extract().map_err(|error| Failure::Input(crate::convert::field_error(yarn.py(), &error)))?;
    Ok(fields.into())
}

/// Refuses a yarn with a field outside of its range.
#[pyfunction]
pub fn check_yarn(yarn: &Bound<'_, PyAny>) -> Result<(), Failure> {
    Ok(extract_yarn(yarn)?.validate()?)
}

/// Names that `yarn_preset` takes.
#[pyfunction]
pub fn yarn_presets(py: Python<'_>) -> PyResult<Bound<'_, PyTuple>> {
    PyTuple::new(py, PRESET_NAMES)
}

/// Fields of a preset.
#[pyfunction]
pub fn yarn_preset<'py>(py: Python<'py>, name: &str) -> Result<Bound<'py, PyDict>, Failure> {
    let yarn = Yarn::preset(name)
        .ok_or_else(|| Failure::Input(format!("yarn preset {name:?} is none of {}", PRESET_NAMES.join(", "))))?;
    let variate = |v: Variate| (v.mean, v.deviation);
    let fields = PyDict::new(py);
    fields.set_item("plies", yarn.plies)?;
    fields.set_item("fibers_per_ply", yarn.fibers_per_ply)?;
    for (name, value) in [
        ("density_beta", yarn.density_beta),
        ("density_epsilon", yarn.density_epsilon),
        ("fiber_twist", yarn.fiber_twist),
        ("ply_twist", yarn.ply_twist),
        ("r_min", yarn.r_min),
        ("migration_rate", yarn.migration_rate),
        ("ellipse_long", yarn.ellipse_long),
        ("ellipse_short", yarn.ellipse_short),
        ("ply_radius", yarn.ply_radius),
        ("fiber_radius", yarn.fiber_radius),
        ("loop_density", yarn.flyaways.loop_density),
        ("hair_density", yarn.flyaways.hair_density),
    ] {
        fields.set_item(name, value)?;
    }
    for (name, value) in [
        ("loop_r_max", yarn.flyaways.loop_r_max),
        ("hair_r_min", yarn.flyaways.hair_r_min),
        ("hair_r_span", yarn.flyaways.hair_r_span),
        ("hair_z_span", yarn.flyaways.hair_z_span),
        ("hair_theta_span", yarn.flyaways.hair_theta_span),
    ] {
        fields.set_item(name, variate(value))?;
    }
    Ok(fields)
}
