//! A picture: tiles, samples, and the passes of a sample in order.

mod buffers;
mod read_back;
mod shadows;
mod threads;
mod tiles;

pub(crate) use buffers::FrameBuffers;
pub(crate) use shadows::DrawnShadows;

use std::time::{Duration, Instant};

use glam::Vec3;

use self::threads::{core_parts, fold};
use self::tiles::{TileLimits, tiles};
use crate::aov::{FRAME_WORDS, Planes, VECTOR_WORDS};
use crate::arrays::Arrays;
use crate::device::Gpu;
use crate::environment::SkyBuffers;
use crate::layout::{self, NONE};
use crate::lights::{Extent, LightSample};
use crate::mesh_raster::MeshPipelines;
use crate::meshes::{MeshBuffers, MeshPlaces};
use crate::motion::{Moment, Motion, Neighbour};
use crate::noise::Noise;
use crate::pipelines::{Bindings, Pipelines};
use crate::sampling::{PixelFilter, Use, pair, sphere};
use crate::shader::{Background, Film, Pass, Resolve};
use crate::timing::Timer;
use crate::upload::SceneBuffers;
use crate::view::View;
use crate::waiting::Listener;
use crate::{Environment, Error, Image, Occlusion, Progress, Scene, Settings, Statistics};

/// Segments per block of the scan, threads of a visibility workgroup, workgroups in a row: `shaders/passes/work.wgsl`.
pub(crate) const BLOCK: u32 = 256;
pub(crate) const LANES: u32 = 64;
pub(crate) const ROW: u32 = 32768;

/// Directions of the sky that one sample takes at most; as in `shaders/passes/shade.wgsl`.
pub(crate) const MOST_SKY_VIEWS: u32 = 8;

/// Directions of a picture of the sky that a picture takes at least, and one sample of it.
const LEAST_ENVIRONMENT_SUNS: u32 = 16;
const LEAST_ENVIRONMENT_SUNS_A_SAMPLE: u32 = 4;

/// Bits of a visibility key for the place along a segment, and for depth.
const PLACE_BITS: u32 = 10;
const DEPTH_BITS: std::ops::RangeInclusive<u32> = 18..=24;

/// Everything a picture is made of.
pub(crate) struct FrameInput<'a> {
    pub scene: &'a Scene,
    pub settings: &'a Settings,
    pub background: Background,
    pub resolve: Resolve,
    pub planes: Planes,
    pub buffers: &'a SceneBuffers,
    pub motion: &'a Motion<'a>,
    /// The frames before and after, if the vector pass is drawn.
    pub neighbours: Option<&'a [Neighbour; 2]>,
    pub sky: &'a SkyBuffers,
    pub meshes: &'a MeshBuffers,
    /// If there are meshes.
    pub mesh_pipelines: Option<&'a MeshPipelines>,
}

impl FrameInput<'_> {
    /// Directions per sample in which sky or other yarns are seen.
    fn sky_views(&self) -> u32 {
        let is_seen = self.scene.ambient != Vec3::ZERO || self.settings.photons() > 0;
        if !is_seen { 0 } else { self.settings.sky_directions.div_ceil(self.settings.samples) }
    }

    /// The scene's picture of the sky, if any light comes from it.
    fn environment(&self) -> Option<&Environment> {
        self.scene.environment.as_ref().filter(|environment| environment.shines())
    }

    /// Directions of that picture per sample, each a sun of its own.
    fn environment_suns(&self) -> u32 {
        let most = LEAST_ENVIRONMENT_SUNS.div_ceil(self.settings.samples).max(LEAST_ENVIRONMENT_SUNS_A_SAMPLE);
        self.environment().map_or(0, |_| most)
    }

    /// Lights per sample.
    fn light_count(&self) -> u32 {
        self.scene.lights.len() as u32 + self.environment_suns()
    }
}

fn bits_for(count: u32) -> u32 {
    32 - count.saturating_sub(1).leading_zeros()
}

/// What the first sample draws, over all tiles so far.
#[derive(Default)]
struct Work {
    fiber_segments: u64,
    fiber_lines: u64,
}

