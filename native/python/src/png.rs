//! Pictures for a display.

use std::path::PathBuf;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::error::Failure;
use crate::gil::detached;
use crate::save;

/// The sRGB transfer function, linear to display [IEC 61966-2-1].
fn display_from_linear(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Display values with straight alpha, 0 to 1.
fn straight(pixel: [f32; 4]) -> [f32; 4] {
    let alpha = pixel[3].clamp(0.0, 1.0);
    let scale = if alpha > 0.0 { 1.0 / alpha } else { 0.0 };
    let [r, g, b] = [0, 1, 2].map(|channel| display_from_linear(pixel[channel] * scale));
    [r, g, b, alpha]
}

/// Writes scene-linear premultiplied RGBA, (h, w, 4), as sRGB with straight alpha.
#[pyfunction]
pub fn save_png(py: Python<'_>, path: PathBuf, combined: PyReadonlyArray3<'_, f32>, bits: u8) -> Result<(), Failure> {
    let &[height, width, 4] = combined.shape() else {
        return Err(Failure::Input(format!("combined: expected shape (h, w, 4), got {:?}", combined.shape())));
    };
    let pixels = combined.as_slice().map_err(|error| Failure::Input(error.to_string()))?.as_chunks::<4>().0;
    detached(py, || {
        let (bytes, color): (Vec<u8>, _) = if bits == 16 {
            let quantise = |value: f32| (65535.0 * value).round() as u16;
            let encode = |&pixel: &[f32; 4]| straight(pixel).map(|value| quantise(value).to_ne_bytes());
            (
                pixels.par_iter().flat_map_iter(|pixel| encode(pixel).into_iter().flatten()).collect(),
                ExtendedColorType::Rgba16,
            )
        } else {
            let quantise = |value: f32| (255.0 * value).round() as u8;
            (
                pixels.par_iter().flat_map_iter(|&pixel| straight(pixel).map(quantise)).collect(),
                ExtendedColorType::Rgba8,
            )
        };
        save::replace(&path, |file| {
            PngEncoder::new(file)
                .write_image(&bytes, width as u32, height as u32, color)
                .map_err(|error| error.to_string())
        })
    })
}
