//! Input that cannot be drawn gives an error that names curve, index and reason; input that can be drawn is.

mod support;

use glam::DVec3;
use lisle_core::{Basis, Curves, Error, KnotMode, Nurbs, Yarns};
use support::sampled;

fn line(count: usize) -> Vec<[f32; 3]> {
    sampled(count, |i| DVec3::new(0.1 * i, 0.0, 0.0))
}

fn two_curves() -> Curves {
    Curves::catmull_rom(vec![line(4), line(5)], false)
}

fn refused(curves: Curves) -> Error {
    Yarns::new(curves, Some(0.1)).expect_err("this cannot be drawn")
}

/// The error's message has all these parts.
fn says(error: &Error, parts: &[&str]) {
    let message = error.to_string();
    for part in parts {
        assert!(message.contains(part), "{message:?} lacks {part:?}");
    }
}

#[test]
fn points_that_are_not_finite() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e20] {
        let mut curves = two_curves();
        curves.points[6][1] = value;
        let error = refused(curves);
        assert!(matches!(error, Error::Point { curve: 1, index: 2, .. }), "{error}");
        says(&error, &["curve 1", "point 2", "finite"]);
        let rest = Yarns::new(two_curves(), Some(0.1)).expect("valid");
        let mut points = two_curves().points;
        points[3][2] = value;
        assert!(matches!(rest.with_points(&points), Err(Error::Point { curve: 0, index: 3, .. })));
    }
}

#[test]
fn radii() {
    for (value, index) in [(f32::NAN, 2), (f32::INFINITY, 0), (-0.5, 4)] {
        let mut curves = two_curves();
        let mut radii = vec![0.1; 9];
        radii[4 + index] = value;
        curves.radii = Some(radii);
        let error = Yarns::new(curves, None).expect_err("a bad radius");
        assert!(matches!(error, Error::Radius { curve: 1, index: i, .. } if i == index), "{error}");
    }
    for value in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(Yarns::new(two_curves(), Some(value)), Err(Error::YarnRadius { .. })));
    }
}

