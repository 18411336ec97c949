//! Cloth that holds together: yarns interlock, and do not intersect.

use crate::cell::POINTS_PER_STITCH;
use crate::distance::{Polyline, closest_approach, tightest_bend};
use crate::{Error, FlatPatch, Knit, Pattern, Sleeve, Stitch, Surface, Tube, YARN_RADIUS_M};
use glam::{DVec2, DVec3};
use lisle_core::curve::Curves;
use std::f64::consts::PI;

fn patterns() -> [(&'static str, Pattern); 5] {
    [
        ("stockinette", Pattern::stockinette()),
        ("garter", Pattern::garter()),
        ("1x1 rib", Pattern::rib(1, 1).expect("a rib")),
        ("2x2 rib", Pattern::rib(2, 2).expect("a rib")),
        ("moss", Pattern::from_chart("kp pk").expect("a chart")),
    ]
}

fn flat(knit: &Knit) -> FlatPatch {
    FlatPatch { size_m: knit.size_m() }
}

fn yarns_in_radii(curves: &Curves) -> Vec<Polyline> {
    (0..curves.len())
        .map(|curve| {
            let points = curves.points[curves.range(curve)].iter();
            let control: Vec<DVec3> = points.map(|p| DVec3::from(p.map(f64::from)) / YARN_RADIUS_M).collect();
            Polyline::from_catmull_rom(&control, curves.closed[curve], 10)
        })
        .collect()
}

/// The closest approach and the tightest bend, in yarn radii. A yarn that never bends tighter than its own radius
/// cannot meet itself within π radii of yarn, so together the two say whether anything intersects.
fn closest_and_tightest(curves: &Curves) -> (f64, f64) {
    let yarns = yarns_in_radii(curves);
    let closest = closest_approach(&yarns, 3.0, PI).expect("yarns of one cloth come near each other");
    (closest, yarns.iter().map(tightest_bend).fold(f64::INFINITY, f64::min))
}

#[test]
fn flat_cloth_is_tight_and_does_not_intersect() {
    for (name, pattern) in patterns() {
        let knit = Knit::flat(&pattern, 8, 8, YARN_RADIUS_M).expect("cloth");
        let (closest, tightest) = closest_and_tightest(&knit.swatch(&flat(&knit)).expect("a swatch"));
        let [wale, course, thickness] = knit.gauge();
        println!(
            "{name}: closest {closest:.4}, bend {tightest:.3}, wale {wale:.3}, course {course:.3}, thickness {thickness:.3}"
        );
        assert!(closest >= 2.0, "{name}: centre lines come within {closest} radii");
        assert!(closest < 2.02, "{name}: loose, the nearest centre lines are {closest} radii apart");
        assert!(tightest >= 1.0, "{name}: bends with radius {tightest}");
    }
}

#[test]
fn tubes_do_not_intersect() {
    for (name, pattern) in patterns() {
        for wales in [24, 48] {
            let knit = Knit::round(&pattern, 6, wales, YARN_RADIUS_M).expect("cloth");
            let tube = Tube { radius_m: knit.tube_radius_m(), height_m: knit.size_m().y };
            let (closest, tightest) = closest_and_tightest(&knit.swatch(&tube).expect("a tube"));
            assert!(closest >= 2.0, "{name}, {wales} wales: centre lines come within {closest} radii");
            assert!(tightest >= 1.0, "{name}, {wales} wales: bends with radius {tightest}");
        }
    }
}

#[test]
fn a_surface_too_small_for_the_cloth_makes_it_intersect() {
    for (name, pattern) in patterns() {
        let knit = Knit::flat(&pattern, 6, 4, YARN_RADIUS_M).expect("cloth");
        let small = FlatPatch { size_m: 0.97 * knit.size_m() };
        let (closest, _) = closest_and_tightest(&knit.swatch(&small).expect("a swatch"));
        assert!(closest < 2.0, "{name}: {closest}");
    }
}

/// Linking number of two closed polygons: half the sum of the signs of their crossings, seen along −z.
fn linking_number(a: &[DVec3], b: &[DVec3]) -> i32 {
    let edges = |polygon: &[DVec3]| -> Vec<[DVec3; 2]> {
        (0..polygon.len()).map(|i| [polygon[i], polygon[(i + 1) % polygon.len()]]).collect()
    };
    let mut twice = 0;
    for [p, q] in edges(a) {
        for [r, s] in edges(b) {
            let (u, v, w) = (q - p, s - r, r - p);
            let turn = u.truncate().perp_dot(v.truncate());
            let along_a = w.truncate().perp_dot(v.truncate()) / turn;
            let along_b = w.truncate().perp_dot(u.truncate()) / turn;
            if (0.0..1.0).contains(&along_a) && (0.0..1.0).contains(&along_b) {
                let a_is_above = (p + u * along_a).z > (r + v * along_b).z;
                twice += if (turn > 0.0) == a_is_above { 1 } else { -1 };
            }
        }
    }
    assert_eq!(twice % 2, 0, "closed curves cross an even number of times");
    twice / 2
}

#[test]
fn linking_numbers_of_rings() {
    let ring = |centre: DVec3, x: DVec3, y: DVec3| -> Vec<DVec3> {
        let angle = |i: i32| 0.1 + f64::from(i) * PI / 20.0;
        (0..40).map(|i| centre + x * angle(i).cos() + y * angle(i).sin()).collect()
    };
    let (x, y, tilted) = (DVec3::X, DVec3::Y, DVec3::new(0.3, 0.2, 1.0));
    let flat = ring(DVec3::ZERO, x, y);
    let through = ring(x, x, tilted);
    assert_eq!(linking_number(&flat, &through).abs(), 1);
    assert_eq!(linking_number(&flat, &ring(x, tilted, x)), -linking_number(&flat, &through));
    assert_eq!(linking_number(&flat, &ring(3.0 * x, x, tilted)), 0);
    assert_eq!(linking_number(&flat, &ring(x + 5.0 * DVec3::Z, x, tilted)), 0);
}

/// How each leg of the loop at (course + 1, wale) passes through the loop at (course, wale): the linking number of the
/// two, where the loop below is closed across its open foot and the leg by a detour behind the cloth.
fn legs_through_loop(courses: &[Vec<DVec3>], course: usize, wale: usize) -> [i32; 2] {
    let n = POINTS_PER_STITCH;
    let start = wale * n;
    // Without its outermost points, which belong to the sinker arcs that it shares with its neighbours.
    let below = &courses[course][start + 2..=start + n - 2];
    let above = &courses[course + 1];
    let pass = |leg: &[DVec3]| {
        let behind = |point: DVec3| DVec3::new(point.x, point.y, -100.0);
        let mut polygon = leg.to_vec();
        polygon.extend([behind(leg[leg.len() - 1]), behind(leg[0])]);
        linking_number(below, &polygon)
    };
    [pass(&above[start..=start + n / 2]), pass(&above[start + n / 2..=start + n])]
}

/// The control points of a flat swatch, course by course: x to the right, y up, z to the front.
fn courses_of(knit: &Knit) -> Vec<Vec<DVec3>> {
    let curves = knit.swatch(&flat(knit)).expect("a swatch");
    let to_front = |p: &[f32; 3]| DVec3::new(f64::from(p[0]), f64::from(p[2]), -f64::from(p[1]));
    (0..curves.len()).map(|curve| curves.points[curves.range(curve)].iter().map(to_front).collect()).collect()
}

#[test]
fn every_loop_is_pulled_through_the_loop_below() {
    for (name, pattern) in patterns() {
        let (courses, wales) = (6, 8);
        let knit = Knit::flat(&pattern, courses, wales, YARN_RADIUS_M).expect("cloth");
        let points = courses_of(&knit);
        for course in 0..courses - 1 {
            for wale in 0..wales {
                // In on one leg and out on the other; a knit stitch comes out at the front, a purl stitch at the back.
                let expected = match pattern.stitch(course + 1, wale) {
                    Stitch::Knit => [-1, 1],
                    Stitch::Purl => [1, -1],
                };
                let found = legs_through_loop(&points, course, wale);
                assert_eq!(found, expected, "{name}, loop ({}, {wale})", course + 1);
            }
        }
    }
}

#[test]
fn courses_that_only_lie_on_each_other_do_not_pass_for_interlocked() {
    let knit = Knit::flat(&Pattern::stockinette(), 2, 3, YARN_RADIUS_M).expect("cloth");
    let mut points = courses_of(&knit);
    for point in &mut points[1] {
        point.z += 0.02;
    }
    for wale in 0..3 {
        assert_eq!(legs_through_loop(&points, 0, wale), [0, 0]);
    }
}

#[test]
fn knit_and_purl_are_each_others_back() {
    let knit = courses_of(&Knit::flat(&Pattern::stockinette(), 3, 3, YARN_RADIUS_M).expect("cloth"));
    let purl = courses_of(&Knit::flat(&Pattern::from_chart("p").expect("purl"), 3, 3, YARN_RADIUS_M).expect("cloth"));
    for (a, b) in knit.iter().flatten().zip(purl.iter().flatten()) {
        assert!(a.distance(DVec3::new(b.x, b.y, -b.z)) < 1e-6 * YARN_RADIUS_M, "{a} {b}");
    }
}

#[test]
fn cloth_keeps_its_points_from_frame_to_frame() {
    let knit = Knit::flat(&Pattern::stockinette(), 10, 12, YARN_RADIUS_M).expect("cloth");
    let patch = flat(&knit);
    let rest = knit.swatch(&patch).expect("a swatch");
    assert_eq!(rest.points.len(), knit.point_count());
    assert_eq!(rest.points.len(), 10 * (12 * POINTS_PER_STITCH + 1));
    rest.validate().expect("drawable curves");
    // A rigid motion of the surface carries every point along.
    let turn = glam::DAffine3::from_rotation_translation(
        glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7),
        DVec3::new(0.1, 0.2, -0.3),
    );
    let moved = knit.points_on(&|u, v| turn.transform_point3(patch.position(u, v))).expect("points");
    for (a, b) in rest.points.iter().zip(&moved) {
        let expected = turn.transform_point3(DVec3::from(a.map(f64::from)));
        assert!(expected.distance(DVec3::from(b.map(f64::from))) < 1e-6);
    }
    // A wave moves no point farther than its amplitude and the tilt of the normals allow.
    let wave = |u: f64, v: f64| patch.position(u, v) + DVec3::Y * (0.003 * (9.0 * u).sin());
    let waved = knit.points_on(&wave).expect("points");
    assert_eq!(waved.len(), moved.len());
    for (a, b) in rest.points.iter().zip(&waved) {
        assert!(DVec3::from(a.map(f64::from)).distance(DVec3::from(b.map(f64::from))) < 0.005);
    }
}

