use lisle_core::scene::SceneError;
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
    /// A part of the scene cannot be drawn.
    #[error(transparent)]
    Scene(#[from] SceneError),
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
