//! Evaluation of every basis against closed forms and finite differences, and arc length.

mod support;

use glam::DVec3;
use lisle_core::{Basis, Curves, KnotMode, Nurbs};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use support::{Noise, point};

fn noisy(count: usize, closed: bool, basis: Basis, seed: u64) -> Curves {
    let mut noise = Noise(seed);
    let points = (0..count).map(|_| noise.vector().as_vec3().to_array()).collect();
    let curves = Curves::of_basis(vec![points], closed, basis);
    curves.validate().expect("valid");
    curves
}

fn nurbs(order: usize, weights: Option<Vec<f32>>, knots: KnotMode) -> Basis {
    Basis::Nurbs(Box::new(Nurbs { order, weights, knots }))
}

/// One curve of each kind, open and closed.
fn all_kinds() -> Vec<(String, Curves)> {
    let mut kinds = Vec::new();
    for closed in [false, true] {
        let bezier = if closed { 12 } else { 13 };
        for (basis, count) in [(Basis::CatmullRom, 9), (Basis::BSpline, 9), (Basis::Linear, 9), (Basis::Bezier, bezier)]
        {
            kinds.push((format!("{basis:?} closed {closed}"), noisy(count, closed, basis, 7)));
        }
        for mode in [KnotMode::Normal, KnotMode::Endpoint, KnotMode::Bezier, KnotMode::EndpointBezier] {
            for order in 2..=6 {
                let count = 4 * (order - 1);
                let weights = (0..count).map(|i| 1.0 + 0.3 * (i % 4) as f32).collect();
                let basis = nurbs(order, Some(weights), mode.clone());
                kinds.push((format!("NURBS {order} {mode:?} closed {closed}"), noisy(count, closed, basis, 9)));
            }
        }
    }
    kinds
}

#[test]
fn derivatives_match_differences() {
    for (name, curves) in all_kinds() {
        let curve = curves.curve(0);
        for segment in 0..curve.segment_count() {
            for t in [0.1, 0.37, 0.5, 0.83] {
                let h = 1e-4;
                let [before, at, after] = [t - h, t, t + h].map(|t| curve.jet(segment, t));
                let first = (after.position - before.position) / (2.0 * h);
                let second = (after.first - before.first) / (2.0 * h);
                let scale = 1.0 + at.second.length();
                assert!(first.distance(at.first) < 1e-5 * scale, "{name}: first derivative");
                assert!(second.distance(at.second) < 1e-4 * scale, "{name}: second derivative");
            }
        }
    }
}

#[test]
fn segments_join() {
    for (name, curves) in all_kinds() {
        let curve = curves.curve(0);
        let n = curve.segment_count();
        let joints = if curve.closed() { n } else { n - 1 };
        for segment in 0..joints {
            let (end, start) = (curve.position(segment, 1.0), curve.position((segment + 1) % n, 0.0));
            assert!(end.distance(start) < 1e-12, "{name}: segment {segment}");
        }
    }
}

#[test]
fn interpolating_bases_pass_through_their_points() {
    for closed in [false, true] {
        for (basis, stride) in [(Basis::CatmullRom, 1), (Basis::Linear, 1), (Basis::Bezier, 3)] {
            let curves = noisy(if stride == 1 { 8 } else { 9 + usize::from(!closed) }, closed, basis, 3);
            let curve = curves.curve(0);
            for segment in 0..curve.segment_count() {
                assert!(curve.position(segment, 0.0).distance(point(curves.points[stride * segment])) < 1e-15);
            }
        }
    }
}

