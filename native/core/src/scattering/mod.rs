//! Scattering of light by one fiber: pure functions, in f64 [WuYuksel2018 §4.3; Khungurn2015].
//!
//! **Contract.** Both directions point away from the fiber: ω_i towards the light, ω_o towards the viewer. θ is the angle
//! to the plane across the fiber (positive on the side of its tangent), φ = φ_o − φ_i the azimuth between the two. The specular
//! cone is θ_o = −θ_i; φ = 0 is the lit side, φ = π straight through. A scattering function S gives the radiance of
//! a fiber, averaged over its width, L_o = ∫ L_i S cos θ_i dω_i. The cosine is part of it: [WuYuksel2018, Eq. 7] leaves it out, while Eq. 8's cos² has it.
//! The share of the light that leaves the fiber again is ∫ S cos θ_o dω_o.

mod angles;
mod azimuthal;
#[cfg(test)]
mod battery;
mod fabrics;
mod fiber;
mod frame;
mod lobe;
mod longitudinal;
mod material;
mod multiple;
mod physical;
mod quadrature;
mod simple;
mod tables;
mod thread;

pub use angles::FiberAngles;
pub use azimuthal::{von_mises, von_mises_scale};
pub use fabrics::{FABRICS, Fabric, fabric_threads};
pub use fiber::{FiberScattering, PhysicalFiber, ScatteringSample, SimpleFiber};
pub use frame::FiberFrame;
pub use longitudinal::{gaussian, gaussian_integral};
pub use material::{MATERIAL_NAMES, MIN_WIDTH_RAD, Material, MaterialError};
pub use multiple::cloth_color;
pub use physical::{
    AmbientFactors, Normalizers, albedo, fiber_scattering, fresnel, physical_ambient, physical_reflected,
};
pub use simple::{highlight, highlight_scale, simple_ambient, simple_reflected};
pub use tables::{ScatteringTables, TABLE_SIZE};
pub use thread::{
    THREAD_SCALE, THREAD_TABLE_SIZE, Thread, ThreadError, ThreadTables, dielectric_reflectance, thread_printed,
    thread_terms,
};