#[test]
fn zero_radii_are_tips_unless_all_are_zero() {
    let mut curves = two_curves();
    curves.radii = Some(vec![0.0, 0.1, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let error = Yarns::new(curves.clone(), None).expect_err("a curve without radius");
    says(&error, &["curve 1", "point 0", "zero"]);
    curves.radii = Some(vec![0.0, 0.1, 0.2, 0.0, 0.0, 0.5, 0.5, 0.5, 0.0]);
    let yarns = Yarns::new(curves, None).expect("tips are fine");
    let tip = lisle_core::strands::ZERO_RADIUS * 0.2;
    assert_eq!(yarns.strands().radii()[..4], [tip, 0.1, 0.2, tip]);
}

#[test]
fn offsets() {
    for (offsets, index, reason) in [
        (vec![1, 4, 9], 0, "first"),
        (vec![0, 9, 4], 2, "less than the 9"),
        (vec![0, 4, 8], 2, "number of points, 9"),
        (vec![0, 12, 9], 2, "less than the 12"),
    ] {
        let mut curves = two_curves();
        curves.offsets = offsets;
        let error = refused(curves);
        assert!(matches!(error, Error::Offsets { index: i, .. } if i == index), "{error}");
        says(&error, &[reason]);
    }
}

#[test]
fn too_few_points() {
    assert!(matches!(refused(Curves::catmull_rom(vec![], false)), Error::NoCurves));
    let mut none = two_curves();
    none.offsets.clear();
    assert!(matches!(refused(none), Error::NoCurves));
    let nurbs = || Basis::Nurbs(Box::new(Nurbs { order: 4, weights: None, knots: KnotMode::Normal }));
    for (basis, closed, count) in [
        (Basis::CatmullRom, false, 0),
        (Basis::CatmullRom, false, 1),
        (Basis::CatmullRom, true, 2),
        (Basis::Linear, false, 1),
        (Basis::BSpline, false, 3),
        (Basis::BSpline, true, 2),
        (Basis::Bezier, false, 5),
        (Basis::Bezier, true, 7),
        (nurbs(), false, 3),
        (nurbs(), true, 3),
    ] {
        let error = refused(Curves::of_basis(
            vec![line(10)[..if closed { 9 } else { 10 }].to_vec(), line(count)],
            closed,
            basis,
        ));
        assert!(matches!(error, Error::PointCount { curve: 1, points, .. } if points == count), "{error}");
        assert!(error.to_string().contains(if closed { "; a closed " } else { "; an open " }), "{error}");
    }
}

#[test]
fn bad_nurbs() {
    let case = |order, weights, knots| {
        let basis = Basis::Nurbs(Box::new(Nurbs { order, weights, knots }));
        let mut curves = Curves::catmull_rom(vec![line(4), line(5)], false);
        curves.basis[1] = basis;
        refused(curves)
    };
    let uniform = |n: i32| (0..n).map(f64::from).collect::<Vec<_>>();
    let mut falling = uniform(9);
    falling[5] = 3.5;
    let mut infinite = uniform(9);
    infinite[8] = f64::INFINITY;
    for (error, reason) in [
        (case(1, None, KnotMode::Normal), "order 1"),
        (case(0, None, KnotMode::Normal), "order 0"),
        (case(4, Some(vec![1.0; 4]), KnotMode::Normal), "4 weights"),
        (case(4, Some(vec![1.0, 1.0, 0.0, 1.0, 1.0]), KnotMode::Normal), "weight 2"),
        (case(4, None, KnotMode::Explicit(uniform(8))), "8 knots, expected 9"),
        (case(4, None, KnotMode::Explicit(falling)), "knot 5 is 3.5"),
        (case(4, None, KnotMode::Explicit(infinite)), "knot 8 is inf"),
        (case(4, None, KnotMode::Explicit(vec![1.0; 9])), "no domain"),
    ] {
        assert!(matches!(error, Error::Nurbs { curve: 1, .. }), "{error}");
        says(&error, &["curve 1", reason]);
    }
}

#[test]
fn arrays_of_other_lengths() {
    let wrong = |change: fn(&mut Curves)| {
        let mut curves = two_curves();
        change(&mut curves);
        Yarns::new(curves, None).expect_err("a wrong length")
    };
    says(&wrong(|c| c.closed = vec![false]), &["closed", "1", "expected 2"]);
    says(&wrong(|c| c.basis.clear()), &["basis", "0", "expected 2"]);
    says(&wrong(|c| c.radii = Some(vec![0.1; 8])), &["radii", "8", "expected 9"]);
}

#[test]
fn coincident_points() {
    let error = refused(Curves::catmull_rom(vec![line(4), vec![[1.0, 2.0, 3.0]; 6]], false));
    assert!(matches!(error, Error::Coincident { curve: 1, points: 6 }), "{error}");
    let mut points = line(6);
    points[3] = points[2];
    for basis in [Basis::CatmullRom, Basis::Linear, Basis::BSpline] {
        for closed in [false, true] {
            let yarns =
                Yarns::new(Curves::of_basis(vec![points.clone()], closed, basis.clone()), Some(0.1)).expect("valid");
            assert!(yarns.strands().normals().iter().flatten().all(|x| x.is_finite()));
        }
    }
}

#[test]
fn the_point_count_changes() {
    let yarns = Yarns::new(two_curves(), Some(0.1)).expect("valid");
    // Curves of four and five points.
    for (count, curve, index) in [(0, 0, 0), (3, 0, 3), (4, 1, 0), (8, 1, 4), (10, 1, 5)] {
        let error = yarns.with_points(&line(count)).expect_err("another count");
        let Error::PointCountChanged { curve: c, index: i, old: 9, new } = error else { panic!("{error}") };
        assert_eq!((c, i, new), (curve, index, count), "{error}");
        says(
            &error,
            &[&format!("curve {curve}, point {index}"), "9 in the rest shape", &format!("{count} in this frame")],
        );
    }
}

#[test]
fn far_from_the_origin() {
    // A million metres away f32 points lie on a grid of 1/16 m: this coil is exactly on it, so all else is exact.
    let coil = |offset: f64| {
        sampled(200, |i| {
            let p = DVec3::new(0.125 * i, 4.0 * (0.3 * i).cos(), 4.0 * (0.3 * i).sin());
            (p * 16.0).round() / 16.0 + offset
        })
    };
    let near = Yarns::new(Curves::catmull_rom(vec![coil(0.0)], false), None).expect("valid");
    let far = Yarns::new(Curves::catmull_rom(vec![coil(1e6)], false), None).expect("valid");
    assert_eq!(near.radii(), far.radii());
    for k in 0..200 {
        assert!((near.strands().lengths()[k] - far.strands().lengths()[k]).abs() < 1e-8);
    }
    assert_eq!(near.strands().normals(), far.strands().normals());
}

#[test]
fn ten_million_points() {
    let count = 10_000_000;
    let points = sampled(count, |i| DVec3::new(1e-3 * i, (0.1 * i).cos(), (0.1 * i).sin()));
    let start = std::time::Instant::now();
    let rest = Yarns::new(Curves::catmull_rom(vec![points], false), None).expect("valid");
    let made = start.elapsed();
    let points: Vec<_> = rest.points().iter().map(|p| [p[0], 1.1 * p[1], p[2]]).collect();
    let start = std::time::Instant::now();
    let now = rest.with_points(&points).expect("same count");
    assert_eq!(now.strands().normals().len(), count);
    println!("10 million points: rest {made:?}, a frame {:?}", start.elapsed());
    // Linear in the points: a quadratic step would take hours.
    assert!(made.as_secs() < 120 && start.elapsed().as_secs() < 60);
}
