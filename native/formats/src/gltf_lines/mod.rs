//! Lines of a glTF file as curves.
//!
//! glTF has no curve primitive. Yarns come as polylines: LINE_STRIP and LINE_LOOP primitives are one curve each, and
//! the single lines of a LINES primitive are chained wherever exactly two of them share an index (never by position).
//! Custom attributes carry what glTF does not know: `_RADIUS`, the yarn's radius, and `_LENGTH`, its length
//! coordinate, both one float per vertex. Other primitives are left alone.
//!
//! The default scene (else the first) is read, node transforms applied; radii and lengths are scaled by the cube
//! root of the transform's determinant, which is exact for uniform scales. Y is up, as glTF demands. Morph targets,
//! skins and animations are not applied.

mod buffers;
mod chain;
mod error;

pub use error::GltfError;

use crate::{Loaded, UpAxis};
use buffers::Buffers;
use chain::{Strip, chain};
use glam::{DMat4, DVec3};
use gltf::mesh::{Mode, Semantic};
use lisle_core::curve::{Basis, Curves};
use std::path::Path;

/// Reads the bytes of a `.gltf` or `.glb` file; buffers in files of their own are looked up in `folder`.
///
/// # Errors
/// [`GltfError`], by buffer, accessor, node or primitive.
pub fn parse(bytes: &[u8], folder: Option<&Path>) -> Result<Loaded, GltfError> {
    // The glTF crate subtracts the header from this length without looking.
    if let Some(length) = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(4..8)) {
        let length = u32::from_le_bytes([length[0], length[1], length[2], length[3]]);
        if length < 12 {
            return Err(GltfError::BinaryLength { length });
        }
    }
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice_without_validation(bytes)?;
    let document = validated(document)?;
    let buffers = Buffers::load(&document, blob, folder)?;
    let scene = document.default_scene().or_else(|| document.scenes().next()).ok_or(GltfError::NoScene)?;

    let mut collected = Collected::default();
    let mut visited = vec![false; document.nodes().len()];
    let mut pending: Vec<(gltf::Node, DMat4)> = scene.nodes().map(|node| (node, DMat4::IDENTITY)).collect();
    pending.reverse();
    while let Some((node, world_from_parent)) = pending.pop() {
        if std::mem::replace(&mut visited[node.index()], true) {
            return Err(GltfError::NodeTwice { node: node.index() });
        }
        let parent_from_node =
            DMat4::from_cols_array_2d(&node.transform().matrix().map(|column| column.map(f64::from)));
        let world_from_node = world_from_parent * parent_from_node;
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                collected.add(&buffers, mesh.index(), &primitive, world_from_node)?;
            }
        }
        let children: Vec<_> = node.children().map(|child| (child, world_from_node)).collect();
        pending.extend(children.into_iter().rev());
    }
    if collected.primitives == 0 {
        return Err(GltfError::NoLines);
    }
    let info = document.as_json().asset.generator.clone().unwrap_or_default();
    Ok(collected.finish(info))
}

/// A document that refers to nothing outside of itself.
fn validated(document: gltf::Document) -> Result<gltf::Document, GltfError> {
    let json = document.into_json();
    // The one index that the glTF crate's own validation uses before it checks it.
    let positions = gltf::json::validation::Checked::Valid(Semantic::Positions);
    for (mesh_index, mesh) in json.meshes.iter().enumerate() {
        for (primitive_index, primitive) in mesh.primitives.iter().enumerate() {
            let accessor = primitive.attributes.get(&positions);
            if let Some(accessor) = accessor.filter(|accessor| accessor.value() >= json.accessors.len()) {
                let reason = format!("POSITION is accessor {}, which does not exist", accessor.value());
                return Err(GltfError::Primitive { mesh: mesh_index, primitive: primitive_index, reason });
            }
        }
    }
    Ok(gltf::Document::from_json(json)?)
}

/// Curves as they are found.
#[derive(Default)]
struct Collected {
    primitives: usize,
    points: Vec<[f32; 3]>,
    radii: Attribute,
    length_coordinates: Attribute,
    offsets: Vec<u32>,
    closed: Vec<bool>,
}

/// An optional value per point: there for all points or for none.
#[derive(Default)]
struct Attribute {
    values: Vec<f32>,
}

