use glam::{DMat4, DVec3, Vec3};

use super::{Lobe, SceneError};

/// A light. Colours are scene-linear Rec.709; powers and strengths follow Blender's conventions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Infinitely far.
    Sun {
        /// Direction in which the light travels, world space.
        direction: DVec3,
        /// Irradiance on a surface facing it, W/m².
        irradiance: Vec3,
        /// Apparent diameter, radians.
        angle_rad: f64,
    },
    /// Infinitely far, and brightest about a direction: a spherical Gaussian of radiance A exp(λ (ω·d − 1)) from a unit direction ω, with d
    /// against `direction` [Khungurn2017]. As λ grows it becomes a sun, as λ goes to 0 an even sky.
    Gaussian {
        /// Direction in which the brightest light travels, world space.
        direction: DVec3,
        /// Radiance over all directions, W/m²: 2π A (1 − e^(−2λ)) / λ. Of a sharp lobe this is the irradiance on a surface facing it.
        fluence: Vec3,
        /// λ, in [`Lobe::SHARPNESS`]: 1/√λ is about the radius of the lobe in radians, where it is small.
        sharpness: f64,
    },
    /// A glowing sphere; a spot if it has a cone.
    Point {
        /// Centre, world space.
        position: DVec3,
        /// Power, W; irradiance at distance d is power / (4π d²).
        power: Vec3,
        /// Radius, m.
        radius: f64,
        /// Cone, for a spot.
        cone: Option<Cone>,
    },
    /// A one-sided emitter.
    Area {
        /// Light to world: emits along its −Z; unit square or disc of diameter 1 scaled by `size`.
        world_from_light: DMat4,
        /// Extents along X and Y, m.
        size: [f64; 2],
        /// An ellipse instead of a rectangle.
        ellipse: bool,
        /// Power, W: radiance is power / (π area).
        power: Vec3,
    },
}

/// The cone of a spot light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Axis, world space.
    pub direction: DVec3,
    /// Full opening angle, radians.
    pub angle_rad: f64,
    /// Share of the cone over which it softens, 0 to 1.
    pub blend: f64,
}

/// Checks every light.
///
/// # Errors
/// [`SceneError`] for the first that cannot shine: a value that is not finite, negative or without direction.
pub(super) fn validate(lights: &[Light]) -> Result<(), SceneError> {
    for (number, light) in lights.iter().enumerate() {
        let finite = |color: Vec3| color.is_finite() && color.cmpge(Vec3::ZERO).all();
        let reason = match *light {
            Light::Sun { direction, irradiance, angle_rad } => {
                if !direction.is_finite() || direction.length() < 1e-12 {
                    Some("the direction is zero or not finite")
                } else if !(0.0..=std::f64::consts::PI).contains(&angle_rad) {
                    Some("the angle is not between 0 and π")
                } else if !finite(irradiance) {
                    Some("the irradiance is negative or not finite")
                } else {
                    None
                }
            }
            Light::Gaussian { direction, fluence, sharpness } => {
                if !direction.is_finite() || direction.length() < 1e-12 {
                    Some("the direction is zero or not finite")
                } else if !Lobe::SHARPNESS.contains(&sharpness) {
                    Some("the sharpness is not from 1e-6 to 1e12")
                } else if !finite(fluence) {
                    Some("the strength is negative or not finite")
                } else {
                    None
                }
            }
            Light::Point { position, power, radius, cone } => {
                if !position.is_finite() {
                    Some("the position is not finite")
                } else if !finite(power) {
                    Some("the power is negative or not finite")
                } else if !(radius.is_finite() && radius >= 0.0) {
                    Some("the radius is negative or not finite")
                } else if cone.is_some_and(|c| !c.direction.is_finite() || c.direction.length() < 1e-12) {
                    Some("the cone's direction is zero or not finite")
                } else if cone.is_some_and(|c| !(0.0..=std::f64::consts::PI).contains(&c.angle_rad)) {
                    Some("the cone's angle is not between 0 and π")
                } else {
                    None
                }
            }
            Light::Area { world_from_light, size, power, .. } => {
                if !world_from_light.is_finite() || world_from_light.z_axis.length() < 1e-12 {
                    Some("the transform is not finite or flat")
                } else if !finite(power) {
                    Some("the power is negative or not finite")
                } else if !size.iter().all(|s| s.is_finite() && *s >= 0.0) {
                    Some("the size is negative or not finite")
                } else {
                    None
                }
            }
        };
        if let Some(reason) = reason {
            return Err(SceneError::input(format!("light {number}"), reason));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gaussian_that_cannot_shine_is_refused_with_the_reason() {
        let good = |direction, fluence: f32, sharpness| Light::Gaussian {
            direction,
            fluence: Vec3::splat(fluence),
            sharpness,
        };
        let sun = Light::Sun { direction: DVec3::Z, irradiance: Vec3::ONE, angle_rad: 0.0 };
        for (light, word) in [
            (good(DVec3::ZERO, 1.0, 1.0), "direction"),
            (good(DVec3::Z, -1.0, 1.0), "strength"),
            (good(DVec3::Z, f32::NAN, 1.0), "strength"),
            (good(DVec3::Z, 1.0, 0.0), "sharpness"),
            (good(DVec3::Z, 1.0, 1e13), "sharpness"),
            (good(DVec3::Z, 1.0, f64::NAN), "sharpness"),
        ] {
            let error = validate(&[sun, light]).expect_err(word).to_string();
            assert!(error.contains("light 1") && error.contains(word), "{error}");
        }
        validate(&[good(DVec3::Z, 0.0, 1e-6), good(DVec3::Z, 1.0, 1e12)]).expect("valid");
    }
}
