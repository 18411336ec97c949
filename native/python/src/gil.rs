//! The one place that releases the GIL, and the way back to Python from there.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::prelude::*;

use crate::error::Failure;

/// Does long work while other Python threads run. A panic in it becomes an error that `except Exception` catches, which
/// `PanicException` is not: inside Blender it would end the process.
pub fn detached<T: Send, E: Into<Failure> + Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, E> + Send,
) -> Result<T, Failure> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(work))) {
        Ok(result) => result.map_err(Into::into),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
            Err(Failure::Internal(format!("internal error: {text}")))
        }
    }
}

/// Threads for all that runs on the processor from now on; whether they could still be set, which is before the first of such work.
#[pyfunction]
pub fn set_threads(count: usize) -> bool {
    rayon::ThreadPoolBuilder::new().num_threads(count).build_global().is_ok()
}

/// Threads that work on the processor.
#[pyfunction]
pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// Python's word in a long call: the progress callback, and Ctrl-C.
pub struct Listener {
    callback: Option<Py<PyAny>>,
    raised: Option<PyErr>,
}

impl Listener {
    /// A listener with or without a callback, which takes the finished fraction and returns False to cancel.
    pub fn new(callback: Option<Py<PyAny>>) -> Self {
        Self { callback, raised: None }
    }

    /// Tells Python how far the work is, from the thread that does it.
    pub fn report(&mut self, fraction: f64) -> ControlFlow<()> {
        let go_on = Python::attach(|py| {
            py.check_signals()?;
            match &self.callback {
                None => Ok(true),
                Some(callback) => {
                    let answer = callback.bind(py).call1((fraction,))?;
                    Ok(answer.is_none() || answer.is_truthy()?)
                }
            }
        });
        match go_on {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(error) => {
                self.raised = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// The result of the work, unless Python raised an exception in the meantime: that goes first.
    pub fn outcome<T>(self, result: Result<T, Failure>) -> Result<T, Failure> {
        match self.raised {
            Some(error) => Err(Failure::Python(error)),
            None => result,
        }
    }
}
