//! What moves while the shutter is open, and where things are in the frames before and after.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scene::between;

use crate::arrays::array;
use crate::device::Gpu;
use crate::meshes::correspond;
use crate::upload::{Draws, ObjectParts, Place, SceneBuffers, Shape};
use crate::view::View;
use crate::{Error, Mesh, Object, Scene};

/// A scene at one or several times.
///
/// Objects and meshes correspond by their order, and their yarns by their rest shape: [`lisle_core::strands::Yarns::with_points`]. Yarns, objects,
/// meshes and camera move; all else is as at the first step. Meshes stay where the steps have not as many, and keep their shape where their
/// triangles differ.
#[derive(Clone, Debug)]
pub struct Exposure {
    /// The scene at even steps from when the shutter opens to when it closes, at least one; between them everything moves evenly. What
    /// belongs to the pixel's centre alone, depth for example, is of the middle of that time.
    pub steps: Vec<Scene>,
    /// The scene one frame before, and one after: for [`crate::Aov::Vector`].
    pub neighbours: Option<[Scene; 2]>,
}

impl Exposure {
    /// One moment.
    pub fn still(scene: Scene) -> Self {
        Self { steps: vec![scene], neighbours: None }
    }
}

/// What is seen at one time, and from where.
pub(crate) struct Moment {
    pub view: View,
    pub draws: Draws,
    /// World from object.
    pub mesh_transforms: Vec<DMat4>,
}

/// The steps, ready to be drawn at any time between them.
pub(crate) struct Motion<'a> {
    steps: &'a [Scene],
    parts: &'a [ObjectParts],
    size: [u32; 2],
    /// Of each step; none if no curve changes its shape.
    pub shapes: Vec<Shape>,
}

/// A frame before or after.
pub(crate) struct Neighbour {
    pub moment: Moment,
    pub shape: Shape,
    pub draws: wgpu::Buffer,
    /// None if the frames have not as many meshes.
    mesh_moves: Vec<MeshMove>,
}

/// A mesh here and in another frame.
struct MeshMove {
    here: Mesh,
    there: Mesh,
}

impl MeshMove {
    /// Where a point of one of its triangles is in the other frame, world space.
    fn follow(&self, triangle: usize, world: DVec3) -> DVec3 {
        let object_from_world = self.here.world_from_object.inverse();
        if !object_from_world.is_finite() {
            return world;
        }
        let here = object_from_world.transform_point3(world);
        let there = if Arc::ptr_eq(&self.here.triangles, &self.there.triangles) {
            here
        } else {
            self.in_other_shape(triangle, here).unwrap_or(here)
        };
        self.there.world_from_object.transform_point3(there)
    }

    /// Object space.
    fn in_other_shape(&self, triangle: usize, place: DVec3) -> Option<DVec3> {
        if !correspond(&self.here.triangles, &self.there.triangles) {
            return None;
        }
        let corners = self.here.triangles.triangles().get(triangle)?;
        let [[a, b, c], [x, y, z]] = [&self.here, &self.there]
            .map(|mesh| corners.map(|corner| Vec3::from(mesh.triangles.positions()[corner as usize]).as_dvec3()));
        let normal = (b - a).cross(c - a);
        let size = normal.length_squared();
        if size == 0.0 {
            return None;
        }
        let share = |from: DVec3, to: DVec3| (to - from).cross(place - from).dot(normal) / size;
        let (of_b, of_c) = (share(c, a), share(a, b));
        Some(x + (y - x) * of_b + (z - x) * of_c)
    }
}

/// A mesh's transform between those of two steps; one that is flat has no rotation to keep.
fn mesh_between(a: &DMat4, b: &DMat4, share: f64) -> DMat4 {
    let mixed = between(a, b, share);
    if mixed.is_finite() { mixed } else { *a * (1.0 - share) + *b * share }
}

/// Fails unless the objects of a scene are those of another, moved.
fn check(scene: &Scene, other: &Scene, when: &str) -> Result<(), Error> {
    if scene.objects.len() != other.objects.len() {
        let (here, there) = (scene.objects.len(), other.objects.len());
        return Err(Error::input(when, format!("{there} objects, expected {here} as at the first time")));
    }
    other.validate()?;
    let moved = |(a, b): (&Object, &Object)| !crate::upload::same_rest(&a.yarns, &b.yarns);
    match scene.objects.iter().zip(&other.objects).find(|pair| moved(*pair)) {
        None => Ok(()),
        Some((object, _)) => Err(Error::input(
            format!("{when}, object \"{}\"", object.name),
            "its yarns have another rest shape than at the first time: make them with with_points",
        )),
    }
}