#[test]
fn the_same_cloth_is_made_every_time() {
    let make = || {
        let knit = Knit::flat(&Pattern::rib(2, 2).expect("a rib"), 3, 4, YARN_RADIUS_M).expect("cloth");
        knit.swatch(&flat(&knit)).expect("a swatch")
    };
    assert_eq!(make(), make());
}

#[test]
fn a_bent_sleeve_keeps_its_courses_closed_round_the_arm() {
    let knit = Knit::round(&Pattern::rib(2, 2).expect("a rib"), 40, 40, YARN_RADIUS_M).expect("cloth");
    let arm = [DVec3::ZERO, DVec3::new(0.0, 0.0, 0.08), DVec3::new(0.06, 0.0, 0.14)];
    let sleeve = Sleeve::new(&arm, knit.tube_radius_m(), DVec3::NEG_Y).expect("a sleeve");
    let curves = knit.swatch(&sleeve).expect("cloth on the sleeve");
    curves.validate().expect("drawable curves");
    for curve in 0..curves.len() {
        let points = &curves.points[curves.range(curve)];
        let step = |i: usize| {
            let [a, b] = [i, (i + 1) % points.len()].map(|k| DVec3::from(points[k].map(f64::from)));
            a.distance(b)
        };
        let longest = (0..points.len() - 1).map(step).fold(0.0, f64::max);
        assert!(step(points.len() - 1) < 1.1 * longest, "curve {curve} has a gap where it closes");
    }
}

