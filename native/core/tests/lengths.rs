//! Length coordinates of the rest yarn.

mod support;

use glam::DVec3;
use lisle_core::{Basis, Curves, Error, KnotMode, Nurbs, Yarns};
use std::f64::consts::TAU;
use support::{bcc, point, sampled, single};

fn circle(count: usize) -> Vec<[f32; 3]> {
    sampled(count, |i| {
        let t = TAU * i / count as f64;
        DVec3::new(2.0 * t.cos(), 2.0 * t.sin(), 1.0)
    })
}

fn wave(count: usize) -> Vec<[f32; 3]> {
    sampled(count, |i| DVec3::new(0.3 * i, (0.4 * i).sin(), 0.0))
}

#[test]
fn a_circle() {
    let yarns = Yarns::new(single(circle(100), true), Some(0.1)).expect("valid");
    let strands = yarns.strands();
    assert!((strands.total_lengths()[0] / (2.0 * TAU) - 1.0).abs() < 1e-5);
    for (k, length) in strands.lengths().iter().enumerate() {
        assert!((length - 2.0 * TAU * k as f64 / 100.0).abs() < 1e-4);
        assert_eq!(yarns.length_coordinates()[k], *length as f32);
    }
}

#[test]
fn they_stay_with_the_rest_shape() {
    let rest = Yarns::new(single(circle(100), true), Some(0.1)).expect("valid");
    let grown: Vec<_> = circle(100).iter().map(|p| p.map(|x| 3.0 * x)).collect();
    let now = rest.with_points(&grown).expect("same count");
    assert_eq!(now.length_coordinates(), rest.length_coordinates());
    assert_eq!(now.strands().total_lengths(), rest.strands().total_lengths());
    assert_eq!(now.points(), grown);
    assert_eq!(now.rest_points(), rest.points());
}

fn bases() -> Vec<(Basis, bool)> {
    let nurbs = |order| Basis::Nurbs(Box::new(Nurbs { order, weights: None, knots: KnotMode::Normal }));
    [false, true]
        .into_iter()
        .flat_map(|closed| {
            [Basis::CatmullRom, Basis::Linear, Basis::BSpline, Basis::Bezier, nurbs(3), nurbs(4)].map(|b| (b, closed))
        })
        .collect()
}

#[test]
fn every_basis_starts_at_zero_and_increases() {
    for (basis, closed) in bases() {
        let points = if closed { circle(30) } else { wave(31) };
        let yarns = Yarns::new(Curves::of_basis(vec![points.clone(), points], closed, basis.clone()), Some(0.1))
            .expect("valid");
        let strands = yarns.strands();
        for curve in 0..2 {
            let knots = strands.offsets()[curve] as usize..strands.offsets()[curve + 1] as usize;
            let lengths = &strands.lengths()[knots];
            assert_eq!(lengths[0], 0.0);
            assert!(lengths.windows(2).all(|w| w[0] < w[1]), "{basis:?}");
            let (last, total) = (lengths[lengths.len() - 1], strands.total_lengths()[curve]);
            assert!(if closed { last < total } else { last == total }, "{basis:?}: {last} of {total}");
            let points = yarns.offsets()[curve] as usize..yarns.offsets()[curve + 1] as usize;
            let coordinates = &yarns.length_coordinates()[points];
            assert_eq!(coordinates[0], 0.0, "{basis:?}");
            assert!(coordinates.windows(2).all(|w| w[0] <= w[1]), "{basis:?}: {coordinates:?}");
            assert!(f64::from(coordinates[29]) > 0.9 * total && f64::from(coordinates[29]) <= total * (1.0 + 1e-6));
        }
    }
}

