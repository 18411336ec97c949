//! From every error of the crates below to the exceptions of `lisle.errors`.

use pyo3::PyErr;
use pyo3::exceptions::PyOSError;

mod exceptions {
    #![allow(missing_docs)]
    pyo3::import_exception!(lisle.errors, Cancelled);
    pyo3::import_exception!(lisle.errors, DeviceError);
    pyo3::import_exception!(lisle.errors, Error);
    pyo3::import_exception!(lisle.errors, InputError);
}

/// What stops a call.
pub enum Failure {
    /// Something was given that cannot be used.
    Input(String),
    /// The adapter is missing or failed.
    Device(String),
    /// The progress callback returned False.
    Cancelled(String),
    /// A file could not be read or written.
    File(String),
    /// A fault of ours.
    Internal(String),
    /// An exception of Python's, to go on as it is.
    Python(PyErr),
}

impl Failure {
    /// The same, where a name says which of several things it is about.
    pub fn of(self, name: &str) -> Self {
        match self {
            Self::Input(message) if !name.is_empty() => Self::Input(format!("{name}: {message}")),
            other => other,
        }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Input(message) => exceptions::InputError::new_err(message),
            Failure::Device(message) => exceptions::DeviceError::new_err(message),
            Failure::Cancelled(message) => exceptions::Cancelled::new_err(message),
            Failure::File(message) => PyOSError::new_err(message),
            Failure::Internal(message) => exceptions::Error::new_err(message),
            Failure::Python(error) => error,
        }
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

/// Errors of which every variant is about what was given.
macro_rules! input_errors {
    ($($error:ty),+ $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::Input(error.to_string())
            }
        })+
    };
}

input_errors!(
    lisle_core::Error,
    lisle_core::scene::SceneError,
    lisle_core::yarn::YarnError,
    lisle_fabric::Error,
    lisle_formats::Error,
);

impl From<lisle_gpu::Error> for Failure {
    fn from(error: lisle_gpu::Error) -> Self {
        let message = error.to_string();
        match error {
            lisle_gpu::Error::Cancelled => Self::Cancelled(message),
            lisle_gpu::Error::NoAdapter { .. } | lisle_gpu::Error::Device { .. } => Self::Device(message),
            _ => Self::Input(message),
        }
    }
}

impl From<lisle_reference::Error> for Failure {
    fn from(error: lisle_reference::Error) -> Self {
        let message = error.to_string();
        match error {
            lisle_reference::Error::Cancelled => Self::Cancelled(message),
            _ => Self::Input(message),
        }
    }
}

impl From<lisle_reference::fibers::FibersError> for Failure {
    fn from(error: lisle_reference::fibers::FibersError) -> Self {
        lisle_reference::Error::from(error).into()
    }
}
