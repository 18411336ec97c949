//! Depth of field: how wide a blur is, that culling knows of it, and that the first sample is sharp.

mod support;

use glam::{DMat4, DVec3};
use lisle_gpu::{Camera, Filter, Image, Lens, Object, Scene, Settings};
use support::{curves, draw, exact, looking, measure, object, orthographic, perspective, preset, scene, yarns_of};

const SIZE: [u32; 2] = [120, 90];

/// The yarn lies 4 away; half the picture's height there is 1.
const DISTANCE: f64 = 4.0;
const TANGENT: f64 = 0.25;

fn thread() -> Object {
    object(&yarns_of(curves::straight(20.0, 40), false, 0.02), &preset("silk-1"))
}

fn front() -> DMat4 {
    looking(DVec3::new(0.0, -DISTANCE, 0.0), DVec3::ZERO)
}

fn through(focus_distance: f64) -> Camera {
    let lens = Lens { aperture_radius: 0.1, focus_distance, blades: 0, rotation_rad: 0.0, ratio: 1.0 };
    Camera { lens: Some(lens), ..perspective(front(), TANGENT, SIZE, [0.0, 0.0]) }
}

fn lit(objects: Vec<Object>, camera: Camera) -> Scene {
    Scene { ambient: glam::Vec3::ONE, ..scene(objects, camera) }
}

fn settings(samples: u32) -> Settings {
    Settings { samples, shadow_resolution: 64, lod_pixels: 1.0, ..exact(SIZE) }
}

/// Standard deviation of the covered rows about their mean, pixels.
fn spread(image: &Image) -> f64 {
    let alpha = |x: u32, y: u32| f64::from(image.combined[(y * image.size[0] + x) as usize][3]);
    let (mut area, mut first, mut second) = (0.0, 0.0, 0.0);
    for y in 0..image.size[1] {
        let row: f64 = (0..image.size[0]).map(|x| alpha(x, y)).sum();
        let place = f64::from(y) + 0.5;
        (area, first, second) = (area + row, first + row * place, second + row * place * place);
    }
    (second / area - (first / area).powi(2)).sqrt()
}

#[test]
fn a_thread_is_blurred_over_the_circle_of_confusion() {
    // A disc of radius r pixels spreads a line by r / 2; beside it the thread's own width is small.
    let own = spread(&draw(&lit(vec![thread()], through(DISTANCE)), &settings(64)));
    let pixels_per_unit = 0.5 * f64::from(SIZE[1]) / TANGENT;
    for focus in [2.5, 8.0, 100.0] {
        let found = spread(&draw(&lit(vec![thread()], through(focus)), &settings(256)));
        let radius = 0.1 * pixels_per_unit * (1.0 / focus - 1.0 / DISTANCE).abs();
        let expected = (0.25 * radius * radius + own * own).sqrt();
        println!("focus {focus}: {found:.3} px, expected {expected:.3}; in focus {own:.3}");
        assert!((found / expected - 1.0).abs() < 0.03, "focus {focus}: {found} for {expected}");
    }
    assert!(own < 1.5, "{own}");
}

#[test]
fn parallel_views_blur_too() {
    let lens = Lens { aperture_radius: 0.1, focus_distance: 2.0, blades: 0, rotation_rad: 0.0, ratio: 1.0 };
    let camera = Camera { lens: Some(lens), ..orthographic(front(), 2.0, SIZE, [0.0, 0.0]) };
    let found = spread(&draw(&lit(vec![thread()], camera), &settings(256)));
    let own = spread(&draw(&lit(vec![thread()], Camera { lens: None, ..camera }), &settings(1)));
    let radius = 0.1 * 45.0 * (DISTANCE / 2.0 - 1.0);
    let expected = (0.25 * radius * radius + own * own).sqrt();
    assert!((found / expected - 1.0).abs() < 0.03, "{found} for {expected}");
}

#[test]
fn what_only_the_rim_of_the_lens_sees_is_there() {
    // Half the frame's height is 1 at the thread; it lies beyond, near enough that some of the lens sees it.
    let radius = 0.1 * (1.0 - DISTANCE / 100.0);
    let beyond = |by: f64| {
        let up = DMat4::from_translation(DVec3::new(0.0, 0.0, 1.0 + by * radius));
        let image = draw(&lit(vec![Object { world_from_object: up, ..thread() }], through(100.0)), &settings(128));
        measure::area(&image)
    };
    let whole = {
        let image = draw(&lit(vec![thread()], through(100.0)), &settings(128));
        measure::area(&image)
    };
    // Of a disc, the share beyond half its radius: (π/3 - √3/4) / π.
    let expected = 1.0 / 3.0 - 3.0_f64.sqrt() / (4.0 * std::f64::consts::PI);
    let found = beyond(0.5) / whole;
    assert!((found - expected).abs() < 0.02, "{found} for {expected}");
    assert!(beyond(1.4) == 0.0);
}

