use glam::DVec3;

/// Directions of light and viewer relative to a fiber: see the contract in [`crate::scattering`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberAngles {
    /// sin θ_i.
    pub sin_theta_i: f64,
    /// cos θ_i ≥ 0.
    pub cos_theta_i: f64,
    /// sin θ_o.
    pub sin_theta_o: f64,
    /// cos θ_o ≥ 0.
    pub cos_theta_o: f64,
    /// cos φ; 0 where either direction lies along the fiber and φ has no meaning.
    pub cos_phi: f64,
}

impl FiberAngles {
    /// From the longitudinal angles and the azimuth, radians.
    pub fn from_radians(theta_i: f64, theta_o: f64, phi: f64) -> Self {
        Self {
            sin_theta_i: theta_i.sin(),
            cos_theta_i: theta_i.cos(),
            sin_theta_o: theta_o.sin(),
            cos_theta_o: theta_o.cos(),
            cos_phi: phi.cos(),
        }
    }

    /// From unit vectors in one space: the fiber's tangent, the directions to the light and to the viewer.
    pub fn from_directions(tangent: DVec3, to_light: DVec3, to_viewer: DVec3) -> Self {
        let (sin_theta_i, sin_theta_o) = (tangent.dot(to_light), tangent.dot(to_viewer));
        let (across_i, across_o) = (to_light - tangent * sin_theta_i, to_viewer - tangent * sin_theta_o);
        let (cos_theta_i, cos_theta_o) = (across_i.length(), across_o.length());
        let product = cos_theta_i * cos_theta_o;
        let cos_phi = if product > 1e-9 { (across_i.dot(across_o) / product).clamp(-1.0, 1.0) } else { 0.0 };
        Self { sin_theta_i, cos_theta_i, sin_theta_o, cos_theta_o, cos_phi }
    }

    /// θ_i, radians in [−π/2, π/2]. By the arc tangent, which keeps its digits at grazing angles.
    pub fn theta_i_rad(&self) -> f64 {
        self.sin_theta_i.atan2(self.cos_theta_i)
    }

    /// θ_o, radians in [−π/2, π/2].
    pub fn theta_o_rad(&self) -> f64 {
        self.sin_theta_o.atan2(self.cos_theta_o)
    }

    /// θ_o + θ_i, radians in [−π, π]: the distance from the specular cone, twice the half angle θ_h.
    pub fn cone_offset_rad(&self) -> f64 {
        let sin = self.sin_theta_o * self.cos_theta_i + self.cos_theta_o * self.sin_theta_i;
        let cos = self.cos_theta_o * self.cos_theta_i - self.sin_theta_o * self.sin_theta_i;
        sin.atan2(cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A direction of given longitude and azimuth around the z axis.
    fn direction(theta: f64, phi: f64) -> DVec3 {
        DVec3::new(theta.cos() * phi.cos(), theta.cos() * phi.sin(), theta.sin())
    }

    #[test]
    fn directions_and_angles_agree() {
        for (theta_i, theta_o, phi_i, phi_o) in
            [(0.3, -0.2, 0.4, 2.9), (1.5, 1.4, -2.0, 1.0), (-1.2, 0.0, 0.0, 0.0), (0.0, 0.9, 3.0, -3.0)]
        {
            let a = FiberAngles::from_directions(DVec3::Z, direction(theta_i, phi_i), direction(theta_o, phi_o));
            let b = FiberAngles::from_radians(theta_i, theta_o, phi_o - phi_i);
            assert!((a.cos_phi - b.cos_phi).abs() < 1e-12);
            assert!((a.theta_i_rad() - theta_i).abs() < 1e-12 && (a.theta_o_rad() - theta_o).abs() < 1e-12);
            assert!((a.cone_offset_rad() - (theta_i + theta_o)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_direction_along_the_fiber_gives_finite_angles() {
        let a = FiberAngles::from_directions(DVec3::Z, DVec3::Z, DVec3::X);
        assert_eq!((a.cos_theta_i, a.cos_phi), (0.0, 0.0));
    }
}
