use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;

use super::medium::Medium;
use super::walk::{Tally, walk};
use crate::SectionDensity;

/// Cells of a [`Transport`] along each of its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransportSize {
    /// Distance from the yarn's centre: even steps over [0, [`Transport::REACH`]]; the last one goes on.
    pub rings: usize,
    /// Azimuth of the light from that of the point: even steps over a turn from −π.
    pub light_azimuths: usize,
    /// θ_i: even steps over [0, π/2].
    pub light_longitudes: usize,
    /// sin θ_o: even steps over [−1, 1].
    pub view_longitudes: usize,
    /// Azimuth of the viewer from that of the point: even steps over [−π/2, π/2].
    pub view_azimuths: usize,
    /// Cosine of the angle between the ways to light and viewer: even steps over [−1, 1].
    pub sides: usize,
}

impl TransportSize {
    /// Of every table.
    pub const ALL: Self =
        Self { rings: 6, light_azimuths: 24, light_longitudes: 8, view_longitudes: 12, view_azimuths: 8, sides: 16 };

    pub(super) fn outgoing(&self) -> usize {
        self.view_longitudes * self.view_azimuths
    }

    /// Cells in all.
    pub fn cells(&self) -> usize {
        self.light_longitudes * self.light_azimuths * self.rings * self.outgoing()
    }
}

/// Light that a yarn's fibers scatter more than once.
#[derive(Clone, Debug, PartialEq)]
pub struct Transport {
    /// Radiance of the fibers there, by light scattered at least twice in the yarn, per irradiance of a sun on a plane that faces it:
    /// `[light longitude][light azimuth][ring][view longitude][view azimuth]`, 1/sr.
    pub radiance: Vec<[f32; 3]>,
    /// The same under radiance 1 from all directions, if all of them had this azimuth: `[light azimuth][ring][view longitude][view azimuth]`.
    /// The mean over azimuths is the radiance under an even sky.
    pub ambient: Vec<[f32; 3]>,
    /// Radiance of the yarn as a whole, mean over its width, by all orders, per irradiance of a sun on a plane that faces it; mean over the yarn's
    /// directions in space: `[side]`, 1/sr.
    pub sides: Vec<[f32; 3]>,
    /// Share of the light on the yarn, from all directions, that leaves it again, and that goes on through it.
    pub albedo: DVec3,
    /// Of the albedo, what leaves on the side away from the light.
    pub through: DVec3,
}

impl Transport {
    /// Where the rings end, in outer radii.
    pub const REACH: f64 = 1.2;

    /// Walks `photons` photons in all; the same yarn, material and number give the same bits on any number of threads.
    pub fn new(yarn: &Yarn, material: &Material, photons: u32) -> Self {
        let size = TransportSize::ALL;
        let medium = Medium::new(SectionDensity::new(yarn));
        let tally = walk(&medium, material, photons);
        Self::from_tally(&medium, &tally, size)
    }

    fn from_tally(medium: &Medium, tally: &Tally, size: TransportSize) -> Self {
        let lengths = ring_lengths(medium, size);
        let solid_angle = (2.0 / size.view_longitudes as f64) * (PI / size.view_azimuths as f64);
        let per_ring = size.outgoing();
        let per_longitude = size.light_azimuths * size.rings * per_ring;
        let mut radiance = Vec::with_capacity(size.cells());
        let mut ambient = vec![DVec3::ZERO; per_longitude];
        for (k, sum) in tally.cells.iter().enumerate() {
            let ring = k / per_ring % size.rings;
            let fibers = lengths[ring] / size.light_azimuths as f64 * medium.diameter();
            let value = if fibers > 0.0 { *sum / (fibers * solid_angle) } else { DVec3::ZERO };
            radiance.push(value.as_vec3().to_array());
            let longitude = k / per_longitude;
            let light = 2.0 * PI * (theta(longitude + 1, size).sin() - theta(longitude, size).sin());
            // θ_i < 0 is the same, turned by half a turn about a line across the yarn.
            let within = k % per_longitude;
            let (azimuth, rest) = (within / (size.rings * per_ring), within % (size.rings * per_ring));
            let (ring, outgoing) = (rest / per_ring, rest % per_ring);
            let turned_azimuth = size.light_azimuths - 1 - azimuth;
            let turned = (turned_azimuth * size.rings + ring) * per_ring + (per_ring - 1 - outgoing);
            ambient[within] += value * light;
            ambient[turned] += value * light;
        }
        let ambient = ambient.into_iter().map(|value| value.as_vec3().to_array()).collect();
        let side = 4.0 * PI / size.sides as f64;
        let sides = tally.sides.iter().map(|sum| (*sum / side).as_vec3().to_array()).collect();
        Self { radiance, ambient, sides, albedo: tally.albedo(), through: tally.through() }
    }
}

pub(super) fn theta(longitude: usize, size: TransportSize) -> f64 {
    FRAC_PI_2 * longitude as f64 / size.light_longitudes as f64
}

/// Length of fibers in each ring per length of the yarn, times the ring's area.
fn ring_lengths(medium: &Medium, size: TransportSize) -> Vec<f64> {
    const STEPS: u32 = 400;
    let cell = 2.0 * medium.reach() / f64::from(STEPS);
    let mut lengths = vec![0.0; size.rings];
    for k in 0..STEPS * STEPS {
        let at = |i: u32| (f64::from(i) + 0.5) * cell - medium.reach();
        let q = glam::DVec2::new(at(k % STEPS), at(k / STEPS));
        lengths[ring(q.length(), size)] += medium.length_density(q) * cell * cell;
    }
    lengths
}

pub(super) fn ring(distance: f64, size: TransportSize) -> usize {
    ((distance / Transport::REACH * size.rings as f64) as usize).min(size.rings - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lisle_core::yarn::PRESET_NAMES;

    #[test]
    fn furnace() {
        use crate::Occlusion;
        for name in PRESET_NAMES {
            let yarn = Yarn::preset(name).expect("preset");
            let white =
                Material { diffuse: DVec3::ONE, diffuse_weight: 1.0, ..Material::preset("cotton").expect("preset") };
            let t = Transport::new(&yarn, &white, 200_000);
            let occlusion = Occlusion::new(&SectionDensity::new(&yarn));
            for ring in 0..6 {
                let mut sum = 0.0;
                for az in 0..24 {
                    for k in 0..48 {
                        sum += f64::from(t.ambient[(az * 6 + ring) * 48 + k][0]) / 12.0 / 48.0;
                    }
                }
                let r = (ring as f64 + 0.5) * 0.2;
                let open: f64 = (0..64)
                    .map(|k| occlusion.at(glam::DVec2::from_angle(std::f64::consts::TAU * k as f64 / 64.0) * r))
                    .sum::<f64>()
                    / 64.0;
                println!("{name} ring {ring}: ms {sum:.3} open {open:.3} sum {:.3}", sum + open);
            }
        }
    }
}
