//! Surfaces among the yarns.

use std::sync::Arc;

use glam::Vec3;
use lisle_core::scene::{self, Labels, MeshKind};
use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::gil::detached;
use crate::scene::{Rows, matrix};

/// The class `Triangles`: a geometry, which any number of meshes share.
#[pyclass(module = "lisle._native", frozen)]
pub struct Triangles(Arc<scene::Triangles>);

#[pymethods]
impl Triangles {
    #[new]
    fn new(
        py: Python<'_>,
        positions: PyReadonlyArray2<'_, f32>,
        triangles: PyReadonlyArray2<'_, u32>,
        normals: Option<PyReadonlyArray3<'_, f32>>,
        uvs: Option<PyReadonlyArray3<'_, f32>>,
    ) -> Result<Self, Failure> {
        let refuse = |error: numpy::AsSliceError| Failure::Input(format!("mesh: {error}"));
        let positions = positions.as_slice().map_err(refuse)?.as_chunks::<3>().0.to_vec();
        let triangles = triangles.as_slice().map_err(refuse)?.as_chunks::<3>().0.to_vec();
        let normals = match &normals {
            Some(normals) => Some(normals.as_slice().map_err(refuse)?.as_chunks::<3>().0.as_chunks::<3>().0.to_vec()),
            None => None,
        };
        let uvs = match &uvs {
            Some(uvs) => Some(uvs.as_slice().map_err(refuse)?.as_chunks::<2>().0.as_chunks::<3>().0.to_vec()),
            None => None,
        };
        let triangles = detached(py, || {
            let triangles = scene::Triangles::new(positions, triangles, normals)?;
            match uvs {
                Some(uvs) => triangles.with_uvs(uvs),
                None => Ok(triangles),
            }
        })?;
        Ok(Self(Arc::new(triangles)))
    }

    fn __len__(&self) -> usize {
        self.0.triangles().len()
    }
}

/// The class `Texels`: a picture of colours, which any number of meshes share.
#[pyclass(module = "lisle._native", frozen)]
pub struct Texels(Arc<scene::Texture>);

#[pymethods]
impl Texels {
    /// sRGB codes, (h, w, 4), row 0 at the bottom.
    #[new]
    fn new(codes: PyReadonlyArray3<'_, u8>) -> Result<Self, Failure> {
        let refuse = |what: String| Failure::Input(format!("texture: expected shape (h, w, 4), got {what}"));
        let shape = codes.shape();
        let values = codes.as_slice().map_err(|error| refuse(error.to_string()))?;
        let (texels, []) = values.as_chunks::<4>() else { return Err(refuse(format!("{shape:?}"))) };
        let [height, width] = [shape[0], shape[1]].map(|side| u32::try_from(side).unwrap_or(0));
        let texels = texels.iter().map(|texel| u32::from_le_bytes(*texel)).collect();
        Ok(Self(Arc::new(scene::Texture::new([width, height], texels)?)))
    }

    #[getter]
    fn size(&self) -> (u32, u32) {
        self.0.size().into()
    }
}

/// `lisle.Mesh`, by its attributes.
#[derive(FromPyObject)]
pub struct MeshFields {
    triangles: Py<Triangles>,
    texels: Option<Py<Texels>>,
    base_color: [f32; 3],
    kind: String,
    world_from_object: Rows,
    name: String,
    object_index: u32,
    material_name: String,
    material_index: u32,
}

impl MeshFields {
    /// The mesh that they stand for, with an object id.
    pub fn mesh(self, id: u32) -> scene::Mesh {
        scene::Mesh {
            id,
            labels: Labels {
                index: self.object_index,
                material: self.material_name,
                material_index: self.material_index,
            },
            triangles: self.triangles.get().0.clone(),
            base_color: Vec3::from(self.base_color),
            texture: self.texels.map(|texels| texels.get().0.clone()),
            kind: match self.kind.as_str() {
                "shadow-catcher" => MeshKind::ShadowCatcher,
                "holdout" => MeshKind::Holdout,
                _ => MeshKind::Shaded,
            },
            world_from_object: matrix(self.world_from_object),
            name: self.name,
        }
    }
}
