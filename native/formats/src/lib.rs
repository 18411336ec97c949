//! Lisle: yarn curves from files.
//!
//! [`load`] reads BCC and glTF (`.gltf`, `.glb`) by their content. Points stay in the file's coordinates;
//! [`Loaded::into_z_up`] turns them to the renderer's. Values are taken as they are: whether they can be drawn (NaN,
//! too few points, no curve at all) is [`lisle_core::Curves::validate`]'s to say.

pub mod bcc;
mod error;
pub mod gltf_lines;
mod loaded;

pub use error::Error;
pub use loaded::{Loaded, UpAxis};

use std::path::Path;

/// Reads the yarn curves of a file. The format is recognised by its first bytes; a file that begins like none is
/// reported as broken if its extension (`.bcc`, `.gltf`, `.glb`) is known.
///
/// # Errors
/// [`Error`], which names the file, and where in it and why.
pub fn load(path: impl AsRef<Path>) -> Result<Loaded, Error> {
    let path = path.as_ref();
    let read = |path: &Path| std::fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source });
    let bytes = read(path)?;
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_ascii_lowercase();
    let begins_with_brace = bytes.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{');
    if bytes.starts_with(b"BCC") || extension == "bcc" {
        bcc::parse(&bytes).map_err(|source| Error::Bcc { path: path.to_owned(), source })
    } else if bytes.starts_with(b"glTF") || begins_with_brace || extension == "gltf" || extension == "glb" {
        gltf_lines::parse(&bytes, path.parent()).map_err(|source| Error::Gltf { path: path.to_owned(), source })
    } else {
        Err(Error::UnknownFormat { path: path.to_owned() })
    }
}
