use glam::DVec3;

/// Axes at a point of a round fiber's surface: x along the surface normal, y along tangent × normal, z along the tangent.
///
/// Directions in these axes are what [`super::FiberScattering`] takes: `z` is sin θ, the azimuth is that about the surface normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberFrame {
    normal: DVec3,
    side: DVec3,
    tangent: DVec3,
}

impl FiberFrame {
    /// From a unit tangent and the surface normal, which may lean along the fiber where its radius changes: that part is left
    /// out, so that the normal is the one of a cylinder. Any normal across the fiber serves where it has no other part.
    pub fn new(tangent: DVec3, normal: DVec3) -> Self {
        let across = normal - tangent * tangent.dot(normal);
        let normal = across.try_normalize().unwrap_or_else(|| tangent.any_orthonormal_vector());
        Self { normal, side: tangent.cross(normal), tangent }
    }

    /// Components of a world direction along the axes.
    pub fn local_from_world(&self, direction: DVec3) -> DVec3 {
        DVec3::new(direction.dot(self.normal), direction.dot(self.side), direction.dot(self.tangent))
    }

    /// The world direction of given components.
    pub fn world_from_local(&self, direction: DVec3) -> DVec3 {
        self.normal * direction.x + self.side * direction.y + self.tangent * direction.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_are_a_right_handed_frame_and_invert() {
        let tangent = DVec3::new(1.0, 2.0, -2.0) / 3.0;
        for normal in [DVec3::X, DVec3::new(0.2, -0.9, 0.4), tangent, DVec3::ZERO] {
            let frame = FiberFrame::new(tangent, normal);
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| frame.world_from_local(axis));
            assert!((x.cross(y) - z).length() < 1e-12 && (z - tangent).length() < 1e-12);
            let direction = DVec3::new(0.1, -0.7, 0.3);
            assert!((frame.local_from_world(frame.world_from_local(direction)) - direction).length() < 1e-12);
        }
    }
}
