//! The same input gives the same bits, whatever else was drawn and however the picture is cut.

mod support;

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::{Curves, Yarns};
use lisle_gpu::{Error, Image, Light, Object, Progress, Scene, Settings};
use support::{another_renderer, curves, draw, draw_with, exact, looking, measure, object, perspective, preset, scene};

const SIZE: [u32; 2] = [96, 64];

fn cloth() -> Arc<Yarns> {
    Arc::new(Yarns::new(Curves::catmull_rom(curves::patch(6, 2.0, 120), false), Some(0.08)).expect("valid"))
}

/// The same cloth, bent by a phase.
fn bent(cloth: &Yarns, phase: f32) -> Arc<Yarns> {
    let points: Vec<[f32; 3]> =
        cloth.rest_points().iter().map(|p| [p[0], p[1] + 0.2 * (2.0 * p[0] + phase).sin(), p[2]]).collect();
    Arc::new(cloth.with_points(&points).expect("as many points"))
}

/// Cloth under a soft light of every kind and the sky, with levels of detail and jitter: everything that draws lots.
fn soft_scene(yarns: &Arc<Yarns>, size: [u32; 2]) -> (Scene, Settings) {
    let camera = perspective(looking(DVec3::new(0.4, -3.0, 0.6), DVec3::ZERO), 0.3, size, [0.0, 0.0]);
    let mut scene = scene(vec![object(yarns, &preset("cotton-2"))], camera);
    scene.ambient = Vec3::new(0.2, 0.3, 0.4);
    let power = Vec3::splat(20.0);
    scene.lights = vec![
        Light::Sun { direction: DVec3::new(1.0, 1.0, -1.0), irradiance: Vec3::ONE, angle_rad: 0.1 },
        Light::Point { position: DVec3::new(1.0, -1.0, 1.0), power, radius: 0.2, cone: None },
        Light::Area {
            world_from_light: looking(DVec3::new(-1.0, -2.0, 1.0), DVec3::ZERO),
            size: [1.0, 0.5],
            ellipse: true,
            power,
        },
    ];
    let settings =
        Settings { samples: 3, lod_pixels: 1.0, filter_width: 1.5, seed: 5, shadow_resolution: 256, ..exact(size) };
    (scene, settings)
}

fn assert_same(name: &str, a: &Image, b: &Image) {
    assert!(measure::area(a) > 100.0, "{name}: nothing is drawn");
    assert_eq!(measure::difference(a, b), None, "{name}");
}

/// More draws than a uniform holds are read from a storage buffer: the same pictures, by other shaders.
#[test]
fn many_draws_look_as_few() {
    let yarns = Arc::new(Yarns::new(Curves::catmull_rom(curves::patch(3, 2.0, 12), false), Some(0.08)).expect("valid"));
    let of = |draws: usize| {
        let (mut scene, settings) = soft_scene(&yarns, SIZE);
        let object = scene.objects[0].clone();
        // Thirty places, with many copies in each: what is seen does not depend on how many.
        let at = |k: usize| DVec3::new((k % 6) as f64 - 2.5, 0.4 * (k % 5) as f64, (k % 5) as f64 - 2.0) * 0.4;
        scene.objects = (0..draws)
            .map(|k| Object { world_from_object: DMat4::from_translation(at(k % 30)), ..object.clone() })
            .collect();
        draw(&scene, &settings)
    };
    // Numbers of segments take as many bits of a key in both.
    let (few, many) = (of(600), of(720));
    assert!(measure::area(&few) > 1000.0, "nothing is drawn");
    assert!(few.combined == many.combined, "another picture");
    assert!(few.combined != of(20).combined, "copies are not told from no copies");
}

