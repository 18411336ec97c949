use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::ControlFlow;

use glam::{DVec2, DVec3};
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;

use super::medium::Medium;
use super::walk::{Tally, walk};
use crate::SectionDensity;

/// Light scattered once is shaded without a table.
const FIRST_ORDER: u32 = 2;

/// Cells of a [`Transport`] along each of its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransportSize {
    /// Distance from the yarn's centre: even steps over [0, [`Transport::REACH`]]; the last one goes on.
    pub rings: usize,
    /// Azimuth of the light from that of the point: even steps over a turn from −π.
    pub light_azimuths: usize,
    /// θ_i: even steps over [0, π/2].
    pub light_longitudes: usize,
    /// sin θ_i + sin θ_o: even steps over [−1, 2], for θ_i ≥ 0. It is 0 where fibers along the yarn reflect, whatever θ_i: highlights stay sharp in few steps.
    pub cones: usize,
    /// Azimuth of the viewer from that of the light: even steps over a turn from −π.
    pub turns: usize,
    /// sin θ_o, under light from all directions: even steps over [−1, 1].
    pub view_longitudes: usize,
    /// Azimuth of the viewer from that of the point, under light from all directions: even steps over [−π/2, π/2].
    pub view_azimuths: usize,
    /// Cosine of the angle between the ways to light and viewer: even steps over [−1, 1].
    pub sides: usize,
}

impl TransportSize {
    /// Of every table.
    pub const ALL: Self = Self {
        rings: 6,
        light_azimuths: 16,
        light_longitudes: 6,
        cones: 20,
        turns: 24,
        view_longitudes: 12,
        view_azimuths: 8,
        sides: 16,
    };

    /// Cells of [`Transport::radiance`].
    pub fn cells(&self) -> usize {
        self.light_longitudes * self.light_azimuths * self.rings * self.cones * self.turns
    }

    /// Cells of [`Transport::ambient`].
    pub fn ambient_cells(&self) -> usize {
        self.light_azimuths * self.rings * self.view_longitudes * self.view_azimuths
    }
}

/// Light that a yarn's fibers scatter more than once.
#[derive(Clone, Debug, PartialEq)]
pub struct Transport {
    /// Radiance of the fibers there that are seen, by light scattered at least twice in the yarn, per irradiance of a sun on a plane that faces it:
    /// `[light longitude][light azimuth][ring][cone][turn]`, 1/sr.
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
    /// Mean cosine between that and the straight way, of what has met fibers, in (0, 1).
    pub through_cosine: f64,
}

impl Transport {
    /// Where the rings end, in outer radii.
    pub const REACH: f64 = 1.2;

