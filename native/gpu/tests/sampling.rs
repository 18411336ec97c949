//! Samples of pixels, lights and sky combine in all ways: pictures of many samples do not hang on the seed, and few make little noise.

mod support;

use glam::{DVec3, Vec3};
use lisle_gpu::{Image, Light, Scene, Settings};
use support::{curves, draw, exact, looking, measure, object, perspective, preset, scene, yarns_of};

const SIZE: [u32; 2] = [48, 36];

/// Yarn among yarn, under two soft lights and the sky.
fn soft() -> Scene {
    let camera = perspective(looking(DVec3::new(0.3, -5.0, 1.5), DVec3::ZERO), 0.2, SIZE, [0.0, 0.0]);
    let yarns = [0.0, 0.3].map(|at| {
        let mut object = object(&yarns_of(curves::wave(3.0, 0.5, 40), false, 0.14), &preset("cotton-1"));
        object.world_from_object = glam::DMat4::from_translation(DVec3::new(at, at, -at));
        object
    });
    let mut scene = scene(yarns.to_vec(), camera);
    scene.ambient = Vec3::splat(0.3);
    let power = Vec3::splat(300.0);
    scene.lights = vec![
        Light::Sun { direction: DVec3::new(1.0, 1.0, -1.5), irradiance: Vec3::splat(2.0), angle_rad: 0.6 },
        Light::Area {
            world_from_light: looking(DVec3::new(-3.0, -2.0, 2.0), DVec3::ZERO),
            size: [2.0, 2.0],
            ellipse: false,
            power,
        },
    ];
    scene
}

fn picture(scene: &Scene, samples: u32, seed: u32) -> Image {
    draw(scene, &Settings { samples, seed, filter_width: 1.5, lod_pixels: 1.0, shadow_resolution: 256, ..exact(SIZE) })
}

/// Root of the mean square of the difference of two pictures' colours, over the mean of one.
fn difference(a: &Image, b: &Image) -> f64 {
    let square = |(a, b): (&[f32; 4], &[f32; 4])| f64::from(a[1] - b[1]).powi(2);
    let sum: f64 = a.combined.iter().zip(&b.combined).map(square).sum();
    (sum / measure::area(b)).sqrt() / measure::brightness(b)
}

#[test]
fn a_picture_of_many_samples_does_not_hang_on_the_seed() {
    let scene = soft();
    let between_seeds = |samples| {
        let [a, b] = [1, 2].map(|seed| picture(&scene, samples, seed));
        difference(&a, &b)
    };
    let (few, many) = (between_seeds(64), between_seeds(1024));
    println!("pictures with two seeds differ by {:.2} % at 64 samples, {:.2} % at 1024", 100.0 * few, 100.0 * many);
    // Noise alone falls by the root of 16 at least; what hangs on the seed does not.
    assert!(many < 0.3 * few && many < 0.05, "{few} at 64 samples, {many} at 1024");
}

#[test]
fn few_samples_make_little_noise() {
    let scene = soft();
    let reference = picture(&scene, 2048, 100);
    // As measured with llvmpipe on 2026-11-23, and less than a tenth more: 48.5, 33.3, 22.5 and 10.6 %.
    for (samples, most) in [(4, 0.53), (8, 0.36), (16, 0.245), (64, 0.115)] {
        let square: f64 = (0..16).map(|seed| difference(&picture(&scene, samples, seed), &reference).powi(2)).sum();
        let noise = (square / 16.0).sqrt();
        println!("{samples} samples: {:.2} %", 100.0 * noise);
        assert!(noise < most, "{samples} samples: {noise}");
    }
}
