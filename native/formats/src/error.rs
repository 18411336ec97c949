//! Why a file could not be read.

use crate::bcc::BccError;
use crate::gltf_lines::GltfError;
use std::path::PathBuf;

/// Why a file of yarn curves could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is neither BCC nor glTF.
    #[error("{}: neither BCC nor glTF by its first bytes or its extension", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A BCC file is broken.
    #[error("{}: BCC: {source}", path.display())]
    Bcc {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: BccError,
    },
    /// A glTF file is broken or holds no lines.
    #[error("{}: glTF: {source}", path.display())]
    Gltf {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: GltfError,
    },
}
