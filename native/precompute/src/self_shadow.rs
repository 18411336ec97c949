use std::f64::consts::{PI, TAU};

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use crate::{Bundle, SectionDensity};

/// Light directions per 1/K of a turn.
const SLICES: usize = 16;
/// Texels along a side of a slice.
const SIZE: usize = 64;

/// Optical depth from every point of a yarn's section towards a light [WuYuksel2018 §4.1]: τ(q) = −ln T, with T the share of the yarn's sections in which no fiber
/// lies between q and the light ([`Bundle`]). The paper adds up densities instead, up to a factor.
///
/// A light may come at any inclination to the yarn: a cylinder is met exactly if the ray's projection on the section meets its circle, so that the path
/// in the section counts, not the longer one in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SelfShadow {
    /// Slice k has the light at angle k/slices · 2π/K in the section; slices repeat.
    pub slices: usize,
    /// Texels along x and along y; values are at texel centres.
    pub size: usize,
    /// Half side of the square a slice covers, in outer radii. Beyond it the nearest texel is right.
    pub extent: f32,
    /// Plies, K.
    pub plies: u32,
    /// τ as `[slice][y][x]`, in the section turned so that the light is at +x.
    pub optical_depth: Vec<f32>,
    /// Fibers that a ray meets per outer radius of its way, as `[y][x]` in the section itself.
    pub extinction: Vec<f32>,
    /// Fiber radius, in outer radii.
    pub fiber_radius: f32,
    /// How much more of the sky is open to a point that is seen, as `[y][x]`: texel centres at x = τ / (1 + τ) for the depth τ towards the
    /// viewer, y = √(c / (c + [`HALF_WAY`])) for the depth c that rays at right angles would have in common, by [`SelfShadow::sky_of_seen`].
    pub seen_sky: Vec<f32>,
    /// Texels along a side of `seen_sky`.
    pub seen_sky_size: usize,
    /// Radius of an opaque tube that takes as much of a light from the side as the fibers do, in outer radii. Fibers do so nearly all within it,
    /// and hardly any beyond: of the presets' light nothing goes through up to 0.6, and 65 to 82 % at 0.9.
    pub tube_radius: f32,
}

/// Directions from a point that is seen, as angles in the section, radians.
///
/// Fibers that are wound move across the section along the yarn, and a light or viewer may be along it as well: what a ray does among fibers is what it does in a section
/// that moves along with them.
#[derive(Clone, Copy, Debug)]
pub struct SeenFrom {
    /// Ways through the yarn, in a section that turns with its plies: to the light and to the viewer.
    pub ways: [f64; 2],
    /// The same across the fiber that the point lies on.
    pub across: [f64; 2],
}

impl SeenFrom {
    /// Light and viewer in the section, where nothing moves.
    pub fn in_section(psi_light: f64, psi_view: f64) -> Self {
        Self { ways: [psi_light, psi_view], across: [psi_light, psi_view] }
    }

    fn angle(&self) -> f64 {
        let [light, view] = self.across;
        2.0 * (0.5 * (light - view)).sin().abs().asin()
    }
}

/// c in the middle of the squared y axis of [`SelfShadow::seen_sky`].
pub const HALF_WAY: f64 = 0.2;
const SEEN_SKY_SIZE: usize = 32;

/// Depth that parallel rays to two places on a fiber's width have in common, as far as the light goes that both let through, if each has `depth`; [`SelfShadow::over_width_of_seen`].
///
/// At places x and y, each even on the width 2r, a fiber that covers one covers the other with a chance of 1 − |x − y| / 2r: of what lets y through,
/// e^(−|x − y| depth / 2r) lets x through, on average 2 (depth − 1 + e^−depth) / depth².
fn shared_over_width(depth: f64) -> f64 {
    // Where the difference has no digits left: to first order.
    if depth < 0.02 {
        return depth * (2.0 / 3.0);
    }
    depth + (2.0 * (depth - 1.0 + (-depth).exp()) / (depth * depth)).ln()
}

/// Depth that a ray to a light has in common with the ray to the viewer, `angle` radians from it; at most `most`. `unit` is σ r/2.
fn in_common(unit: f64, angle: f64, most: f64) -> f64 {
    let half = 0.5 * angle;
    let shared = unit * (half.tan().max(1e-6).recip() - 0.5 * PI + half);
    let most = most.max(1e-9);
    most * (1.0 - (-shared / most).exp())
}

