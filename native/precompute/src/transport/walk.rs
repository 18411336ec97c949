//! Photons of a sun on a yarn, followed until they leave it.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use glam::{DVec2, DVec3};
use lisle_core::sampling::Random;
use lisle_core::scattering::{FiberFrame, Material, PhotonScattering};
use rayon::prelude::*;

use super::medium::{Collision, Medium};
use super::table::{TransportSize, ring, theta};

/// Photons are walked in this many streams, summed in order.
const STREAMS: u32 = 16;

/// A photon this weak is ended by Russian roulette.
const LEAST_POWER: f64 = 0.05;

/// Light within this much of a fiber's direction is left out, where radiance per power goes to infinity.
const LEAST_COS: f64 = 0.02;

/// Sums over photons whose power is the irradiance's on the yarn.
pub(super) struct Tally {
    /// Power that leaves fibers and the yarn over the cosine of its inclination: [`super::Transport::radiance`] before it is divided by the fibers of
    /// a cell that are seen from there.
    pub cells: Vec<DVec3>,
    /// The same for [`super::Transport::ambient`], of suns with θ_i ≥ 0.
    pub ambient: Vec<DVec3>,
    /// Power that leaves the yarn by the cosine of its turn, over the yarn's width seen from there.
    pub sides: Vec<DVec3>,
    /// Of suns of a θ_i.
    pub balances: Vec<Balance>,
}

/// Light on a yarn and what becomes of it; that of an inclination has the share of a sky's light that it is.
#[derive(Clone, Copy, Default)]
pub(super) struct Balance {
    pub entered: f64,
    pub left: DVec3,
    /// Of that, what leaves away from the light.
    pub through: DVec3,
    /// Of what leaves away from the light after having met fibers: sum of the channels, and that times the cosine to the straight way.
    pub spread: f64,
    pub spread_cos: f64,
}

impl std::ops::AddAssign for Balance {
    fn add_assign(&mut self, other: Self) {
        self.entered += other.entered;
        self.left += other.left;
        self.through += other.through;
        self.spread += other.spread;
        self.spread_cos += other.spread_cos;
    }
}

impl Tally {
    fn new() -> Self {
        let size = TransportSize::ALL;
        Self {
            cells: vec![DVec3::ZERO; size.cells()],
            ambient: vec![DVec3::ZERO; size.ambient_cells()],
            sides: vec![DVec3::ZERO; size.sides],
            balances: vec![Balance::default(); size.light_longitudes],
        }
    }

    fn add(mut self, other: &Self) -> Self {
        self.cells.iter_mut().zip(&other.cells).for_each(|(a, b)| *a += *b);
        self.ambient.iter_mut().zip(&other.ambient).for_each(|(a, b)| *a += *b);
        self.sides.iter_mut().zip(&other.sides).for_each(|(a, b)| *a += *b);
        self.balances.iter_mut().zip(&other.balances).for_each(|(a, b)| *a += *b);
        self
    }

    /// Under light from all directions.
    pub fn balance(&self) -> Balance {
        self.balances.iter().fold(Balance::default(), |mut sum, balance| {
            sum += *balance;
            sum
        })
    }
}

/// Photons of a batch, after which a walk may be stopped: some hundredths of a second.
const BATCH: u32 = 20_000;

/// Batches of a walk.
pub(super) fn batches(photons: u32) -> u32 {
    photons.div_ceil(BATCH)
}

/// Walks about `photons` photons; `proceed` is asked after each batch. Light counts in the tables from that order on, 1 for light scattered once.
pub(super) fn walk(
    medium: &Medium,
    material: &Material,
    photons: u32,
    first_order: u32,
    proceed: &mut dyn FnMut() -> ControlFlow<()>,
) -> ControlFlow<(), Tally> {
    let scattering = PhotonScattering::new(material);
    let longitudes = TransportSize::ALL.light_longitudes;
    let batches = batches(photons);
    let each = photons.div_ceil(batches * STREAMS * longitudes as u32);
    let share = 1.0 / f64::from(each * STREAMS * batches);
    let mut streams: Vec<_> = (0..STREAMS)
        .map(|stream| {
            let randoms: Vec<_> = (0..longitudes).map(|k| Random::new(0x7a15, k as u64, stream)).collect();
            (Tally::new(), randoms)
        })
        .collect();
    for _ in 0..batches {
        streams.par_iter_mut().for_each(|(tally, randoms)| {
            for (longitude, random) in randoms.iter_mut().enumerate() {
                for _ in 0..each {
                    follow(medium, &scattering, longitude, share, first_order, random, tally);
                }
            }
        });
        proceed()?;
    }
    ControlFlow::Continue(streams.iter().fold(Tally::new(), |sum, (tally, _)| sum.add(tally)))
}

