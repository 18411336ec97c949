use lisle_core::yarn::{FiberTable, FiberType, Yarn};
use rayon::prelude::*;

use crate::arrangement::{Arrangement, TURNS};
use crate::ply_view::{NOTHING, REACH, SLANT_STEP, SLANTS, Texel, VIEWS, View, WIDTH};

/// Layers, rows in all turns.
const LAYERS: usize = 5;
const LENGTH: usize = 48 * TURNS;

/// Rows from one to the next that tell how wide a texture is.
const WIDEST_STRIDE: usize = 8;

/// Textures that stand for the fibers of a ply that are not drawn one by one [WuYuksel2018 §3.2, Fig. 5].
///
/// They show a ply of a straight yarn in its NORMALISED section (half axes divided out: a unit disc), seen from +h, with +v across. Row u is the turn of the
/// bundle: fiber i lies at angle 2π(u + angle_turns_i) from +h towards +v, at radius R_i (R_min + (1 − R_min)(½ − ½ cos 2π(± s u + migration_turns_i))), which is
/// Eq. 2 as [`Arrangement`] has it, or a loop or a hair. (In a single turn each fiber has one radius at each angle, and the few outermost ones decide how
/// bright an edge is.) Sample them with the nearest texel: neighbours may be different fibers.
///
/// A ray goes to the viewer from the section of its row, where it passes h = 0 of the ply at v. Seen at a slant it leaves that section: by the time that it comes to a
/// fiber, the bundle has turned in its ply, and the ply about the yarn. How long a section cuts a fiber, and how far it bulges, hangs on where it goes there.
///
/// The short axis of a ply points at the yarn's centre, so that the section direction ψ that a ply is seen from, whose normalised form
/// is (cos ψ, sin ψ), tells where about the yarn it is: in front for ψ = 0, at either edge for ψ = ±90°. In it, the ellipse is
/// T = √(e_N² cos²ψ + e_B² sin²ψ) deep and W = e_N e_B / T wide (half each).
#[derive(Clone, Debug, PartialEq)]
pub struct CoreFiber {
    /// Slant l is for a tangent of (l − (slants − 1)/2) `slant_step` between the direction to the viewer and the section, above 0 where it goes along the yarn.
    pub slants: usize,
    /// See `slants`.
    pub slant_step: f32,
    /// View k is for sin ψ |sin ψ| = 2 k / (views − 1) − 1.
    pub views: usize,
    /// Layer l shows the fibers of rank ≥ m (l / layers)² in the order of [`FiberTable`], the outermost first, loops and hairs among them.
    pub layers: usize,
    /// Turns after which they repeat.
    pub turns: usize,
    /// Rows; row k is at u = (k + ½) turns / length.
    pub length: usize,
    /// Texels across; texel k is at v = ((k + ½) / width · 2 − 1) half_width.
    pub width: usize,
    /// Half of what v covers without slant, and what is added for each step of it to either side.
    pub half_width: [f32; 2],
    /// `[slant][view][layer][u][v]`: height h of the visible surface ([`crate::HOLE`] where there is none), offset across the fiber in [−1, 1] (towards +v),
    /// and dh/dθ, dv/dθ of the visible fiber's centre line in its ply, θ the bundle's angle in radians, as they are in the section of the row.
    pub texels: Vec<[f32; 4]>,
    /// Rank of the visible fiber, in the same order; `u16::MAX` where there is none.
    pub ranks: Vec<u16>,
}

/// First of `count` fibers that a layer shows.
fn first_rank(layer: usize, count: usize) -> usize {
    (layer * layer * count).div_ceil(LAYERS * LAYERS)
}

