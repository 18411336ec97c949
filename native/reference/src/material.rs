//! A fiber's scattering taken apart: light through and around the whole fiber, and light off the point that is seen.

use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

use glam::DVec3;
use lisle_core::scattering::{FiberScattering, Material};
use lisle_core::scene::Shading;

use lisle_core::sampling::Random;

/// Scattering at the point of a fiber that is seen, from wherever on the width: a function to compare with other renderers, of no use to
/// pictures.
pub trait NearField: Send + Sync {
    /// f times the cosine, 1/sr: radiance towards `wo` per radiance and solid angle from `wi`, both in the fiber's axes. X is the normal of the
    /// surface at the point, Z the tangent, so that `wo` tells where on the width the point is seen.
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> DVec3;

    /// A direction that light is taken from, drawn with the density [`Self::pdf`]; that should be nearly in proportion to [`Self::evaluate`]: what is
    /// left of their ratio multiplies from bounce to bounce.
    fn sample(&self, wo: DVec3, random: &mut Random) -> DVec3;

    /// Density over the solid angle, above 0 wherever light is taken from.
    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64;
}

/// Which of the parts scatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// S of the fiber: it takes in light over its whole width, wherever on the width it is seen.
    Fiber,
    /// Lambert's term at the surface.
    Surface,
    /// Another function at the surface, which takes in light from all around.
    Near,
}

/// All parts of a material.
#[derive(Clone)]
pub(crate) struct Scattering {
    fiber: Option<FiberScattering>,
    surface_albedo: DVec3,
    /// In place of all else.
    near: Option<Arc<dyn NearField>>,
}

/// A direction drawn by one part.
pub(crate) struct Onward {
    pub part: Part,
    /// Towards the light, in the part's axes: x is the normal of the surface for [`Part::Surface`].
    pub wi: DVec3,
    /// The part's throughput over the density and the part's chance.
    pub weight: DVec3,
    /// Density, with the part's chance.
    pub pdf: f64,
}

impl Scattering {
    pub fn new(material: Material, shading: Shading) -> Self {
        let bare = Material { diffuse: DVec3::ZERO, ..material };
        let (fiber, surface_albedo) = match shading {
            Shading::Simple => {
                let has_highlight = material.specular != DVec3::ZERO;
                (has_highlight.then(|| FiberScattering::simple(bare)), material.diffuse)
            }
            Shading::Physical => {
                let has_lobes = material.diffuse_weight < 1.0;
                (has_lobes.then(|| FiberScattering::physical(bare)), material.diffuse * material.diffuse_weight)
            }
        };
        Self { fiber, surface_albedo, near: None }
    }

    /// A matt surface of one colour.
    pub fn matt(color: DVec3) -> Self {
        Self { fiber: None, surface_albedo: color, near: None }
    }

    /// Another function alone.
    pub fn near(function: Arc<dyn NearField>) -> Self {
        Self { near: Some(function), ..Self::matt(DVec3::ZERO) }
    }

    /// The parts that scatter anything.
    pub fn parts(&self) -> impl Iterator<Item = Part> {
        let fiber = self.fiber.as_ref().map(|_| Part::Fiber);
        let surface = (self.surface_albedo != DVec3::ZERO).then_some(Part::Surface);
        let near = self.near.as_ref().map(|_| Part::Near);
        fiber.into_iter().chain(surface).chain(near)
    }

    /// A part's f, 1/sr: radiance towards `wo` per radiance and solid angle from `wi`.
    pub fn evaluate(&self, part: Part, wo: DVec3, wi: DVec3) -> DVec3 {
        match (part, &self.fiber) {
            (Part::Fiber, Some(fiber)) => fiber.evaluate(wo, wi),
            (Part::Fiber, None) => DVec3::ZERO,
            (Part::Surface, _) => self.surface_albedo * (FRAC_1_PI * wi.x.max(0.0)),
            (Part::Near, _) => self.near.as_ref().map_or(DVec3::ZERO, |near| near.evaluate(wo, wi)),
        }
    }

    /// Density with which [`Self::sample`] draws a direction by a part.
    pub fn pdf(&self, part: Part, wo: DVec3, wi: DVec3) -> f64 {
        let chance = self.surface_chance(wo);
        match (part, &self.fiber) {
            (Part::Fiber, Some(fiber)) => (1.0 - chance) * fiber.pdf(wo, wi),
            (Part::Fiber, None) => 0.0,
            (Part::Surface, _) => chance * FRAC_1_PI * wi.x.max(0.0),
            (Part::Near, _) => self.near.as_ref().map_or(0.0, |near| near.pdf(wo, wi)),
        }
    }

    /// Chance of the surface: about its share of the light. Neither part that scatters has none.
    fn surface_chance(&self, wo: DVec3) -> f64 {
        let mean = |color: DVec3| color.element_sum() / 3.0;
        let surface = mean(self.surface_albedo);
        match &self.fiber {
            None => 1.0,
            Some(_) if surface == 0.0 => 0.0,
            Some(fiber) => (surface / (surface + mean(fiber.albedo(wo)))).clamp(0.05, 0.95),
        }
    }

    /// Draws a part and a direction; `None` where nothing is scattered.
    pub fn sample(&self, wo: DVec3, random: &mut Random) -> Option<Onward> {
        if let Some(near) = &self.near {
            let wi = near.sample(wo, random);
            let pdf = near.pdf(wo, wi);
            let weight = near.evaluate(wo, wi) / pdf;
            return (pdf > 0.0).then_some(Onward { part: Part::Near, wi, weight, pdf });
        }
        let chance = self.surface_chance(wo);
        let (choice, numbers) = (random.unit(), random.triple());
        if choice >= chance {
            let drawn = self.fiber.as_ref()?.sample(wo, numbers)?;
            let share = 1.0 - chance;
            return Some(Onward {
                part: Part::Fiber,
                wi: drawn.wi,
                weight: drawn.weight / share,
                pdf: drawn.pdf * share,
            });
        }
        let (sin, cos) = (TAU * numbers[1]).sin_cos();
        let (height, across) = ((1.0 - numbers[0]).sqrt(), numbers[0].sqrt());
        let wi = DVec3::new(height, across * cos, across * sin);
        let pdf = chance * FRAC_1_PI * height;
        Some(Onward { part: Part::Surface, wi, weight: self.surface_albedo / chance, pdf })
    }
}