#[test]
fn catmull_rom_reflects_its_ends() {
    let curves = noisy(5, false, Basis::CatmullRom, 4);
    let [p0, p1] = [0, 1].map(|i| point(curves.points[i]));
    // The phantom point 2 p0 - p1 makes the end tangent the first chord, and the curvature there depend on p2.
    assert!(curves.curve(0).jet(0, 0.0).first.distance(p1 - p0) < 1e-15);
    let two = Curves::catmull_rom(vec![vec![[1.0, 2.0, 3.0], [3.0, 2.0, 3.0]]], false);
    for t in [0.0, 0.25, 0.8, 1.0] {
        assert!(two.curve(0).position(0, t).distance(DVec3::new(1.0 + 2.0 * t, 2.0, 3.0)) < 1e-15);
    }
}

#[test]
fn nurbs_reproduce_the_uniform_bases() {
    // Order 4, uniform knots: the B-spline, one control point later when closed.
    for closed in [false, true] {
        let (spline, rational) =
            (noisy(9, closed, Basis::BSpline, 5), noisy(9, closed, nurbs(4, None, KnotMode::Normal), 5));
        let (a, b) = (spline.curve(0), rational.curve(0));
        assert_eq!(a.segment_count(), b.segment_count());
        for segment in 0..a.segment_count() {
            let same = if closed { (segment + 1) % 9 } else { segment };
            assert!(a.position(same, 0.3).distance(b.position(segment, 0.3)) < 1e-14);
        }
    }
    // Order 4, Bézier knots with clamped ends: the Bézier spline. Order 2: the polyline.
    for (uniform, mode, order, count) in
        [(Basis::Bezier, KnotMode::EndpointBezier, 4, 10), (Basis::Linear, KnotMode::Endpoint, 2, 10)]
    {
        let (exact, rational) = (noisy(count, false, uniform, 6), noisy(count, false, nurbs(order, None, mode), 6));
        let (a, b) = (exact.curve(0), rational.curve(0));
        assert_eq!(a.segment_count(), b.segment_count());
        for segment in 0..a.segment_count() {
            assert!(a.position(segment, 0.7).distance(b.position(segment, 0.7)) < 1e-14);
        }
    }
}

#[test]
fn blender_knot_vectors() {
    // Values computed by hand from Blender's documented multiplicities.
    for (mode, order, points, closed, expected) in [
        (KnotMode::Normal, 3, 5, false, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]),
        (KnotMode::Endpoint, 3, 5, false, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]),
        (KnotMode::Bezier, 3, 5, false, vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0]),
        (KnotMode::EndpointBezier, 3, 5, false, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]),
        (KnotMode::Normal, 3, 4, true, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]),
        (KnotMode::Endpoint, 3, 4, true, vec![0.0, 1.0, 1.0, 2.0, 3.0, 4.0, 4.0, 5.0, 6.0]),
    ] {
        let by_mode = noisy(points, closed, nurbs(order, None, mode.clone()), 8);
        let by_hand = noisy(points, closed, nurbs(order, None, KnotMode::Explicit(expected)), 8);
        let (a, b) = (by_mode.curve(0), by_hand.curve(0));
        assert_eq!(a.segment_count(), b.segment_count(), "{mode:?}");
        for segment in 0..a.segment_count() {
            assert!(a.position(segment, 0.4).distance(b.position(segment, 0.4)) < 1e-15, "{mode:?}");
        }
    }
}

/// A circle of radius 1 in four rational quadratic arcs.
fn circle() -> Curves {
    let w = FRAC_1_SQRT_2 as f32;
    let points = [[1., 0.], [1., 1.], [0., 1.], [-1., 1.], [-1., 0.], [-1., -1.], [0., -1.], [1., -1.], [1., 0.]];
    let knots = vec![0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0];
    let weights = (0..9).map(|i| if i % 2 == 0 { 1.0 } else { w }).collect();
    let basis = nurbs(3, Some(weights), KnotMode::Explicit(knots));
    Curves::of_basis(vec![points.map(|[x, y]: [f32; 2]| [x, y, 0.0]).to_vec()], false, basis)
}

fn length(curves: &Curves) -> f64 {
    let curve = curves.curve(0);
    (0..curve.segment_count()).map(|s| curve.length(s, 0.0, 1.0)).sum()
}

