//! The renderer: yarn curves become fibers in compute shaders (`shaders/`), through `wgpu`.

mod aov;
mod arrays;
pub mod cryptomatte;
mod device;
mod environment;
mod error;
mod frame;
mod image;
mod knots;
mod layout;
#[cfg(test)]
mod lighting_tests;
mod lights;
mod mesh_raster;
mod meshes;
mod motion;
mod noise;
mod pipelines;
mod renderer;
mod scene;
mod scene_tables;
mod shader;
mod tables;
mod timing;
mod upload;
mod waiting;
mod word_texture;

pub use aov::Aov;
pub use device::{AdapterInfo, adapters};
pub use error::Error;
pub use image::{Image, Statistics};
pub use lisle_core::sampling::Filter;
pub use lisle_core::scene::{
    Camera, Cone, Environment, EnvironmentImage, Labels, Lens, Light, Mesh, MeshKind, Object, Scene, Shading, Texture,
    Triangles,
};
pub use motion::Exposure;
pub use renderer::{Progress, Renderer};
pub use scene::*;

use lisle_core::{sampling, view};
