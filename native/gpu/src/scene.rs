//! What is drawn: plain data, checked when a frame begins.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scattering::Material;
use lisle_core::strands::Yarns;
use lisle_core::yarn::Yarn;

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

/// Which ambient occlusion [WuYuksel2018 §4.2].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Occlusion {
    /// Cubic in the distance from the yarn centre.
    #[default]
    Distance,
    /// Precomputed over the yarn's section.
    Table,
}

/// How it is drawn.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Pixels of the whole frame.
    pub size: [u32; 2],
    /// Part of the frame to draw: left, top, width, height in pixels, from the top left; `None` for all.
    pub region: Option<[u32; 4]>,
    /// Jittered samples per pixel, ≥ 1.
    pub samples: u32,
    /// Shading model.
    pub shading: Shading,
    /// Occlusion method.
    pub occlusion: Occlusion,
    /// Fibers thinner than this many pixels are merged, omega_LoD of [WuYuksel2018 Eq. 4]; 0 draws every fiber.
    pub lod_pixels: f32,
    /// Leaves the background transparent, otherwise it is the ambient radiance.
    pub transparent: bool,
    /// Width of the Blackman–Harris pixel filter, pixels; 0 for a point sample at the centre of each pixel.
    pub filter_width: f32,
    /// Texels along one side of a shadow map.
    pub shadow_resolution: u32,
    /// Seeds the sample sequence.
    pub seed: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: [1280, 960],
            region: None,
            samples: 16,
            shading: Shading::Physical,
            occlusion: Occlusion::Distance,
            lod_pixels: 1.0,
            transparent: true,
            filter_width: 1.5,
            shadow_resolution: 2048,
            seed: 0,
        }
    }
}
