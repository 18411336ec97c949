use glam::{DMat3, DMat4, DQuat, DVec3, Vec4Swizzles};

use super::{Camera, Lens};

/// The rotation nearest to a transform's axes in their order: X stays, Y stays in its plane. Mirrored ones are turned over.
fn rotation(matrix: &DMat4) -> DQuat {
    let mirror = matrix.determinant().signum();
    let (x, y) = (matrix.x_axis.xyz() * mirror, matrix.y_axis.xyz() * mirror);
    let x = x.normalize();
    let y = (y - x * x.dot(y)).normalize();
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y)))
}

/// A transform on the way from one to another, by `share` of it: what turns keeps its size. Both must have an inverse.
pub fn between(a: &DMat4, b: &DMat4, share: f64) -> DMat4 {
    if a == b {
        return *a;
    }
    let (turn_a, turn_b) = (rotation(a), rotation(b));
    let rest = |matrix: &DMat4, turn: DQuat| DMat3::from_quat(turn.conjugate()) * DMat3::from_mat4(*matrix);
    let (rest_a, rest_b) = (rest(a, turn_a), rest(b, turn_b));
    let linear = DMat3::from_quat(turn_a.slerp(turn_b, share)) * (rest_a * (1.0 - share) + rest_b * share);
    let translation: DVec3 = a.w_axis.xyz().lerp(b.w_axis.xyz(), share);
    DMat4::from_cols(
        linear.x_axis.extend(0.0),
        linear.y_axis.extend(0.0),
        linear.z_axis.extend(0.0),
        translation.extend(1.0),
    )
}

impl Camera {
    /// The camera on the way to another, by `share` of it. A lens blurs if either does.
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let mix_lens = |a: Lens, b: Lens| Lens {
            aperture_radius: mix(a.aperture_radius, b.aperture_radius),
            focus_distance: mix(a.focus_distance, b.focus_distance),
            rotation_rad: mix(a.rotation_rad, b.rotation_rad),
            ratio: mix(a.ratio, b.ratio),
            ..a
        };
        let lens = match (self.lens, other.lens) {
            (Some(a), Some(b)) => Some(mix_lens(a, b)),
            (a, b) => a.or(b),
        };
        let (a, b) = (self.clip_from_camera, other.clip_from_camera);
        Self {
            world_from_camera: between(&self.world_from_camera, &other.world_from_camera, share),
            clip_from_camera: if a == b { a } else { a * (1.0 - share) + b * share },
            lens,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheared() -> DMat4 {
        DMat4::from_cols_array_2d(&[
            [2.0, 0.3, 0.0, 0.0],
            [0.1, 1.0, -0.4, 0.0],
            [0.0, 0.2, 0.5, 0.0],
            [3.0, 4.0, 5.0, 1.0],
        ])
    }

    #[test]
    fn ends_are_the_transforms_themselves() {
        let mirrored = sheared() * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        for (a, b) in [(DMat4::IDENTITY, sheared()), (mirrored, mirrored * DMat4::from_rotation_z(1.0))] {
            assert!(between(&a, &b, 0.0).abs_diff_eq(a, 1e-12));
            assert!(between(&a, &b, 1.0).abs_diff_eq(b, 1e-12));
        }
    }

    #[test]
    fn what_turns_keeps_its_size() {
        let a = DMat4::from_scale(DVec3::splat(2.0));
        let b = DMat4::from_rotation_z(2.0) * a;
        let half = between(&a, &b, 0.5);
        assert!(half.abs_diff_eq(DMat4::from_rotation_z(1.0) * a, 1e-12));
        // Entries mixed by themselves would shrink it.
        assert!((a * 0.5 + b * 0.5).determinant() < 0.5 * a.determinant());
    }
}
