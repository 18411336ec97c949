//! Compute pipelines, and bind groups made of what each pass uses.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::Error;
use crate::arrays::Arrays;
use crate::device::Gpu;
use crate::shader::{Pass, Store};

struct Pipeline {
    pipeline: wgpu::ComputePipeline,
    bindings: Vec<u32>,
}

/// A pass by what its shader is made of.
type Variant = (Pass, Arrays);

/// The passes that one device runs.
pub(crate) struct Pipelines {
    passes: Mutex<Vec<(Variant, Arc<Pipeline>)>>,
    /// Ways to store keys, one after the other.
    pub stores: Vec<Store>,
}

/// Buffers and textures by binding number.
pub(crate) type Bindings<'a> = HashMap<u32, wgpu::BindingResource<'a>>;

/// The group of those that a pass uses.
pub(crate) fn bind_group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    used: &[u32],
    bindings: &Bindings,
) -> wgpu::BindGroup {
    let entries: Vec<_> = used
        .iter()
        .map(|binding| wgpu::BindGroupEntry { binding: *binding, resource: bindings[binding].clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

impl Pipelines {
    /// `wide`: one pass with 64-bit atomics, else two with 32-bit ones.
    pub fn new(gpu: &Gpu, wide: bool) -> Result<Self, Error> {
        let stores = if wide { vec![Store::Wide] } else { vec![Store::High, Store::Low] };
        let pipelines = Self { passes: Mutex::default(), stores };
        pipelines.ensure(gpu, Arrays::Uniform, &[])?;
        Ok(pipelines)
    }

    /// Builds those of the passes that are not there yet, and those that every picture has.
    pub fn ensure(&self, gpu: &Gpu, arrays: Arrays, wanted: &[Pass]) -> Result<(), Error> {
        let mut all = vec![Pass::Cull, Pass::Scan, Pass::Shadow, Pass::SizeLists];
        all.extend(self.stores.iter().flat_map(|store| [Pass::Fibers(*store), Pass::Cores(*store)]));
        all.extend(wanted);
        let mut passes = self.passes.lock().unwrap_or_else(PoisonError::into_inner);
        for pass in all {
            if !passes.iter().any(|(known, _)| *known == (pass, arrays)) {
                passes.push(((pass, arrays), Arc::new(build(gpu, pass, arrays)?)));
            }
        }
        gpu.finish()
    }

    fn get(&self, pass: Pass, arrays: Arrays) -> Arc<Pipeline> {
        let passes = self.passes.lock().unwrap_or_else(PoisonError::into_inner);
        let found = passes.iter().find(|(known, _)| *known == (pass, arrays));
        Arc::clone(&found.expect("every pass that is drawn was built").1)
    }

    /// Records a pass.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (pass, arrays): Variant,
        bindings: &Bindings,
        timestamps: Option<wgpu::ComputePassTimestampWrites>,
        dispatch: impl FnOnce(&mut wgpu::ComputePass),
    ) {
        let found = self.get(pass, arrays);
        let Pipeline { pipeline, bindings: used } = &*found;
        let group = bind_group(gpu, pass.entry_point(), &pipeline.get_bind_group_layout(0), used, bindings);
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.entry_point()),
            timestamp_writes: timestamps,
        });
        compute.set_pipeline(pipeline);
        compute.set_bind_group(0, &group, &[]);
        dispatch(&mut compute);
    }
}

fn build(gpu: &Gpu, pass: Pass, arrays: Arrays) -> Result<Pipeline, Error> {
    let bindings = pass.reflect(arrays).map_err(|message| gpu.error(format!("{pass:?}: {message}")))?.bindings;
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(pass.entry_point()),
        source: wgpu::ShaderSource::Wgsl(pass.source(arrays).into()),
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
    Ok(Pipeline { pipeline, bindings })
}
