//! Surfaces among the yarns.

use std::sync::Arc;

use glam::Vec3;
use lisle_core::scene::{self, Labels, MeshKind};
use numpy::{PyReadonlyArray2, PyReadonlyArray3};
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
    ) -> Result<Self, Failure> {
        let refuse = |error: numpy::AsSliceError| Failure::Input(format!("mesh: {error}"));
        let positions = positions.as_slice().map_err(refuse)?.as_chunks::<3>().0.to_vec();
        let triangles = triangles.as_slice().map_err(refuse)?.as_chunks::<3>().0.to_vec();
        let normals = match &normals {
            Some(normals) => Some(normals.as_slice().map_err(refuse)?.as_chunks::<3>().0.as_chunks::<3>().0.to_vec()),
            None => None,
        };
        let triangles = detached(py, || scene::Triangles::new(positions, triangles, normals))?;
        Ok(Self(Arc::new(triangles)))
    }

    fn __len__(&self) -> usize {
        self.0.triangles().len()
    }
}

/// `lisle.Mesh`, by its attributes.
#[derive(FromPyObject)]
pub struct MeshFields {
    triangles: Py<Triangles>,
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