#[test]
fn a_region_is_a_part_of_the_whole_and_the_first_sample_is_sharp() {
    let objects = || {
        vec![
            thread(),
            Object { id: 2, ..object(&yarns_of(curves::wave(3.0, 0.6, 60), false, 0.1), &preset("cotton-1")) },
        ]
    };
    for focus in [2.0, 30.0] {
        let scene = lit(objects(), through(focus));
        let settings = Settings { filter_width: 1.5, seed: 3, ..settings(8) };
        let whole = draw(&scene, &settings);
        let region = [50, 20, 31, 40];
        let part = draw(&scene, &Settings { region: Some(region), ..settings.clone() });
        assert_eq!(measure::difference(&part, &measure::crop(&whole, region)), None);
        let pinhole = lit(objects(), Camera { lens: None, ..through(focus) });
        let sharp = draw(&pinhole, &Settings { samples: 1, ..settings.clone() });
        assert_eq!(whole.depth, sharp.depth);
        assert_eq!(whole.object_id, sharp.object_id);
        assert_ne!(whole.combined, draw(&pinhole, &settings).combined);
    }
}

/// The largest difference between a picture and the mean of two others.
fn off_the_mean(whole: &Image, parts: &[Image; 2]) -> f32 {
    let off = |(i, whole): (usize, &[f32; 4])| {
        let mean = |c: usize| 0.5 * (parts[0].combined[i][c] + parts[1].combined[i][c]);
        (0..4).map(|c| (whole[c] - mean(c)).abs()).fold(0.0, f32::max)
    };
    whole.combined.iter().enumerate().map(off).fold(0.0, f32::max)
}

#[test]
fn a_picture_can_be_taken_in_parts() {
    // Bits of yarn beyond each border, at distances that a wide filter reaches; each sample culls for itself with a lens, one for all without.
    let (width, height) = (4.0 / 3.0, 1.0);
    let around = (0..32).map(|i| {
        let (beyond, along) = (0.05 + 0.05 * f64::from(i / 4), 0.2 * f64::from(i / 4) - 0.7);
        let [x, z] = match i % 4 {
            0 => [along, height + beyond],
            1 => [along, -height - beyond],
            2 => [width + beyond, along],
            _ => [-width - beyond, along],
        };
        Object {
            world_from_object: DMat4::from_translation(DVec3::new(x, 0.0, z)),
            ..object(&yarns_of(curves::straight(0.04, 3), false, 0.02), &preset("silk-1"))
        }
    });
    let objects: Vec<_> = std::iter::once(thread()).chain(around).collect();
    for lens in [through(2.5).lens, None] {
        for (filter, filter_width) in [(Filter::BlackmanHarris, 1.5), (Filter::Box, 40.0)] {
            let scene = lit(objects.clone(), Camera { lens, ..through(2.5) });
            let settings = Settings { filter, filter_width, ..settings(32) };
            let whole = draw(&scene, &settings);
            let parts =
                [0, 16].map(|first_sample| draw(&scene, &Settings { samples: 16, first_sample, ..settings.clone() }));
            let off = off_the_mean(&whole, &parts);
            assert!(off < 1e-6, "{filter:?}, lens {}: {off}", lens.is_some());
            assert!(off_the_mean(&whole, &[whole.clone(), parts[0].clone()]) > 1e-3, "the comparison passes anything");
        }
    }
}

#[test]
fn impossible_lenses_are_refused() {
    for (what, lens) in [
        ("aperture_radius", Lens { aperture_radius: -1.0, ..through(1.0).lens.expect("a lens") }),
        ("focus_distance", Lens { focus_distance: 0.0, ..through(1.0).lens.expect("a lens") }),
        ("ratio", Lens { ratio: f64::NAN, ..through(1.0).lens.expect("a lens") }),
    ] {
        let scene = lit(vec![thread()], Camera { lens: Some(lens), ..through(1.0) });
        let error = support::renderer()
            .render(&scene, &settings(1), &mut |_| std::ops::ControlFlow::Continue(()))
            .expect_err("a lens that cannot be");
        assert!(error.to_string().contains(what), "{error}");
    }
}
