use std::f64::consts::{PI, TAU};

use glam::DVec2;
use lisle_core::sampling::hash_combine;
use lisle_core::yarn::{FiberTable, Yarn, fiber_profile};
use rayon::prelude::*;

use crate::arrangement::EVEN_STEPS;
use crate::density::share_of_others;

/// Points of fibers in all sections of plies that differ in direction, about.
const POINTS: usize = 300_000;
/// At least and at most so many sections.
const SECTIONS: (usize, usize) = (64, 4096);
/// Of more plies, each tells less.
const FEW_PLIES: usize = 8;

/// The fibers of a yarn's ply in sections of it, as many as tell how often one of them is in a ray's way.
///
/// Tables come from these, not from the density of all yarns of a kind: some dozens of fibers keep their places in the ply all along it, and where by chance these are
/// close together or leave a gap, up to a quarter less or more light comes through.
#[derive(Clone, Debug, PartialEq)]
pub struct Bundle {
    pub(crate) plies: u32,
    ply_distance: f64,
    /// [`share_of_others`].
    others: f64,
    /// Of a fiber, where it does not thin out.
    fiber_radius: f64,
    /// Of one section.
    fibers: usize,
    /// `[section][fiber]`: place along the ply's short axis and its long one, and radius; in outer radii.
    points: Vec<[f32; 3]>,
}

impl Bundle {
    /// That of a yarn whose parameters are valid.
    pub fn of(yarn: &Yarn) -> Self {
        Self::new(yarn, &FiberTable::new(yarn))
    }

    /// Sections of a yarn's ply. Along a yarn, turns and migration meet in all pairs alike; loops and hairs are left to chance.
    pub fn new(yarn: &Yarn, table: &FiberTable) -> Self {
        let fibers = table.radius.len();
        let outer = yarn.outer_radius();
        let sections = POINTS / fibers / (yarn.plies as usize).div_ceil(FEW_PLIES);
        let sections = sections.clamp(SECTIONS.0, SECTIONS.1);
        let axes = DVec2::new(yarn.ellipse_short, yarn.ellipse_long) / outer;
        let fiber_radius = yarn.fiber_radius / outer;
        let point = |place: usize| {
            let (section, fiber) = (place / fibers, place % fibers);
            let [turns, phase] = EVEN_STEPS.map(|step| (section as f64 + 0.5) * step);
            let phase = (phase + table.migration_turns[fiber]).fract();
            let hash = hash_combine(section as u32, fiber as u32);
            let shape = fiber_profile(yarn, yarn.migration_rate, fiber as u32, table.radius[fiber], phase, hash);
            let astray = yarn.fiber_twist.signum() * shape.angle_turns;
            let angle = TAU * (turns + table.angle_turns[fiber] + astray);
            let at = DVec2::from_angle(angle) * shape.radius * axes;
            [at.x as f32, at.y as f32, (fiber_radius * shape.taper) as f32]
        };
        Self {
            plies: yarn.plies,
            ply_distance: yarn.ply_distance() / outer,
            others: share_of_others(yarn),
            fiber_radius,
            fibers,
            points: (0..sections * fibers).into_par_iter().map(point).collect(),
        }
    }

    /// Optical depths as `[y][x]`, light at angle `psi` and at +x, of texels over [−extent, extent]²: of the share of sections in which no fiber is in the light's way.
    ///
    /// A way begins πr/4 from its texel. A shaded point lies on a fiber and in no other one, so that fibers which contain it (πr²/2 of
    /// their area towards the light, divided by 2r) cannot shade it.
    ///
    /// `share`: of the sections, one of so many is looked at.
    pub fn depths(&self, psi: f64, size: usize, extent: f64, share: usize) -> Vec<f64> {
        let skipped = 0.25 * PI * self.fiber_radius;
        let per_texel = 0.5 * size as f64 / extent;
        let texels = |place: f64| (place + extent) * per_texel - 0.5;
        // The first ones of an even sequence are even, too.
        let sections = self.points.len() / self.fibers / share;
        let mut depths = vec![0.0; size * size];
        // Texels of each row, from the dark end, that a section has in the shade; in how many sections that is as many.
        let mut shaded = vec![0_usize; size];
        let mut count = vec![0_u32; size * (size + 1)];
        for ply in 0..self.plies {
            let turned = DVec2::from_angle(TAU * f64::from(ply) / f64::from(self.plies) - psi);
            count.fill(0);
            for section in self.points.chunks_exact(self.fibers).take(sections) {
                shaded.fill(0);
                for [short, long, radius] in section.iter().map(|point| point.map(f64::from)) {
                    let at = turned.rotate(DVec2::new(self.ply_distance + short, long));
                    let before = at_least(texels(at.x - skipped)).min(size);
                    let first = at_least(texels(at.y - radius)).min(size);
                    let end = at_least(texels(at.y + radius)).clamp(first, size);
                    for texels in &mut shaded[first..end] {
                        *texels = before.max(*texels);
                    }
                }
                for (row, texels) in shaded.iter().enumerate() {
                    count[row * (size + 1) + texels] += 1;
                }
            }
            for (depths, count) in depths.chunks_exact_mut(size).zip(count.chunks_exact(size + 1)) {
                let mut open = sections as f64;
                for (depth, count) in depths.iter_mut().zip(&count[1..]).rev() {
                    open -= f64::from(*count);
                    *depth -= self.others * (open.max(0.5) / sections as f64).ln();
                }
            }
        }
        depths
    }
}

/// The least whole number that is not below `place`. (The rounding of floating-point numbers is a call of a library on old processors.)
fn at_least(place: f64) -> usize {
    let whole = place as usize;
    whole + usize::from((whole as f64) < place)
}
