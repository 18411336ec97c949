//! Odd input gives the right picture or an error that names it; never a crash, a NaN or a silent blank.

mod support;

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;
use lisle_core::{Curves, Yarns};
use lisle_gpu::{Camera, Error, Image, Light, Mesh, MeshKind, Object, Renderer, Scene, Settings, Shading, Triangles};
use support::{
    curves, draw, exact, looking, measure, object, orthographic, perspective, picture, preset, scene, sun, try_draw,
    yarns_of,
};

const SIZE: [u32; 2] = [96, 64];

fn front() -> DMat4 {
    looking(DVec3::new(0.3, -3.0, 0.4), DVec3::ZERO)
}

fn camera() -> Camera {
    perspective(front(), 0.25, SIZE, [0.0, 0.0])
}

fn settings() -> Settings {
    Settings { lod_pixels: 1.0, samples: 2, filter_width: 1.5, shadow_resolution: 256, ..exact(SIZE) }
}

fn wave() -> Object {
    object(&yarns_of(curves::wave(2.0, 0.25, 60), false, 0.15), &preset("cotton-1"))
}

fn lit(objects: Vec<Object>, camera: Camera) -> Scene {
    let mut scene = scene(objects, camera);
    scene.ambient = Vec3::splat(0.4);
    scene.lights = vec![sun([1.0, 1.0, -1.0], 2.0)];
    scene
}

/// Draws in both shadings; nothing may be NaN.
fn finite(name: &str, scene: &Scene) -> Image {
    let simple = draw(scene, &Settings { shading: Shading::Simple, ..settings() });
    assert_eq!(measure::not_finite(&simple), 0, "{name}, simple shading");
    let image = draw(scene, &settings());
    assert_eq!(measure::not_finite(&image), 0, "{name}");
    picture::show(&format!("robust {name}"), &image);
    image
}

#[test]
fn an_empty_scene_is_the_background() {
    for transparent in [true, false] {
        let image = draw(&lit(vec![], camera()), &Settings { transparent, ..settings() });
        let expected = if transparent { [0.0; 4] } else { [0.4, 0.4, 0.4, 1.0] };
        let close = |c: &[f32; 4]| c.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(image.combined.iter().all(close), "{:?}", image.combined[0]);
        assert!(image.depth.iter().all(|d| *d == Image::EMPTY_DEPTH) && image.object_id.iter().all(|id| *id == 0));
    }
}

#[test]
fn cameras_in_odd_places_draw_what_they_see() {
    let looks = |eye: [f64; 3], target: [f64; 3]| {
        perspective(looking(DVec3::from(eye), DVec3::from(target)), 0.25, SIZE, [0.0, 0.0])
    };
    // Inside the yarn, on its axis: something is in front of every pixel but those along the axis.
    let inside = finite("camera inside", &lit(vec![wave()], looks([0.0, 0.0, 0.0], [1.0, 0.05, 0.05])));
    println!("inside: area {}", measure::area(&inside));
    assert!(measure::area(&inside) > 0.3 * 96.0 * 64.0, "{}", measure::area(&inside));
    let away = finite("camera away", &lit(vec![wave()], looks([0.0, -3.0, 0.0], [0.0, -6.0, 0.0])));
    assert_eq!(measure::area(&away), 0.0, "a yarn behind the camera is drawn");
    let along = finite("camera along", &lit(vec![wave()], looks([4.0, 0.0, 0.0], [0.0, 0.0, 0.0])));
    assert!(measure::area(&along) > 50.0);
    let far = finite("camera far", &lit(vec![wave()], looks([0.0, -3000.0, 0.0], [0.0, 0.0, 0.0])));
    assert!(measure::area(&far) < 2.0);
    // Part of the yarn behind an orthographic camera's plane.
    let cut = orthographic(looking(DVec3::new(0.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.1)), 1.0, SIZE, [0.0, 0.0]);
    finite("orthographic through", &lit(vec![wave()], cut));
}

