//! Energy: what comes in goes out.

mod support;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use lisle_core::Yarns;
use lisle_core::sampling::{hash_combine, sphere, unit_from_hash};
use lisle_core::scattering::{FiberScattering, Material};
use lisle_core::scene::{Light, Shading};
use lisle_core::yarn::Yarn;
use lisle_reference::{Image, Settings};
use support::{RADIUS, draw, lambert, looking, mean, object, orthographic, scene, single_fiber, straight};

fn unit(i: u32, key: u32) -> f64 {
    unit_from_hash(hash_combine(i, key))
}

/// A heap of straight fibers within a sphere of radius 1 about the origin: dense enough that light is scattered often, and so long that
/// their round ends, which scatter as if they were no ends, have a fiftieth of the surface.
fn heap() -> Arc<Yarns> {
    let ends: Vec<[DVec3; 2]> = (0..300)
        .map(|i| {
            let middle = sphere([unit(i, 0), unit(i, 1)]) * 0.3 * unit(i, 2).cbrt();
            let half = sphere([unit(i, 3), unit(i, 4)]) * 0.7;
            [middle - half, middle + half]
        })
        .collect();
    straight(&ends, 0.02)
}

fn view(direction: DVec3, size: [u32; 2]) -> lisle_core::scene::Camera {
    orthographic(looking(direction * 10.0, DVec3::ZERO), 2.2, size)
}

/// The most that any pixel differs from 1 under uniform light 1, with that light as the background.
fn visibility(material: Material, yarns: &Arc<Yarns>, yarn: &Yarn) -> f32 {
    let size = [48, 48];
    let scene = scene(object(yarns, yarn, material), vec![], 1.0, view(DVec3::new(0.3, -0.8, 0.4).normalize(), size));
    let settings = Settings { size, samples: 8, shading: Shading::Simple, transparent: false, ..Settings::default() };
    draw(&scene, &settings).combined.iter().flatten().map(|c| (c - 1.0).abs()).fold(0.0, f32::max)
}

#[test]
fn white_lambert_fibers_disappear_in_uniform_light() {
    let (heap, fiber) = (heap(), single_fiber());
    assert!(visibility(lambert(1.0), &heap, &fiber) < 1e-6);
    let swatch: Vec<Vec<[f32; 3]>> = (0..6)
        .map(|row| {
            (0..12).map(|i| [0.15 * i as f32 - 0.8, 0.05 * (i as f32 * 1.3).sin(), 0.15 * row as f32 - 0.4]).collect()
        })
        .collect();
    let yarns = Arc::new(Yarns::new(lisle_core::Curves::catmull_rom(swatch, false), Some(0.1)).expect("valid curves"));
    assert!(visibility(lambert(1.0), &yarns, &Yarn::preset("silk-1").expect("preset")) < 1e-6);
    // A hundredth of the light lost at each scattering is seen.
    assert!(visibility(lambert(0.99), &heap, &fiber) > 0.009);
}

#[test]
fn a_sphere_of_light_about_the_scene_is_a_uniform_sky() {
    // Both ways to meet a light with extent, weighted: a wrong weight or density leaves another brightness. Radiance 1 is a power of 4π²r².
    let radius = 30.0;
    let power = Vec3::splat((4.0 * PI * PI * radius * radius) as f32);
    let light = |power| Light::Point { position: DVec3::ZERO, power, radius, cone: None };
    let size = [24, 24];
    let picture = |power| {
        let mut scene = scene(object(&heap(), &single_fiber(), lambert(1.0)), vec![], 0.0, view(DVec3::NEG_Y, size));
        scene.lights.push(light(power));
        draw(&scene, &Settings { size, samples: 64, shading: Shading::Simple, ..Settings::default() })
    };
    let missing = |image: &Image| {
        let alpha = image.combined.iter().map(|c| f64::from(c[3])).sum::<f64>() / image.combined.len() as f64;
        let (mean, error) = mean(image);
        ((mean - alpha) / error, error / alpha)
    };
    let (deviations, relative) = missing(&picture(power));
    println!("{deviations} standard errors of {relative}");
    assert!(deviations.abs() < 4.0 && relative < 0.005);
    assert!(missing(&picture(power * 1.03)).0 > 4.0);
}