#[test]
fn their_own_coordinates_change_nothing() {
    for (basis, closed) in bases() {
        let points = if closed { circle(30) } else { wave(31) };
        let yarns = Yarns::new(Curves::of_basis(vec![points], closed, basis.clone()), Some(0.1)).expect("valid");
        let again = yarns.with_length_coordinates(yarns.length_coordinates()).expect("valid coordinates");
        for (a, b) in yarns.strands().lengths().iter().zip(again.strands().lengths()) {
            assert!((a - b).abs() < 1e-5, "{basis:?}: {a} became {b}");
        }
        let (a, b) = (yarns.strands().total_lengths()[0], again.strands().total_lengths()[0]);
        assert!((a / b - 1.0).abs() < 1e-6, "{basis:?}: {a} became {b}");
        assert_eq!(again.length_coordinates(), yarns.length_coordinates());
    }
}

#[test]
fn stored_coordinates_count() {
    let yarns = Yarns::new(single(wave(4), false), Some(0.1)).expect("valid");
    let stored = yarns.with_length_coordinates(&[1.0, 2.0, 2.0, 5.0]).expect("valid coordinates");
    assert_eq!(stored.strands().lengths(), [1.0, 2.0, 2.0, 5.0]);
    assert_eq!(stored.strands().total_lengths(), [5.0]);
    let moved = stored.with_points(&wave(4)).expect("same count");
    assert_eq!(moved.strands().lengths(), [1.0, 2.0, 2.0, 5.0]);
    // A resampled curve: knots between control points lie between their coordinates, here twice the length.
    let line = Curves::of_basis(vec![wave(31)], false, Basis::Linear);
    let yarns = Yarns::new(line, Some(0.1)).expect("valid");
    let doubled: Vec<f32> = yarns.length_coordinates().iter().map(|s| 2.0 * s).collect();
    let stored = yarns.with_length_coordinates(&doubled).expect("valid coordinates");
    for (a, b) in yarns.strands().lengths().iter().zip(stored.strands().lengths()) {
        assert!((2.0 * a - b).abs() < 1e-5);
    }
}

#[test]
fn bad_coordinates_are_refused() {
    let yarns = Yarns::new(Curves::catmull_rom(vec![wave(3), wave(4)], false), Some(0.1)).expect("valid");
    let refused = |c: &[f32]| yarns.with_length_coordinates(c).expect_err("bad coordinates");
    assert!(matches!(refused(&[0.0; 5]), Error::ArrayLength { expected: 7, found: 5, .. }));
    let at = |e: Error| match e {
        Error::LengthCoordinate { curve, index, .. } => (curve, index),
        other => panic!("{other}"),
    };
    assert_eq!(at(refused(&[0.0, 1.0, 2.0, 0.0, 1.0, f32::NAN, 3.0])), (1, 2));
    assert_eq!(at(refused(&[0.0, 1.0, f32::INFINITY, 0.0, 1.0, 2.0, 3.0])), (0, 2));
    assert_eq!(at(refused(&[0.0, 1.0, 2.0, 0.0, 1.0, 0.5, 3.0])), (1, 2));
    assert_eq!(at(refused(&[0.0, 1.0, 2.0, 4.0, 4.0, 4.0, 4.0])), (1, 3));
}

#[test]
fn real_yarn_has_its_known_length() {
    // Lengths of the polylines through the control points, computed by a separate reader.
    for (name, polyline) in [("glove.bcc", 13_918.8), ("openwork_trellis_pattern.bcc", 2_734.7)] {
        let Some(curves) = bcc(name) else { return };
        let edge = |a: usize, b: usize| point(curves.points[a]).distance(point(curves.points[b]));
        let edges = |i: usize| (curves.range(i).start + 1..curves.range(i).end).map(|k| edge(k - 1, k)).sum::<f64>();
        let open: f64 = (0..curves.len()).map(edges).sum();
        assert!((open / polyline - 1.0).abs() < 1e-5, "{name}: {open}");
        // The curve through the points is a little longer.
        let yarns = Yarns::new(curves, None).expect("valid");
        let total: f64 = yarns.strands().total_lengths().iter().sum();
        assert!((1.0..1.03).contains(&(total / polyline)), "{name}: {total}");
    }
}