fn refused(name: &str, scene: &Scene, settings: &Settings, part: &str) {
    match try_draw(scene, settings) {
        Ok(_) => panic!("{name}: drawn"),
        Err(error) => {
            println!("{name}: {error}");
            assert!(error.to_string().contains(part), "{name}: \"{error}\" does not name {part}");
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_named() {
    let good = lit(vec![wave()], camera());
    for region in [[0, 0, 0, 5], [0, 0, 5, 0], [90, 0, 10, 5], [0, 64, 1, 1], [u32::MAX, 0, 2, 2]] {
        refused("region", &good, &Settings { region: Some(region), ..settings() }, "region");
    }
    refused("size", &good, &Settings { size: [0, 64], ..settings() }, "size");
    refused("samples", &good, &Settings { samples: 0, ..settings() }, "samples");
    refused("lod", &good, &Settings { lod_pixels: f32::NAN, ..settings() }, "lod_pixels");
    refused("filter", &good, &Settings { filter_width: -1.0, ..settings() }, "filter_width");
    refused("shadow", &good, &Settings { shadow_resolution: 0, ..settings() }, "shadow_resolution");
    let mut nan = good.clone();
    nan.camera.world_from_camera.w_axis.x = f64::NAN;
    refused("NaN in the camera's place", &nan, &settings(), "camera");
    let mut flat = good.clone();
    flat.camera.world_from_camera.x_axis = glam::DVec4::ZERO;
    refused("a camera without width", &flat, &settings(), "camera");
    let mut none = good.clone();
    none.camera.clip_from_camera = DMat4::ZERO;
    refused("no projection", &none, &settings(), "camera");
    for (name, matrix) in [
        ("NaN", DMat4::from_translation(DVec3::new(0.0, f64::NAN, 0.0))),
        ("flat", DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))),
    ] {
        let object = Object { name: "left sleeve".into(), world_from_object: matrix, ..wave() };
        refused(name, &lit(vec![object], camera()), &settings(), "left sleeve");
    }
    let mut light = good.clone();
    light.lights = vec![sun([1.0, 0.0, 0.0], 1.0), sun([0.0, 0.0, 0.0], 1.0)];
    refused("a sun without direction", &light, &settings(), "light 1");
    let mut negative = good.clone();
    negative.ambient = Vec3::new(0.0, -1.0, 0.0);
    refused("a negative sky", &negative, &settings(), "ambient");
    let bad = Object { yarn: Arc::new(Yarn { r_min: 2.0, ..preset("silk-1") }), ..wave() };
    refused("a yarn out of range", &lit(vec![bad], camera()), &settings(), "r_min");
    let silk = Material::preset("silk").expect("preset");
    let bad = Object { material: Arc::new(Material { beta_r_rad: 0.0, ..silk }), ..wave() };
    refused("a material out of range", &lit(vec![bad], camera()), &settings(), "beta_r_rad");
    let missing = Renderer::new(Some("no such adapter"));
    assert!(matches!(missing, Err(Error::NoAdapter { .. })));
    // The renderer still works.
    assert!(measure::area(&draw(&good, &settings())) > 100.0);
}

#[test]
fn a_tall_picture_with_a_mesh_is_drawn_in_tiles() {
    // Taller than textures are.
    let size = [2, 40_000];
    let camera = orthographic(front(), 2.0, size, [0.0, 0.0]);
    let corners = vec![[-9.0, 1.0, -9.0], [9.0, 1.0, -9.0], [9.0, 1.0, 9.0], [-9.0, 1.0, 9.0]];
    let mesh = Mesh {
        name: "wall".into(),
        id: 7,
        labels: Default::default(),
        triangles: Arc::new(Triangles::new(corners, vec![[0, 1, 2], [0, 2, 3]], None).expect("a square")),
        base_color: Vec3::ONE,
        texture: None,
        kind: MeshKind::Shaded,
        world_from_object: DMat4::IDENTITY,
    };
    let scene = Scene { meshes: vec![mesh], ..scene(vec![], camera) };
    let image = draw(&scene, &Settings { samples: 1, size, ..settings() });
    assert!(image.object_id.iter().all(|id| *id == 7));
}

#[test]
fn mirrored_and_uneven_transforms_are_drawn() {
    let area = |matrix: DMat4| {
        let object = Object { world_from_object: matrix, ..wave() };
        measure::area(&finite("transform", &lit(vec![object], camera())))
    };
    let plain = area(DMat4::IDENTITY);
    let mirrored = area(DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0)));
    println!("plain {plain:.0}, mirrored {mirrored:.0}");
    assert!((mirrored / plain - 1.0).abs() < 0.2);
    for scale in [[2.0, 0.5, 1.0], [1.0, 1.0, 0.02], [0.01, 1.0, 1.0], [-1.0, 1.0, 3.0]] {
        let area = area(DMat4::from_scale(DVec3::from(scale)));
        println!("{scale:?}: {area:.0}");
        assert!(area > 20.0, "{scale:?}: {area}");
    }
    // A shear.
    let mut shear = DMat4::IDENTITY;
    shear.y_axis.x = 0.7;
    assert!(area(shear) > 100.0);
}

