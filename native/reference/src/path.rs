//! The light that arrives along one ray.
//!
//! A path goes from the camera from fiber to fiber. At each it draws a direction to every light, and one by the fiber's scattering, in
//! which the path goes on. Lights with extent are met by both: the two estimates are weighted by the balance heuristic [Veach1995].
//! The even sky is met by the second alone.
//!
//! **Where rays leave a fiber.** S is the radiance averaged over a fiber's width, for light that is even over its width. Among other fibers
//! light is not even: the reference takes its mean, by a ray to a place on the width, seen from the light, that is drawn evenly. Then a fiber
//! gives back just the share of the light that the model says, whatever the light. A ray from the place that the camera sees would count
//! light at the rims of the fiber more often than that at its middle. Lambert's term belongs to the surface, and its rays start there. Meshes
//! have that term alone.

use std::borrow::Cow;
use std::f64::consts::PI;

use glam::DVec3;
use lisle_core::scattering::FiberFrame;

use crate::assembly::{Ray, Surface};
use crate::material::{Part, Scattering};
use crate::world::{Met, World};
use lisle_core::sampling::Random;

/// Scatterings before Russian roulette may end a path.
const LEAST_BOUNCES: u32 = 3;

/// A ray starts this share of the radius off the surface.
const OFFSET: f64 = 1e-4;

/// Where a path meets a fiber or a mesh.
struct Vertex<'a> {
    surface: Surface,
    /// Axes of the fiber, and of the surface: they differ at a fiber's round ends.
    fiber_frame: FiberFrame,
    surface_frame: FiberFrame,
    scattering: Cow<'a, Scattering>,
    /// Whether nothing comes from behind the surface, as that of a mesh.
    is_opaque: bool,
    /// Towards where the path comes from, in the axes of the fiber.
    wo: DVec3,
}