/// Mean over all directions of what [`in_common`] lets through more. Lights farther from the viewer shine through more of the yarn: the share let
/// through falls about as cos² of half the angle, as on a lit sphere.
fn seen_sky(depth: f64, unit: f64) -> f64 {
    const STEPS: u32 = 256;
    let step = |k: u32| {
        // Steps close up towards the viewer, about whom it happens.
        let x = (f64::from(k) + 0.5) / f64::from(STEPS);
        let (angle, width) = (PI * x.powi(3), 3.0 * x * x / f64::from(STEPS));
        width * (0.5 * angle).cos().powi(2) * ((in_common(unit, angle, depth) - depth).exp() - (-depth).exp())
    };
    (0..STEPS).map(step).sum()
}

/// Half side of the square that slices cover, in outer radii: the plies and most loops.
pub(crate) const EXTENT: f64 = 1.25;

impl SelfShadow {
    /// Looks through the bundle along every slice. `resolution`, ≥ 1: times as many texels along each side, and slices.
    pub fn new(bundle: &Bundle, density: &SectionDensity, resolution: usize) -> Self {
        let (slices, size) = (resolution * SLICES, resolution * SIZE);
        let sector = TAU / f64::from(density.plies);
        let optical_depth = (0..slices)
            .into_par_iter()
            .flat_map_iter(|k| bundle.depths(sector * k as f64 / slices as f64, size, EXTENT, 1))
            .map(|depth| depth as f32)
            .collect();
        let optical_depth: Vec<f32> = optical_depth;
        let texel = |k: usize| ((k as f64 + 0.5) / size as f64 * 2.0 - 1.0) * EXTENT;
        // The first texel of a row has all fibers between it and the light.
        let taken: f64 = optical_depth.chunks_exact(size).map(|row| 1.0 - f64::from(-row[0]).exp()).sum();
        let extinction =
            (0..size * size).map(|k| density.extinction(DVec2::new(texel(k % size), texel(k / size))) as f32).collect();
        Self {
            slices,
            size,
            extent: EXTENT as f32,
            plies: density.plies,
            optical_depth,
            extinction,
            fiber_radius: density.fiber_radius as f32,
            seen_sky: (0..SEEN_SKY_SIZE * SEEN_SKY_SIZE)
                .map(|k| {
                    let at = |k: usize| (k as f64 + 0.5) / SEEN_SKY_SIZE as f64;
                    let (x, y) = (at(k % SEEN_SKY_SIZE), at(k / SEEN_SKY_SIZE).powi(2));
                    seen_sky(x / (1.0 - x), HALF_WAY * y / (1.0 - y)) as f32
                })
                .collect(),
            seen_sky_size: SEEN_SKY_SIZE,
            tube_radius: (EXTENT * taken / (size * slices) as f64) as f32,
        }
    }

    /// Optical depth towards a light for a point that a viewer sees: both directions as angles in the section, radians.
    /// Shaders have the same in `self_shadows` (`shaders/passes/lighting.wgsl`): renderer and rays through explicit fibers are both compared with this.
    ///
    /// No fiber lies between the point and the viewer, so that none is there to shade it either: what the two rays share of
    /// the depth is to be left out (the \"hot spot\" of canopies of leaves [Kuusk1991]). A fiber of radius r blocks both rays if its centre lies within r of
    /// either, which for rays at an angle 2h is an area r² (cot h − (π/2 − h)), without that of fibers which contain the point itself. At a
    /// density of σ / 2r that is σ r/2 (cot h − π/2 + h) fibers, for a σ that is even around the point; they cannot be more than either ray meets in all.
    pub fn toward_light_of_seen(&self, from: SeenFrom, q: DVec2) -> f64 {
        let [light, view] = from.ways.map(|psi| self.at(psi, q));
        light - in_common(self.unit_in_common(q), from.angle(), light.min(view))
    }