/// Over random lines through the sphere about the heap: mean of (radiance − 1) where a line meets it, in uniform light 1, and its standard error
/// over directions.
///
/// As much light comes in as goes out exactly if every scattering gives back all of it; lines drawn evenly are how light leaves a sphere. A model that is
/// not reciprocal is brighter to one side and darker to another: only the mean over all lines has to vanish.
fn gain(material: Material, shading: Shading) -> (f64, f64) {
    let (yarns, yarn, size) = (heap(), single_fiber(), [12, 12]);
    let gains: Vec<f64> = (0..200)
        .map(|i| {
            let direction = sphere([(f64::from(i) + 0.5) / 200.0, f64::from(i) * 0.618_033_988_75]);
            let scene = scene(object(&yarns, &yarn, material), vec![], 1.0, view(direction, size));
            let image = draw(
                &scene,
                &Settings { size, samples: 16, shading, seed: i, filter_width: 1.0, ..Settings::default() },
            );
            let (mut light, mut alpha) = (0.0, 0.0);
            for pixel in &image.combined {
                light += f64::from(pixel[0]);
                alpha += f64::from(pixel[3]);
            }
            (light - alpha) / alpha
        })
        .collect();
    let n = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / n;
    (mean, (gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt())
}

/// R + TT that give back all light, without a Lambert term.
fn white() -> Material {
    Material {
        color_r: DVec3::splat(0.3),
        color_tt: DVec3::ONE,
        beta_r_rad: 0.1,
        diffuse_weight: 0.0,
        ..Material::preset("cotton").expect("preset")
    }
}

#[test]
fn white_r_and_tt_fibers_give_back_all_light() {
    let (mean, error) = gain(white(), Shading::Physical);
    println!("{mean} ± {error}");
    assert!(mean.abs() < 4.0 * error && error < 0.004);
    let (mean, error) = gain(Material { color_tt: DVec3::splat(0.97), ..white() }, Shading::Physical);
    println!("3 % of TT lost: {mean} ± {error}");
    assert!(mean < -4.0 * error);
}

#[test]
fn one_fiber_in_uniform_light_has_the_models_ambient_brightness() {
    let size = [8, 60];
    let yarns = straight(&[[DVec3::NEG_X * 5.0, DVec3::X * 5.0]], RADIUS);
    for shading in [Shading::Simple, Shading::Physical] {
        for name in ["cotton", "silk", "rayon-4"] {
            let material = Material::preset(name).expect(name);
            let fiber = match shading {
                Shading::Simple => FiberScattering::simple(material),
                Shading::Physical => FiberScattering::physical(material),
            };
            for slant in [0.0_f64, 0.9] {
                let direction = DVec3::new(slant.sin(), -slant.cos(), 0.0);
                let camera = orthographic(looking(direction * 10.0, DVec3::ZERO), 1.5 * RADIUS, size);
                let scene = scene(object(&yarns, &single_fiber(), material), vec![], 1.0, camera);
                let image =
                    draw(&scene, &Settings { size, samples: 256, shading, bounces: Some(1), ..Settings::default() });
                let (found, error) = mean(&image);
                // Light from within a Lambert cylinder is none of this fiber's: `ambient` has all of it.
                let expected = fiber.ambient(DVec3::new(slant.cos(), 0.0, slant.sin())).x;
                println!("{shading:?} {name} {slant}: {found} ± {error}, expected {expected}");
                assert!(
                    (found - expected).abs() < 4.0 * error + 1e-6 && error < 0.01 * expected,
                    "{shading:?} {name} {slant}"
                );
            }
        }
    }
}
