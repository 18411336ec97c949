//! Paths from viewers to a yarn's fibers, followed from one to the next until they leave it towards a light.
//!
//! They scatter and go on as those of the reference do (`native/reference/src/path.rs`): a place on the fiber's width is drawn for each ray by which it takes in light.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use glam::{DVec2, DVec3};
use lisle_core::sampling::Random;
use lisle_core::scattering::{FiberFrame, FiberScattering, Material};
use lisle_core::yarn::Yarn;
use rayon::prelude::*;

use super::section::{Section, Sections};
use super::table::{Entry, TransportSize, ring, theta};
use crate::SectionDensity;

/// Paths are walked in this many streams, summed in order.
const STREAMS: u32 = 16;

/// Paths through one section.
const PATHS_A_SECTION: u32 = 64;

/// A path goes so far along the yarn until its section turns with the plies, outer radii.
const STEP: f64 = 0.5;

/// Scatterings before Russian roulette may end a path.
const LEAST_SCATTERINGS: u32 = 3;

/// Sums over paths.
#[derive(Clone)]
pub(super) struct Tally {
    /// Throughput by cell of the table, of light scattered at least twice.
    pub cells: Vec<DVec3>,
    /// Paths by the cell of place and viewer: [`TransportSize::places`].
    pub seen: Vec<f64>,
    /// Throughput by the cosine between the ways to light and viewer, of all paths on the yarn, and how many these are.
    pub sides: Vec<DVec3>,
    pub on_yarn: f64,
    /// By the yarn's width as the viewer sees it: of all on the yarn, and the throughput of those that leave.
    width: f64,
    left: DVec3,
    pub entries: Entries,
}

/// Moments of where light came in (e) and where it is seen (p), beside the plane through the yarn's axis and the light.
#[derive(Clone, Copy, Default)]
pub(super) struct Entries {
    weight: f64,
    ee: f64,
    ep: f64,
    pp: f64,
}

impl Entries {
    fn push(&mut self, entry: f64, place: f64, weight: f64) {
        self.weight += weight;
        self.ee += weight * entry * entry;
        self.ep += weight * entry * place;
        self.pp += weight * place * place;
    }

    fn add(&mut self, other: &Self) {
        self.weight += other.weight;
        self.ee += other.ee;
        self.ep += other.ep;
        self.pp += other.pp;
    }

    /// The line through the origin that fits best, and what is left. Of no light, none is moved.
    pub fn entry(&self) -> Entry {
        let share = if self.pp > 0.0 { self.ep / self.pp } else { 1.0 };
        let left = (self.ee - share * self.ep) / self.weight.max(f64::MIN_POSITIVE);
        Entry { share, spread: left.max(0.0).sqrt() }
    }
}

impl Tally {
    fn new() -> Self {
        let size = TransportSize::ALL;
        Self {
            cells: vec![DVec3::ZERO; size.cells()],
            seen: vec![0.0; size.places()],
            sides: vec![DVec3::ZERO; size.sides],
            on_yarn: 0.0,
            width: 0.0,
            left: DVec3::ZERO,
            entries: Entries::default(),
        }
    }

    fn add(mut self, other: &Self) -> Self {
        self.cells.iter_mut().zip(&other.cells).for_each(|(a, b)| *a += *b);
        self.seen.iter_mut().zip(&other.seen).for_each(|(a, b)| *a += *b);
        self.sides.iter_mut().zip(&other.sides).for_each(|(a, b)| *a += *b);
        self.on_yarn += other.on_yarn;
        self.width += other.width;
        self.left += other.left;
        self.entries.add(&other.entries);
        self
    }

    pub fn albedo(&self) -> DVec3 {
        self.left / self.width
    }
}

/// Paths of a batch, after which a walk may be stopped: some hundredths of a second.
const BATCH: u32 = 20_000;

/// Batches of a walk.
pub(super) fn batches(paths: u32) -> u32 {
    paths.div_ceil(BATCH)
}

/// Walks about `paths` paths; `proceed` is asked after each batch.
pub(super) fn walk(
    yarn: &Yarn,
    material: &Material,
    paths: u32,
    proceed: &mut dyn FnMut() -> ControlFlow<()>,
) -> ControlFlow<(), Tally> {
    let walker = Walker::new(yarn, material);
    let batches = batches(paths);
    let sections = paths.div_ceil(batches * STREAMS * PATHS_A_SECTION);
    let mut streams: Vec<_> = (0..STREAMS).map(|stream| (Tally::new(), Random::new(0x7a15, 0, stream))).collect();
    for _ in 0..batches {
        streams.par_iter_mut().for_each(|(tally, random)| {
            let mut ways = Vec::new();
            for _ in 0..sections {
                let section = walker.sections.cut(random.unit(), (random.unit() * f64::from(u32::MAX)) as u32);
                for _ in 0..PATHS_A_SECTION {
                    walker.follow(&section, random, tally, &mut ways);
                }
            }
        });
        proceed()?;
    }
    ControlFlow::Continue(streams.iter().fold(Tally::new(), |sum, (tally, _)| sum.add(tally)))
}