/// Length of a polyline through many points of the curve, with its error of second order removed by extrapolation.
fn brute_length(curves: &Curves) -> f64 {
    let curve = curves.curve(0);
    let polyline = |steps: usize| -> f64 {
        (0..curve.segment_count())
            .map(|s| {
                let at = |i: usize| curve.position(s, i as f64 / steps as f64);
                (0..steps).map(|i| at(i).distance(at(i + 1))).sum::<f64>()
            })
            .sum()
    };
    let (coarse, fine) = (polyline(2000), polyline(4000));
    fine + (fine - coarse) / 3.0
}

#[test]
fn a_rational_circle_is_round_and_two_pi_long() {
    let curves = circle();
    let curve = curves.curve(0);
    for segment in 0..4 {
        for i in 0..=10 {
            // The weight is an f32: it carries 6e-8 of error.
            assert!((curve.position(segment, f64::from(i) / 10.0).length() - 1.0).abs() < 1e-7);
        }
    }
    assert!((length(&curves) / TAU - 1.0).abs() < 1e-7);
}

#[test]
fn closed_forms_of_length() {
    // A parabola y = x² from 0 to 1 as a cubic Bézier.
    let third = 1.0 / 3.0;
    let parabola = vec![[0.0, 0.0, 0.0], [third, 0.0, 0.0], [2.0 * third, third, 0.0], [1.0, 1.0, 0.0]];
    let exact = 0.5 * 5f64.sqrt() + 0.25 * 2f64.asinh();
    assert!((length(&Curves::of_basis(vec![parabola], false, Basis::Bezier)) / exact - 1.0).abs() < 1e-7);
    // The semicubical parabola (t², t³) has a cusp in the middle of its segment.
    let cusp = vec![[1.0, -1.0, 0.0], [-third, 1.0, 0.0], [-third, -1.0, 0.0], [1.0, 1.0, 0.0]];
    let exact = 2.0 * (13f64.powf(1.5) - 8.0) / 27.0;
    assert!((length(&Curves::of_basis(vec![cusp], false, Basis::Bezier)) / exact - 1.0).abs() < 1e-6);
    let polyline = vec![[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 12.0]];
    assert!((length(&Curves::of_basis(vec![polyline], false, Basis::Linear)) / 17.0 - 1.0).abs() < 1e-15);
}

#[test]
fn lengths_match_brute_force() {
    for (name, curves) in all_kinds() {
        let (found, expected) = (length(&curves), brute_length(&curves));
        assert!((found / expected - 1.0).abs() < 1e-5, "{name}: {found} is not {expected}");
    }
    // Sharp turns, near cusps and very uneven points.
    let mut noise = Noise(11);
    for _ in 0..200 {
        let points: Vec<_> =
            (0..6).map(|_| (noise.vector() * (10.0 * noise.next()).exp2()).as_vec3().to_array()).collect();
        let curves = Curves::catmull_rom(vec![points], false);
        let (found, expected) = (length(&curves), brute_length(&curves));
        assert!((found / expected - 1.0).abs() < 1e-5, "{:?}: {found} is not {expected}", curves.points);
    }
}

#[test]
fn the_length_comparison_can_fail() {
    let mut curves = circle();
    let exact = brute_length(&curves);
    curves.points[1][0] += 1e-3;
    assert!((length(&curves) / exact - 1.0).abs() > 1e-5);
}

#[test]
fn radii_blend_like_positions() {
    for (name, mut curves) in all_kinds() {
        let radii: Vec<f32> = curves.points.iter().map(|p| p[1]).collect();
        curves.radii = None;
        let curve = curves.curve(0);
        for segment in 0..curve.segment_count() {
            let y = curve.position(segment, 0.6).y;
            assert!((curve.blend(segment, 0.6, &radii) - y).abs() < 1e-14, "{name}");
        }
    }
}
