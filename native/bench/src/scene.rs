//! What is the same in every picture: yarn, material and light.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::Yarns;
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;
use lisle_gpu::{Camera, Light, Object, Scene, Settings, Shading};

use crate::views::SIZE;

/// The yarn of every model.
pub fn yarn() -> Yarn {
    Yarn::preset("cotton-1").expect("a preset of the core")
}

/// One object of the given yarns at the origin.
pub fn object(yarns: &Arc<Yarns>, yarn: Yarn) -> Object {
    Object {
        name: "yarns".into(),
        id: 1,
        yarns: Arc::clone(yarns),
        yarn: Arc::new(yarn),
        material: Arc::new(Material::preset("cotton").expect("a preset of the core")),
        world_from_object: DMat4::IDENTITY,
        labels: Default::default(),
        is_holdout: false,
    }
}

/// A sun without a penumbra.
pub fn sun() -> Light {
    Light::Sun { direction: DVec3::new(-1.0, 1.0, -2.0), irradiance: Vec3::splat(3.0), angle_rad: 0.0 }
}

/// Yarns in the light of one sun and a constant sky.
pub fn lit(yarns: &Arc<Yarns>, camera: Camera) -> Scene {
    Scene {
        objects: vec![object(yarns, yarn())],
        meshes: Vec::new(),
        lights: vec![sun()],
        ambient: Vec3::splat(0.3),
        environment: None,
        camera,
    }
}

/// Defaults of the renderer, at the size of the benchmark.
pub fn settings(shading: Shading, samples: u32) -> Settings {
    Settings { size: SIZE, samples, shading, ..Settings::default() }
}
