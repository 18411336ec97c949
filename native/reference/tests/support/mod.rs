//! What several tests share: yarns of one fiber, cameras, pictures.
#![allow(dead_code, reason = "each test crate uses a part")]

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4, Vec3};
use lisle_core::scattering::Material;
use lisle_core::scene::{Camera, Light, Object, Scene};
use lisle_core::yarn::Yarn;
use lisle_core::{Curves, Yarns};
use lisle_reference::{Image, Reference, Settings};

/// Radius of the fibers here.
pub const RADIUS: f64 = 0.1;

/// How much wider than its yarn the fiber of [`single_fiber`] is.
const OVERSIZE: f64 = 1e6;

/// A yarn that is a single fiber without turns and flyaways, at a distance from the yarn's centre that is next to nothing.
pub fn single_fiber() -> Yarn {
    let mut yarn = Yarn::preset("cotton-1").expect("preset");
    yarn.plies = 1;
    yarn.fibers_per_ply = 1;
    yarn.ellipse_long = 1.0;
    yarn.ellipse_short = 1.0;
    yarn.ply_radius = 0.0;
    yarn.fiber_radius = OVERSIZE;
    yarn.fiber_twist = 1e20;
    yarn.ply_twist = 1e20;
    yarn.r_min = 1.0;
    yarn.flyaways.loop_density = 0.0;
    yarn.flyaways.hair_density = 0.0;
    yarn
}

/// Straight curves between pairs of points, for fibers of that radius by [`single_fiber`].
pub fn straight(ends: &[[DVec3; 2]], radius: f64) -> Arc<Yarns> {
    let curves = ends
        .iter()
        .map(|[a, b]| (0..=4).map(|i| a.lerp(*b, f64::from(i) / 4.0).as_vec3().to_array()).collect())
        .collect();
    Arc::new(Yarns::new(Curves::catmull_rom(curves, false), Some((radius / OVERSIZE) as f32)).expect("valid curves"))
}

/// A Lambert fiber of that albedo: a cylinder of the simple model without highlight.
pub fn lambert(albedo: f64) -> Material {
    Material { diffuse: DVec3::splat(albedo), specular: DVec3::ZERO, ..Material::preset("silk").expect("preset") }
}

/// An object at the origin.
pub fn object(yarns: &Arc<Yarns>, yarn: &Yarn, material: Material) -> Object {
    Object {
        name: "yarn".into(),
        id: 1,
        yarns: Arc::clone(yarns),
        yarn: Arc::new(yarn.clone()),
        material: Arc::new(material),
        world_from_object: DMat4::IDENTITY,
        labels: Default::default(),
        is_holdout: false,
    }
}

/// A sun that shines along a direction, white.
pub fn sun(direction: DVec3, irradiance: f32) -> Light {
    Light::Sun { direction, irradiance: Vec3::splat(irradiance), angle_rad: 0.0 }
}

/// Camera at `eye` that looks at `target` with +Z, or +Y if it looks along Z, upwards.
pub fn looking(eye: DVec3, target: DVec3) -> DMat4 {
    let back = (eye - target).normalize();
    let up = if back.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z };
    let right = up.cross(back).normalize();
    DMat4::from_cols(right.extend(0.0), back.cross(right).extend(0.0), back.extend(0.0), eye.extend(1.0))
}

/// Orthographic, `height` units high.
pub fn orthographic(world_from_camera: DMat4, height: f64, size: [u32; 2]) -> Camera {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let (near, far) = (1e-3, 1e3);
    Camera {
        world_from_camera,
        clip_from_camera: DMat4::from_cols(
            DVec4::new(2.0 / (height * aspect), 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 / height, 0.0, 0.0),
            DVec4::new(0.0, 0.0, -2.0 / (far - near), 0.0),
            DVec4::new(0.0, 0.0, -(far + near) / (far - near), 1.0),
        ),
        lens: None,
    }
}

/// A scene of one object.
pub fn scene(object: Object, lights: Vec<Light>, ambient: f32, camera: Camera) -> Scene {
    Scene {
        objects: vec![object],
        meshes: Vec::new(),
        lights,
        ambient: Vec3::splat(ambient),
        environment: None,
        camera,
    }
}

/// What is ready to be drawn.
pub fn prepare(scene: &Scene, settings: &Settings) -> Reference {
    Reference::new(scene, settings, &mut || ControlFlow::Continue(())).expect("a scene")
}

/// Draws.
pub fn draw(scene: &Scene, settings: &Settings) -> Image {
    let reference = prepare(scene, settings);
    let mut film = reference.film();
    reference.render(&mut film, &mut |_| ControlFlow::Continue(())).expect("a picture");
    film.image()
}

/// Mean of the red channel over all pixels, and its standard error.
pub fn mean(image: &Image) -> (f64, f64) {
    let n = image.combined.len() as f64;
    let mean = image.combined.iter().map(|c| f64::from(c[0])).sum::<f64>() / n;
    let variance = image.variance.iter().map(|v| f64::from(v[0])).sum::<f64>() / (n * n);
    (mean, variance.sqrt())
}
