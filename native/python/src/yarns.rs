//! The class `Yarns`.

use std::sync::Arc;

use lisle_core::curve::{Basis, Curves, KnotMode, Nurbs};
use lisle_core::strands;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::convert::{frozen_array, integers, numbers, vectors};
use crate::error::Failure;
use crate::gil::detached;

/// Names of the bases, at their codes.
const BASIS_NAMES: [&str; 5] = ["catmull-rom", "linear", "bezier", "nurbs", "b-spline"];
const NURBS: u8 = 3;

/// Order of a NURBS curve unless given, as in Blender.
const DEFAULT_ORDER: usize = 4;

/// Yarn curves in a rest shape and a current shape.
#[pyclass(module = "lisle", frozen)]
pub struct Yarns {
    /// Shared with the scenes that draw them.
    pub yarns: Arc<strands::Yarns>,
    name: String,
    arrays: Arrays,
}

/// What has been asked for once.
#[derive(Default)]
struct Arrays {
    points: Cached,
    rest_points: Cached,
    offsets: Cached,
    closed: Cached,
    basis: Cached,
    radii: Cached,
    length_coordinates: Cached,
}

impl Yarns {
    /// Curves at rest, computed without the GIL.
    pub fn at_rest(
        py: Python<'_>,
        curves: Curves,
        yarn_radius: Option<f32>,
        length_coordinates: Option<Vec<f32>>,
        name: String,
    ) -> Result<Self, Failure> {
        let yarns = detached(py, || {
            let yarns = strands::Yarns::new(curves, yarn_radius)?;
            match length_coordinates {
                None => Ok::<_, lisle_core::Error>(yarns),
                Some(lengths) => yarns.with_length_coordinates(&lengths),
            }
        });
        Ok(Self::of(yarns.map_err(|failure| failure.of(&name))?, name))
    }

    fn of(yarns: strands::Yarns, name: String) -> Self {
        Self { yarns: Arc::new(yarns), name, arrays: Arrays::default() }
    }
}

/// A numpy array of a field, made at the first call.
struct Cached(PyOnceLock<Py<PyAny>>);

impl Default for Cached {
    fn default() -> Self {
        Self(PyOnceLock::new())
    }
}

impl Cached {
    fn get(&self, py: Python<'_>, make: impl FnOnce() -> PyResult<Py<PyAny>>) -> PyResult<Py<PyAny>> {
        Ok(self.0.get_or_try_init(py, make)?.clone_ref(py))
    }
}

fn flat<T: numpy::Element + Clone>(py: Python<'_>, values: &[T]) -> PyResult<Py<PyAny>> {
    Ok(frozen_array(py, values.to_vec(), &[values.len()])?.unbind())
}

fn triples(py: Python<'_>, values: &[[f32; 3]]) -> PyResult<Py<PyAny>> {
    Ok(frozen_array(py, values.to_vec().into_flattened(), &[values.len(), 3])?.unbind())
}

#[pymethods]
impl Yarns {
    #[new]
    #[pyo3(signature = (
        points, offsets, closed=None, basis=None, radii=None, *, nurbs_order=None, nurbs_weights=None,
        nurbs_knots_mode=None, yarn_radius=None, length_coordinates=None, name="",
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of a constructor in Python")]
    fn new(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        offsets: &Bound<'_, PyAny>,
        closed: Option<&Bound<'_, PyAny>>,
        basis: Option<&Bound<'_, PyAny>>,
        radii: Option<&Bound<'_, PyAny>>,
        nurbs_order: Option<&Bound<'_, PyAny>>,
        nurbs_weights: Option<&Bound<'_, PyAny>>,
        nurbs_knots_mode: Option<&Bound<'_, PyAny>>,
        yarn_radius: Option<f32>,
        length_coordinates: Option<&Bound<'_, PyAny>>,
        name: &str,
    ) -> Result<Self, Failure> {
        let of = |failure: Failure| failure.of(name);
        let points = vectors("points", points).map_err(of)?;
        let offsets: Vec<u32> = integers("offsets", offsets).map_err(of)?;
        let curves = offsets.len().saturating_sub(1);
        let closed = match closed {
            None => vec![false; curves],
            Some(closed) => per_curve("closed", integers::<u8>("closed", closed).map_err(of)?, curves)
                .map_err(of)?
                .iter()
                .map(|&c| c != 0)
                .collect(),
        };
        let nurbs = NurbsArguments {
            order: nurbs_order.map(|order| integers("nurbs_order", order)).transpose().map_err(of)?,
            weights: nurbs_weights.map(|weights| numbers("nurbs_weights", weights)).transpose().map_err(of)?,
            knots_mode: nurbs_knots_mode.map(|mode| integers("nurbs_knots_mode", mode)).transpose().map_err(of)?,
        };
        let basis = nurbs.bases(basis, &offsets, points.len()).map_err(of)?;
        let radii = radii.map(|radii| numbers("radii", radii)).transpose().map_err(of)?;
        let lengths =
            length_coordinates.map(|lengths| numbers("length_coordinates", lengths)).transpose().map_err(of)?;
        Self::at_rest(py, Curves { points, offsets, closed, basis, radii }, yarn_radius, lengths, name.to_owned())
    }