/// Share of the covered pixels whose colours or alpha differ by more than a hundredth.
fn changed(a: &Image, b: &Image) -> f64 {
    let differs = |(a, b): (&[f32; 4], &[f32; 4])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 0.01);
    a.combined.iter().zip(&b.combined).filter(|pair| differs(*pair)).count() as f64 / measure::area(a)
}

#[test]
fn a_million_metres_from_the_origin_the_picture_is_the_same() {
    let far = DVec3::new(1e6, -2e6, 0.7e6);
    let move_by = |camera: Camera, by: DVec3| Camera {
        world_from_camera: DMat4::from_translation(by) * camera.world_from_camera,
        ..camera
    };
    let at_origin = draw(&lit(vec![wave()], camera()), &settings());
    // By the object's own transform: nothing is lost.
    let moved = Object { world_from_object: DMat4::from_translation(far), ..wave() };
    let image = draw(&lit(vec![moved], move_by(camera(), far)), &settings());
    println!("by transform: {:.4} of the pixels differ", changed(&at_origin, &image));
    assert!(changed(&at_origin, &image) < 0.02, "{}", changed(&at_origin, &image));
    // By the points, which f32 rounds to a sixteenth: a yarn large enough that this is little.
    let size = 2000.0;
    let large = |at: DVec3| {
        let points = curves::wave(2.0 * size, 0.25 * size, 60)
            .into_iter()
            .map(|p| (Vec3::from(p).as_dvec3() + at).as_vec3().to_array())
            .collect();
        object(&yarns_of(points, false, (0.15 * size) as f32), &preset("cotton-1"))
    };
    let view = perspective(looking(DVec3::new(0.3, -3.0, 0.4) * size, DVec3::ZERO), 0.25, SIZE, [0.0, 0.0]);
    let near = draw(&lit(vec![large(DVec3::ZERO)], view), &settings());
    let distant = draw(&lit(vec![large(far)], move_by(view, far)), &settings());
    println!("by points: {:.4} of the pixels differ", changed(&near, &distant));
    assert!(measure::area(&near) > 300.0 && changed(&near, &distant) < 0.05, "{}", changed(&near, &distant));
}

#[test]
fn yarns_of_any_size_and_make_are_drawn() {
    let short = yarns_of(vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], false, 0.15);
    let base = preset("cotton-1");
    let plain = support::without_flyaways(base.clone());
    let cases = [
        ("one segment", object(&short, &base), 100.0),
        ("one ply, one fiber", object(&short, &Yarn { plies: 1, fibers_per_ply: 1, ..base.clone() }), 3.0),
        ("60,000 fibers", object(&short, &Yarn { plies: 4, fibers_per_ply: 15_000, ..base.clone() }), 100.0),
        ("one ply of 60,000", object(&short, &Yarn { plies: 1, fibers_per_ply: 60_000, ..base.clone() }), 100.0),
        ("4000 plies", object(&short, &Yarn { plies: 4000, fibers_per_ply: 1, ..base.clone() }), 100.0),
        ("no flyaways", object(&short, &plain), 100.0),
        ("thick fibers", object(&short, &Yarn { fiber_radius: 0.05, ..base.clone() }), 100.0),
        ("no migration", object(&short, &Yarn { r_min: 1.0, ..base.clone() }), 100.0),
        ("fibers through the centre", object(&short, &Yarn { r_min: 0.0, ..base.clone() }), 100.0),
        ("tight twist", object(&short, &Yarn { fiber_twist: 0.001, ply_twist: -0.001, ..base.clone() }), 100.0),
        ("huge radius", object(&yarns_of(curves::straight(2.0, 8), false, 50.0), &base), 100.0),
        ("tiny radius", object(&yarns_of(curves::straight(2.0, 8), false, 1e-6), &base), -1.0),
    ];
    for (name, object, least) in cases {
        let image = finite(name, &lit(vec![object], camera()));
        println!("{name}: area {:.1}, brightness {:.3}", measure::area(&image), measure::brightness(&image));
        assert!(measure::area(&image) > least, "{name}: {}", measure::area(&image));
    }
}

