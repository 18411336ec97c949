//! The renderer: yarn curves become fibers in compute shaders (`shaders/`), through `wgpu`.

mod device;
mod error;
mod frame;
mod image;
mod knots;
mod layout;
mod lights;
mod pipelines;
mod renderer;
mod scene;
mod shader;
mod tables;
mod timing;
mod upload;

pub use device::{AdapterInfo, adapters};
pub use error::Error;
pub use image::{Image, Statistics};
pub use lisle_core::scene::{Camera, Cone, Lens, Light, Object, Scene, Shading};
pub use renderer::{Progress, Renderer};
pub use scene::*;

use lisle_core::{sampling, view};
