//! A generated garment, for benchmarks: as many control points as wanted, on a body of fixed size.

use crate::cell::POINTS_PER_STITCH;
use crate::knit::Knit;
use crate::pattern::Pattern;
use crate::surface::Sleeve;
use crate::{Error, YARN_RADIUS_M};
use glam::DVec3;
use lisle_core::curve::Curves;

/// The body's section: two half circles of this radius in metres, joined by straight sides of that length.
const BODY_END_RADIUS_M: f64 = 0.13;
const BODY_SIDE_M: f64 = 0.20;
const BODY_HEIGHT_M: f64 = 0.62;
const SLEEVE_RADIUS_M: f64 = 0.062;
/// The left sleeve from shoulder to wrist; the right one is its mirror image.
const ARM_M: [[f64; 3]; 5] =
    [[0.24, 0.0, 0.53], [0.33, 0.0, 0.44], [0.41, -0.01, 0.31], [0.45, -0.05, 0.18], [0.46, -0.12, 0.07]];
const LEAST_POINTS: usize = 20_000;

/// A sweater's body and two sleeves of stockinette, all courses closed, in metres: at most `points` control points,
/// and nearly as many. The sweater keeps its size; more points mean thinner yarn (0.6 mm at 2 M points).
///
/// # Errors
/// [`Error::CoarseGarment`] below 20,000 points.
pub fn sweater(points: usize) -> Result<Curves, Error> {
    if points < LEAST_POINTS {
        return Err(Error::CoarseGarment { points, least: LEAST_POINTS });
    }
    let pattern = Pattern::stockinette();
    let sleeves = [1.0, -1.0].map(|side| {
        let arm = ARM_M.map(|[x, y, z]| DVec3::new(side * x, y, z));
        Sleeve::new(&arm, SLEEVE_RADIUS_M, DVec3::NEG_Y)
    });
    let [left, right] = sleeves;
    let (left, right) = (left?, right?);
    let body_width_m = std::f64::consts::TAU * BODY_END_RADIUS_M + 2.0 * BODY_SIDE_M;
    let sleeve_width_m = std::f64::consts::TAU * SLEEVE_RADIUS_M;

    // Stitches of the cloth's own proportions: so many per metre that their number is what was asked for.
    let [wale, course, _] = Knit::flat(&pattern, 1, 1, YARN_RADIUS_M)?.gauge();
    let area_m2 = body_width_m * BODY_HEIGHT_M + 2.0 * sleeve_width_m * left.length_m();
    let radius_m = (area_m2 * POINTS_PER_STITCH as f64 / (points as f64 * wale * course)).sqrt();
    let stitches = |width_m: f64, height_m: f64| {
        [(height_m / (course * radius_m)) as usize, (width_m / (wale * radius_m)) as usize]
    };
    let [body_courses, body_wales] = stitches(body_width_m, BODY_HEIGHT_M);
    let [sleeve_courses, sleeve_wales] = stitches(sleeve_width_m, left.length_m());
    let body = Knit::round(&pattern, body_courses, body_wales, radius_m)?.swatch(&body_position)?;
    let sleeve = Knit::round(&pattern, sleeve_courses, sleeve_wales, radius_m)?;
    let mut garment = body;
    for surface in [left, right] {
        append(&mut garment, sleeve.swatch(&surface)?);
    }
    Ok(garment)
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
    use super::*;

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
}
