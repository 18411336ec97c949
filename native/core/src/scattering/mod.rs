//! Scattering of light by one fiber: pure functions, in f64 [WuYuksel2018 §4.3; Khungurn2015].

mod material;

pub use material::{MATERIAL_NAMES, Material, MaterialError};
