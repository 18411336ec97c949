use std::f64::consts::TAU;

use lisle_core::sampling::{hash_combine, unit_from_hash};
use lisle_core::yarn::{FiberTable, HAIR_WIDTH, Yarn};
use rayon::prelude::*;

/// Height that marks a texel where no fiber is seen.
pub const HOLE: f32 = -2.0;

/// Layers, rows along the ply, texels across it.
const LAYERS: usize = 8;
const LENGTH: usize = 256;
const WIDTH: usize = 128;

/// Textures that stand for the inner fibers of a ply [WuYuksel2018 §3.2, Fig. 5].
///
/// They show a ply in its NORMALISED section (half axes divided out: a unit disc), seen from +h, with +v across. Row u is the turn of the bundle: fiber i
/// lies at angle 2π(u + angle_turns_i) from +h towards +v, at radius R_i (R_min + (1 − R_min)(½ − ½ cos 2π(u + migration_turns_i))), which is Eq. 2 with
/// s = 1, so that one turn tiles. Sample them with the nearest texel: neighbours may be different fibers.
#[derive(Clone, Debug, PartialEq)]
pub struct CoreFiber {
    /// Layer l shows the fibers of rank ≥ ⌊l m / layers⌋ of the fiber table; rank 0 is the outermost. Those astray are left out.
    pub layers: usize,
    /// Rows; row k is at u = (k + ½) / length, in turns.
    pub length: usize,
    /// Texels across; texel k is at v = ((k + ½) / width · 2 − 1) half_width.
    pub width: usize,
    /// Half of what v covers, for every layer: 1 + the relative fiber radius.
    pub half_width: f32,
    /// Per layer, the largest |v| that its fibers reach.
    pub layer_half_width: Vec<f32>,
    /// `[layer][u][v]`: height h of the visible surface ([`HOLE`] where there is none), offset across the fiber in [−1, 1] (towards +v),
    /// and dh/dθ, dv/dθ of the visible fiber's centre line, θ the bundle's angle in radians.
    pub texels: Vec<[f32; 4]>,
}

/// Which fibers of a ply the textures show: flyaways are drawn one by one while they are outside of the ply, so that only as many of
/// the fibers that fly away are here as stay in it at a time.
fn stays(yarn: &Yarn, fiber: usize) -> bool {
    let (loops, hairs) = yarn.flyaway_chances();
    let span = yarn.flyaways.hair_z_span;
    // Mean of |x| for a normal variate about (nearly) zero.
    let width = (span.deviation * (2.0 / std::f64::consts::PI).sqrt()).max(span.mean.abs()) / yarn.migration_period();
    let away = loops + hairs * width.clamp(HAIR_WIDTH.0, HAIR_WIDTH.1);
    fiber >= yarn.flyaway_fibers() as usize || unit_from_hash(hash_combine(0x57a7_1c0e, fiber as u32)) >= away
}

/// A fiber's centre in the normalised section and its rates per radian of the bundle.
#[derive(Clone, Copy, Debug)]
struct Center {
    h: f64,
    v: f64,
    dh: f64,
    dv: f64,
}

fn center(yarn: &Yarn, table: &FiberTable, fiber: usize, u: f64) -> Center {
    let migration = TAU * (u + table.migration_turns[fiber]);
    let outer = table.radius[fiber];
    let radius = outer * (yarn.r_min + (1.0 - yarn.r_min) * (0.5 - 0.5 * migration.cos()));
    let radius_rate = outer * (1.0 - yarn.r_min) * 0.5 * migration.sin();
    let (sin, cos) = (TAU * (u + table.angle_turns[fiber])).sin_cos();
    Center {
        h: radius * cos,
        v: radius * sin,
        dh: radius_rate * cos - radius * sin,
        dv: radius_rate * sin + radius * cos,
    }
}