/// Who waits for a picture.
pub(crate) type PictureListener = Listener<Result<Image, Error>>;

/// Records and runs the passes of one picture.
pub(crate) struct Recorder<'a> {
    gpu: &'a Gpu,
    pipelines: &'a Pipelines,
    listener: &'a PictureListener,
    input: &'a FrameInput<'a>,
    frame: &'a FrameBuffers,
    arrays: Arrays,
    uniform: layout::Frame,
    filter: PixelFilter,
    timer: Timer,
    drawn_shadows: DrawnShadows,
    work: Work,
    /// What the sample sees.
    moment: Moment,
    mesh_places: MeshPlaces,
    /// That of the first sample, without jitter and lens.
    first_view: View,
}

impl<'a> Recorder<'a> {
    pub fn new(
        gpu: &'a Gpu,
        pipelines: &'a Pipelines,
        listener: &'a PictureListener,
        input: &'a FrameInput<'a>,
        frame: &'a FrameBuffers,
        moment: Moment,
        kept_shadows: Option<DrawnShadows>,
    ) -> Result<Self, Error> {
        let FrameInput { scene, settings, planes, buffers, meshes, .. } = input;
        let draws = &moment.draws;
        if frame.views() > threads::MOST_LAYERS {
            let reason = format!("they have {} shadow maps, more than {}", frame.views(), threads::MOST_LAYERS);
            return Err(Error::input("lights", reason));
        }
        let slot_bits = bits_for(draws.most_slots);
        let depth_bits = (64 - PLACE_BITS - slot_bits - bits_for(draws.segment_count)).min(*DEPTH_BITS.end());
        if depth_bits < *DEPTH_BITS.start() {
            return Err(Error::input(
                "scene",
                format!(
                    "{} control points (instances counted each) with up to {} fibers are too many for one picture",
                    draws.segment_count, draws.most_slots
                ),
            ));
        }
        let background = scene.ambient;
        let mesh_places = meshes.place(scene, &moment.mesh_transforms, moment.view.origin);
        let depths = &frame.shadow_depths;
        let drawn_shadows = DrawnShadows::of(kept_shadows, depths, &meshes.positions, buffers, draws, &mesh_places);
        let mut recorder = Self {
            gpu,
            pipelines,
            listener,
            input,
            frame,
            arrays: frame.arrays(gpu, input.buffers),
            uniform: layout::Frame {
                segment_count: draws.segment_count,
                draw_count: draws.items.len() as u32,
                slot_bits,
                place_bits: PLACE_BITS,
                depth_bits,
                lod_pixels: settings.lod_pixels,
                light_count: input.light_count(),
                occlusion_table: u32::from(settings.occlusion == Occlusion::Table),
                ambient: scene.ambient,
                shadow_resolution: frame.shadow_resolution(),
                background,
                opaque_background: u32::from(!settings.transparent),
                // From one end of the filter, where the sample that culls may be, to the other.
                cull_margin: settings.filter_width,
                plane_position: planes.position,
                plane_uv: planes.uv,
                plane_vector: planes.vector,
                plane_matte: planes.matte,
                plane_albedo: planes.albedo,
                plane_diffuse: planes.diffuse,
                plane_specular: planes.specular,
                plane_transmission: planes.transmission,
                plane_scattered: planes.scattered,
                plane_ambient: planes.ambient,
                plane_shadow: planes.shadow,
                ..Default::default()
            },
            filter: PixelFilter::new(settings.filter, settings.filter_width),
            timer: Timer::new(gpu),
            drawn_shadows,
            work: Work::default(),
            first_view: moment.view,
            moment,
            mesh_places,
        };
        recorder.show();
        Ok(recorder)
    }

