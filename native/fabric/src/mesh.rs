//! Knitted cloth on a mesh, which it follows when the mesh moves.

use crate::Error;
use crate::cell::POINTS_PER_STITCH;
use crate::knit::{Knit, relaxed};
use crate::pattern::Pattern;
use crate::uv_grid::UvGrid;
use glam::{DVec2, DVec3};
use lisle_core::curve::{Basis, Curves};
use rayon::prelude::*;

/// UVs that differ by less, as a share of the map's diagonal, are one corner that was rounded twice.
const SAME_UV: f64 = 1e-6;

/// A triangle mesh with a UV map: courses run along u, wales along v.
#[derive(Clone, Debug)]
pub struct UvMesh {
    /// Vertices, in metres.
    pub positions: Vec<DVec3>,
    /// Unit normals of the vertices, out of the front of the cloth.
    pub normals: Vec<DVec3>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// (u, v) of each triangle's corners, which differ between triangles along the map's seams.
    pub uvs: Vec<[DVec2; 3]>,
}

/// A place on a mesh, whatever the mesh's shape: weights of three vertices, and a height above their mean normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPoint {
    /// Vertices of the triangle.
    pub vertices: [u32; 3],
    /// Their weights, which add up to one.
    pub weights: [f32; 3],
    /// Metres along the normal.
    pub height_m: f32,
}

impl MeshPoint {
    /// Where the place is on a mesh of these vertices and unit normals.
    #[must_use]
    pub fn position(&self, positions: &[DVec3], normals: &[DVec3]) -> DVec3 {
        let mean = |values: &[DVec3]| -> DVec3 {
            self.vertices.iter().zip(self.weights).map(|(&vertex, w)| values[vertex as usize] * f64::from(w)).sum()
        };
        mean(positions) + mean(normals).normalize_or_zero() * f64::from(self.height_m)
    }
}

/// Knitted cloth bound to a mesh.
///
/// The stitches are spread evenly over the UV map's bounding rectangle, as many as have the yarn's natural size on average. A
/// course is cut where the map has no triangle, and at the borders of its islands. Where the right border of the rectangle
/// is the left one again, as round a tube, courses are closed.
#[derive(Clone, Debug)]
pub struct MeshKnit {
    /// The yarns on the mesh as it was given.
    pub curves: Curves,
    /// What the control points are bound to, in their order.
    pub points: Vec<MeshPoint>,
    /// Stitches of the rectangle: courses and wales.
    pub stitches: [usize; 2],
}

/// A run of control points on one island: course, and points from the first number on.
struct Run {
    points: Vec<MeshPoint>,
    closed: bool,
}

impl MeshKnit {
    /// Knits on a mesh.
    ///
    /// # Errors
    /// [`Error::Mesh`], [`Error::YarnRadius`], [`Error::OverlappingUvs`], [`Error::NoStitches`] or [`Error::TooManyPoints`].
    pub fn new(pattern: &Pattern, mesh: &UvMesh, yarn_radius_m: f64) -> Result<Self, Error> {
        if !(yarn_radius_m.is_finite() && yarn_radius_m > 0.0) {
            return Err(Error::YarnRadius { value_m: yarn_radius_m });
        }
        mesh.check()?;
        let (low, high) = mesh.uv_bounds();
        let grid = UvGrid::new(&mesh.uvs, low, high)?;
        let cell = relaxed(pattern);
        let stitch_m = DVec2::from(cell.spacings()) * yarn_radius_m;
        let extent_m = mesh.metres_per_uv() * (high - low);
        let too_small =
            Error::NoStitches { width_m: extent_m.x, height_m: extent_m.y, wale_m: stitch_m.x, course_m: stitch_m.y };
        let counts = extent_m / stitch_m;
        if counts.min_element() < 0.5 {
            return Err(too_small);
        }
        let (wales, courses) = (counts.x.round().max(1.0) as usize, counts.y.round().max(1.0) as usize);
        let columns = pattern.columns();
        let repeats = (counts.x / columns as f64).round() as usize;
        let round = repeats * columns >= 3 && mesh.is_joined(&grid, low, high, courses, yarn_radius_m)?;
        let wales = if round { repeats * columns } else { wales };
        let knit = Knit::of_cell(cell, courses, wales, yarn_radius_m, round)?;
        let islands = mesh.islands(SAME_UV * (high - low).length());
        let runs: Vec<Result<Vec<Run>, Error>> = (0..courses)
            .into_par_iter()
            .map(|course| {
                let points: Result<Vec<Option<(usize, MeshPoint)>>, Error> = (0..knit.course_points())
                    .map(|index| {
                        let (place, height_m) = knit.place(course, index);
                        let along = if round { place.x.rem_euclid(1.0) } else { place.x };
                        let found = grid.find(low + DVec2::new(along, place.y) * (high - low))?;
                        Ok(found.map(|(triangle, weights)| {
                            let vertices = mesh.triangles[triangle];
                            let weights = weights.as_vec3().to_array();
                            (islands[triangle], MeshPoint { vertices, weights, height_m: height_m as f32 })
                        }))
                    })
                    .collect();
                Ok(cut(&points?, round))
            })
            .collect();
        // Errors are looked for one course after the other: the first is the same whichever thread is quicker.
        let runs: Vec<Run> = runs.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        if runs.is_empty() {
            return Err(too_small);
        }
        Ok(Self::of_runs(runs, mesh, yarn_radius_m, [courses, wales]))
    }