    /// Walks about `photons` photons; `proceed` is asked after each of [`Self::batches`] whether to go on.
    ///
    /// The same yarn, material and number give the same bits on any number of threads.
    pub fn new(
        yarn: &Yarn,
        material: &Material,
        photons: u32,
        proceed: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> ControlFlow<(), Self> {
        let medium = Medium::new(SectionDensity::new(yarn));
        let tally = walk(&medium, material, photons, FIRST_ORDER, proceed)?;
        ControlFlow::Continue(Self::from_tally(&medium, &tally, TransportSize::ALL))
    }

    /// How often [`Self::new`] asks.
    pub fn batches(photons: u32) -> u32 {
        super::walk::batches(photons)
    }

    fn from_tally(medium: &Medium, tally: &Tally, size: TransportSize) -> Self {
        let seen = Seen::new(medium, size);
        let cones = Cones::new(size);
        let directions = size.turns as f64 / TAU;
        let mut radiance = Vec::with_capacity(size.cells());
        for longitude in 0..size.light_longitudes {
            for light in 0..size.light_azimuths {
                let areas = seen.by_turn(light);
                for ring in 0..size.rings {
                    for cone in 0..size.cones {
                        let cone = cones.nearest(longitude, cone);
                        radiance.extend((0..size.turns).map(|turn| {
                            let ring = areas.nearest(ring, turn);
                            let row = (longitude * size.light_azimuths + light) * size.rings + ring;
                            let sum = tally.cells[(row * size.cones + cone) * size.turns + turn];
                            let scale = directions * areas.over(ring, turn) / cones.width(longitude, cone);
                            (sum * scale).as_vec3().to_array()
                        }));
                    }
                }
            }
        }
        let areas = seen.by_view();
        let per_ring = size.view_longitudes * size.view_azimuths;
        let directions = (size.view_azimuths * size.view_longitudes) as f64 / TAU;
        let ambient = (0..size.ambient_cells()).map(|cell| {
            let (row, view) = (cell / per_ring, cell % size.view_azimuths);
            let ring = areas.nearest(row % size.rings, view);
            let cell = (row / size.rings * size.rings + ring) * per_ring + cell % per_ring;
            // θ_i < 0 is the same, turned by half a turn about a line across the yarn.
            let both = tally.ambient[cell] + tally.ambient[turned_cell(cell, size)];
            (both * (directions * areas.over(ring, view))).as_vec3().to_array()
        });
        let side = 4.0 * PI / size.sides as f64;
        let sides = tally.sides.iter().map(|sum| (*sum / side).as_vec3().to_array()).collect();
        let balance = tally.balance();
        Self {
            radiance,
            ambient: ambient.collect(),
            sides,
            albedo: balance.left / balance.entered,
            through: balance.through / balance.entered,
            through_cosine: balance.spread_cos / balance.spread.max(f64::MIN_POSITIVE),
        }
    }
}

/// How much of the directions the cells of [`TransportSize::cones`] have.
struct Cones {
    size: TransportSize,
    /// Width in sin θ_o, mean over θ_i: `[light longitude][cone]`.
    widths: Vec<f64>,
}

impl Cones {
    fn new(size: TransportSize) -> Self {
        const STEPS: u32 = 64;
        let step = 3.0 / size.cones as f64;
        let widths = (0..size.light_longitudes * size.cones).map(|cell| {
            let (longitude, cone) = (cell / size.cones, cell % size.cones);
            let (from, to) = (theta(longitude, size), theta(longitude + 1, size));
            let first = -1.0 + step * cone as f64;
            let width = |k: u32| {
                let sin_theta_i = (from + (to - from) * (f64::from(k) + 0.5) / f64::from(STEPS)).sin();
                ((first + step - sin_theta_i).min(1.0) - (first - sin_theta_i).max(-1.0)).max(0.0)
            };
            (0..STEPS).map(width).sum::<f64>() / f64::from(STEPS)
        });
        Self { size, widths: widths.collect() }
    }

    fn width(&self, longitude: usize, cone: usize) -> f64 {
        self.widths[longitude * self.size.cones + cone]
    }

    /// The nearest cone of which at least half has directions: what is beyond would be mostly noise.
    fn nearest(&self, longitude: usize, cone: usize) -> usize {
        let is_wide = |cone: &usize| self.width(longitude, *cone) >= 1.5 / self.size.cones as f64;
        (0..self.size.cones).filter(is_wide).min_by_key(|wide| wide.abs_diff(cone)).expect("sin θ_o has a range of 2")
    }
}

/// The cell of [`Transport::ambient`] that another becomes by half a turn about a line across the yarn through its points.
fn turned_cell(cell: usize, size: TransportSize) -> usize {
    let per_ring = size.view_longitudes * size.view_azimuths;
    let per_azimuth = size.rings * per_ring;
    let (azimuth, ring, outgoing) = (cell / per_azimuth, cell / per_ring % size.rings, cell % per_ring);
    ((size.light_azimuths - 1 - azimuth) * size.rings + ring) * per_ring + (per_ring - 1 - outgoing)
}

pub(super) fn theta(longitude: usize, size: TransportSize) -> f64 {
    FRAC_PI_2 * longitude as f64 / size.light_longitudes as f64
}

/// Area that the fibers of a ring show to a viewer, per length of the yarn.
struct Seen {
    size: TransportSize,
    /// By the viewer's azimuth from that of the fibers: `[ring][`[`Seen::AZIMUTHS`]`]`.
    areas: Vec<f64>,
}

impl Seen {
    const AZIMUTHS: usize = 48;

    fn new(medium: &Medium, size: TransportSize) -> Self {
        /// Across the section, and viewers about each of its places.
        const STEPS: usize = 120;
        let cell = 2.0 * medium.reach() / STEPS as f64;
        let mut areas = vec![0.0; size.rings * Self::AZIMUTHS];
        for k in 0..STEPS * STEPS {
            let at = |i: usize| (i as f64 + 0.5) * cell - medium.reach();
            let q = DVec2::new(at(k % STEPS), at(k / STEPS));
            let area = medium.length_density(q) * cell * cell * medium.diameter();
            if area > 0.0 {
                let row = &mut areas[ring(q.length(), size) * Self::AZIMUTHS..][..Self::AZIMUTHS];
                for (azimuth, sum) in row.iter_mut().enumerate() {
                    let view = TAU * (azimuth as f64 + 0.5) / Self::AZIMUTHS as f64;
                    *sum += area * medium.seen(q, DVec2::from_angle(q.to_angle() + view));
                }
            }
        }
        Self { size, areas }
    }

