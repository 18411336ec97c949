//! The renderer: one device, and what it keeps between pictures.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use lisle_precompute::TransportStore;

use crate::aov::{NO_PLANE, Planes};
use crate::device::Gpu;
use crate::environment::SkyBuffers;
use crate::frame::{DrawnShadows, FrameBuffers, FrameInput, MOST_SKY_VIEWS, PictureListener, Recorder};
use crate::mesh_raster::MeshPipelines;
use crate::meshes::MeshBuffers;
use crate::motion::{Motion, Neighbour};
use crate::pipelines::Pipelines;
use crate::shader::{Background, Film, Pass, Resolve};
use crate::tables::TableCache;
use crate::upload::SceneBuffers;
use crate::waiting::{Turns, Waiting};
use crate::{AdapterInfo, Aov, Error, Exposure, Image, Scene, Settings};

/// How far a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Another picture is being finished, or the scene made ready.
    Preparing,
    /// Tables of multiple scattering, for yarns and materials that were never drawn before: steps of some hundredths of a second.
    Tables {
        /// Steps done, at most `total`.
        done: u32,
        /// Steps of all tables.
        total: u32,
    },
    /// Samples per pixel.
    Samples {
        /// Done, over all tiles: at most `total`.
        done: u32,
        /// Samples per pixel × tiles.
        total: u32,
    },
}

/// Draws scenes on one adapter. Thread-safe: pictures are drawn one at a time.
pub struct Renderer {
    adapter: AdapterInfo,
    submissions: Arc<AtomicU64>,
    drawing: Arc<Turns<Drawing>>,
}

/// The device, and what is kept from picture to picture.
struct Drawing {
    gpu: Gpu,
    pipelines: Pipelines,
    /// Made for the first scene that has meshes.
    mesh_pipelines: Option<MeshPipelines>,
    tables: TableCache,
    scene: Option<SceneBuffers>,
    sky: Option<SkyBuffers>,
    meshes: Option<MeshBuffers>,
    frame: Option<FrameBuffers>,
    shadows: Option<DrawnShadows>,
}

impl Renderer {
    /// Opens the first adapter whose name contains `adapter` (in any case), or the best one.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] if none answers; [`Error::Device`] if it refuses.
    pub fn new(adapter: Option<&str>) -> Result<Self, Error> {
        let gpu = Gpu::new(adapter)?;
        let wide = gpu.info.wide_atomics;
        Self::with_gpu(gpu, wide)
    }

