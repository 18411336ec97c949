use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::ControlFlow;

use glam::DVec3;
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;

use super::walk::{Tally, walk};

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

    /// Cells of place and viewer.
    pub(super) fn places(&self) -> usize {
        self.rings * self.outgoing()
    }

    /// Cells in all.
    pub fn cells(&self) -> usize {
        self.light_longitudes * self.light_azimuths * self.places()
    }
}

/// Light that a yarn's fibers scatter more than once.
#[derive(Clone, Debug, PartialEq)]
pub struct Transport {
    /// Radiance of the fibers that are seen there, by light scattered at least twice in the yarn, per irradiance of a sun on a plane that faces it:
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
    /// Where light came in that is scattered more than once.
    pub entry: Entry,
}

/// Where light enters a yarn that is scattered more than once and seen from its lit side, by its distance from the plane through the yarn's axis and the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Its mean over that of the place that is seen.
    pub share: f64,
    /// Its standard deviation from there, outer radii.
    pub spread: f64,
}

impl Transport {
    /// Where the rings end, in outer radii.
    pub const REACH: f64 = 1.2;

    /// Walks the paths of about `photons` photons, backwards; `proceed` is asked after each of [`Self::batches`] whether to go on.
    ///
    /// The same yarn, material and number give the same bits on any number of threads.
    pub fn new(
        yarn: &Yarn,
        material: &Material,
        photons: u32,
        proceed: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> ControlFlow<(), Self> {
        let tally = walk(yarn, material, photons, proceed)?;
        ControlFlow::Continue(Self::from_tally(tally, TransportSize::ALL))
    }

    /// How often [`Self::new`] asks.
    pub fn batches(photons: u32) -> u32 {
        super::walk::batches(photons)
    }

    fn from_tally(mut tally: Tally, size: TransportSize) -> Self {
        let per_longitude = size.light_azimuths * size.places();
        // Of the light's directions: θ_i ≥ 0 of a longitude, at all azimuths.
        let solid_angle = |longitude| TAU * (theta(longitude + 1, size).sin() - theta(longitude, size).sin());
        for (longitude, cells) in tally.cells.chunks_exact_mut(per_longitude).enumerate() {
            cells.iter_mut().for_each(|sum| *sum *= size.light_azimuths as f64 / solid_angle(longitude));
        }
        blur_tally(&mut tally, size);
        share_with_neighbours(&mut tally, size);
        let mut radiance = Vec::with_capacity(size.cells());
        let mut ambient = vec![DVec3::ZERO; per_longitude];
        for (k, sum) in tally.cells.iter().enumerate() {
            let (longitude, within) = (k / per_longitude, k % per_longitude);
            let (azimuth, place) = (within / size.places(), within % size.places());
            let paths = tally.seen[place];
            let value = if paths > 0.0 { *sum / paths } else { DVec3::ZERO };
            radiance.push(value.as_vec3().to_array());
            // θ_i < 0 is the same, turned by half a turn about a line across the yarn.
            let (ring, outgoing) = (place / size.outgoing(), place % size.outgoing());
            let turned = ((size.light_azimuths - 1 - azimuth) * size.rings + ring + 1) * size.outgoing() - 1 - outgoing;
            ambient[within] += value * solid_angle(longitude);
            ambient[turned] += value * solid_angle(longitude);
        }
        let ambient = ambient.into_iter().map(|value| value.as_vec3().to_array()).collect();
        let side = 4.0 * PI / size.sides as f64 * tally.on_yarn;
        let sides = tally.sides.iter().map(|sum| (*sum / side).as_vec3().to_array()).collect();
        let entry = tally.entries.entry();
        Self { radiance, ambient, sides, albedo: tally.albedo(), entry }
    }
}

/// Share of a cell's light that goes to each of its two neighbours, along azimuths and along longitudes, where cones of narrow lobes are.
const AZIMUTH_BLUR: f64 = 0.25;
const LONGITUDE_BLUR: f64 = 0.125;

/// Blurs the directions of lights and viewers: a path falls into one cell of a hundred thousand, and few paths have colours far apart.
fn blur_tally(tally: &mut Tally, size: TransportSize) {
    let (azimuths, places) = (size.view_azimuths, size.places());
    blur(&mut tally.seen, azimuths, 1, AZIMUTH_BLUR, false);
    blur(&mut tally.seen, size.view_longitudes, azimuths, LONGITUDE_BLUR, false);
    blur(&mut tally.cells, azimuths, 1, AZIMUTH_BLUR, false);
    blur(&mut tally.cells, size.view_longitudes, azimuths, LONGITUDE_BLUR, false);
    blur(&mut tally.cells, size.light_azimuths, places, AZIMUTH_BLUR, true);
    blur(&mut tally.cells, size.light_longitudes, size.light_azimuths * places, LONGITUDE_BLUR, false);
}

/// Mixes each of so many cells along an axis, `stride` apart, with a share of each of its neighbours; the ends lose nothing.
fn blur<T>(values: &mut [T], cells: usize, stride: usize, share: f64, is_circle: bool)
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let mut line = Vec::with_capacity(cells);
    for block in values.chunks_exact_mut(cells * stride) {
        for first in 0..stride {
            line.clear();
            line.extend(block.iter().skip(first).step_by(stride).copied());
            for k in 0..cells {
                let (before, after) = if is_circle {
                    ((k + cells - 1) % cells, (k + 1) % cells)
                } else {
                    (k.saturating_sub(1), (k + 1).min(cells - 1))
                };
                block[first + k * stride] = line[k] * (1.0 - 2.0 * share) + (line[before] + line[after]) * share;
            }
        }
    }
}

