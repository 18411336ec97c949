//! Motion blur: how wide, of what, and that a still frame does not know of it.

mod support;

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_gpu::{Camera, Exposure, Image, Object, Scene, Settings};
use support::{curves, draw, exact, expose, looking, measure, object, orthographic, preset, scene, yarns_of};

const SIZE: [u32; 2] = [100, 80];

/// Two units are 80 pixels.
fn camera() -> Camera {
    orthographic(looking(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO), 2.0, SIZE, [0.0, 0.0])
}

fn thread() -> Object {
    object(&yarns_of(curves::straight(6.0, 24), false, 0.02), &preset("silk-1"))
}

fn settings(samples: u32) -> Settings {
    Settings { samples, lod_pixels: 1.0, filter_width: 1.5, ..exact(SIZE) }
}

fn steps(steps: &[Scene]) -> Exposure {
    Exposure { steps: steps.to_vec(), neighbours: None }
}

fn up(by: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(0.0, 0.0, by))
}

fn by_object(object: Object, by: f64) -> Scene {
    scene(vec![Object { world_from_object: up(by), ..object }], camera())
}

fn by_camera(object: Object, by: f64) -> Scene {
    let camera = Camera { world_from_camera: up(-by) * camera().world_from_camera, ..camera() };
    scene(vec![object], camera)
}

fn by_points(object: Object, by: f64) -> Scene {
    let moved: Vec<_> =
        object.yarns.points().iter().map(|p| (Vec3::from(*p) + Vec3::Z * by as f32).to_array()).collect();
    let yarns = Arc::new(object.yarns.with_points(&moved).expect("as many points"));
    scene(vec![Object { yarns, ..object }], camera())
}

/// Mean row of what is covered, and the variance about it.
fn rows(image: &Image) -> (f64, f64) {
    let (mut area, mut first, mut second) = (0.0, 0.0, 0.0);
    for (i, color) in image.combined.iter().enumerate() {
        let (alpha, place) = (f64::from(color[3]), f64::from(i as u32 / SIZE[0]) + 0.5);
        (area, first, second) = (area + alpha, first + alpha * place, second + alpha * place * place);
    }
    (first / area, second / area - (first / area).powi(2))
}

#[test]
fn what_moves_is_spread_over_its_way() {
    let own = rows(&draw(&by_object(thread(), 0.0), &settings(64))).1;
    for (what, moved) in
        [("object", &by_object as &dyn Fn(Object, f64) -> Scene), ("camera", &by_camera), ("points", &by_points)]
    {
        let thread = thread();
        // 20 pixels up, evenly: a variance of 400 / 12.
        let image = expose(&steps(&[moved(thread.clone(), -0.2), moved(thread.clone(), 0.3)]), &settings(128));
        let (mean, variance) = rows(&image);
        println!("{what}: mean {mean:.2}, variance {variance:.2}");
        assert!((mean - 38.0).abs() < 0.3, "{what}: {mean}");
        assert!((variance / (400.0 / 12.0 + own) - 1.0).abs() < 0.03, "{what}: {variance}");
        // Halfway it stands still: half of it is there, the rest is spread.
        let stops = [moved(thread.clone(), -0.2), moved(thread.clone(), 0.3), moved(thread.clone(), 0.3)];
        let (mean, _) = rows(&expose(&steps(&stops), &settings(128)));
        assert!((mean - (38.0 + 28.0) / 2.0).abs() < 0.5, "{what}: {mean}");
        // What belongs to the pixel's centre is of the middle.
        let sharp = draw(&moved(thread.clone(), 0.05), &settings(1));
        let differ = image.object_id.iter().zip(&sharp.object_id).filter(|(a, b)| a != b).count();
        assert!(differ < 30, "{what}: {differ}");
    }
}

