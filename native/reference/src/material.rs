//! A fiber's scattering taken apart: light through and around the whole fiber, and light off the point that is seen.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;
use lisle_core::scattering::{FiberScattering, Material};
use lisle_core::scene::Shading;

use lisle_core::sampling::Random;

/// Which of the two parts scatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// S of the fiber: it takes in light over its whole width, wherever on the width it is seen.
    Fiber,
    /// Lambert's term at the surface.
    Surface,
}

/// Both parts of a material.
#[derive(Clone)]
pub(crate) struct Scattering {
    fiber: Option<FiberScattering>,
    surface_albedo: DVec3,
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
        Self { fiber, surface_albedo }
    }

    /// A matt surface of one colour.
    pub fn matt(color: DVec3) -> Self {
        Self { fiber: None, surface_albedo: color }
    }

    /// The parts that scatter anything.
    pub fn parts(&self) -> impl Iterator<Item = Part> {
        let fiber = self.fiber.as_ref().map(|_| Part::Fiber);
        let surface = (self.surface_albedo != DVec3::ZERO).then_some(Part::Surface);
        fiber.into_iter().chain(surface)
    }

    /// A part's f, 1/sr: radiance towards `wo` per radiance and solid angle from `wi`.
    pub fn evaluate(&self, part: Part, wo: DVec3, wi: DVec3) -> DVec3 {
        match (part, &self.fiber) {
            (Part::Fiber, Some(fiber)) => fiber.evaluate(wo, wi),
            (Part::Fiber, None) => DVec3::ZERO,
            (Part::Surface, _) => self.surface_albedo * (FRAC_1_PI * wi.x.max(0.0)),
        }
    }

    /// Density with which [`Self::sample`] draws a direction by a part.
    pub fn pdf(&self, part: Part, wo: DVec3, wi: DVec3) -> f64 {
        let chance = self.surface_chance(wo);
        match (part, &self.fiber) {
            (Part::Fiber, Some(fiber)) => (1.0 - chance) * fiber.pdf(wo, wi),
            (Part::Fiber, None) => 0.0,
            (Part::Surface, _) => chance * FRAC_1_PI * wi.x.max(0.0),
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
