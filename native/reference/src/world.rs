//! A scene made ready for rays: explicit fibers, scattering, lights.

use std::ops::ControlFlow;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scene::{Object, Scene, Shading};

use crate::Error;
use crate::assembly::Assembly;
use crate::fibers::{self, Fibers};
use crate::light::Emitter;
use crate::material::Scattering;

/// What paths are traced through. Its space has the world's axes, with the middle of all yarns at the origin: f32 stays fine there.
pub(crate) struct World {
    pub assembly: Assembly,
    objects: Vec<ObjectFibers>,
    pub lights: Vec<Emitter>,
    pub ambient: DVec3,
    /// Of the space, in the world.
    pub origin: DVec3,
}

/// What the fibers of an object have in common.
struct ObjectFibers {
    /// First point of the object's fibers.
    first_point: u32,
    scattering: Scattering,
    object_id: u32,
    is_holdout: bool,
}

impl World {
    /// Checks a scene and makes its fibers.
    pub fn new(
        scene: &Scene,
        shading: Shading,
        chord_error: f64,
        progress: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Self, Error> {
        scene.validate()?;
        if !scene.meshes.is_empty() {
            return Err(Error::Input { what: "meshes", reason: "the path tracer draws yarns alone".into() });
        }
        let origin = middle(&scene.objects);
        let space_from_world = DMat4::from_translation(-origin);
        let mut all = Fibers { points: Vec::new(), offsets: vec![0] };
        let mut objects = Vec::with_capacity(scene.objects.len());
        for object in &scene.objects {
            objects.push(ObjectFibers {
                first_point: all.points.len() as u32,
                scattering: Scattering::new(*object.material, shading),
                object_id: object.id,
                is_holdout: object.is_holdout,
            });
            let options = fibers::Options {
                chord_error,
                object_id: object.id,
                space_from_object: space_from_world * object.world_from_object,
                detail: None,
            };
            fibers::append(&mut all, object.yarns.strands(), &object.yarn, &options, &mut |_| progress())?;
        }
        let sky = scene.environment.iter().filter(|sky| sky.shines()).cloned().map(Emitter::Sky);
        Ok(Self {
            assembly: Assembly::new(all, progress)?,
            objects,
            lights: scene.lights.iter().map(|light| Emitter::new(light, origin)).chain(sky).collect(),
            ambient: scene.ambient.as_dvec3(),
            origin,
        })
    }

    fn object(&self, segment: u32) -> &ObjectFibers {
        &self.objects[self.objects.partition_point(|o| o.first_point <= segment) - 1]
    }

    /// Radiance of what lies behind everything, in a direction.
    pub fn background(&self, direction: DVec3) -> DVec3 {
        self.ambient + self.lights.iter().map(|light| light.background(direction)).sum::<DVec3>()
    }

    /// How the fiber of a segment scatters.
    pub fn scattering(&self, segment: u32) -> &Scattering {
        &self.object(segment).scattering
    }

    /// Whether a segment belongs to a hole in the picture.
    pub fn is_holdout(&self, segment: u32) -> bool {
        self.object(segment).is_holdout
    }

    /// Id of the object that a segment belongs to.
    pub fn object_id(&self, segment: u32) -> u32 {
        self.object(segment).object_id
    }
}

/// Of the box about all knots, world space.
fn middle(objects: &[Object]) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for object in objects {
        for point in object.yarns.strands().positions() {
            let at = object.world_from_object.transform_point3(Vec3::from(*point).as_dvec3());
            (low, high) = (low.min(at), high.max(at));
        }
    }
    if low.is_finite() { 0.5 * (low + high) } else { DVec3::ZERO }
}
