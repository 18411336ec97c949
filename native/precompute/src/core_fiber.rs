use std::f64::consts::TAU;

use lisle_core::sampling::{hash_combine, unit_from_hash};
use lisle_core::yarn::{FiberTable, Yarn};
use rayon::prelude::*;

use crate::profile::astray_share;

/// Height that marks a texel where no fiber is seen.
pub const HOLE: f32 = -2.0;

/// Rank of no fiber.
pub const NO_RANK: u16 = u16::MAX;

/// Turns of the bundle along the ply that a texture shows.
pub const TURNS: usize = 4;

/// Views, layers, rows in all turns, texels across the ply.
const VIEWS: usize = 4;
const LAYERS: usize = 6;
const LENGTH: usize = 128 * TURNS;
const WIDTH: usize = 128;

/// Textures that stand for the inner fibers of a ply [WuYuksel2018 §3.2, Fig. 5].
///
/// They show a ply in its NORMALISED section (half axes divided out: a unit disc), seen from +h, with +v across. Row u is the turn of the bundle: fiber i
/// lies at angle 2π(u + angle_turns_i) from +h towards +v, at radius R_i (R_min + (1 − R_min)(½ − ½ cos 2π(s u + migration_turns_i))), which is Eq. 2 with
/// the migration rate s rounded to an odd number of periods in all turns, so that they tile. (In a single turn each fiber has one radius at each angle, and the
/// few outermost ones decide how bright an edge is.) Sample them with the nearest texel: neighbours may be different fibers.
///
/// Centre lines turn rigidly in that section, whatever the view; a round fiber does not. Seen from the section direction whose normalised form
/// is (cos ψ, sin ψ), the ellipse is T = √(e_N² cos²ψ + e_B² sin²ψ) deep and e_N e_B / T wide (half each), by which the fiber's radius is divided along h and v.
/// There is a texture for each of several ψ. The skew between h and v shifts heights within a fiber by less than its radius, and is left out.
///
/// How long a section cuts a fiber hangs on its slope across the view, which is that of its turning about its ply and of the ply's about the yarn. The short
/// axis of a ply points at the yarn's centre, so that ψ tells where about the yarn a ply is that is seen: in front for ψ = 0, at the edge for ψ = 90°.
#[derive(Clone, Debug, PartialEq)]
pub struct CoreFiber {
    /// View k is for sin²ψ = k / (views − 1), from in front of the short axis to in front of the long one.
    pub views: usize,
    /// Layer l shows the fibers of rank ≥ m (l / layers)² in the order of [`FiberTable::drawing_order`], the outermost first. Those astray are left out.
    pub layers: usize,
    /// Turns after which they repeat.
    pub turns: usize,
    /// Rows; row k is at u = (k + ½) turns / length.
    pub length: usize,
    /// Texels across; texel k is at v = ((k + ½) / width · 2 − 1) half_width.
    pub width: usize,
    /// Half of what v covers, for every view and layer: 1 + the largest relative fiber radius.
    pub half_width: f32,
    /// `[view][layer][u][v]`: height h of the visible surface ([`HOLE`] where there is none), offset across the fiber in [−1, 1] (towards +v),
    /// and dh/dθ, dv/dθ of the visible fiber's centre line, θ the bundle's angle in radians.
    pub texels: Vec<[f32; 4]>,
    /// Rank of the visible fiber, in the same order; [`NO_RANK`] where there is none.
    pub ranks: Vec<u16>,
}

/// A texel as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Texel {
    values: [f32; 4],
    rank: u16,
}

const NOTHING: Texel = Texel { values: [HOLE, 0.0, 0.0, 0.0], rank: NO_RANK };

/// A fiber as one view of the normalised section sees it.
#[derive(Clone, Copy, Debug)]
struct Footprint {
    /// Its radius along h and across, normalised.
    depth: f64,
    width: f64,
    /// dv/dθ that crosses the ply at 45°.
    steepness: f64,
    /// What the ply's turning adds to dv/dθ: at h = 0, and for each h.
    carried: [f64; 2],
}

