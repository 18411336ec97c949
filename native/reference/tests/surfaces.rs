//! Meshes among fibers: what they hide, shade and reflect, by formulas.

mod support;

use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::scene::{Camera, Mesh, MeshKind, Scene, Shading, Triangles};
use lisle_reference::{Image, Settings};
use support::{RADIUS, draw, lambert, looking, mean, object, orthographic, scene, single_fiber, straight, sun};

const SIZE: [u32; 2] = [4, 600];
const COLOR: f32 = 0.6;
const HEIGHT: f64 = 10.0 * RADIUS;

/// A triangle mesh at its place in the world.
fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
    let positions = positions.iter().map(|p| p.map(|c| c as f32)).collect();
    Mesh {
        name: "mesh".into(),
        id: 7,
        labels: Default::default(),
        triangles: Arc::new(Triangles::new(positions, triangles.to_vec(), None).expect("a mesh")),
        base_color: Vec3::splat(COLOR),
        texture: None,
        kind: MeshKind::Shaded,
        world_from_object: DMat4::IDENTITY,
    }
}

/// A rectangle at a height, from one corner to the other.
fn level(z: f64, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Mesh {
    mesh(&[[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]], &[[0, 1, 2], [0, 2, 3]])
}

fn floor() -> Mesh {
    level(0.0, [-100.0; 2], [100.0; 2])
}

/// Looks down at a frame of that height about the X axis.
fn above() -> Camera {
    orthographic(looking(DVec3::Z * 10.0, DVec3::ZERO), HEIGHT, SIZE)
}

fn settings(samples: u32, bounces: Option<u32>) -> Settings {
    Settings { size: SIZE, samples, bounces, shading: Shading::Simple, ..Settings::default() }
}

/// A black fiber along X above meshes, under a sun from above and −Y, at 45°.
fn fiber_above(meshes: Vec<Mesh>, albedo: f64, radius: f64) -> Scene {
    let z = 3.0 * RADIUS;
    let yarns = straight(&[[DVec3::new(-5.0, 0.0, z), DVec3::new(5.0, 0.0, z)]], radius);
    let sun = sun(DVec3::new(0.0, 1.0, -1.0), 3.0);
    Scene { meshes, ..scene(object(&yarns, &single_fiber(), lambert(albedo)), vec![sun], 0.0, above()) }
}

/// What remains of a picture of [`HEIGHT`] without the fiber, 2 r high, and without its shadow, 2 √2 r high.
fn open_share(radius: f64) -> f64 {
    1.0 - (2.0 + 2.0 * SQRT_2) * radius / HEIGHT
}

#[test]
fn a_fiber_hides_and_shades_a_floor() {
    // A matt surface has the radiance ρ E cos θ / π.
    let expected = |radius: f64| f64::from(COLOR) * 3.0 * FRAC_1_SQRT_2 / PI * open_share(radius);
    let found = mean(&draw(&fiber_above(vec![floor()], 0.0, RADIUS), &settings(64, None)));
    println!("{found:?}, expected {}", expected(RADIUS));
    assert!((found.0 - expected(RADIUS)).abs() < 4.0 * found.1 + 1e-3 * expected(RADIUS));
    assert!(
        (found.0 - expected(1.02 * RADIUS)).abs() > 4.0 * found.1 + 1e-3 * expected(RADIUS),
        "2 % wider is told apart"
    );
}

#[test]
fn a_mesh_hides_a_fiber_and_shades_it() {
    let half = |albedo: f64, kind: MeshKind, meshes: Vec<Mesh>| {
        let meshes = meshes.into_iter().map(|mesh| Mesh { kind, ..mesh }).collect();
        let scene = fiber_above(meshes, albedo, RADIUS);
        draw(&scene, &Settings { size: [8, 300], ..settings(32, Some(1)) })
    };
    let sides = |image: &Image| {
        let side = |x: usize| image.combined.chunks(8).map(|row| f64::from(row[x][0])).sum::<f64>();
        [side(1), side(6)]
    };
    let free = sides(&half(0.8, MeshKind::Shaded, vec![]));
    // Between the camera and the fiber where x > 0, far enough to the side of the sun's way.
    let hides = level(9.0, [0.0, -1.0], [50.0, 1.0]);
    let hidden = half(0.8, MeshKind::Holdout, vec![hides.clone()]);
    let [left, right] = sides(&hidden);
    assert!((left / free[0] - 1.0).abs() < 0.02 && right == 0.0, "{left} {right} of {free:?}");
    assert!(
        hidden.combined.chunks(8).all(|row| row[6] == [0.0; 4]) && hidden.object_id.chunks(8).all(|row| row[6] == 0)
    );
    let shown = half(0.8, MeshKind::Shaded, vec![hides]);
    assert!(shown.object_id.chunks(8).all(|row| row[6] == 7) && shown.depth.iter().any(|z| (z - 1.0).abs() < 1e-6));
    // In the sun's way where x > 0, beside that of the camera.
    let shades = level(2.0, [0.0, -4.0], [50.0, -1.0]);
    let [left, right] = sides(&half(0.8, MeshKind::Shaded, vec![shades]));
    assert!((left / free[0] - 1.0).abs() < 0.02 && right == 0.0, "{left} {right} of {free:?}");
}

#[test]
fn a_shadow_catcher_shows_as_much_as_is_shaded() {
    let catcher = Mesh { kind: MeshKind::ShadowCatcher, ..floor() };
    let mut scene = fiber_above(vec![catcher], 0.5, RADIUS);
    let alpha = |scene: &Scene, transparent: bool| {
        let image = draw(scene, &Settings { transparent, ..settings(16, Some(1)) });
        let mean = |channel: usize| image.combined.iter().map(|c| f64::from(c[channel])).sum::<f64>() / 2400.0;
        [mean(0), mean(3)]
    };
    let [_, found] = alpha(&scene, true);
    let expected = 1.0 - open_share(RADIUS);
    println!("{found}, expected {expected}");
    assert!((found - expected).abs() < 2e-3 * expected + 1e-3);
    // With as much of an even sky as of the sun, E cos θ = π A, the shadow is half as deep, but for the sky that the fiber hides as well: that is its width seen from
    // the floor, summed over the floor the share 2 r of π for each of its length, about r / HEIGHT, of which the frame holds most.
    scene.ambient = Vec3::splat((3.0 * FRAC_1_SQRT_2 / PI) as f32);
    let [_, with_sky] = alpha(&scene, true);
    let sun_alone = 2.0 * RADIUS / HEIGHT + SQRT_2 * RADIUS / HEIGHT;
    assert!(with_sky > sun_alone && with_sky < sun_alone + RADIUS / HEIGHT, "{with_sky} for {sun_alone}");
    assert!((alpha(&scene, false)[1] - 1.0).abs() < 1e-6);
}

#[test]
fn white_meshes_and_fibers_disappear_in_an_even_light() {
    let corners: Vec<[f64; 3]> =
        (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|c| 0.3 * f64::from(c) - 0.15)).collect();
    let sides = [[0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 5, 1], [0, 4, 5], [2, 3, 7], [2, 7, 6], [0, 2, 6]];
    let sides: Vec<[u32; 3]> = sides.into_iter().chain([[0, 6, 4], [1, 7, 3], [1, 5, 7]]).collect();
    let picture = |color: f32| {
        let cube = Mesh { base_color: Vec3::splat(color), ..mesh(&corners, &sides) };
        let turned = Mesh { world_from_object: DMat4::from_rotation_x(0.5), ..cube };
        let mut scene = fiber_above(vec![turned, floor()], 1.0, RADIUS);
        scene.meshes[1].base_color = Vec3::ONE;
        scene.lights.clear();
        scene.ambient = Vec3::ONE;
        mean(&draw(&scene, &Settings { size: [40, 40], ..settings(32, None) }))
    };
    let (found, error) = picture(1.0);
    assert!((found - 1.0).abs() < 4.0 * error + 1e-6 && error < 0.01, "{found} ± {error}");
    let (found, error) = picture(0.95);
    assert!(found < 1.0 - 4.0 * error, "{found} ± {error}");
}

