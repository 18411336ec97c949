use std::f64::consts::TAU;

use glam::{DMat2, DMat4, DVec2, DVec4};
use rayon::prelude::*;

use crate::Bundle;
use crate::self_shadow::{EXTENT, bilinear};

/// Texels along a side.
const SIZE: usize = 64;
/// Directions over the whole circle, at least; divided evenly over the section's K equal sectors.
const DIRECTIONS: u32 = 96;
/// Texels along a side of the optical depths that are averaged.
const FINE_SIZE: usize = 128;
/// Of the bundle's sections, one of so many is enough for them: the mean over directions has the noise of all.
const SHARE: usize = 4;

/// Share of the ambient light that reaches a point of a yarn's section, both ways of [WuYuksel2018 §4.2].
///
/// The mean of exp(−τ) over all directions in the section. Along a straight yarn τ does not depend on a direction's
/// inclination, so that this is the mean over the sphere. Even directions take the place of the paper's random ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Occlusion {
    /// Texels along x and along y; values are at texel centres.
    pub size: usize,
    /// Half side of the square covered, in outer radii.
    pub extent: f32,
    /// Visibility in [0, 1] as `[y][x]`, section coordinates.
    pub visibility: Vec<f32>,
    /// The distance-based way: c₀ + c₁ρ + c₂ρ² + c₃ρ³ with ρ = min(|q|, extent), the least-squares fit to the mean over the angle;
    /// clamped to [0, 1], beyond which it swings by a percent near the centre of dense yarns.
    pub cubic: [f32; 4],
}

/// Visibility at section points, from fine slices of optical depth.
struct Slices {
    plies: u32,
    /// Light angle and `[y][x]` depths, over one sector.
    sector: Vec<(f64, Vec<f64>)>,
}

impl Slices {
    fn new(bundle: &Bundle) -> Self {
        let count = DIRECTIONS.div_ceil(bundle.plies);
        let sector = (0..count)
            .into_par_iter()
            .map(|k| {
                let psi = TAU / f64::from(bundle.plies) * (f64::from(k) + 0.5) / f64::from(count);
                (psi, bundle.depths(psi, FINE_SIZE, EXTENT, SHARE))
            })
            .collect();
        Self { plies: bundle.plies, sector }
    }

    fn visibility(&self, q: DVec2) -> f64 {
        let mut sum = 0.0;
        for (psi, slice) in &self.sector {
            for ply in 0..self.plies {
                // The section looks the same from every sector.
                let angle = psi + TAU * f64::from(ply) / f64::from(self.plies);
                sum += (-bilinear(slice, FINE_SIZE, EXTENT, DMat2::from_angle(-angle) * q)).exp();
            }
        }
        sum / (self.sector.len() * self.plies as usize) as f64
    }
}

/// Distances at which the cubic is fitted, and angles whose mean it fits.
const RINGS: u32 = 64;
const ANGLES: u32 = 32;

/// ρ and the mean visibility over one sector's angles at that distance.
fn radial_average(slices: &Slices) -> Vec<(f64, f64)> {
    let sector = TAU / f64::from(slices.plies);
    (0..=RINGS)
        .into_par_iter()
        .map(|ring| {
            let rho = EXTENT * f64::from(ring) / f64::from(RINGS);
            let angle = |k: u32| sector * f64::from(k) / f64::from(ANGLES);
            let sum: f64 = (0..ANGLES).map(|k| slices.visibility(DVec2::from_angle(angle(k)) * rho)).sum();
            (rho, sum / f64::from(ANGLES))
        })
        .collect()
}

fn powers(rho: f64) -> DVec4 {
    DVec4::new(1.0, rho, rho * rho, rho * rho * rho)
}

/// Least squares by the normal equations, which are well conditioned for four powers over [0, 1.25].
fn fit_cubic(samples: &[(f64, f64)]) -> DVec4 {
    let (mut matrix, mut right) = (DMat4::ZERO, DVec4::ZERO);
    for &(rho, value) in samples {
        let p = powers(rho);
        matrix += DMat4::from_cols(p * p.x, p * p.y, p * p.z, p * p.w);
        right += p * value;
    }
    matrix.inverse() * right
}

