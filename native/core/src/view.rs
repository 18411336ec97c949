//! From a scene's camera to pixels and rays in render space: the world's axes, the camera at the origin.

use glam::{DMat3, DMat4, DVec3, DVec4, Mat4, Vec4, Vec4Swizzles};

use crate::scene::{Camera, Lens, SceneError};

/// Axis-aligned box in render space.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Least coordinates.
    pub min: DVec3,
    /// Greatest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// Holds nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Grows to hold a point.
    pub fn include(&mut self, point: DVec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// Grows to hold another box.
    pub fn merge(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// The box with so much more on every side.
    pub fn grown(&self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    /// Its eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), self.max, self.min))
    }

    /// Of the box's image under a transform.
    pub fn transformed(&self, matrix: &DMat4) -> Self {
        let mut image = Self::EMPTY;
        if !self.is_empty() {
            self.corners().into_iter().for_each(|c| image.include(matrix.transform_point3(c)));
        }
        image
    }
}

/// The camera in render space.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// World position of the render space's origin.
    pub origin: DVec3,
    /// Whether all rays are parallel.
    pub orthographic: bool,
    /// Rows x, y, w, z of pixel space for the whole frame, before the jitter.
    rows: [DVec4; 4],
    /// Pixels per unit of length at distance 1 along the view axis (perspective) or everywhere (orthographic).
    pub pixels_per_unit: f64,
    /// Distance of the near plane; −∞ if everything in an orthographic view counts.
    pub near: f64,
    /// Distance of the far plane; ∞ if there is none.
    pub far: f64,
    /// Direction towards the viewer and 1 (orthographic), or the origin and 0.
    pub viewer: Vec4,
    /// What blurs the picture.
    pub lens: Option<Lens>,
    /// X and Y of camera space, in render space.
    axes: [DVec3; 2],
}

impl View {
    /// The view of a frame of `size` pixels.
    ///
    /// # Errors
    /// [`SceneError`] for matrices that are not finite, have no inverse or no near plane.
    pub fn new(camera: &Camera, size: [u32; 2]) -> Result<Self, SceneError> {
        let invalid = |reason: &str| SceneError::input("camera", reason);
        if !camera.world_from_camera.is_finite() || !camera.clip_from_camera.is_finite() {
            return Err(invalid("a matrix has an entry that is not finite"));
        }
        if camera.world_from_camera.determinant().abs() < 1e-30 {
            return Err(invalid("world_from_camera has no inverse"));
        }
        camera.lens.map_or(Ok(()), |lens| lens.validate())?;
        let origin = camera.world_from_camera.w_axis.xyz();
        let mut camera_from_world = camera.world_from_camera;
        camera_from_world.w_axis = DVec4::W;
        let camera_from_render = camera_from_world.inverse();
        let clip = camera.clip_from_camera.transpose();
        let orthographic = clip.w_axis.xyz() == DVec3::ZERO;
        let [cx, cy, cw] = [clip.x_axis, clip.y_axis, clip.w_axis].map(|row| camera_from_render.transpose() * row);
        let z = -camera_from_render.transpose().z_axis;
        let (width, height) = (f64::from(size[0]), f64::from(size[1]));
        let projection = camera.clip_from_camera;
        let scale = (projection.x_axis.x * width / 2.0 * projection.y_axis.y * height / 2.0).abs().sqrt();
        if !(scale.is_finite() && scale > 0.0) {
            return Err(invalid("clip_from_camera is no perspective or orthographic projection"));
        }
        // z of clip space is A z_camera + B; the planes are where clip z = ∓ clip w.
        let (a, b) = (projection.z_axis.z, projection.w_axis.z);
        let (near, far) = if orthographic { ((b + 1.0) / a, (b - 1.0) / a) } else { (b / (a - 1.0), b / (a + 1.0)) };
        if !near.is_finite() || (!orthographic && near <= 0.0) {
            return Err(invalid("clip_from_camera has no near plane in front of the camera"));
        }
        let toward = camera_from_render.inverse().transform_vector3(DVec3::Z).normalize();
        Ok(Self {
            origin,
            orthographic,
            rows: [(cx + cw) * (width / 2.0), (cw - cy) * (height / 2.0), cw, z],
            pixels_per_unit: scale,
            near,
            far: if far.is_finite() && far > near { far } else { f64::INFINITY },
            viewer: if orthographic { toward.as_vec3().extend(1.0) } else { Vec4::ZERO },
            lens: camera.lens,
            axes: [camera.world_from_camera.x_axis.xyz(), camera.world_from_camera.y_axis.xyz()],
        })
    }

