//! Why a glTF file could not be read.

use std::path::PathBuf;

/// Why bytes are not a glTF file with lines.
#[derive(Debug, thiserror::Error)]
pub enum GltfError {
    /// Not JSON, not glTF, or it needs an extension that nobody here knows.
    #[error(transparent)]
    Document(#[from] gltf::Error),
    /// A binary file's header contradicts itself.
    #[error("offset 8: the file's length by its header is {length}, less than the header")]
    BinaryLength {
        /// The length found.
        length: u32,
    },
    /// A file without any scene shows nothing.
    #[error("the file has no scene")]
    NoScene,
    /// The scene holds no line primitives.
    #[error("the scene has no LINES, LINE_STRIP or LINE_LOOP primitive; glTF's curves are made of these")]
    NoLines,
    /// The nodes do not form a tree.
    #[error("node {node} occurs twice in the scene's tree")]
    NodeTwice {
        /// Index of the node.
        node: usize,
    },
    /// A buffer's data is not to be had.
    #[error("buffer {buffer}: {reason}")]
    Buffer {
        /// Index of the buffer.
        buffer: usize,
        /// What is wrong.
        reason: String,
    },
    /// A buffer's file cannot be read.
    #[error("buffer {buffer}: {}: {source}", path.display())]
    BufferFile {
        /// Index of the buffer.
        buffer: usize,
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// An accessor reaches out of its data, or has a type that is not expected here.
    #[error("accessor {accessor} ({usage}): {reason}")]
    Accessor {
        /// Index of the accessor.
        accessor: usize,
        /// What it is for: an attribute's name or "indices".
        usage: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A primitive that makes no sense.
    #[error("mesh {mesh}, primitive {primitive}: {reason}")]
    Primitive {
        /// Index of the mesh.
        mesh: usize,
        /// Index of the primitive in the mesh.
        primitive: usize,
        /// What is wrong.
        reason: String,
    },
    /// A per-vertex value that only some of the lines have.
    #[error("some line primitives have {name} and others have not")]
    MixedAttribute {
        /// Name of the attribute.
        name: &'static str,
    },
    /// Points are counted with 32 bits.
    #[error("the scene's lines have more than 2^32 - 1 points")]
    TooManyPoints,
}
