//! All fibers of a scene, and what rays meet among them.

use std::ops::ControlFlow;
use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as BoxRay, RayHit};
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;

use crate::Error;
use crate::cone::{Entry, RoundCone};
use crate::fibers::{Fibers, position};

/// Leaves at most. A leaf is a run of neighbouring round cones of a fiber: one for scenes with fewer cones than this, more for larger ones.
/// Runs of 2, 4 and 8 instead of 1 take 26, 21 and 19 bytes a cone instead of 36, and rays take 1.3, 2.4 and 5 times as long
/// (`examples/rays.rs`, 9 M cones).
const MOST_LEAVES: usize = 25_000_000;

/// Leaves of a part of the hierarchy, about. Parts are built one after another, so that the work can be stopped between them, and building
/// takes memory for few at once.
const PART: usize = 1 << 16;

/// Runs are sorted into so many cells a side before they are shared out to parts.
const CELLS: usize = 64;

/// Longest run.
const MOST_RUN: usize = 8;

/// Radius of the scene among boxes, about: the box test ignores the first 1e-4 of a ray, which must be next to nothing.
const BOX_RADIUS: f64 = 65536.0;

/// Margin about boxes: what f32 rounds away.
const MARGIN: f32 = 1e-6 * BOX_RADIUS as f32;

/// A hit within this share of a radius below the neighbour's surface is on it.
const JOINT: f64 = 1e-6;

/// Fibers with a bounding volume hierarchy over runs of them: of two levels, parts of the scene and what is in each.
pub struct Assembly {
    /// Chains one after another; the radius of a chain's last point has its sign bit set.
    points: Vec<[f32; 4]>,
    /// First segment of every run, part after part, each in the order of its leaves.
    runs: Vec<u32>,
    /// Most segments of a run.
    run: usize,
    parts: Vec<Part>,
    /// Over the parts.
    top: CwBvh,
    /// Units of the boxes per unit of length, a power of two; their origin is the centre.
    scale: f64,
    center: DVec3,
    /// Of a sphere about the centre that holds everything.
    radius: f64,
}

/// A ray of unit direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes.
    pub direction: DVec3,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance.
    pub t: f64,
    /// Number of the round cone: that of its first point.
    pub segment: u32,
    /// Place along it, 0 to 1.
    pub along: f64,
}

/// The surface at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// On the surface.
    pub position: DVec3,
    /// Unit normal of the fiber that the chords stand for: perpendicular to its tangent, but for its round ends.
    pub normal: DVec3,
    /// Unit normal of the round cone.
    pub cone_normal: DVec3,
    /// Unit tangent, interpolated along the fiber, towards growing length coordinates.
    pub tangent: DVec3,
    /// Radius of the fiber.
    pub radius: f64,
}

/// A ray among boxes.
struct Clipped {
    ray: BoxRay,
    /// How far along the true ray it starts.
    skip: f64,
    scale: f64,
}

impl Clipped {
    /// The distance among boxes up to which something nearer than `t` may lie.
    fn shorten(&self, t: f64) -> f32 {
        (((t - self.skip) * self.scale) as f32).min(f32::MAX) + MARGIN
    }
}

/// Runs that lie near each other.
struct Part {
    first_run: usize,
    hierarchy: CwBvh,
}

struct RunBox<'a> {
    points: &'a [[f32; 4]],
    center: DVec3,
    scale: f64,
}

impl Boundable for RunBox<'_> {
    fn aabb(&self) -> Aabb {
        let mut bounds = Aabb { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };
        for point in self.points {
            let at = ((position(*point) - self.center) * self.scale).as_vec3a();
            let reach = (f64::from(point[3].abs()) * self.scale) as f32 + MARGIN;
            bounds = Aabb { min: bounds.min.min(at - reach), max: bounds.max.max(at + reach) };
        }
        bounds
    }
}

