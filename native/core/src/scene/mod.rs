//! What is drawn, whoever draws it: objects, lights, a camera. Plain data, checked when a picture begins.

mod environment;
mod lens;
mod light;
mod lobe;
mod mesh;
mod motion;

pub use environment::{Environment, EnvironmentImage};
pub use lens::Lens;
pub use light::{Cone, Light};
pub use lobe::Lobe;
pub use mesh::{Mesh, MeshKind, Texture, Triangles};
pub use motion::between;

use std::sync::Arc;

use glam::{DMat4, Vec3};
use thiserror::Error;

use crate::scattering::{Material, MaterialError};
use crate::strands::Yarns;
use crate::yarn::{Yarn, YarnError};

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
    /// What passes call it.
    pub labels: Labels,
    /// Whether it is a hole in the picture: it hides what is behind, casts shadows, and shows nothing itself.
    pub is_holdout: bool,
}

/// What passes call an object, besides its name and id.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Labels {
    /// The object's index.
    pub index: u32,
    /// Name of its material.
    pub material: String,
    /// The material's index.
    pub material_index: u32,
}

/// A camera: two matrices, and a lens if what is out of focus is blurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Camera to world; the camera looks down its −Z, Y is up.
    pub world_from_camera: DMat4,
    /// Projection to OpenGL clip space (z from −1 to 1), lens shift included.
    pub clip_from_camera: DMat4,
    /// The lens; `None` for a pinhole.
    pub lens: Option<Lens>,
}

/// A picture's content.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Yarns.
    pub objects: Vec<Object>,
    /// What hides them, throws shadows on them and takes theirs.
    pub meshes: Vec<Mesh>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Constant radiance from everywhere, scene-linear.
    pub ambient: Vec3,
    /// Radiance from everywhere, added to that.
    pub environment: Option<Environment>,
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
pub enum SceneError {
    /// An object's yarn is out of range.
    #[error("object \"{object}\": {source}")]
    Yarn {
        /// The object's name.
        object: String,
        /// The parameter.
        source: YarnError,
    },
    /// An object's material is out of range.
    #[error("object \"{object}\": {source}")]
    Material {
        /// The object's name.
        object: String,
        /// The parameter.
        source: MaterialError,
    },
    /// Something else.
    #[error("{what}: {reason}")]
    Input {
        /// Object, light, camera or sky.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
}

impl SceneError {
    pub(crate) fn input(what: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Input { what: what.into(), reason: reason.into() }
    }
}

impl Object {
    fn validate(&self) -> Result<(), SceneError> {
        let object = || self.name.clone();
        self.yarn.validate().map_err(|source| SceneError::Yarn { object: object(), source })?;
        self.material.validate().map_err(|source| SceneError::Material { object: object(), source })?;
        if !self.world_from_object.is_finite() || self.world_from_object.determinant() == 0.0 {
            let what = format!("object \"{}\"", self.name);
            return Err(SceneError::input(what, "its transform is not finite, or has a scale of zero along an axis"));
        }
        Ok(())
    }
}

impl Scene {
    /// Checks all but the camera, which [`crate::view::View::new`] checks.
    ///
    /// # Errors
    /// [`SceneError`] for the first part that cannot be drawn.
    pub fn validate(&self) -> Result<(), SceneError> {
        if !self.ambient.is_finite() || self.ambient.min_element() < 0.0 {
            let reason = format!("{}: expected finite radiances of at least 0", self.ambient);
            return Err(SceneError::input("ambient", reason));
        }
        self.environment.as_ref().map_or(Ok(()), Environment::validate)?;
        light::validate(&self.lights)?;
        self.meshes.iter().try_for_each(Mesh::validate)?;
        self.objects.iter().try_for_each(Object::validate)
    }
}
