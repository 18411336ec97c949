//! The light that arrives along one ray.
//!
//! A path goes from the camera from fiber to fiber. At each it draws a direction to every light, and one by the fiber's scattering, in
//! which the path goes on. Lights with extent are met by both: the two estimates are weighted by the balance heuristic [Veach1995].
//! The sky is met by the second alone.
//!
//! **Where rays leave a fiber.** S is the radiance averaged over a fiber's width, for light that is even over its width. Among other fibers
//! light is not even: the reference takes its mean, by a ray to a place on the width, seen from the light, that is drawn evenly. Then a fiber
//! gives back just the share of the light that the model says, whatever the light. A ray from the place that the camera sees would count
//! light at the rims of the fiber more often than that at its middle. Lambert's term belongs to the surface, and its rays start there.

use glam::DVec3;
use lisle_core::scattering::FiberFrame;

use crate::assembly::{Hit, Ray, Surface};
use crate::material::{Part, Scattering};
use crate::world::World;
use lisle_core::sampling::Random;

/// Scatterings before Russian roulette may end a path.
const LEAST_BOUNCES: u32 = 3;

/// A ray starts this share of the radius off the surface.
const OFFSET: f64 = 1e-4;

/// Where a path meets a fiber.
struct Vertex<'a> {
    surface: Surface,
    /// Axes of the fiber, and of the surface: they differ at a fiber's round ends.
    fiber_frame: FiberFrame,
    surface_frame: FiberFrame,
    scattering: &'a Scattering,
    /// Towards where the path comes from, in the axes of the fiber.
    wo: DVec3,
}

impl World {
    fn vertex(&self, ray: &Ray, hit: &Hit) -> Vertex<'_> {
        let surface = self.assembly.surface(ray, hit);
        let fiber_frame = FiberFrame::new(surface.tangent, surface.normal);
        let surface_frame = FiberFrame::new(surface.normal.any_orthonormal_vector(), surface.normal);
        let wo = fiber_frame.local_from_world(-ray.direction);
        Vertex { surface, fiber_frame, surface_frame, scattering: self.scattering(hit.segment), wo }
    }

    /// Radiance along a ray that has met a fiber, by light scattered at most `bounces` times.
    pub fn radiance(&self, first: &Ray, first_hit: &Hit, bounces: Option<u32>, random: &mut Random) -> DVec3 {
        let (mut ray, mut hit) = (*first, *first_hit);
        let (mut radiance, mut throughput) = (DVec3::ZERO, DVec3::ONE);
        let meets_light = self.ambient != DVec3::ZERO || self.lights.iter().any(|light| light.has_extent());
        for bounce in 1.. {
            let vertex = self.vertex(&ray, &hit);
            radiance += throughput * self.direct(&vertex, random);
            let is_last = bounces.is_some_and(|most| bounce >= most);
            if is_last && !meets_light {
                break;
            }
            let Some(onward) = vertex.scattering.sample(vertex.wo, random) else { break };
            throughput *= onward.weight;
            let next_ray = vertex.leave(onward.part, onward.wi, random);
            let next = self.assembly.nearest(&next_ray, f64::INFINITY);
            radiance += throughput * self.met(&next_ray, vertex.lit_point(onward.part), onward.pdf, next.as_ref());
            match next {
                Some(next) if !is_last => (ray, hit) = (next_ray, next),
                _ => break,
            }
            if bounce >= LEAST_BOUNCES {
                let survival = throughput.max_element().min(1.0);
                if random.unit() >= survival {
                    break;
                }
                throughput /= survival;
            }
        }
        radiance
    }

    /// Light that comes straight from the lights, by directions drawn towards them.
    fn direct(&self, vertex: &Vertex, random: &mut Random) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for light in &self.lights {
            for part in vertex.scattering.parts() {
                let Some(sample) = light.sample(vertex.lit_point(part), random) else { continue };
                let wi = vertex.frame(part).local_from_world(sample.direction);
                let scattered = vertex.scattering.evaluate(part, vertex.wo, wi) * sample.irradiance;
                if scattered == DVec3::ZERO {
                    continue;
                }
                let share = if sample.pdf.is_finite() {
                    sample.pdf / (sample.pdf + vertex.scattering.pdf(part, vertex.wo, wi))
                } else {
                    1.0
                };
                if !self.assembly.is_blocked(&vertex.leave(part, wi, random), sample.distance) {
                    sum += scattered * share;
                }
            }
        }
        sum
    }

    /// Light that a direction drawn by the scattering, with that density, meets before the next fiber.
    fn met(&self, ray: &Ray, lit_point: DVec3, pdf: f64, next: Option<&Hit>) -> DVec3 {
        let reach = next.map_or(f64::INFINITY, |hit| hit.t);
        let mut sum = if next.is_none() { self.ambient } else { DVec3::ZERO };
        for light in self.lights.iter().filter(|light| light.has_extent()) {
            if let Some(glow) = light.meet(lit_point, ray.direction).filter(|glow| glow.distance <= reach) {
                sum += glow.radiance * (pdf / (pdf + glow.pdf));
            }
        }
        sum
    }
}

impl Vertex<'_> {
    /// The fiber's axis at the hit.
    fn axis(&self) -> DVec3 {
        self.surface.position - self.surface.cone_normal * self.surface.radius
    }

    /// The point that lights are drawn for: their density there must not depend on where a ray leaves.
    fn lit_point(&self, part: Part) -> DVec3 {
        match part {
            Part::Fiber => self.axis(),
            Part::Surface => self.surface.position,
        }
    }

    /// The axes in which a part's directions are given.
    fn frame(&self, part: Part) -> &FiberFrame {
        match part {
            Part::Fiber => &self.fiber_frame,
            Part::Surface => &self.surface_frame,
        }
    }

    /// The ray by which a part takes in light from a direction, given in the part's frame.
    fn leave(&self, part: Part, wi: DVec3, random: &mut Random) -> Ray {
        let direction = self.frame(part).world_from_local(wi).normalize();
        let Surface { position, cone_normal, radius, tangent, .. } = self.surface;
        let origin = match part {
            // On the side that faces the direction, if only by rounding.
            Part::Surface => position + cone_normal * (OFFSET * radius * cone_normal.dot(direction).signum()),
            Part::Fiber => {
                let facing = (direction - tangent * direction.dot(tangent)).normalize_or(cone_normal);
                let offset = 2.0 * random.unit() - 1.0;
                let on_rim = facing * (1.0 - offset * offset).sqrt() + tangent.cross(facing) * offset;
                self.axis() + on_rim * (radius * (1.0 + OFFSET))
            }
        };
        Ray { origin, direction }
    }
}
