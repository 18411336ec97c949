//! The renderer: one device, and what it keeps between pictures.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use lisle_precompute::TransportStore;

use crate::aov::{NO_PLANE, Planes};
use crate::device::Gpu;
use crate::environment::SkyBuffers;
use crate::frame::{FrameBuffers, FrameInput, Recorder};
use crate::mesh_raster::MeshPipelines;
use crate::meshes::MeshBuffers;
use crate::motion::{Motion, Neighbour};
use crate::pipelines::Pipelines;
use crate::shader::{Film, Pass, Resolve};
use crate::tables::TableCache;
use crate::upload::SceneBuffers;
use crate::{AdapterInfo, Aov, Error, Exposure, Image, Scene, Settings};

/// How far a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
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
    gpu: Gpu,
    pipelines: Pipelines,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    tables: TableCache,
    scene: Option<SceneBuffers>,
    sky: Option<SkyBuffers>,
    meshes: Option<MeshBuffers>,
    /// Made for the first scene that has meshes.
    mesh_pipelines: Option<MeshPipelines>,
    frame: Option<FrameBuffers>,
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
        Ok(Self { gpu, pipelines, state: Mutex::default() })
    }

    /// Keeps tables of multiple scattering in a folder, for later sessions.
    #[must_use]
    pub fn with_store(self, folder: impl Into<PathBuf>) -> Self {
        self.lock().tables.store = Some(TransportStore::new(folder));
        self
    }

    /// A panic elsewhere leaves at worst stale buffers behind, which an update replaces.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.gpu.info
    }

    /// Draws a picture. `progress` is called after every sample, and before them while tables are made, and can stop the work.
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
        self.expose(&Exposure::still(scene), settings, progress)
    }

    /// The same for a scene that moves while the shutter is open: each sample is drawn at its own time.
    ///
    /// # Errors
    /// As [`Self::render`]; [`Error::Input`] for times between which objects do not correspond.
    pub fn expose(
        &self,
        exposure: &Exposure,
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
        let planes = Planes::new(&settings.aovs);
        let mut state = self.lock();
        let State { tables, scene: kept_scene, sky: kept_sky, meshes: kept_meshes, mesh_pipelines, frame: kept_frame } =
            &mut *state;
        let transports = match settings.photons() {
            0 => Vec::new(),
            photons => {
                let found =
                    tables.transports(scene, photons, &mut |done, total| progress(Progress::Tables { done, total }));
                let ControlFlow::Continue(transports) = found else { return Err(Error::Cancelled) };
                transports
            }
        };
        let (mut buffers, which) = SceneBuffers::update(&self.gpu, kept_scene.take(), scene, &transports, tables)?;
        let sky = SkyBuffers::update(&self.gpu, kept_sky.take(), scene.environment.as_ref())?;
        let meshes = MeshBuffers::update(&self.gpu, kept_meshes.take(), scene)?;
        if mesh_pipelines.is_none() && !meshes.is_empty() {
            *mesh_pipelines = Some(MeshPipelines::new(&self.gpu)?);
        }
        let motion = Motion::new(&self.gpu, exposure.steps, &which, settings.size, &buffers)?;
        let neighbours = exposure.neighbours.filter(|_| planes.vector != NO_PLANE).map(|[before, after]| {
            let neighbour =
                |other, when| Neighbour::new(&self.gpu, scene, other, when, &which, settings.size, &buffers);
            Ok::<_, Error>([neighbour(before, "frame before")?, neighbour(after, "frame after")?])
        });
        let neighbours = neighbours.transpose()?;
        let moment = motion.at(&buffers, 0.5)?;
        let film = if planes.count > 0 { Film::Aovs } else { Film::Plain };
        let resolve = Resolve { film, model: settings.model() };
        let wanted = [
            (true, Pass::ResolveFibers(resolve)),
            (true, Pass::ResolveCores(resolve)),
            (!meshes.is_empty(), Pass::ResolveMeshes(resolve)),
            (neighbours.is_some(), Pass::Follow),
            (!motion.shapes.is_empty(), Pass::MoveKnots),
        ];
        let wanted: Vec<Pass> = wanted.into_iter().filter_map(|(is, pass)| is.then_some(pass)).collect();
        self.pipelines.ensure(&self.gpu, &wanted)?;
        let neighbours = neighbours.as_ref();
        let input = FrameInput {
            scene,
            settings,
            resolve,
            planes,
            buffers: &buffers,
            motion: &motion,
            neighbours,
            sky: &sky,
            meshes: &meshes,
        };
        let frame = FrameBuffers::fit(&self.gpu, kept_frame.take(), &input, &moment.draws, region)?;
        let mut recorder = Recorder::new(&self.gpu, &self.pipelines, mesh_pipelines.as_ref(), &input, &frame, moment)?;
        let image = recorder.picture(region, progress);
        drop(recorder);
        buffers.displaced = !motion.shapes.is_empty();
        drop(motion);
        *kept_scene = Some(buffers);
        *kept_sky = Some(sky);
        *kept_meshes = Some(meshes);
        *kept_frame = Some(frame);
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
    scene.validate()?;
    Ok(region)
}
