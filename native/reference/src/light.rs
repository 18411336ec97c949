//! Lights as a path tracer uses them: a direction drawn for a point, and what a ray that went elsewhere meets.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec3};
use lisle_core::sampling::{Random, basis, disc, sphere};
use lisle_core::scene::{Cone, Environment, Light, Lobe};

/// A direction drawn towards a light.
pub(crate) struct LightSample {
    /// Unit, towards the light.
    pub direction: DVec3,
    pub distance: f64,
    /// Radiance from there divided by `pdf`.
    pub irradiance: DVec3,
    /// Over the solid angle; infinite for a light without extent.
    pub pdf: f64,
}

/// What a ray meets of a light.
pub(crate) struct Glow {
    pub distance: f64,
    pub radiance: DVec3,
    /// Density with which [`Emitter::sample`] draws that direction.
    pub pdf: f64,
}

/// A light, in the space of the fibers.
pub(crate) enum Emitter {
    /// Parallel light, or a disc at infinity; `tangent` is that of half its diameter.
    Sun { toward: DVec3, axes: (DVec3, DVec3), irradiance: DVec3, tangent: f64 },
    /// All around, infinitely far, with radiance in proportion to its density.
    Gaussian { lobe: Lobe, fluence: DVec3 },
    /// A sphere of even radiance, or a point.
    Point { center: DVec3, power: DVec3, radius: f64, cone: Option<Cone> },
    /// One side of a parallelogram or an ellipse.
    Area(Box<Panel>),
    /// All around, infinitely far.
    Sky(Environment),
}

/// An area light.
pub(crate) struct Panel {
    /// From the plane of the unit square or of the disc of diameter 1, and back.
    space_from_unit: DMat4,
    unit_from_space: DMat4,
    /// The side that shines.
    axis: DVec3,
    area: f64,
    ellipse: bool,
    power: DVec3,
}

impl Emitter {
    /// `origin`: of the space, in the world.
    pub fn new(light: &Light, origin: DVec3) -> Self {
        match *light {
            Light::Sun { direction, irradiance, angle_rad } => {
                let toward = -direction.normalize();
                // As wide as the renderer's sun can be.
                let tangent = (0.5 * angle_rad.min(3.1)).tan();
                Self::Sun { toward, axes: basis(toward), irradiance: irradiance.as_dvec3(), tangent }
            }
            Light::Gaussian { direction, fluence, sharpness } => {
                Self::Gaussian { lobe: Lobe::new(-direction, sharpness), fluence: fluence.as_dvec3() }
            }
            Light::Point { position, power, radius, cone } => {
                Self::Point { center: position - origin, power: power.as_dvec3(), radius, cone }
            }
            Light::Area { world_from_light, size, ellipse, power } => {
                let scale = DMat4::from_scale(DVec3::new(size[0], size[1], 1.0));
                let space_from_unit = DMat4::from_translation(-origin) * world_from_light * scale;
                let across = |v: DVec3| space_from_unit.transform_vector3(v);
                let area = across(DVec3::X).cross(across(DVec3::Y)).length() * if ellipse { PI / 4.0 } else { 1.0 };
                Self::Area(Box::new(Panel {
                    space_from_unit,
                    unit_from_space: space_from_unit.inverse(),
                    axis: -world_from_light.transform_vector3(DVec3::Z).normalize(),
                    area,
                    ellipse,
                    power: power.as_dvec3(),
                }))
            }
        }
    }

    /// Whether rays can meet it by chance.
    pub fn has_extent(&self) -> bool {
        match self {
            Self::Sun { tangent, .. } => *tangent > 0.0,
            Self::Point { radius, .. } => *radius > 0.0,
            Self::Area(panel) => panel.area > 0.0,
            Self::Gaussian { .. } | Self::Sky(_) => true,
        }
    }

