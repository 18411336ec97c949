//! The reference: every fiber explicit, and light scattered between them as often as it likes. Slow and right, it says how far
//! off the renderer is; nothing of it runs on a GPU.

pub mod assembly;
pub mod cone;
mod error;
pub mod fibers;
mod film;
mod hierarchy;
mod light;
mod material;
mod path;
mod render;
mod settings;
mod shutter;
mod surfaces;
mod tangent;
mod world;

pub use error::Error;
pub use film::{Film, Image};
#[doc(hidden)]
pub use material::NearField;
pub use render::Reference;
pub use settings::Settings;