#[test]
fn shadows_move_along() {
    // A thread over a wall of yarn, lit from the front: its shadow is blurred as it is.
    let wall = object(&yarns_of(curves::straight(6.0, 24), false, 0.5), &preset("cotton-1"));
    let wall = Object { id: 2, world_from_object: DMat4::from_translation(DVec3::new(0.0, 1.0, 0.0)), ..wall };
    let thread = object(&yarns_of(curves::straight(6.0, 24), false, 0.05), &preset("silk-1"));
    let at = |by: f64| {
        let mut scene = by_object(thread.clone(), 0.6 + by);
        scene.objects.push(wall.clone());
        scene.ambient = Vec3::ZERO;
        scene.lights = vec![support::sun([0.0, 1.0, -0.6], 3.0)];
        scene
    };
    let settings = Settings { shadow_resolution: 1024, transport_photons: 0, ..settings(64) };
    let dark = |image: &Image| {
        let wall = draw(&Scene { objects: vec![wall.clone()], ..at(0.0) }, &settings);
        let rows = SIZE[1] as usize;
        let mut lost = vec![0.0; rows];
        for (i, (a, b)) in wall.combined.iter().zip(&image.combined).enumerate() {
            if image.object_id[i] == 2 {
                lost[i / SIZE[0] as usize] += f64::from(a[0] - b[0]);
            }
        }
        lost.into_iter().fold(0.0, f64::max)
    };
    let sharp = dark(&draw(&at(0.0), &settings));
    let blurred = dark(&expose(&steps(&[at(-0.15), at(0.15)]), &settings));
    println!("darkest row of the shadow: {sharp:.1}, moving {blurred:.1}");
    assert!(blurred < 0.6 * sharp && blurred > 0.1 * sharp);
}

#[test]
fn a_turning_object_keeps_its_length() {
    let bar = object(&yarns_of(curves::straight(1.6, 20), false, 0.05), &preset("silk-1"));
    let turned =
        |angle: f64| scene(vec![Object { world_from_object: DMat4::from_rotation_y(angle), ..bar.clone() }], camera());
    let image = expose(&steps(&[turned(0.0), turned(2.0)]), &settings(64));
    // The tip's circle, 32 pixels, is reached in the middle of the turn.
    let reach = |image: &Image| {
        let center = [0.5 * f64::from(SIZE[0]), 0.5 * f64::from(SIZE[1])];
        let at = |i: usize| {
            let (x, y) = (f64::from(i as u32 % SIZE[0]) + 0.5, f64::from(i as u32 / SIZE[0]) + 0.5);
            (x - center[0], y - center[1])
        };
        let covered = image.combined.iter().enumerate().filter(|(_, color)| color[3] > 0.0).map(|(i, _)| at(i));
        // Near the direction of the middle, one radian.
        let middle = covered.filter(|(x, y)| (y.abs().atan2(x.abs()) - 1.0).abs() < 0.2);
        middle.map(|(x, y)| x.hypot(y)).fold(0.0, f64::max)
    };
    let found = reach(&image);
    assert!((found - 32.0).abs() < 1.5, "{found}");
}

#[test]
fn frames_do_not_depend_on_what_was_drawn_before() {
    let wave = object(&yarns_of(curves::wave(1.5, 0.4, 30), false, 0.08), &preset("cotton-1"));
    let moving = |from: f64| [by_points(wave.clone(), from), by_points(wave.clone(), from + 0.2)];
    let settings = settings(6);
    let (first, second) = (moving(0.0), moving(0.2));
    let alone = support::another_renderer()
        .expose(steps(&second), &settings, &mut |_| std::ops::ControlFlow::Continue(()))
        .expect("a picture");
    expose(&steps(&first), &settings);
    assert_eq!(measure::difference(&expose(&steps(&second), &settings), &alone), None);
    // A still one after it, of a shape that the buffers held at first.
    let still = draw(&second[0], &settings);
    let fresh = support::draw_with(&support::another_renderer(), &second[0], &settings);
    assert_eq!(measure::difference(&still, &fresh), None);
    assert!(measure::difference(&still, &alone).is_some());
}

#[test]
fn a_scene_that_stays_is_a_still() {
    let wave = object(&yarns_of(curves::wave(1.5, 0.4, 30), false, 0.08), &preset("cotton-1"));
    let scene = scene(vec![wave], camera());
    let settings = settings(6);
    let three = expose(&steps(&[scene.clone(), scene.clone(), scene.clone()]), &settings);
    assert_eq!(measure::difference(&three, &draw(&scene, &settings)), None);
}

#[test]
fn scenes_that_do_not_correspond_are_refused() {
    let refused = |scenes: &[Scene], words: &str| {
        let result =
            support::renderer().expose(steps(scenes), &settings(1), &mut |_| std::ops::ControlFlow::Continue(()));
        let error = result.expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    };
    let here = by_object(thread(), 0.0);
    refused(&[], "time steps");
    refused(&[here.clone(), scene(vec![], camera())], "time step 1: 0 objects");
    refused(&[here.clone(), by_object(thread(), 0.1)], "time step 1, object \"yarn\"");
    let mut flat = here.clone();
    flat.objects[0].world_from_object = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
    refused(&[here, flat], "scale of zero");
}
