//! Presets and checks of the material, which is a dataclass in Python.

use glam::DVec3;
use lisle_core::scattering::{MATERIAL_NAMES, MIN_WIDTH_RAD, Material};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::convert::field_error;
use crate::error::Failure;

/// `lisle.Material`, by its attributes.
#[derive(FromPyObject)]
struct MaterialFields {
    color_r: [f64; 3],
    color_tt: [f64; 3],
    beta_r_deg: f64,
    beta_tt_deg: f64,
    gamma_tt_deg: f64,
    diffuse: [f64; 3],
    diffuse_weight: f64,
    specular: [f64; 3],
    specular_beta_deg: f64,
}

/// Fields of wrong type are input too.
pub fn extract_material(material: &Bound<'_, PyAny>) -> Result<Material, Failure> {
    let fields: MaterialFields =
        material.extract().map_err(|error| Failure::Input(field_error(material.py(), &error)))?;
    Ok(Material {
        color_r: DVec3::from(fields.color_r),
        color_tt: DVec3::from(fields.color_tt),
        beta_r_rad: fields.beta_r_deg.to_radians(),
        beta_tt_rad: fields.beta_tt_deg.to_radians(),
        gamma_tt_rad: fields.gamma_tt_deg.to_radians(),
        diffuse: DVec3::from(fields.diffuse),
        diffuse_weight: fields.diffuse_weight,
        specular: DVec3::from(fields.specular),
        specular_beta_rad: fields.specular_beta_deg.to_radians(),
    })
}

/// Refuses a material with a field outside of its range.
#[pyfunction]
pub fn check_material(material: &Bound<'_, PyAny>) -> Result<(), Failure> {
    extract_material(material)?.validate().map_err(|error| {
        // Angles are degrees on this side.
        Failure::Input(match error.parameter.strip_suffix("_rad") {
            Some(angle) => format!(
                "material parameter `{angle}_deg` is {}: expected an angle from {:.4} to 90 degrees",
                error.value.to_degrees(),
                MIN_WIDTH_RAD.to_degrees(),
            ),
            None => error.to_string(),
        })
    })
}

/// Names that `material_preset` takes.
#[pyfunction]
pub fn material_presets(py: Python<'_>) -> PyResult<Bound<'_, PyTuple>> {
    PyTuple::new(py, MATERIAL_NAMES)
}

/// Fields of a preset.
#[pyfunction]
pub fn material_preset<'py>(py: Python<'py>, name: &str) -> Result<Bound<'py, PyDict>, Failure> {
    let material = Material::preset(name)
        .ok_or_else(|| Failure::Input(format!("material preset {name:?} is none of {}", MATERIAL_NAMES.join(", "))))?;
    let fields = PyDict::new(py);
    for (name, color) in [
        ("color_r", material.color_r),
        ("color_tt", material.color_tt),
        ("diffuse", material.diffuse),
        ("specular", material.specular),
    ] {
        fields.set_item(name, (color.x, color.y, color.z))?;
    }
    for (name, angle_rad) in [
        ("beta_r_deg", material.beta_r_rad),
        ("beta_tt_deg", material.beta_tt_rad),
        ("gamma_tt_deg", material.gamma_tt_rad),
        ("specular_beta_deg", material.specular_beta_rad),
    ] {
        fields.set_item(name, angle_rad.to_degrees())?;
    }
    fields.set_item("diffuse_weight", material.diffuse_weight)?;
    Ok(fields)
}