struct Walker {
    sections: Sections,
    turn_rate: f64,
    /// Radius that no fiber leaves.
    reach: f64,
    /// The lobes, if there are any.
    fiber: Option<FiberScattering>,
    /// Of Lambert's term.
    surface_albedo: DVec3,
    surface_chance: f64,
}

/// Where a path meets a fiber, in the section there.
struct Vertex {
    fiber: usize,
    /// Off the fiber's axis.
    normal: DVec3,
    /// Turn of the section since the last one.
    turn: f64,
}

impl Walker {
    fn new(yarn: &Yarn, material: &Material) -> Self {
        let sections = Sections::of(yarn);
        let weight = material.diffuse_weight;
        let bare = Material { diffuse: DVec3::ZERO, ..*material };
        Self {
            turn_rate: sections.turn_rate(),
            sections,
            reach: SectionDensity::new(yarn).reach,
            fiber: (weight < 1.0).then(|| FiberScattering::physical(bare)),
            surface_albedo: material.diffuse * weight,
            surface_chance: if material.diffuse == DVec3::ZERO { 0.0 } else { weight },
        }
    }

    /// The next fiber on a ray's way that begins on a fiber or outside.
    fn next(
        &self,
        section: &Section,
        from: DVec2,
        direction: DVec3,
        own: Option<usize>,
        ways: &mut Vec<f32>,
    ) -> Option<(Vertex, DVec3)> {
        let (mut q, mut d, mut own, mut turn) = (from, direction, own, 0.0);
        loop {
            let out = way_out(q, d.truncate(), self.reach)?;
            let most = STEP / d.z.abs().max(1e-9);
            let met = section.nearest(q, d, own, ways).filter(|(_, way)| *way <= most && *way <= out);
            let way = met.map_or(most, |(_, way)| way);
            if met.is_none() && out <= most {
                return None;
            }
            let z = way * d.z;
            let step_turn = self.turn_rate * z;
            let back = DVec2::from_angle(-step_turn);
            let rotate = |v: DVec3| back.rotate(v.truncate()).extend(v.z);
            turn += step_turn;
            if let Some((fiber, _)) = met {
                let slope = section.slope(fiber);
                let tangent = slope.extend(1.0).normalize();
                let beside = (q + d.truncate() * way - section.center(fiber) - slope * z).extend(0.0);
                let normal = (beside - tangent * beside.dot(tangent)).normalize_or(-d);
                return Some((Vertex { fiber, normal: rotate(normal), turn }, rotate(d)));
            }
            q = back.rotate(q + d.truncate() * way);
            d = rotate(d);
            own = None;
        }
    }

    /// A direction of light drawn at a vertex, where on the section its ray starts, and the throughput.
    fn scatter(
        &self,
        section: &Section,
        vertex: &Vertex,
        view: DVec3,
        random: &mut Random,
    ) -> Option<(DVec2, DVec3, DVec3)> {
        let (center, slope) = (section.center(vertex.fiber), section.slope(vertex.fiber));
        let tangent = slope.extend(1.0).normalize();
        let start = |on_rim: DVec3| {
            let offset = on_rim * section.radius(vertex.fiber);
            center + offset.truncate() - slope * offset.z
        };
        let (choice, numbers) = (random.unit(), random.triple());
        if choice < self.surface_chance {
            let frame = FiberFrame::new(vertex.normal.any_orthonormal_vector(), vertex.normal);
            let (sin, cos) = (TAU * numbers[1]).sin_cos();
            let (height, across) = ((1.0 - numbers[0]).sqrt(), numbers[0].sqrt());
            let direction = frame.world_from_local(DVec3::new(height, across * cos, across * sin));
            return Some((start(vertex.normal), direction, self.surface_albedo / self.surface_chance));
        }
        let frame = FiberFrame::new(tangent, vertex.normal);
        let drawn = self.fiber.as_ref()?.sample(frame.local_from_world(view), numbers)?;
        let direction = frame.world_from_local(drawn.wi).normalize();
        let facing = (direction - tangent * direction.dot(tangent)).normalize_or(vertex.normal);
        let offset = 2.0 * random.unit() - 1.0;
        let on_rim = facing * (1.0 - offset * offset).sqrt() + tangent.cross(facing) * offset;
        Some((start(on_rim), direction, drawn.weight / (1.0 - self.surface_chance)))
    }

