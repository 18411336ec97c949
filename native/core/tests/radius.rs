//! The yarn radius of curves that come without one.

mod support;

use lisle_core::{Basis, Curves, Yarns};
use support::{bcc, sampled};

fn estimated(curves: Curves) -> f32 {
    let yarns = Yarns::new(curves, None).expect("valid curves");
    assert!(yarns.radii().iter().all(|r| *r == yarns.radii()[0]));
    yarns.radii()[0]
}

#[test]
fn yarn_models_have_about_a_tenth() {
    for name in ["openwork_trellis_pattern", "flame_ribbing_pattern", "glove", "alien_sweater", "sweater_flame_ribbing"]
    {
        let Some(curves) = bcc(&format!("{name}.bcc")) else { return };
        let radius = estimated(curves);
        assert!((0.085..0.11).contains(&radius), "{name}: {radius}");
    }
}

/// Parallel strands at a distance of 0.3; every tenth runs through its neighbour.
fn parallel(points: usize, edge: f64, basis: Basis) -> Curves {
    let strand = |i: usize| {
        let y = 0.3 * i as f64 - if i % 10 == 9 { 0.29 } else { 0.0 };
        sampled(points, |k| glam::DVec3::new(edge * k, y, 0.0))
    };
    Curves::of_basis((0..40).map(strand).collect(), false, basis)
}

#[test]
fn parallel_strands_touch() {
    for basis in [Basis::CatmullRom, Basis::Linear, Basis::BSpline, Basis::Bezier] {
        let radius = estimated(parallel(31, 0.2, basis.clone()));
        assert!((radius - 0.15).abs() < 1e-3, "{basis:?}: {radius}");
    }
    // Edges much longer than the distance.
    let radius = estimated(parallel(4, 5.0, Basis::CatmullRom));
    assert!((radius - 0.15).abs() < 1e-3, "{radius}");
}

#[test]
fn one_coil_touches_itself() {
    // Pitch 0.2, turns of radius 1: neighbouring turns are other stretches, the two sides of a turn are not closer.
    let coil = |i: f64| {
        let t = std::f64::consts::TAU * i / 64.0;
        glam::DVec3::new(0.2 * i / 64.0, t.cos(), t.sin())
    };
    let radius = estimated(Curves::catmull_rom(vec![sampled(2000, coil)], false));
    assert!((radius - 0.1).abs() < 2e-3, "{radius}");
}

#[test]
fn a_lone_strand_gets_a_quarter_of_its_segments() {
    let straight = |i: f64| glam::DVec3::new(0.4 * i, 0.0, 0.0);
    assert!((estimated(Curves::catmull_rom(vec![sampled(10, straight)], false)) - 0.1).abs() < 1e-6);
    let two = vec![[0.0; 3], [0.0, 0.0, 3.0]];
    assert!((estimated(Curves::catmull_rom(vec![two], false)) - 0.75).abs() < 1e-6);
}

#[test]
fn the_given_radius_wins() {
    let mut curves = parallel(5, 0.2, Basis::CatmullRom);
    curves.radii = Some(vec![0.7; curves.points.len()]);
    assert_eq!(Yarns::new(curves.clone(), None).expect("valid").radii()[3], 0.7);
    assert_eq!(Yarns::new(curves, Some(0.2)).expect("valid").radii()[3], 0.2);
}
