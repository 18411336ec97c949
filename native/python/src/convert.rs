//! Arrays from Python and back.

use numpy::{
    Element, IntoPyArray, Ix1, Ix2, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::Failure;

/// Any array-like as (n, 3) f32.
pub fn vectors(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<[f32; 3]>, Failure> {
    let expected = "an array of shape (n, 3)";
    let array = contiguous::<f32, Ix2>(name, value, expected)?;
    let slice = array.as_slice().map_err(|error| Failure::Input(format!("{name}: {error}")))?;
    match slice.as_chunks::<3>() {
        (vectors, []) if array.shape()[1] == 3 => Ok(vectors.to_vec()),
        _ => Err(Failure::Input(format!("{name}: expected {expected}, got shape {:?}", array.shape()))),
    }
}

/// Any array-like as (n,) numbers of one type.
pub fn numbers<T: Element + Clone>(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<T>, Failure> {
    let array = contiguous::<T, Ix1>(name, value, "an array of shape (n,)")?;
    Ok(array.as_slice().map_err(|error| Failure::Input(format!("{name}: {error}")))?.to_vec())
}

/// Any array-like of whole numbers in a range, as (n,) or a single one.
pub fn integers<T: TryFrom<i64>>(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<T>, Failure> {
    let py = value.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let refuse = |what: String| Failure::Input(format!("{name}: expected whole numbers, got {what}"));
    let array = numpy
        .call_method1(intern!(py, "atleast_1d"), (value,))
        .ok()
        .and_then(|array| array.cast_into::<PyUntypedArray>().ok())
        .ok_or_else(|| refuse(value.get_type().to_string()))?;
    if array.len() > 0 && !matches!(array.dtype().kind(), b'i' | b'u' | b'b') {
        return Err(refuse(array.dtype().to_string()));
    }
    numbers::<i64>(name, &array)?
        .into_iter()
        .enumerate()
        .map(|(index, number)| {
            T::try_from(number).map_err(|_| Failure::Input(format!("{name}: entry {index} is {number}: out of range")))
        })
        .collect()
}

fn contiguous<'py, T: Element, D: numpy::ndarray::Dimension>(
    name: &str,
    value: &Bound<'py, PyAny>,
    expected: &str,
) -> Result<PyReadonlyArray<'py, T, D>, Failure> {
    let py = value.py();
    let refuse = |got: String| Failure::Input(format!("{name}: expected {expected}, got {got}"));
    let options = PyDict::new(py);
    options.set_item(intern!(py, "dtype"), T::get_dtype(py))?;
    let array = py
        .import(intern!(py, "numpy"))?
        .call_method(intern!(py, "ascontiguousarray"), (value,), Some(&options))
        .map_err(|error| refuse(error.value(py).to_string()))?;
    array.extract::<PyReadonlyArray<'py, T, D>>().map_err(|_| match array.cast::<PyUntypedArray>() {
        Ok(array) => refuse(format!("shape {:?}", array.shape())),
        Err(_) => refuse(value.get_type().to_string()),
    })
}

/// A numpy array that owns what the vector held, row-major.
pub fn array<'py, T: Element>(py: Python<'py>, values: Vec<T>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    Ok(values.into_pyarray(py).reshape(shape.to_vec())?.into_any())
}

/// The same, not writable.
pub fn frozen_array<'py, T: Element>(py: Python<'py>, values: Vec<T>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let array = array(py, values, shape)?;
    array.call_method1(intern!(py, "setflags"), (false,))?;
    Ok(array)
}

/// What is wrong with a field that has the wrong type: the exception that names the field, then its cause.
pub fn field_error(py: Python<'_>, error: &PyErr) -> String {
    match error.cause(py) {
        Some(cause) => format!("{}: {}", error.value(py), cause.value(py)),
        None => error.value(py).to_string(),
    }
}