    /// Mean over some azimuths, given in turns.
    fn mean(&self, ring: usize, turns: impl Iterator<Item = f64> + Clone) -> f64 {
        let azimuth = |turn: f64| (turn.rem_euclid(1.0) * Self::AZIMUTHS as f64) as usize % Self::AZIMUTHS;
        let row = &self.areas[ring * Self::AZIMUTHS..][..Self::AZIMUTHS];
        turns.clone().map(|turn| row[azimuth(turn)]).sum::<f64>() / turns.count() as f64
    }

    /// Of the cells of [`Transport::radiance`] with that azimuth of the light: `[ring][turn]`.
    fn by_turn(&self, light: usize) -> SeenAreas {
        const STEPS: u32 = 4;
        let size = self.size;
        let within = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
        // Lights' azimuths and turns both begin at half a turn.
        let azimuth = |turn: usize, a: u32, b: u32| {
            (light as f64 + within(a)) / size.light_azimuths as f64 + (turn as f64 + within(b)) / size.turns as f64
        };
        let share = 1.0 / size.light_azimuths as f64;
        let areas = (0..size.rings * size.turns).map(|cell| {
            let turns = (0..STEPS * STEPS).map(|k| azimuth(cell % size.turns, k % STEPS, k / STEPS));
            share * self.mean(cell / size.turns, turns)
        });
        SeenAreas { directions: size.turns, areas: areas.collect(), rings: size.rings }
    }

    /// Of the cells of [`Transport::ambient`]: `[ring][view azimuth]`.
    fn by_view(&self) -> SeenAreas {
        const STEPS: u32 = 16;
        let size = self.size;
        let share = 1.0 / size.light_azimuths as f64;
        let areas = (0..size.rings * size.view_azimuths).map(|cell| {
            let turns = (0..STEPS).map(|k| {
                let place = (cell % size.view_azimuths) as f64 + (f64::from(k) + 0.5) / f64::from(STEPS);
                0.5 * place / size.view_azimuths as f64 - 0.25
            });
            share * self.mean(cell / size.view_azimuths, turns)
        });
        SeenAreas { directions: size.view_azimuths, areas: areas.collect(), rings: size.rings }
    }
}

/// Area of the fibers of a ring that is seen from a direction.
struct SeenAreas {
    rings: usize,
    directions: usize,
    areas: Vec<f64>,
}

impl SeenAreas {
    fn at(&self, ring: usize, direction: usize) -> f64 {
        self.areas[ring * self.directions + direction]
    }

    /// 1 over that, or 0 where nothing is seen.
    fn over(&self, ring: usize, direction: usize) -> f64 {
        let area = self.at(ring, direction);
        if area > 0.0 { 1.0 / area } else { 0.0 }
    }

    /// That ring or the next one outwards of which enough is seen: what is hardly ever seen would be mostly noise.
    fn nearest(&self, ring: usize, direction: usize) -> usize {
        let most = (0..self.rings).map(|ring| self.at(ring, direction)).fold(0.0, f64::max);
        (ring..self.rings).find(|ring| self.at(*ring, direction) > 0.03 * most).unwrap_or(ring)
    }
}

pub(super) fn ring(distance: f64, size: TransportSize) -> usize {
    ((distance / Transport::REACH * size.rings as f64) as usize).min(size.rings - 1)
}

#[cfg(test)]
mod tests {
    use lisle_core::yarn::PRESET_NAMES;

    use super::*;
    use crate::explicit::extreme_yarns;

    const SIZE: TransportSize = TransportSize::ALL;

    /// Of light from all directions.
    const OUTGOING: usize = SIZE.view_longitudes * SIZE.view_azimuths;

    /// Lambert's fibers of an albedo, which a furnace hides.
    fn lambert(albedo: f64) -> Material {
        let base = Material::preset("cotton").expect("preset");
        Material { diffuse: DVec3::splat(albedo), diffuse_weight: 1.0, ..base }
    }