    /// A direction from a point; `None` where the light does not shine.
    pub fn sample(&self, point: DVec3, random: &mut Random) -> Option<LightSample> {
        let uniform = random.pair();
        match self {
            Self::Sun { toward, axes, irradiance, tangent } => {
                let [u, v] = disc(uniform).map(|c| c * tangent);
                let direction = (*toward + axes.0 * u + axes.1 * v).normalize();
                let pdf = sun_density(direction.dot(*toward), *tangent);
                Some(LightSample { direction, distance: f64::INFINITY, irradiance: *irradiance, pdf })
            }
            Self::Gaussian { lobe, fluence } => {
                let direction = lobe.sample(uniform);
                let pdf = lobe.pdf(direction);
                Some(LightSample { direction, distance: f64::INFINITY, irradiance: *fluence, pdf })
            }
            Self::Point { center, power, radius, cone } => {
                let to_center = *center - point;
                let distance_squared = to_center.length_squared();
                let power = *power * spot(cone.as_ref(), to_center);
                if power == DVec3::ZERO || distance_squared == 0.0 {
                    return None;
                }
                if *radius == 0.0 {
                    let distance = distance_squared.sqrt();
                    let irradiance = power / (4.0 * PI * distance_squared);
                    let pdf = f64::INFINITY;
                    return Some(LightSample { direction: to_center / distance, distance, irradiance, pdf });
                }
                let radiance = power / (4.0 * PI * PI * radius * radius);
                let solid_angle = sphere_solid_angle(distance_squared, *radius);
                let direction = if solid_angle >= 2.0 * TAU {
                    sphere(uniform)
                } else {
                    let axis = to_center / distance_squared.sqrt();
                    let (x, y) = basis(axis);
                    // 1 − cos of the angle to the axis is uniform.
                    let lowered = uniform[0] * solid_angle / TAU;
                    let sine = (lowered * (2.0 - lowered)).max(0.0).sqrt();
                    let (sin, cos) = (TAU * uniform[1]).sin_cos();
                    (axis * (1.0 - lowered) + (x * cos + y * sin) * sine).normalize()
                };
                // At the rim rounding may miss it: the nearest point of the ray serves.
                let distance = sphere_distance(to_center, direction, *radius).unwrap_or(to_center.dot(direction));
                Some(LightSample { direction, distance, irradiance: radiance * solid_angle, pdf: 1.0 / solid_angle })
            }
            Self::Area(panel) => {
                let Panel { space_from_unit, axis, area, ellipse, power, .. } = &**panel;
                let [u, v] = if *ellipse { disc(uniform).map(|c| 0.5 * c) } else { uniform.map(|c| c - 0.5) };
                let to_light = space_from_unit.transform_point3(DVec3::new(u, v, 0.0)) - point;
                let distance_squared = to_light.length_squared();
                let distance = distance_squared.sqrt();
                let direction = to_light / distance.max(1e-300);
                let cos = -direction.dot(*axis);
                (cos > 0.0).then(|| LightSample {
                    direction,
                    distance,
                    irradiance: *power * (cos / (PI * distance_squared)),
                    pdf: distance_squared / (area * cos),
                })
            }
            Self::Sky(sky) => {
                let direction = sky.sample(uniform);
                let pdf = sky.pdf(direction);
                let irradiance = sky.radiance(direction) / pdf;
                (pdf > 0.0).then_some(LightSample { direction, distance: f64::INFINITY, irradiance, pdf })
            }
        }
    }

    /// Radiance of what lies behind everything, in a direction.
    pub fn background(&self, direction: DVec3) -> DVec3 {
        if let Self::Sky(sky) = self { sky.radiance(direction) } else { DVec3::ZERO }
    }

