//! The class `Renderer`.

use std::cell::Cell;
use std::path::PathBuf;

use lisle_gpu::{Exposure, Image, Progress, Statistics};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::adapter::Adapter;
use crate::convert::{array, field_error};
use crate::environment::EnvironmentFields;
use crate::error::Failure;
use crate::gil::{Listener, detached};
use crate::mesh::MeshFields;
use crate::scene::{CameraFields, LightFields, ObjectFields, SettingsItems, StepFields, moved, scene};

thread_local! {
    /// Whether this thread is in a render: a progress callback that drew again would wait for itself.
    static DRAWING: Cell<bool> = const { Cell::new(false) };
}

/// Share of a picture's progress that its tables have, if they are to be made.
const TABLES_SHARE: f64 = 0.25;

/// Where tables are kept: `$LISLE_CACHE`, nowhere if that is empty, or the user's folder for such files.
fn cache_folder() -> Option<PathBuf> {
    match std::env::var_os("LISLE_CACHE") {
        Some(folder) => (!folder.is_empty()).then(|| folder.into()),
        None => dirs::cache_dir().map(|folder| folder.join("lisle")),
    }
}

/// An adapter that draws.
#[pyclass(module = "lisle._native", frozen)]
pub struct Renderer(lisle_gpu::Renderer);

#[pymethods]
impl Renderer {
    #[new]
    fn new(py: Python<'_>, adapter: Option<String>) -> Result<Self, Failure> {
        let renderer = detached(py, || lisle_gpu::Renderer::new(adapter.as_deref()))?;
        Ok(Self(match cache_folder() {
            Some(folder) => renderer.with_store(folder),
            None => renderer,
        }))
    }

    #[getter]
    fn adapter(&self) -> Adapter {
        self.0.adapter().clone().into()
    }

    /// Passes by name and statistics. `later` are the further time steps, `neighbours` the frames before and after, or nothing.
    #[expect(clippy::too_many_arguments, reason = "called from one place in the package, by position")]
    fn render<'py>(
        &self,
        py: Python<'py>,
        objects: Vec<ObjectFields<'py>>,
        meshes: Vec<(MeshFields, u32)>,
        lights: Vec<LightFields>,
        ambient: [f32; 3],
        environment: Option<EnvironmentFields>,
        camera: CameraFields,
        later: Vec<StepFields<'py>>,
        neighbours: Vec<StepFields<'py>>,
        settings: &Bound<'py, PyDict>,
        progress: Option<Py<PyAny>>,
    ) -> Result<(Bound<'py, PyDict>, Bound<'py, PyDict>), Failure> {
        let settings: SettingsItems = settings.extract().map_err(|error| Failure::Input(field_error(py, &error)))?;
        let settings = settings.settings()?;
        let mut steps = vec![scene(objects, meshes, lights, ambient, environment, camera)?];
        let neighbours = neighbours.into_iter().map(|step| moved(&steps[0], step)).collect::<Result<Vec<_>, _>>()?;
        for step in later {
            steps.push(moved(&steps[0], step)?);
        }
        let exposure = Exposure { steps, neighbours: neighbours.try_into().ok() };
        if DRAWING.replace(true) {
            return Err(Failure::Input("render was called from a progress callback of another render".to_owned()));
        }
        let mut listener = Listener::new(progress);
        let mut tables = 0.0;
        let mut report = |progress| {
            let share = |done, total| f64::from(done) / f64::from(total);
            listener.report(match progress {
                Progress::Preparing => 0.0,
                Progress::Tables { done, total } => {
                    tables = TABLES_SHARE * share(done, total);
                    tables
                }
                Progress::Samples { done, total } => tables + (1.0 - tables) * share(done, total),
            })
        };
        let result = detached(py, || self.0.expose(exposure, &settings, &mut report));
        DRAWING.set(false);
        let image = listener.outcome(result)?;
        let statistics = statistics(py, &image.statistics)?;
        Ok((passes(py, image)?, statistics))
    }
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
    for (aov, values) in image.aovs {
        let shape = [height, width, aov.channels()];
        let shape = if aov.channels() == 1 { &shape[..2] } else { &shape[..] };
        passes.set_item(aov.name(), array(py, values, shape)?)?;
    }
    Ok(passes)
}

fn statistics<'py>(py: Python<'py>, statistics: &Statistics) -> PyResult<Bound<'py, PyDict>> {
    let milliseconds = PyDict::new(py);
    for (pass, time) in &statistics.passes {
        milliseconds.set_item(pass, time)?;
    }
    let result = PyDict::new(py);
    result.set_item("samples", statistics.samples)?;
    result.set_item("adapter", &statistics.adapter)?;
    result.set_item("segments", statistics.segments)?;
    result.set_item("fiber_segments", statistics.fiber_segments)?;
    result.set_item("fiber_lines", statistics.fiber_lines)?;
    result.set_item("knot_bytes", statistics.knot_bytes)?;
    result.set_item("gpu_bytes", statistics.gpu_bytes)?;
    result.set_item("uploaded_bytes", statistics.uploaded_bytes)?;
    result.set_item("passes_ms", milliseconds)?;
    Ok(result)
}