    /// The view through one point of the lens, given in camera space: sheared, so that the plane in focus stays where it is.
    pub fn through(&self, lens: &Lens, [x, y]: [f64; 2]) -> Self {
        let [px, py, w, z] = self.rows;
        // A point at depth z looks as if it were moved by -offset (1 - z / focus), which is 0 in focus.
        let offset = self.axes[0] * x + self.axes[1] * y;
        let away = z / lens.focus_distance - DVec4::W;
        let shear = |row: DVec4| row + away * row.xyz().dot(offset);
        let viewer = if self.orthographic {
            let backward = self.viewer.xyz().as_dvec3();
            let per_depth = backward / -z.xyz().dot(backward);
            (per_depth * lens.focus_distance + offset).normalize().as_vec3().extend(1.0)
        } else {
            offset.as_vec3().extend(0.0)
        };
        Self { rows: [shear(px), shear(py), w, z], viewer, ..*self }
    }

    /// Pixel space of the frame, shifted so that the sample `jitter` off a pixel's centre lands on it.
    pub fn pixel_from_render(&self, jitter: [f64; 2]) -> Mat4 {
        let [x, y, w, z] = self.rows;
        let (x, y) = (x - w * jitter[0], y - w * jitter[1]);
        DMat4::from_cols(x, y, w, z).transpose().as_mat4()
    }

    /// Where a point of the world is on the frame, pixels from the top left; `None` if it is no farther than the near plane.
    pub fn pixel(&self, world: DVec3) -> Option<[f64; 2]> {
        let point = (world - self.origin).extend(1.0);
        let [x, y, w, z] = self.rows.map(|row| row.dot(point));
        (z > self.near).then(|| [x / w, y / w])
    }

    /// Nearest and farthest distance along the view axis within a box, cut at the near plane.
    pub fn depth_range(&self, bounds: &Bounds) -> (f64, f64) {
        let depths = bounds.corners().map(|c| self.rows[3].dot(c.extend(1.0)));
        let near = depths.into_iter().fold(f64::INFINITY, f64::min).max(self.near);
        let far = depths.into_iter().fold(f64::NEG_INFINITY, f64::max).min(self.far);
        (near, far.max(near + 1e-6 * near.abs().max(1e-6)))
    }

    /// (a, b) of a hardware's depth (a z + b) / w for the distance z along the view axis: 1 at the near plane or, in an orthographic view,
    /// before a box if that is farther; 0 at the far plane or behind the box.
    pub fn clip_depth(&self, bounds: &Bounds) -> [f32; 2] {
        if !self.orthographic {
            let (a, b) = if self.far.is_finite() {
                let share = self.near / (self.far - self.near);
                (-share, share * self.far)
            } else {
                (0.0, self.near)
            };
            return [a as f32, b as f32];
        }
        let (near, far) = self.depth_range(bounds);
        // A surface at the border counts, and f32 tells the planes of a flat box apart.
        let margin = 1e-3 * (far - near + far.abs().max(near.abs()));
        let (near, far) = ((near - margin).max(self.near), (far + margin).min(self.far));
        [(-1.0 / (far - near)) as f32, (far / (far - near)) as f32]
    }

    /// Pixels per unit of length at a point, render space; no nearer than the near plane.
    pub fn pixels_per_unit_at(&self, point: DVec3) -> f64 {
        let w = self.rows[2].dot(point.extend(1.0));
        self.pixels_per_unit / if self.orthographic { w } else { w.max(self.near) }
    }

