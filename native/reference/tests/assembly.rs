//! The hierarchy against a look at every round cone.

mod support;

use std::ops::ControlFlow;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::sampling::{hash_combine, sphere, unit_from_hash};
use lisle_core::yarn::Yarn;
use lisle_core::{Curves, Yarns};
use lisle_reference::assembly::{Assembly, Ray};
use lisle_reference::cone::RoundCone;
use lisle_reference::fibers::{Fibers, Options, fibers};

fn unit(i: u32, key: u32) -> f64 {
    unit_from_hash(hash_combine(i, key))
}

/// The fibers of a loop of yarn in a space that is `scale` times as large.
fn fibers_of_loop(scale: f64) -> Fibers {
    let points = (0..40).map(|i| {
        let a = 0.2 * f64::from(i);
        Vec3::new(a.cos() as f32, a.sin() as f32, 0.05 * a as f32).to_array()
    });
    let yarns = Yarns::new(Curves::catmull_rom(vec![points.collect()], false), Some(0.1)).expect("valid curves");
    let options = Options { space_from_object: DMat4::from_scale(DVec3::splat(scale)), ..Options::default() };
    let yarn = Yarn::preset("silk-1").expect("preset");
    fibers(yarns.strands(), &yarn, &options, &mut |_| ControlFlow::Continue(())).expect("fibers")
}

fn cones(fibers: &Fibers) -> Vec<RoundCone> {
    let at = |p: [f32; 4]| DVec3::new(p[0].into(), p[1].into(), p[2].into());
    (0..fibers.len())
        .flat_map(|chain| fibers.chain(chain).windows(2))
        .map(|w| RoundCone { a: at(w[0]), b: at(w[1]), radius_a: w[0][3].into(), radius_b: w[1][3].into() })
        .collect()
}

/// From outside, at the yarn; some along an axis, where components of the direction are zeros of either sign.
fn ray(i: u32, scale: f64) -> Ray {
    let target = sphere([unit(i, 0), unit(i, 1)]) * scale;
    let direction = match i % 8 {
        0 => DVec3::new(-0.0, 1.0, 0.0),
        1 => DVec3::new(0.0, -0.0, -1.0),
        _ => sphere([unit(i, 2), unit(i, 3)]),
    };
    Ray { origin: target * DVec3::new(1.0, 1.0, 0.1) - direction * 3.0 * scale, direction }
}

fn assembled(fibers: Fibers) -> Assembly {
    Assembly::new(fibers, &mut || ControlFlow::Continue(())).expect("never stopped")
}

/// Straight fibers of ten cones each, everywhere in a cube and every way.
fn haystack(count: u32) -> Fibers {
    let mut fibers = Fibers { points: Vec::new(), offsets: vec![0] };
    for i in 0..count {
        let start = DVec3::new(unit(i, 10), unit(i, 11), unit(i, 12)) * 2.0 - 1.0;
        let step = sphere([unit(i, 13), unit(i, 14)]) * 0.01;
        let at = |k: i32| (start + step * f64::from(k)).as_vec3().extend(0.002).to_array();
        fibers.points.extend((0..=10).map(at));
        fibers.offsets.push(fibers.points.len() as u32);
    }
    fibers
}

#[test]
fn scenes_of_many_parts_are_met_as_those_of_one() {
    // Two parts and a bit.
    let fibers = haystack(27_000);
    let cones = cones(&fibers);
    let assembly = assembled(fibers);
    let mut met = 0;
    for i in 0..60 {
        let ray = ray(i, 1.0);
        let expected = cones
            .iter()
            .filter_map(|cone| cone.enter(ray.origin, ray.direction))
            .map(|entry| entry.t)
            .fold(f64::INFINITY, f64::min);
        let found = assembly.nearest(&ray, f64::INFINITY).map_or(f64::INFINITY, |hit| hit.t);
        assert_eq!(found, expected, "ray {i}");
        assert_eq!(assembly.is_blocked(&ray, f64::INFINITY), expected.is_finite());
        met += usize::from(expected.is_finite());
    }
    assert!(met > 20, "{met}");
}

