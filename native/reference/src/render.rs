//! Samples in order, pixels in parallel.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use lisle_core::sampling::{Filter, PixelFilter, Random};
use lisle_core::scene::{Mesh, MeshKind, Object, Scene};
use lisle_core::view::View;
use rayon::prelude::*;

use crate::assembly::Ray;
use crate::film::{EMPTY_DEPTH, Film, Pixel, Sample};
use crate::material::NearField;
use crate::shutter::Shutter;
use crate::world::{Met, World};
use crate::{Error, Settings};

/// Time after which no work is begun before the progress callback has been called.
const BREATH: Duration = Duration::from_millis(50);

/// Neighbouring pixels that a thread takes at once.
const BLOCK: usize = 16;

/// A scene with all its fibers, ready to be drawn.
pub struct Reference {
    shutter: Shutter,
    /// That of the first sample, and of all if nothing moves.
    middle: Moment,
    filter: PixelFilter,
    settings: Settings,
    region: [u32; 4],
    digest: u64,
}

/// What is seen at the time of a sample, and from where.
struct Moment {
    sample: u32,
    world: Arc<World>,
    view: View,
}

impl Reference {
    /// Checks scene and settings, makes the fibers and finds a hierarchy for them. `progress` is called several times a second and can
    /// stop the work.
    ///
    /// # Errors
    /// [`Error`] for whatever cannot be drawn; [`Error::Cancelled`].
    pub fn new(
        scene: &Scene,
        settings: &Settings,
        progress: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Self, Error> {
        Self::exposed(std::slice::from_ref(scene), settings, progress)
    }

    /// The same of a scene at even steps from when the shutter opens to when it closes, at least one. Objects correspond by their order,
    /// and their yarns by their rest shape: [`lisle_core::Yarns::with_points`]. Yarns, objects and camera move evenly between steps; all
    /// else is as at the first. Where more than the camera moves, fibers and hierarchy are made anew for each sample.
    ///
    /// # Errors
    /// As [`new`](Self::new), and for steps that are not of one scene.
    pub fn exposed(
        steps: &[Scene],
        settings: &Settings,
        progress: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Self, Error> {
        let region = settings.check()?;
        let shutter = Shutter::new(steps)?;
        let scene = shutter.at(0, settings.seed)?;
        let view = View::new(&scene.camera, settings.size)?;
        let world = World::new(&scene, settings.shading, settings.chord_error, progress)?;
        let digest = digest(shutter.steps(), settings, &world, progress)?;
        let filter = PixelFilter::new(Filter::default(), settings.filter_width);
        let middle = Moment { sample: 0, world: Arc::new(world), view };
        Ok(Self { shutter, middle, filter, settings: settings.clone(), region, digest })
    }

    /// Has all fibers scatter by another function: for comparisons with other renderers, of a scene in which nothing moves.
    #[doc(hidden)]
    #[must_use]
    pub fn with_near_field(mut self, function: Arc<dyn NearField>) -> Self {
        if let Some(world) = Arc::get_mut(&mut self.middle.world) {
            world.scatter_by(&function);
        }
        self
    }

    /// What is seen at the time of a sample.
    fn moment(&self, sample: u32, progress: &mut dyn FnMut() -> ControlFlow<()>) -> Result<Moment, Error> {
        let scene = self.shutter.at(sample, self.settings.seed)?;
        let view = View::new(&scene.camera, self.settings.size)?;
        let Settings { shading, chord_error, .. } = self.settings;
        let world = if self.shutter.moves_objects() {
            Arc::new(World::new(&scene, shading, chord_error, progress)?)
        } else {
            Arc::clone(&self.middle.world)
        };
        Ok(Moment { sample, world, view })
    }

    /// Round cones of all fibers, and bytes of them, all meshes, and their hierarchies.
    pub fn extent(&self) -> (usize, usize) {
        let World { assembly, surfaces, .. } = &*self.middle.world;
        (assembly.segments(), assembly.bytes() + surfaces.bytes())
    }

    /// A film without samples.
    pub fn film(&self) -> Film {
        let [_, _, width, height] = self.region;
        let pixels = vec![Pixel::default(); width as usize * height as usize];
        Film { size: [width, height], samples: self.settings.samples, digest: self.digest, done: 0, pixels }
    }

    /// Adds the samples that a film lacks. `progress` is called some twenty times a second and can stop the work: the film then holds what
    /// is done, and another call, in this process or another, ends in the same bits as one without the stop.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Checkpoint`] for a film of another picture.
    pub fn render(&self, film: &mut Film, progress: &mut dyn FnMut(&Film) -> ControlFlow<()>) -> Result<(), Error> {
        let [_, _, width, height] = self.region;
        if film.digest != self.digest || film.size != [width, height] {
            return Err(Error::Checkpoint("is of another scene, or of other settings"));
        }
        if film.done > film.pixels.len() as u64 * u64::from(self.settings.samples) {
            return Err(Error::Checkpoint("has more samples than are asked for"));
        }
        film.samples = self.settings.samples;
        let mut moved = None;
        while !film.is_done() {
            let sample = (film.done / film.pixels.len() as u64) as u32;
            if self.shutter.is_moving() && moved.as_ref().is_none_or(|moment: &Moment| moment.sample != sample) {
                // One at a time: each holds all fibers.
                drop(moved.take());
                moved = Some(self.moment(sample, &mut || progress(film))?);
            }
            let start = Instant::now();
            self.add_while(moved.as_ref().unwrap_or(&self.middle), film, || start.elapsed() < BREATH);
            if progress(film).is_break() {
                return Err(Error::Cancelled);
            }
        }
        Ok(())
    }

    /// Adds one sample to the next pixels of a film, block by block, each begun if `go_on()`; those of one sample number at most.
    fn add_while(&self, moment: &Moment, film: &mut Film, mut go_on: impl FnMut() -> bool + Send) {
        let count = film.pixels.len() as u64;
        let (sample, first) = ((film.done / count) as u32, (film.done % count) as usize);
        let blocks = film.pixels[first..].chunks_mut(BLOCK).zip((first..).step_by(BLOCK));
        // Blocks are begun in order, and those that are begun are finished: what is done is without gaps.
        let begun = blocks.enumerate().take_while(|(number, _)| *number == 0 || go_on()).par_bridge();
        let done = begun.map(|(_, (pixels, place))| {
            pixels.iter_mut().zip(place..).for_each(|(pixel, place)| self.add(moment, place, sample, pixel));
            pixels.len() as u64
        });
        film.done += done.sum::<u64>();
    }

    /// Adds one sample to the pixel at a place of the region.
    fn add(&self, moment: &Moment, place: usize, sample: u32, pixel: &mut Pixel) {
        let [left, top, width, _] = self.region;
        let (x, y) = (left + place as u32 % width, top + place as u32 / width);
        let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let Moment { world, view, .. } = moment;
        if sample == 0 {
            let met = moment.meet(view, center);
            (pixel.depth, pixel.object_id) = met.map_or((EMPTY_DEPTH, 0), |(_, met, depth)| match met {
                Met::Fiber(hit) => (depth, world.object_id(hit.segment)),
                Met::Surface(hit) => match world.surfaces.mesh(&hit) {
                    Mesh { kind: MeshKind::Holdout, .. } => (EMPTY_DEPTH, 0),
                    mesh => (depth, mesh.id),
                },
            });
        }
        // By the pixel's place in the frame: a region has the same noise as the whole.
        let number = u64::from(y) * u64::from(self.settings.size[0]) + u64::from(x);
        let mut random = Random::new(self.settings.seed, number, sample);
        let offset = self.filter.offset(random.pair());
        let place = [center[0] + offset[0], center[1] + offset[1]];
        let view = match &view.lens {
            Some(lens) => view.through(lens, lens.point(random.pair())),
            None => *view,
        };
        let background = || world.background(view.ray(place).1.normalize());
        let Some((ray, met, _)) = moment.meet(&view, place) else {
            if !self.settings.transparent {
                let radiance = background().to_array();
                pixel.add(&Sample { radiance, alpha: 1.0, ..Sample::default() });
            }
            return;
        };
        let (normal, tangent) = match &met {
            Met::Fiber(hit) if world.is_holdout(hit.segment) => return,
            Met::Fiber(hit) => {
                let surface = world.assembly.surface(&ray, hit);
                (surface.normal, surface.tangent)
            }
            Met::Surface(hit) => {
                let normal = world.surfaces.face(&ray, hit).normal;
                match world.surfaces.mesh(hit).kind {
                    MeshKind::Holdout => return,
                    MeshKind::ShadowCatcher => {
                        let shadow = world.shadow(&ray, &met, &mut random);
                        let (radiance, alpha) = if self.settings.transparent {
                            (DVec3::ZERO, shadow)
                        } else {
                            (background() * (1.0 - shadow), 1.0)
                        };
                        let [radiance, normal] = [radiance, normal].map(|v| v.to_array());
                        return pixel.add(&Sample { radiance, alpha, normal, ..Sample::default() });
                    }
                    MeshKind::Shaded => (normal, DVec3::ZERO),
                }
            }
        };
        pixel.add(&Sample {
            radiance: world.radiance(&ray, &met, self.settings.bounces, &mut random).to_array(),
            alpha: 1.0,
            normal: normal.to_array(),
            tangent: tangent.to_array(),
        });
    }
}

impl Moment {
    /// What a view shows at a place on the frame: the ray, what it meets, and its depth.
    fn meet(&self, view: &View, place: [f64; 2]) -> Option<(Ray, Met, f64)> {
        let (at_zero, per_depth) = view.ray(place);
        let length = per_depth.length();
        let near = view.near;
        let origin = at_zero + per_depth * near + view.origin - self.world.origin;
        let ray = Ray { origin, direction: per_depth / length };
        let met = self.world.nearest(&ray, (view.far - near) * length)?;
        let depth = near + met.t() / length;
        Some((ray, met, depth))
    }
}

/// Tells pictures apart: everything but the number of samples.
fn digest(
    steps: &[Scene],
    settings: &Settings,
    world: &World,
    progress: &mut dyn FnMut() -> ControlFlow<()>,
) -> Result<u64, Error> {
    /// Values between two calls of the progress callback.
    const VALUES: usize = 1 << 24;

    let Settings { size, region, seed, bounces, shading, transparent, filter_width, .. } = settings;
    let settings = format!("{size:?} {region:?} {seed} {bounces:?} {shading:?} {transparent} {filter_width}");
    let scene = &steps[0];
    let sky = scene.environment.as_ref();
    let turned = sky.map(|sky| (sky.image.size(), sky.world_from_environment, sky.strength));
    let of = |object: &Object| (object.id, Arc::clone(&object.material), object.is_holdout);
    let objects: Vec<_> = scene.objects.iter().map(of).collect();
    let mut text = format!(
        "{settings} {objects:?} {turned:?} {:?} {:?} {:?} {:?}",
        scene.lights, scene.ambient, scene.camera, world.origin
    );
    for mesh in &scene.meshes {
        let Mesh { id, base_color, kind, world_from_object, .. } = mesh;
        text += &format!(" {id} {base_color} {kind:?} {world_from_object}");
    }
    for step in &steps[1..] {
        let places: Vec<_> = step.objects.iter().map(|object| object.world_from_object).collect();
        text += &format!(" {:?} {places:?}", step.camera);
    }
    // FNV-1a, 64 bits, over words where there are many.
    let step = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    let mut hash = text.bytes().map(u64::from).fold(0xcbf2_9ce4_8422_2325, step);
    let texels = sky.iter().flat_map(|sky| sky.image.radiance().iter().flatten());
    hash = texels.map(|value| u64::from(value.to_bits())).fold(hash, step);
    let moving = steps[1..].iter().flat_map(|step| &step.objects).map(|object| object.yarns.points().as_flattened());
    let positions = scene.meshes.iter().map(|mesh| mesh.triangles.positions().as_flattened());
    let normals = scene.meshes.iter().filter_map(|mesh| mesh.triangles.normals());
    let normals = normals.map(|normals| normals.as_flattened().as_flattened());
    let all = [world.assembly.points().as_flattened()].into_iter().chain(moving).chain(positions).chain(normals);
    for values in all.flat_map(|values| values.chunks(VALUES)) {
        hash = values.iter().map(|value| u64::from(value.to_bits())).fold(hash, step);
        if progress().is_break() {
            return Err(Error::Cancelled);
        }
    }
    let corners = scene.meshes.iter().flat_map(|mesh| mesh.triangles.triangles().as_flattened());
    hash = corners.map(|corner| u64::from(*corner)).fold(hash, step);
    Ok(hash)
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, Vec3};
    use lisle_core::scene::Camera;

    use super::*;

    fn nothing(size: [u32; 2]) -> Reference {
        let camera = Camera {
            world_from_camera: DMat4::IDENTITY,
            clip_from_camera: DMat4::from_scale(glam::DVec3::new(1.0, 1.0, -0.1)),
            lens: None,
        };
        let scene =
            Scene { objects: vec![], meshes: vec![], lights: vec![], ambient: Vec3::ONE, environment: None, camera };
        let settings = Settings { size, transparent: false, samples: 2, ..Settings::default() };
        Reference::new(&scene, &settings, &mut || ControlFlow::Continue(())).expect("a scene")
    }

    /// However many threads there are, and whatever a block costs.
    #[test]
    fn once_it_is_told_to_stop_no_block_is_begun() {
        let reference = nothing([64, 32]);
        let mut film = reference.film();
        for allowed in [3, 0, 40] {
            let (before, mut asked) = (film.done, 0);
            reference.add_while(&reference.middle, &mut film, || {
                asked += 1;
                asked <= allowed
            });
            assert_eq!(asked, allowed + 1, "once a block, and not again after a no");
            assert_eq!(film.done - before, BLOCK as u64 * (allowed + 1), "the first block is always done");
        }
        let drawn: Vec<bool> = film.pixels.iter().map(|pixel| pixel.alpha == 1.0).collect();
        let expected: Vec<bool> = (0..film.pixels.len()).map(|place| (place as u64) < film.done).collect();
        assert_eq!(drawn, expected, "without gaps");
        reference.add_while(&reference.middle, &mut film, || true);
        assert_eq!(film.done, 64 * 32, "no further than a sample of each pixel");
    }
}
