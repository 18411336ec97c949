//! Buffers of a glTF file, and the numbers in them.

use super::GltfError;
use base64::Engine;
use gltf::accessor::{DataType, Dimensions};
use std::path::Path;

/// The bytes of every buffer.
pub(super) struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    /// Collects the buffers: `blob` is the binary part of a `.glb`, files are looked up in `folder`.
    pub fn load(
        document: &gltf::Document,
        mut blob: Option<Vec<u8>>,
        folder: Option<&Path>,
    ) -> Result<Self, GltfError> {
        let mut buffers = Vec::with_capacity(document.buffers().len());
        for buffer in document.buffers() {
            let index = buffer.index();
            let refuse = |reason: &str| GltfError::Buffer { buffer: index, reason: reason.to_owned() };
            let bytes = match buffer.source() {
                gltf::buffer::Source::Bin => blob.take().ok_or_else(|| refuse("the file has no binary part"))?,
                gltf::buffer::Source::Uri(uri) => read_uri(uri, index, folder)?,
            };
            if bytes.len() < buffer.length() {
                let reason = format!("{} bytes, but byteLength is {}", bytes.len(), buffer.length());
                return Err(GltfError::Buffer { buffer: index, reason });
            }
            buffers.push(bytes);
        }
        Ok(Self(buffers))
    }

    /// The elements of an accessor as `N` floats each.
    pub fn floats<const N: usize>(
        &self,
        accessor: &gltf::Accessor,
        usage: &'static str,
    ) -> Result<Vec<[f32; N]>, GltfError> {
        let expected = if N == 1 { Dimensions::Scalar } else { Dimensions::Vec3 };
        if accessor.data_type() != DataType::F32 || accessor.dimensions() != expected {
            let reason =
                format!("{:?} of {:?}, expected {expected:?} of F32", accessor.dimensions(), accessor.data_type());
            return Err(GltfError::Accessor { accessor: accessor.index(), usage, reason });
        }
        self.elements(accessor, usage, |bytes| {
            std::array::from_fn(|i| {
                f32::from_le_bytes([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]])
            })
        })
    }

    /// The elements of an accessor as indices.
    pub fn indices(&self, accessor: &gltf::Accessor) -> Result<Vec<u32>, GltfError> {
        let usage = "indices";
        match (accessor.dimensions(), accessor.data_type()) {
            (Dimensions::Scalar, DataType::U8) => self.elements(accessor, usage, |bytes| u32::from(bytes[0])),
            (Dimensions::Scalar, DataType::U16) => {
                self.elements(accessor, usage, |bytes| u32::from(u16::from_le_bytes([bytes[0], bytes[1]])))
            }
            (Dimensions::Scalar, DataType::U32) => {
                self.elements(accessor, usage, |bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
            }
            (dimensions, data_type) => {
                let reason = format!("{dimensions:?} of {data_type:?}, expected unsigned scalars");
                Err(GltfError::Accessor { accessor: accessor.index(), usage, reason })
            }
        }
    }

    /// The bytes of every element, checked against the bounds of view and buffer before anything is allocated.
    fn elements<T>(
        &self,
        accessor: &gltf::Accessor,
        usage: &'static str,
        convert: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, GltfError> {
        let refuse =
            |reason: &str| Err(GltfError::Accessor { accessor: accessor.index(), usage, reason: reason.to_owned() });
        if accessor.sparse().is_some() {
            return refuse("sparse accessors are not supported");
        }
        let Some(view) = accessor.view() else { return refuse("it has no buffer view") };
        if accessor.count() == 0 {
            return Ok(Vec::new());
        }
        let size = accessor.size();
        let stride = view.stride().unwrap_or(size);
        let buffer = &self.0[view.buffer().index()];
        let bytes = view.offset().checked_add(view.length()).and_then(|end| buffer.get(view.offset()..end));
        let Some(bytes) = bytes else { return refuse("its buffer view reaches beyond the buffer") };
        let used = (accessor.count() - 1).checked_mul(stride).and_then(|n| n.checked_add(size));
        let end = used.and_then(|n| n.checked_add(accessor.offset()));
        if stride < size || end.is_none_or(|end| end > bytes.len()) {
            return refuse("its elements reach beyond its buffer view, or into each other");
        }
        let start = |i: usize| accessor.offset() + i * stride;
        Ok((0..accessor.count()).map(|i| convert(&bytes[start(i)..start(i) + size])).collect())
    }
}

fn read_uri(uri: &str, buffer: usize, folder: Option<&Path>) -> Result<Vec<u8>, GltfError> {
    let refuse = |reason: String| GltfError::Buffer { buffer, reason };
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((_, encoded)) = data.split_once(";base64,") else {
            return Err(refuse("its data URI is not base64".to_owned()));
        };
        let engine = &base64::engine::general_purpose::STANDARD;
        return engine.decode(encoded).map_err(|error| refuse(format!("its data URI: {error}")));
    }
    if uri.contains(':') {
        return Err(refuse(format!("{uri:?} is not a file beside this one")));
    }
    let Some(folder) = folder else { return Err(refuse(format!("{uri:?}: there is no folder to look in"))) };
    let name = urlencoding::decode(uri).map_err(|error| refuse(format!("{uri:?}: {error}")))?;
    let path = folder.join(name.as_ref());
    std::fs::read(&path).map_err(|source| GltfError::BufferFile { buffer, path, source })
}
