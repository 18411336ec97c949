//! Depth maps of the lights: which are drawn anew, and in how many steps.

use std::ops::Range;
use std::time::{Duration, Instant};

use super::threads::{fold, nearest_w, parts, parts_within};
use super::{LANES, Recorder};
use crate::meshes::MeshPlaces;
use crate::shader::Pass;
use crate::upload::{Draws, SceneBuffers};
use crate::{Error, layout};

/// What a step takes at most, if one map does: a picture may be stopped between steps.
const STEP: Duration = Duration::from_millis(20);

/// All that the maps hang on besides their views.
#[derive(Clone, PartialEq, Eq)]
struct Casters {
    depths: wgpu::Buffer,
    curves: wgpu::Buffer,
    revision: u64,
    yarns: wgpu::Buffer,
    mesh_positions: wgpu::Buffer,
    /// Instances of yarns and of meshes.
    items: [Vec<u8>; 2],
}

/// Maps that are drawn, by their number. A strip of a picture, or its next samples, need not draw them again.
pub(crate) struct DrawnShadows {
    casters: Casters,
    views: Vec<layout::ShadowView>,
}

impl DrawnShadows {
    /// The kept ones, unless anything has changed that they show.
    pub(super) fn of(
        kept: Option<Self>,
        depths: &wgpu::Buffer,
        mesh_positions: &wgpu::Buffer,
        buffers: &SceneBuffers,
        draws: &Draws,
        meshes: &MeshPlaces,
    ) -> Self {
        let casters = Casters {
            depths: depths.clone(),
            curves: buffers.curves.clone(),
            revision: buffers.revision,
            yarns: buffers.tables.yarns.clone(),
            mesh_positions: mesh_positions.clone(),
            items: [bytemuck::cast_slice(&draws.items).to_vec(), bytemuck::cast_slice(&meshes.items).to_vec()],
        };
        let views = kept.filter(|kept| kept.casters == casters).map_or(Vec::new(), |kept| kept.views);
        Self { casters, views }
    }

    /// What they show has moved.
    pub(super) fn forget(&mut self) {
        self.views.clear();
    }

    fn has(&self, number: usize, view: &layout::ShadowView) -> bool {
        self.views.get(number).is_some_and(|drawn| bytemuck::bytes_of(drawn) == bytemuck::bytes_of(view))
    }

    fn add(&mut self, numbers: Range<usize>, views: &[layout::ShadowView]) {
        self.views.resize(self.views.len().max(numbers.end), layout::ShadowView::default());
        self.views[numbers.clone()].copy_from_slice(&views[numbers]);
    }
}

impl Recorder<'_> {
    /// Draws the maps of a sample that are not there already.
    pub(super) fn shadows(&mut self, views: &[layout::ShadowView]) -> Result<(), Error> {
        let (mut first, mut most) = (0, 1);
        while first < views.len() {
            if self.drawn_shadows.has(first, &views[first]) {
                first += 1;
                continue;
            }
            let others = views[first..].iter().enumerate().take(most);
            let count = others.take_while(|(i, view)| !self.drawn_shadows.has(first + i, view)).count();
            let start = Instant::now();
            self.draw_shadows(&views[first..first + count], first as u32);
            self.drawn_shadows.add(first..first + count, views);
            first += count;
            if first < views.len() {
                self.gpu.finish()?;
                self.listener.check()?;
                let each = start.elapsed().as_secs_f64() / count as f64;
                most = ((STEP.as_secs_f64() / each) as usize).max(1);
            }
        }
        Ok(())
    }

    /// Maps of these views, `first` being the number of the first.
    fn draw_shadows(&mut self, views: &[layout::ShadowView], first: u32) {
        let count = views.len() as u32;
        let resolution = f64::from(self.frame.shadow_resolution());
        let draws = &self.moment.draws;
        let radius = |view: &layout::ShadowView| draws.radius_max * f64::from(view.texels_per_unit) / nearest_w(view);
        let radius = views.iter().map(radius).fold(0.0, f64::max).min(resolution);
        let parts = parts(draws.slenderness * radius, 2.0 * radius + 2.0, 8.0, 2.0 * resolution);
        let parts = parts_within(parts, count);
        self.gpu.queue.write_buffer(&self.frame.pass_uniform, 0, bytemuck::cast_slice(&[first, parts, 0, 0]));
        let mut encoder = self.encoder();
        let bytes = 4 * u64::from(self.frame.shadow_resolution()).pow(2);
        encoder.clear_buffer(&self.frame.shadow_depths, bytes * u64::from(first), Some(bytes * u64::from(count)));
        if self.uniform.segment_count > 0 {
            let (x, y) = fold(self.uniform.segment_count.div_ceil(LANES));
            self.record(&mut encoder, Pass::Shadow, |pass| pass.dispatch_workgroups(x, y, count * parts));
        }
        if let Some(pipelines) = self.input.mesh_pipelines {
            let numbers = views.iter().enumerate().map(|(i, view)| (first + i as u32, view.side as u32));
            let (bindings, triangles) = (self.bindings(), self.input.meshes.triangle_count());
            let targets = &self.frame.mesh_targets;
            pipelines.record_shadows(self.gpu, &mut encoder, &bindings, targets, numbers, triangles);
        }
        self.timer.resolve(&mut encoder);
        self.gpu.submit(encoder);
    }
}
