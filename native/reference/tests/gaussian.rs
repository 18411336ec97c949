//! Spherical-Gaussian light against a quadrature of its radiance, and at its ends: an even sky, a sun.

mod support;

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use lisle_core::scattering::{FiberScattering, Material};
use lisle_core::scene::{Light, Shading};
use lisle_reference::Settings;
use support::{RADIUS, draw, lambert, looking, mean, object, orthographic, scene, single_fiber, straight, sun};

fn gaussian(toward: DVec3, fluence: f64, sharpness: f64) -> Light {
    Light::Gaussian { direction: -toward, fluence: Vec3::splat(fluence as f32), sharpness }
}

/// A fiber about X that covers two thirds of the picture, seen from −Y.
fn picture(material: Material, shading: Shading, light: Light, samples: u32) -> (f64, f64) {
    let size = [4, 600];
    let yarns = straight(&[[DVec3::NEG_X * 5.0, DVec3::X * 5.0]], RADIUS);
    let camera = orthographic(looking(DVec3::NEG_Y * 10.0, DVec3::ZERO), 3.0 * RADIUS, size);
    let scene = scene(object(&yarns, &single_fiber(), material), vec![light], 0.0, camera);
    mean(&draw(&scene, &Settings { size, samples, shading, bounces: Some(1), ..Settings::default() }))
}

/// R and TT, wide enough for a grid of directions.
fn wide_lobes() -> Material {
    let base = Material::preset("rayon-1").expect("preset");
    Material { beta_r_rad: 0.2, beta_tt_rad: 0.3, diffuse_weight: 0.0, ..base }
}

/// What a fiber of R and TT seen from −Y has of A exp(λ (ω·d − 1)), two thirds of the picture: both lobes are even over its width.
fn quadrature(material: Material, toward: DVec3, amplitude: f64, sharpness: f64) -> f64 {
    const ROWS: u32 = 800;
    let fiber = FiberScattering::physical(material);
    // The axes of the scattering library: x to the viewer, z along the fiber.
    let toward = DVec3::new(-toward.y, -toward.z, toward.x);
    let cell = (2.0 / f64::from(ROWS)) * (TAU / f64::from(ROWS));
    let at = |i: u32| {
        let z = (f64::from(i / ROWS) + 0.5) * 2.0 / f64::from(ROWS) - 1.0;
        let (sin, cos) = ((f64::from(i % ROWS) + 0.5) * TAU / f64::from(ROWS)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        let wi = DVec3::new(across * cos, across * sin, z);
        fiber.evaluate(DVec3::X, wi).x * amplitude * (sharpness * (wi.dot(toward) - 1.0)).exp()
    };
    2.0 / 3.0 * cell * (0..ROWS * ROWS).map(at).sum::<f64>()
}

#[test]
fn a_fiber_has_the_brightness_of_a_quadrature() {
    let toward = DVec3::new(0.5, 0.7, 0.6).normalize();
    let agrees = |(found, error): (f64, f64), expected: f64| {
        error < 0.01 * expected && (found - expected).abs() < 4.0 * error + 1e-3 * expected
    };
    for sharpness in [0.01, 1.0, 8.0, 60.0_f64] {
        let fluence = 3.0;
        let amplitude = fluence * sharpness / (TAU * (1.0 - (-2.0 * sharpness).exp()));
        let found = picture(wide_lobes(), Shading::Physical, gaussian(toward, fluence, sharpness), 64);
        let expected = quadrature(wide_lobes(), toward, amplitude, sharpness);
        println!("λ {sharpness}: {found:?}, expected {expected}");
        assert!(agrees(found, expected), "λ {sharpness}: {found:?}, expected {expected}");
        // Another lobe, or the light against its direction, is told apart, if it is not even anyhow.
        if sharpness >= 1.0 {
            assert!(!agrees(found, quadrature(wide_lobes(), toward, amplitude, 1.2 * sharpness)));
            assert!(!agrees(found, quadrature(wide_lobes(), -toward, amplitude, sharpness)));
        }
    }
}

#[test]
fn a_sharp_one_is_a_sun() {
    let toward = DVec3::new(0.3, -0.6, 0.7).normalize();
    for (name, material, shading) in [
        ("Lambert", lambert(0.8), Shading::Simple),
        ("R and TT", Material::preset("cotton-2").expect("preset"), Shading::Physical),
    ] {
        let (found, error) = picture(material, shading, gaussian(toward, 3.0, 1e5), 64);
        let (expected, own) = picture(material, shading, sun(-toward, 3.0), 64);
        println!("{name}: {found} ± {error}, of a sun {expected} ± {own}");
        let bound = 4.0 * error.hypot(own) + 1e-3 * expected;
        assert!((found - expected).abs() < bound && bound < 0.02 * expected, "{name}");
        let (wide, _) = picture(material, shading, gaussian(toward, 3.0, 10.0), 64);
        assert!((wide - expected).abs() > bound, "{name}: λ = 10 passes as a sun");
    }
}

#[test]
fn white_fibers_disappear_in_a_wide_one() {
    // Met by chance and drawn, with weights: an even sky of radiance 1, in which light is scattered any number of times.
    let size = [24, 24];
    let fibers: Vec<[DVec3; 2]> = (0..12)
        .flat_map(|i| {
            let at = 0.1 * f64::from(i) - 0.55;
            [
                [DVec3::new(-1.0, 0.0, at), DVec3::new(1.0, 0.0, at)],
                [DVec3::new(at, 0.1, -1.0), DVec3::new(at, 0.1, 1.0)],
            ]
        })
        .collect();
    let yarns = straight(&fibers, 0.04);
    let missing = |fluence: f64| {
        let camera = orthographic(looking(DVec3::new(1.0, -9.0, 2.0), DVec3::ZERO), 1.0, size);
        let light = gaussian(DVec3::Z, fluence, 1e-6);
        let scene = scene(object(&yarns, &single_fiber(), lambert(1.0)), vec![light], 0.0, camera);
        let image = draw(&scene, &Settings { size, samples: 256, shading: Shading::Simple, ..Settings::default() });
        let alpha = image.combined.iter().map(|c| f64::from(c[3])).sum::<f64>() / image.combined.len() as f64;
        let (mean, error) = mean(&image);
        println!("{mean} ± {error} of {alpha}");
        ((mean - alpha) / error, error / alpha)
    };
    let (deviations, relative) = missing(4.0 * PI);
    assert!(deviations.abs() < 4.0 && relative < 0.005, "{deviations} standard errors of {relative}");
    assert!(missing(4.0 * PI * 1.03).0 > 4.0);
}
