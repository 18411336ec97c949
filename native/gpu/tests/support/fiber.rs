//! A fiber alone.

use std::sync::Arc;

use glam::DVec3;
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;
use lisle_gpu::{Camera, Object};

use super::{curves, looking, object, orthographic, preset, twin, without_flyaways, yarns_of};

/// One straight fiber, so thin against its yarn that its own shadow and occlusion are within a thousandth of none; its yarn is one
/// segment.
pub fn lone_fiber(material: Material) -> Object {
    straight_fiber(material, 2)
}

/// The same on a yarn of so many knots.
pub fn straight_fiber(material: Material, knots: usize) -> Object {
    let yarn = Yarn {
        plies: 1,
        fibers_per_ply: 1,
        r_min: 1.0,
        fiber_twist: 1e4,
        ply_twist: 1e4,
        fiber_radius: 5e-4 * preset("silk-1").ellipse_long,
        ..without_flyaways(preset("silk-1"))
    };
    Object { material: Arc::new(material), ..object(&yarns_of(curves::straight(2.0, knots), false, 0.2), &yarn) }
}

/// Close-up of the fiber from a direction: it is 40 pixels wide.
pub fn close_up(object: &Object, from: DVec3, size: [u32; 2]) -> Camera {
    let target = twin::fiber_position(object, object.yarns.points().len() / 2 - 1, 0.5);
    orthographic(looking(target + from.normalize(), target), f64::from(size[1]) / 20.0 * 0.2 * 5e-4, size, [0.0, 0.0])
}