impl CoreFiber {
    /// Draws the fibers of one ply.
    pub fn new(yarn: &Yarn, table: &FiberTable) -> Self {
        let count = table.radius.len();
        let arrangement = Arrangement::even(yarn, table);
        let view = |index: usize| View::new(&arrangement, index / VIEWS, index % VIEWS);
        let place = |row: usize| (view(row / LENGTH), ((row % LENGTH) as f64 + 0.5) * TURNS as f64 / LENGTH as f64);
        let widest = |slant: usize, shown: fn(FiberType) -> bool| {
            // Some rows of each view tell: in all of them the same fibers come to the edge.
            let rows = (slant * VIEWS * LENGTH..(slant + 1) * VIEWS * LENGTH).into_par_iter().step_by(WIDEST_STRIDE);
            let of_row = |row: usize| {
                let (view, u) = place(row);
                let footprints = (0..count).map(|rank| view.footprint(rank, u));
                footprints
                    .filter(|at| at.half_span > 0.0 && shown(at.kind))
                    .map(|at| (at.across.abs() + at.half_span) / view.half_width)
                    .fold(0.0, f64::max)
            };
            rows.map(of_row).reduce(|| 0.0, f64::max)
        };
        let staying = |kind| kind == FiberType::Migration;
        let middle = (SLANTS - 1) / 2;
        let least = widest(middle, staying);
        let half_width = widest(middle, |_| true).min(REACH).max(least);
        let steps = |slant: usize| slant.abs_diff(middle) as f64;
        let widening =
            (0..SLANTS).filter(|slant| *slant != middle).map(|slant| (widest(slant, staying) - least) / steps(slant));
        let widening = widening.fold(0.0, f64::max);

        // Innermost layer first: each next one adds fibers to a copy of the last.
        let row = |row: usize| {
            let (view, u) = place(row);
            let half_width = half_width + widening * steps(row / LENGTH / VIEWS);
            let mut texels = [NOTHING; WIDTH];
            let mut layers = vec![texels; LAYERS];
            for layer in (0..LAYERS).rev() {
                let end = if layer + 1 == LAYERS { count } else { first_rank(layer + 1, count) };
                for rank in first_rank(layer, count)..end {
                    view.draw(&view.footprint(rank, u), half_width, &mut texels);
                }
                layers[layer] = texels;
            }
            layers
        };
        let rows: Vec<_> = (0..SLANTS * VIEWS * LENGTH).into_par_iter().map(row).collect();
        let texels = || {
            let of_view = |rows| (0..LAYERS).flat_map(move |layer| in_layer(rows, layer));
            rows.chunks(LENGTH).flat_map(of_view)
        };
        Self {
            slants: SLANTS,
            slant_step: SLANT_STEP as f32,
            views: VIEWS,
            layers: LAYERS,
            turns: TURNS,
            length: LENGTH,
            width: WIDTH,
            half_width: [half_width as f32, widening as f32],
            texels: texels().map(|texel| texel.values).collect(),
            ranks: texels().map(|texel| texel.rank).collect(),
        }
    }
}