    fn of_runs(runs: Vec<Run>, mesh: &UvMesh, yarn_radius_m: f64, stitches: [usize; 2]) -> Self {
        let mut offsets = vec![0];
        let closed: Vec<bool> = runs.iter().map(|run| run.closed).collect();
        let mut points = Vec::new();
        for run in runs {
            points.extend(run.points);
            offsets.push(points.len() as u32);
        }
        let position = |point: &MeshPoint| point.position(&mesh.positions, &mesh.normals).as_vec3().to_array();
        let curves = Curves {
            points: points.par_iter().map(position).collect(),
            offsets,
            basis: vec![Basis::CatmullRom; closed.len()],
            closed,
            radii: Some(vec![yarn_radius_m as f32; points.len()]),
        };
        Self { curves, points, stitches }
    }
}

/// Cuts a course where there is no mesh and where the island changes; drops what is shorter than a stitch.
fn cut(points: &[Option<(usize, MeshPoint)>], round: bool) -> Vec<Run> {
    let n = points.len();
    let island = |i: usize| points[i % n].map(|(island, _)| island);
    // In the round an island's border does not end the yarn where the map's right border is joined to its left one.
    let breaks = |i: usize| island(i).is_none() || (island(i) != island(i + n - 1) && !(round && i.is_multiple_of(n)));
    let Some(first) = (0..n).find(|&i| breaks(i)).or((!round).then_some(0)) else {
        return vec![Run { points: points.iter().flatten().map(|(_, point)| *point).collect(), closed: true }];
    };
    let mut runs = vec![Run { points: Vec::new(), closed: false }];
    // In the round the walk begins at a break, so that no run is cut by the first point's number.
    let start = if round { first } else { 0 };
    for i in start..start + n {
        if breaks(i) || (!round && i == 0) {
            runs.push(Run { points: Vec::new(), closed: false });
        }
        if let (Some((_, point)), Some(run)) = (points[i % n], runs.last_mut()) {
            run.points.push(point);
        }
    }
    runs.retain(|run| run.points.len() >= POINTS_PER_STITCH);
    runs
}

/// The first of a tree of numbers; shortens the way there.
fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

