//! Pictures whose brightness follows from a formula.

mod support;

use std::f64::consts::PI;

use glam::DVec3;
use lisle_core::scattering::{FiberScattering, Material};
use lisle_core::scene::Shading;
use lisle_reference::Settings;
use support::{RADIUS, draw, lambert, looking, mean, object, orthographic, scene, single_fiber, straight, sun};

// So many rows that the pixel filter, which is no partition of unity, does not matter.
const SIZE: [u32; 2] = [4, 600];

fn settings(samples: u32, bounces: u32, shading: Shading) -> Settings {
    Settings { size: SIZE, samples, bounces: Some(bounces), shading, filter_width: 1.5, ..Settings::default() }
}

/// A long straight fiber along X.
fn along_x(offset: DVec3) -> [DVec3; 2] {
    [DVec3::new(-5.0, 0.0, 0.0) + offset, DVec3::new(5.0, 0.0, 0.0) + offset]
}

/// Looks along +Y at a frame that the fiber about X covers for two thirds.
fn front() -> lisle_core::scene::Camera {
    orthographic(looking(DVec3::new(0.0, -10.0, 0.0), DVec3::ZERO), 3.0 * RADIUS, SIZE)
}

/// Whether a mean is the expected one within four standard errors, and errors are small enough to tell. Rows of pixels leave 1e-3.
fn agrees((found, error): (f64, f64), expected: f64) -> bool {
    error < 0.02 * expected && (found - expected).abs() < 4.0 * error + 1e-3 * expected
}

/// A Lambert cylinder about X seen from −Y, under a sun that comes from angle φ to the viewer about the axis, square to the axis.
///
/// At the angle a about the axis (0 faces the viewer), n·l = cos(a − φ) where positive and the width is r cos a da. Over the projected width 2r
/// L = (ρ E / π) ½ ∫ cos a max(cos(a − φ), 0) da, over a from φ − π/2 to π/2 (0 ≤ φ ≤ π): = (ρ E / 2π) (sin φ + (π − φ) cos φ) / 2.
/// The picture is 3 r high: two thirds of it are fiber.
fn lambert_mean(albedo: f64, irradiance: f64, phi: f64) -> f64 {
    2.0 / 3.0 * albedo * irradiance / (2.0 * PI) * (phi.sin() + (PI - phi) * phi.cos()) / 2.0
}

fn lambert_picture(albedo: f64, phi: f64) -> (f64, f64) {
    let yarns = straight(&[along_x(DVec3::ZERO)], RADIUS);
    let toward = DVec3::new(0.0, -phi.cos(), phi.sin());
    let scene = scene(object(&yarns, &single_fiber(), lambert(albedo)), vec![sun(-toward, 3.0)], 0.0, front());
    mean(&draw(&scene, &settings(400, 1, Shading::Simple)))
}

#[test]
fn a_lambert_fiber_under_a_sun_has_the_brightness_of_a_cylinder() {
    for phi in [0.0, 0.7, 1.6, 2.5] {
        let found = lambert_picture(0.8, phi);
        println!("φ {phi}: {found:?}, expected {}", lambert_mean(0.8, 3.0, phi));
        assert!(agrees(found, lambert_mean(0.8, 3.0, phi)), "φ {phi}: {found:?}");
    }
    // Light from elsewhere, or another albedo, is told apart.
    assert!(!agrees(lambert_picture(0.8, 0.7), lambert_mean(0.8, 3.0, 0.75)));
    assert!(!agrees(lambert_picture(0.83, 0.7), lambert_mean(0.8, 3.0, 0.7)));
}

#[test]
fn the_r_and_tt_lobes_are_even_over_the_width() {
    // S cos θ_i does not depend on the place on the width: L = S cos θ_i E, two thirds of which is the picture's mean. `evaluate` has the cosine.
    let material = Material { diffuse_weight: 0.0, ..Material::preset("rayon-1").expect("preset") };
    let yarns = straight(&[along_x(DVec3::ZERO)], RADIUS);
    let towards = DVec3::new(0.3, 0.8, 0.5).normalize();
    let scene = scene(object(&yarns, &single_fiber(), material), vec![sun(-towards, 3.0)], 0.0, front());
    let found = mean(&draw(&scene, &settings(16, 1, Shading::Physical)));
    // In the axes of the scattering library: x towards the viewer (−Y), y = tangent × x = X × −Y = −Z, z the tangent (X).
    let light = |d: DVec3| DVec3::new(-d.y, -d.z, d.x);
    let fiber = FiberScattering::physical(material);
    let expected = |d| 2.0 / 3.0 * 3.0 * fiber.evaluate(DVec3::X, light(d)).x;
    println!("{found:?}, expected {}", expected(towards));
    assert!(agrees(found, expected(towards)));
    assert!(!agrees(found, expected(DVec3::new(0.35, 0.8, 0.5).normalize())));
    assert!(!agrees(found, expected(towards * DVec3::new(1.0, -1.0, 1.0))));
}

