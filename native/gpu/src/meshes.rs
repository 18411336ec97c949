//! The scene's meshes on the GPU: geometry stays there from frame to frame.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scene::{Mesh, MeshKind, Triangles};
use rayon::prelude::*;

use crate::device::Gpu;
use crate::knots::pack_unit_vector;
use crate::layout::{self, MESH_HOLDOUT, MESH_SHADED, MESH_SHADOW_CATCHER, NONE};
use crate::upload::storage;
use crate::view::Bounds;
use crate::{Error, Scene};

/// A geometry, as uploaded; instances share it.
struct Upload {
    triangles: Arc<Triangles>,
    center: DVec3,
    bounds: Bounds,
    first_position: u32,
    first_corner: u32,
    first_normal: u32,
}

/// Buffers of the meshes, and what they hold.
pub(crate) struct MeshBuffers {
    uploads: Vec<Upload>,
    pub positions: wgpu::Buffer,
    pub corners: wgpu::Buffer,
    pub normals: wgpu::Buffer,
    /// Geometry of each mesh, and triangles of all.
    which: Vec<usize>,
    triangle_count: u32,
}

/// Where the meshes of a picture are.
pub(crate) struct MeshPlaces {
    pub items: Vec<layout::MeshDraw>,
    /// Render space.
    pub bounds: Bounds,
}

impl MeshPlaces {
    /// None.
    pub fn new() -> Self {
        Self { items: Vec::new(), bounds: Bounds::EMPTY }
    }
}

impl MeshBuffers {
    /// Brings the GPU up to date, reusing what `previous` already holds.
    pub fn update(gpu: &Gpu, previous: Option<Self>, scene: &Scene) -> Result<Self, Error> {
        let mut distinct: Vec<&Arc<Triangles>> = Vec::new();
        let mut known = std::collections::HashMap::new();
        let which: Vec<usize> = scene
            .meshes
            .iter()
            .map(|mesh| {
                *known.entry(Arc::as_ptr(&mesh.triangles)).or_insert_with(|| {
                    distinct.push(&mesh.triangles);
                    distinct.len() - 1
                })
            })
            .collect();
        let kept = previous.filter(|p| {
            p.uploads.len() == distinct.len()
                && p.uploads.iter().zip(&distinct).all(|(upload, triangles)| Arc::ptr_eq(&upload.triangles, triangles))
        });
        let mut buffers = match kept {
            Some(buffers) => buffers,
            None => Self::upload(gpu, &distinct)?,
        };
        let triangles: u64 = scene.meshes.iter().map(|mesh| mesh.triangles.triangles().len() as u64).sum();
        // Corners of all instances are numbered.
        if 3 * triangles > u64::from(u32::MAX) {
            return Err(Error::input("scene", "more than 1.43 billion triangles, instances counted each"));
        }
        (buffers.which, buffers.triangle_count) = (which, triangles as u32);
        Ok(buffers)
    }

    fn upload(gpu: &Gpu, distinct: &[&Arc<Triangles>]) -> Result<Self, Error> {
        let (mut positions, mut corners, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        let mut uploads = Vec::with_capacity(distinct.len());
        for triangles in distinct {
            let point = |p: &[f32; 3]| Vec3::from(*p).as_dvec3();
            let mut bounds = Bounds::EMPTY;
            // Positions that no triangle has do not count.
            triangles.triangles().iter().flatten().for_each(|corner| {
                bounds.include(point(&triangles.positions()[*corner as usize]));
            });
            let center = if bounds.is_empty() { DVec3::ZERO } else { 0.5 * (bounds.min + bounds.max) };
            let too_many = |_| Error::input("scene", "more than 4.29 billion corners of triangles");
            let place = |count: usize| u32::try_from(count).map_err(too_many);
            uploads.push(Upload {
                triangles: Arc::clone(triangles),
                center,
                bounds: Bounds { min: bounds.min - center, max: bounds.max - center },
                first_position: place(positions.len())?,
                first_corner: place(3 * corners.len())?,
                first_normal: if triangles.normals().is_some() { place(normals.len())? } else { NONE },
            });
            positions.par_extend(triangles.positions().par_iter().map(|p| (point(p) - center).as_vec3().to_array()));
            corners.extend_from_slice(triangles.triangles());
            let of_triangles = triangles.normals().unwrap_or_default().as_flattened();
            normals.par_extend(of_triangles.par_iter().map(|n| {
                let unit = Vec3::from(*n).try_normalize().unwrap_or(Vec3::Z);
                pack_unit_vector(unit.to_array())
            }));
        }
        Ok(Self {
            uploads,
            positions: storage(gpu, "positions of meshes", &positions)?,
            corners: storage(gpu, "triangles of meshes", &corners)?,
            normals: storage(gpu, "normals of meshes", &normals)?,
            which: Vec::new(),
            triangle_count: 0,
        })
    }

    /// The meshes of a picture in the render space about an origin, world space.
    pub fn place(&self, scene: &Scene, origin: DVec3) -> MeshPlaces {
        let mut places = MeshPlaces::new();
        let mut first_triangle = 0;
        for (mesh, upload) in scene.meshes.iter().zip(self.which.iter().map(|place| &self.uploads[*place])) {
            let render_from_object =
                DMat4::from_translation(-origin) * mesh.world_from_object * DMat4::from_translation(upload.center);
            let row = |i: usize| render_from_object.row(i).as_vec4();
            places.items.push(layout::MeshDraw {
                render_from_object_x: row(0),
                render_from_object_y: row(1),
                render_from_object_z: row(2),
                color: mesh.base_color,
                kind: kind(mesh),
                first_triangle,
                first_corner: upload.first_corner,
                first_position: upload.first_position,
                first_normal: upload.first_normal,
            });
            first_triangle += upload.triangles.triangles().len() as u32;
            places.bounds.merge(&upload.bounds.transformed(&render_from_object));
        }
        places
    }

    /// Of all instances.
    pub fn triangle_count(&self) -> u32 {
        self.triangle_count
    }

    pub fn is_empty(&self) -> bool {
        self.triangle_count == 0
    }

    pub fn bytes(&self) -> u64 {
        [&self.positions, &self.corners, &self.normals].map(wgpu::Buffer::size).iter().sum()
    }
}

fn kind(mesh: &Mesh) -> u32 {
    match mesh.kind {
        MeshKind::Shaded => MESH_SHADED,
        MeshKind::ShadowCatcher => MESH_SHADOW_CATCHER,
        MeshKind::Holdout => MESH_HOLDOUT,
    }
}
