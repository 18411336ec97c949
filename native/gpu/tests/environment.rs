//! Light from a picture of the sky, and the picture behind everything.

mod support;

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, Vec3};
use lisle_core::scattering::Material;
use lisle_gpu::{Camera, Environment, EnvironmentImage, Light, Scene, Settings};
use support::fiber::{close_up, lone_fiber};
use support::{
    curves, draw, exact, looking, measure, object, orthographic, perspective, picture, preset, scene, yarns_of,
};

const SIZE: [u32; 2] = [64, 48];

/// A picture of the sky by a function of its directions.
fn environment(size: [u32; 2], turn: DMat3, radiance: impl Fn(DVec3) -> Vec3) -> Environment {
    let direction = |i: u32| {
        let [u, v] =
            [(f64::from(i % size[0]) + 0.5) / f64::from(size[0]), (f64::from(i / size[0]) + 0.5) / f64::from(size[1])];
        let (longitude, polar) = ((0.5 - u) * std::f64::consts::TAU, v * std::f64::consts::PI);
        DVec3::new(polar.sin() * longitude.cos(), polar.sin() * longitude.sin(), polar.cos())
    };
    let texels = (0..size[0] * size[1]).map(|i| radiance(direction(i)).to_array()).collect();
    let image = EnvironmentImage::new(size, texels).expect("radiances");
    Environment { image: Arc::new(image), world_from_environment: turn, strength: 1.0 }
}

/// A dim sky with a warm glow about a direction.
fn glow(toward: DVec3) -> impl Fn(DVec3) -> Vec3 {
    move |d| Vec3::new(0.2, 0.25, 0.3) + Vec3::new(6.0, 4.0, 2.0) * (d.dot(toward.normalize()).max(0.0).powi(16) as f32)
}

fn lit_by(environment: Option<Environment>, lights: Vec<Light>, ambient: f32) -> Scene {
    let yarn = object(&yarns_of(curves::straight(2.0, 20), false, 0.2), &preset("cotton-2"));
    let camera = orthographic(looking(DVec3::new(0.0, -2.0, 0.3), DVec3::ZERO), 0.7, SIZE, [0.0, 0.0]);
    Scene { environment, lights, ambient: Vec3::splat(ambient), ..scene(vec![yarn], camera) }
}

fn soft(samples: u32) -> Settings {
    Settings { samples, filter_width: 1.5, shadow_resolution: 256, ..exact(SIZE) }
}

#[test]
fn a_small_sun_in_the_sky_is_a_sun() {
    // A disc of 3° and of irradiance 2, everything else black.
    let toward = DVec3::new(0.3, -0.7, 0.6).normalize();
    let size = [512, 256];
    let cos = 0.05_f64.cos();
    let disc = |d: DVec3| Vec3::splat(if d.dot(toward) > cos { 1.0 } else { 0.0 });
    let mut sky = environment(size, DMat3::IDENTITY, disc);
    let irradiance: f64 = {
        let solid_angle = |row: f64| {
            let edge = |r: f64| (std::f64::consts::PI * r / f64::from(size[1])).cos();
            (edge(row) - edge(row + 1.0)) * std::f64::consts::TAU / f64::from(size[0])
        };
        let lit = sky.image.radiance().iter().enumerate();
        lit.map(|(i, t)| f64::from(t[0]) * solid_angle((i as u32 / size[0]).into())).sum()
    };
    sky.strength = (2.0 / irradiance) as f32;
    let sun = Light::Sun { direction: -toward, irradiance: Vec3::splat(2.0), angle_rad: 0.1 };
    let expected = measure::brightness(&draw(&lit_by(None, vec![sun], 0.0), &soft(64)));
    let found = measure::brightness(&draw(&lit_by(Some(sky.clone()), vec![], 0.0), &soft(64)));
    println!("{found:.4} for {expected:.4}");
    assert!((found / expected - 1.0).abs() < 0.02, "{found} for {expected}");
    // Turned with its picture back to where it was, it is the same; turned alone, another.
    let turn = DMat3::from_rotation_z(1.2) * DMat3::from_rotation_x(0.4);
    sky.world_from_environment = turn;
    let away = measure::brightness(&draw(&lit_by(Some(sky.clone()), vec![], 0.0), &soft(64)));
    assert!((away / expected - 1.0).abs() > 0.05, "{away} for {expected}");
    let turned_sun = Light::Sun { direction: -(turn * toward), irradiance: Vec3::splat(2.0), angle_rad: 0.1 };
    let expected = measure::brightness(&draw(&lit_by(None, vec![turned_sun], 0.0), &soft(64)));
    assert!((away / expected - 1.0).abs() < 0.02, "{away} for {expected}");
}