#[test]
fn curves_of_repeated_points_are_drawn_without_nan() {
    let p = [0.2, 0.0, 0.1];
    for (name, points, closed) in [
        ("repeated point", vec![[-1.0, 0.0, 0.0], p, p, p, [1.0, 0.0, 0.0]], false),
        ("there and back", vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], false),
        ("closed triangle", vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.6]], true),
    ] {
        let Ok(yarns) = Yarns::new(Curves::catmull_rom(vec![points], closed), Some(0.1)) else {
            println!("{name}: refused");
            continue;
        };
        let image = finite(name, &lit(vec![object(&Arc::new(yarns), &preset("silk-1"))], camera()));
        assert!(measure::area(&image) > 50.0, "{name}");
    }
}

#[test]
fn lights_within_the_yarn_and_without_size_give_finite_pictures() {
    let power = Vec3::splat(1.0);
    for (name, light) in [
        ("point inside", Light::Point { position: DVec3::new(0.1, 0.0, 0.0), power, radius: 0.0, cone: None }),
        ("large point", Light::Point { position: DVec3::new(0.1, 0.0, 0.0), power, radius: 2.0, cone: None }),
        (
            "area without size",
            Light::Area {
                world_from_light: looking(DVec3::new(0.0, -1.0, 1.0), DVec3::ZERO),
                size: [0.0, 0.0],
                ellipse: false,
                power,
            },
        ),
        ("point far away", Light::Point { position: DVec3::new(0.0, -1e5, 1e5), power, radius: 0.0, cone: None }),
    ] {
        let mut scene = lit(vec![wave()], camera());
        scene.lights = vec![light];
        finite(name, &scene);
    }
}

#[test]
fn more_points_than_a_key_has_numbers_for_are_refused() {
    // Instances share their points, and count each.
    let yarns = yarns_of(curves::straight(2.0, 10_001), false, 0.05);
    let yarn = Yarn { plies: 4, fibers_per_ply: 15_000, ..preset("cotton-1") };
    let scene = |count| lit(vec![object(&yarns, &yarn); count], camera());
    let error = try_draw(&scene(106), &settings()).expect_err("too many points");
    let Error::Input { what, reason } = &error else { panic!("{error}") };
    assert_eq!(what, "scene");
    assert!(reason.contains("1060318 control points") && reason.contains("too many for one picture"), "{reason}");
    assert!(measure::area(&draw(&scene(1), &settings())) > 100.0, "the next picture");
}

#[test]
fn twelve_million_points_are_drawn_and_more_than_a_buffer_holds_work_for_are_refused() {
    // Rows of a cloth of which the camera sees a hundredth.
    let row = |k: usize| {
        let (x, z) = (2.0 * (k % 1000) as f64 / 999.0 - 1.0, 0.01 * (k / 1000) as f64 - 0.5);
        DVec3::new(x, 0.0, z).as_vec3().to_array()
    };
    let curves = (0..12_000).map(|i| (1000 * i..1000 * (i + 1)).map(row).collect()).collect();
    let yarns = Arc::new(Yarns::new(Curves::catmull_rom(curves, false), Some(1e-4)).expect("valid curves"));
    let settings = Settings { samples: 1, ..settings() };
    let cloth = object(&yarns, &preset("cotton-1"));
    let image = draw(&lit(vec![cloth.clone()], camera()), &settings);
    assert_eq!(measure::not_finite(&image), 0);
    println!("area {:.1}, brightness {:.3}", measure::area(&image), measure::brightness(&image));
    assert!(measure::area(&image) > 40.0, "{}", measure::area(&image));

    // Instances share their points; work is counted for each.
    match try_draw(&lit(vec![cloth; 3], camera()), &settings) {
        Ok(image) => assert!(measure::area(&image) > 40.0, "an adapter with larger buffers"),
        Err(error) => {
            let said = error.to_string();
            assert!(said.contains("work of segments need 137 MiB; a buffer holds at most"), "{said}");
        }
    }
}