impl Attribute {
    /// Takes one primitive's values, at the given vertices; `before` is the number of points of earlier primitives.
    fn add(
        &mut self,
        name: &'static str,
        values: Option<&Vec<[f32; 1]>>,
        strips: &[Strip],
        scale: f64,
        before: usize,
    ) -> Result<(), GltfError> {
        if before > 0 && values.is_some() == self.values.is_empty() {
            return Err(GltfError::MixedAttribute { name });
        }
        if let Some(values) = values {
            let vertices = strips.iter().flat_map(|strip| &strip.vertices);
            self.values.extend(vertices.map(|&vertex| (f64::from(values[vertex as usize][0]) * scale) as f32));
        }
        Ok(())
    }

    fn finish(self) -> Option<Vec<f32>> {
        (!self.values.is_empty()).then_some(self.values)
    }
}

impl Collected {
    fn add(
        &mut self,
        buffers: &Buffers,
        mesh: usize,
        primitive: &gltf::Primitive,
        world_from_node: DMat4,
    ) -> Result<(), GltfError> {
        if !matches!(primitive.mode(), Mode::Lines | Mode::LineStrip | Mode::LineLoop) {
            return Ok(());
        }
        let refuse = |reason: String| GltfError::Primitive { mesh, primitive: primitive.index(), reason };
        let positions = primitive
            .get(&Semantic::Positions)
            .ok_or_else(|| refuse("lines without POSITION".to_owned()))
            .and_then(|accessor| buffers.floats::<3>(&accessor, "POSITION"))?;
        let attribute = |name: &str, usage: &'static str| -> Result<Option<Vec<[f32; 1]>>, GltfError> {
            let Some(accessor) = primitive.get(&Semantic::Extras(name.to_owned())) else { return Ok(None) };
            let values = buffers.floats::<1>(&accessor, usage)?;
            if values.len() != positions.len() {
                return Err(refuse(format!("{usage} has {} values for {} vertices", values.len(), positions.len())));
            }
            Ok(Some(values))
        };
        let radii = attribute("RADIUS", "_RADIUS")?;
        let length_coordinates = attribute("LENGTH", "_LENGTH")?;
        let indices = match primitive.indices() {
            Some(accessor) => buffers.indices(&accessor)?,
            None => (0..positions.len() as u32).collect(),
        };
        if let Some((at, &index)) = indices.iter().enumerate().find(|&(_, &index)| index as usize >= positions.len()) {
            return Err(refuse(format!("index {at} is {index}, but there are {} vertices", positions.len())));
        }
        let strips = match primitive.mode() {
            Mode::Lines => {
                let (lines, left_over) = indices.as_chunks::<2>();
                if !left_over.is_empty() {
                    return Err(refuse(format!("{} indices do not make whole lines", indices.len())));
                }
                chain(lines, positions.len())
            }
            mode => vec![Strip { vertices: indices, closed: mode == Mode::LineLoop }],
        };
        let count: usize = strips.iter().map(|strip| strip.vertices.len()).sum();
        let before = self.points.len();
        if before + count > u32::MAX as usize {
            return Err(GltfError::TooManyPoints);
        }
        let scale = world_from_node.determinant().abs().cbrt();
        self.radii.add("_RADIUS", radii.as_ref(), &strips, scale, before)?;
        self.length_coordinates.add("_LENGTH", length_coordinates.as_ref(), &strips, scale, before)?;
        for strip in &strips {
            self.points.extend(strip.vertices.iter().map(|&vertex| {
                let position = DVec3::from_array(positions[vertex as usize].map(f64::from));
                world_from_node.transform_point3(position).as_vec3().to_array()
            }));
            self.offsets.push(self.points.len() as u32);
            self.closed.push(strip.closed);
        }
        self.primitives += 1;
        Ok(())
    }

    fn finish(mut self, info: String) -> Loaded {
        self.offsets.insert(0, 0);
        let curves = Curves {
            points: self.points,
            basis: vec![Basis::Linear; self.closed.len()],
            closed: self.closed,
            offsets: self.offsets,
            radii: self.radii.finish(),
        };
        Loaded { curves, up: UpAxis::Y, length_coordinates: self.length_coordinates.finish(), info }
    }
}