impl CoreFiber {
    /// Draws the fibers of one ply.
    pub fn new(yarn: &Yarn, table: &FiberTable) -> Self {
        let fiber_radius = yarn.fiber_radius / yarn.mean_axis();
        let half_width = 1.0 + fiber_radius;
        let count = table.radius.len();
        let first_rank = |layer: usize| layer * count / LAYERS;

        // Innermost layer first: each next one adds fibers to a copy of the last.
        let row = |k: usize| {
            let u = (k as f64 + 0.5) / LENGTH as f64;
            let mut texels = [[HOLE, 0.0, 0.0, 0.0]; WIDTH];
            let mut layers = vec![texels; LAYERS];
            for layer in (0..LAYERS).rev() {
                let end = if layer + 1 == LAYERS { count } else { first_rank(layer + 1) };
                for fiber in (first_rank(layer)..end).filter(|fiber| stays(yarn, *fiber)) {
                    draw(yarn, &center(yarn, table, fiber, u), fiber_radius, half_width, &mut texels);
                }
                layers[layer] = texels;
            }
            layers
        };
        let rows: Vec<_> = (0..LENGTH).into_par_iter().map(row).collect();
        let texels = (0..LAYERS).flat_map(|layer| rows.iter().flat_map(move |row| row[layer])).collect();
        Self {
            layers: LAYERS,
            length: LENGTH,
            width: WIDTH,
            half_width: half_width as f32,
            layer_half_width: (0..LAYERS)
                .map(|layer| (table.radius[first_rank(layer)] + fiber_radius) as f32)
                .collect(),
            texels,
        }
    }
}

/// Half of what a fiber covers of a row: a fiber that crosses the ply at a slant is cut longer than it is wide.
fn half_span(yarn: &Yarn, at: &Center, fiber_radius: f64) -> f64 {
    let slope = at.dv * TAU * yarn.mean_axis() / yarn.fiber_twist.abs();
    fiber_radius * slope.hypot(1.0)
}

/// Draws one fiber into a row, nearest to the viewer wins.
fn draw(yarn: &Yarn, at: &Center, fiber_radius: f64, half_width: f64, row: &mut [[f32; 4]; WIDTH]) {
    let span = half_span(yarn, at, fiber_radius);
    let texel_width = 2.0 * half_width / WIDTH as f64;
    let column = |v: f64| ((v + half_width) / texel_width - 0.5).clamp(0.0, WIDTH as f64);
    let columns = column(at.v - span).ceil() as usize..(column(at.v + span).floor() as usize + 1).min(WIDTH);
    for (k, texel) in columns.clone().zip(&mut row[columns]) {
        let offset = ((k as f64 + 0.5) * texel_width - half_width - at.v) / span;
        let height = (at.h + fiber_radius * (1.0 - offset * offset).max(0.0).sqrt()) as f32;
        if offset.abs() <= 1.0 && height > texel[0] {
            *texel = [height, offset as f32, at.dh as f32, at.dv as f32];
        }
    }
}

#[cfg(test)]
mod tests {
    use lisle_core::yarn::PRESET_NAMES;

    use super::*;
    use crate::explicit::Random;

    fn texture(name: &str) -> (Yarn, FiberTable, CoreFiber) {
        let yarn = Yarn::preset(name).expect(name);
        let table = FiberTable::new(&yarn);
        let texture = CoreFiber::new(&yarn, &table);
        (yarn, table, texture)
    }

    /// Mean difference of height between two rows of layer 0.
    fn difference(texture: &CoreFiber, a: usize, b: usize) -> f64 {
        let row = |k: usize| texture.texels[k * WIDTH..(k + 1) * WIDTH].iter();
        row(a).zip(row(b)).map(|(a, b)| f64::from((a[0] - b[0]).abs())).sum::<f64>() / WIDTH as f64
    }

    #[test]
    fn rows_tile() {
        for name in PRESET_NAMES {
            let (_, _, texture) = texture(name);
            let inner = (1..LENGTH).map(|k| difference(&texture, k - 1, k)).fold(0.0, f64::max);
            assert!(difference(&texture, LENGTH - 1, 0) <= inner, "{name}");
            // The same check sees a seam: rows a sixteenth of a turn apart.
            assert!(difference(&texture, LENGTH - 16, 0) > inner, "{name}");
        }
    }

