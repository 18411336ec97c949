//! Meshes on the hardware's rasteriser: what the camera sees of them, and their part of the shadow maps.

use crate::Error;
use crate::device::Gpu;
use crate::pipelines::{Bindings, bind_group};
use crate::shader::Raster;

const SEEN: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Of the target that gives a shadow map its size, and keeps nothing.
const CARRIER: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

struct Pipeline {
    pipeline: wgpu::RenderPipeline,
    bindings: Vec<u32>,
}

/// The two passes.
pub(crate) struct MeshPipelines {
    visibility: Pipeline,
    shadow: Pipeline,
}

impl MeshPipelines {
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        let build = |raster: Raster| {
            let bindings = raster.bindings().map_err(|message| gpu.error(format!("{raster:?}: {message}")))?;
            let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(raster.name()),
                source: wgpu::ShaderSource::Wgsl(raster.source().into()),
            });
            let (format, write_mask) = match raster {
                Raster::Visibility => (SEEN, wgpu::ColorWrites::ALL),
                Raster::Shadow => (CARRIER, wgpu::ColorWrites::empty()),
            };
            let [vertex, fragment] = raster.entry_points();
            let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(raster.name()),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: (raster == Raster::Visibility).then(|| wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState { format, blend: None, write_mask })],
                }),
                multiview_mask: None,
                cache: None,
            });
            Ok::<_, Error>(Pipeline { pipeline, bindings })
        };
        let pipelines = Self { visibility: build(Raster::Visibility)?, shadow: build(Raster::Shadow)? };
        gpu.finish()?;
        Ok(pipelines)
    }

    /// Records what the camera sees of so many triangles, into the corner of the targets that a tile of `size` takes.
    pub fn record_visibility(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bindings: &Bindings,
        targets: &MeshTargets,
        size: [u32; 2],
        triangles: u32,
    ) {
        let Pipeline { pipeline, bindings: used } = &self.visibility;
        let group = bind_group(gpu, Raster::Visibility.name(), &pipeline.get_bind_group_layout(0), used, bindings);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(Raster::Visibility.name()),
            color_attachments: &[Some(attachment(&targets.seen, wgpu::StoreOp::Store))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_viewport(0.0, 0.0, size[0] as f32, size[1] as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, size[0], size[1]);
        pass.draw(0..3 * triangles, 0..1);
    }

    /// Records so many triangles into shadow maps: numbers of views, and the side of each in texels.
    pub fn record_shadows(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bindings: &Bindings,
        targets: &MeshTargets,
        views: impl Iterator<Item = (u32, u32)>,
        triangles: u32,
    ) {
        let Pipeline { pipeline, bindings: used } = &self.shadow;
        let group = bind_group(gpu, Raster::Shadow.name(), &pipeline.get_bind_group_layout(0), used, bindings);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(Raster::Shadow.name()),
            color_attachments: &[Some(attachment(&targets.carrier, wgpu::StoreOp::Discard))],
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        for (view, side) in views {
            pass.set_scissor_rect(0, 0, side, side);
            pass.draw(0..3 * triangles, view..view + 1);
        }
    }
}

fn attachment(view: &wgpu::TextureView, store: wgpu::StoreOp) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store },
    }
}

/// How large targets are: tiles of so many pixels, and shadow maps of so many texels along one side.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct TargetSizes {
    pub tile: [u32; 2],
    pub shadow: u32,
}

/// Textures that are drawn into.
pub(crate) struct MeshTargets {
    /// Triangle + 1 and distance; a single texel, 0, where there are no meshes.
    pub seen: wgpu::TextureView,
    depth: wgpu::TextureView,
    carrier: wgpu::TextureView,
    bytes: u64,
}

impl MeshTargets {
    /// `None` where there are no meshes. Then nothing may be drawn into them, not even to clear them: where anything was drawn, Mesa's
    /// software driver keeps timestamps of compute passes back until the next one. wgpu clears by copies what has `COPY_DST`.
    pub fn new(gpu: &Gpu, sizes: Option<TargetSizes>) -> Self {
        let usage = match sizes {
            Some(_) => wgpu::TextureUsages::RENDER_ATTACHMENT,
            None => wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        };
        let TargetSizes { tile, shadow } = sizes.unwrap_or(TargetSizes { tile: [1, 1], shadow: 1 });
        let texture = |label, [width, height]: [u32; 2], format| {
            gpu.device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some(label),
                    size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: if format == SEEN { usage | wgpu::TextureUsages::TEXTURE_BINDING } else { usage },
                    view_formats: &[],
                })
                .create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self {
            seen: texture("meshes that are seen", tile, SEEN),
            depth: texture("depth of meshes", tile, DEPTH),
            carrier: texture("size of a shadow map", [shadow; 2], CARRIER),
            bytes: 12 * u64::from(tile[0]) * u64::from(tile[1]) + u64::from(shadow).pow(2),
        }
    }

    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}
