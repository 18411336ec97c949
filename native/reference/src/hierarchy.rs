//! Boxes about things, and what rays meet among them.

use std::ops::ControlFlow;
use std::time::Duration;

use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as BoxRay, RayHit};
use rayon::prelude::*;

use crate::Error;

/// Items of a part of the hierarchy, about. Parts are built one after another, so that the work can be stopped between them, and building
/// takes memory for few at once.
const PART: usize = 1 << 16;

/// Items are sorted into so many cells a side before they are shared out to parts.
const CELLS: usize = 64;

/// Radius of the scene among boxes, about: the box test ignores the first 1e-4 of a ray, which must be next to nothing.
const BOX_RADIUS: f64 = 65536.0;

/// Margin about boxes: what f32 rounds away.
const MARGIN: f32 = 1e-6 * BOX_RADIUS as f32;

/// A ray of unit direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes.
    pub direction: DVec3,
}

/// Least and greatest coordinates.
pub(crate) type Extent = (DVec3, DVec3);

/// The box about two.
pub(crate) fn union(a: Extent, b: Extent) -> Extent {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The box about nothing.
pub(crate) const NOTHING: Extent = (DVec3::INFINITY, DVec3::NEG_INFINITY);

/// A bounding volume hierarchy of two levels: parts of the scene and what is in each.
pub(crate) struct Hierarchy {
    /// Part after part, each in the order of its leaves.
    items: Vec<u32>,
    parts: Vec<Part>,
    /// Over the parts.
    top: CwBvh,
    /// Units of the boxes per unit of length, a power of two; their origin is the centre.
    scale: f64,
    center: DVec3,
    /// Of a sphere about the centre that holds everything.
    radius: f64,
}

/// Items that lie near each other.
struct Part {
    first: usize,
    hierarchy: CwBvh,
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

impl Hierarchy {
    /// Builds the hierarchy over items with a place and a box each, all within `extent`. `progress` is called several times a second and
    /// can stop the work.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn new(
        mut items: Vec<u32>,
        extent: Extent,
        place: impl Fn(u32) -> DVec3,
        bounds: impl Fn(u32) -> Extent + Sync,
        progress: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Self, Error> {
        let (low, high) = if items.is_empty() { (DVec3::ZERO, DVec3::ZERO) } else { extent };
        let center = 0.5 * (low + high);
        let radius = 0.5 * low.distance(high);
        let scale = (BOX_RADIUS / radius.max(1e-30)).log2().round().exp2();
        let mut go_on = || if progress().is_break() { Err(Error::Cancelled) } else { Ok(()) };
        go_on()?;
        if items.len() > PART {
            items = by_cells(&items, place, low, high, &mut go_on)?;
        }
        let aabb = |item: &u32| {
            let (low, high) = bounds(*item);
            let [low, high] = [low, high].map(|corner| ((corner - center) * scale).as_vec3a());
            Aabb { min: low - MARGIN, max: high + MARGIN }
        };
        let (mut parts, mut boxes) = (Vec::new(), Vec::new());
        // As many parts at once as there are threads: a part takes some hundredths of a second.
        let starts: Vec<usize> = (0..items.len()).step_by(PART).collect();
        for starts in starts.chunks(rayon::current_num_threads()) {
            let built: Vec<_> = starts
                .par_iter()
                .map(|&first| {
                    let items = &items[first..items.len().min(first + PART)];
                    let boxes: Vec<Aabb> = items.iter().map(aabb).collect();
                    let mut hierarchy = build_cwbvh(&boxes, one_a_leaf(), &mut Duration::default());
                    let order = std::mem::take(&mut hierarchy.primitive_indices);
                    let ordered: Vec<u32> = order.into_iter().map(|place| items[place as usize]).collect();
                    let bounds = boxes.iter().fold(Aabb::empty(), |all, one| all.union(one));
                    (Part { first, hierarchy }, ordered, bounds)
                })
                .collect();
            for (part, ordered, bounds) in built {
                items[part.first..part.first + ordered.len()].copy_from_slice(&ordered);
                parts.push(part);
                boxes.push(bounds);
            }
            go_on()?;
        }
        let mut top = build_cwbvh(&boxes, one_a_leaf(), &mut Duration::default());
        let mut places: Vec<Option<Part>> = parts.into_iter().map(Some).collect();
        let parts = std::mem::take(&mut top.primitive_indices);
        let parts = parts.into_iter().filter_map(|place| places[place as usize].take()).collect();
        Ok(Self { items, parts, top, scale, center, radius })
    }

    /// Its bytes.
    pub fn bytes(&self) -> usize {
        let nodes: usize = self.parts.iter().map(|part| size_of_val(&part.hierarchy.nodes[..])).sum();
        size_of_val(&self.items[..]) + nodes + size_of_val(&self.top.nodes[..])
    }

    /// Centre and radius of a sphere that holds everything.
    pub fn bounds(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    /// Shows items that may lie on the ray between the distances 0 and `reach`. `visit` returns the distance beyond which nothing counts any
    /// more.
    pub fn nearest(&self, ray: &Ray, reach: f64, mut visit: impl FnMut(u32) -> f64) {
        let Some(clipped) = self.clip(ray, reach) else { return };
        let mut most = reach;
        let shortened = |most: f64| if most < reach { clipped.shorten(most) } else { f32::INFINITY };
        self.top.ray_traverse(clipped.ray, &mut RayHit::none(), |box_ray, part| {
            let Part { first, hierarchy } = &self.parts[part];
            hierarchy.ray_traverse(*box_ray, &mut RayHit::none(), |_, id| {
                most = visit(self.items[first + id]);
                shortened(most)
            });
            shortened(most)
        });
    }

    /// Whether `is_hit` for any item that may lie on the ray between the distances 0 and `reach`.
    pub fn any(&self, ray: &Ray, reach: f64, is_hit: impl Fn(u32) -> bool) -> bool {
        let Some(clipped) = self.clip(ray, reach) else { return false };
        // A hit is told by a distance of 0.
        let distance = |is_hit: bool| if is_hit { 0.0 } else { f32::INFINITY };
        !self.top.ray_traverse_miss(clipped.ray, |box_ray, part| {
            let Part { first, hierarchy } = &self.parts[part];
            distance(!hierarchy.ray_traverse_miss(*box_ray, |_, id| distance(is_hit(self.items[first + id]))))
        })
    }

    /// The ray in f32 from where it comes near the scene; `None` if it never does.
    fn clip(&self, ray: &Ray, reach: f64) -> Option<Clipped> {
        let skip = ((self.center - ray.origin).dot(ray.direction) - 1.01 * self.radius).max(0.0);
        if self.items.is_empty() || skip >= reach {
            return None;
        }
        let start = ((ray.origin + ray.direction * skip - self.center) * self.scale).as_vec3a();
        // No negative zeros: the box test takes the sign of a component from a comparison with zero.
        let direction = ray.direction.as_vec3a() + 0.0;
        let clipped = Clipped { ray: BoxRay::new(start, direction, 0.0, f32::MAX), skip, scale: self.scale };
        Some(Clipped { ray: BoxRay { tmax: clipped.shorten(reach), ..clipped.ray }, ..clipped })
    }
}

fn one_a_leaf() -> BvhBuildParams {
    BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::fast_build() }
}

/// Items in the order of the cells of a grid along a space-filling curve, so that neighbours in the list are neighbours in space.
fn by_cells(
    items: &[u32],
    place: impl Fn(u32) -> DVec3,
    low: DVec3,
    high: DVec3,
    go_on: &mut dyn FnMut() -> Result<(), Error>,
) -> Result<Vec<u32>, Error> {
    const BLOCK: usize = 1 << 21;
    let cells = (high - low).max_element().max(1e-30).recip() * CELLS as f64;
    // Bits of the three numbers in turn: a Morton code.
    let spread = |i: u32| (0..CELLS.ilog2()).map(|bit| (i >> bit & 1) << (3 * bit)).sum::<u32>();
    let spread: Vec<u32> = (0..CELLS as u32).map(spread).collect();
    let cell = |item: u32| {
        let place = ((place(item) - low) * cells).as_uvec3().min(glam::UVec3::splat(CELLS as u32 - 1));
        (spread[place.x as usize] | spread[place.y as usize] << 1 | spread[place.z as usize] << 2) as usize
    };
    let mut starts = vec![0_usize; CELLS.pow(3) + 1];
    for block in items.chunks(BLOCK) {
        block.iter().for_each(|item| starts[cell(*item) + 1] += 1);
        go_on()?;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut sorted = vec![0; items.len()];
    for block in items.chunks(BLOCK) {
        for item in block {
            let next = &mut starts[cell(*item)];
            sorted[*next] = *item;
            *next += 1;
        }
        go_on()?;
    }
    Ok(sorted)
}