    fn follow(&self, section: &Section, random: &mut Random, tally: &mut Tally, ways: &mut Vec<f32>) {
        let size = TransportSize::ALL;
        let sin = 2.0 * random.unit() - 1.0;
        let cos = (1.0 - sin * sin).sqrt();
        let across = DVec2::from_angle(TAU * random.unit());
        let beside = self.reach * (2.0 * random.unit() - 1.0);
        let on_yarn = beside.abs() < 1.0;
        let mut view = (across * cos).extend(sin);
        if on_yarn {
            tally.on_yarn += 1.0;
            tally.width += cos;
        }
        let start = across * (self.reach * self.reach - beside * beside).sqrt() * (1.0 - 1e-9) + across.perp() * beside;
        let Some((mut vertex, mut ray)) = self.next(section, start, -view, None, ways) else {
            if on_yarn {
                tally.left += cos;
            }
            return;
        };
        view = -ray;
        let place = section.center(vertex.fiber) + vertex.normal.truncate() * section.radius(vertex.fiber);
        let seen = Seen::new(place, view);
        tally.seen[seen.cell()] += 1.0;
        tally.seen[seen.turned().cell()] += 1.0;
        let (mut throughput, mut turn) = (DVec3::ONE, 0.0);
        for scatterings in 1.. {
            let Some((from, direction, weight)) = self.scatter(section, &vertex, -ray, random) else { return };
            throughput *= weight;
            let Some((next, arrives)) = self.next(section, from, direction, Some(vertex.fiber), ways) else {
                let light = DVec2::from_angle(turn).rotate(direction.truncate()).extend(direction.z);
                if scatterings > 1 {
                    tally.cells[seen.light_cell(light)] += throughput;
                    let toward_light = light.truncate().normalize_or_zero();
                    if view.truncate().dot(toward_light) > 0.0 {
                        let beside = |q: DVec2| q.dot(toward_light.perp());
                        tally.entries.push(
                            beside(DVec2::from_angle(turn).rotate(from)),
                            beside(place),
                            throughput.element_sum(),
                        );
                    }
                }
                if on_yarn {
                    let cosine = light.dot(view);
                    tally.sides[step(0.5 * cosine + 0.5, size.sides)] += throughput;
                    tally.left += throughput * cos;
                }
                return;
            };
            turn += next.turn;
            (vertex, ray) = (next, arrives);
            if scatterings >= LEAST_SCATTERINGS {
                let survival = throughput.max_element().min(1.0);
                if random.unit() >= survival {
                    return;
                }
                throughput /= survival;
            }
        }
    }
}

/// Way to the circle about the yarn that a ray leaves it by; none outside, or along the yarn, where nothing is ever left: a set of measure 0.
fn way_out(q: DVec2, across: DVec2, radius: f64) -> Option<f64> {
    let a = across.length_squared();
    let b = q.dot(across);
    let root = b * b - a * (q.length_squared() - radius * radius);
    (a > 1e-18 && root > 0.0).then(|| (root.sqrt() - b) / a).filter(|way| *way > 0.0)
}

/// Cell of x in [0, 1].
fn step(x: f64, cells: usize) -> usize {
    ((x * cells as f64) as usize).min(cells - 1)
}

/// A turn in [0, 1), of which one half is none.
fn half_turned(angle: f64) -> f64 {
    (angle / TAU + 0.5).rem_euclid(1.0)
}

/// A place of a yarn that is seen.
#[derive(Clone, Copy)]
struct Seen {
    azimuth: f64,
    ring: usize,
    view_longitude: usize,
    view_azimuth: usize,
}

impl Seen {
    fn new(place: DVec2, view: DVec3) -> Self {
        let size = TransportSize::ALL;
        let azimuth = place.y.atan2(place.x);
        let turn = half_turned(view.y.atan2(view.x) - azimuth) * TAU - PI;
        Self {
            azimuth,
            ring: ring(place.length(), size),
            view_longitude: step(0.5 * view.z + 0.5, size.view_longitudes),
            view_azimuth: step(turn / PI + 0.5, size.view_azimuths),
        }
    }

    /// By half a turn about a line across the yarn through the place.
    fn turned(self) -> Self {
        let size = TransportSize::ALL;
        Self {
            view_longitude: size.view_longitudes - 1 - self.view_longitude,
            view_azimuth: size.view_azimuths - 1 - self.view_azimuth,
            ..self
        }
    }

    /// Of [`Tally::seen`].
    fn cell(&self) -> usize {
        let size = TransportSize::ALL;
        (self.ring * size.view_longitudes + self.view_longitude) * size.view_azimuths + self.view_azimuth
    }

    /// Of [`Tally::cells`]. The table has lights of θ_i ≥ 0; others are the same, turned.
    fn light_cell(self, light: DVec3) -> usize {
        let size = TransportSize::ALL;
        let turn = half_turned(light.y.atan2(light.x) - self.azimuth);
        let theta_i = light.z.atan2(light.truncate().length());
        let (seen, turn) = if theta_i < 0.0 { (self.turned(), (1.0 - turn).rem_euclid(1.0)) } else { (self, turn) };
        let longitude = step(theta_i.abs() / (0.5 * PI), size.light_longitudes);
        debug_assert!(theta(longitude, size) <= theta_i.abs());
        (longitude * size.light_azimuths + step(turn, size.light_azimuths)) * size.places() + seen.cell()
    }
}
