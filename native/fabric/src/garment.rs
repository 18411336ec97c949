//! A generated garment, for benchmarks: as many control points as wanted, on a body of fixed size.

use crate::Error;
use crate::cell::POINTS_PER_STITCH;
use crate::knit::Knit;
use crate::pattern::Pattern;
use crate::surface::Sleeve;
use glam::DVec3;
use lisle_core::curve::Curves;
use std::f64::consts::TAU;

/// The body's section: two half circles of this radius in metres, joined by straight sides of that length.
const BODY_END_RADIUS_M: f64 = 0.13;
const BODY_SIDE_M: f64 = 0.20;
const BODY_HEIGHT_M: f64 = 0.62;
const SLEEVE_RADIUS_M: f64 = 0.062;
/// Where an arm begins beside the body, pointing aside; how long it is, and by how much it turns downwards.
const SHOULDER_HEIGHT_M: f64 = 0.53;
const ARM_LENGTH_M: f64 = 0.56;
const ARM_TURN_DEG: f64 = 60.0;
/// Steps between the points of its centre line. At either end its bend grows evenly over so many: a Catmull-Rom curve exceeds its points' bend
/// by as much as that changes from step to step.
const ARM_STEPS: usize = 40;
const ARM_RAMP: usize = 8;
/// From the body's yarn to the sleeves', in yarn radii.
const GAP: f64 = 1.0;
const LEAST_POINTS: usize = 20_000;

/// A sweater's body and two sleeves of stockinette, all courses closed, in metres: at most `points` control points,
/// and nearly as many. The sweater keeps its size; more points mean thinner yarn (0.6 mm at 2 M points). Its yarns keep two radii apart, as in
/// [`Knit`]: sleeves begin beside the body, and have as many courses as there is room for on the inside of their bend.
///
/// # Errors
/// [`Error::CoarseGarment`] below 20,000 points.
pub fn sweater(points: usize) -> Result<Curves, Error> {
    if points < LEAST_POINTS {
        return Err(Error::CoarseGarment { points, least: LEAST_POINTS });
    }
    let pattern = Pattern::stockinette();
    let body_width_m = TAU * BODY_END_RADIUS_M + 2.0 * BODY_SIDE_M;

    // Stitches of the cloth's own proportions: so many per metre that their number is what was asked for. Yarn that is nearer to the axis has
    // less room than the surface, and a loop is higher than a course; how much depends on the yarn.
    let unit = Knit::round(&pattern, 1, 3, 1.0)?;
    let [wale, course, thickness] = unit.gauge();
    let (nearer, higher) = (unit.inner_height_m(), unit.size_m().y - course);
    let sizes = |radius_m: f64| {
        let shorter = 1.0 - (SLEEVE_RADIUS_M + thickness * radius_m) / tightest_bend_m();
        let width = |middle_m: f64| middle_m - TAU * nearer * radius_m;
        let height = |all_m: f64| all_m - higher * radius_m;
        [[width(body_width_m), height(BODY_HEIGHT_M)], [width(TAU * SLEEVE_RADIUS_M), height(ARM_LENGTH_M * shorter)]]
    };
    let mut radius_m = 0.0;
    for _ in 0..8 {
        let [body, sleeve] = sizes(radius_m).map(|[width, height]| width * height);
        radius_m = ((body + 2.0 * sleeve) * POINTS_PER_STITCH as f64 / (points as f64 * wale * course)).sqrt();
    }
    let knit = |[width_m, height_m]: [f64; 2]| {
        let wales = (width_m / (wale * radius_m)) as usize;
        Knit::round(&pattern, (height_m / (course * radius_m)) as usize, wales, radius_m)
    };
    let [body, sleeve] = sizes(radius_m).map(knit);
    let (body, sleeve) = (body?.swatch(&body_position)?, sleeve?);
    let beside_m = 0.5 * BODY_SIDE_M + BODY_END_RADIUS_M + (thickness + 2.0 + GAP) * radius_m;
    let sleeves = [1.0, -1.0].map(|side| Sleeve::new(&arm(side, beside_m), SLEEVE_RADIUS_M, DVec3::NEG_Y));
    let [left, right] = sleeves;
    let mut garment = body;
    for surface in [left?, right?] {
        append(&mut garment, sleeve.swatch(&surface)?);
    }
    Ok(garment)
}

/// How much of its full bend an arm has in the middle of a step.
fn bend(step: usize) -> f64 {
    let from_end = step.min(ARM_STEPS - 1 - step) as f64 + 0.5;
    (from_end / ARM_RAMP as f64).min(1.0)
}