    /// Where the ray through a place on the frame (pixels from the top left) lies at distance 0 along the view axis, and how far it
    /// moves per unit of that distance: a distance along the ray in units of its direction is a depth.
    pub fn ray(&self, pixel: [f64; 2]) -> (DVec3, DVec3) {
        let [x, y, w, z] = self.rows;
        let (a, b) = (x - w * pixel[0], y - w * pixel[1]);
        let inverse = DMat3::from_cols(a.xyz(), b.xyz(), z.xyz()).transpose().inverse();
        (inverse * -DVec3::new(a.w, b.w, z.w), inverse.z_axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [320, 200];

    fn views() -> [View; 2] {
        let world_from_camera = DMat4::from_translation(DVec3::new(3.0, -7.0, 2.0)) * DMat4::from_rotation_x(1.1);
        let perspective = DMat4::from_cols_array_2d(&[
            [2.0, 0.0, 0.0, 0.0],
            [0.0, 3.2, 0.0, 0.0],
            [0.3, -0.2, -1.002, -1.0],
            [0.0, 0.0, -0.2002, 0.0],
        ]);
        let orthographic = DMat4::from_cols_array_2d(&[
            [0.5, 0.0, 0.0, 0.0],
            [0.0, 0.8, 0.0, 0.0],
            [0.0, 0.0, -0.02, 0.0],
            [0.3, -0.2, -1.002, 1.0],
        ]);
        [perspective, orthographic].map(|clip_from_camera| {
            let camera = Camera { world_from_camera, clip_from_camera, lens: None };
            View::new(&camera, SIZE).expect("a valid camera")
        })
    }

    #[test]
    fn a_ray_meets_its_pixel_at_every_depth() {
        for view in views() {
            for pixel in [[0.5, 0.5], [160.0, 100.0], [319.5, 3.25], [17.0, 199.0]] {
                let (origin, direction) = view.ray(pixel);
                for depth in [0.7, 5.0, 60.0] {
                    let point = (origin + direction * depth).extend(1.0);
                    let [x, y, w, z] = view.rows.map(|row| row.dot(point));
                    let found = [x / w, y / w, z];
                    let expected = [pixel[0], pixel[1], depth];
                    for (found, expected) in found.into_iter().zip(expected) {
                        assert!((found - expected).abs() < 1e-9 * (1.0 + expected), "{found} instead of {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn rays_through_a_lens_meet_where_it_is_in_focus() {
        let lens = Lens { aperture_radius: 0.5, focus_distance: 6.0, blades: 0, rotation_rad: 0.0, ratio: 1.0 };
        let at = [0.3, -0.2];
        for view in views() {
            let moved = view.through(&lens, at);
            for pixel in [[160.0, 100.0], [17.0, 199.0]] {
                let ((origin, direction), (other, turned)) = (view.ray(pixel), moved.ray(pixel));
                assert!((origin + direction * 6.0).distance(other + turned * 6.0) < 1e-9);
                // At depth 0 they start on the lens.
                let expected = view.axes[0] * at[0] + view.axes[1] * at[1];
                assert!((other - origin).distance(expected) < 1e-9, "{} for {expected}", other - origin);
                // The ray runs away from the viewer.
                let toward = moved.viewer.xyz().as_dvec3();
                let along = if moved.orthographic { toward } else { (toward - (other + turned * 3.0)).normalize() };
                assert!(along.dot(turned.normalize()) < -1.0 + 1e-6);
            }
        }
    }

    #[test]
    fn sizes_are_those_of_pixels() {
        for view in views() {
            let (origin, direction) = view.ray([160.0, 100.0]);
            let (beside, onward) = view.ray([161.0, 100.0]);
            let point = origin + direction * 6.0;
            // The pixels of these views are as wide as high.
            let found = 1.0 / view.pixels_per_unit_at(point);
            let expected = (beside + onward * 6.0).distance(point);
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} for {expected}");
        }
    }

    #[test]
    fn rays_start_at_the_eye_or_run_parallel() {
        let [perspective, orthographic] = views();
        assert!(perspective.ray([12.0, 180.0]).0.length() < 1e-12);
        let (a, b) = (orthographic.ray([0.0, 0.0]), orthographic.ray([100.0, 50.0]));
        assert!(a.1.distance(b.1) < 1e-12 && a.0.distance(b.0) > 0.1);
    }
}