#[test]
fn it_converges_with_the_samples_and_without_noise_between_pixels() {
    let sky = environment([64, 32], DMat3::IDENTITY, glow(DVec3::new(-0.5, -0.6, 0.7)));
    let scene = lit_by(Some(sky), vec![], 0.0);
    let mean = |samples, seed| measure::brightness(&draw(&scene, &Settings { seed, ..soft(samples) }));
    let truth = mean(512, 1);
    for (samples, bound) in [(1, 0.1), (16, 0.04), (64, 0.015)] {
        // Root mean square: the largest would hang on one draw of a few directions.
        let squares: Vec<f64> = (2..8).map(|seed| (mean(samples, seed) / truth - 1.0).powi(2)).collect();
        let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        println!("{samples} samples: {:.2} %", 100.0 * error);
        assert!(error < bound, "{samples} samples: {error}");
    }
}

#[test]
fn on_a_lone_fiber_an_even_sky_is_ambient_light() {
    // Among others it is not: tables take the light that fibers leave for the same from all sides.
    let fiber = lone_fiber(Material::preset("cotton-2").expect("preset"));
    let camera = close_up(&fiber, DVec3::new(0.5, -0.8, 0.3), SIZE);
    let ambient = |radiance| Scene { ambient: Vec3::splat(radiance), ..scene(vec![fiber.clone()], camera) };
    let sky = environment([16, 8], DMat3::IDENTITY, |_| Vec3::splat(0.7));
    let found = draw(&Scene { environment: Some(sky), ..ambient(0.0) }, &soft(256));
    let expected = |radiance| measure::brightness(&draw(&ambient(radiance), &soft(1)));
    let found = measure::brightness(&found);
    println!("{found:.4} as directions, {:.4} from tables", expected(0.7));
    assert!((found / expected(0.7) - 1.0).abs() < 0.02, "{found} for {}", expected(0.7));
    assert!((found / expected(0.75) - 1.0).abs() > 0.02);
}

#[test]
fn what_is_behind_is_the_picture_as_the_camera_sees_it() {
    let turn = DMat3::from_rotation_z(0.8) * DMat3::from_rotation_y(0.3);
    let sky = environment([64, 32], turn, |d| (d.as_vec3() * 0.5 + 0.5) * 3.0);
    let world_from_camera =
        looking(DVec3::new(1.0, -3.0, 0.5), DVec3::new(0.0, 0.0, 0.3)) * DMat4::from_rotation_z(0.2);
    let cameras: [Camera; 2] = [
        perspective(world_from_camera, 0.9, SIZE, [0.1, -0.2]),
        orthographic(world_from_camera, 2.0, SIZE, [0.0, 0.0]),
    ];
    for camera in cameras {
        let view = lisle_core::view::View::new(&camera, SIZE).expect("a camera");
        let scene = Scene { camera, objects: vec![], ..lit_by(Some(sky.clone()), vec![], 0.25) };
        let image = draw(&scene, &Settings { transparent: false, ..exact(SIZE) });
        picture::show("sky", &image);
        let error = |sky: &Environment| {
            (0..SIZE[0] * SIZE[1])
                .map(|i| {
                    let place = [f64::from(i % SIZE[0]) + 0.5, f64::from(i / SIZE[0]) + 0.5];
                    let expected = sky.radiance(view.ray(place).1.normalize()) + 0.25;
                    let [r, g, b, a] = image.combined[i as usize].map(f64::from);
                    assert_eq!(a, 1.0);
                    (DVec3::new(r, g, b) / expected - 1.0).abs().max_element()
                })
                .fold(0.0, f64::max)
        };
        // Halves have 11 bits.
        assert!(error(&sky) < 1e-3, "{}", error(&sky));
        let wrong = Environment {
            world_from_environment: DMat3::from_rotation_z(0.82) * DMat3::from_rotation_y(0.3),
            ..sky.clone()
        };
        assert!(error(&wrong) > 1e-3);
        let transparent = draw(&scene, &exact(SIZE));
        assert!(transparent.combined.iter().all(|c| *c == [0.0; 4]));
    }
}