impl Footprint {
    fn new(yarn: &Yarn, view: usize) -> Self {
        let (sin, cos) = section_angle(view).sin_cos();
        let half_depth = (yarn.ellipse_short * cos).hypot(yarn.ellipse_long * sin);
        let half_width = yarn.ellipse_short * yarn.ellipse_long / half_depth;
        // A point of the yarn's section that is d nearer to the viewer than its centre is carried across by d times the ply's angle: d is the
        // ply centre's distance times the cosine of its angle to the view, e_N cos ψ / T, and T h.
        let plies_per_fiber = if yarn.plies > 1 { yarn.fiber_twist / yarn.ply_twist } else { 0.0 };
        let nearer = yarn.ply_distance() * yarn.ellipse_short * cos / half_depth;
        Self {
            depth: yarn.fiber_radius / half_depth,
            width: yarn.fiber_radius / half_width,
            steepness: yarn.fiber_twist.abs() / (TAU * half_width),
            carried: [nearer, half_depth].map(|d| plies_per_fiber * d / half_width),
        }
    }

    /// Half of what a fiber covers of a row: a fiber that crosses the view at a slant is cut longer than it is wide.
    fn half_span(&self, at: &Center) -> f64 {
        let across = at.dv + self.carried[0] + self.carried[1] * at.h;
        self.width * (across / self.steepness).hypot(1.0)
    }
}

/// ψ of a view, radians.
fn section_angle(view: usize) -> f64 {
    (view as f64 / (VIEWS - 1) as f64).sqrt().asin()
}

/// Which fibers of a ply the textures show: flyaways are drawn one by one while they are outside of the ply, so that only as many of
/// the fibers that fly away are here as stay in it at a time.
fn staying(yarn: &Yarn, table: &FiberTable) -> Vec<bool> {
    let stays = |fiber: usize| {
        fiber >= yarn.flyaway_fibers() as usize
            || unit_from_hash(hash_combine(0x57a7_1c0e, fiber as u32)) >= astray_share(yarn, table.radius[fiber])
    };
    (0..table.radius.len()).map(stays).collect()
}

/// First of `count` fibers that a layer shows.
fn first_rank(layer: usize, count: usize) -> usize {
    (layer * layer * count).div_ceil(LAYERS * LAYERS)
}

/// A fiber's centre in the normalised section and its rates per radian of the bundle.
#[derive(Clone, Copy, Debug)]
struct Center {
    h: f64,
    v: f64,
    dh: f64,
    dv: f64,
}

/// Migration periods per turn of the textures: an odd number of them in all turns, which repeats in no fewer of the four.
fn migration_rate(yarn: &Yarn) -> f64 {
    let odd = 2.0 * (0.5 * (yarn.migration_rate * TURNS as f64 - 1.0)).round().max(0.0) + 1.0;
    odd / TURNS as f64
}

fn center(yarn: &Yarn, table: &FiberTable, fiber: usize, u: f64) -> Center {
    let rate = migration_rate(yarn);
    let migration = TAU * (rate * u + table.migration_turns[fiber]);
    let outer = table.radius[fiber];
    let radius = outer * (yarn.r_min + (1.0 - yarn.r_min) * (0.5 - 0.5 * migration.cos()));
    // Slopes are those of the yarn itself.
    let radius_rate = outer * (1.0 - yarn.r_min) * 0.5 * migration.sin() * yarn.migration_rate;
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
        let footprints: Vec<_> = (0..VIEWS).map(|view| Footprint::new(yarn, view)).collect();
        let half_width = 1.0 + footprints.iter().map(|f| f.width).fold(0.0, f64::max);
        let count = table.radius.len();
        let first_rank = |layer: usize| first_rank(layer, count);
        let (staying, order) = (staying(yarn, table), FiberTable::drawing_order(yarn));

        // Innermost layer first: each next one adds fibers to a copy of the last.
        let row = |view: usize, k: usize| {
            let u = (k as f64 + 0.5) * TURNS as f64 / LENGTH as f64;
            let mut texels = [NOTHING; WIDTH];
            let mut layers = vec![texels; LAYERS];
            for layer in (0..LAYERS).rev() {
                let end = if layer + 1 == LAYERS { count } else { first_rank(layer + 1) };
                for rank in (first_rank(layer)..end).filter(|rank| staying[order[*rank]]) {
                    let at = center(yarn, table, order[rank], u);
                    draw(&at, rank as u16, &footprints[view], half_width, &mut texels);
                }
                layers[layer] = texels;
            }
            layers
        };
        let rows: Vec<_> = (0..VIEWS * LENGTH).into_par_iter().map(|k| row(k / LENGTH, k % LENGTH)).collect();
        let texels = || {
            let of_view = |rows| (0..LAYERS).flat_map(move |layer| in_layer(rows, layer));
            rows.chunks(LENGTH).flat_map(of_view)
        };
        Self {
            views: VIEWS,
            layers: LAYERS,
            turns: TURNS,
            length: LENGTH,
            width: WIDTH,
            half_width: half_width as f32,
            texels: texels().map(|texel| texel.values).collect(),
            ranks: texels().map(|texel| texel.rank).collect(),
        }
    }
}

