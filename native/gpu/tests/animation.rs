//! Frames of an animation: only what moves is sent, and the picture is that of a fresh start.

mod support;

use std::sync::Arc;

use glam::DVec3;
use lisle_core::{Curves, Yarns};
use lisle_gpu::{Object, Scene, Settings};
use support::{
    another_renderer, curves, draw_with, exact, looking, measure, object, perspective, picture, preset, scene, sun,
};

const SIZE: [u32; 2] = [96, 64];

fn cloth() -> Yarns {
    Yarns::new(Curves::catmull_rom(curves::patch(6, 2.0, 120), false), Some(0.08)).expect("valid")
}

fn moved(yarns: &Yarns, by: f32) -> Arc<Yarns> {
    let points: Vec<[f32; 3]> =
        yarns.points().iter().map(|p| [p[0], p[1] + by * (3.0 * p[0]).sin(), p[2] + 0.5 * by]).collect();
    Arc::new(yarns.with_points(&points).expect("as many points"))
}

fn picture_of(objects: Vec<Object>) -> (Scene, Settings) {
    let camera = perspective(looking(DVec3::new(0.4, -3.0, 0.6), DVec3::ZERO), 0.3, SIZE, [0.0, 0.0]);
    let mut scene = scene(objects, camera);
    scene.lights = vec![sun([1.0, 1.0, -1.0], 2.0)];
    (scene, Settings { samples: 2, filter_width: 1.5, lod_pixels: 1.0, shadow_resolution: 256, ..exact(SIZE) })
}

#[test]
fn only_what_moves_is_sent() {
    let renderer = another_renderer();
    let rest = cloth();
    let (still, first, second) = (Arc::new(cloth()), moved(&rest, 0.0), moved(&rest, 0.1));
    // Each of the six open curves has one knot more at either end.
    let knots = (rest.points().len() + 2 * 6) as u64;
    let standing = object(&still, &preset("cotton-2"));
    let moving = Object { id: 2, ..object(&first, &preset("silk-1")) };
    let upload = |objects: Vec<Object>| {
        let (scene, settings) = picture_of(objects);
        draw_with(&renderer, &scene, &settings).statistics.uploaded_bytes
    };
    let fresh = upload(vec![standing.clone(), moving.clone()]);
    assert!(fresh >= 2 * 28 * knots, "{fresh} bytes for {knots} knots, twice");
    assert_eq!(upload(vec![standing.clone(), moving.clone()]), 0, "nothing moves");
    let next = Object { yarns: second, ..moving.clone() };
    let step = upload(vec![standing.clone(), next.clone()]);
    println!("first picture {fresh} bytes, next frame {step}");
    // Position, 12 bytes, and normal, 4, of the moving knots alone.
    assert_eq!(step, 16 * knots);
    assert_eq!(upload(vec![standing, next]), 0, "nothing moves any more");
}

#[test]
fn a_moved_frame_is_the_frame_sent_afresh() {
    let renderer = another_renderer();
    let standing = object(&Arc::new(cloth()), &preset("silk-1"));
    // Its knots begin within a row of their texture, fill the next and end within the third.
    let rest = Yarns::new(Curves::catmull_rom(curves::patch(6, 2.0, 1700), false), Some(0.08)).expect("valid");
    for (step, by) in [0.0, 0.05, 0.1, -0.2].into_iter().enumerate() {
        let moving = Object { id: 2, ..object(&moved(&rest, by), &preset("cotton-2")) };
        let (scene, settings) = picture_of(vec![standing.clone(), moving]);
        let image = draw_with(&renderer, &scene, &settings);
        let afresh = draw_with(&another_renderer(), &scene, &settings);
        assert!(measure::area(&image) > 100.0);
        assert_eq!(measure::difference(&image, &afresh), None, "step {step}");
    }
}

#[test]
fn changes_that_are_no_frames_are_noticed() {
    // Other radii, another yarn, other length coordinates, one object more: all must show, none may use what was sent before.
    let renderer = another_renderer();
    let rest = cloth();
    let base = object(&Arc::new(rest.clone()), &preset("cotton-2"));
    let thin = Arc::new(Yarns::new(Curves::catmull_rom(curves::patch(6, 2.0, 120), false), Some(0.06)).expect("valid"));
    let stretched: Vec<f32> = rest.length_coordinates().iter().map(|s| 1.5 * s).collect();
    let stretched = Arc::new(rest.with_length_coordinates(&stretched).expect("valid"));
    let other_yarn = object(&base.yarns, &preset("rayon-1"));
    let more =
        Object { id: 3, world_from_object: glam::DMat4::from_translation(DVec3::new(0.0, 0.0, 0.5)), ..base.clone() };
    for (name, objects) in [
        ("base", vec![base.clone()]),
        ("thinner", vec![Object { yarns: thin, ..base.clone() }]),
        ("other lengths", vec![Object { yarns: stretched, ..base.clone() }]),
        ("another yarn", vec![other_yarn]),
        ("one object more", vec![base.clone(), more]),
        ("none", vec![]),
        ("back", vec![base]),
    ] {
        let (scene, settings) = picture_of(objects);
        let image = draw_with(&renderer, &scene, &settings);
        let afresh = draw_with(&another_renderer(), &scene, &settings);
        assert_eq!(measure::difference(&image, &afresh), None, "{name}");
    }
}

#[test]
fn two_million_control_points_occupy_at_most_64_mib_and_are_drawn() {
    let garment = lisle_fabric::sweater(2_000_000).expect("a sweater");
    let points = garment.points.len();
    let yarns = Arc::new(Yarns::new(garment, None).expect("valid"));
    let camera = perspective(looking(DVec3::new(0.0, -2.0, 0.3), DVec3::new(0.0, 0.0, 0.3)), 0.2, SIZE, [0.0, 0.0]);
    let mut scene = scene(vec![object(&yarns, &preset("cotton-2"))], camera);
    let settings = Settings { lod_pixels: 1.0, ..exact(SIZE) };
    scene.lights = vec![sun([1.0, 1.0, -1.0], 2.0)];
    let renderer = another_renderer();
    let image = draw_with(&renderer, &scene, &settings);
    let statistics = &image.statistics;
    let megabytes = statistics.knot_bytes as f64 / f64::from(1 << 20);
    println!(
        "{points} points, {} segments: {megabytes:.2} MiB, area {:.0} px",
        statistics.segments,
        measure::area(&image)
    );
    picture::show("sweater", &image);
    assert!(points > 1_900_000, "{points}");
    assert!(megabytes <= 64.0 * points as f64 / 2e6, "{megabytes} MiB");
    assert!(measure::area(&image) > 1000.0, "nothing is drawn");
    assert_eq!(measure::not_finite(&image), 0);
}
