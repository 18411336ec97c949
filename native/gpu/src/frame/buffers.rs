//! What a picture needs on the GPU besides its scene.

use super::tiles::{TileLimits, most_of, tiles};
use super::{BLOCK, FrameInput};
use crate::arrays::{Arrays, empty_array};
use crate::device::Gpu;
use crate::mesh_raster::{MeshTargets, TargetSizes};
use crate::upload::{Draws, SceneBuffers, empty_storage};
use crate::{Error, layout, lights};

/// Buffers that depend on the picture's size and the scene's counts.
pub(crate) struct FrameBuffers {
    capacity: Capacity,
    pub(super) keys: wgpu::Buffer,
    pub(super) film: [wgpu::Buffer; 3],
    pub(super) pixel_list: wgpu::Buffer,
    pub(super) resolve_dispatch: wgpu::Buffer,
    pub(super) staging: wgpu::Buffer,
    pub(super) segment_work: wgpu::Buffer,
    pub(super) block_work: wgpu::Buffer,
    pub(super) dispatch: wgpu::Buffer,
    pub(super) draws: wgpu::Buffer,
    pub(super) lights: wgpu::Buffer,
    pub(super) views: wgpu::Buffer,
    pub(super) shadow_depths: wgpu::Buffer,
    pub(super) aovs: wgpu::Buffer,
    pub(super) uniform: wgpu::Buffer,
    /// Of the passes that need a few numbers more.
    pub(super) pass_uniform: wgpu::Buffer,
    pub(super) meshes: wgpu::Buffer,
    pub(super) mesh_draws: wgpu::Buffer,
    pub(super) mesh_targets: MeshTargets,
}

#[derive(Clone, Copy, PartialEq, Eq)]
struct Capacity {
    pixels: u64,
    planes: u64,
    segments: u64,
    draws: u64,
    meshes: u64,
    lights: u64,
    views: u64,
    shadow_resolution: u32,
    mesh_targets: Option<TargetSizes>,
}

impl Capacity {
    /// What shadow maps hang on: they stay where only the size of the picture is another.
    fn shadows(&self) -> (u64, u32) {
        (self.views, self.shadow_resolution)
    }
}

impl FrameBuffers {
    /// Buffers for a picture: the kept ones if they fit.
    pub fn fit(
        gpu: &Gpu,
        kept: Option<Self>,
        input: &FrameInput,
        draws: &Draws,
        region: [u32; 4],
    ) -> Result<Self, Error> {
        let has_meshes = !input.meshes.is_empty();
        let sky_views = input.sky_views() + input.environment_suns();
        let views = u64::from(lights::most_views(&input.scene.lights, sky_views, has_meshes));
        // As many texels as one binding holds.
        let most_texels = gpu.limits.max_storage_buffer_binding_size / 4 / views.max(1);
        let shadow_resolution = input
            .settings
            .shadow_resolution
            .min(most_texels.isqrt().min(gpu.limits.max_texture_dimension_2d.into()) as u32);
        let tiles = tiles(region, TileLimits::new(gpu, &input.planes));
        let largest = tiles.iter().map(|[_, _, w, h]| u64::from(*w) * u64::from(*h)).max();
        let capacity = Capacity {
            pixels: largest.unwrap_or(0),
            planes: u64::from(input.planes.count),
            segments: u64::from(draws.segment_count),
            draws: draws.items.len() as u64,
            meshes: input.scene.meshes.len() as u64,
            lights: u64::from(input.light_count()),
            views,
            shadow_resolution,
            mesh_targets: has_meshes.then(|| TargetSizes { tile: most_of(&tiles), shadow: shadow_resolution }),
        };
        let kept_depths = kept.as_ref().filter(|b| b.capacity.shadows() == capacity.shadows());
        let shadow_depths = match kept_depths {
            Some(buffers) => buffers.shadow_depths.clone(),
            None => empty_storage(gpu, "shadow maps", capacity.views * 4 * u64::from(shadow_resolution).pow(2))?,
        };
        if let Some(buffers) = kept.filter(|b| b.capacity == capacity) {
            return Ok(buffers);
        }
        let uniform = |label, size: usize, kind| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: kind | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let film = || empty_storage(gpu, "film", 16 * capacity.pixels);
        Ok(Self {
            keys: empty_storage(gpu, "visibility keys", 8 * capacity.pixels)?,
            film: [film()?, film()?, film()?],
            pixel_list: empty_storage(gpu, "pixels to resolve", 4 * capacity.pixels)?,
            resolve_dispatch: empty_storage(gpu, "dispatch of the resolve", 32)?,
            staging: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("read-back"),
                size: 4 * capacity.planes.max(12) * capacity.pixels,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            segment_work: empty_storage(gpu, "work of segments", 4 * capacity.segments)?,
            block_work: empty_storage(gpu, "work of blocks", 4 * capacity.segments.div_ceil(u64::from(BLOCK)))?,
            dispatch: empty_storage(gpu, "dispatch", 32)?,
            draws: empty_array(gpu, "instances", capacity.draws * size_of::<layout::Draw>() as u64)?,
            lights: empty_array(gpu, "lights", capacity.lights * size_of::<layout::Light>() as u64)?,
            views: empty_array(gpu, "shadow views", capacity.views * size_of::<layout::ShadowView>() as u64)?,
            shadow_depths,
            uniform: uniform("frame", size_of::<layout::Frame>(), wgpu::BufferUsages::UNIFORM),
            pass_uniform: uniform("pass", 16, wgpu::BufferUsages::UNIFORM),
            aovs: empty_storage(gpu, "passes", 4 * capacity.planes * capacity.pixels)?,
            meshes: uniform("meshes of a sample", size_of::<layout::Meshes>(), wgpu::BufferUsages::STORAGE),
            mesh_draws: empty_storage(gpu, "meshes", capacity.meshes * size_of::<layout::MeshDraw>() as u64)?,
            mesh_targets: MeshTargets::new(gpu, capacity.mesh_targets),
            capacity,
        })
    }

    /// Texels along a side of a shadow map: as asked for, or as many as fit.
    pub(super) fn shadow_resolution(&self) -> u32 {
        self.capacity.shadow_resolution
    }

    /// Shadow maps.
    pub(super) fn views(&self) -> u64 {
        self.capacity.views
    }

    /// Where shaders find what the scene has few of.
    pub fn arrays(&self, gpu: &Gpu, scene: &SceneBuffers) -> Arrays {
        Arrays::of(gpu, &[&self.draws, &self.lights, &self.views, &scene.tables.yarns, &scene.tables.materials])
    }

    pub(super) fn bytes(&self) -> u64 {
        let film: u64 = self.film.iter().map(wgpu::Buffer::size).sum();
        [
            &self.keys,
            &self.staging,
            &self.pixel_list,
            &self.segment_work,
            &self.block_work,
            &self.draws,
            &self.lights,
            &self.views,
            &self.shadow_depths,
            &self.aovs,
        ]
        .map(wgpu::Buffer::size)
        .iter()
        .sum::<u64>()
            + film
            + self.mesh_targets.bytes()
    }
}
