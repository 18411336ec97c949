//! Compute pipelines, and bind groups made of what each pass uses.

use std::collections::HashMap;

use crate::Error;
use crate::device::Gpu;
use crate::shader::{Pass, Store};

struct Pipeline {
    pipeline: wgpu::ComputePipeline,
    bindings: Vec<u32>,
}

/// The passes that one device runs.
pub(crate) struct Pipelines {
    passes: Vec<(Pass, Pipeline)>,
    /// Ways to store keys, one after the other.
    pub stores: Vec<Store>,
}

/// Buffers by binding number.
pub(crate) type Bindings<'a> = HashMap<u32, &'a wgpu::Buffer>;

impl Pipelines {
    /// `wide`: one pass with 64-bit atomics, else two with 32-bit ones.
    pub fn new(gpu: &Gpu, wide: bool) -> Result<Self, Error> {
        let stores = if wide { vec![Store::Wide] } else { vec![Store::High, Store::Low] };
        let mut wanted = vec![Pass::Cull, Pass::Scan, Pass::Shadow];
        wanted.extend([Pass::Classify, Pass::SizeLists, Pass::ResolveFibers, Pass::ResolveCores]);
        wanted.extend(stores.iter().flat_map(|store| [Pass::Fibers(*store), Pass::Cores(*store)]));
        let build = |pass: Pass| {
            let bindings = pass.reflect().map_err(|message| gpu.error(format!("{pass:?}: {message}")))?.bindings;
            let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(pass.entry_point()),
                source: wgpu::ShaderSource::Wgsl(pass.source().into()),
            });
            let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(pass.entry_point()),
                layout: None,
                module: &module,
                entry_point: Some(pass.entry_point()),
                compilation_options: wgpu::PipelineCompilationOptions {
                    zero_initialize_workgroup_memory: matches!(pass, Pass::Cull | Pass::Scan),
                    ..Default::default()
                },
                cache: None,
            });
            Ok((pass, Pipeline { pipeline, bindings }))
        };
        let passes = wanted.into_iter().map(build).collect::<Result<Vec<_>, Error>>()?;
        gpu.finish()?;
        Ok(Self { passes, stores })
    }

    fn get(&self, pass: Pass) -> &Pipeline {
        let found = self.passes.iter().find(|(known, _)| *known == pass);
        &found.expect("every pass of this device was built").1
    }

    /// Records a pass.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pass: Pass,
        bindings: &Bindings,
        timestamps: Option<wgpu::ComputePassTimestampWrites>,
        dispatch: impl FnOnce(&mut wgpu::ComputePass),
    ) {
        let Pipeline { pipeline, bindings: used } = self.get(pass);
        let entries: Vec<_> = used
            .iter()
            .map(|binding| wgpu::BindGroupEntry { binding: *binding, resource: bindings[binding].as_entire_binding() })
            .collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(pass.entry_point()),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.entry_point()),
            timestamp_writes: timestamps,
        });
        compute.set_pipeline(pipeline);
        compute.set_bind_group(0, &group, &[]);
        dispatch(&mut compute);
    }
}