    fn made(yarn: &Yarn, material: &Material, photons: u32) -> Transport {
        match Transport::new(yarn, material, photons, &mut || ControlFlow::Continue(())) {
            ControlFlow::Continue(transport) => transport,
            ControlFlow::Break(()) => unreachable!("nobody stopped it"),
        }
    }

    const PHOTONS: u32 = 300_000;

    /// Radiance of the fibers that are seen under a sky of radiance 1, by all orders, mean over all that is seen of a yarn: of white fibers 1.
    fn seen_in_a_furnace(yarn: &Yarn, material: &Material) -> f64 {
        let medium = Medium::new(SectionDensity::new(yarn));
        let tally = walk(&medium, material, PHOTONS, 1, &mut || ControlFlow::Continue(()));
        let ControlFlow::Continue(tally) = tally else { unreachable!("nobody stopped it") };
        let transport = Transport::from_tally(&medium, &tally, SIZE);
        let areas = Seen::new(&medium, SIZE).by_view();
        let (mut sum, mut weight) = (0.0, 0.0);
        for (k, radiance) in transport.ambient.iter().enumerate() {
            let area = areas.at(k / OUTGOING % SIZE.rings, k % SIZE.view_azimuths);
            sum += area * f64::from(radiance[0]);
            weight += area;
        }
        sum / weight
    }

    const FURNACE_BOUND: f64 = 0.04;

    fn furnace_error(yarn: &Yarn, material: &Material) -> f64 {
        (seen_in_a_furnace(yarn, material) - 1.0).abs()
    }

    #[test]
    fn white_fibers_disappear_in_a_furnace() {
        for name in PRESET_NAMES {
            let yarn = Yarn::preset(name).expect(name);
            let error = furnace_error(&yarn, &lambert(1.0));
            println!("{name}: {error:.4}");
            assert!(error < FURNACE_BOUND, "{name}: {error}");
        }
    }

    #[test]
    fn fibers_that_absorb_a_tenth_are_rejected_by_the_same_check() {
        let yarn = Yarn::preset("cotton-1").expect("preset");
        assert!(furnace_error(&yarn, &lambert(0.9)) > FURNACE_BOUND);
    }

    #[test]
    fn a_yarn_gives_back_all_light_or_what_its_fibers_leave_of_it() {
        let yarn = Yarn::preset("silk-1").expect("preset");
        let white = made(&yarn, &lambert(1.0), PHOTONS);
        assert!((white.albedo.x - 1.0).abs() < 0.01, "{}", white.albedo);
        let black = made(&yarn, &lambert(0.0), PHOTONS);
        assert!(black.radiance.iter().flatten().all(|x| *x == 0.0));
        assert!(black.albedo.x > 0.0 && black.albedo.x < 0.3, "light between the fibers: {}", black.albedo);
        assert!((black.albedo - black.through).abs().max_element() < 1e-12);
        let gray = made(&yarn, &lambert(0.5), PHOTONS);
        assert!(gray.albedo.x > black.albedo.x && gray.albedo.x < white.albedo.x);
    }

    /// Of light from each inclination, what leaves a yarn.
    fn albedos(yarn: &Yarn, material: &Material) -> Vec<f64> {
        let tally = walk(&Medium::new(SectionDensity::new(yarn)), material, PHOTONS, FIRST_ORDER, &mut || {
            ControlFlow::Continue(())
        });
        let ControlFlow::Continue(tally) = tally else { unreachable!("nobody stopped it") };
        tally.balances.iter().map(|balance| balance.left.x / balance.entered).collect()
    }

    #[test]
    fn white_fibers_keep_all_light_from_each_inclination() {
        for name in PRESET_NAMES {
            let found = albedos(&Yarn::preset(name).expect(name), &lambert(1.0));
            println!("{name}: {found:.4?}");
            assert!(found.iter().all(|albedo| (albedo - 1.0).abs() < 0.01), "{name}: {found:?}");
        }
    }

    #[test]
    fn the_lit_side_is_the_brighter_one() {
        let yarn = Yarn::preset("cotton-1").expect("preset");
        let transport = made(&yarn, &lambert(0.95), PHOTONS);
        let side = |azimuth: usize| -> f32 {
            let first = (azimuth * SIZE.rings + SIZE.rings - 2) * OUTGOING;
            transport.ambient[first..first + OUTGOING].iter().map(|c| c[0]).sum()
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
            assert!(t.albedo.is_finite() && t.through.is_finite());
        }
    }
}
