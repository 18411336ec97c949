use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::lobe::{Azimuth, Lobe};
use super::longitudinal::gaussian_integral;
use super::physical::{fresnel, schlick};
use super::quadrature::simpson;
use super::tables::lookup;
use super::{
    FiberAngles, Material, Normalizers, Thread, ThreadTables, albedo, highlight_scale, physical_reflected,
    simple_reflected, von_mises_scale,
};

/// One fiber's scattering as a path tracer over round fibers uses it: evaluation, sampling, density, albedo.
///
/// **Directions** are unit vectors in the axes of [`super::FiberFrame`] at the hit, both away from the fiber: `wo` towards the viewer
/// (the way back along the path), `wi` towards the light (the way on).
///
/// **Throughput.** [`Self::evaluate`] is f in L_o = ∫ L_i f dω_i over the *whole* sphere; every cosine is in it. It is the sum of
///
/// - S cos θ_i, a fiber's function. S is defined by the radiance averaged over the fiber's width (the contract in
///   [`crate::scattering`]). A path tracer meets single points of the width, with uniform density over it as seen by the viewer. The
///   average of what it computes is right if the throughput at a point is one whose mean over the width is S cos θ_i; S cos θ_i at every
///   point is the simplest and has the least variance. So this part does not depend on the normal, and takes light from behind
///   the surface as well: light through the fiber.
/// - a Lambert term albedo/π max(n·ω_i, 0) at the surface normal n of the point, x in these axes. Its mean over the width is that of a
///   Lambert cylinder, so both terms share a unit. It is mixed as the renderer mixes it: [`physical_reflected`], [`simple_reflected`].
///
/// **Continuing rays** (to lights as well): S is for light that is even over the fiber's width. Where it is not, a ray from a place on the width
/// that is drawn evenly, seen from where the ray goes, takes its mean. Lambert's term takes in light at the hit itself. S holds all that happens
/// inside: hits of the same fiber before the ray has left it are to be ignored.
///
/// **What holds.** Light is conserved: [`Self::albedo`] ≤ 1. Reciprocity, f(ω_o, ω_i) cos θ_o = f(ω_i, ω_o) cos θ_i for the fiber's part, holds for `Simple` and
/// `Thread` but not for `Physical`, whose lobes are normalised by the light's θ_i alone. So a white `Physical` fiber gives back all light, but seen at a
/// slant under uniform light it is not exactly 1: it is [`Self::ambient`]. Only a Lambert fiber of albedo 1 disappears in a furnace at every angle.
#[derive(Clone, Debug)]
pub enum FiberScattering {
    /// Lambert and the highlight of [WuYuksel2018, Eq. 5].
    Simple(SimpleFiber),
    /// R + TT [Khungurn2015], mixed with a Lambert term.
    Physical(Box<PhysicalFiber>),
    /// A thread as a whole [Sadeghi2012, Eq. 2–4].
    Thread(Box<ThreadFiber>),
}

/// A direction of light drawn by [`FiberScattering::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatteringSample {
    /// Towards the light, in the axes of [`super::FiberFrame`].
    pub wi: DVec3,
    /// [`FiberScattering::evaluate`] divided by `pdf`: what the path's throughput is multiplied by.
    pub weight: DVec3,
    /// [`FiberScattering::pdf`] > 0, 1/sr.
    pub pdf: f64,
}

/// Parameters of [`FiberScattering::Simple`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimpleFiber {
    material: Material,
    /// Albedo of the highlight's shape, its colour left out, over ∫ g cos²θ dθ.
    scale: f64,
}

/// Parameters of [`FiberScattering::Physical`], and its normalisers in tables fine enough for a reference (tested: within 2e-4).
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicalFiber {
    material: Material,
    /// √ ∫ g cos²θ_o dθ_o over |θ_i|, for β_R and β_TT.
    root_integral_r: Vec<f64>,
    root_integral_tt: Vec<f64>,
    azimuthal_tt: f64,
    azimuth_tt: Azimuth,
}

/// Parameters of [`FiberScattering::Thread`], and its energy in tables.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadFiber {
    thread: Thread,
    tables: ThreadTables,
}

const NORMALIZER_TABLE_SIZE: usize = 2048;

impl PhysicalFiber {
    fn new(material: Material) -> Self {
        let table = |beta: f64| {
            let theta = |k: usize| FRAC_PI_2 * k as f64 / (NORMALIZER_TABLE_SIZE - 1) as f64;
            (0..NORMALIZER_TABLE_SIZE).map(|k| gaussian_integral(theta(k), beta).sqrt()).collect()
        };
        Self {
            root_integral_r: table(material.beta_r_rad),
            root_integral_tt: table(material.beta_tt_rad),
            azimuthal_tt: von_mises_scale(material.gamma_tt_rad),
            azimuth_tt: Azimuth::straight(material.gamma_tt_rad),
            material,
        }
    }

