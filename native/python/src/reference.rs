//! The reference: explicit fibers, and the path tracer through them.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lisle_core::view::View;
use lisle_gpu::{Scene, Shading};
use lisle_reference::fibers::{Detail, Options, fibers as make_fibers};
use lisle_reference::{Film, Image, Reference, Settings};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{array, field_error};
use crate::environment::EnvironmentFields;
use crate::error::Failure;
use crate::gil::{Listener, detached};
use crate::mesh::MeshFields;
use crate::scene::{CameraFields, LightFields, ObjectFields, StepFields, moved, scene, shading};
use crate::yarn::extract_yarn;
use crate::yarns::Yarns;

/// Time between two checkpoints.
const CHECKPOINT_PERIOD: Duration = Duration::from_secs(60);

/// The keyword arguments of a reference that are settings.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct SettingsItems {
    size: [u32; 2],
    region: Option<[u32; 4]>,
    samples: u32,
    seed: u32,
    bounces: Option<u32>,
    shading: String,
    transparent: bool,
    filter_width: f32,
    chord_error: f64,
}

impl SettingsItems {
    fn settings(self) -> Result<Settings, Failure> {
        let shading: Shading = shading(&self.shading)?;
        Ok(Settings {
            size: self.size,
            region: self.region,
            samples: self.samples,
            seed: self.seed,
            bounces: self.bounces,
            shading,
            transparent: self.transparent,
            filter_width: self.filter_width,
            chord_error: self.chord_error,
        })
    }
}

/// Arrays of points, offsets and radii.
type FiberArrays<'py> = [Bound<'py, PyAny>; 3];

/// Points of all fibers of yarns, offsets of the chains, and radii.
#[pyfunction]
pub fn fibers<'py>(
    py: Python<'py>,
    yarns: &Bound<'py, Yarns>,
    yarn: &Bound<'py, PyAny>,
    chord_error: f64,
    object_id: u32,
    view: Option<(CameraFields, [u32; 2], f64)>,
    progress: Option<Py<PyAny>>,
) -> Result<FiberArrays<'py>, Failure> {
    let yarn = extract_yarn(yarn)?;
    yarn.validate()?;
    let yarns = yarns.get().yarns.clone();
    let detail = view.map(|(camera, size, lod_pixels)| {
        let view = View::new(&camera.into(), size).map_err(lisle_reference::Error::from)?;
        Ok::<_, Failure>(Detail { view, lod_pixels })
    });
    let options = Options { chord_error, object_id, detail: detail.transpose()?, ..Options::default() };
    let mut listener = Listener::new(progress);
    let made = detached(py, || make_fibers(yarns.strands(), &yarn, &options, &mut |done| listener.report(done)));
    let made = listener.outcome(made)?;
    let count = made.points.len();
    let points = made.points.iter().flat_map(|[x, y, z, _]| [*x, *y, *z]).collect();
    let radii = made.points.iter().map(|point| point[3]).collect();
    let chains = made.offsets.len();
    Ok([array(py, points, &[count, 3])?, array(py, made.offsets, &[chains])?, array::<f32>(py, radii, &[count])?])
}

/// Passes by name, and statistics, of a scene drawn by the path tracer. `later` are the further time steps.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called from one place in the package, by position")]
pub fn reference<'py>(
    py: Python<'py>,
    objects: Vec<ObjectFields<'py>>,
    meshes: Vec<(MeshFields, u32)>,
    lights: Vec<LightFields>,
    ambient: [f32; 3],
    environment: Option<EnvironmentFields>,
    camera: CameraFields,
    later: Vec<StepFields<'py>>,
    settings: &Bound<'py, PyDict>,
    checkpoint: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
) -> Result<(Bound<'py, PyDict>, Bound<'py, PyDict>), Failure> {
    let settings: SettingsItems = settings.extract().map_err(|error| Failure::Input(field_error(py, &error)))?;
    let settings = settings.settings()?;
    let mut steps = vec![scene(objects, meshes, lights, ambient, environment, camera)?];
    for step in later {
        steps.push(moved(&steps[0], step)?);
    }
    let mut listener = Listener::new(progress);
    let result = detached(py, || draw(&steps, &settings, checkpoint.as_deref(), &mut listener));
    let (image, segments, bytes) = listener.outcome(result)?;
    let statistics = PyDict::new(py);
    statistics.set_item("fiber_segments", segments)?;
    statistics.set_item("bytes", bytes)?;
    Ok((passes(py, image)?, statistics))
}

/// The picture, and how many segments and bytes its fibers have.
fn draw(
    steps: &[Scene],
    settings: &Settings,
    checkpoint: Option<&Path>,
    listener: &mut Listener,
) -> Result<(Image, usize, usize), Failure> {
    let kept = checkpoint.filter(|path| path.exists()).map(read).transpose()?;
    let reference = Reference::exposed(steps, settings, &mut || listener.report(0.0))?;
    let mut film = kept.unwrap_or_else(|| reference.film());
    let mut saved = Instant::now();
    let mut failure = None;
    let result = reference.render(&mut film, &mut |film| {
        if let Some(path) = checkpoint.filter(|_| saved.elapsed() >= CHECKPOINT_PERIOD) {
            if let Err(error) = write(path, film) {
                failure = Some(error);
                return ControlFlow::Break(());
            }
            saved = Instant::now();
        }
        listener.report(film.fraction())
    });
    if let Some(failure) = failure {
        return Err(failure);
    }
    // What a stopped picture has is kept as well; a film of another picture has not changed.
    if let (Some(path), Ok(()) | Err(lisle_reference::Error::Cancelled)) = (checkpoint, &result) {
        write(path, &film)?;
    }
    result?;
    let (segments, bytes) = reference.extent();
    Ok((film.image(), segments, bytes))
}

fn read(path: &Path) -> Result<Film, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::File(format!("{}: {error}", path.display())))?;
    Film::from_bytes(&bytes).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}

fn write(path: &Path, film: &Film) -> Result<(), Failure> {
    crate::save::replace(path, |file| {
        std::io::Write::write_all(file, &film.to_bytes()).map_err(|error| error.to_string())
    })
}

/// The image's passes as numpy arrays, row 0 at the top.
fn passes<'py>(py: Python<'py>, image: Image) -> PyResult<Bound<'py, PyDict>> {
    let [width, height] = image.size.map(|pixels| pixels as usize);
    let passes = PyDict::new(py);
    passes.set_item("combined", array(py, image.combined.into_flattened(), &[height, width, 4])?)?;
    passes.set_item("depth", array(py, image.depth, &[height, width])?)?;
    passes.set_item("normal", array(py, image.normal.into_flattened(), &[height, width, 3])?)?;
    passes.set_item("tangent", array(py, image.tangent.into_flattened(), &[height, width, 3])?)?;
    passes.set_item("object_id", array(py, image.object_id, &[height, width])?)?;
    passes.set_item("variance", array(py, image.variance.into_flattened(), &[height, width, 3])?)?;
    Ok(passes)
}