    /// From now on samples see the moment.
    fn show(&mut self) {
        let Moment { view, draws, mesh_transforms } = &self.moment;
        let (depth_min, depth_max) = if draws.bounds.is_empty() { (0.0, 1.0) } else { view.depth_range(&draws.bounds) };
        self.gpu.queue.write_buffer(&self.frame.draws, 0, bytemuck::cast_slice(&draws.items));
        self.mesh_places = self.input.meshes.place(self.input.scene, mesh_transforms, view.origin);
        let items = bytemuck::cast_slice(&self.mesh_places.items);
        self.gpu.queue.write_buffer(&self.frame.mesh_draws, 0, items);
        self.uniform = layout::Frame {
            pixels_per_unit: view.pixels_per_unit as f32,
            depth_min: depth_min as f32,
            depth_scale: (1.0 / (depth_max - depth_min)) as f32,
            near: view.near as f32,
            least_w: if view.orthographic { 1.0 } else { view.near as f32 },
            ..self.uniform
        };
    }

    /// Moves knots, meshes and camera to the time of a sample.
    fn move_to(&mut self, time: f64) -> Result<(), Error> {
        let FrameInput { motion, buffers, meshes, .. } = *self.input;
        self.moment = motion.at(buffers, time)?;
        self.drawn_shadows.forget();
        self.show();
        let (step, share) = motion.step(time);
        meshes.deform(self.gpu, step, share);
        if let Some([earlier, later]) = motion.shapes.get(step..step + 2) {
            let knots = buffers.knot_count();
            let numbers = [knots, (share as f32).to_bits(), 0, 0];
            self.gpu.queue.write_buffer(&self.frame.pass_uniform, 0, bytemuck::cast_slice(&numbers));
            let mut encoder = self.encoder();
            let (x, y) = fold(knots.div_ceil(LANES));
            let bound =
                [(41, earlier.knots.binding()), (42, later.knots.binding()), (43, buffers.shape.knots.binding())];
            self.record_with(&mut encoder, Pass::MoveKnots, &bound, |pass| pass.dispatch_workgroups(x, y, 1));
            self.timer.resolve(&mut encoder);
            self.gpu.submit(encoder);
        }
        Ok(())
    }