    /// Optical depth towards a light for a fiber that a viewer sees at q, for light that it takes in over its width; the same as in `self_shadows`.
    ///
    /// Such light enters on the side that faces it, not at q. Over a width that is drawn evenly, an edge is on average πr/4 before the axis, so that
    /// the mean place where light enters is πr/4 (l − v) from the mean place that is seen. Nor do the two rays share all of their way if light and viewer are in one
    /// direction: [`shared_over_width`].
    pub fn over_width_of_seen(&self, from: SeenFrom, q: DVec2) -> f64 {
        let [l, v] = from.across.map(DVec2::from_angle);
        let entry = q + 0.25 * PI * f64::from(self.fiber_radius) * (l - v);
        let (light, view) = (self.at(from.ways[0], entry), self.at(from.ways[1], q));
        light - in_common(self.unit_in_common(q), from.angle(), shared_over_width(light.min(view)))
    }

    /// Share of the sky that is open to a point that a viewer sees, above the mean over points there, seen or not; `sky_of_seen` in shaders.
    pub fn sky_of_seen(&self, psi_view: f64, q: DVec2) -> f64 {
        let (depth, unit) = (self.at(psi_view, q), self.unit_in_common(q));
        let place = DVec2::new(depth / (1.0 + depth), (unit / (unit + HALF_WAY)).sqrt());
        bilinear(&self.seen_sky, self.seen_sky_size, 1.0, 2.0 * place - 1.0)
    }

    /// σ r/2.
    fn unit_in_common(&self, q: DVec2) -> f64 {
        0.5 * bilinear(&self.extinction, self.size, f64::from(self.extent), q) * f64::from(self.fiber_radius)
    }

    /// Trilinear lookup: light at angle `psi` radians in the section, `q` in section coordinates.
    pub fn at(&self, psi: f64, q: DVec2) -> f64 {
        let turns = psi * f64::from(self.plies) / TAU;
        let z = (turns - turns.floor()) * self.slices as f64;
        let (near, z) = (z as usize % self.slices, z.fract());
        let toward_light = DMat2::from_angle(-psi) * q;
        let slice = |k: usize| {
            bilinear(&self.optical_depth[k * self.size * self.size..], self.size, f64::from(self.extent), toward_light)
        };
        slice(near) * (1.0 - z) + slice((near + 1) % self.slices) * z
    }
}

/// Bilinear lookup in a square table `[y][x]` over [−extent, extent]², clamped to its border texels.
pub(crate) fn bilinear<T: Copy + Into<f64>>(table: &[T], size: usize, extent: f64, q: DVec2) -> f64 {
    let texel = ((q / extent * 0.5 + 0.5) * size as f64 - 0.5).clamp(DVec2::ZERO, DVec2::splat((size - 1) as f64));
    let (x, y) = ((texel.x as usize).min(size - 2), (texel.y as usize).min(size - 2));
    let (fx, fy) = (texel.x - x as f64, texel.y - y as f64);
    let at = |dx: usize, dy: usize| -> f64 { table[(y + dy) * size + x + dx].into() };
    (at(0, 0) * (1.0 - fx) + at(1, 0) * fx) * (1.0 - fy) + (at(0, 1) * (1.0 - fx) + at(1, 1) * fx) * fy
}

#[cfg(test)]
mod tests {
    use lisle_core::yarn::{PRESET_NAMES, Yarn};

    use super::*;
    use crate::explicit::{Random, SectionFiber, Sections, without_flyaways};

    fn yarn(name: &str) -> Yarn {
        Yarn::preset(name).expect(name)
    }

    fn table_of(yarn: &Yarn) -> SelfShadow {
        SelfShadow::new(&Bundle::of(yarn), &SectionDensity::new(yarn), 1)
    }

    const BINS: usize = 5;

    /// Worst difference between predicted and true mean transmittance: rays sorted by prediction into [`BINS`] bins, then of all rays.
    fn errors(yarn: &Yarn, predict: impl Fn(f64, DVec2) -> f64) -> (f64, f64) {
        let (dealer, mut random) = (Sections::of(yarn), Random::new(5));
        let radius = yarn.fiber_radius / yarn.outer_radius();
        let mut bins = [(0.0, 0.0, 0.0); BINS];
        for _ in 0..4000 {
            let fibers = dealer.draw(&mut random);
            for _ in 0..40 {
                let q = DVec2::from_angle(TAU * random.unit()) * random.unit().sqrt();
                let psi = TAU * random.unit();
                let light = DVec2::from_angle(psi);
                if fibers.iter().any(|fiber| fiber.holds(q, radius)) {
                    continue; // Inside a fiber: nothing to shade.
                }
                let blocked = fibers.iter().any(|fiber| fiber.blocks(q, light, radius));
                let predicted = predict(psi, q);
                let bin = &mut bins[((predicted * BINS as f64) as usize).min(BINS - 1)];
                *bin = (bin.0 + predicted, bin.1 + f64::from(u8::from(!blocked)), bin.2 + 1.0);
            }
        }
        let worst = bins.iter().map(|(p, t, n)| (p - t).abs() / n).fold(0.0, f64::max);
        let sum = bins.iter().fold((0.0, 0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2));
        (worst, (sum.0 - sum.1).abs() / sum.2)
    }

