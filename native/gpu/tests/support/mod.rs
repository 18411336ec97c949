//! What several tests share: one renderer a test binary, scenes, cameras, pictures to look at.
#![allow(dead_code, reason = "each test crate uses a part")]

pub mod curves;
pub mod fiber;
pub mod measure;
pub mod picture;
pub mod quiet;
pub mod twin;

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use glam::{DMat4, DVec3, DVec4, Vec3};
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;
use lisle_core::{Curves, Yarns};
use lisle_gpu::{Camera, Error, Exposure, Image, Light, Object, Renderer, Scene, Settings};

/// The renderer of this test binary, with a logger that [`draw`] consults.
pub fn renderer() -> &'static Renderer {
    static RENDERER: OnceLock<Renderer> = OnceLock::new();
    RENDERER.get_or_init(another_renderer)
}

/// A renderer of one's own.
pub fn another_renderer() -> Renderer {
    quiet::install();
    Renderer::new(None).expect("an adapter")
}

/// Draws, and fails the test on any error, also on one that only the log tells.
pub fn draw(scene: &Scene, settings: &Settings) -> Image {
    draw_with(renderer(), scene, settings)
}

/// The same on a given renderer.
pub fn draw_with(renderer: &Renderer, scene: &Scene, settings: &Settings) -> Image {
    let image = try_draw_with(renderer, scene, settings).expect("a picture");
    quiet::assert_quiet();
    image
}

/// Draws what may be refused.
pub fn try_draw(scene: &Scene, settings: &Settings) -> Result<Image, Error> {
    try_draw_with(renderer(), scene, settings)
}

/// Draws what moves.
pub fn expose(exposure: &Exposure, settings: &Settings) -> Image {
    let image = renderer().expose(exposure.clone(), settings, &mut |_| ControlFlow::Continue(())).expect("a picture");
    quiet::assert_quiet();
    image
}

fn try_draw_with(renderer: &Renderer, scene: &Scene, settings: &Settings) -> Result<Image, Error> {
    renderer.render(scene, settings, &mut |_| ControlFlow::Continue(()))
}

/// Point samples of every fiber, light scattered once: what a twin can follow.
pub fn exact(size: [u32; 2]) -> Settings {
    Settings {
        size,
        samples: 1,
        filter_width: 0.0,
        lod_pixels: 0.0,
        shadow_resolution: 64,
        transport_photons: 0,
        ..Settings::default()
    }
}

/// Yarns of one Catmull-Rom curve.
pub fn yarns_of(points: Vec<[f32; 3]>, closed: bool, radius: f32) -> Arc<Yarns> {
    Arc::new(Yarns::new(Curves::catmull_rom(vec![points], closed), Some(radius)).expect("valid curves"))
}

/// A preset.
pub fn preset(name: &str) -> Yarn {
    Yarn::preset(name).expect(name)
}

/// The same yarn without loops and hairs.
pub fn without_flyaways(mut yarn: Yarn) -> Yarn {
    yarn.flyaways.loop_density = 0.0;
    yarn.flyaways.hair_density = 0.0;
    yarn
}

/// An object at the origin, of fibers that show light from every angle.
pub fn object(yarns: &Arc<Yarns>, yarn: &Yarn) -> Object {
    Object {
        name: "yarn".into(),
        id: 1,
        yarns: Arc::clone(yarns),
        yarn: Arc::new(yarn.clone()),
        material: Arc::new(Material { diffuse_weight: 0.5, ..Material::preset("cotton-2").expect("preset") }),
        world_from_object: DMat4::IDENTITY,
        labels: Default::default(),
        is_holdout: false,
    }
}

/// Objects under an ambient sky without lights.
pub fn scene(objects: Vec<Object>, camera: Camera) -> Scene {
    Scene { objects, meshes: Vec::new(), lights: Vec::new(), ambient: Vec3::ONE, environment: None, camera }
}

/// A sun that shines along a direction.
pub fn sun(direction: [f64; 3], irradiance: f32) -> Light {
    Light::Sun { direction: DVec3::from(direction), irradiance: Vec3::splat(irradiance), angle_rad: 0.0 }
}

/// Camera at `eye` that looks at `target` with +Z, or +Y if it looks along Z, upwards.
pub fn looking(eye: DVec3, target: DVec3) -> DMat4 {
    let back = (eye - target).normalize();
    let up = if back.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z };
    let right = up.cross(back).normalize();
    let up = back.cross(right);
    DMat4::from_cols(right.extend(0.0), up.extend(0.0), back.extend(0.0), eye.extend(1.0))
}

/// Perspective: `tangent` is that of half the vertical field of view; `shift` in picture heights.
pub fn perspective(world_from_camera: DMat4, tangent: f64, size: [u32; 2], shift: [f64; 2]) -> Camera {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let (near, far) = (1e-3, 1e4);
    let (x, y) = (1.0 / (tangent * aspect), 1.0 / tangent);
    Camera {
        world_from_camera,
        clip_from_camera: DMat4::from_cols(
            DVec4::new(x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, y, 0.0, 0.0),
            DVec4::new(2.0 * shift[0] / aspect, 2.0 * shift[1], (near + far) / (near - far), -1.0),
            DVec4::new(0.0, 0.0, 2.0 * near * far / (near - far), 0.0),
        ),
        lens: None,
    }
}

/// Orthographic: `height` is the picture's, in units of length; `shift` in picture heights.
pub fn orthographic(world_from_camera: DMat4, height: f64, size: [u32; 2], shift: [f64; 2]) -> Camera {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let (near, far) = (1e-3, 1e3);
    Camera {
        world_from_camera,
        clip_from_camera: DMat4::from_cols(
            DVec4::new(2.0 / (height * aspect), 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 / height, 0.0, 0.0),
            DVec4::new(0.0, 0.0, -2.0 / (far - near), 0.0),
            DVec4::new(-2.0 * shift[0] / aspect, -2.0 * shift[1], -(far + near) / (far - near), 1.0),
        ),
        lens: None,
    }
}

/// A file of the data folder; `None`, said aloud, if it is not there.
pub fn data(path: &str) -> Option<PathBuf> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("LISLE_DATA").map_or_else(|| root.join("../shared/data"), Into::into);
    let file = folder.join(path);
    if !file.exists() {
        // Not by a macro, whose lines a passing test keeps to itself.
        let _ = writeln!(std::io::stderr(), "skipped: no data ({path})");
        return None;
    }
    Some(file)
}
