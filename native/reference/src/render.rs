//! Samples in order, pixels in parallel.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use lisle_core::sampling::{Filter, PixelFilter, Random};
use lisle_core::scene::{Object, Scene};
use lisle_core::view::View;
use rayon::prelude::*;

use crate::assembly::{Hit, Ray};
use crate::film::{EMPTY_DEPTH, Film, Pixel, Sample};
use crate::world::World;
use crate::{Error, Settings};

/// Time after which no work is begun before the progress callback has been called.
const BREATH: Duration = Duration::from_millis(50);

/// Neighbouring pixels that a thread takes at once.
const BLOCK: usize = 16;

/// A scene with all its fibers, ready to be drawn.
pub struct Reference {
    world: World,
    view: View,
    filter: PixelFilter,
    settings: Settings,
    region: [u32; 4],
    digest: u64,
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
        let region = settings.check()?;
        let view = View::new(&scene.camera, settings.size)?;
        let world = World::new(scene, settings.shading, settings.chord_error, progress)?;
        let digest = digest(scene, settings, &world, progress)?;
        let filter = PixelFilter::new(Filter::default(), settings.filter_width);
        Ok(Self { world, view, filter, settings: settings.clone(), region, digest })
    }

    /// Round cones of all fibers, and bytes of them with their hierarchy.
    pub fn extent(&self) -> (usize, usize) {
        (self.world.assembly.segments(), self.world.assembly.bytes())
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
        while !film.is_done() {
            let start = Instant::now();
            self.add_while(film, || start.elapsed() < BREATH);
            if progress(film).is_break() {
                return Err(Error::Cancelled);
            }
        }
        Ok(())
    }

    /// Adds one sample to the next pixels of a film, block by block, each begun if `go_on()`; those of one sample number at most.
    fn add_while(&self, film: &mut Film, mut go_on: impl FnMut() -> bool + Send) {
        let count = film.pixels.len() as u64;
        let (sample, first) = ((film.done / count) as u32, (film.done % count) as usize);
        let blocks = film.pixels[first..].chunks_mut(BLOCK).zip((first..).step_by(BLOCK));
        // Blocks are begun in order, and those that are begun are finished: what is done is without gaps.
        let begun = blocks.enumerate().take_while(|(number, _)| *number == 0 || go_on()).par_bridge();
        let done = begun.map(|(_, (pixels, place))| {
            pixels.iter_mut().zip(place..).for_each(|(pixel, place)| self.add(place, sample, pixel));
            pixels.len() as u64
        });
        film.done += done.sum::<u64>();
    }

    /// Adds one sample to the pixel at a place of the region.
    fn add(&self, place: usize, sample: u32, pixel: &mut Pixel) {
        let [left, top, width, _] = self.region;
        let (x, y) = (left + place as u32 % width, top + place as u32 / width);
        let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        if sample == 0 {
            let met = self.meet(&self.view, center);
            pixel.depth = met.as_ref().map_or(EMPTY_DEPTH, |(_, _, depth)| *depth);
            pixel.object_id = met.map_or(0, |(_, hit, _)| self.world.object_id(hit.segment));
        }
        // By the pixel's place in the frame: a region has the same noise as the whole.
        let number = u64::from(y) * u64::from(self.settings.size[0]) + u64::from(x);
        let mut random = Random::new(self.settings.seed, number, sample);
        let offset = self.filter.offset(random.pair());
        let place = [center[0] + offset[0], center[1] + offset[1]];
        let view = match &self.view.lens {
            Some(lens) => self.view.through(lens, lens.point(random.pair())),
            None => self.view,
        };
        let Some((ray, hit, _)) = self.meet(&view, place) else {
            if !self.settings.transparent {
                let radiance = self.world.background(view.ray(place).1.normalize()).to_array();
                pixel.add(&Sample { radiance, alpha: 1.0, ..Sample::default() });
            }
            return;
        };
        if self.world.is_holdout(hit.segment) {
            return;
        }
        let surface = self.world.assembly.surface(&ray, &hit);
        pixel.add(&Sample {
            radiance: self.world.radiance(&ray, &hit, self.settings.bounces, &mut random).to_array(),
            alpha: 1.0,
            normal: surface.normal.to_array(),
            tangent: surface.tangent.to_array(),
        });
    }

    /// What a view shows at a place on the frame: the ray, what it meets, and its depth.
    fn meet(&self, view: &View, place: [f64; 2]) -> Option<(Ray, Hit, f64)> {
        let (at_zero, per_depth) = view.ray(place);
        let length = per_depth.length();
        let near = view.near;
        let origin = at_zero + per_depth * near + view.origin - self.world.origin;
        let ray = Ray { origin, direction: per_depth / length };
        let hit = self.world.assembly.nearest(&ray, (view.far - near) * length)?;
        Some((ray, hit, near + hit.t / length))
    }
}

/// Tells pictures apart: everything but the number of samples.
fn digest(
    scene: &Scene,
    settings: &Settings,
    world: &World,
    progress: &mut dyn FnMut() -> ControlFlow<()>,
) -> Result<u64, Error> {
    /// Points between two calls of the progress callback.
    const POINTS: usize = 1 << 22;

    let Settings { size, region, seed, bounces, shading, transparent, filter_width, .. } = settings;
    let settings = format!("{size:?} {region:?} {seed} {bounces:?} {shading:?} {transparent} {filter_width}");
    let sky = scene.environment.as_ref();
    let turned = sky.map(|sky| (sky.image.size(), sky.world_from_environment, sky.strength));
    let of = |object: &Object| (object.id, Arc::clone(&object.material), object.is_holdout);
    let objects: Vec<_> = scene.objects.iter().map(of).collect();
    let text = format!(
        "{settings} {objects:?} {turned:?} {:?} {:?} {:?} {:?}",
        scene.lights, scene.ambient, scene.camera, world.origin
    );
    // FNV-1a, 64 bits, over words where there are many.
    let step = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    let mut hash = text.bytes().map(u64::from).fold(0xcbf2_9ce4_8422_2325, step);
    let texels = sky.iter().flat_map(|sky| sky.image.radiance().iter().flatten());
    hash = texels.map(|value| u64::from(value.to_bits())).fold(hash, step);
    for points in world.assembly.points().chunks(POINTS) {
        hash = points.iter().flatten().map(|value| u64::from(value.to_bits())).fold(hash, step);
        if progress().is_break() {
            return Err(Error::Cancelled);
        }
    }
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
            reference.add_while(&mut film, || {
                asked += 1;
                asked <= allowed
            });
            assert_eq!(asked, allowed + 1, "once a block, and not again after a no");
            assert_eq!(film.done - before, BLOCK as u64 * (allowed + 1), "the first block is always done");
        }
        let drawn: Vec<bool> = film.pixels.iter().map(|pixel| pixel.alpha == 1.0).collect();
        let expected: Vec<bool> = (0..film.pixels.len()).map(|place| (place as u64) < film.done).collect();
        assert_eq!(drawn, expected, "without gaps");
        reference.add_while(&mut film, || true);
        assert_eq!(film.done, 64 * 32, "no further than a sample of each pixel");
    }
}
