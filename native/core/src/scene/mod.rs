//! What is drawn, whoever draws it: objects, lights, a camera. Plain data, checked when a picture begins.

mod light;

pub use light::{Cone, Light, validate_lights};

use std::sync::Arc;

use glam::{DMat4, Vec3};
use thiserror::Error;

use crate::scattering::Material;
use crate::strands::Yarns;
use crate::yarn::Yarn;

/// Yarn curves at a place, with what they are made of.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name for messages.
    pub name: String,
    /// Number delivered in the object-id pass; also seeds the fibers, so that two objects differ.
    pub id: u32,
    /// The curves, object space.
    pub yarns: Arc<Yarns>,
    /// The procedural yarn.
    pub yarn: Arc<Yarn>,
    /// How its fibers scatter.
    pub material: Arc<Material>,
    /// Object to world.
    pub world_from_object: DMat4,
}

/// A camera: two matrices and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Camera to world; the camera looks down its −Z, Y is up.
    pub world_from_camera: DMat4,
    /// Projection to OpenGL clip space (z from −1 to 1), lens shift included.
    pub clip_from_camera: DMat4,
}

/// A picture's content.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Yarns.
    pub objects: Vec<Object>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Constant radiance from everywhere, scene-linear.
    pub ambient: Vec3,
    /// Viewpoint.
    pub camera: Camera,
}

/// Which formulas shade a fiber.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// Diffuse and the lobe of [WuYuksel2018 Eq. 5].
    Simple,
    /// R + TT [Khungurn2015] and diffuse.
    #[default]
    Physical,
}

/// A part of a scene that cannot be drawn.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{what}: {reason}")]
pub struct SceneError {
    /// Light or camera.
    pub what: String,
    /// What is wrong with it.
    pub reason: String,
}