#[test]
fn impossible_cloth_is_refused_by_name() {
    let rib = Pattern::rib(2, 2).expect("a rib");
    let error = |result: Result<Knit, Error>| result.expect_err("an error");
    assert_eq!(error(Knit::round(&rib, 5, 10, 1e-3)), Error::BrokenRound { wales: 10, columns: 4 });
    assert_eq!(error(Knit::flat(&rib, 0, 10, 1e-3)), Error::EmptyCloth { courses: 0, wales: 10 });
    assert_eq!(error(Knit::flat(&rib, 1, 1, -1.0)), Error::YarnRadius { value_m: -1.0 });
    assert!(matches!(error(Knit::flat(&rib, 1, 1, f64::NAN)), Error::YarnRadius { .. }));
    let (courses, wales) = (1 << 40, 1 << 40);
    assert_eq!(error(Knit::flat(&rib, courses, wales, 1e-3)), Error::TooManyPoints { courses, wales });

    let knit = Knit::flat(&rib, 8, 4, 1e-3).expect("cloth");
    // Later courses are refused sooner; the error is the first course's.
    let folded = |_: f64, v: f64| {
        std::thread::sleep(std::time::Duration::from_millis(if v < 0.1 { 10 } else { 0 }));
        DVec3::new(0.0, 0.0, v)
    };
    let refused = knit.points_on(&folded);
    assert!(matches!(refused, Err(Error::Surface { yarn: 0, index: 0, .. })), "{refused:?}");
    assert!(knit.points_on(&FlatPatch { size_m: DVec2::ONE }).is_ok());
}
