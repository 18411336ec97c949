//! The meshes of a scene, and what rays meet among them.

use std::ops::ControlFlow;

use glam::{DMat3, DMat4, DVec3, Vec3};
use lisle_core::scene::{Mesh, Triangles};

use crate::Error;
use crate::hierarchy::{Extent, Hierarchy, NOTHING, Ray, union};

/// How far beside a triangle a ray counts, share of its extent: where two meet, it must not slip through.
const SEAM: f64 = 1e-12;

/// All triangles, in the space of the fibers, with a bounding volume hierarchy over them.
pub(crate) struct Surfaces {
    /// Corners, mesh after mesh.
    triangles: Vec<[DVec3; 3]>,
    meshes: Vec<Placed>,
    hierarchy: Hierarchy,
}

/// A mesh, and where its triangles begin.
struct Placed {
    first: u32,
    mesh: Mesh,
    /// Turns normals: the cofactors of the transform, right under any scale.
    cofactors: DMat3,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceHit {
    /// Distance.
    pub t: f64,
    triangle: u32,
    /// Shares of the second and the third corner.
    shares: [f64; 2],
}

/// The surface at a hit, as it faces the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub position: DVec3,
    /// Of the triangle.
    pub facing: DVec3,
    /// As it is shaded.
    pub normal: DVec3,
}

impl Surfaces {
    /// Puts meshes into the space in which `origin` of the world is at zero. `progress` is called several times a second and can stop the
    /// work.
    ///
    /// # Errors
    /// [`Error::Cancelled`], [`Error::Input`] for more triangles than are counted.
    pub fn new(meshes: &[Mesh], origin: DVec3, progress: &mut dyn FnMut() -> ControlFlow<()>) -> Result<Self, Error> {
        let mut triangles: Vec<[DVec3; 3]> = Vec::new();
        let mut placed = Vec::with_capacity(meshes.len());
        for mesh in meshes {
            let first = triangles.len() as u32;
            let matrix = DMat4::from_translation(-origin) * mesh.world_from_object;
            let of_mesh: &Triangles = &mesh.triangles;
            if triangles.len() + of_mesh.triangles().len() > u32::MAX as usize {
                return Err(Error::Input { what: "meshes", reason: "they have more than 4294967295 triangles".into() });
            }
            let positions = of_mesh.positions();
            let at = |corner: u32| matrix.transform_point3(Vec3::from(positions[corner as usize]).as_dvec3());
            triangles.extend(of_mesh.triangles().iter().map(|corners| corners.map(at)));
            let linear = DMat3::from_mat4(matrix);
            let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
            let scale = x.length().max(y.length()).max(z.length()).max(1e-30);
            let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * (scale * scale).recip();
            placed.push(Placed { first, mesh: mesh.clone(), cofactors });
            if progress().is_break() {
                return Err(Error::Cancelled);
            }
        }
        let about = |corners: &[DVec3; 3]| -> Extent {
            let [a, b, c] = *corners;
            (a.min(b).min(c), a.max(b).max(c))
        };
        let extent = triangles.iter().map(about).fold(NOTHING, union);
        let place = |item: u32| triangles[item as usize].iter().sum::<DVec3>() / 3.0;
        let bounds = |item: u32| about(&triangles[item as usize]);
        let items = (0..triangles.len() as u32).collect();
        let hierarchy = Hierarchy::new(items, extent, place, bounds, progress)?;
        Ok(Self { triangles, meshes: placed, hierarchy })
    }

    /// Bytes of triangles and hierarchy.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.triangles[..]) + self.hierarchy.bytes()
    }

    /// The nearest triangle, from either side, between the distances 0 and `reach`.
    pub fn nearest(&self, ray: &Ray, reach: f64) -> Option<SurfaceHit> {
        let mut best: Option<SurfaceHit> = None;
        self.hierarchy.nearest(ray, reach, |triangle| {
            let most = best.map_or(reach, |hit| hit.t);
            if let Some(hit) = self.meet(ray, triangle, most) {
                best = Some(hit);
            }
            best.map_or(reach, |hit| hit.t)
        });
        best
    }

    /// Whether any triangle lies on the ray between the distances 0 and `reach`.
    pub fn is_blocked(&self, ray: &Ray, reach: f64) -> bool {
        self.hierarchy.any(ray, reach, |triangle| self.meet(ray, triangle, reach).is_some())
    }

    /// By Cramer's rule for o + t d = a + u (b − a) + v (c − a).
    fn meet(&self, ray: &Ray, triangle: u32, most: f64) -> Option<SurfaceHit> {
        let [a, b, c] = self.triangles[triangle as usize];
        let (to_b, to_c, from_a) = (b - a, c - a, ray.origin - a);
        let across = ray.direction.cross(to_c);
        let determinant = to_b.dot(across);
        if determinant == 0.0 {
            return None;
        }
        let along = from_a.cross(to_b);
        let [t, u, v] =
            [to_c.dot(along), from_a.dot(across), ray.direction.dot(along)].map(|minor| minor / determinant);
        let is_inside = u >= -SEAM && v >= -SEAM && u + v <= 1.0 + SEAM;
        (is_inside && t > 0.0 && t < most).then_some(SurfaceHit { t, triangle, shares: [u, v] })
    }

    fn placed(&self, hit: &SurfaceHit) -> &Placed {
        &self.meshes[self.meshes.partition_point(|placed| placed.first <= hit.triangle) - 1]
    }

    /// The mesh that was met.
    pub fn mesh(&self, hit: &SurfaceHit) -> &Mesh {
        &self.placed(hit).mesh
    }

    /// The surface at a hit. Normals are interpolated where the mesh has any, the triangle's where next to nothing is left of them.
    pub fn face(&self, ray: &Ray, hit: &SurfaceHit) -> Face {
        let [a, b, c] = self.triangles[hit.triangle as usize];
        let [u, v] = hit.shares;
        let outward = (b - a).cross(c - a).normalize_or(-ray.direction);
        let facing = if outward.dot(ray.direction) <= 0.0 { outward } else { -outward };
        let placed = self.placed(hit);
        let of_corners = placed.mesh.triangles.normals().map(|all| all[(hit.triangle - placed.first) as usize]);
        let normal = of_corners.map_or(facing, |corners| {
            let [a, b, c] = corners.map(|normal| Vec3::from(normal).as_dvec3().normalize_or_zero());
            let turned = placed.cofactors * (a * (1.0 - u - v) + b * u + c * v);
            if turned.length() < 1e-6 {
                return facing;
            }
            let side = if turned.dot(facing) >= 0.0 { 1.0 } else { -1.0 };
            turned * (side / turned.length())
        });
        Face { position: a * (1.0 - u - v) + b * u + c * v, facing, normal }
    }

    /// Length that is next to nothing beside everything.
    pub fn offset(&self) -> f64 {
        1e-9 * self.hierarchy.bounds().1
    }
}