impl Assembly {
    /// Builds the hierarchy. `progress` is called several times a second and can stop the work.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn new(fibers: Fibers, progress: &mut dyn FnMut() -> ControlFlow<()>) -> Result<Self, Error> {
        let Fibers { mut points, offsets } = fibers;
        let run = (points.len() / MOST_LEAVES + 1).min(MOST_RUN);
        let ends = offsets.windows(2).map(|w| w[0] as usize..w[1] as usize);
        let mut runs = Vec::new();
        for chain in ends {
            runs.extend(chain.clone().take(chain.len() - 1).step_by(run).map(|first| first as u32));
            let last = &mut points[chain.end - 1][3];
            *last = -last.abs();
        }
        let (low, high) = points
            .par_iter()
            .map(|p| {
                let (at, reach) = (position(*p), f64::from(p[3].abs()));
                (at - reach, at + reach)
            })
            .reduce(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let (low, high) = if points.is_empty() { (DVec3::ZERO, DVec3::ZERO) } else { (low, high) };
        let center = 0.5 * (low + high);
        let radius = 0.5 * low.distance(high);
        let scale = (BOX_RADIUS / radius.max(1e-30)).log2().round().exp2();
        let mut go_on = || if progress().is_break() { Err(Error::Cancelled) } else { Ok(()) };
        go_on()?;
        if runs.len() > PART {
            runs = by_cells(&runs, &points, low, high, &mut go_on)?;
        }
        let (mut parts, mut boxes) = (Vec::new(), Vec::new());
        // As many parts at once as there are threads: a part takes some hundredths of a second.
        let starts: Vec<usize> = (0..runs.len()).step_by(PART).collect();
        for starts in starts.chunks(rayon::current_num_threads()) {
            let built: Vec<_> = starts
                .par_iter()
                .map(|&first_run| {
                    let runs = &runs[first_run..runs.len().min(first_run + PART)];
                    let of_run = |first: &u32| RunBox { points: run_of(&points, *first as usize, run), center, scale };
                    let boxes: Vec<Aabb> = runs.iter().map(|first| of_run(first).aabb()).collect();
                    let mut hierarchy = build_cwbvh(&boxes, one_a_leaf(), &mut Duration::default());
                    let order = std::mem::take(&mut hierarchy.primitive_indices);
                    let ordered: Vec<u32> = order.into_iter().map(|place| runs[place as usize]).collect();
                    let bounds = boxes.iter().fold(Aabb::empty(), |all, one| all.union(one));
                    (Part { first_run, hierarchy }, ordered, bounds)
                })
                .collect();
            for (part, ordered, bounds) in built {
                runs[part.first_run..part.first_run + ordered.len()].copy_from_slice(&ordered);
                parts.push(part);
                boxes.push(bounds);
            }
            go_on()?;
        }
        let mut top = build_cwbvh(&boxes, one_a_leaf(), &mut Duration::default());
        let mut places: Vec<Option<Part>> = parts.into_iter().map(Some).collect();
        let parts = std::mem::take(&mut top.primitive_indices);
        let parts = parts.into_iter().filter_map(|place| places[place as usize].take()).collect();
        Ok(Self { points, runs, run, parts, top, scale, center, radius })
    }

    /// Bytes of fibers and hierarchy.
    pub fn bytes(&self) -> usize {
        let nodes: usize = self.parts.iter().map(|part| size_of_val(&part.hierarchy.nodes[..])).sum();
        size_of_val(&self.points[..]) + size_of_val(&self.runs[..]) + nodes + size_of_val(&self.top.nodes[..])
    }

    /// Number of round cones.
    pub fn segments(&self) -> usize {
        self.points.iter().filter(|p| p[3].is_sign_positive()).count()
    }

    /// All points: position and radius, with the sign bit set at the end of a chain.
    pub(crate) fn points(&self) -> &[[f32; 4]] {
        &self.points
    }