impl World {
    fn vertex(&self, ray: &Ray, met: &Met) -> Vertex<'_> {
        let (surface, scattering, is_opaque) = match met {
            Met::Fiber(hit) => (self.assembly.surface(ray, hit), Cow::Borrowed(self.scattering(hit.segment)), false),
            Met::Surface(hit) => {
                let face = self.surfaces.face(ray, hit);
                let surface = Surface {
                    position: face.position,
                    normal: face.normal,
                    cone_normal: face.facing,
                    tangent: face.normal.any_orthonormal_vector(),
                    radius: self.surfaces.offset() / OFFSET,
                };
                let color = self.surfaces.mesh(hit).base_color.as_dvec3();
                (surface, Cow::Owned(Scattering::matt(color)), true)
            }
        };
        let fiber_frame = FiberFrame::new(surface.tangent, surface.normal);
        let surface_frame = FiberFrame::new(surface.normal.any_orthonormal_vector(), surface.normal);
        let wo = fiber_frame.local_from_world(-ray.direction);
        Vertex { surface, fiber_frame, surface_frame, scattering, is_opaque, wo }
    }

    /// Radiance along a ray that has met something, by light scattered at most `bounces` times.
    pub fn radiance(&self, first: &Ray, first_met: &Met, bounces: Option<u32>, random: &mut Random) -> DVec3 {
        let (mut ray, mut met) = (*first, *first_met);
        let (mut radiance, mut throughput) = (DVec3::ZERO, DVec3::ONE);
        let meets_light = self.ambient != DVec3::ZERO || self.lights.iter().any(|light| light.has_extent());
        for bounce in 1.. {
            let vertex = self.vertex(&ray, &met);
            radiance += throughput * self.direct(&vertex, random);
            let is_last = bounces.is_some_and(|most| bounce >= most);
            if is_last && !meets_light {
                break;
            }
            let Some(onward) = vertex.scattering.sample(vertex.wo, random) else { break };
            throughput *= onward.weight;
            let next_ray = vertex.leave(onward.part, onward.wi, random);
            if vertex.is_behind(next_ray.direction) {
                break;
            }
            let next = self.nearest(&next_ray, f64::INFINITY);
            radiance += throughput * self.met(&next_ray, vertex.lit_point(onward.part), onward.pdf, next.as_ref());
            match next {
                Some(next) if !is_last => (ray, met) = (next_ray, next),
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
                if vertex.is_behind(sample.direction) {
                    continue;
                }
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
                if !self.is_blocked(&vertex.leave(part, wi, random), sample.distance) {
                    sum += scattered * share;
                }
            }
        }
        sum
    }

    /// Share of the light on a mesh that something keeps from it, by luminance: at most 1, and 0 in the dark. The light that there would be
    /// is a mean over several directions to each light, so that a sample's share is one of all light.
    pub fn shadow(&self, ray: &Ray, met: &Met, random: &mut Random) -> f64 {
        const DRAWS: u32 = 16;
        let luminance = |color: DVec3| color.dot(DVec3::new(0.2126, 0.7152, 0.0722));
        let vertex = self.vertex(ray, met);
        let lit_point = vertex.lit_point(Part::Surface);
        let open = |direction: DVec3| {
            if vertex.is_behind(direction) { 0.0 } else { vertex.surface.normal.dot(direction).max(0.0) }
        };
        let is_hidden = |direction: DVec3, distance: f64, random: &mut Random| {
            let wi = vertex.surface_frame.local_from_world(direction);
            self.is_blocked(&vertex.leave(Part::Surface, wi, random), distance)
        };
        let (mut hidden, mut all) = (0.0, 0.0);
        for light in &self.lights {
            for draw in 0..DRAWS {
                let Some(sample) = light.sample(lit_point, random) else { continue };
                let light = luminance(sample.irradiance) * open(sample.direction);
                all += light / f64::from(DRAWS);
                if draw == 0 && light > 0.0 && is_hidden(sample.direction, sample.distance, random) {
                    hidden += light;
                }
            }
        }
        // A direction of the even sky, by the cosine.
        let even = Scattering::matt(self.ambient);
        if let Some(onward) = even.sample(DVec3::X, random) {
            let direction = vertex.surface_frame.world_from_local(onward.wi);
            let light = luminance(onward.weight) * PI;
            all += light;
            if light > 0.0 && open(direction) > 0.0 && is_hidden(direction, f64::INFINITY, random) {
                hidden += light;
            }
        }
        if all > 0.0 { (hidden / all).min(1.0) } else { 0.0 }
    }

    /// Light that a direction drawn by the scattering, with that density, meets before anything else.
    fn met(&self, ray: &Ray, lit_point: DVec3, pdf: f64, next: Option<&Met>) -> DVec3 {
        let reach = next.map_or(f64::INFINITY, Met::t);
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
    /// Whether a direction leads into a mesh.
    fn is_behind(&self, direction: DVec3) -> bool {
        self.is_opaque && direction.dot(self.surface.cone_normal) <= 0.0
    }

    /// The fiber's axis at the hit.
    fn axis(&self) -> DVec3 {
        self.surface.position - self.surface.cone_normal * self.surface.radius
    }

    /// The point that lights are drawn for: their density there must not depend on where a ray leaves.
    fn lit_point(&self, part: Part) -> DVec3 {
        match part {
            Part::Fiber => self.axis(),
            Part::Surface | Part::Near => self.surface.position,
        }
    }

    /// The axes in which a part's directions are given.
    fn frame(&self, part: Part) -> &FiberFrame {
        match part {
            Part::Fiber | Part::Near => &self.fiber_frame,
            Part::Surface => &self.surface_frame,
        }
    }

    /// The ray by which a part takes in light from a direction, given in the part's frame.
    fn leave(&self, part: Part, wi: DVec3, random: &mut Random) -> Ray {
        let direction = self.frame(part).world_from_local(wi).normalize();
        let Surface { position, cone_normal, radius, tangent, .. } = self.surface;
        let origin = match part {
            // On the side that faces the direction, if only by rounding.
            Part::Surface | Part::Near => {
                position + cone_normal * (OFFSET * radius * cone_normal.dot(direction).signum())
            }
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