#[test]
fn a_picture_is_the_same_alone_again_and_after_others() {
    let cloth = cloth();
    let (scene, settings) = soft_scene(&cloth, SIZE);
    let alone = draw_with(&another_renderer(), &scene, &settings);
    let shared = another_renderer();
    assert_same("another renderer", &alone, &draw_with(&shared, &scene, &settings));
    assert_same("again", &alone, &draw_with(&shared, &scene, &settings));
    // Another size, scene, yarn and material in between; and a picture that was stopped half-way.
    let (mut other, other_settings) = soft_scene(&bent(&cloth, 1.0), [40, 30]);
    other.objects.insert(0, Object { id: 9, ..object(&cloth, &preset("rayon-1")) });
    other.lights.clear();
    draw_with(&shared, &other, &other_settings);
    assert_same("after another scene", &alone, &draw_with(&shared, &scene, &settings));
    let stopped = shared.render(&scene, &Settings { samples: 8, ..settings.clone() }, &mut |p| {
        if matches!(p, Progress::Samples { done: 2, .. }) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(stopped, Err(Error::Cancelled)));
    assert_same("after a cancelled picture", &alone, &draw_with(&shared, &scene, &settings));
    // What differs must be seen to differ.
    let reseeded = draw_with(&shared, &scene, &Settings { seed: 6, ..settings });
    assert!(!measure::identical(&alone, &reseeded), "the comparison passes anything");
}

#[test]
fn a_frame_is_the_same_alone_and_in_a_sequence() {
    let cloth = cloth();
    let frames: Vec<_> = (0..4).map(|i| bent(&cloth, 0.4 * i as f32)).collect();
    let sequence = another_renderer();
    let pictures: Vec<Image> = frames
        .iter()
        .map(|frame| {
            let (scene, settings) = soft_scene(frame, SIZE);
            draw_with(&sequence, &scene, &settings)
        })
        .collect();
    for number in [0, 3] {
        // From the points alone, as another process would.
        let alone = Arc::new(cloth.with_points(frames[number].points()).expect("as many points"));
        let (scene, settings) = soft_scene(&alone, SIZE);
        assert_same(&format!("frame {number}"), &draw_with(&another_renderer(), &scene, &settings), &pictures[number]);
    }
    assert!(!measure::identical(&pictures[0], &pictures[3]), "nothing moves");
}

#[test]
fn pictures_drawn_from_several_threads_are_the_same() {
    let cloth = cloth();
    let (scene, settings) = soft_scene(&cloth, SIZE);
    let (other, _) = soft_scene(&bent(&cloth, 2.0), SIZE);
    let shared = another_renderer();
    let expected = [draw_with(&shared, &scene, &settings), draw_with(&shared, &other, &settings)];
    std::thread::scope(|scope| {
        let drawn: Vec<_> = (0..4)
            .map(|i| {
                let (shared, scene, settings) = (&shared, if i % 2 == 0 { &scene } else { &other }, &settings);
                scope.spawn(move || draw_with(shared, scene, settings))
            })
            .collect();
        for (i, handle) in drawn.into_iter().enumerate() {
            assert_same(&format!("thread {i}"), &handle.join().expect("drawn"), &expected[i % 2]);
        }
    });
}

#[test]
fn a_region_is_the_crop_of_the_whole() {
    let (scene, settings) = soft_scene(&cloth(), SIZE);
    let whole = draw(&scene, &settings);
    for region in [[0, 0, 96, 64], [30, 20, 41, 27], [95, 0, 1, 64], [17, 63, 60, 1]] {
        let part = draw(&scene, &Settings { region: Some(region), ..settings.clone() });
        let expected = measure::crop(&whole, region);
        assert_eq!(measure::difference(&part, &expected), None, "{region:?}");
    }
    let moved = measure::crop(&whole, [31, 20, 41, 27]);
    let part = draw(&scene, &Settings { region: Some([30, 20, 41, 27]), ..settings });
    assert!(!measure::identical(&part, &moved), "the comparison passes anything");
}

#[test]
fn tiles_are_the_crops_of_a_whole() {
    // Wider than the 2048 pixels of a tile: cuts that lie on either side of the seam, in it and across it.
    let (scene, settings) = soft_scene(&cloth(), [2100, 40]);
    let whole = draw(&scene, &settings);
    assert!(measure::area(&measure::crop(&whole, [900, 0, 300, 40])) > 100.0, "nothing is drawn");
    for region in [[0, 0, 1000, 40], [1000, 0, 1100, 40], [2040, 10, 16, 20], [900, 5, 300, 30]] {
        let part = draw(&scene, &Settings { region: Some(region), ..settings.clone() });
        assert_eq!(measure::difference(&part, &measure::crop(&whole, region)), None, "{region:?}");
    }
}

#[test]
fn instances_are_the_objects_that_they_stand_for() {
    let yarns = cloth();
    let (mut scene, settings) = soft_scene(&yarns, SIZE);
    let shared = object(&yarns, &preset("cotton-2"));
    scene.objects = (0..3)
        .map(|i| Object {
            id: 3 + i,
            world_from_object: DMat4::from_translation(DVec3::new(0.0, 0.3 * f64::from(i), 0.4 * f64::from(i) - 0.4)),
            ..shared.clone()
        })
        .collect();
    let instances = draw(&scene, &settings);
    let mut copies = scene.clone();
    for object in &mut copies.objects {
        object.yarns = cloth();
    }
    let copied = draw(&copies, &settings);
    assert_same("copies of the curves", &instances, &copied);
    assert!(copied.statistics.knot_bytes > instances.statistics.knot_bytes, "instances share their curves");
    // Ids seed the fibers: the same place with another id is another picture.
    scene.objects[0].id = 40;
    assert!(!measure::identical(&instances, &draw(&scene, &settings)));
}