    fn normalizers(&self, theta_i_rad: f64) -> Normalizers {
        Normalizers {
            integral_r: lookup(&self.root_integral_r, theta_i_rad).powi(2),
            integral_tt: lookup(&self.root_integral_tt, theta_i_rad).powi(2),
            azimuthal_tt: self.azimuthal_tt,
        }
    }

    /// ∫ weight(cos θ_i) M cos²θ_i dθ_i for light from all sides.
    fn over_light(&self, theta_o: f64, root_integral: &[f64], beta: f64, weight: impl Fn(f64) -> f64) -> f64 {
        let reach = 8.0 * beta;
        let (from, to) = ((-theta_o - reach).max(-FRAC_PI_2), (-theta_o + reach).min(FRAC_PI_2));
        simpson(from, to, 200, |theta_i| {
            let m = super::gaussian(theta_o + theta_i, beta) / lookup(root_integral, theta_i).powi(2);
            weight(theta_i.cos()) * m * theta_i.cos().powi(2)
        })
    }
}

/// Share of each lobe in a mixture of densities; unused ones have none.
type Mixture = [(f64, Lobe); 3];

impl FiberScattering {
    /// The simple model of a valid material ([`Material::validate`]).
    pub fn simple(material: Material) -> Self {
        Self::Simple(SimpleFiber { scale: highlight_scale(material.specular_beta_rad), material })
    }

    /// The physically based model of a valid material ([`Material::validate`]). Takes milliseconds: tables are filled.
    pub fn physical(material: Material) -> Self {
        Self::Physical(Box::new(PhysicalFiber::new(material)))
    }

    /// The thread model of a valid thread ([`Thread::validate`]). Takes about a fifth of a second on one core: tables are filled.
    pub fn thread(thread: Thread) -> Self {
        Self::Thread(Box::new(ThreadFiber { tables: ThreadTables::new(&thread), thread }))
    }

