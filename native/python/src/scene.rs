//! What is drawn, from the dataclasses of the package.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_gpu::{Aov, Camera, Cone, Filter, Labels, Lens, Light, Object, Occlusion, Scene, Settings, Shading};
use pyo3::prelude::*;

use crate::environment::EnvironmentFields;
use crate::error::Failure;
use crate::material::extract_material;
use crate::mesh::MeshFields;
use crate::yarn::extract_yarn;
use crate::yarns::Yarns;

/// A matrix by rows.
pub type Rows = [[f64; 4]; 4];

/// `lisle.Object`, by its attributes.
#[derive(FromPyObject)]
pub struct ObjectFields<'py> {
    yarns: Bound<'py, Yarns>,
    yarn: Bound<'py, PyAny>,
    material: Bound<'py, PyAny>,
    world_from_object: Rows,
    object_id: u32,
    name: String,
    object_index: u32,
    material_name: String,
    material_index: u32,
    is_holdout: bool,
}

/// One of `lisle.Light`, by its attributes: the variants are told apart by what they have.
#[derive(FromPyObject)]
pub enum LightFields {
    /// `lisle.Spot`
    Spot {
        position: [f64; 3],
        direction: [f64; 3],
        power: f32,
        color: [f32; 3],
        radius: f64,
        cone_angle_rad: f64,
        blend: f64,
    },
    /// `lisle.Area`
    Area { world_from_light: Rows, size: [f64; 2], power: f32, color: [f32; 3], shape: String },
    /// `lisle.Point`
    Point { position: [f64; 3], power: f32, color: [f32; 3], radius: f64 },
    /// `lisle.Gaussian`
    Gaussian { direction: [f64; 3], strength: f32, color: [f32; 3], sharpness: f64 },
    /// `lisle.Sun`
    Sun { direction: [f64; 3], strength: f32, color: [f32; 3], angle_rad: f64 },
}

/// The keyword arguments of a render that are settings.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct SettingsItems {
    size: [u32; 2],
    region: Option<[u32; 4]>,
    samples: u32,
    shading: String,
    transport_photons: u32,
    occlusion: String,
    transparent: bool,
    lod_pixels: f32,
    filter: String,
    filter_width: f32,
    noise_threshold: f32,
    time_limit_s: Option<f64>,
    table_resolution: u32,
    sky_directions: u32,
    shadow_resolution: u32,
    seed: u32,
    first_sample: u32,
    passes: Vec<String>,
}

/// A matrix from its rows.
pub fn matrix(rows: Rows) -> DMat4 {
    DMat4::from_cols_array_2d(&rows).transpose()
}

impl ObjectFields<'_> {
    fn object(self) -> Result<Object, Failure> {
        let of = |failure: Failure| failure.of(&self.name);
        Ok(Object {
            id: self.object_id,
            yarns: self.yarns.get().yarns.clone(),
            yarn: Arc::new(extract_yarn(&self.yarn).map_err(of)?),
            material: Arc::new(extract_material(&self.material).map_err(of)?),
            world_from_object: matrix(self.world_from_object),
            is_holdout: self.is_holdout,
            labels: Labels {
                index: self.object_index,
                material: self.material_name,
                material_index: self.material_index,
            },
            name: self.name,
        })
    }
}

impl From<LightFields> for Light {
    fn from(fields: LightFields) -> Self {
        match fields {
            LightFields::Sun { direction, strength, color, angle_rad } => {
                Self::Sun { direction: direction.into(), irradiance: strength * Vec3::from(color), angle_rad }
            }
            LightFields::Gaussian { direction, strength, color, sharpness } => {
                Self::Gaussian { direction: direction.into(), fluence: strength * Vec3::from(color), sharpness }
            }
            LightFields::Point { position, power, color, radius } => {
                Self::Point { position: position.into(), power: power * Vec3::from(color), radius, cone: None }
            }
            LightFields::Spot { position, direction, power, color, radius, cone_angle_rad, blend } => Self::Point {
                position: position.into(),
                power: power * Vec3::from(color),
                radius,
                cone: Some(Cone { direction: DVec3::from(direction), angle_rad: cone_angle_rad, blend }),
            },
            LightFields::Area { world_from_light, size, power, color, shape } => Self::Area {
                world_from_light: matrix(world_from_light),
                size,
                ellipse: shape == "disk",
                power: power * Vec3::from(color),
            },
        }
    }
}

