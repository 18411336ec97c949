//! Pictures for a compositor.

use std::path::PathBuf;

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
use numpy::{Element, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::gil::detached;
use crate::save;

/// Writes all passes, scene-linear, into one part: `R G B A` premultiplied, `Z`, `normal.X Y Z`, `tangent.X Y Z`, `object_id`; `variance.R G B`
/// where there is one.
#[pyfunction]
#[pyo3(signature = (path, combined, depth, normal, tangent, object_id, variance=None))]
#[expect(clippy::too_many_arguments, reason = "one a pass")]
pub fn save_exr(
    py: Python<'_>,
    path: PathBuf,
    combined: PyReadonlyArray3<'_, f32>,
    depth: PyReadonlyArray2<'_, f32>,
    normal: PyReadonlyArray3<'_, f32>,
    tangent: PyReadonlyArray3<'_, f32>,
    object_id: PyReadonlyArray2<'_, u32>,
    variance: Option<PyReadonlyArray3<'_, f32>>,
) -> Result<(), Failure> {
    let (height, width) = (combined.shape()[0], combined.shape()[1]);
    let colors = slice("combined", &combined, &[height, width, 4])?;
    let depths = slice("depth", &depth, &[height, width])?;
    let normals = slice("normal", &normal, &[height, width, 3])?;
    let tangents = slice("tangent", &tangent, &[height, width, 3])?;
    let ids = slice("object_id", &object_id, &[height, width])?;
    let variances = variance.as_ref().map(|array| slice("variance", array, &[height, width, 3])).transpose()?;
    detached(py, || {
        let mut channels = Vec::new();
        let mut add = |names: &[&str], values: &[f32]| {
            for (channel, name) in names.iter().enumerate() {
                let samples = values.iter().skip(channel).step_by(names.len()).copied().collect();
                channels.push(AnyChannel::new(*name, FlatSamples::F32(samples)));
            }
        };
        add(&["R", "G", "B", "A"], colors);
        add(&["Z"], depths);
        add(&["normal.X", "normal.Y", "normal.Z"], normals);
        add(&["tangent.X", "tangent.Y", "tangent.Z"], tangents);
        if let Some(variances) = variances {
            add(&["variance.R", "variance.G", "variance.B"], variances);
        }
        channels.push(AnyChannel::new("object_id", FlatSamples::U32(ids.to_vec())));
        let channels = AnyChannels::sort(channels.into_iter().collect());
        let layer = Layer::new((width, height), LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
        save::replace(&path, |file| {
            // The writer seeks; a buffer in memory is simpler than a seekable, buffered file.
            let mut bytes = std::io::Cursor::new(Vec::new());
            Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
            std::io::Write::write_all(file, bytes.get_ref()).map_err(|error| error.to_string())
        })
    })
}

fn slice<'a, T: Element, D: numpy::ndarray::Dimension>(
    name: &str,
    array: &'a numpy::PyReadonlyArray<'_, T, D>,
    shape: &[usize],
) -> Result<&'a [T], Failure> {
    if array.shape() != shape {
        return Err(Failure::Input(format!("{name}: expected shape {shape:?}, got {:?}", array.shape())));
    }
    array.as_slice().map_err(|error| Failure::Input(format!("{name}: {error}")))
}
