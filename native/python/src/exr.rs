//! Pictures for a compositor.

use std::collections::BTreeMap;
use std::path::PathBuf;

use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::gil::detached;
use crate::save;

/// Values of a pass, (h, w) or (h, w, channels).
#[derive(FromPyObject)]
pub enum Values<'py> {
    /// Numbers.
    Float(PyReadonlyArrayDyn<'py, f32>),
    /// Ids.
    Integer(PyReadonlyArrayDyn<'py, u32>),
}

/// Writes passes, scene-linear, into one part: for each the names of its channels and its values. `metadata` is text by attribute.
#[pyfunction]
pub fn save_exr(
    py: Python<'_>,
    path: PathBuf,
    passes: Vec<(Vec<String>, Values<'_>)>,
    metadata: BTreeMap<String, String>,
) -> Result<(), Failure> {
    let mut size = None;
    let mut channels = Vec::new();
    for (names, values) in &passes {
        let shape = match values {
            Values::Float(array) => array.shape(),
            Values::Integer(array) => array.shape(),
        };
        let (height, width) = match *shape {
            [height, width] if names.len() == 1 => (height, width),
            [height, width, count] if names.len() == count => (height, width),
            _ => return Err(Failure::Input(format!("{names:?}: {shape:?} are not as many channels"))),
        };
        if *size.get_or_insert((width, height)) != (width, height) {
            return Err(Failure::Input(format!("{names:?}: {shape:?} is not of the other passes' size")));
        }
        for (channel, name) in names.iter().enumerate() {
            let every = |length: usize| (channel..length).step_by(names.len());
            let broken = |error: numpy::AsSliceError| Failure::Input(format!("{name}: {error}"));
            let samples = match values {
                Values::Float(array) => {
                    let slice = array.as_slice().map_err(broken)?;
                    FlatSamples::F32(every(slice.len()).map(|i| slice[i]).collect())
                }
                Values::Integer(array) => {
                    let slice = array.as_slice().map_err(broken)?;
                    FlatSamples::U32(every(slice.len()).map(|i| slice[i]).collect())
                }
            };
            channels.push(AnyChannel::new(name.as_str(), samples));
        }
    }
    let size = size.ok_or_else(|| Failure::Input("a picture without passes".to_owned()))?;
    let text = |text: &str| {
        Text::new_or_none(text).ok_or_else(|| Failure::Input(format!("{text:?} cannot be written into an EXR")))
    };
    let mut attributes = LayerAttributes::default();
    for (name, value) in &metadata {
        attributes.other.insert(text(name)?, AttributeValue::Text(text(value)?));
    }
    detached(py, || {
        let channels = AnyChannels::sort(channels.into_iter().collect());
        let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
        save::replace(&path, |file| {
            // The writer seeks; a buffer in memory is simpler than a seekable, buffered file.
            let mut bytes = std::io::Cursor::new(Vec::new());
            Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
            std::io::Write::write_all(file, bytes.get_ref()).map_err(|error| error.to_string())
        })
    })
}

/// The hash by which Cryptomatte knows a name.
#[pyfunction]
pub fn cryptomatte_hash(name: &str) -> u32 {
    lisle_gpu::cryptomatte::hash(name)
}
