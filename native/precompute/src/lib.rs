//! Tables of a yarn: self-shadow, ambient occlusion, core fiber, which depend on its parameters alone, and with a material multiple scattering.
//!
//! **Section coordinates.** A point q of a yarn's cross-section, in units of the yarn's outer radius, in the frame that turns with
//! the plies: ply j's centre lies at angle 2πj/K. The section repeats after 1/K of a turn.

mod arrangement;
mod bundle;
mod core_fiber;
mod density;
#[cfg(test)]
mod explicit;
mod occlusion;
mod ply_view;
mod profile;
mod self_shadow;
mod tables;
mod transport;

use glam::DVec3;
use lisle_core::yarn::YarnPoint;

pub use arrangement::TURNS;
pub use bundle::Bundle;
pub use core_fiber::CoreFiber;
pub use density::SectionDensity;
pub use occlusion::Occlusion;
pub use ply_view::HOLE;
pub use self_shadow::{HALF_WAY, SeenFrom, SelfShadow};
pub use tables::Tables;
pub use transport::{Transport, TransportSize, TransportStore};

/// The centre of a yarn of outer radius 1 along z.
fn straight(length: f64) -> YarnPoint {
    YarnPoint {
        position: DVec3::ZERO,
        velocity: DVec3::Z,
        tangent: DVec3::Z,
        normal: DVec3::X,
        binormal: DVec3::Y,
        normal_rate: DVec3::ZERO,
        binormal_rate: DVec3::ZERO,
        length,
        length_rate: 1.0,
        radius: 1.0,
        radius_rate: 0.0,
    }
}