fn follow(
    medium: &Medium,
    scattering: &PhotonScattering,
    longitude: usize,
    share: f64,
    first_order: u32,
    random: &mut Random,
    tally: &mut Tally,
) {
    let size = TransportSize::ALL;
    let (from, to) = (theta(longitude, size), theta(longitude + 1, size));
    let theta_i = from + (to - from) * random.unit();
    let azimuth = TAU * random.unit();
    let toward_light = DVec2::from_angle(azimuth);
    let reach = medium.reach();
    let beside = reach * (2.0 * random.unit() - 1.0);
    let mut q = toward_light * (reach * reach - beside * beside).sqrt() * (1.0 - 1e-9) + toward_light.perp() * beside;
    let mut direction = (-toward_light * theta_i.cos()).extend(-theta_i.sin());
    // Light from all directions in space: those of a cell of θ_i share cos θ_i dθ_i.
    let suns = theta_i.cos() * (to - from);
    // Per unit length of the yarn, at irradiance 1 on a plane that faces the light.
    let mut power = DVec3::splat(2.0 * reach * theta_i.cos() * share);
    let on_yarn = beside.abs() < 1.0;
    if on_yarn {
        tally.balances[longitude].entered += power.x * suns;
    }
    let first_power = power.x;
    let (mut scatterings, mut came) = (0, None);
    loop {
        let (weight, collision) = medium.next(q, direction, came.as_ref(), random);
        power *= weight;
        let Some(Collision { q: met, tangent }) = collision else { break };
        let frame = FiberFrame::new(tangent, tangent.any_orthonormal_vector());
        let way = medium.way((scatterings > 0).then_some(q), met, direction);
        let (wo, left) = scattering.scatter(frame.local_from_world(-direction), power, random);
        (q, direction, power) = (met, frame.world_from_local(wo), left);
        scatterings += 1;
        if scatterings >= first_order {
            let cos = wo.truncate().length();
            if cos > LEAST_COS {
                let (place, radiance) = (
                    Place::new(q, direction, azimuth),
                    power * (medium.seen_after(q, direction.truncate(), &way) / cos),
                );
                tally.cells[place.cell(longitude, theta_i.sin() + direction.z)] += radiance;
                if let Some(cell) = place.ambient_cell(direction.z) {
                    tally.ambient[cell] += radiance * (TAU * suns);
                }
            }
        }
        came = Some(way);
        let most = power.max_element() / first_power;
        if most < LEAST_POWER {
            if random.unit() * LEAST_POWER >= most {
                return;
            }
            power *= LEAST_POWER / most;
        }
    }
    if on_yarn {
        let toward_light = toward_light.extend(theta_i.tan()).normalize();
        let cos = direction.truncate().length();
        let turn = direction.dot(toward_light);
        if scatterings > 0 && cos > LEAST_COS {
            let side = (0.5 * turn + 0.5) * size.sides as f64;
            tally.sides[(side as usize).min(size.sides - 1)] += power * (suns / (2.0 * cos));
        }
        let left = power * suns;
        let is_through = turn < 0.0;
        let spread = if is_through && scatterings > 0 { left.element_sum() } else { 0.0 };
        let through = if is_through { left } else { DVec3::ZERO };
        tally.balances[longitude] += Balance { entered: 0.0, left, through, spread, spread_cos: -turn * spread };
    }
}

/// Where in the tables light leaves a fiber.
struct Place {
    light_azimuth: usize,
    ring: usize,
    turn: usize,
    /// Azimuth from that of the point, radians in [−π, π).
    view_azimuth_rad: f64,
}

impl Place {
    fn new(q: DVec2, direction: DVec3, light_azimuth_rad: f64) -> Self {
        let size = TransportSize::ALL;
        let azimuth = q.y.atan2(q.x);
        let view = direction.y.atan2(direction.x);
        let turn = |angle: f64| (angle / TAU + 0.5).rem_euclid(1.0);
        Self {
            light_azimuth: step(turn(light_azimuth_rad - azimuth), size.light_azimuths),
            ring: ring(q.length(), size),
            turn: step(turn(view - light_azimuth_rad), size.turns),
            view_azimuth_rad: turn(view - azimuth) * TAU - PI,
        }
    }

    fn cell(&self, longitude: usize, sum_of_sines: f64) -> usize {
        let size = TransportSize::ALL;
        let light = (longitude * size.light_azimuths + self.light_azimuth) * size.rings + self.ring;
        (light * size.cones + step((sum_of_sines + 1.0) / 3.0, size.cones)) * size.turns + self.turn
    }

    /// If the table has its direction.
    fn ambient_cell(&self, sin_theta_o: f64) -> Option<usize> {
        let size = TransportSize::ALL;
        let light = self.light_azimuth * size.rings + self.ring;
        let longitude = step(0.5 * sin_theta_o + 0.5, size.view_longitudes);
        let azimuth = step(self.view_azimuth_rad / PI + 0.5, size.view_azimuths);
        (self.view_azimuth_rad.abs() < 0.5 * PI)
            .then(|| (light * size.view_longitudes + longitude) * size.view_azimuths + azimuth)
    }
}

/// Cell of a place in [0, 1].
fn step(place: f64, cells: usize) -> usize {
    ((place * cells as f64) as usize).min(cells - 1)
}