    /// What a ray of unit direction meets of it.
    pub fn meet(&self, point: DVec3, direction: DVec3) -> Option<Glow> {
        match self {
            Self::Sun { toward, irradiance, tangent, .. } => {
                let cos = direction.dot(*toward);
                let is_inside = cos > 0.0 && direction.cross(*toward).length() <= tangent * cos;
                is_inside.then(|| {
                    let pdf = sun_density(cos, *tangent);
                    Glow { distance: f64::INFINITY, radiance: *irradiance * pdf, pdf }
                })
            }
            Self::Gaussian { lobe, fluence } => {
                let pdf = lobe.pdf(direction);
                Some(Glow { distance: f64::INFINITY, radiance: *fluence * pdf, pdf })
            }
            Self::Point { center, power, radius, cone } => {
                let to_center = *center - point;
                let distance = sphere_distance(to_center, direction, *radius)?;
                let radiance = *power * spot(cone.as_ref(), to_center) / (4.0 * PI * PI * radius * radius);
                let pdf = 1.0 / sphere_solid_angle(to_center.length_squared(), *radius);
                Some(Glow { distance, radiance, pdf })
            }
            Self::Area(panel) => {
                let Panel { unit_from_space, axis, area, ellipse, power, .. } = &**panel;
                let cos = -direction.dot(*axis);
                let (from, along) =
                    (unit_from_space.transform_point3(point), unit_from_space.transform_vector3(direction));
                let distance = -from.z / along.z;
                if cos <= 0.0 || distance <= 0.0 || !distance.is_finite() {
                    return None;
                }
                let at = (from + along * distance).truncate();
                let is_inside = if *ellipse { at.length() <= 0.5 } else { at.abs().max_element() <= 0.5 };
                let radiance = *power / (PI * area);
                is_inside.then(|| Glow { distance, radiance, pdf: distance * distance / (area * cos) })
            }
            Self::Sky(sky) => {
                let (radiance, pdf) = (sky.radiance(direction), sky.pdf(direction));
                Some(Glow { distance: f64::INFINITY, radiance, pdf })
            }
        }
    }
}

/// Density over the solid angle of directions to a disc drawn evenly in the plane at distance 1.
fn sun_density(cos: f64, tangent: f64) -> f64 {
    1.0 / (PI * tangent * tangent * cos.powi(3))
}

/// 2π (1 − √(1 − r²/d²)); the whole sphere from within.
fn sphere_solid_angle(distance_squared: f64, radius: f64) -> f64 {
    let share = radius * radius / distance_squared;
    if share >= 1.0 { 2.0 * TAU } else { TAU * share / (1.0 + (1.0 - share).sqrt()) }
}

/// Where a ray meets a sphere: its near side, or the far one from within.
fn sphere_distance(to_center: DVec3, direction: DVec3, radius: f64) -> Option<f64> {
    let along = to_center.dot(direction);
    let half = radius * radius - (to_center - direction * along).length_squared();
    if half < 0.0 {
        return None;
    }
    let (near, far) = (along - half.sqrt(), along + half.sqrt());
    if near > 0.0 { Some(near) } else { (far > 0.0).then_some(far) }
}