#[test]
fn normals_of_corners_shade_and_lead_into_no_mesh() {
    // A floor whose normals lean to the sun is as bright as one that faces it half-way, and one whose normals lean away darker.
    let lit = |lean: f64| {
        let normal = DVec3::new(0.0, -lean.sin(), lean.cos()).as_vec3().to_array();
        let flat = floor();
        let (positions, triangles) = (flat.triangles.positions().to_vec(), flat.triangles.triangles().to_vec());
        let triangles = Triangles::new(positions, triangles, Some(vec![[normal; 3]; 2])).expect("a mesh");
        let mut scene = fiber_above(vec![Mesh { triangles: Arc::new(triangles), ..flat }], 0.0, RADIUS);
        scene.objects.clear();
        mean(&draw(&scene, &settings(4, None))).0
    };
    for lean in [0.4_f64, -0.4, PI - 0.4] {
        let side = if lean.cos() < 0.0 { lean - PI } else { lean };
        let expected = f64::from(COLOR) * 3.0 / PI * (PI / 4.0 - side).cos();
        assert!((lit(lean) / expected - 1.0).abs() < 1e-4, "{lean}: {} for {expected}", lit(lean));
    }
    assert!((lit(0.0) / (f64::from(COLOR) * 3.0 / PI * FRAC_1_SQRT_2) - 1.0).abs() < 1e-4);
}