    fn with_points(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> Result<Self, Failure> {
        let of = |failure: Failure| failure.of(&self.name);
        let points = vectors("points", points).map_err(of)?;
        let moved = detached(py, || self.yarns.with_points(&points)).map_err(of)?;
        Ok(Self::of(moved, self.name.clone()))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn points(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.arrays.points.get(py, || triples(py, self.yarns.points()))
    }

    #[getter]
    fn rest_points(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.arrays.rest_points.get(py, || triples(py, self.yarns.rest_points()))
    }

    #[getter]
    fn offsets(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.arrays.offsets.get(py, || flat(py, self.yarns.offsets()))
    }

    #[getter]
    fn closed(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.arrays.closed.get(py, || flat(py, self.yarns.closed()))
    }

    #[getter]
    fn basis(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let code = |basis: &Basis| match basis {
            Basis::CatmullRom => 0_u8,
            Basis::Linear => 1,
            Basis::Bezier => 2,
            Basis::Nurbs(_) => NURBS,
            Basis::BSpline => 4,
        };
        self.arrays.basis.get(py, || flat(py, &self.yarns.basis().iter().map(code).collect::<Vec<_>>()))
    }

    #[getter]
    fn radii(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.arrays.radii.get(py, || flat(py, self.yarns.radii()))
    }

    #[getter]
    fn length_coordinates(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.arrays.length_coordinates.get(py, || flat(py, self.yarns.length_coordinates()))
    }

    #[getter]
    fn length(&self) -> f64 {
        self.yarns.strands().total_lengths().iter().sum()
    }

    fn __len__(&self) -> usize {
        self.yarns.closed().len()
    }

    fn __repr__(&self) -> String {
        let name = if self.name.is_empty() { String::new() } else { format!("{:?}, ", self.name) };
        format!("Yarns({name}{} curves, {} points)", self.__len__(), self.yarns.points().len())
    }
}

/// One entry per curve from one per curve, or from a single one for all.
fn per_curve<T: Clone>(name: &str, values: Vec<T>, curves: usize) -> Result<Vec<T>, Failure> {
    match values.len() {
        1 => Ok(vec![values[0].clone(); curves]),
        found if found == curves => Ok(values),
        found => Err(Failure::Input(format!("{name} has {found} entries, expected {curves}, one per curve"))),
    }
}

struct NurbsArguments {
    order: Option<Vec<usize>>,
    weights: Option<Vec<f32>>,
    knots_mode: Option<Vec<u8>>,
}

impl NurbsArguments {
    /// A basis per curve, from a name for all or a code for each.
    fn bases(self, basis: Option<&Bound<'_, PyAny>>, offsets: &[u32], points: usize) -> Result<Vec<Basis>, Failure> {
        let curves = offsets.len().saturating_sub(1);
        let codes = match basis {
            None => vec![0; curves],
            Some(basis) => match basis.extract::<String>() {
                Ok(name) => {
                    let code = BASIS_NAMES.iter().position(|known| *known == name).ok_or_else(|| {
                        Failure::Input(format!("basis: {name:?} is none of {}", BASIS_NAMES.join(", ")))
                    })?;
                    vec![code as u8; curves]
                }
                Err(_) => per_curve("basis", integers("basis", basis)?, curves)?,
            },
        };
        let orders = per_curve("nurbs_order", self.order.unwrap_or(vec![DEFAULT_ORDER]), curves)?;
        let modes = per_curve("nurbs_knots_mode", self.knots_mode.unwrap_or(vec![0]), curves)?;
        if let Some(weights) = self.weights.as_ref().filter(|weights| weights.len() != points) {
            return Err(Failure::Input(format!("nurbs_weights has {} entries, expected {points}", weights.len())));
        }
        let refuse =
            |curve: usize, what: &str, code: u8| Failure::Input(format!("curve {curve}: {what} {code} is unknown"));
        let basis = |curve: usize, code: u8| match code {
            0 => Ok(Basis::CatmullRom),
            1 => Ok(Basis::Linear),
            2 => Ok(Basis::Bezier),
            NURBS => {
                let knots = match modes[curve] {
                    0 => KnotMode::Normal,
                    1 => KnotMode::Endpoint,
                    2 => KnotMode::Bezier,
                    3 => KnotMode::EndpointBezier,
                    mode => return Err(refuse(curve, "nurbs_knots_mode", mode)),
                };
                // Offsets are not checked yet; those that miss leave a length that is refused with its curve.
                let range = offsets[curve] as usize..offsets[curve + 1] as usize;
                let weights =
                    self.weights.as_ref().map(|weights| weights.get(range).map_or_else(Vec::new, <[f32]>::to_vec));
                Ok(Basis::Nurbs(Box::new(Nurbs { order: orders[curve], weights, knots })))
            }
            4 => Ok(Basis::BSpline),
            code => Err(refuse(curve, "basis", code)),
        };
        codes.into_iter().enumerate().map(|(curve, code)| basis(curve, code)).collect()
    }
}
