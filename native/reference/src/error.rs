use lisle_core::scattering::MaterialError;
use lisle_core::scene::SceneError;
use lisle_core::yarn::YarnError;
use thiserror::Error;

use crate::fibers::FibersError;

/// Why a picture could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A light or the camera.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An object's yarn is out of range.
    #[error("object \"{object}\": {source}")]
    Yarn {
        /// The object's name.
        object: String,
        /// The parameter.
        source: YarnError,
    },
    /// An object's material is out of range.
    #[error("object \"{object}\": {source}")]
    Material {
        /// The object's name.
        object: String,
        /// The parameter.
        source: MaterialError,
    },
    /// Something else in the scene or the settings.
    #[error("{what}: {reason}")]
    Input {
        /// Object or setting.
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