impl UvMesh {
    fn check(&self) -> Result<(), Error> {
        let refuse = |reason: String| Err(Error::Mesh { reason });
        if self.triangles.is_empty() {
            return refuse("it has no faces".to_owned());
        }
        if self.normals.len() != self.positions.len() || self.uvs.len() != self.triangles.len() {
            return refuse(format!(
                "{} vertices have {} normals, and {} triangles UVs of {}",
                self.positions.len(),
                self.normals.len(),
                self.triangles.len(),
                self.uvs.len()
            ));
        }
        let is_outside = |triangle: &[u32; 3]| triangle.iter().any(|&vertex| vertex as usize >= self.positions.len());
        if let Some(triangle) = self.triangles.iter().position(is_outside) {
            return refuse(format!("triangle {triangle} has a vertex beyond the last one"));
        }
        if let Some(vertex) = (0..self.positions.len()).find(|&i| !(self.positions[i] + self.normals[i]).is_finite()) {
            return refuse(format!("vertex {vertex} is not finite"));
        }
        if let Some(triangle) = self.uvs.iter().position(|corners| corners.iter().any(|uv| !uv.is_finite())) {
            return refuse(format!("the UVs of triangle {triangle} are not finite"));
        }
        if self.uvs.iter().all(|[a, b, c]| (*b - *a).perp_dot(*c - *a) == 0.0) {
            return refuse("its UV map has no area".to_owned());
        }
        Ok(())
    }

    fn uv_bounds(&self) -> (DVec2, DVec2) {
        let corners = self.uvs.iter().flatten();
        corners.fold((DVec2::MAX, DVec2::MIN), |(low, high), &uv| (low.min(uv), high.max(uv)))
    }

    /// Mean lengths of the mesh's derivatives along u and v, weighted by area in the map.
    fn metres_per_uv(&self) -> DVec2 {
        let (mut sum, mut total) = (DVec2::ZERO, 0.0);
        for (vertices, [a, b, c]) in self.triangles.iter().zip(&self.uvs) {
            let [p, q, r] = vertices.map(|vertex| self.positions[vertex as usize]);
            let (side, other) = (*b - *a, *c - *a);
            let area = side.perp_dot(other);
            if area != 0.0 {
                let along_u = ((q - p) * other.y - (r - p) * side.y) / area;
                let along_v = ((r - p) * side.x - (q - p) * other.x) / area;
                sum += DVec2::new(along_u.length(), along_v.length()) * area.abs();
                total += area.abs();
            }
        }
        sum / total
    }

    /// Number of the island of each triangle: islands share no corner of the same vertex and UV, but for rounding.
    fn islands(&self, same_uv: f64) -> Vec<usize> {
        let mut parent: Vec<usize> = (0..self.triangles.len()).collect();
        let mut corners: Vec<Vec<(DVec2, usize)>> = vec![Vec::new(); self.positions.len()];
        for (triangle, (vertices, uvs)) in self.triangles.iter().zip(&self.uvs).enumerate() {
            for (&vertex, &uv) in vertices.iter().zip(uvs) {
                let corners = &mut corners[vertex as usize];
                if let Some((_, other)) = corners.iter().find(|(known, _)| known.distance(uv) <= same_uv) {
                    let (a, b) = (root(&mut parent, triangle), root(&mut parent, *other));
                    parent[a.max(b)] = a.min(b);
                } else {
                    corners.push((uv, triangle));
                }
            }
        }
        (0..parent.len()).map(|i| root(&mut parent, i)).collect()
    }

    /// Whether the right border of the map's rectangle is the left one again, wherever it is on the mesh.
    fn is_joined(
        &self,
        grid: &UvGrid<'_>,
        low: DVec2,
        high: DVec2,
        courses: usize,
        yarn_radius_m: f64,
    ) -> Result<bool, Error> {
        let mut met = false;
        for course in 0..courses {
            let v = low.y + (high.y - low.y) * (course as f64 + 0.5) / courses as f64;
            let at = |u: f64| {
                let found = grid.find(DVec2::new(u, v))?;
                Ok(found.map(|(triangle, weights)| -> DVec3 {
                    let corners = self.triangles[triangle].map(|vertex| self.positions[vertex as usize]);
                    corners.into_iter().zip(weights.to_array()).map(|(position, weight)| position * weight).sum()
                }))
            };
            match (at(low.x)?, at(high.x)?) {
                (Some(left), Some(right)) if left.distance(right) < 0.5 * yarn_radius_m => met = true,
                (None, None) => {}
                _ => return Ok(false),
            }
        }
        Ok(met)
    }
}