    #[test]
    fn texels_show_the_front_fiber_of_their_layer() {
        let (yarn, table, texture) = texture("cotton-2");
        let fiber_radius = yarn.fiber_radius / yarn.mean_axis();
        let mut random = Random::new(3);
        for _ in 0..4000 {
            let pick = |count: usize, x: f64| (count as f64 * x) as usize;
            let (layer, k, j) = (pick(LAYERS, random.unit()), pick(LENGTH, random.unit()), pick(WIDTH, random.unit()));
            let u = (k as f64 + 0.5) / LENGTH as f64;
            let v = ((j as f64 + 0.5) / WIDTH as f64 * 2.0 - 1.0) * f64::from(texture.half_width);
            let mut expected = [f64::from(HOLE), 0.0, 0.0, 0.0];
            let ranks = layer * table.radius.len() / LAYERS..table.radius.len();
            for fiber in ranks.filter(|fiber| stays(&yarn, *fiber)) {
                let at = center(&yarn, &table, fiber, u);
                let offset = (v - at.v) / half_span(&yarn, &at, fiber_radius);
                let height = at.h + fiber_radius * (1.0 - offset * offset).max(0.0).sqrt();
                if offset.abs() <= 1.0 && height > expected[0] {
                    expected = [height, offset, at.dh, at.dv];
                }
            }
            let texel = texture.texels[(layer * LENGTH + k) * WIDTH + j];
            assert!((0..4).all(|c| (f64::from(texel[c]) - expected[c]).abs() < 1e-4), "{texel:?} for {expected:?}");
            if texel[0] > HOLE {
                assert!(v.abs() <= f64::from(texture.layer_half_width[layer]) + 0.02);
            }
        }
    }

    #[test]
    fn directions_are_finite_differences_of_the_centre_line() {
        let (yarn, table, _) = texture("rayon-4");
        for fiber in 0..table.radius.len() {
            for k in 0..16 {
                let (u, step) = (f64::from(k) / 16.0, 1e-6);
                let (a, b) = (center(&yarn, &table, fiber, u - step), center(&yarn, &table, fiber, u + step));
                let at = center(&yarn, &table, fiber, u);
                let radians = 2.0 * step * TAU;
                assert!(((b.h - a.h) / radians - at.dh).abs() < 1e-8 && ((b.v - a.v) / radians - at.dv).abs() < 1e-8);
            }
        }
    }

    /// Share of [−half_width, half_width] that tubes of the fiber radius cover, over random turns and views.
    fn explicit_coverage(yarn: &Yarn, table: &FiberTable, half_width: f64) -> f64 {
        const RAYS: u32 = 20_000;
        let fiber_radius = yarn.fiber_radius / yarn.mean_axis();
        let length_of_turn = yarn.fiber_twist.abs() / yarn.mean_axis();
        let reach = 2.0 * fiber_radius / length_of_turn;
        let mut random = Random::new(9);
        let covered = (0..RAYS).filter(|_| {
            // A viewer at angle ψ sees the bundle turned by −ψ; the migration does not turn with the view.
            let (u, view, v) = (random.unit(), random.unit(), (2.0 * random.unit() - 1.0) * half_width);
            (0..table.radius.len()).filter(|fiber| stays(yarn, *fiber)).any(|fiber| {
                let seen = FiberTable {
                    radius: vec![table.radius[fiber]],
                    angle_turns: vec![table.angle_turns[fiber] - view],
                    migration_turns: vec![table.migration_turns[fiber]],
                    acceptance: 1.0,
                };
                (-20..=20).any(|k| {
                    let along = f64::from(k) / 20.0 * reach;
                    (along * length_of_turn).hypot(center(yarn, &seen, 0, u + along).v - v) < fiber_radius
                })
            })
        });
        covered.count() as f64 / f64::from(RAYS)
    }

    #[test]
    fn the_outermost_layer_covers_what_its_fibers_cover() {
        for name in PRESET_NAMES {
            let (yarn, table, texture) = texture(name);
            let seen = texture.texels[..LENGTH * WIDTH].iter().filter(|texel| texel[0] > HOLE).count();
            let coverage = seen as f64 / (LENGTH * WIDTH) as f64;
            let expected = explicit_coverage(&yarn, &table, f64::from(texture.half_width));
            println!("{name}: coverage {coverage:.4} for {expected:.4}");
            assert!((coverage / expected - 1.0).abs() < 0.01, "{name}: {coverage} for {expected}");
            let inner = texture.texels[3 * LENGTH * WIDTH..4 * LENGTH * WIDTH].iter();
            let inner = inner.filter(|texel| texel[0] > HOLE).count() as f64 / (LENGTH * WIDTH) as f64;
            assert!((inner / expected - 1.0).abs() > 0.01, "{name}: an inner layer passes too");
        }
    }
}
