//! The scene's meshes on the GPU: geometry stays there from frame to frame.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scene::{Mesh, MeshKind, Texture, Triangles};
use rayon::prelude::*;

use crate::device::Gpu;
use crate::knots::pack_unit_vector;
use crate::layout::{self, MESH_HOLDOUT, MESH_SHADED, MESH_SHADOW_CATCHER, NONE};
use crate::upload::{empty_storage, storage};
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
    /// Behind the normals; read where there is a texture.
    first_uv: u32,
    /// At each time step of the picture; none where all are one.
    shapes: Vec<Arc<Triangles>>,
}

impl Upload {
    /// As the buffer holds them, on the way from one shape to another.
    fn positions(&self, a: &Triangles, b: &Triangles, share: f64) -> Vec<[f32; 3]> {
        let pairs = a.positions().par_iter().zip(b.positions());
        pairs.map(|(a, b)| (point(a).lerp(point(b), share) - self.center).as_vec3().to_array()).collect()
    }
}

fn point(p: &[f32; 3]) -> DVec3 {
    Vec3::from(*p).as_dvec3()
}

/// Likewise, of normals at corners.
fn normals(a: &Triangles, b: &Triangles, share: f64) -> Vec<u32> {
    let [a, b] = [a, b].map(|triangles| triangles.normals().unwrap_or_default().as_flattened());
    let pairs = a.par_iter().zip(b);
    let mixed = pairs.map(|(a, b)| Vec3::from(*a).lerp(Vec3::from(*b), share as f32));
    mixed.map(|n| pack_unit_vector(n.try_normalize().unwrap_or(Vec3::Z).to_array())).collect()
}

/// Whether one is the other with its corners moved.
pub(crate) fn correspond(a: &Arc<Triangles>, b: &Arc<Triangles>) -> bool {
    Arc::ptr_eq(a, b)
        || (a.positions().len() == b.positions().len()
            && a.triangles() == b.triangles()
            && a.normals().is_some() == b.normals().is_some()
            && a.uvs().is_some() == b.uvs().is_some())
}

fn bounds(triangles: &Triangles) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    // Positions that no triangle has do not count.
    triangles.triangles().iter().flatten().for_each(|corner| {
        bounds.include(point(&triangles.positions()[*corner as usize]));
    });
    bounds
}

/// Buffers of the meshes, and what they hold.
pub(crate) struct MeshBuffers {
    uploads: Vec<Upload>,
    pub positions: wgpu::Buffer,
    pub corners: wgpu::Buffer,
    /// And places on textures.
    pub normals: wgpu::Buffer,
    pub texels: wgpu::Buffer,
    textures: Vec<Arc<Texture>>,
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
    /// Brings the GPU up to date with the first of a picture's time steps, reusing what `previous` already holds.
    pub fn update(gpu: &Gpu, previous: Option<Self>, steps: &[Scene]) -> Result<Self, Error> {
        let scene = &steps[0];
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
        let mut textures: Vec<&Arc<Texture>> = Vec::new();
        for texture in scene.meshes.iter().filter_map(|mesh| mesh.texture.as_ref()) {
            if !textures.iter().any(|known| Arc::ptr_eq(known, texture)) {
                textures.push(texture);
            }
        }
        let is_kept = |p: &&Self| {
            p.textures.len() == textures.len() && p.textures.iter().zip(&textures).all(|(a, b)| Arc::ptr_eq(a, b))
        };
        let texels = match previous.as_ref().filter(is_kept) {
            Some(previous) => previous.texels.clone(),
            None => upload_textures(gpu, &textures)?,
        };
        let kept = previous.filter(|p| {
            // One that moved in its picture is left somewhere on its way.
            p.uploads.iter().all(|upload| upload.shapes.is_empty())
                && p.uploads.len() == distinct.len()
                && p.uploads.iter().zip(&distinct).all(|(upload, triangles)| Arc::ptr_eq(&upload.triangles, triangles))
        });
        let mut buffers = match kept {
            Some(buffers) => buffers,
            None => Self::upload(gpu, &distinct, texels.clone())?,
        };
        buffers.texels = texels;
        buffers.textures = textures.into_iter().map(Arc::clone).collect();
        let triangles: u64 = scene.meshes.iter().map(|mesh| mesh.triangles.triangles().len() as u64).sum();
        // Corners of all instances are numbered.
        if 3 * triangles > u64::from(u32::MAX) {
            return Err(Error::input("scene", "more than 1.43 billion triangles, instances counted each"));
        }
        (buffers.which, buffers.triangle_count) = (which, triangles as u32);
        buffers.move_in(steps);
        Ok(buffers)
    }

    /// Notes which geometries change their shape over the time steps of a picture. Instances move as the first of them.
    fn move_in(&mut self, steps: &[Scene]) {
        let all = |step: &&Scene| step.meshes.len() == steps[0].meshes.len();
        if steps.len() < 2 || !steps.iter().all(|step| all(&step)) {
            return;
        }
        for (place, upload) in self.uploads.iter_mut().enumerate() {
            let Some(first) = self.which.iter().position(|which| *which == place) else { continue };
            let shapes = steps.iter().map(|step| &step.meshes[first].triangles);
            if shapes.clone().all(|shape| Arc::ptr_eq(shape, &upload.triangles))
                || !shapes.clone().all(|shape| correspond(shape, &upload.triangles))
            {
                continue;
            }
            for shape in shapes {
                let Bounds { min, max } = bounds(shape);
                upload.bounds.merge(&Bounds { min: min - upload.center, max: max - upload.center });
                upload.shapes.push(Arc::clone(shape));
            }
        }
    }