    /// A bin holds at least 1000 rays, in clusters of a section: three standard errors. All rays: the same.
    const BOUNDS: (f64, f64) = (0.04, 0.008);

    fn within_bounds((worst, mean): (f64, f64)) -> bool {
        worst < BOUNDS.0 && mean < BOUNDS.1
    }

    #[test]
    fn transmittance_is_that_of_rays_through_explicit_fibers() {
        for name in PRESET_NAMES {
            let full = Yarn::preset(name).expect(name);
            for (kind, yarn) in [("bare", without_flyaways(&full)), ("with flyaways", full)] {
                let table = table_of(&yarn);
                let error = errors(&yarn, |psi, q| (-table.at(psi, q)).exp());
                println!("{name} {kind}: bins within {:.4}, mean within {:.4}", error.0, error.1);
                assert!(within_bounds(error), "{name} {kind}: {error:?}");
            }
        }
    }

    #[test]
    fn wrong_optical_depths_are_rejected_by_the_same_rays() {
        let yarn = Yarn::preset("cotton-1").expect("preset");
        let table = table_of(&yarn);
        let skipped = 0.25 * PI * f64::from(table.fiber_radius);
        let bare = table_of(&without_flyaways(&yarn));
        assert!(!within_bounds(errors(&yarn, |psi, q| (-0.8 * table.at(psi, q)).exp())), "too thin");
        assert!(!within_bounds(errors(&yarn, |psi, q| (-1.25 * table.at(psi, q)).exp())), "too thick");
        let from_q = |psi: f64, q: DVec2| (-table.at(psi, q - DVec2::from_angle(psi) * skipped)).exp();
        assert!(!within_bounds(errors(&yarn, from_q)), "fibers around the point itself");
        assert!(!within_bounds(errors(&yarn, |psi, q| (-table.at(-psi, q)).exp())), "mirrored light");
        assert!(!within_bounds(errors(&yarn, |psi, q| (-bare.at(psi, q)).exp())), "without flyaways");
    }

    /// Light that reaches points which a viewer sees, for several angles between light and viewer: (angle, true mean, predicted mean).
    fn seen(yarn: &Yarn, predict: impl Fn(&Seen) -> f64) -> Vec<(f64, f64, f64)> {
        seen_from(yarn, &[0.0, 5.0, 15.0, 30.0, 60.0, 90.0, 130.0, 180.0], 1500, predict)
    }

    /// Every 4° of a turn, around the viewer's own direction.
    const SKY_DEG: [f64; 90] = {
        let mut angles = [0.0; 90];
        let mut k = 0;
        while k < 90 {
            angles[k] = 4.0 * k as f64 + 2.0;
            k += 1;
        }
        angles
    };

    fn seen_from(
        yarn: &Yarn,
        angles_deg: &[f64],
        sections: u32,
        predict: impl Fn(&Seen) -> f64,
    ) -> Vec<(f64, f64, f64)> {
        lit_fibers(yarn, angles_deg, sections, predict, |rays, light| rays.is_open(rays.met, light, 0.0))
    }

    /// As [`seen`], of light that a fiber takes in evenly over its width, as its lobes do: rays leave from its rim towards the light, and none
    /// that contain their start hinder them.
    fn over_width(
        yarn: &Yarn,
        angles_deg: &[f64],
        sections: u32,
        predict: impl Fn(&Seen) -> f64,
    ) -> Vec<(f64, f64, f64)> {
        lit_fibers(yarn, angles_deg, sections, predict, |rays, light| {
            let across = light.perp() * rays.place + light * (1.0 - rays.place * rays.place).sqrt();
            rays.is_open(rays.fibers[rays.own].center + rays.radius * across, light, rays.radius)
        })
    }