/// Factor of a spot's cone: as `shaders/light/sample.wgsl`, seen from the sphere's centre.
fn spot(cone: Option<&Cone>, to_center: DVec3) -> f64 {
    let Some(cone) = cone else { return 1.0 };
    let edge = (0.5 * cone.angle_rad).cos();
    let full = edge + ((1.0 - edge) * cone.blend.clamp(0.0, 1.0)).max(1e-6);
    let cos = -to_center.normalize_or_zero().dot(cone.direction.normalize());
    let x = ((cos - edge) / (full - edge)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Lights with extent, and a point that each shines on.
    fn lights() -> Vec<(&'static str, Light)> {
        let power = Vec3::splat(50.0);
        let turned = DMat4::from_translation(DVec3::new(0.2, 0.1, 3.0)) * DMat4::from_rotation_x(0.4);
        let point = |position, radius, cone| Light::Point { position, power, radius, cone };
        let gaussian = |sharpness| Light::Gaussian { direction: DVec3::new(0.3, 0.2, -1.0), fluence: power, sharpness };
        let cone = Cone { direction: DVec3::new(0.1, 0.0, -1.0), angle_rad: 0.9, blend: 0.5 };
        let area = |ellipse| Light::Area { world_from_light: turned, size: [2.0, 1.0], ellipse, power };
        vec![
            ("sun", Light::Sun { direction: DVec3::new(0.3, 0.2, -1.0), irradiance: Vec3::ONE, angle_rad: 0.6 }),
            ("wide Gaussian", gaussian(0.5)),
            ("Gaussian", gaussian(20.0)),
            ("sphere", point(DVec3::new(0.5, 0.4, 2.0), 0.7, None)),
            ("sphere about the point", point(DVec3::new(0.1, 0.0, 0.2), 1.0, None)),
            ("spot", point(DVec3::new(0.1, 0.2, 3.0), 0.5, Some(cone))),
            ("rectangle", area(false)),
            ("ellipse", area(true)),
        ]
    }

    /// ∫ radiance dω and ∫ pdf dω by even directions, the first also by the light's own.
    fn integrals(emitter: &Emitter) -> [f64; 3] {
        let mut random = Random::new(1, 2, 3);
        let n = 400_000;
        let (mut met, mut density, mut drawn) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            if let Some(glow) = emitter.meet(DVec3::ZERO, sphere(random.pair())) {
                met += glow.radiance.x;
                density += glow.pdf;
            }
            drawn += emitter.sample(DVec3::ZERO, &mut random).map_or(0.0, |sample| sample.irradiance.x);
        }
        let whole = 4.0 * PI / f64::from(n);
        [met * whole, density * whole, drawn / f64::from(n)]
    }

    #[test]
    fn a_light_is_as_bright_when_drawn_as_when_met() {
        for (name, light) in lights() {
            let [met, density, drawn] = integrals(&Emitter::new(&light, DVec3::ZERO));
            println!("{name}: {met} met, {drawn} drawn, density {density}");
            assert!((met / drawn - 1.0).abs() < 0.03, "{name}: {met} met, {drawn} drawn");
            assert!((density - 1.0).abs() < 0.03, "{name}: {density}");
        }
    }

    #[test]
    fn samples_have_the_radiance_and_density_of_what_is_met_there() {
        for (name, light) in lights() {
            let emitter = Emitter::new(&light, DVec3::new(1.0, 2.0, 3.0));
            let point = DVec3::new(-1.0, -2.0, -3.0);
            let mut random = Random::new(4, 5, 6);
            for _ in 0..100 {
                let Some(sample) = emitter.sample(point, &mut random) else { continue };
                // A direction at the rim may miss by rounding; a little inwards none does.
                let Some(glow) = emitter.meet(point, sample.direction) else { continue };
                assert!((glow.pdf / sample.pdf - 1.0).abs() < 1e-6, "{name}");
                assert!((glow.radiance.x / (sample.irradiance.x * sample.pdf) - 1.0).abs() < 1e-6, "{name}");
                assert!(
                    glow.distance == sample.distance || (glow.distance / sample.distance - 1.0).abs() < 1e-6,
                    "{name}"
                );
            }
        }
    }

    #[test]
    fn small_lights_have_the_irradiance_of_points() {
        let (power, height) = (Vec3::splat(50.0), 4.0);
        let position = DVec3::Z * height;
        let mut random = Random::new(7, 8, 9);
        let of_point = 50.0 / (4.0 * PI * height * height);
        for radius in [0.0, 0.01] {
            let emitter = Emitter::new(&Light::Point { position, power, radius, cone: None }, DVec3::ZERO);
            let sample = emitter.sample(DVec3::ZERO, &mut random).expect("light");
            assert!((sample.irradiance.x / of_point - 1.0).abs() < 1e-4);
        }
        // A one-sided square sends P/π to where it faces, by the square of the distance.
        let panel =
            Light::Area { world_from_light: DMat4::from_translation(position), size: [0.01; 2], ellipse: false, power };
        let sample = Emitter::new(&panel, DVec3::ZERO).sample(DVec3::ZERO, &mut random).expect("light");
        assert!((sample.irradiance.x / (4.0 * of_point) - 1.0).abs() < 1e-3);
        assert!(Emitter::new(&panel, DVec3::ZERO).sample(DVec3::Z * 8.0, &mut random).is_none(), "its back is dark");
    }
}
