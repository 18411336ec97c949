use lisle_core::scene::SceneError;
use thiserror::Error;

use crate::fibers::FibersError;

/// Why a picture could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A part of the scene cannot be drawn.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A setting, or the environment.
    #[error("{what}: {reason}")]
    Input {
        /// Which.
        what: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// The fibers cannot be made.
    #[error(transparent)]
    Fibers(FibersError),
    /// A checkpoint that is not of this picture.
    #[error("the checkpoint {0}")]
    Checkpoint(&'static str),
    /// The progress callback asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<FibersError> for Error {
    fn from(error: FibersError) -> Self {
        match error {
            FibersError::Cancelled => Self::Cancelled,
            other => Self::Fibers(other),
        }
    }
}