/// Paths that tell a place's radiance, at least, by the mean over places. A viewer sees few of the inner fibers.
const LEAST_SEEN: f64 = 0.25;

/// Where few paths began, takes in those of the next ring, from the outermost inwards and back.
fn share_with_neighbours(tally: &mut Tally, size: TransportSize) {
    let (outgoing, places) = (size.outgoing(), size.places());
    let least = LEAST_SEEN * tally.seen.iter().sum::<f64>() / places as f64;
    let inwards = (0..size.rings - 1).rev().map(|ring| (ring, ring + 1));
    let outwards = (1..size.rings).map(|ring| (ring, ring - 1));
    for (to, from) in inwards.chain(outwards) {
        for k in 0..outgoing {
            let (to, from) = (to * outgoing + k, from * outgoing + k);
            if tally.seen[to] < least {
                tally.seen[to] += tally.seen[from];
                for first in (0..size.cells()).step_by(places) {
                    let more = tally.cells[first + from];
                    tally.cells[first + to] += more;
                }
            }
        }
    }
}

pub(super) fn theta(longitude: usize, size: TransportSize) -> f64 {
    FRAC_PI_2 * longitude as f64 / size.light_longitudes as f64
}

pub(super) fn ring(distance: f64, size: TransportSize) -> usize {
    ((distance / Transport::REACH * size.rings as f64) as usize).min(size.rings - 1)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use lisle_core::yarn::PRESET_NAMES;

    use super::*;
    use crate::explicit::extreme_yarns;
    use crate::{Bundle, Occlusion, SectionDensity, SelfShadow};

    const SIZE: TransportSize = TransportSize::ALL;

    /// Lambert's fibers of an albedo, which a furnace hides.
    fn lambert(albedo: f64) -> Material {
        let base = Material::preset("cotton").expect("preset");
        Material { diffuse: DVec3::splat(albedo), diffuse_weight: 1.0, ..base }
    }

    /// Fibers that reflect a share of the light, all around: what they take in is the mean over all azimuths.
    fn mirrors(albedo: f64) -> Material {
        let base = Material::preset("cotton").expect("preset");
        Material { color_r: DVec3::splat(albedo), color_tt: DVec3::ZERO, diffuse_weight: 0.0, ..base }
    }

    fn made(yarn: &Yarn, material: &Material, photons: u32) -> Transport {
        match Transport::new(yarn, material, photons, &mut || ControlFlow::Continue(())) {
            ControlFlow::Continue(transport) => transport,
            ControlFlow::Break(()) => unreachable!("nobody stopped it"),
        }
    }

    const PHOTONS: u32 = 300_000;

    /// Under an even sky, light scattered before makes up for the sky that fibers hide from a point that is seen, by tables of self-shadow and occlusion, which know nothing
    /// of the walk. (Found: 0.012 to 0.035.)
    const FURNACE_BOUND: f64 = 0.05;

    /// Of all that viewers at about a right angle see.
    fn furnace_error(yarn: &Yarn, material: &Material) -> f64 {
        let ControlFlow::Continue(tally) = walk(yarn, material, PHOTONS, &mut || ControlFlow::Continue(())) else {
            unreachable!("nobody stopped it")
        };
        let transport = Transport::from_tally(tally.clone(), SIZE);
        let bundle = Bundle::of(yarn);
        let occlusion = Occlusion::new(&bundle, 1);
        let self_shadow = SelfShadow::new(&bundle, &SectionDensity::new(yarn), 1);
        let (mut sum, mut weights) = (0.0, 0.0);
        for cell in 0..SIZE.places() {
            let (ring, longitude) = (cell / SIZE.outgoing(), cell / SIZE.view_azimuths % SIZE.view_longitudes);
            if longitude.abs_diff(SIZE.view_longitudes / 2) > 1 {
                continue;
            }
            let before = |azimuth: usize| f64::from(transport.ambient[azimuth * SIZE.places() + cell][0]);
            let before = (0..SIZE.light_azimuths).map(before).sum::<f64>() / SIZE.light_azimuths as f64;
            let distance = (ring as f64 + 0.5) / SIZE.rings as f64 * Transport::REACH;
            let view = PI * (((cell % SIZE.view_azimuths) as f64 + 0.5) / SIZE.view_azimuths as f64 - 0.5);
            let open = |k: u32| {
                let azimuth = TAU * f64::from(k) / 64.0;
                let q = DVec2::from_angle(azimuth) * distance;
                (occlusion.at(q) + self_shadow.sky_of_seen(azimuth + view, q)).min(1.0)
            };
            let open = (0..64).map(open).sum::<f64>() / 64.0;
            sum += tally.seen[cell] * (before + open - 1.0);
            weights += tally.seen[cell];
        }
        sum / weights
    }

    #[test]
    fn white_fibers_disappear_in_a_furnace() {
        for name in PRESET_NAMES {
            let yarn = Yarn::preset(name).expect(name);
            let error = furnace_error(&yarn, &mirrors(1.0));
            println!("{name}: {error:.4}");
            assert!(error.abs() < FURNACE_BOUND, "{name}: {error}");
        }
    }

    #[test]
    fn fibers_that_absorb_a_tenth_are_rejected_by_the_same_check() {
        let yarn = Yarn::preset("cotton-1").expect("preset");
        assert!(furnace_error(&yarn, &mirrors(0.9)) < -FURNACE_BOUND);
    }

    #[test]
    fn a_yarn_gives_back_all_light_or_what_its_fibers_leave_of_it() {
        let yarn = Yarn::preset("silk-1").expect("preset");
        let white = made(&yarn, &lambert(1.0), PHOTONS);
        // Paths are weighted where fibers overlap, which their energy shows.
        assert!((white.albedo.x - 1.0).abs() < 0.03, "{}", white.albedo);
        let black = made(&yarn, &lambert(0.0), PHOTONS);
        assert!(black.radiance.iter().flatten().all(|x| *x == 0.0));
        assert!(black.albedo.x > 0.0 && black.albedo.x < 0.3, "light between the fibers: {}", black.albedo);
        let gray = made(&yarn, &lambert(0.5), PHOTONS);
        assert!(gray.albedo.x > black.albedo.x && gray.albedo.x < white.albedo.x);
    }

    #[test]
    fn blurred_cells_keep_their_sum_and_meet_around_a_circle() {
        let mut line = [0.0; 12];
        line[2] = 1.0;
        let mut circle = line;
        blur(&mut line, 3, 4, 0.25, false);
        blur(&mut circle, 3, 4, 0.25, true);
        assert_eq!([line[2], line[6], line[10]], [0.75, 0.25, 0.0]);
        assert_eq!([circle[2], circle[6], circle[10]], [0.5, 0.25, 0.25]);
        assert_eq!([line.iter().sum::<f64>(), circle.iter().sum::<f64>()], [1.0, 1.0]);
    }

    #[test]
    fn light_comes_in_nearer_to_the_middle_the_more_often_it_is_scattered() {
        let yarn = Yarn::preset("cotton-1").expect("preset");
        let entry = |albedo| made(&yarn, &mirrors(albedo), 20_000).entry;
        let (dark, white) = (entry(0.2), entry(1.0));
        println!("{dark:?} {white:?}");
        assert!(0.0 < white.share && white.share + 0.05 < dark.share && dark.share < 1.1);
        assert!(0.1 < dark.spread && dark.spread + 0.05 < white.spread && white.spread < 0.6);
    }

    #[test]
    fn the_lit_side_is_the_brighter_one() {
        let yarn = Yarn::preset("cotton-1").expect("preset");
        let transport = made(&yarn, &lambert(0.95), PHOTONS);
        let side = |azimuth: usize| -> f32 {
            let first = (azimuth * SIZE.rings + SIZE.rings - 2) * SIZE.outgoing();
            transport.ambient[first..first + SIZE.outgoing()].iter().map(|c| c[0]).sum()
        };
        assert!(side(SIZE.light_azimuths / 2) > 3.0 * side(0), "{} {}", side(SIZE.light_azimuths / 2), side(0));
        assert!(transport.sides[SIZE.sides - 1][0] > 2.0 * transport.sides[0][0]);
    }

    #[test]
    fn tables_are_deterministic_on_any_number_of_threads() {
        let (yarn, material) = (Yarn::preset("rayon-1").expect("preset"), Material::preset("silk").expect("preset"));
        let table = || made(&yarn, &material, 20_000);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("pool").install(table);
        assert_eq!(table(), one);
    }

    #[test]
    fn a_walk_stops_when_it_is_told_to() {
        let (yarn, material) = (Yarn::preset("rayon-1").expect("preset"), Material::preset("silk").expect("preset"));
        let mut asked = 0;
        let stopped = Transport::new(&yarn, &material, 1_000_000, &mut || {
            asked += 1;
            if asked == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(stopped.is_break());
        assert_eq!(asked, 2);
        assert!(Transport::batches(1_000_000) > 2);
    }

    #[test]
    fn extreme_yarns_give_finite_tables() {
        for yarn in extreme_yarns() {
            let t = made(&yarn, &Material::preset("cotton").expect("preset"), 20_000);
            let values = t.radiance.iter().chain(&t.ambient).chain(&t.sides).flatten();
            assert!(values.clone().all(|x| x.is_finite() && *x >= 0.0), "{yarn:?}");
            assert!(t.albedo.is_finite() && t.entry.share.is_finite() && t.entry.spread.is_finite());
        }
    }
}