    /// Centre and radius of a sphere that holds everything.
    pub fn bounds(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    fn cone(&self, segment: usize) -> RoundCone {
        let (a, b) = (self.points[segment], self.points[segment + 1]);
        RoundCone { a: position(a), b: position(b), radius_a: a[3].abs().into(), radius_b: b[3].abs().into() }
    }

    fn has_next(&self, segment: usize) -> bool {
        self.points[segment + 1][3].is_sign_positive()
    }

    fn has_previous(&self, segment: usize) -> bool {
        segment > 0 && self.points[segment - 1][3].is_sign_positive()
    }

    /// The nearest surface that the ray enters between the distances 0 and `reach`. A ray that starts inside of a fiber leaves it unhindered.
    pub fn nearest(&self, ray: &Ray, reach: f64) -> Option<Hit> {
        let clipped = self.clip(ray, reach)?;
        let mut best: Option<Hit> = None;
        let shortened = |best: &Option<Hit>| best.map_or(f32::INFINITY, |hit| clipped.shorten(hit.t));
        self.top.ray_traverse(clipped.ray, &mut RayHit::none(), |box_ray, part| {
            let Part { first_run, hierarchy } = &self.parts[part];
            hierarchy.ray_traverse(*box_ray, &mut RayHit::none(), |_, id| {
                for segment in self.run_at(first_run + id) {
                    let most = best.map_or(reach, |hit| hit.t);
                    if let Some(entry) = self.enter(ray, segment, most) {
                        best = Some(Hit { t: entry.t, segment: segment as u32, along: entry.along });
                    }
                }
                shortened(&best)
            });
            shortened(&best)
        });
        best
    }

    /// Whether the ray enters any fiber between the distances 0 and `reach`.
    pub fn is_blocked(&self, ray: &Ray, reach: f64) -> bool {
        let Some(clipped) = self.clip(ray, reach) else { return false };
        let is_blocked_by = |run: usize| self.run_at(run).any(|segment| self.enter(ray, segment, reach).is_some());
        // A hit is told by a distance of 0.
        let distance = |is_hit: bool| if is_hit { 0.0 } else { f32::INFINITY };
        !self.top.ray_traverse_miss(clipped.ray, |box_ray, part| {
            let Part { first_run, hierarchy } = &self.parts[part];
            distance(!hierarchy.ray_traverse_miss(*box_ray, |_, id| distance(is_blocked_by(first_run + id))))
        })
    }

    fn enter(&self, ray: &Ray, segment: usize, most: f64) -> Option<Entry> {
        let entry = self.cone(segment).enter(ray.origin, ray.direction)?;
        let counts = entry.t > 0.0 && entry.t < most && !self.is_inside_joint(ray, segment, entry.t);
        counts.then_some(entry)
    }

    /// Segments of a run.
    fn run_at(&self, number: usize) -> impl Iterator<Item = usize> {
        let first = self.runs[number] as usize;
        first..first + run_of(&self.points, first, self.run).len() - 1
    }

    /// Whether the entry lies within the next or the previous round cone of the same fiber: no surface of the fiber.
    fn is_inside_joint(&self, ray: &Ray, segment: usize, t: f64) -> bool {
        let point = ray.origin + ray.direction * t;
        (self.has_next(segment) && self.cone(segment + 1).holds(point, JOINT))
            || (self.has_previous(segment) && self.cone(segment - 1).holds(point, JOINT))
    }

    /// The ray in f32 from where it comes near the scene; `None` if it never does.
    fn clip(&self, ray: &Ray, reach: f64) -> Option<Clipped> {
        let skip = ((self.center - ray.origin).dot(ray.direction) - 1.01 * self.radius).max(0.0);
        if self.runs.is_empty() || skip >= reach {
            return None;
        }
        let start = ((ray.origin + ray.direction * skip - self.center) * self.scale).as_vec3a();
        // No negative zeros: the box test takes the sign of a component from a comparison with zero.
        let direction = ray.direction.as_vec3a() + 0.0;
        let clipped = Clipped { ray: BoxRay::new(start, direction, 0.0, f32::MAX), skip, scale: self.scale };
        Some(Clipped { ray: BoxRay { tmax: clipped.shorten(reach), ..clipped.ray }, ..clipped })
    }

    /// The surface at a hit.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let segment = hit.segment as usize;
        let cone = self.cone(segment);
        let position = ray.origin + ray.direction * hit.t;
        let axis_point = cone.a.lerp(cone.b, hit.along);
        let from_axis = position - axis_point;
        let tangent = self.tangent(segment).lerp(self.tangent(segment + 1), hit.along).normalize();
        let across = from_axis - tangent * from_axis.dot(tangent);
        let cone_normal = from_axis.normalize_or(-ray.direction);
        let is_end = (hit.along <= 0.0 && !self.has_previous(segment)) || (hit.along >= 1.0 && !self.has_next(segment));
        Surface {
            position,
            normal: if is_end { cone_normal } else { across.normalize_or(cone_normal) },
            cone_normal,
            tangent,
            radius: cone.radius_a + (cone.radius_b - cone.radius_a) * hit.along,
        }
    }

