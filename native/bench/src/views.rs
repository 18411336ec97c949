//! Cameras of [WuYuksel2018 Table 1]: from a few stitches to the whole model.

use glam::{DMat3, DMat4, DVec3, DVec4};
use lisle_core::Yarns;
use lisle_gpu::Camera;

/// Size of every picture, pixels [WuYuksel2018 Table 1].
pub const SIZE: [u32; 2] = [1280, 960];

/// Vertical opening angle, radians.
const ANGLE_RAD: f64 = 0.6;
/// Room around the whole model, as a factor on its extent.
const MARGIN: f64 = 1.05;
/// Height of the closest picture, yarn radii: a few stitches.
const CLOSE_HEIGHT_RADII: f64 = 20.0;
/// Clip planes: the camera's distance divided and multiplied by this.
const DEPTH: f64 = 100.0;

/// A straight path away from the cloth: all cameras look along one direction.
pub struct Views {
    world_from_camera: DMat3,
    close: Viewpoint,
    full: Viewpoint,
}

#[derive(Clone, Copy)]
struct Viewpoint {
    eye: DVec3,
    /// To what the camera looks at, units of length.
    distance: f64,
}

impl Views {
    /// The path for a model. Garments are seen from the front (−Y), sheets that lie flat from above.
    pub fn of(yarns: &Yarns) -> Self {
        let points = || yarns.points().iter().map(|point| DVec3::from(point.map(f64::from)));
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
        let extent = high - low;
        let lies_flat = extent.z < extent.x.min(extent.y);
        let backward = if lies_flat { DVec3::new(0.0, -0.3, 1.0) } else { DVec3::new(0.0, -1.0, 0.3) }.normalize();
        let right = DVec3::Z.cross(backward).normalize();
        let world_from_camera = DMat3::from_cols(right, backward.cross(right), backward);
        let radius = f64::from(yarns.radii().iter().copied().fold(0.0, f32::max));

        let camera_from_world = world_from_camera.transpose();
        let middle = 0.5 * (low + high);
        let locals = || points().map(|point| camera_from_world * (point - middle));
        let local_low = locals().fold(DVec3::INFINITY, DVec3::min);
        let local_high = locals().fold(DVec3::NEG_INFINITY, DVec3::max);
        let center = 0.5 * (local_low + local_high);
        let tangent_y = (0.5 * ANGLE_RAD).tan();
        let tangent_x = tangent_y * f64::from(SIZE[0]) / f64::from(SIZE[1]);
        let needed = |local: DVec3| {
            let reach = MARGIN * ((local - center).abs() + radius);
            local.z - center.z + (reach.x / tangent_x).max(reach.y / tangent_y)
        };
        let full_distance = locals().map(needed).fold(0.0, f64::max) + radius;

        // The frontmost point near the axis of the full view: a step aside has to gain ten steps towards the camera.
        let cost = |local: DVec3| 10.0 * (local - center).truncate().length() - local.z;
        let target = locals().min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(center);
        let close_distance = 0.5 * CLOSE_HEIGHT_RADII * radius / tangent_y;
        let viewpoint = |target: DVec3, distance: f64| Viewpoint {
            eye: middle + world_from_camera * (target + DVec3::Z * distance),
            distance,
        };
        Self { world_from_camera, close: viewpoint(target, close_distance), full: viewpoint(center, full_distance) }
    }

    /// A few stitches.
    pub fn close(&self) -> Camera {
        self.between(0.0)
    }

    /// The whole model.
    pub fn full(&self) -> Camera {
        self.between(1.0)
    }

    /// From close (0) to full (1), by equal factors of the distance.
    pub fn between(&self, share: f64) -> Camera {
        let Self { close, full, .. } = self;
        let distance = close.distance * (full.distance / close.distance).powf(share);
        let along = (distance - close.distance) / (full.distance - close.distance);
        let eye = close.eye.lerp(full.eye, along);
        let rotation = DMat4::from_mat3(self.world_from_camera);
        perspective(DMat4::from_translation(eye) * rotation, distance)
    }
}

fn perspective(world_from_camera: DMat4, distance: f64) -> Camera {
    let y = 1.0 / (0.5 * ANGLE_RAD).tan();
    let x = y * f64::from(SIZE[1]) / f64::from(SIZE[0]);
    let (near, far) = (distance / DEPTH, distance * DEPTH);
    let clip_from_camera = DMat4::from_cols(
        DVec4::new(x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, y, 0.0, 0.0),
        DVec4::new(0.0, 0.0, (near + far) / (near - far), -1.0),
        DVec4::new(0.0, 0.0, 2.0 * near * far / (near - far), 0.0),
    );
    Camera { world_from_camera, clip_from_camera, lens: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_screen(camera: &Camera, point: [f32; 3]) -> DVec3 {
        let clip_from_world = camera.clip_from_camera * camera.world_from_camera.inverse();
        clip_from_world.project_point3(DVec3::from(point.map(f64::from)))
    }

    fn visible(camera: &Camera, yarns: &Yarns) -> usize {
        let inside = |p: &&[f32; 3]| on_screen(camera, **p).abs().max_element() <= 1.0;
        yarns.points().iter().filter(inside).count()
    }

    #[test]
    fn full_shows_all_close_shows_some_and_the_rest_lies_between() {
        let yarns = Yarns::new(lisle_fabric::sweater(20_000).expect("a garment"), None).expect("valid curves");
        let views = Views::of(&yarns);
        let all = yarns.points().len();
        assert_eq!(visible(&views.full(), &yarns), all);
        let reach = yarns.points().iter().map(|p| on_screen(&views.full(), *p).truncate().abs().max_element());
        assert!(reach.fold(0.0, f64::max) > 0.9, "the model is small in the full view");
        let counts = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| visible(&views.between(share), &yarns));
        assert!(counts.is_sorted(), "{counts:?}");
        assert!(counts[0] > 20 && counts[0] < all / 5, "{} of {all}", counts[0]);
    }
}
