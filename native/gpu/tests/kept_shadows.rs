//! Shadow maps that are there are not drawn again; where anything has changed that they show, they are.

mod support;

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::{Curves, Yarns};
use lisle_gpu::{Exposure, Labels, Light, Mesh, MeshKind, Renderer, Scene, Settings, Triangles};
use support::{another_renderer, curves, draw_with, exact, looking, measure, object, perspective, preset, scene, sun};

const SIZE: [u32; 2] = [64, 48];

fn cloth(radius: f32) -> Arc<Yarns> {
    Arc::new(Yarns::new(Curves::catmull_rom(curves::patch(4, 2.0, 40), false), Some(radius)).expect("valid"))
}

fn lit(yarns: &Arc<Yarns>) -> (Scene, Settings) {
    let camera = perspective(looking(DVec3::new(0.4, -3.0, 0.6), DVec3::ZERO), 0.3, SIZE, [0.0, 0.0]);
    let mut scene = scene(vec![object(yarns, &preset("cotton-1"))], camera);
    scene.lights = vec![sun([1.0, 2.0, -1.0], 2.0), sun([-1.0, 2.0, -0.3], 1.0)];
    scene.ambient = Vec3::new(0.2, 0.3, 0.4);
    (scene, Settings { sky_directions: 2, lod_pixels: 1.0, shadow_resolution: 128, ..exact(SIZE) })
}

/// A square between the light and the yarns, turned by an angle.
fn screen(angle_rad: f64) -> Mesh {
    let corners = [[-0.5, -1.2, 0.2], [0.5, -1.2, 0.2], [0.5, -1.2, 1.2], [-0.5, -1.2, 1.2]];
    let triangles = Triangles::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], None).expect("a square");
    Mesh {
        name: "screen".into(),
        id: 7,
        labels: Labels::default(),
        triangles: Arc::new(triangles),
        base_color: Vec3::ONE,
        texture: None,
        world_from_object: DMat4::from_rotation_y(angle_rad),
        kind: MeshKind::ShadowCatcher,
    }
}

type Change<'a> = &'a dyn Fn(&mut Scene);

/// How often a picture handed work to the adapter. It is the one that another renderer draws.
fn submissions(renderer: &Renderer, name: &str, scene: &Scene, settings: &Settings) -> u64 {
    let before = renderer.submissions();
    let drawn = draw_with(renderer, scene, settings);
    let taken = renderer.submissions() - before;
    assert!(measure::area(&drawn) > 100.0, "{name}: nothing is drawn");
    assert_eq!(measure::difference(&drawn, &draw_with(&another_renderer(), scene, settings)), None, "{name}");
    taken
}

#[test]
fn maps_are_drawn_again_only_where_they_would_differ() {
    let yarns = cloth(0.08);
    let (first, settings) = lit(&yarns);
    let renderer = another_renderer();
    let all = submissions(&renderer, "first", &first, &settings);
    let none = submissions(&renderer, "again", &first, &settings);
    assert!(none < all, "{none} submissions, the first time {all}");
    // The same from another strip, and with another picture's settings that maps do not hang on.
    let strip = Settings { region: Some([0, 10, SIZE[0], 20]), ..settings.clone() };
    assert_eq!(submissions(&renderer, "a strip", &first, &strip), none);
    let painted = {
        let mut scene = first.clone();
        let material = Arc::make_mut(&mut scene.objects[0].material);
        material.color_r *= 0.5;
        scene
    };
    assert_eq!(submissions(&renderer, "another colour", &painted, &settings), none);

    // Each beside the one before it, so that what it was is not what it is.
    let changed = |change: Change| {
        let mut scene = first.clone();
        change(&mut scene);
        scene
    };
    let bent: Vec<[f32; 3]> = yarns.rest_points().iter().map(|p| [p[0], p[1] + 0.3 * p[0].sin(), p[2]]).collect();
    let bent = Arc::new(yarns.with_points(&bent).expect("as many points"));
    let changes: [(&str, Change); 8] = [
        ("moved points", &|scene| scene.objects[0].yarns = Arc::clone(&bent)),
        ("another transform", &|scene| scene.objects[0].world_from_object = DMat4::from_rotation_z(0.3)),
        ("another radius", &|scene| scene.objects[0].yarns = cloth(0.05)),
        ("another kind of yarn", &|scene| scene.objects[0] = object(&yarns, &preset("silk-1"))),
        ("another light", &|scene| scene.lights[0] = sun([0.2, 1.0, -2.0], 2.0)),
        ("a mesh", &|scene| scene.meshes = vec![screen(0.0)]),
        ("a turned mesh", &|scene| scene.meshes = vec![screen(0.5)]),
        ("another eye", &|scene| scene.camera.world_from_camera = looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO)),
    ];
    for (name, change) in changes {
        let taken = submissions(&renderer, name, &changed(change), &settings);
        assert!(taken > none, "{name}: {taken} submissions");
    }
    assert!(submissions(&renderer, "finer maps", &first, &Settings { shadow_resolution: 200, ..settings }) > none);
}

#[test]
fn maps_of_what_moves_are_its_own() {
    let yarns = cloth(0.08);
    let (scene, settings) = lit(&yarns);
    let settings = Settings { samples: 3, filter_width: 1.5, ..settings };
    let mut end = scene.clone();
    end.objects[0].world_from_object = DMat4::from_rotation_z(0.2);
    let soft = Scene {
        lights: vec![Light::Sun { direction: DVec3::new(1.0, 2.0, -1.0), irradiance: Vec3::ONE, angle_rad: 0.3 }],
        ..scene.clone()
    };
    let renderer = another_renderer();
    let draw = |renderer: &Renderer, steps: &[&Scene]| {
        let exposure = Exposure { steps: steps.iter().map(|scene| (*scene).clone()).collect(), neighbours: None };
        renderer.expose(exposure, &settings, &mut |_| ControlFlow::Continue(())).expect("a picture")
    };
    for steps in [vec![&scene], vec![&scene, &end], vec![&scene], vec![&soft], vec![&scene, &end], vec![&soft]] {
        let (drawn, alone) = (draw(&renderer, &steps), draw(&another_renderer(), &steps));
        assert!(measure::area(&drawn) > 100.0, "nothing is drawn");
        assert_eq!(measure::difference(&drawn, &alone), None, "{} steps", steps.len());
    }
}