    /// The fiber's tangent at a point: that of the parabola through it and its neighbours.
    fn tangent(&self, point: usize) -> DVec3 {
        let is_last = self.points[point][3].is_sign_negative();
        let is_first = point == 0 || self.points[point - 1][3].is_sign_negative();
        let chord = |from: usize| position(self.points[from + 1]) - position(self.points[from]);
        let inner = |at: usize| {
            let (before, after) = (chord(at - 1), chord(at));
            let (a, b) = (before.length_squared(), after.length_squared());
            (before * b + after * a).normalize_or(after.normalize_or(DVec3::X))
        };
        let mirrored = |chord: DVec3, inner: DVec3| {
            let along = chord.normalize_or(inner);
            along * (2.0 * inner.dot(along)) - inner
        };
        if is_first && self.points[point + 1][3].is_sign_negative() {
            chord(point).normalize_or(DVec3::X)
        } else if is_last && (point < 2 || self.points[point - 2][3].is_sign_negative()) {
            chord(point - 1).normalize_or(DVec3::X)
        } else if is_first {
            mirrored(chord(point), inner(point + 1))
        } else if is_last {
            mirrored(chord(point - 1), inner(point - 1))
        } else {
            inner(point)
        }
    }
}

fn one_a_leaf() -> BvhBuildParams {
    BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::fast_build() }
}

/// Runs in the order of the cells of a grid along a space-filling curve, so that neighbours in the list are neighbours in space.
fn by_cells(
    runs: &[u32],
    points: &[[f32; 4]],
    low: DVec3,
    high: DVec3,
    go_on: &mut dyn FnMut() -> Result<(), Error>,
) -> Result<Vec<u32>, Error> {
    const BLOCK: usize = 1 << 21;
    let cells = (high - low).max_element().max(1e-30).recip() * CELLS as f64;
    // Bits of the three numbers in turn: a Morton code.
    let spread = |i: u32| (0..CELLS.ilog2()).map(|bit| (i >> bit & 1) << (3 * bit)).sum::<u32>();
    let spread: Vec<u32> = (0..CELLS as u32).map(spread).collect();
    let cell = |first: u32| {
        let place =
            ((position(points[first as usize]) - low) * cells).as_uvec3().min(glam::UVec3::splat(CELLS as u32 - 1));
        (spread[place.x as usize] | spread[place.y as usize] << 1 | spread[place.z as usize] << 2) as usize
    };
    let mut starts = vec![0_usize; CELLS.pow(3) + 1];
    for block in runs.chunks(BLOCK) {
        block.iter().for_each(|first| starts[cell(*first) + 1] += 1);
        go_on()?;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut sorted = vec![0; runs.len()];
    for block in runs.chunks(BLOCK) {
        for first in block {
            let next = &mut starts[cell(*first)];
            sorted[*next] = *first;
            *next += 1;
        }
        go_on()?;
    }
    Ok(sorted)
}

/// Points of the run of at most `most` segments that begins with a segment.
fn run_of(points: &[[f32; 4]], first: usize, most: usize) -> &[[f32; 4]] {
    let mut last = first + 1;
    while last < first + most && points[last][3].is_sign_positive() {
        last += 1;
    }
    &points[first..=last]
}
