//! Pictures of the sky.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DMat3;
use lisle_core::scene;
use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::convert::array;
use crate::error::Failure;
use crate::gil::detached;

/// The class `EnvironmentImage`: a picture with its tables, made once for all scenes that show it.
#[pyclass(module = "lisle._native", frozen)]
pub struct EnvironmentImage(Arc<scene::EnvironmentImage>);

#[pymethods]
impl EnvironmentImage {
    #[new]
    fn new(py: Python<'_>, radiance: PyReadonlyArray3<'_, f32>) -> Result<Self, Failure> {
        let refuse = |what: String| Failure::Input(format!("Environment: expected shape (h, w, 3), got {what}"));
        let shape = radiance.shape();
        let values = radiance.as_slice().map_err(|error| refuse(error.to_string()))?;
        let (texels, []) = values.as_chunks::<3>() else { return Err(refuse(format!("{shape:?}"))) };
        let [height, width] = [shape[0], shape[1]].map(|side| u32::try_from(side).unwrap_or(0));
        let texels = texels.to_vec();
        let image = detached(py, || scene::EnvironmentImage::new([width, height], texels))?;
        Ok(Self(Arc::new(image)))
    }

    #[getter]
    fn size(&self) -> (u32, u32) {
        self.0.size().into()
    }
}

/// `lisle.Environment`, by its attributes.
#[derive(FromPyObject)]
pub struct EnvironmentFields {
    image: Py<EnvironmentImage>,
    world_from_environment: [[f64; 3]; 3],
    strength: f32,
}

impl From<EnvironmentFields> for scene::Environment {
    fn from(fields: EnvironmentFields) -> Self {
        Self {
            image: fields.image.get().0.clone(),
            world_from_environment: DMat3::from_cols_array_2d(&fields.world_from_environment).transpose(),
            strength: fields.strength,
        }
    }
}

/// A scene-linear picture file, .exr or .hdr, as (h, w, 3) float32, row 0 at the top.
#[pyfunction]
pub fn load_image(py: Python<'_>, path: PathBuf) -> Result<Bound<'_, PyAny>, Failure> {
    let (size, texels) = detached(py, || read(&path))?;
    Ok(array(py, texels.into_flattened(), &[size[1], size[0], 3])?)
}

/// Width and height, and texels.
fn read(path: &std::path::Path) -> Result<([usize; 2], Vec<[f32; 3]>), Failure> {
    let failed = |reason: String| Failure::File(format!("{}: {reason}", path.display()));
    let suffix = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match suffix.as_str() {
        "exr" => {
            let image = exr::prelude::read_first_rgba_layer_from_file(
                path,
                |size, _| (size.width(), vec![[0.0; 3]; size.area()]),
                |(width, texels), place, (r, g, b, _): (f32, f32, f32, f32)| {
                    texels[place.y() * *width + place.x()] = [r, g, b]
                },
            )
            .map_err(|error| failed(error.to_string()))?;
            let size = image.layer_data.size;
            Ok(([size.width(), size.height()], image.layer_data.channel_data.pixels.1))
        }
        "hdr" => {
            let image = image::open(path).map_err(|error| failed(error.to_string()))?.into_rgb32f();
            let size = [image.width() as usize, image.height() as usize];
            Ok((size, image.into_raw().as_chunks::<3>().0.to_vec()))
        }
        _ => Err(Failure::Input(format!("{}: expected a picture of type .exr or .hdr", path.display()))),
    }
}
