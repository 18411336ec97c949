use lisle_core::scattering::MaterialError;
use lisle_core::yarn::YarnError;
use thiserror::Error;

/// Why a picture could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// No adapter answers, or none has that name.
    #[error(
        "no graphics adapter{wanted}: found {found}. A Vulkan driver is needed; on Debian without a GPU: mesa-vulkan-drivers"
    )]
    NoAdapter {
        /// ` named "…"`, or nothing.
        wanted: String,
        /// Names of those that answered.
        found: String,
    },
    /// The adapter lacks something.
    #[error("adapter {adapter}: {reason}")]
    Device {
        /// Its name.
        adapter: String,
        /// What it said.
        reason: String,
    },
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
        /// Object, light, camera or setting.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The progress callback asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl Error {
    pub(crate) fn input(what: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Input { what: what.into(), reason: reason.into() }
    }
}

impl From<lisle_core::scene::SceneError> for Error {
    fn from(error: lisle_core::scene::SceneError) -> Self {
        Self::Input { what: error.what, reason: error.reason }
    }
}
