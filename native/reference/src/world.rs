//! A scene made ready for rays: explicit fibers, scattering, lights.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scene::{Mesh, Object, Scene, Shading};

use crate::Error;
use crate::assembly::{Assembly, Hit, Ray};
use crate::fibers::{self, Fibers};
use crate::light::Emitter;
use crate::material::{NearField, Scattering};
use crate::surfaces::{SurfaceHit, Surfaces};

/// What paths are traced through. Its space has the world's axes, with the middle of all yarns at the origin: f32 stays fine there.
pub(crate) struct World {
    pub assembly: Assembly,
    pub surfaces: Surfaces,
    objects: Vec<ObjectFibers>,
    pub lights: Vec<Emitter>,
    pub ambient: DVec3,
    /// Of the space, in the world.
    pub origin: DVec3,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Met {
    Fiber(Hit),
    Surface(SurfaceHit),
}

impl Met {
    /// Distance.
    pub fn t(&self) -> f64 {
        match self {
            Self::Fiber(hit) => hit.t,
            Self::Surface(hit) => hit.t,
        }
    }
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
    /// Makes the fibers of a valid scene.
    pub fn new(
        scene: &Scene,
        shading: Shading,
        chord_error: f64,
        progress: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Self, Error> {
        let origin = middle(&scene.objects, &scene.meshes);
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
            surfaces: Surfaces::new(&scene.meshes, origin, progress)?,
            objects,
            lights: scene.lights.iter().map(|light| Emitter::new(light, origin)).chain(sky).collect(),
            ambient: scene.ambient.as_dvec3(),
            origin,
        })
    }

    /// Has all fibers scatter by another function.
    pub fn scatter_by(&mut self, function: &Arc<dyn NearField>) {
        for object in &mut self.objects {
            object.scattering = Scattering::near(Arc::clone(function));
        }
    }

    fn object(&self, segment: u32) -> &ObjectFibers {
        &self.objects[self.objects.partition_point(|o| o.first_point <= segment) - 1]
    }

    /// Radiance of what lies behind everything, in a direction.
    pub fn background(&self, direction: DVec3) -> DVec3 {
        self.ambient + self.lights.iter().map(|light| light.background(direction)).sum::<DVec3>()
    }

    /// The nearest fiber or mesh between the distances 0 and `reach`.
    pub fn nearest(&self, ray: &Ray, reach: f64) -> Option<Met> {
        let fiber = self.assembly.nearest(ray, reach);
        let surface = self.surfaces.nearest(ray, fiber.map_or(reach, |hit| hit.t));
        surface.map(Met::Surface).or(fiber.map(Met::Fiber))
    }

    /// Whether there is any between the distances 0 and `reach`.
    pub fn is_blocked(&self, ray: &Ray, reach: f64) -> bool {
        self.surfaces.is_blocked(ray, reach) || self.assembly.is_blocked(ray, reach)
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

/// Of the box about all knots, or without any about all meshes, world space.
fn middle(objects: &[Object], meshes: &[Mesh]) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for object in objects {
        for point in object.yarns.strands().positions() {
            let at = object.world_from_object.transform_point3(Vec3::from(*point).as_dvec3());
            (low, high) = (low.min(at), high.max(at));
        }
    }
    if objects.is_empty() {
        for mesh in meshes {
            for point in mesh.triangles.positions() {
                let at = mesh.world_from_object.transform_point3(Vec3::from(*point).as_dvec3());
                (low, high) = (low.min(at), high.max(at));
            }
        }
    }
    if low.is_finite() { 0.5 * (low + high) } else { DVec3::ZERO }
}
