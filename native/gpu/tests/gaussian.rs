//! Spherical-Gaussian light: at its ends a sun and an even sky, with shadows and through the tables of multiple scattering.

mod support;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};
use lisle_core::scattering::{FiberAngles, Material, Normalizers, physical_reflected};
use lisle_gpu::{Environment, EnvironmentImage, Light, Scene, Settings};
use support::fiber::{close_up, lone_fiber};
use support::{draw, exact, looking, measure, object, orthographic, preset, scene};

const SIZE: [u32; 2] = [64, 48];

fn gaussian(toward: DVec3, fluence: f64, sharpness: f64) -> Light {
    Light::Gaussian { direction: -toward, fluence: Vec3::splat(fluence as f32), sharpness }
}

fn toward() -> DVec3 {
    DVec3::new(0.3, -0.7, 0.6).normalize()
}

/// Four yarns beside and above each other, which throw shadows on each other.
fn lit_by(lights: Vec<Light>, environment: Option<Environment>) -> Scene {
    let row = |k: usize| -> Vec<[f32; 3]> {
        let (y, z) = (0.25 * (k / 2) as f32, 0.22 * (k % 2) as f32);
        (0..20).map(|i| [2.0 * i as f32 / 19.0 - 1.0, y, z]).collect()
    };
    let curves = lisle_core::Curves::catmull_rom((0..4).map(row).collect(), false);
    let yarns = Arc::new(lisle_core::Yarns::new(curves, Some(0.1)).expect("valid curves"));
    let target = DVec3::new(0.0, 0.0, 0.11);
    let camera = orthographic(looking(target + DVec3::new(0.2, -2.0, 0.5), target), 0.5, SIZE, [0.0, 0.0]);
    let yarn = object(&yarns, &preset("cotton-2"));
    Scene { lights, environment, ambient: Vec3::ZERO, ..scene(vec![yarn], camera) }
}

fn even_sky(radiance: f32) -> Environment {
    let image = EnvironmentImage::new([16, 8], vec![[radiance; 3]; 128]).expect("radiances");
    Environment { image: Arc::new(image), world_from_environment: DMat3::IDENTITY, strength: 1.0 }
}

fn soft(samples: u32, transport_photons: u32) -> Settings {
    Settings { samples, filter_width: 1.5, shadow_resolution: 256, transport_photons, ..exact(SIZE) }
}

const PHOTONS: [u32; 2] = [0, 100_000];

#[test]
fn a_sharp_one_is_a_sun() {
    for photons in PHOTONS {
        let mean = |light| measure::brightness(&draw(&lit_by(vec![light], None), &soft(32, photons)));
        let expected = mean(Light::Sun { direction: -toward(), irradiance: Vec3::splat(2.0), angle_rad: 0.0 });
        let [found, wide] = [1e5, 5.0].map(|sharpness| mean(gaussian(toward(), 2.0, sharpness)));
        println!("{photons} photons: {found:.4}, {wide:.4} of a wide one, {expected:.4} of a sun");
        assert!((found / expected - 1.0).abs() < 0.01, "{found} for {expected}");
        assert!((wide / expected - 1.0).abs() > 0.03, "{wide} for {expected}");
    }
}

#[test]
fn a_wide_one_is_an_even_sky() {
    for photons in PHOTONS {
        let mean = |scene| measure::brightness(&draw(&scene, &soft(256, photons)));
        let expected = mean(lit_by(vec![], Some(even_sky(0.5))));
        let [found, sharper] = [1e-3, 1.0].map(|sharpness| {
            let light = gaussian(toward(), 0.5 * 4.0 * PI, sharpness);
            mean(lit_by(vec![light], None))
        });
        println!("{photons} photons: {found:.4}, {sharper:.4} of a sharper one, {expected:.4} of the sky");
        assert!((found / expected - 1.0).abs() < 0.015, "{found} for {expected}");
        assert!((sharper / expected - 1.0).abs() > 0.03, "{sharper} for {expected}");
    }
}

#[test]
fn a_lone_fiber_has_the_brightness_of_a_quadrature() {
    // R and TT without a Lambert part are even over the width.
    const ROWS: u32 = 400;
    let base = Material::preset("cotton-2").expect("preset");
    let material = Material { beta_r_rad: 0.25, beta_tt_rad: 0.3, diffuse_weight: 0.0, ..base };
    let fiber = lone_fiber(material);
    let view = DVec3::new(0.2, -0.8, 0.3).normalize();
    let expected = |axis: DVec3, sharpness: f64| {
        let amplitude = 2.0 * sharpness / (TAU * (1.0 - (-2.0 * sharpness).exp()));
        let cell = (2.0 / f64::from(ROWS)) * (TAU / f64::from(ROWS));
        let row = |j: u32| {
            let z = (f64::from(j) + 0.5) * 2.0 / f64::from(ROWS) - 1.0;
            let across = (1.0 - z * z).sqrt();
            // The fiber lies along X, to which angles are: all of a row have one longitude.
            let normalizers = Normalizers::exact(&material, z.asin());
            let at = |i: u32| {
                let (sin, cos) = ((f64::from(i) + 0.5) * TAU / f64::from(ROWS)).sin_cos();
                let from = DVec3::new(z, across * cos, across * sin);
                let angles = FiberAngles::from_directions(DVec3::X, from, view);
                physical_reflected(&material, &normalizers, &angles, 0.0).x * (sharpness * (from.dot(axis) - 1.0)).exp()
            };
            (0..ROWS).map(at).sum::<f64>()
        };
        amplitude * cell * (0..ROWS).map(row).sum::<f64>()
    };
    for sharpness in [0.1, 2.0, 12.0, 60.0] {
        let mut scene = Scene { ambient: Vec3::ZERO, ..scene(vec![fiber.clone()], close_up(&fiber, view, SIZE)) };
        scene.lights = vec![gaussian(toward(), 2.0, sharpness)];
        let image = draw(&scene, &Settings { samples: 1024, shadow_resolution: 64, ..exact(SIZE) });
        let covered = image.combined.iter().filter(|c| c[3] == 1.0);
        let (sum, count) = covered.fold((0.0, 0), |(sum, count), c| (sum + f64::from(c[0]), count + 1));
        let (found, expected_here) = (sum / f64::from(count), expected(toward(), sharpness));
        println!("λ {sharpness}: {found:.5}, expected {expected_here:.5}");
        // The tables have normalisers within half a percent; 1024 directions leave a tenth.
        assert!(count > 1000 && (found / expected_here - 1.0).abs() < 0.005, "λ {sharpness}");
        if sharpness > 1.0 {
            assert!((found / expected(toward(), 1.2 * sharpness) - 1.0).abs() > 0.01, "λ {sharpness}: another λ");
            assert!((found / expected(-toward(), sharpness) - 1.0).abs() > 0.01, "λ {sharpness}: turned about");
        }
    }
}

#[test]
fn it_converges_with_the_samples_and_without_noise_between_pixels() {
    let scene = lit_by(vec![gaussian(toward(), 2.0, 10.0)], None);
    let mean = |samples, seed| measure::brightness(&draw(&scene, &Settings { seed, ..soft(samples, 0) }));
    let truth = mean(512, 1);
    for (samples, bound) in [(1, 0.4), (16, 0.05), (64, 0.015)] {
        let squares: Vec<f64> = (2..8).map(|seed| (mean(samples, seed) / truth - 1.0).powi(2)).collect();
        let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        println!("{samples} samples: {:.2} %", 100.0 * error);
        assert!(error < bound, "{samples} samples: {error}");
    }
}