/// One layer's texels of a view's rows.
fn in_layer(rows: &[Vec<[Texel; WIDTH]>], layer: usize) -> impl Iterator<Item = Texel> {
    rows.iter().flat_map(move |row| row[layer])
}

/// Draws one fiber into a row, nearest to the viewer wins.
fn draw(at: &Center, rank: u16, footprint: &Footprint, half_width: f64, row: &mut [Texel; WIDTH]) {
    let span = footprint.half_span(at);
    let texel_width = 2.0 * half_width / WIDTH as f64;
    let column = |v: f64| ((v + half_width) / texel_width - 0.5).clamp(0.0, WIDTH as f64);
    let columns = column(at.v - span).ceil() as usize..(column(at.v + span).floor() as usize + 1).min(WIDTH);
    for (k, texel) in columns.clone().zip(&mut row[columns]) {
        let offset = ((k as f64 + 0.5) * texel_width - half_width - at.v) / span;
        let height = (at.h + footprint.depth * (1.0 - offset * offset).max(0.0).sqrt()) as f32;
        if offset.abs() <= 1.0 && height > texel.values[0] {
            *texel = Texel { values: [height, offset as f32, at.dh as f32, at.dv as f32], rank };
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
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
            // The same check sees a seam: rows a quarter of a turn apart.
            assert!(difference(&texture, LENGTH - LENGTH / TURNS / 4, 0) > inner, "{name}");
        }
    }

    #[test]
    fn texels_show_the_front_fiber_of_their_layer() {
        let (yarn, table, texture) = texture("cotton-2");
        let mut random = Random::new(3);
        let (staying, order) = (staying(&yarn, &table), FiberTable::drawing_order(&yarn));
        for _ in 0..4000 {
            let pick = |count: usize, x: f64| (count as f64 * x) as usize;
            let view = pick(VIEWS, random.unit());
            let footprint = Footprint::new(&yarn, view);
            let (layer, k, j) = (pick(LAYERS, random.unit()), pick(LENGTH, random.unit()), pick(WIDTH, random.unit()));
            let u = (k as f64 + 0.5) * TURNS as f64 / LENGTH as f64;
            let v = ((j as f64 + 0.5) / WIDTH as f64 * 2.0 - 1.0) * f64::from(texture.half_width);
            let mut expected = [f64::from(HOLE), 0.0, 0.0, 0.0];
            let mut expected_rank = NO_RANK;
            let ranks = first_rank(layer, table.radius.len())..table.radius.len();
            for rank in ranks.filter(|rank| staying[order[*rank]]) {
                let at = center(&yarn, &table, order[rank], u);
                let offset = (v - at.v) / footprint.half_span(&at);
                let height = at.h + footprint.depth * (1.0 - offset * offset).max(0.0).sqrt();
                if offset.abs() <= 1.0 && height > expected[0] {
                    expected = [height, offset, at.dh, at.dv];
                    expected_rank = rank as u16;
                }
            }
            let index = ((view * LAYERS + layer) * LENGTH + k) * WIDTH + j;
            let texel = texture.texels[index];
            assert_eq!(texture.ranks[index], expected_rank);
            assert!((0..4).all(|c| (f64::from(texel[c]) - expected[c]).abs() < 1e-4), "{texel:?} for {expected:?}");
        }
    }

    #[test]
    fn directions_are_finite_differences_of_the_centre_line() {
        let yarn = Yarn { migration_rate: 1.75, ..Yarn::preset("rayon-4").expect("preset") };
        let table = FiberTable::new(&yarn);
        for fiber in 0..table.radius.len() {
            for k in 0..16 {
                let (u, step) = (f64::from(k) / 4.0, 1e-6);
                let (a, b) = (center(&yarn, &table, fiber, u - step), center(&yarn, &table, fiber, u + step));
                let at = center(&yarn, &table, fiber, u);
                let radians = 2.0 * step * TAU;
                assert!(((b.h - a.h) / radians - at.dh).abs() < 1e-8 && ((b.v - a.v) / radians - at.dv).abs() < 1e-8);
            }
        }
    }

    /// Share of [−half_width, half_width] about a ply's centre that round tubes cover in the yarn's own section, over random places along the yarn where the
    /// ply is seen from a direction that one view stands for. Fibers turn about their ply and migrate as the textures have it, and the ply about the yarn.
    fn explicit_coverage(yarn: &Yarn, table: &FiberTable, view: usize, half_width: f64) -> f64 {
        const RAYS: u32 = 20_000;
        let axes = DVec2::new(yarn.ellipse_short, yarn.ellipse_long);
        let psi = section_angle(view);
        // Towards the viewer, in the ply's section.
        let toward = (DVec2::from_angle(psi) * axes).normalize();
        let half = axes.x * axes.y / (DVec2::from_angle(psi) * axes).length();
        let length_of_turn = yarn.fiber_twist.abs();
        let reach = 2.0 * yarn.fiber_radius / length_of_turn;
        let ply_angle = if yarn.plies > 1 { TAU * yarn.fiber_twist / yarn.ply_twist } else { 0.0 };
        let center_of_ply = DVec2::new(yarn.ply_distance(), 0.0);
        let mut random = Random::new(9);
        let staying = staying(yarn, table);
        let covered = (0..RAYS).filter(|_| {
            let (u, v) = (TURNS as f64 * random.unit(), (2.0 * random.unit() - 1.0) * half_width);
            (0..table.radius.len()).filter(|fiber| staying[*fiber]).any(|fiber| {
                (-20..=20).any(|k| {
                    let along = f64::from(k) / 20.0 * reach;
                    let at = center(yarn, table, fiber, u + along);
                    // From (h, v) of the view to the section's own axes: the bundle is turned by ψ.
                    let in_ply = DVec2::from_angle(psi).rotate(DVec2::new(at.h, at.v)) * axes;
                    let turned = DVec2::from_angle(ply_angle * along).rotate(center_of_ply + in_ply);
                    let across = toward.perp_dot(turned - center_of_ply) - v * half;
                    (along * length_of_turn).hypot(across) < yarn.fiber_radius
                })
            })
        });
        f64::from(covered.count() as u32) / f64::from(RAYS)
    }

    #[test]
    fn each_view_covers_what_round_fibers_cover() {
        for name in PRESET_NAMES {
            let (yarn, table, texture) = texture(name);
            let coverage = |view: usize, layer: usize| {
                let first = (view * LAYERS + layer) * LENGTH * WIDTH;
                let seen = texture.texels[first..first + LENGTH * WIDTH].iter().filter(|texel| texel[0] > HOLE).count();
                seen as f64 / (LENGTH * WIDTH) as f64
            };
            let width = f64::from(texture.half_width);
            for view in [0, VIEWS - 1] {
                let expected = explicit_coverage(&yarn, &table, view, width);
                println!("{name}, view {view}: coverage {:.4} for {expected:.4}", coverage(view, 0));
                assert!(
                    (coverage(view, 0) / expected - 1.0).abs() < 0.01,
                    "{name}: {} for {expected}",
                    coverage(view, 0)
                );
                assert!(
                    (coverage(view, LAYERS - 1) / expected - 1.0).abs() > 0.01,
                    "{name}: an inner layer passes too"
                );
            }
            // The views differ where the ply is flat.
            if yarn.ellipse_long > 1.3 * yarn.ellipse_short {
                let wrong = explicit_coverage(&yarn, &table, 0, width);
                assert!((coverage(VIEWS - 1, 0) / wrong - 1.0).abs() > 0.01, "{name}: the wrong view passes too");
            }
        }
    }
}