impl Occlusion {
    /// Averages over directions, then over angles. `resolution`, ≥ 1: times as many texels along each side.
    pub fn new(bundle: &Bundle, resolution: usize) -> Self {
        let slices = Slices::new(bundle);
        let size = resolution * SIZE;
        let texel = 2.0 * EXTENT / size as f64;
        let center = |k: usize| (k as f64 + 0.5) * texel - EXTENT;
        let visibility = (0..size * size)
            .into_par_iter()
            .map(|k| slices.visibility(DVec2::new(center(k % size), center(k / size))) as f32)
            .collect();
        let cubic = fit_cubic(&radial_average(&slices)).to_array().map(|c| c as f32);
        Self { size, extent: EXTENT as f32, visibility, cubic }
    }

    /// Bilinear lookup at a point of the section; the same as `self_occlusion` in `shaders/passes/lighting.wgsl`.
    pub fn at(&self, q: DVec2) -> f64 {
        bilinear(&self.visibility, self.size, f64::from(self.extent), q)
    }

    /// The distance-based approximation at a point of the section; the other half of `self_occlusion`.
    pub fn at_distance(&self, q: DVec2) -> f64 {
        DVec4::from(self.cubic.map(f64::from)).dot(powers(q.length().min(EXTENT))).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use lisle_core::yarn::{PRESET_NAMES, Yarn};

    use super::*;
    use crate::explicit::{Random, Sections};

    #[test]
    fn visibility_grows_outwards_and_the_cubic_follows_it() {
        for name in PRESET_NAMES {
            let bundle = Bundle::of(&Yarn::preset(name).expect(name));
            let table = Occlusion::new(&bundle, 1);
            assert!(table.visibility.iter().all(|v| (0.0..=1.0).contains(v)), "{name}");
            let average = radial_average(&Slices::new(&bundle));
            let at = |rho: f64| average[(rho / EXTENT * f64::from(RINGS)).round() as usize].1;
            assert!(at(0.5) < at(0.8) && at(0.8) < at(1.0) && at(1.0) < at(1.2), "{name}");
            let (mut worst, mut square) = (0.0_f64, 0.0);
            for (rho, value) in &average {
                let fitted = table.at_distance(DVec2::new(*rho, 0.0));
                assert!((0.0..=1.0).contains(&fitted), "{name}: {fitted} at {rho}");
                worst = worst.max((fitted - value).abs());
                square += (fitted - value).powi(2) / average.len() as f64;
            }
            println!("{name}: cubic {:?} within {worst:.3}, RMS {:.3}", table.cubic, square.sqrt());
            assert!(worst < 0.12 && square.sqrt() < 0.05, "{name}: {worst} {}", square.sqrt());
        }
    }

    #[test]
    fn the_fit_reproduces_a_cubic() {
        let exact = DVec4::new(0.1, -0.4, 0.7, 0.3);
        let samples: Vec<_> = (0..20).map(|k| f64::from(k) / 19.0).map(|rho| (rho, exact.dot(powers(rho)))).collect();
        assert!((fit_cubic(&samples) - exact).abs().max_element() < 1e-9);
    }

    #[test]
    fn visibility_is_that_of_rays_through_explicit_fibers() {
        for name in ["cotton-1", "rayon-4", "silk-1"] {
            let yarn = Yarn::preset(name).expect(name);
            let table = Occlusion::new(&Bundle::of(&yarn), 1);
            let (dealer, mut random) = (Sections::of(&yarn), Random::new(11));
            let radius = yarn.fiber_radius / yarn.outer_radius();
            // Table, cubic and rays, by distance.
            let mut bins = [(0.0, 0.0, 0.0); 4];
            for _ in 0..1000 {
                let fibers = dealer.draw(&mut random);
                for _ in 0..40 {
                    let q = DVec2::from_angle(TAU * random.unit()) * random.unit().sqrt();
                    let direction = DVec2::from_angle(TAU * random.unit());
                    if fibers.iter().any(|fiber| fiber.holds(q, radius)) {
                        continue;
                    }
                    let blocked = fibers.iter().any(|fiber| fiber.blocks(q, direction, radius));
                    let bin = &mut bins[(q.length() * 4.0).min(3.0) as usize];
                    *bin = (bin.0 + table.at(q), bin.1 + f64::from(u8::from(!blocked)), bin.2 + 1.0);
                }
            }
            for (visibility, seen, count) in bins {
                let (table, rays) = (visibility / count, seen / count);
                println!("{name}: {table:.3} for {rays:.3} ({count})");
                assert!((table - rays).abs() < 0.03, "{name}: {table} for {rays}");
            }
        }
    }
}