    /// Fibers of a section, and where a viewer meets the nearest of them.
    struct Rays<'a> {
        fibers: &'a [SectionFiber],
        radius: f64,
        own: usize,
        met: DVec2,
        /// Even on (−1, 1): a place on a fiber's width.
        place: f64,
    }

    impl Rays<'_> {
        /// Whether no other fiber lies towards a light, but those nearer than a distance.
        fn is_open(&self, from: DVec2, light: DVec2, beyond: f64) -> bool {
            !self.fibers.iter().enumerate().any(|(k, fiber)| {
                let w = fiber.center - from;
                let is_hit = w.dot(light) > 0.0 && w.perp_dot(light).abs() < self.radius;
                k != self.own && is_hit && w.length() > beyond
            })
        }
    }

    /// For each angle between light and viewer: the angle, the share of seen fibers for which the light is open, and the mean prediction.
    fn lit_fibers(
        yarn: &Yarn,
        angles_deg: &[f64],
        sections: u32,
        predict: impl Fn(&Seen) -> f64,
        is_open: impl Fn(&Rays, DVec2) -> bool,
    ) -> Vec<(f64, f64, f64)> {
        let (dealer, mut random) = (Sections::of(yarn), Random::new(6));
        let radius = yarn.fiber_radius / yarn.outer_radius();
        let mut sums = vec![(0.0, 0.0, 0.0); angles_deg.len()];
        for _ in 0..sections {
            let fibers = dealer.draw(&mut random);
            for _ in 0..20 {
                let psi = TAU * random.unit();
                let view = DVec2::from_angle(psi);
                let ray = view.perp() * (2.0 * random.unit() - 1.0);
                let place = 2.0 * random.unit() - 1.0;
                // The fiber nearest to the viewer, as a circle.
                let met = fibers.iter().enumerate().filter_map(|(k, fiber)| {
                    let offset = (fiber.center - ray).dot(view.perp());
                    let half = radius * radius - offset * offset;
                    (half > 0.0).then(|| (k, (fiber.center - ray).dot(view) + half.sqrt()))
                });
                let Some((own, depth)) = met.max_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
                let rays = Rays { fibers: &fibers, radius, own, met: ray + view * depth, place };
                for (angle, sum) in angles_deg.iter().zip(&mut sums) {
                    let psi_light = psi + angle.to_radians();
                    let open = is_open(&rays, DVec2::from_angle(psi_light));
                    let predicted = predict(&Seen { q: rays.met, psi_view: psi, psi_light });
                    *sum = (sum.0 + f64::from(u8::from(open)), sum.1 + predicted, sum.2 + 1.0);
                }
            }
        }
        angles_deg.iter().zip(sums).map(|(a, s)| (*a, s.0 / s.2, s.1 / s.2)).collect()
    }

    /// At most 0.021, of over a million rays: of one yarn, whose few fibers keep their places, what is behind one that is seen is not the mean of all that is there.
    const CLOSE: f64 = 0.024;

    const WIDTH_DEG: [f64; 9] = [0.0, 5.0, 15.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0];

    #[test]
    fn fibers_that_are_seen_take_in_as_much_light_over_their_width_as_explicit_fibers_leave_them() {
        let mut worst_point = 0.0_f64;
        for name in PRESET_NAMES {
            let yarn = without_flyaways(&Yarn::preset(name).expect(name));
            let table = table_of(&yarn);
            let found = over_width(&yarn, &WIDTH_DEG, 6000, |s| {
                (-table.over_width_of_seen(SeenFrom::in_section(s.psi_light, s.psi_view), s.q)).exp()
            });
            for (angle, expected, predicted) in found {
                println!(
                    "{name}, light {angle}° from the viewer: {expected:.3} of the light, {predicted:.3} predicted"
                );
                assert!((predicted - expected).abs() < CLOSE, "{name}, {angle}°: {predicted} for {expected}");
            }
            // What is right for the point that is seen is rejected.
            let point = over_width(&yarn, &WIDTH_DEG, 6000, |s| {
                (-table.toward_light_of_seen(SeenFrom::in_section(s.psi_light, s.psi_view), s.q)).exp()
            });
            worst_point = point.iter().map(|(_, e, p)| (e - p).abs()).fold(worst_point, f64::max);
        }
        assert!(worst_point > 0.1, "{worst_point}");
    }

    struct Seen {
        q: DVec2,
        psi_view: f64,
        psi_light: f64,
    }

    #[test]
    fn points_that_are_seen_are_as_lit_as_explicit_fibers_leave_them() {
        let mut worst_mean = 0.0_f64;
        for name in PRESET_NAMES {
            let yarn = without_flyaways(&Yarn::preset(name).expect(name));
            let table = table_of(&yarn);
            let found = seen(&yarn, |s| {
                (-table.toward_light_of_seen(SeenFrom::in_section(s.psi_light, s.psi_view), s.q)).exp()
            });
            for (angle, expected, predicted) in found {
                println!(
                    "{name}, light {angle}° from the viewer: {expected:.3} of the light, {predicted:.3} predicted"
                );
                assert!((predicted - expected).abs() < CLOSE, "{name}, {angle}°: {predicted} for {expected}");
            }
            // The mean over all points, seen or not, is rejected.
            let mean = seen(&yarn, |s| (-table.at(s.psi_light, s.q)).exp());
            worst_mean = mean.iter().map(|(_, e, p)| (e - p).abs()).fold(worst_mean, f64::max);
        }
        assert!(worst_mean > 0.3, "{worst_mean}");
    }

    #[test]
    fn points_that_are_seen_have_as_much_sky_as_explicit_fibers_leave_them() {
        for name in PRESET_NAMES {
            let yarn = without_flyaways(&Yarn::preset(name).expect(name));
            let (table, occlusion) = (table_of(&yarn), crate::Occlusion::new(&Bundle::of(&yarn), 1));
            // Lights all around at even angles are the sky.
            let mean = |predict: &dyn Fn(&Seen) -> f64| {
                let found = seen_from(&yarn, &SKY_DEG, 100, predict);
                let count = found.len() as f64;
                (found.iter().map(|f| f.1).sum::<f64>() / count, found.iter().map(|f| f.2).sum::<f64>() / count)
            };
            let (expected, predicted) = mean(&|s| (occlusion.at(s.q) + table.sky_of_seen(s.psi_view, s.q)).min(1.0));
            let (_, plain) = mean(&|s| occlusion.at(s.q));
            println!("{name}: {expected:.3} of the sky, {predicted:.3} predicted, {plain:.3} for all points");
            assert!((predicted - expected).abs() < 0.02, "{name}: {predicted} for {expected}");
            assert!((plain - expected).abs() > 0.02, "{name}: the mean over all points passes too");
        }
    }

    #[test]
    fn lookups_stay_within_their_bound_between_slices_and_texels() {
        for name in PRESET_NAMES {
            let (bundle, table) = (Bundle::of(&yarn(name)), table_of(&yarn(name)));
            let mut random = Random::new(2);
            let (mut worst, mut square) = (0.0_f64, 0.0);
            const DIRECTIONS: u32 = 40;
            const COUNT: u32 = 100;
            const FINE: usize = 256;
            for _ in 0..DIRECTIONS {
                let psi = TAU * random.unit();
                let fine = bundle.depths(psi, FINE, EXTENT, 1);
                for _ in 0..COUNT {
                    let q = DVec2::from_angle(TAU * random.unit()) * random.unit().sqrt();
                    let depth = bilinear(&fine, FINE, EXTENT, DVec2::from_angle(-psi).rotate(q));
                    let error = ((-depth).exp() - (-table.at(psi, q)).exp()).abs();
                    worst = worst.max(error);
                    square += error * error / f64::from(DIRECTIONS * COUNT);
                }
            }
            println!("{name}: lookups within {worst:.4}, RMS {:.4}", square.sqrt());
            assert!(worst < 0.15 && square.sqrt() < 0.012, "{name}: {worst} {}", square.sqrt());
        }
    }

    #[test]
    fn slices_repeat_with_the_plies() {
        let table = table_of(&yarn("silk-1"));
        let q = DVec2::new(0.2, -0.1);
        let turn = TAU / 3.0;
        let turned = DMat2::from_angle(turn) * q;
        assert!((table.at(0.4, q) - table.at(0.4 + turn, turned)).abs() < 1e-9);
        assert!((table.at(-0.0, q) - table.at(TAU, q)).abs() < 1e-9);
    }
}
