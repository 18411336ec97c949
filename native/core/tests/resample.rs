//! Curves of other bases as Catmull-Rom knots.

mod support;

use glam::DVec3;
use lisle_core::strands::TOLERANCE;
use lisle_core::{Basis, Curves, KnotMode, Nurbs, Strands, Yarns};
use support::{Noise, point, sampled};

const RADIUS: f32 = 0.1;

/// A ring with waves in and across its plane.
fn ring(count: usize) -> Vec<[f32; 3]> {
    sampled(count, |i| {
        let t = std::f64::consts::TAU * i / count as f64;
        let r = 2.0 + 0.4 * (4.0 * t).cos();
        DVec3::new(r * t.cos(), r * t.sin(), 0.4 * (5.0 * t).sin())
    })
}

fn rough(count: usize) -> Vec<[f32; 3]> {
    let mut noise = Noise(3);
    ring(count).iter().map(|p| (point(*p) + 0.3 * noise.vector()).as_vec3().to_array()).collect()
}

fn nurbs(order: usize, count: usize, knots: KnotMode) -> Basis {
    let weights = (0..count).map(|i| 1.0 + (i % 3) as f32).collect();
    Basis::Nurbs(Box::new(Nurbs { order, weights: Some(weights), knots }))
}

fn cases() -> Vec<(String, Curves)> {
    let mut cases = Vec::new();
    for closed in [false, true] {
        for (shape, points) in [("ring", ring(48)), ("coarse ring", ring(18)), ("rough", rough(24))] {
            let count = points.len();
            let bezier = if closed { count / 3 * 3 } else { (count - 1) / 3 * 3 + 1 };
            for (basis, count) in [
                (Basis::BSpline, count),
                (Basis::Linear, count),
                (Basis::Bezier, bezier),
                (nurbs(3, count, KnotMode::Endpoint), count),
                (nurbs(5, count, KnotMode::Normal), count),
                (nurbs(4, count / 3 * 3, KnotMode::EndpointBezier), count / 3 * 3),
            ] {
                let name = format!("{shape}, closed {closed}, {basis:?}").chars().take(60).collect();
                cases.push((name, Curves::of_basis(vec![points[..count].to_vec()], closed, basis)));
            }
        }
    }
    cases
}

/// Points of the drawn curve: `steps` per segment of the first strand.
fn drawn(strands: &Strands, steps: usize) -> Vec<DVec3> {
    let points = strands.positions().to_vec();
    let curves = Curves::catmull_rom(vec![points], strands.closed()[0]);
    exact(&curves, steps)
}

fn exact(curves: &Curves, steps: usize) -> Vec<DVec3> {
    let curve = curves.curve(0);
    (0..curve.segment_count() * steps)
        .map(|i| curve.position(i / steps, (i % steps) as f64 / steps as f64))
        .chain([curve.position(curve.segment_count() - 1, 1.0)])
        .collect()
}

/// Largest distance from points of `a` to the polyline through `b`.
fn deviation(a: &[DVec3], b: &[DVec3]) -> f64 {
    let to_edge = |p: DVec3, k: usize| {
        let (from, edge) = (b[k], b[k + 1] - b[k]);
        let t = if edge == DVec3::ZERO { 0.0 } else { ((p - from).dot(edge) / edge.length_squared()).clamp(0.0, 1.0) };
        p.distance_squared(from + t * edge)
    };
    let nearest = |&p: &DVec3| (0..b.len() - 1).map(|k| to_edge(p, k)).fold(f64::INFINITY, f64::min);
    a.iter().map(nearest).fold(0.0, f64::max).sqrt()
}