/// `lisle.Camera`, by its attributes.
#[derive(FromPyObject)]
pub struct CameraFields {
    world_from_camera: Rows,
    clip_from_camera: Rows,
    aperture_radius: f64,
    focus_distance: f64,
    blades: u32,
    rotation_rad: f64,
    ratio: f64,
}

impl From<CameraFields> for Camera {
    fn from(fields: CameraFields) -> Self {
        let CameraFields { aperture_radius, focus_distance, blades, rotation_rad, ratio, .. } = fields;
        let lens = Lens { aperture_radius, focus_distance, blades, rotation_rad, ratio };
        Self {
            world_from_camera: matrix(fields.world_from_camera),
            clip_from_camera: matrix(fields.clip_from_camera),
            lens: (aperture_radius != 0.0).then_some(lens),
        }
    }
}

/// A scene, and how to draw it.
pub fn scene(
    objects: Vec<ObjectFields<'_>>,
    meshes: Vec<(MeshFields, u32)>,
    lights: Vec<LightFields>,
    ambient: [f32; 3],
    environment: Option<EnvironmentFields>,
    camera: CameraFields,
) -> Result<Scene, Failure> {
    Ok(Scene {
        objects: objects.into_iter().map(ObjectFields::object).collect::<Result<_, _>>()?,
        meshes: meshes.into_iter().map(|(fields, id)| fields.mesh(id)).collect(),
        lights: lights.into_iter().map(Light::from).collect(),
        ambient: Vec3::from(ambient),
        environment: environment.map(EnvironmentFields::into),
        camera: camera.into(),
    })
}

/// What moves: objects, meshes with their numbers, and camera.
pub type StepFields<'py> = (Vec<ObjectFields<'py>>, Vec<(MeshFields, u32)>, CameraFields);

/// A scene at another time.
pub fn moved(scene: &Scene, (objects, meshes, camera): StepFields<'_>) -> Result<Scene, Failure> {
    let objects = objects.into_iter().map(ObjectFields::object).collect::<Result<_, _>>()?;
    let meshes = meshes.into_iter().map(|(fields, id)| fields.mesh(id)).collect();
    Ok(Scene { objects, meshes, camera: camera.into(), ..scene.clone() })
}

/// A shading model by its name.
pub fn shading(name: &str) -> Result<Shading, Failure> {
    match name {
        "physical" => Ok(Shading::Physical),
        "simple" => Ok(Shading::Simple),
        other => Err(Failure::Input(format!("shading: {other:?} is neither \"physical\" nor \"simple\""))),
    }
}

impl SettingsItems {
    /// The settings that they stand for.
    pub fn settings(self) -> Result<Settings, Failure> {
        let shading = shading(&self.shading)?;
        let occlusion = match self.occlusion.as_str() {
            "distance" => Occlusion::Distance,
            "table" => Occlusion::Table,
            other => return Err(Failure::Input(format!("occlusion: {other:?} is neither \"distance\" nor \"table\""))),
        };
        let filter = match self.filter.as_str() {
            "blackman-harris" => Filter::BlackmanHarris,
            "gaussian" => Filter::Gaussian,
            "box" => Filter::Box,
            other => {
                let known = "\"blackman-harris\", \"gaussian\" and \"box\"";
                return Err(Failure::Input(format!("filter: {other:?} is none of {known}")));
            }
        };
        let aov = |name: &String| {
            let known = Aov::ALL.into_iter().find(|aov| aov.name() == name);
            known.ok_or_else(|| Failure::Input(format!("passes: {name:?} is no pass that can be asked for")))
        };
        let aovs = self.passes.iter().map(aov).collect::<Result<_, _>>()?;
        Ok(Settings {
            size: self.size,
            region: self.region,
            samples: self.samples,
            shading,
            transport_photons: self.transport_photons,
            occlusion,
            transparent: self.transparent,
            lod_pixels: self.lod_pixels,
            filter,
            filter_width: self.filter_width,
            noise_threshold: self.noise_threshold,
            time_limit_s: self.time_limit_s,
            table_resolution: self.table_resolution,
            sky_directions: self.sky_directions,
            shadow_resolution: self.shadow_resolution,
            seed: self.seed,
            first_sample: self.first_sample,
            aovs,
        })
    }
}