    fn bindings(&self) -> Bindings<'a> {
        let (scene, frame) = (self.input.buffers, self.frame);
        let buffers: [(u32, &wgpu::Buffer); 27] = [
            (0, &frame.uniform),
            (1, &frame.draws),
            (2, &scene.curves),
            (6, &scene.tables.yarns),
            (7, &scene.tables.materials),
            (9, &frame.lights),
            (10, &frame.views),
            (11, &frame.shadow_depths),
            (12, &frame.segment_work),
            (13, &frame.block_work),
            (14, &frame.dispatch),
            (15, &frame.keys),
            (16, &frame.pass_uniform),
            (17, &frame.film[0]),
            (18, &frame.film[1]),
            (19, &frame.film[2]),
            (20, &frame.pixel_list),
            (21, &frame.resolve_dispatch),
            (30, &self.input.sky.sky),
            (31, &self.input.sky.texels),
            (32, &frame.meshes),
            (33, &frame.mesh_draws),
            (34, &self.input.meshes.positions),
            (35, &self.input.meshes.corners),
            (36, &self.input.meshes.normals),
            (38, &self.input.meshes.texels),
            (40, &frame.aovs),
        ];
        let mut bindings: Bindings = buffers.map(|(number, buffer)| (number, buffer.as_entire_binding())).into();
        bindings.extend([
            (3, scene.shape.knots.binding()),
            (4, scene.rest_knots.binding()),
            (5, scene.knot_curves.binding()),
            (8, scene.tables.words.binding()),
            (37, wgpu::BindingResource::TextureView(&frame.mesh_targets.seen)),
        ]);
        bindings
    }

    /// Draws a region: left, top, width, height.
    pub fn picture(&mut self, region: [u32; 4]) -> Result<Image, Error> {
        let [left, top, width, height] = region;
        let count = width as usize * height as usize;
        let mut image = Image {
            size: [width, height],
            combined: vec![[0.0; 4]; count],
            depth: vec![Image::EMPTY_DEPTH; count],
            normal: vec![[0.0; 3]; count],
            tangent: vec![[0.0; 3]; count],
            object_id: vec![0; count],
            aovs: Vec::new(),
            statistics: Statistics::default(),
        };
        let wanted = &self.input.settings.aovs;
        image.aovs = wanted.iter().map(|aov| (*aov, vec![0.0; aov.channels() * count])).collect();
        let tiles = tiles(region, TileLimits::new(self.gpu, &self.input.planes));
        let samples = self.input.settings.samples;
        let (start, mut fewest) = (Instant::now(), samples);
        let total = samples.saturating_mul(tiles.len() as u32);
        for (number, tile) in tiles.iter().enumerate() {
            let deadline = self.input.settings.time_limit_s.map(|limit| {
                let share = (number + 1) as f64 / tiles.len() as f64;
                start + Duration::from_secs_f64((limit * share).min(1e9))
            });
            let mut noise = Noise::new(self.input.settings.noise_threshold);
            let mut drawn = 0;
            for sample in 0..samples {
                self.sample(*tile, sample)?;
                drawn = sample + 1;
                let done = (number as u32).saturating_mul(samples).saturating_add(sample + 1);
                self.listener.report(Progress::Samples { done, total })?;
                let is_late = deadline.is_some_and(|deadline| Instant::now() >= deadline);
                let film = || self.read(&[(&self.frame.film[0], 16 * u64::from(tile[2]) * u64::from(tile[3]))]);
                if is_late || (drawn < samples && noise.wants(drawn) && noise.is_low(drawn, &film()?)) {
                    break;
                }
            }
            fewest = fewest.min(drawn);
            self.read_tile(*tile, [left, top], drawn, &mut image)?;
        }
        image.statistics = Statistics {
            samples: fewest,
            adapter: self.gpu.info.name.clone(),
            segments: self.moment.draws.real_segments,
            fiber_segments: self.work.fiber_segments,
            fiber_lines: self.work.fiber_lines,
            knot_bytes: self.input.buffers.knot_bytes() + self.frame.segment_work.size(),
            gpu_bytes: self.input.buffers.knot_bytes()
                + self.input.buffers.tables.bytes()
                + self.input.sky.bytes()
                + self.input.meshes.bytes()
                + self.frame.bytes(),
            passes: self.timer.totals(),
            uploaded_bytes: self.input.buffers.uploaded_bytes,
        };
        Ok(image)
    }

    /// One sample of a tile: jittered, and through a point of the lens. What can be seen through the whole lens would be culled by a wide
    /// margin, which blurred foreground makes larger than the picture: with a lens, each sample culls for itself.
    fn sample(&mut self, tile: [u32; 4], index: u32) -> Result<(), Error> {
        self.listener.check()?;
        let FrameInput { scene, settings, motion, .. } = *self.input;
        let [left, top, width, height] = tile;
        let number = settings.first_sample.wrapping_add(index);
        let pair = |index, of| pair(index, settings.seed, of);
        if motion.is_moving() {
            self.move_to(pair(number, Use::Time)[0])?;
        }
        let view = self.moment.view;
        if index == 0 {
            self.first_view = view;
        }
        let jitter = if number == 0 { [0.0; 2] } else { self.filter.offset(pair(number, Use::Pixel)) };
        let seen = match &view.lens {
            Some(lens) => view.through(lens, lens.point(pair(number, Use::Lens))),
            None => view,
        };
        self.uniform.origin = [left, top];
        self.uniform.size = [width, height];
        self.uniform.core_parts = core_parts(self.input, &self.moment.draws, width + height);
        self.uniform.sample_index = number;
        self.uniform.first = u32::from(index == 0);
        self.uniform.pixel_from_render = seen.pixel_from_render(jitter);
        self.uniform.viewer = seen.viewer;

        let extent = Extent::new(self.moment.draws.bounds, self.mesh_places.bounds);
        let mut meshes = self.meshes();
        if !extent.is_empty() {
            let resolution = self.frame.shadow_resolution();
            let mut lights = LightSample::new(&scene.lights, view.origin, extent, resolution, number, settings.seed);
            let sky_views = self.input.sky_views();
            (self.uniform.sky_view, self.uniform.sky_view_count) = (lights.views.len() as u32, sky_views);
            let first = number.wrapping_mul(sky_views);
            let sky = |view| sphere(pair(first.wrapping_add(view), Use::Sky));
            (0..sky_views).for_each(|view| lights.add_sky(sky(view)));
            if !extent.wide.is_empty() {
                meshes.wide_sky_view = lights.views.len() as u32;
                (0..sky_views).for_each(|view| lights.add_wide_sky(sky(view)));
            }
            if let Some(environment) = self.input.environment() {
                let count = self.input.environment_suns();
                for sun in 0..count {
                    let uniform = pair(number.wrapping_mul(count).wrapping_add(sun), Use::Environment);
                    lights.add_environment(environment, uniform, 1.0 / f64::from(count));
                }
            }
            self.gpu.queue.write_buffer(&self.frame.lights, 0, bytemuck::cast_slice(&lights.lights));
            self.gpu.queue.write_buffer(&self.frame.views, 0, bytemuck::cast_slice(&lights.views));
            self.gpu.queue.write_buffer(&self.frame.meshes, 0, bytemuck::bytes_of(&meshes));
            self.write_uniform();
            self.shadows(&lights.views)?;
            self.listener.check()?;
        } else {
            self.write_uniform();
        }
        let cull = index == 0 || view.lens.is_some() || motion.is_moving();
        self.visibility(cull);
        // A software driver takes its time for either half, and the picture may be stopped between them.
        self.gpu.finish()?;
        self.listener.check()?;
        self.resolve(width, height);
        if index == 0
            && let Some(neighbours) = self.input.neighbours
        {
            self.follow(neighbours, width * height);
        }
        self.gpu.finish()?;
        self.timer.collect(self.gpu)?;
        if cull {
            let work = self.check_work()?;
            if index == 0 {
                self.work.fiber_segments += work.fiber_segments;
                self.work.fiber_lines += work.fiber_lines;
            }
        }
        Ok(())
    }

    /// The shadow maps that another picture of the same may take.
    pub fn into_shadows(self) -> Option<DrawnShadows> {
        (!self.input.motion.is_moving()).then_some(self.drawn_shadows)
    }

    /// What the passes of a sample know of all meshes.
    fn meshes(&self) -> layout::Meshes {
        let MeshPlaces { items, bounds, .. } = &self.mesh_places;
        let clip_depth = if bounds.is_empty() { [0.0, 0.0] } else { self.moment.view.clip_depth(bounds) };
        layout::Meshes { clip_depth, draw_count: items.len() as u32, wide_sky_view: NONE }
    }

    fn write_uniform(&self) {
        self.gpu.queue.write_buffer(&self.frame.uniform, 0, bytemuck::bytes_of(&self.uniform));
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("sample") })
    }

    /// Cull and scan if asked for, visibility.
    fn visibility(&mut self, cull: bool) {
        let mut encoder = self.encoder();
        if self.uniform.segment_count > 0 {
            if cull {
                let (x, y) = fold(self.uniform.segment_count.div_ceil(BLOCK));
                encoder.clear_buffer(&self.frame.dispatch, 0, None);
                self.record(&mut encoder, Pass::Cull, |pass| pass.dispatch_workgroups(x, y, 1));
                self.record(&mut encoder, Pass::Scan, |pass| pass.dispatch_workgroups(1, 1, 1));
            }
            encoder.clear_buffer(&self.frame.keys, 0, None);
            let (x, y) = fold(self.uniform.segment_count.div_ceil(LANES));
            let parts = self.uniform.core_parts;
            for store in self.pipelines.stores.clone() {
                self.record(&mut encoder, Pass::Cores(store), |pass| pass.dispatch_workgroups(x, y, parts));
                let arguments = &self.frame.dispatch;
                self.record(&mut encoder, Pass::Fibers(store), |pass| pass.dispatch_workgroups_indirect(arguments, 0));
            }
        } else {
            encoder.clear_buffer(&self.frame.keys, 0, None);
        }
        if let Some(pipelines) = self.input.mesh_pipelines {
            let (bindings, triangles) = (self.bindings(), self.input.meshes.triangle_count());
            let (targets, size) = (&self.frame.mesh_targets, self.uniform.size);
            pipelines.record_visibility(self.gpu, &mut encoder, &bindings, targets, size, triangles);
        }
        self.timer.resolve(&mut encoder);
        self.gpu.submit(encoder);
    }

    /// What is seen gets its colour.
    fn resolve(&mut self, width: u32, height: u32) {
        let mut encoder = self.encoder();
        encoder.clear_buffer(&self.frame.resolve_dispatch, 0, None);
        let resolve = self.input.resolve;
        if resolve.film == Film::Aovs && self.uniform.first == 1 {
            encoder.clear_buffer(&self.frame.aovs, 0, None);
        }
        let (x, y) = fold((width * height).div_ceil(LANES));
        self.record(&mut encoder, Pass::Classify(self.input.background), |pass| pass.dispatch_workgroups(x, y, 1));
        if !self.input.meshes.is_empty() {
            self.record(&mut encoder, Pass::ResolveMeshes(resolve), |pass| pass.dispatch_workgroups(x, y, 1));
        }
        if self.uniform.segment_count > 0 {
            let arguments = &self.frame.resolve_dispatch;
            self.record(&mut encoder, Pass::SizeLists, |pass| pass.dispatch_workgroups(1, 1, 1));
            self.record(&mut encoder, Pass::ResolveFibers(resolve), |pass| {
                pass.dispatch_workgroups_indirect(arguments, 0)
            });
            self.record(&mut encoder, Pass::ResolveCores(resolve), |pass| {
                pass.dispatch_workgroups_indirect(arguments, 16)
            });
        }
        self.timer.resolve(&mut encoder);
        self.gpu.submit(encoder);
    }

    /// Where the yarns' points of the first sample are in this frame and in those before and after, all without jitter and lens.
    fn follow(&mut self, [before, after]: &'a [Neighbour; 2], pixels: u32) {
        let kept = self.uniform;
        let [here_word, before_word, after_word] = FRAME_WORDS;
        // What is seen is before the camera; it stays there where it is not in another frame.
        let view = self.first_view;
        self.follow_to(&view, f32::MIN, [here_word, VECTOR_WORDS], &[], pixels);
        for (neighbour, words) in [(before, [before_word, after_word]), (after, [after_word, VECTOR_WORDS])] {
            let bound = [(1, neighbour.draws.as_entire_binding()), (3, neighbour.shape.knots.binding())];
            let view = &neighbour.moment.view;
            self.follow_to(view, view.near as f32, words, &bound, pixels);
        }
        self.uniform = kept;
    }

    /// The same in one frame; `words` are the first that it writes, and the end.
    fn follow_to(
        &mut self,
        view: &View,
        near: f32,
        words: [u32; 2],
        bound: &[(u32, wgpu::BindingResource)],
        pixels: u32,
    ) {
        self.uniform.pixel_from_render = view.pixel_from_render([0.0; 2]);
        self.uniform.near = near;
        [self.uniform.frame_word, self.uniform.frame_word_end] = words;
        self.write_uniform();
        let mut encoder = self.encoder();
        let (x, y) = fold(pixels.div_ceil(LANES));
        self.record_with(&mut encoder, Pass::Follow, bound, |pass| pass.dispatch_workgroups(x, y, 1));
        self.timer.resolve(&mut encoder);
        self.gpu.submit(encoder);
    }

    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: Pass,
        dispatch: impl FnOnce(&mut wgpu::ComputePass),
    ) {
        self.record_with(encoder, pass, &[], dispatch);
    }

    /// The same with some buffers and textures in place of the usual ones.
    fn record_with(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: Pass,
        bound: &[(u32, wgpu::BindingResource)],
        dispatch: impl FnOnce(&mut wgpu::ComputePass),
    ) {
        let (mut bindings, gpu, pipelines) = (self.bindings(), self.gpu, self.pipelines);
        bindings.extend(bound.iter().cloned());
        let timestamps = self.timer.begin(pass.entry_point());
        pipelines.record(gpu, encoder, (pass, self.arrays), &bindings, timestamps, dispatch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_hold_the_largest_index() {
        for (count, bits) in [(1, 0), (2, 1), (3, 2), (256, 8), (257, 9)] {
            assert_eq!(bits_for(count), bits);
        }
    }
}
