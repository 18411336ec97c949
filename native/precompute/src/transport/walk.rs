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
    /// Power that leaves fibers over the cosine of its inclination: [`super::Transport::radiance`] before it is divided by the fibers of a cell.
    pub cells: Vec<DVec3>,
    /// Power that leaves the yarn by the cosine of its turn, over the yarn's width seen from there.
    pub sides: Vec<DVec3>,
    entered: f64,
    left: DVec3,
    left_forward: DVec3,
}

impl Tally {
    fn new() -> Self {
        Self {
            cells: vec![DVec3::ZERO; TransportSize::ALL.cells()],
            sides: vec![DVec3::ZERO; TransportSize::ALL.sides],
            entered: 0.0,
            left: DVec3::ZERO,
            left_forward: DVec3::ZERO,
        }
    }

    fn add(mut self, other: &Self) -> Self {
        self.cells.iter_mut().zip(&other.cells).for_each(|(a, b)| *a += *b);
        self.sides.iter_mut().zip(&other.sides).for_each(|(a, b)| *a += *b);
        self.entered += other.entered;
        self.left += other.left;
        self.left_forward += other.left_forward;
        self
    }

    pub fn albedo(&self) -> DVec3 {
        self.left / self.entered
    }

    pub fn through(&self) -> DVec3 {
        self.left_forward / self.entered
    }
}

/// Photons of a batch, after which a walk may be stopped: some hundredths of a second.
const BATCH: u32 = 20_000;

/// Batches of a walk.
pub(super) fn batches(photons: u32) -> u32 {
    photons.div_ceil(BATCH)
}

/// Walks about `photons` photons; `proceed` is asked after each batch.
pub(super) fn walk(
    medium: &Medium,
    material: &Material,
    photons: u32,
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
                    follow(medium, &scattering, longitude, share, random, tally);
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
    // Per unit length of the yarn, at irradiance 1 on a plane that faces the light.
    let mut power = DVec3::splat(2.0 * reach * theta_i.cos() * share);
    let on_yarn = beside.abs() < 1.0;
    if on_yarn {
        tally.entered += power.x;
    }
    let first_power = power.x;
    let mut scatterings = 0;
    loop {
        let (weight, collision) = medium.next(q, direction, scatterings > 0, random);
        power *= weight;
        let Some(Collision { q: met, tangent }) = collision else { break };
        let frame = FiberFrame::new(tangent, tangent.any_orthonormal_vector());
        let (wo, left) = scattering.scatter(frame.local_from_world(-direction), power, random);
        (q, direction, power) = (met, frame.world_from_local(wo), left);
        scatterings += 1;
        if scatterings > 1 {
            let cos = wo.truncate().length();
            if let Some(cell) = outgoing_cell(q, direction, azimuth).filter(|_| cos > LEAST_COS) {
                tally.cells[longitude * (size.cells() / size.light_longitudes) + cell] += power / cos;
            }
        }
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
        if scatterings > 0 && cos > LEAST_COS {
            // A sun of every direction in space: those of a cell of θ_i share cos θ_i dθ_i.
            let suns = to.sin() - from.sin();
            let side = (0.5 * direction.dot(toward_light) + 0.5) * size.sides as f64;
            tally.sides[(side as usize).min(size.sides - 1)] += power * (suns / (2.0 * cos));
        }
        tally.left += power;
        if direction.dot(toward_light) < 0.0 {
            tally.left_forward += power;
        }
    }
}

/// Cell of a scattering within those of one θ_i, if the table has its direction.
fn outgoing_cell(q: DVec2, direction: DVec3, light_azimuth: f64) -> Option<usize> {
    let size = TransportSize::ALL;
    let azimuth = q.y.atan2(q.x);
    let turn = |angle: f64| (angle / TAU + 0.5).rem_euclid(1.0);
    let view = turn(direction.y.atan2(direction.x) - azimuth) * TAU - PI;
    let step = |x: f64, cells: usize| ((x * cells as f64) as usize).min(cells - 1);
    if view.abs() >= 0.5 * PI {
        return None;
    }
    let light = step(turn(light_azimuth - azimuth), size.light_azimuths);
    let view_longitude = step(0.5 * direction.z + 0.5, size.view_longitudes);
    let view_azimuth = step(view / PI + 0.5, size.view_azimuths);
    Some(
        ((light * size.rings + ring(q.length(), size)) * size.view_longitudes + view_longitude) * size.view_azimuths
            + view_azimuth,
    )
}