impl<'a> Motion<'a> {
    /// `parts` are what [`SceneBuffers::update`] gave for the first step, that `buffers` hold.
    pub fn new(
        gpu: &Gpu,
        steps: &'a [Scene],
        parts: &'a [ObjectParts],
        size: [u32; 2],
        buffers: &SceneBuffers,
    ) -> Result<Self, Error> {
        let mut deforms = false;
        for (number, step) in steps.iter().enumerate().skip(1) {
            check(&steps[0], step, &format!("time step {number}"))?;
            let pairs = || steps[0].objects.iter().zip(&step.objects);
            deforms |= pairs().any(|(a, b)| !std::ptr::eq(a.yarns.points(), b.yarns.points()));
        }
        let shape = |step: &Scene| buffers.shape_of(gpu, step, parts);
        let shapes = if deforms { steps.iter().map(shape).collect::<Result<_, _>>()? } else { Vec::new() };
        Ok(Self { steps, parts, size, shapes })
    }

    pub fn is_moving(&self) -> bool {
        self.steps.len() > 1
    }

    /// The step before a time, 0 to 1, and the share of the way to the next.
    pub fn step(&self, time: f64) -> (usize, f64) {
        let place = time * (self.steps.len() - 1) as f64;
        let step = (place as usize).min(self.steps.len().saturating_sub(2));
        (step, place - step as f64)
    }

    /// What is seen at a time.
    pub fn at(&self, buffers: &SceneBuffers, time: f64) -> Result<Moment, Error> {
        if !self.is_moving() {
            return Moment::new(buffers, &self.steps[0], self.parts, self.size, &buffers.shape.places);
        }
        let (first, share) = self.step(time);
        let (a, b) = (&self.steps[first], &self.steps[first + 1]);
        let view = View::new(&a.camera.between(&b.camera, share), self.size)?;
        let transforms = a.objects.iter().zip(&b.objects);
        let transforms: Vec<DMat4> =
            transforms.map(|(a, b)| between(&a.world_from_object, &b.world_from_object, share)).collect();
        let places: Vec<Place> = match self.shapes.get(first..first + 2) {
            Some([a, b]) => a.places.iter().zip(&b.places).map(|(a, b)| a.between(b, share)).collect(),
            _ => buffers.shape.places.clone(),
        };
        let draws = buffers.draws(&self.steps[0], self.parts, view.origin, &transforms, &places)?;
        let meshes = &self.steps[0].meshes;
        let mesh_transforms = if self.steps.iter().all(|step| step.meshes.len() == meshes.len()) {
            let pairs = a.meshes.iter().zip(&b.meshes);
            pairs.map(|(a, b)| mesh_between(&a.world_from_object, &b.world_from_object, share)).collect()
        } else {
            transforms_of(meshes)
        };
        Ok(Moment { view, draws, mesh_transforms })
    }
}

fn transforms_of(meshes: &[Mesh]) -> Vec<DMat4> {
    meshes.iter().map(|mesh| mesh.world_from_object).collect()
}

impl Moment {
    fn new(
        buffers: &SceneBuffers,
        scene: &Scene,
        parts: &[ObjectParts],
        size: [u32; 2],
        places: &[Place],
    ) -> Result<Self, Error> {
        let view = View::new(&scene.camera, size)?;
        let transforms: Vec<DMat4> = scene.objects.iter().map(|object| object.world_from_object).collect();
        let draws = buffers.draws(scene, parts, view.origin, &transforms, places)?;
        Ok(Self { view, draws, mesh_transforms: transforms_of(&scene.meshes) })
    }
}

impl Neighbour {
    /// Uploads a neighbouring frame.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        other: &Scene,
        when: &str,
        parts: &[ObjectParts],
        size: [u32; 2],
        buffers: &SceneBuffers,
    ) -> Result<Self, Error> {
        check(scene, other, when)?;
        let shape = buffers.shape_of(gpu, other, parts)?;
        let moment = Moment::new(buffers, other, parts, size, &shape.places)?;
        let items = &moment.draws.items;
        let draws = array(gpu, "instances in another frame", items)?;
        let moved = |(here, there): (&Mesh, &Mesh)| MeshMove { here: here.clone(), there: there.clone() };
        let pairs = scene.meshes.iter().zip(&other.meshes);
        let mesh_moves = if scene.meshes.len() == other.meshes.len() { pairs.map(moved).collect() } else { Vec::new() };
        Ok(Self { moment, shape, draws, mesh_moves })
    }

    /// Where a point of a mesh's triangle is on the picture of that frame, pixels; `None` if it is not before the camera.
    pub fn mesh_pixel(&self, mesh: usize, triangle: usize, world: DVec3) -> Option<[f64; 2]> {
        let there = self.mesh_moves.get(mesh).map_or(world, |moved| moved.follow(triangle, world));
        self.moment.view.pixel(there)
    }
}
