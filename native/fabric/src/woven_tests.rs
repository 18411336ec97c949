//! Woven cloth that holds together: yarns interlace as the weave says, and do not intersect.

use crate::distance::{Polyline, closest_approach, tightest_bend};
use crate::{Error, FlatPatch, SPACING, Surface, Weave, Woven, YARN_RADIUS_M};
use glam::{DVec2, DVec3};
use lisle_core::curve::Curves;
use std::f64::consts::PI;

fn weaves() -> [(&'static str, Weave); 7] {
    [
        ("plain", Weave::plain()),
        ("2/2 twill", Weave::twill(2, 2).expect("a twill")),
        ("3/1 twill", Weave::twill(3, 1).expect("a twill")),
        ("1/3 twill", Weave::twill(1, 3).expect("a twill")),
        ("satin of 5", Weave::satin(5).expect("a satin")),
        ("satin of 8", Weave::satin(8).expect("a satin")),
        ("basket", Weave::from_chart("oxx oxx xoo").expect("a chart")),
    ]
}

fn cloth(weave: &Weave, spacing: f64) -> Woven {
    Woven::new(weave, 9, 11, YARN_RADIUS_M, spacing).expect("cloth")
}

fn laid_flat(woven: &Woven, scale: f64) -> Curves {
    woven.swatch(&FlatPatch { size_m: scale * woven.size_m() }).expect("a swatch")
}

fn yarns_in_radii(curves: &Curves) -> Vec<Polyline> {
    (0..curves.len())
        .map(|curve| {
            let points = curves.points[curves.range(curve)].iter();
            let control: Vec<DVec3> = points.map(|p| DVec3::from(p.map(f64::from)) / YARN_RADIUS_M).collect();
            Polyline::from_catmull_rom(&control, false, 10)
        })
        .collect()
}

#[test]
fn yarns_do_not_intersect_and_the_tightest_cloth_touches() {
    for (name, weave) in weaves() {
        for spacing in [1.0, SPACING, 1.4] {
            let yarns = yarns_in_radii(&laid_flat(&cloth(&weave, spacing), 1.0));
            let closest = closest_approach(&yarns, 3.0, PI).expect("yarns cross");
            let tightest = yarns.iter().map(tightest_bend).fold(f64::INFINITY, f64::min);
            println!("{name}, spacing {spacing:.3}: closest {closest:.4}, bend {tightest:.3}");
            assert!(closest >= 2.0, "{name}, {spacing}: centre lines come within {closest} radii");
            assert!(closest < 2.025, "{name}, {spacing}: loose, the nearest centre lines are {closest} radii apart");
            assert!(tightest >= 1.0, "{name}, {spacing}: bends with radius {tightest}");
        }
    }
}

#[test]
fn a_surface_too_small_for_the_cloth_makes_it_intersect() {
    for (name, weave) in weaves() {
        let yarns = yarns_in_radii(&laid_flat(&cloth(&weave, 1.0), 0.96));
        assert!(closest_approach(&yarns, 3.0, PI).expect("yarns cross") < 2.0, "{name}");
    }
}

/// Whether the warp lies in front where its yarn `warp` crosses the weft yarn `weft`: where their centre lines meet as
/// seen from the front. `None` where they do not.
fn is_warp_in_front(yarns: &[Polyline], warp_count: usize, weft: usize, warp: usize) -> Option<bool> {
    let (a, b) = (&yarns[warp].points, &yarns[warp_count + weft].points);
    // The front faces −Y.
    let seen = |p: DVec3| DVec2::new(p.x, p.z);
    for i in 0..a.len() - 1 {
        for k in 0..b.len() - 1 {
            let (p, u) = (seen(a[i]), seen(a[i + 1] - a[i]));
            let (q, v) = (seen(b[k]), seen(b[k + 1] - b[k]));
            let turn = u.perp_dot(v);
            let (s, t) = ((q - p).perp_dot(v) / turn, (q - p).perp_dot(u) / turn);
            // Yarns cross at points of both: a little to either side counts.
            if (-1e-3..=1.001).contains(&s) && (-1e-3..=1.001).contains(&t) {
                return Some(a[i].lerp(a[i + 1], s).y < b[k].lerp(b[k + 1], t).y);
            }
        }
    }
    None
}

/// The crossings of a cloth that are not as the weave says.
fn wrong_crossings(yarns: &[Polyline], weave: &Weave, warp: usize, weft: usize) -> usize {
    let crossings = (0..weft).flat_map(|row| (0..warp).map(move |column| (row, column)));
    crossings
        .filter(|&(row, column)| {
            is_warp_in_front(yarns, warp, row, column) != Some(weave.warp_is_in_front(row, column))
        })
        .count()
}

#[test]
fn every_crossing_is_as_the_weave_says() {
    for (name, weave) in weaves() {
        let yarns = yarns_in_radii(&laid_flat(&cloth(&weave, SPACING), 1.0));
        assert_eq!(wrong_crossings(&yarns, &weave, 9, 11), 0, "{name}");
    }
}

#[test]
fn another_weave_and_yarns_that_lie_on_each_other_do_not_pass() {
    let twill = Weave::twill(2, 2).expect("a twill");
    let yarns = yarns_in_radii(&laid_flat(&cloth(&Weave::plain(), SPACING), 1.0));
    assert!(wrong_crossings(&yarns, &twill, 9, 11) > 40);
    let mut layers = yarns;
    for yarn in &mut layers[..9] {
        yarn.points.iter_mut().for_each(|point| point.y = -1.5);
    }
    assert_eq!(wrong_crossings(&layers, &Weave::plain(), 9, 11), 49);
}

#[test]
fn cloth_has_its_size_and_keeps_its_points_on_any_surface() {
    // Yarns of plain cloth jam at √3 diameters; those of a satin's warp touch.
    let plain = cloth(&Weave::plain(), 1.2).size_m() / YARN_RADIUS_M;
    assert!((plain / (DVec2::new(9.0, 11.0) * 1.2 * 2.0 * 3.0_f64.sqrt()) - 1.0).abs().max_element() < 0.01, "{plain}");
    let woven = cloth(&Weave::satin(5).expect("a satin"), 1.0);
    let warp = woven.size_m().x / (9.0 * 2.0 * YARN_RADIUS_M);
    assert!((1.0..1.02).contains(&warp), "{warp}");
    let patch = FlatPatch { size_m: woven.size_m() };
    let rest = woven.swatch(&patch).expect("a swatch");
    rest.validate().expect("drawable curves");
    assert_eq!((rest.len(), rest.points.len()), (woven.yarn_count(), woven.point_count()));
    let half = 0.5 * woven.size_m();
    let reach = |axis: usize| rest.points.iter().map(|p| f64::from(p[axis].abs())).fold(0.0, f64::max);
    assert!((reach(0) - half.x).abs() < 1e-6 && (reach(2) - half.y).abs() < 1e-6);
    let moved = woven.points_on(&|u, v| patch.position(u, v) + DVec3::new(0.1, 0.2, 0.3)).expect("points");
    for (a, b) in rest.points.iter().zip(&moved) {
        let expected = DVec3::from(a.map(f64::from)) + DVec3::new(0.1, 0.2, 0.3);
        assert!(expected.distance(DVec3::from(b.map(f64::from))) < 1e-6);
    }
}

#[test]
fn impossible_cloth_is_refused_by_name() {
    let plain = Weave::plain();
    let error = |warp, weft, radius, spacing| Woven::new(&plain, warp, weft, radius, spacing).expect_err("an error");
    assert_eq!(error(0, 5, 1e-3, 2.0), Error::WovenSize { warp: 0, weft: 5 });
    assert_eq!(error(1 << 40, 5, 1e-3, 2.0), Error::WovenSize { warp: 1 << 40, weft: 5 });
    assert_eq!(error(5, 5, 0.0, 2.0), Error::YarnRadius { value_m: 0.0 });
    assert_eq!(error(5, 5, 1e-3, 0.9), Error::Spacing { value: 0.9 });
    assert!(matches!(error(5, 5, 1e-3, f64::NAN), Error::Spacing { .. }));
    let woven = Woven::new(&plain, 2, 2, 1e-3, 2.0).expect("cloth");
    let refused = woven.points_on(&|_: f64, v: f64| DVec3::new(0.0, 0.0, v));
    assert!(matches!(refused, Err(Error::Surface { yarn: 0, index: 0, .. })), "{refused:?}");
}