/// Brightness of a Lambert fiber about X under a sun from +Z, with a thinner one of radius `share` r in the sun's way, out of the picture.
///
/// Of the visible half, a from −π/2 to π/2, the sun lights a > 0, where n·l = sin a. A point there is at y = −r cos a: the thin fiber at y = 0 shades
/// it if r cos a < share r. What remains is ∫ cos a sin a da from 0 to acos(share): L = (ρ E / 2π) (1 − share²) / 2.
fn shaded_mean(share: f64) -> (f64, f64) {
    let thick = straight(&[along_x(DVec3::ZERO)], RADIUS);
    let thin = straight(&[along_x(DVec3::Z * 5.0 * RADIUS)], share * RADIUS);
    let mut scene = scene(object(&thick, &single_fiber(), lambert(0.8)), vec![sun(DVec3::NEG_Z, 3.0)], 0.0, front());
    scene.objects.push(object(&thin, &single_fiber(), lambert(0.8)));
    mean(&draw(&scene, &settings(100, 1, Shading::Simple)))
}

#[test]
fn one_fiber_shades_another_exactly() {
    let expected = |share: f64| 2.0 / 3.0 * 0.8 * 3.0 / (2.0 * PI) * (1.0 - share * share) / 2.0;
    for share in [0.2, 0.5, 0.8] {
        let found = shaded_mean(share);
        println!("{share}: {found:?}, expected {}", expected(share));
        assert!(agrees(found, expected(share)));
    }
    assert!(!agrees(shaded_mean(0.5), expected(0.51)));
}

/// Alpha of a picture through `count` fibers whose lines are drawn evenly: at an even distance up to `reach` from the Y axis, at an even angle about it.
///
/// Any place of the picture is covered by one fiber with the chance r / reach, as long as it is nearer to the axis than reach − r. All together leave
/// it open with (1 − r/reach)^count, which is exp(−count r/reach) for many thin ones.
fn coverage(count: u32, radius: f64, reach: f64, seed: u32) -> f64 {
    let unit = |i: u32, key: u32| {
        lisle_core::sampling::unit_from_hash(lisle_core::sampling::hash_combine(seed * 7919 + i, key))
    };
    let fibers: Vec<[DVec3; 2]> = (0..count)
        .map(|i| {
            let (distance, angle) = (reach * (2.0 * unit(i, 0) - 1.0), PI * unit(i, 1));
            let across = DVec3::new(angle.cos(), 0.0, angle.sin());
            let along = DVec3::new(-angle.sin(), 0.0, angle.cos());
            let middle = across * distance + DVec3::Y * (2.0 * unit(i, 2) - 1.0);
            [middle - along * 3.0 * reach, middle + along * 3.0 * reach]
        })
        .collect();
    let yarns = straight(&fibers, radius);
    let size = [48, 48];
    let camera = orthographic(looking(DVec3::new(0.0, -10.0, 0.0), DVec3::ZERO), reach, size);
    let scene = scene(object(&yarns, &single_fiber(), lambert(0.5)), vec![], 0.0, camera);
    let image =
        draw(&scene, &Settings { size, samples: 4, bounces: Some(1), shading: Shading::Simple, ..Settings::default() });
    image.combined.iter().map(|c| f64::from(c[3])).sum::<f64>() / image.combined.len() as f64
}

#[test]
fn many_fibers_let_through_what_chance_leaves_open() {
    let (count, radius, reach) = (60, 0.01, 1.0);
    let found: Vec<f64> = (0..40).map(|seed| 1.0 - coverage(count, radius, reach, seed)).collect();
    let n = found.len() as f64;
    let mean = found.iter().sum::<f64>() / n;
    let error = (found.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    let expected = |count: u32| (1.0 - radius / reach).powi(count as i32);
    println!("{mean} ± {error}, expected {}", expected(count));
    assert!((mean - expected(count)).abs() < 3.0 * error && error < 0.01);
    assert!((mean - expected(count + 8)).abs() > 3.0 * error, "a tenth more fibers are told apart");
}