    /// Moves what changes its shape to a place between a time step and the next.
    pub fn deform(&self, gpu: &Gpu, step: usize, share: f64) {
        for upload in &self.uploads {
            let Some([a, b]) = upload.shapes.get(step..step + 2) else { continue };
            let positions = upload.positions(a, b, share);
            gpu.queue.write_buffer(
                &self.positions,
                12 * u64::from(upload.first_position),
                bytemuck::cast_slice(&positions),
            );
            if upload.first_normal != NONE {
                let normals = normals(a, b, share);
                gpu.queue.write_buffer(
                    &self.normals,
                    4 * u64::from(upload.first_normal),
                    bytemuck::cast_slice(&normals),
                );
            }
        }
    }

    fn upload(gpu: &Gpu, distinct: &[&Arc<Triangles>], texels: wgpu::Buffer) -> Result<Self, Error> {
        let (mut positions, mut corners, mut at_corners) = (Vec::new(), Vec::new(), Vec::new());
        let mut uploads = Vec::with_capacity(distinct.len());
        for triangles in distinct {
            let bounds = bounds(triangles);
            let center = if bounds.is_empty() { DVec3::ZERO } else { 0.5 * (bounds.min + bounds.max) };
            let too_many = |_| Error::input("scene", "more than 4.29 billion corners of triangles");
            let place = |count: usize| u32::try_from(count).map_err(too_many);
            let own_normals = 3 * triangles.normals().map_or(0, <[_]>::len);
            let upload = Upload {
                triangles: Arc::clone(triangles),
                center,
                bounds: Bounds { min: bounds.min - center, max: bounds.max - center },
                first_position: place(positions.len())?,
                first_corner: place(3 * corners.len())?,
                first_normal: if triangles.normals().is_some() { place(at_corners.len())? } else { NONE },
                first_uv: place(at_corners.len() + own_normals)?,
                shapes: Vec::new(),
            };
            positions.extend(upload.positions(triangles, triangles, 0.0));
            corners.extend_from_slice(triangles.triangles());
            at_corners.extend(normals(triangles, triangles, 0.0));
            let uvs = triangles.uvs().unwrap_or_default().as_flattened().as_flattened();
            at_corners.extend(uvs.iter().map(|place| place.to_bits()));
            uploads.push(upload);
        }
        Ok(Self {
            uploads,
            positions: storage(gpu, "positions of meshes", &positions)?,
            corners: storage(gpu, "triangles of meshes", &corners)?,
            normals: storage(gpu, "normals and UV coordinates of meshes", &at_corners)?,
            texels,
            textures: Vec::new(),
            which: Vec::new(),
            triangle_count: 0,
        })
    }

    /// The meshes of a picture, by their transforms to world space, in the render space about an origin.
    pub fn place(&self, scene: &Scene, transforms: &[DMat4], origin: DVec3) -> MeshPlaces {
        let mut places = MeshPlaces::new();
        let mut first_triangle = 0;
        let uploads = self.which.iter().map(|place| &self.uploads[*place]);
        for ((mesh, world_from_object), upload) in scene.meshes.iter().zip(transforms).zip(uploads) {
            let render_from_object =
                DMat4::from_translation(-origin) * *world_from_object * DMat4::from_translation(upload.center);
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
                texture_size: mesh.texture.as_ref().map_or([0; 2], |texture| texture.size()),
                first_texel: self.first_texel(mesh),
                first_uv: upload.first_uv,
            });
            first_triangle += upload.triangles.triangles().len() as u32;
            places.bounds.merge(&upload.bounds.transformed(&render_from_object));
        }
        places
    }

    fn first_texel(&self, mesh: &Mesh) -> u32 {
        let mut first = 0;
        for texture in &self.textures {
            if mesh.texture.as_ref().is_some_and(|own| Arc::ptr_eq(own, texture)) {
                return first;
            }
            first += texture.texels().len() as u32;
        }
        NONE
    }

    /// Of all instances.
    pub fn triangle_count(&self) -> u32 {
        self.triangle_count
    }

    pub fn is_empty(&self) -> bool {
        self.triangle_count == 0
    }

    pub fn bytes(&self) -> u64 {
        [&self.positions, &self.corners, &self.normals, &self.texels].map(wgpu::Buffer::size).iter().sum()
    }
}

fn upload_textures(gpu: &Gpu, textures: &[&Arc<Texture>]) -> Result<wgpu::Buffer, Error> {
    let count: usize = textures.iter().map(|texture| texture.texels().len()).sum();
    let buffer = empty_storage(gpu, "textures of meshes", 4 * count as u64)?;
    let mut first = 0;
    for texture in textures {
        let bytes: &[u8] = bytemuck::cast_slice(texture.texels());
        gpu.queue.write_buffer(&buffer, first, bytes);
        first += bytes.len() as u64;
    }
    Ok(buffer)
}

fn kind(mesh: &Mesh) -> u32 {
    match mesh.kind {
        MeshKind::Shaded => MESH_SHADED,
        MeshKind::ShadowCatcher => MESH_SHADOW_CATCHER,
        MeshKind::Holdout => MESH_HOLDOUT,
    }
}