#[test]
fn building_can_be_stopped_at_every_step() {
    let fibers = haystack(27_000);
    let mut steps = 0;
    let made = Assembly::new(fibers.clone(), &mut || {
        steps += 1;
        ControlFlow::Continue(())
    });
    assert!(made.is_ok() && steps >= 4, "{steps}");
    for stop in 1..=steps {
        let mut left = stop;
        let made = Assembly::new(fibers.clone(), &mut || {
            left -= 1;
            if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(matches!(made, Err(lisle_reference::Error::Cancelled)) && left == 0, "step {stop}");
    }
}

#[test]
fn rays_meet_what_a_look_at_every_cone_finds() {
    // Small scenes and large ones: nothing depends on the unit of length.
    for scale in [1e-5, 1.0, 1e5] {
        let fibers = fibers_of_loop(scale);
        let cones = cones(&fibers);
        let assembly = assembled(fibers);
        let mut met = 0;
        for i in 0..400 {
            let ray = ray(i, scale);
            let expected = cones
                .iter()
                .filter_map(|cone| cone.enter(ray.origin, ray.direction))
                .map(|entry| entry.t)
                .fold(f64::INFINITY, f64::min);
            let found = assembly.nearest(&ray, f64::INFINITY).map_or(f64::INFINITY, |hit| hit.t);
            assert_eq!(found, expected, "scale {scale}, ray {i}");
            assert_eq!(assembly.is_blocked(&ray, f64::INFINITY), expected.is_finite());
            if expected.is_finite() {
                met += 1;
                assert!(
                    assembly.is_blocked(&ray, expected * 1.000_001) && !assembly.is_blocked(&ray, expected * 0.999_999)
                );
                assert_eq!(assembly.nearest(&ray, expected * 0.999_999), None);
            }
        }
        assert!((50..350).contains(&met), "{met}");
    }
}

#[test]
fn a_ray_from_inside_leaves_unhindered() {
    // Along a straight fiber of several cones, and out of it at a slant: neither the ends of cones nor the fiber's own side stop it.
    let yarns = support::straight(&[[DVec3::NEG_X, DVec3::X]], 0.1);
    let made =
        fibers(yarns.strands(), &support::single_fiber(), &Options::default(), &mut |_| ControlFlow::Continue(()));
    let assembly = assembled(made.expect("fibers"));
    for direction in
        [DVec3::X, DVec3::new(1.0, 0.02, 0.0).normalize(), DVec3::Y, DVec3::new(-0.3, 0.1, 0.9).normalize()]
    {
        assert_eq!(assembly.nearest(&Ray { origin: DVec3::new(-0.7, 0.03, 0.02), direction }, 10.0), None);
    }
    assert!(assembly.nearest(&Ray { origin: DVec3::new(-3.0, 0.03, 0.02), direction: DVec3::X }, 10.0).is_some());
}

#[test]
fn nothing_is_met_where_nothing_is() {
    let empty = assembled(Fibers { points: vec![], offsets: vec![0] });
    let ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };
    assert_eq!(empty.nearest(&ray, f64::INFINITY), None);
    assert!(!empty.is_blocked(&ray, f64::INFINITY));
}

#[test]
fn tangents_and_normals_are_those_of_the_curve() {
    // A helix of one fiber: its tangent in closed form.
    let points = (0..200).map(|i| {
        let a = 0.05 * f64::from(i);
        DVec3::new(a.cos(), a.sin(), 0.3 * a)
    });
    let curve = points.map(|p| p.as_vec3().to_array()).collect();
    let yarns = Yarns::new(Curves::catmull_rom(vec![curve], false), Some(1e-7)).expect("valid curves");
    let made =
        fibers(yarns.strands(), &support::single_fiber(), &Options::default(), &mut |_| ControlFlow::Continue(()));
    let assembly = assembled(made.expect("fibers"));
    let (mut worst, mut met) = (0.0_f64, 0);
    for i in 0..300 {
        let angle = 0.5 + 8.5 * unit(i, 0);
        let out = DVec3::new(angle.cos(), angle.sin(), 0.0);
        let ray = Ray { origin: out * 3.0 + DVec3::Z * (0.3 * angle + 0.06 * (unit(i, 1) - 0.5)), direction: -out };
        let Some(hit) = assembly.nearest(&ray, f64::INFINITY) else { continue };
        let surface = assembly.surface(&ray, &hit);
        let at = surface.position.y.atan2(surface.position.x).rem_euclid(std::f64::consts::TAU);
        let turn = at + std::f64::consts::TAU * ((angle - at) / std::f64::consts::TAU).round();
        let expected = DVec3::new(-turn.sin(), turn.cos(), 0.3).normalize();
        worst = worst.max(surface.tangent.distance(expected));
        assert!(surface.normal.dot(surface.tangent).abs() < 1e-9 && (surface.normal.length() - 1.0).abs() < 1e-9);
        met += 1;
    }
    println!("{met} hits, tangent within {worst:.2e}");
    assert!(met > 200 && worst < 0.01);
}