/// Angle by which an arm turns in a step of full bend, radians.
fn full_turn() -> f64 {
    ARM_TURN_DEG.to_radians() / (0..ARM_STEPS).map(bend).sum::<f64>()
}

/// The tightest radius of an arm's centre line.
fn tightest_bend_m() -> f64 {
    ARM_LENGTH_M / ARM_STEPS as f64 / (full_turn() * (1.0 + 1.0 / ARM_RAMP as f64))
}

/// The centre line of an arm, which begins at a distance from the body's middle.
fn arm(side: f64, beside_m: f64) -> Vec<DVec3> {
    let mut points = vec![DVec3::new(side * beside_m, 0.0, SHOULDER_HEIGHT_M)];
    let (mut point, mut angle) = (points[0], 0.0_f64);
    for step in 0..ARM_STEPS {
        let turn = bend(step) * full_turn();
        let (sin, cos) = (angle + 0.5 * turn).sin_cos();
        point += DVec3::new(side * cos, 0.0, -sin) * (ARM_LENGTH_M / ARM_STEPS as f64);
        angle += turn;
        points.push(point);
    }
    points
}

/// The body's surface: `u` round its section at even lengths from the left side, `v` upwards.
fn body_position(u: f64, v: f64) -> DVec3 {
    use std::f64::consts::PI;
    let arc = PI * BODY_END_RADIUS_M;
    let half = arc + BODY_SIDE_M;
    let along = u.rem_euclid(1.0) * 2.0 * half;
    let (side, along) = if along < half { (1.0, along) } else { (-1.0, along - half) };
    let half_side = 0.5 * BODY_SIDE_M;
    let section = if along < arc {
        let angle = along / BODY_END_RADIUS_M - 0.5 * PI;
        [half_side + BODY_END_RADIUS_M * angle.cos(), BODY_END_RADIUS_M * angle.sin()]
    } else {
        [half_side - (along - arc), BODY_END_RADIUS_M]
    };
    DVec3::new(side * section[0], side * section[1], v * BODY_HEIGHT_M)
}

fn append(curves: &mut Curves, more: Curves) {
    let base = curves.points.len() as u32;
    curves.points.extend(more.points);
    curves.offsets.extend(more.offsets[1..].iter().map(|offset| base + offset));
    curves.closed.extend(more.closed);
    curves.basis.extend(more.basis);
    if let (Some(radii), Some(more)) = (&mut curves.radii, more.radii) {
        radii.extend(more);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::distance::{Polyline, closest_approach};

    #[test]
    fn sizes_hit_the_number_of_points_from_below() {
        for points in [LEAST_POINTS, 100_000, 2_000_000] {
            let garment = sweater(points).expect("a valid size");
            let found = garment.points.len();
            assert!(found <= points && found as f64 > 0.85 * points as f64, "{found} of {points}");
            garment.validate().expect("drawable curves");
            assert!(garment.closed.iter().all(|&closed| closed));
        }
        assert!(sweater(LEAST_POINTS - 1).is_err());
    }

    #[test]
    fn the_body_is_walked_round_at_even_speed_without_a_gap() {
        let n = 1000;
        let step =
            |i: usize| body_position(i as f64 / n as f64, 0.3).distance(body_position((i + 1) as f64 / n as f64, 0.3));
        let expected = 2.0 * (std::f64::consts::PI * BODY_END_RADIUS_M + BODY_SIDE_M) / n as f64;
        for i in 0..n {
            assert!((step(i) / expected - 1.0).abs() < 1e-4, "{i}: {} {expected}", step(i));
        }
    }

    #[test]
    fn its_yarns_keep_apart() {
        for points in [LEAST_POINTS, 60_000] {
            let garment = sweater(points).expect("a valid size");
            let radius = f64::from(garment.radii.as_ref().expect("radii")[0]);
            let yarns: Vec<Polyline> = (0..garment.len())
                .map(|curve| {
                    let points = garment.points[garment.range(curve)].iter();
                    let control: Vec<DVec3> = points.map(|p| DVec3::from(p.map(f64::from)) / radius).collect();
                    Polyline::from_catmull_rom(&control, garment.closed[curve], 8)
                })
                .collect();
            let closest = closest_approach(&yarns, 3.0, PI).expect("yarns of one cloth come near each other");
            println!("{points} points: centre lines come within {closest:.4} radii");
            assert!(closest >= 2.0, "{points} points: centre lines come within {closest} radii");
        }
    }
}