/// One layer's texels of a view's rows.
fn in_layer(rows: &[Vec<[Texel; WIDTH]>], layer: usize) -> impl Iterator<Item = Texel> {
    rows.iter().flat_map(move |row| row[layer])
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};
    use lisle_core::yarn::PRESET_NAMES;

    use super::*;
    use crate::explicit::Random;
    use crate::ply_view::{HOLE, MOST_LEAN, NO_RANK};

    fn texture(yarn: Yarn) -> (Yarn, FiberTable, CoreFiber) {
        let table = FiberTable::new(&yarn);
        let texture = CoreFiber::new(&yarn, &table);
        (yarn, table, texture)
    }

    fn without_flyaways(name: &str) -> Yarn {
        let mut yarn = Yarn::preset(name).expect(name);
        (yarn.flyaways.loop_density, yarn.flyaways.hair_density) = (0.0, 0.0);
        yarn
    }

    /// Texels in which two rows show the same fiber, in layer 0: the mean over all slants and views.
    fn same(texture: &CoreFiber, a: usize, b: usize) -> f64 {
        let of_view = |index: usize| {
            let row = |k: usize| texture.ranks[(index * LAYERS * LENGTH + k) * WIDTH..][..WIDTH].iter();
            row(a).zip(row(b)).filter(|(a, b)| a == b && **a != NO_RANK).count() as f64
        };
        (0..SLANTS * VIEWS).map(of_view).sum::<f64>() / (SLANTS * VIEWS) as f64
    }

    #[test]
    fn rows_tile() {
        for name in PRESET_NAMES {
            let (_, _, texture) = texture(Yarn::preset(name).expect(name));
            let inner = (1..LENGTH).map(|k| same(&texture, k - 1, k)).fold(f64::INFINITY, f64::min);
            let (seam, apart) = (same(&texture, LENGTH - 1, 0), same(&texture, LENGTH - LENGTH / TURNS / 4, 0));
            println!("{name}: {inner} at least, {seam} at the seam, {apart} a quarter of a turn apart");
            assert!(seam >= inner, "{name}: {seam} texels for {inner}");
            // The same check sees a seam: rows a quarter of a turn apart.
            assert!(apart < inner, "{name}: {apart} texels for {inner}");
        }
    }

    #[test]
    fn rates_are_finite_differences_of_the_centre_line() {
        let yarn = Yarn { migration_rate: 1.75, ..Yarn::preset("rayon-4").expect("preset") };
        let table = FiberTable::new(&yarn);
        let arrangement = Arrangement::even(&yarn, &table);
        for fiber in 0..table.radius.len() {
            let view = View::new(&arrangement, fiber % SLANTS, fiber % VIEWS);
            for k in 0..16 {
                let (u, along, step) = (f64::from(k) / 4.0, 0.01 * f64::from(k % 5), 1e-7);
                let [a, b] = [-step, step].map(|step| view.point(fiber, u, along + step).position);
                assert!(((b - a) / (2.0 * step)).distance(view.point(fiber, u, along).rate) < 1e-6);
            }
        }
    }

    /// A fiber as a ray meets it: its rank, the height of its surface, and its rate along the yarn.
    struct Met {
        rank: usize,
        height: f64,
        rate: DVec2,
    }

    /// What a ray from row u at v sees among the fibers from the `first` on, all of them chains of short round tubes.
    fn met(view: &View, first: usize, u: f64, v: f64) -> Option<Met> {
        let yarn = view.yarn;
        let radius = yarn.fiber_radius;
        let toward_viewer = DVec3::new(1.0, 0.0, view.slant).normalize();
        let origin = (view.center() + DVec2::new(0.0, v * view.half_width)).extend(0.0);
        // The bundle fills all sections that the ray has it in.
        let farthest = if yarn.flyaway_fibers() > 0 { REACH } else { 1.0 };
        let reach = 2.0 * farthest * yarn.ellipse_long.max(yarn.ellipse_short) * view.slant.abs() + 4.0 * radius;
        let step = 2.0 * radius;
        let steps = (reach / step).ceil() as i32;
        let mut nearest = (f64::NEG_INFINITY, None);
        for fiber in first..view.table.radius.len() {
            let at = |k: i32| {
                let along = f64::from(k) * step;
                view.point(fiber, u, along).position.extend(along) - origin
            };
            let width = |k: i32| view.point(fiber, u, f64::from(k) * step).width;
            let mut a = at(-steps);
            for k in -steps..steps {
                let b = at(k + 1);
                let beside = |p: DVec3| p - toward_viewer * p.dot(toward_viewer);
                let (c, d) = (beside(a), beside(b) - beside(a));
                let share = (-c.dot(d) / d.length_squared()).clamp(0.0, 1.0);
                let width = width(k);
                let left = radius * radius - ((c + d * share) / width).length_squared();
                if left > 0.0 {
                    let lean = (b - a).length() / d.length();
                    let way = a.lerp(b, share).dot(toward_viewer) + left.sqrt() * lean.min(MOST_LEAN);
                    if way > nearest.0 {
                        let bulge = left.sqrt();
                        let before = toward_viewer.x * (way - bulge * lean.min(MOST_LEAN)) + bulge;
                        let height = (before - v * view.skew) / view.depth;
                        let along = (b - a).normalize();
                        let farther = bulge * lean.min(MOST_LEAN) * along.dot(toward_viewer) * along.z;
                        let rate = view.point(fiber, u, (f64::from(k) + share) * step + farther).rate;
                        nearest = (way, Some(Met { rank: fiber, height, rate }));
                    }
                }
                a = b;
            }
        }
        nearest.1
    }

    /// How texels agree with rays through tubes.
    #[derive(Debug, Default)]
    struct Agreement {
        texels: f64,
        covered: [f64; 2],
        same: f64,
        height_error: f64,
        rate_error: f64,
        rate: f64,
    }

    /// Texels of a slant and view beside rays as another slant has them.
    fn agreement(
        texture: &CoreFiber,
        yarn: &Yarn,
        table: &FiberTable,
        slant: usize,
        view: usize,
        of: usize,
    ) -> Agreement {
        const RAYS: u32 = 200;
        let arrangement = Arrangement::even(yarn, table);
        let traced = View::new(&arrangement, of, view);
        let [half_width, widening] = texture.half_width.map(f64::from);
        let half_width = half_width + widening * slant.abs_diff((SLANTS - 1) / 2) as f64;
        let compare = |ray: u32| {
            let mut random = Random::new(1000 * (slant * VIEWS + view) as u32 + ray);
            let mut pick = |count: usize| (count as f64 * random.unit()) as usize;
            let (layer, k, j) = (pick(LAYERS), pick(LENGTH), pick(WIDTH));
            let u = (k as f64 + 0.5) * TURNS as f64 / LENGTH as f64;
            let v = ((j as f64 + 0.5) / WIDTH as f64 * 2.0 - 1.0) * half_width;
            let index = (((slant * VIEWS + view) * LAYERS + layer) * LENGTH + k) * WIDTH + j;
            let (texel, rank) = (texture.texels[index], texture.ranks[index]);
            let expected = met(&traced, first_rank(layer, table.radius.len()), u, v);
            let mut found = Agreement { texels: 1.0, ..Default::default() };
            found.covered = [f64::from(u8::from(rank != NO_RANK)), f64::from(u8::from(expected.is_some()))];
            let Some(expected) = expected else {
                found.same = f64::from(u8::from(rank == NO_RANK));
                return found;
            };
            if usize::from(rank) == expected.rank {
                let [height, offset, dh, dv] = texel.map(f64::from);
                found.same = 1.0;
                found.height_error = (height - expected.height).abs();
                // As the shader has it.
                let bulge = yarn.fiber_radius * (1.0 - offset * offset).max(0.0).sqrt();
                let skewed = |h: f64, v: f64| DVec2::new(h * traced.depth + v * traced.skew, v * traced.half_width);
                let axis = skewed(height - bulge / traced.depth, v - offset * yarn.fiber_radius / traced.half_width);
                let rate = skewed(dh, dv) * traced.fiber_rate + (traced.center() + axis).perp() * traced.ply_rate;
                found.rate_error = rate.distance(expected.rate);
                found.rate = expected.rate.length();
            }
            found
        };
        (0..RAYS).into_par_iter().map(compare).reduce(Agreement::default, |a, b| Agreement {
            texels: a.texels + b.texels,
            covered: [0, 1].map(|k| a.covered[k] + b.covered[k]),
            same: a.same + b.same,
            height_error: a.height_error + b.height_error,
            rate_error: a.rate_error + b.rate_error,
            rate: a.rate + b.rate,
        })
    }

    /// In every view: at least so many texels show the same fiber, of all views together and of one; heights and rates are off by at most so much.
    struct Bounds {
        same: f64,
        same_in_view: f64,
        covered: f64,
        height: f64,
        rate: f64,
    }

    fn agree(name: &str, texture: &CoreFiber, yarn: &Yarn, table: &FiberTable, bounds: &Bounds) {
        let (mut covered, mut same, mut texels) = ([0.0; 2], 0.0, 0.0);
        for (slant, view) in (0..SLANTS).flat_map(|slant| (0..VIEWS).map(move |view| (slant, view))) {
            let found = agreement(texture, yarn, table, slant, view, slant);
            println!("{name}, slant {slant}, view {view}: {found:?}");
            let told = format!("{name}, slant {slant}, view {view}: {found:?}");
            assert!(found.same > bounds.same_in_view * found.texels, "{told}");
            assert!(found.height_error < bounds.height * found.same, "{told}");
            assert!(found.rate_error < bounds.rate * found.rate, "{told}");
            covered = [0, 1].map(|k| covered[k] + found.covered[k]);
            (same, texels) = (same + found.same, texels + found.texels);
        }
        println!("{name}: {same} of {texels}, {covered:?} covered");
        assert!(same > bounds.same * texels, "{name}: {same} of {texels}");
        assert!((covered[0] / covered[1] - 1.0).abs() < bounds.covered, "{name}: {covered:?}");
    }

    #[test]
    fn texels_show_what_rays_through_round_fibers_meet() {
        for name in PRESET_NAMES {
            let (yarn, table, texture) = texture(without_flyaways(name));
            let bounds = Bounds { same: 0.985, same_in_view: 0.94, covered: 0.005, height: 0.03, rate: 0.06 };
            agree(name, &texture, &yarn, &table, &bounds);
            // The same comparison sees rays of the opposite slant, of none, and of another view.
            for (slant, of) in [(0, 4), (1, 3), (3, 2)] {
                let wrong = agreement(&texture, &yarn, &table, slant, 3, of);
                assert!(wrong.same < 0.9 * wrong.texels, "{name}: rays of slant {of} pass as {slant}: {wrong:?}");
            }
        }
    }

    /// Hairs bend by more than a row is long: within it their direction changes.
    #[test]
    fn texels_show_loops_and_hairs_where_rays_meet_them() {
        for name in ["cotton-2", "rayon-1", "silk-2"] {
            let (yarn, table, texture) = texture(Yarn::preset(name).expect(name));
            let bounds = Bounds { same: 0.985, same_in_view: 0.94, covered: 0.006, height: 0.03, rate: 0.18 };
            agree(name, &texture, &yarn, &table, &bounds);
        }
    }

    #[test]
    fn a_view_and_its_slant_are_those_of_the_other_edge_turned_over() {
        // Half a turn about the direction to the viewer's section makes the one of the other, rows and columns backwards: as much is covered, as near.
        let (_, _, texture) = texture(without_flyaways("cotton-2"));
        let mean = |slant: usize, view: usize| {
            let of_view = LAYERS * LENGTH * WIDTH;
            let texels = &texture.texels[(slant * VIEWS + view) * of_view..][..LENGTH * WIDTH];
            let seen = texels.iter().filter(|texel| texel[0] > HOLE);
            let (count, sum) = seen.fold((0.0, 0.0), |(count, sum), t| (count + 1.0, sum + f64::from(t[0])));
            [count / (LENGTH * WIDTH) as f64, sum / count]
        };
        for (slant, view) in [(0, 0), (0, 1), (0, 2), (1, 0)] {
            let [a, b] = [mean(slant, view), mean(SLANTS - 1 - slant, VIEWS - 1 - view)];
            println!("slant {slant}, view {view}: {a:?}, turned {b:?}");
            assert!((a[0] / b[0] - 1.0).abs() < 0.005 && (a[1] - b[1]).abs() < 0.02, "{a:?}, {b:?}");
        }
        // The opposite slant of the same view is another picture.
        let [a, b] = [mean(0, 0), mean(SLANTS - 1, 0)];
        assert!((a[0] / b[0] - 1.0).abs() > 0.05 && (a[1] - b[1]).abs() > 0.1, "{a:?}, {b:?}");
    }
}