    /// f, 1/sr: radiance towards `wo` per radiance and solid angle from `wi`, all cosines included.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> DVec3 {
        let angles = FiberAngles::from_directions(DVec3::Z, wi, wo);
        match self {
            Self::Simple(fiber) => simple_reflected(&fiber.material, &angles, wi.x),
            Self::Physical(fiber) => {
                let normalizers = fiber.normalizers(angles.theta_i_rad());
                physical_reflected(&fiber.material, &normalizers, &angles, wi.x)
            }
            Self::Thread(fiber) => fiber.tables.evaluate(&fiber.thread, &angles),
        }
    }

    /// Draws the direction of light by three numbers in [0, 1), the first of which chooses the lobe. `None` where nothing is scattered.
    pub fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<ScatteringSample> {
        let mixture = self.mixture(wo);
        let total: f64 = mixture.iter().map(|(share, _)| share).sum();
        let mut left = u[0] * total;
        let lobe = mixture.iter().filter(|(share, _)| *share > 0.0).find_map(|(share, lobe)| {
            left -= share;
            (left < 0.0).then_some(lobe)
        });
        // Rounding can leave a remainder behind the last lobe.
        let lobe = lobe.or_else(|| mixture.iter().rev().find(|(share, _)| *share > 0.0).map(|(_, lobe)| lobe))?;
        let wi = lobe.sample(wo, [u[1], u[2]]);
        let pdf = density(&mixture, wo, wi);
        (pdf > 0.0).then(|| ScatteringSample { wi, weight: self.evaluate(wo, wi) / pdf, pdf })
    }

    /// Density of [`Self::sample`] over the solid angle of `wi`, 1/sr; 0 where nothing is scattered.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        density(&self.mixture(wo), wo, wi)
    }

    /// Share of the light from `wi` that the fiber scatters, over its whole width and all viewers: ∫ S cos θ_o dω_o, and the Lambert term's.
    pub fn albedo(&self, wi: DVec3) -> DVec3 {
        let cos_theta_i = wi.truncate().length().min(1.0);
        match self {
            Self::Simple(SimpleFiber { material, scale }) => {
                // cos(φ/2) integrates to 4; θ_h of width β is θ_o of width 2β.
                let shape = gaussian_integral(wi.z.atan2(cos_theta_i), 2.0 * material.specular_beta_rad);
                material.specular * (scale * 4.0 * shape) + material.diffuse
            }
            Self::Physical(fiber) => {
                let (m, w) = (&fiber.material, fiber.material.diffuse_weight);
                albedo(m, cos_theta_i) * (1.0 - w) + m.diffuse * w
            }
            Self::Thread(fiber) => fiber.tables.albedo(&fiber.thread, wi.z.atan2(cos_theta_i)),
        }
    }

    /// Radiance towards `wo` under radiance 1 from all directions, ∫ f dω_i: the mean weight of [`Self::sample`]. By quadrature.
    pub fn ambient(&self, wo: DVec3) -> DVec3 {
        match self {
            // Reciprocal, so that light and viewer may change places.
            Self::Simple(_) | Self::Thread(_) => self.albedo(wo),
            Self::Physical(fiber) => {
                let m = &fiber.material;
                let theta_o = wo.z.atan2(wo.truncate().length());
                let over = |beta, root: &[f64], weight: fn(f64) -> f64| fiber.over_light(theta_o, root, beta, weight);
                super::physical_ambient(
                    m,
                    &super::AmbientFactors {
                        reflect: over(m.beta_r_rad, &fiber.root_integral_r, |_| 1.0),
                        reflect_grazing: over(m.beta_r_rad, &fiber.root_integral_r, schlick),
                        transmit: over(m.beta_tt_rad, &fiber.root_integral_tt, |cos| 1.0 - schlick(cos)),
                    },
                )
            }
        }
    }

    /// The lobes for a viewer, with about the light that each scatters. A lobe that can scatter any has a share above 0.
    fn mixture(&self, wo: DVec3) -> Mixture {
        let mean = |color: DVec3| color.element_sum() / 3.0;
        match self {
            Self::Simple(SimpleFiber { material: m, .. }) => {
                let cone = Lobe::Cone { sigma_rad: 2.0 * m.specular_beta_rad, azimuth: Azimuth::HalfCosine };
                [(mean(m.specular), cone), (mean(m.diffuse), Lobe::Lambert), (0.0, Lobe::Even)]
            }
            Self::Physical(fiber) => {
                let (m, w) = (&fiber.material, fiber.material.diffuse_weight);
                let theta = wo.z.atan2(wo.truncate().length()).abs();
                // F at the cone, from θ ± β, so that neither F nor 1 − F is 0 where the lobe has more of it.
                let reflect = fresnel(m.color_r, (theta + m.beta_r_rad).min(FRAC_PI_2).cos());
                let enter = DVec3::ONE - fresnel(m.color_r, (theta - m.beta_tt_rad).max(0.0).cos());
                let cone = |sigma_rad, azimuth| Lobe::Cone { sigma_rad, azimuth };
                [
                    ((1.0 - w) * mean(reflect), cone(m.beta_r_rad, Azimuth::Uniform)),
                    ((1.0 - w) * mean(enter * m.color_tt), cone(m.beta_tt_rad, fiber.azimuth_tt)),
                    (w * mean(m.diffuse), Lobe::Lambert),
                ]
            }
            Self::Thread(fiber) => {
                let theta = wo.z.atan2(wo.truncate().length());
                let [surface, volume] = fiber.tables.terms(theta);
                let (volume, isotropic) = (volume * mean(fiber.thread.color), fiber.thread.isotropic);
                // θ_h of width γ is θ_i of width 2γ. F grows where cos(φ/2) falls: their product is about uniform in φ.
                let cone = |width: f64| Lobe::Cone { sigma_rad: 2.0 * width, azimuth: Azimuth::Uniform };
                [
                    (surface, cone(fiber.thread.surface_width_rad)),
                    (volume * (1.0 - isotropic), cone(fiber.thread.volume_width_rad)),
                    (volume * isotropic, Lobe::Even),
                ]
            }
        }
    }
}

fn density(mixture: &Mixture, wo: DVec3, wi: DVec3) -> f64 {
    let total: f64 = mixture.iter().map(|(share, _)| share).sum();
    if total <= 0.0 {
        return 0.0;
    }
    let used = mixture.iter().filter(|(share, _)| *share > 0.0);
    used.map(|(share, lobe)| share * lobe.density(wo, wi)).sum::<f64>() / total
}

#[cfg(test)]
mod tests {
    use super::super::MATERIAL_NAMES;
    use super::*;

    #[test]
    fn normalisers_of_a_reference_are_within_their_bound_between_entries() {
        let mut worst = 0.0_f64;
        for name in MATERIAL_NAMES {
            let material = Material::preset(name).expect(name);
            let fiber = PhysicalFiber::new(material);
            for k in 0..=4000 {
                let theta = FRAC_PI_2 * f64::from(k) / 4000.0;
                let (table, exact) = (fiber.normalizers(theta), Normalizers::exact(&material, theta));
                worst = worst.max((table.integral_r / exact.integral_r - 1.0).abs());
                worst = worst.max((table.integral_tt / exact.integral_tt - 1.0).abs());
            }
        }
        println!("normalisers within {worst:.1e}");
        assert!(worst < 2e-4, "{worst}");
    }

    #[test]
    fn a_fiber_that_scatters_nothing_draws_nothing() {
        let silk = Material::preset("silk").expect("preset");
        let black = Material { specular: DVec3::ZERO, diffuse: DVec3::ZERO, ..silk };
        let fiber = FiberScattering::simple(black);
        assert_eq!(fiber.sample(DVec3::X, [0.3, 0.4, 0.5]), None);
        assert_eq!(fiber.pdf(DVec3::X, DVec3::Y), 0.0);
    }
}