#[test]
fn drawn_curves_stay_within_the_tolerance() {
    for (name, curves) in cases() {
        let yarns = Yarns::new(curves.clone(), Some(RADIUS)).expect("valid curves");
        let strands = yarns.strands();
        let (drawn, exact) = (drawn(strands, 6), exact(&curves, 100));
        let allowed = TOLERANCE * f64::from(RADIUS);
        // The tolerance is kept at three places of each interval; between them it can be a little more.
        let found = deviation(&drawn, &exact).max(deviation(&exact, &drawn));
        println!(
            "{name}: {} points, {} knots, {:.3} of the tolerance",
            curves.points.len(),
            drawn.len() / 6,
            found / allowed
        );
        assert!(found < 1.2 * allowed, "{name}: {found}");
    }
}

#[test]
fn without_refinement_the_tolerance_is_exceeded() {
    let curves = Curves::of_basis(vec![rough(40)], false, Basis::Linear);
    let through_points = Curves::catmull_rom(vec![rough(40)], false);
    let found = deviation(&exact(&through_points, 8), &exact(&curves, 100));
    assert!(found > 2.0 * TOLERANCE * f64::from(RADIUS), "{found}");
}

#[test]
fn neighbouring_intervals_are_alike() {
    for (name, curves) in cases() {
        let yarns = Yarns::new(curves, Some(RADIUS)).expect("valid curves");
        let knots = yarns.strands().positions();
        let edges: Vec<f64> = knots.windows(2).map(|w| point(w[0]).distance(point(w[1]))).collect();
        for (k, pair) in edges.windows(2).enumerate() {
            let ratio = pair[0].max(pair[1]) / pair[0].min(pair[1]).max(TOLERANCE * f64::from(RADIUS));
            assert!(ratio < 2.01, "{name}: {ratio} at knot {k}");
        }
    }
}

#[test]
fn catmull_rom_points_are_the_knots() {
    let yarns = Yarns::new(Curves::catmull_rom(vec![rough(40), ring(20)], false), Some(RADIUS)).expect("valid");
    assert_eq!(yarns.strands().positions(), yarns.points());
    assert_eq!(yarns.strands().positions().as_ptr(), yarns.points().as_ptr(), "shared, not copied");
}

#[test]
fn knots_follow_the_motion_of_the_points() {
    // An affine motion of the control points moves every knot likewise, for every basis.
    let motion = |p: DVec3| DVec3::new(p.x + 0.2 * p.y, 0.9 * p.y - 0.1 * p.z, p.z + 0.5);
    for (name, curves) in cases() {
        let moved: Vec<_> = curves.points.iter().map(|p| motion(point(*p)).as_vec3().to_array()).collect();
        let rest = Yarns::new(curves, Some(RADIUS)).expect("valid curves");
        let now = rest.with_points(&moved).expect("same count");
        for (a, b) in rest.strands().positions().iter().zip(now.strands().positions()) {
            assert!(motion(point(*a)).distance(point(*b)) < 1e-5, "{name}");
        }
        assert!(std::ptr::eq(rest.strands().lengths(), now.strands().lengths()), "{name}: lengths are shared");
    }
}

#[test]
fn radii_are_blended() {
    let mut curves = Curves::of_basis(vec![ring(13)], false, Basis::Bezier);
    curves.radii = Some((0..13).map(|i| 0.1 + 0.01 * i as f32).collect());
    let yarns = Yarns::new(curves, None).expect("valid curves");
    let radii = yarns.strands().radii();
    assert_eq!(radii[0], 0.1);
    assert!((radii[radii.len() - 1] - 0.22).abs() < 1e-6);
    assert!(radii.windows(2).all(|w| w[0] < w[1]));
    assert!((yarns.strands().reference_radii()[0] - 0.16).abs() < 1e-6);
}

#[test]
fn a_hopeless_radius_ends_at_the_cap() {
    let points = 300;
    let curves = Curves::of_basis(vec![rough(points)], false, Basis::Linear);
    let yarns = Yarns::new(curves, Some(1e-12)).expect("valid curves");
    let knots = yarns.strands().positions().len();
    assert!(knots <= lisle_core::strands::MAX_KNOTS_PER_SEGMENT * points, "{knots}");
}