    /// The same without 64-bit atomics, even where the adapter has them: two visibility passes, the same picture.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_narrow_atomics(adapter: Option<&str>) -> Result<Self, Error> {
        Self::with_gpu(Gpu::new(adapter)?, false)
    }

    fn with_gpu(gpu: Gpu, wide: bool) -> Result<Self, Error> {
        let pipelines = Pipelines::new(&gpu, wide)?;
        let (adapter, submissions) = (gpu.info.clone(), Arc::clone(&gpu.submissions));
        let drawing = Drawing {
            gpu,
            pipelines,
            mesh_pipelines: None,
            tables: TableCache::default(),
            scene: None,
            sky: None,
            meshes: None,
            frame: None,
            shadows: None,
        };
        Ok(Self { adapter, submissions, drawing: Arc::new(Turns::new(drawing)) })
    }

    /// Keeps tables of multiple scattering in a folder, for later sessions.
    #[must_use]
    pub fn with_store(self, folder: impl Into<PathBuf>) -> Self {
        if let Ok(mut drawing) = self.drawing.take(&mut || ControlFlow::Continue(())) {
            drawing.tables.store = Some(TransportStore::new(folder));
        }
        self
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.adapter
    }

    /// How often pictures have handed work to the adapter.
    pub fn submissions(&self) -> u64 {
        self.submissions.load(Ordering::Relaxed)
    }

    /// Draws a picture. `progress` is called after every sample, and before them while tables are made, and again every few hundredths of a
    /// second; it can stop the work. A picture that was stopped hands nothing more to the adapter; what the adapter has of it already may keep
    /// the next picture waiting.
    ///
    /// The same scene and settings give the same bits on one adapter, whatever was drawn before.
    ///
    /// # Errors
    /// [`Error::Scene`] or [`Error::Input`] for what cannot be drawn, [`Error::Device`] for what the adapter
    /// cannot do, [`Error::Cancelled`].
    pub fn render(
        &self,
        scene: &Scene,
        settings: &Settings,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Image, Error> {
        self.expose(Exposure::still(scene.clone()), settings, progress)
    }

    /// The same for a scene that moves while the shutter is open: each sample is drawn at its own time.
    ///
    /// # Errors
    /// As [`Self::render`]; [`Error::Input`] for times between which objects do not correspond.
    pub fn expose(
        &self,
        exposure: Exposure,
        settings: &Settings,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Image, Error> {
        let Some(scene) = exposure.steps.first() else {
            return Err(Error::input("time steps", "there are none"));
        };
        let region = check(scene, settings)?;
        if settings.aovs.contains(&Aov::Vector) && exposure.neighbours.is_none() {
            return Err(Error::input("vector", "this pass needs the scenes of the frames before and after"));
        }
        let settings = settings.clone();
        let mut drawing = self.drawing.take(&mut || progress(Progress::Preparing))?;
        let work = move |listener: &PictureListener| drawing.draw(&exposure, &settings, region, listener);
        let refused =
            |error: std::io::Error| Error::Device { adapter: self.adapter.name.clone(), reason: error.to_string() };
        Waiting::begin(work).map_err(refused)?.outcome(progress)?
    }
}

impl Drop for Renderer {
    /// Waits for what a stopped picture has left: a driver that is unloaded while it works ends the process.
    fn drop(&mut self) {
        if let Ok(drawing) = self.drawing.take(&mut || ControlFlow::Continue(())) {
            drop(drawing.keep());
        }
    }
}

impl Drawing {
    /// Draws a region: left, top, width, height.
    fn draw(
        &mut self,
        exposure: &Exposure,
        settings: &Settings,
        region: [u32; 4],
        listener: &PictureListener,
    ) -> Result<Image, Error> {
        let scene = &exposure.steps[0];
        let planes = Planes::new(&settings.aovs);
        let Self { gpu, pipelines, mesh_pipelines, tables, .. } = self;
        let (gpu, pipelines) = (&*gpu, &*pipelines);
        let transports = match settings.photons() {
            0 => Vec::new(),
            photons => {
                let step = &mut |done, total| match listener.report(Progress::Tables { done, total }) {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(_) => ControlFlow::Break(()),
                };
                let ControlFlow::Continue(transports) = tables.transports(scene, photons, step) else {
                    return Err(Error::Cancelled);
                };
                transports
            }
        };
        listener.check()?;
        let (mut buffers, parts) =
            SceneBuffers::update(gpu, self.scene.take(), scene, &transports, settings.table_resolution, tables)?;
        let sky = SkyBuffers::update(gpu, self.sky.take(), scene.environment.as_ref())?;
        let meshes = MeshBuffers::update(gpu, self.meshes.take(), &exposure.steps)?;
        if mesh_pipelines.is_none() && !meshes.is_empty() {
            *mesh_pipelines = Some(MeshPipelines::new(gpu)?);
        }
        let motion = Motion::new(gpu, &exposure.steps, &parts, settings.size, &buffers)?;
        let neighbours = exposure.neighbours.as_ref().filter(|_| planes.vector != NO_PLANE).map(|[before, after]| {
            let neighbour = |other, when| Neighbour::new(gpu, scene, other, when, &parts, settings.size, &buffers);
            Ok::<_, Error>([neighbour(before, "frame before")?, neighbour(after, "frame after")?])
        });
        let neighbours = neighbours.transpose()?;
        let moment = motion.at(&buffers, 0.5)?;
        let film = if planes.count > 0 { Film::Aovs } else { Film::Plain };
        let resolve = Resolve { film, model: settings.model() };
        let shows_sky = !settings.transparent && scene.environment.as_ref().is_some_and(|sky| sky.shines());
        let background = if shows_sky { Background::Sky } else { Background::Even };
        let wanted = [
            (true, Pass::Classify(background)),
            (true, Pass::ResolveFibers(resolve)),
            (true, Pass::ResolveCores(resolve)),
            (!meshes.is_empty(), Pass::ResolveMeshes(resolve)),
            (neighbours.is_some(), Pass::Follow),
            (!motion.shapes.is_empty(), Pass::MoveKnots),
        ];
        let wanted: Vec<Pass> = wanted.into_iter().filter_map(|(is, pass)| is.then_some(pass)).collect();
        let neighbours = neighbours.as_ref();
        let input = FrameInput {
            scene,
            settings,
            background,
            resolve,
            planes,
            buffers: &buffers,
            motion: &motion,
            neighbours,
            sky: &sky,
            meshes: &meshes,
            mesh_pipelines: mesh_pipelines.as_ref().filter(|_| !meshes.is_empty()),
        };
        let frame = FrameBuffers::fit(gpu, self.frame.take(), &input, &moment.draws, region)?;
        let arrays = frame.arrays(gpu, &buffers);
        pipelines.ensure(gpu, arrays, &wanted)?;
        let shadows = self.shadows.take();
        let mut recorder = Recorder::new(gpu, pipelines, listener, &input, &frame, moment, shadows)?;
        // What is left of a picture that was stopped is done before another begins.
        let image = recorder.picture(region).or_else(|error| gpu.finish().and(Err(error)));
        let shadows = recorder.into_shadows();
        buffers.displaced = !motion.shapes.is_empty();
        drop(motion);
        // After an error of the device, of memory for one, buffers may be none: nothing of them is kept.
        if matches!(image, Ok(_) | Err(Error::Cancelled)) {
            self.scene = Some(buffers);
            self.sky = Some(sky);
            self.meshes = Some(meshes);
            self.frame = Some(frame);
            self.shadows = shadows;
        }
        image
    }
}

/// Pixels of one picture: with all passes, 6 GiB of memory.
const MOST_PIXELS: u64 = 1 << 27;

/// Checks scene and settings; the region to draw: left, top, width, height.
fn check(scene: &Scene, settings: &Settings) -> Result<[u32; 4], Error> {
    let [width, height] = settings.size;
    let invalid = |what: &str, reason: String| Err(Error::input(what, reason));
    if width == 0 || height == 0 || width > 65536 || height > 65536 {
        return invalid("size", format!("{width}×{height}: expected 1 to 65536 pixels each"));
    }
    let region = settings.region.unwrap_or([0, 0, width, height]);
    let [left, top, w, h] = region;
    if w == 0 || h == 0 || left.saturating_add(w) > width || top.saturating_add(h) > height {
        return invalid("region", format!("{w}×{h} at ({left}, {top}) is not inside of {width}×{height} pixels"));
    }
    if u64::from(w) * u64::from(h) > MOST_PIXELS {
        return invalid("region", format!("{w}×{h} pixels are more than {MOST_PIXELS}: draw them in parts"));
    }
    if settings.samples == 0 {
        return invalid("samples", "0: expected at least 1".into());
    }
    if !(settings.noise_threshold.is_finite() && settings.noise_threshold >= 0.0) {
        return invalid("noise_threshold", format!("{}: expected 0 or more", settings.noise_threshold));
    }
    if settings.time_limit_s.is_some_and(|limit| !(limit.is_finite() && limit > 0.0)) {
        return invalid("time_limit_s", "expected a number of seconds above 0".into());
    }
    for (what, value) in [("lod_pixels", settings.lod_pixels), ("filter_width", settings.filter_width)] {
        if !(0.0..=100.0).contains(&value) {
            return invalid(what, format!("{value}: expected 0 to 100 pixels"));
        }
    }
    if !(16..=16384).contains(&settings.shadow_resolution) {
        return invalid("shadow_resolution", format!("{}: expected 16 to 16384 texels", settings.shadow_resolution));
    }
    if !(1..=MOST_SKY_VIEWS).contains(&settings.sky_directions) {
        return invalid("sky_directions", format!("{}: expected 1 to {MOST_SKY_VIEWS}", settings.sky_directions));
    }
    if !(1..=4).contains(&settings.table_resolution) {
        return invalid("table_resolution", format!("{}: expected 1 to 4", settings.table_resolution));
    }
    scene.validate()?;
    Ok(region)
}
