//! Meshes among yarns: what hides what, whose shadow falls where, and the kinds of meshes.

mod support;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_gpu::{Aov, Camera, Image, Labels, Light, Mesh, MeshKind, Object, Scene, Settings, Triangles};
use support::{
    curves, draw, exact, looking, measure, object, orthographic, perspective, picture, preset, scene, yarns_of,
};

const SIZE: [u32; 2] = [64, 48];

/// A square of side 2 in the XY plane.
fn square() -> Arc<Triangles> {
    let corners = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    Arc::new(Triangles::new(corners, vec![[0, 1, 2], [0, 2, 3]], None).expect("a square"))
}

/// A cube of side 2.
fn cube() -> Arc<Triangles> {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(|bit| 2.0 * bit as f32 - 1.0);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Arc::new(Triangles::new((0..8).map(corner).collect(), triangles, None).expect("a cube"))
}

/// A sphere of radius 1, smooth or flat.
fn sphere(rings: u32, smooth: bool) -> Arc<Triangles> {
    let at = |ring: u32, step: u32| {
        let (polar, around) = (PI * f64::from(ring) / f64::from(rings), PI * f64::from(step) / f64::from(rings));
        let p = DVec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos());
        p.as_vec3().to_array()
    };
    let steps = 2 * rings;
    let positions: Vec<_> = (0..=rings).flat_map(|ring| (0..steps).map(move |step| at(ring, step))).collect();
    let place = |ring: u32, step: u32| ring * steps + step % steps;
    let triangles: Vec<[u32; 3]> = (0..rings)
        .flat_map(|ring| {
            (0..steps).flat_map(move |step| {
                let [a, b, c, d] =
                    [place(ring, step), place(ring + 1, step), place(ring + 1, step + 1), place(ring, step + 1)];
                [[a, b, c], [a, c, d]]
            })
        })
        .collect();
    let normals = smooth.then(|| triangles.iter().map(|t| t.map(|i| positions[i as usize])).collect());
    Arc::new(Triangles::new(positions, triangles, normals).expect("a sphere"))
}

fn mesh(triangles: Arc<Triangles>, world_from_object: DMat4) -> Mesh {
    Mesh {
        name: "mesh".into(),
        id: 77,
        labels: Labels::default(),
        triangles,
        base_color: Vec3::new(0.8, 0.5, 0.2),
        texture: None,
        kind: MeshKind::Shaded,
        world_from_object,
    }
}

fn placed(scale: f64, at: [f64; 3]) -> DMat4 {
    DMat4::from_translation(DVec3::from(at)) * DMat4::from_scale(DVec3::splat(scale))
}

fn yarn() -> Object {
    object(&yarns_of(curves::straight(2.0, 20), false, 0.1), &preset("cotton-2"))
}

fn sun_from(toward: [f64; 3]) -> Light {
    Light::Sun { direction: -DVec3::from(toward), irradiance: Vec3::splat(PI as f32), angle_rad: 0.0 }
}

fn cameras() -> [Camera; 2] {
    let front = looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO);
    [orthographic(front, 0.9, SIZE, [0.0, 0.0]), perspective(front, 0.15, SIZE, [0.0, 0.0])]
}

fn sharp() -> Settings {
    Settings { lod_pixels: 1.0, shadow_resolution: 512, ..exact(SIZE) }
}

fn soft(samples: u32) -> Settings {
    Settings { samples, filter_width: 1.5, ..sharp() }
}

fn at(image: &Image, x: u32, y: u32) -> [f32; 4] {
    image.combined[(y * image.size[0] + x) as usize]
}

fn pixels_with(image: &Image, id: u32) -> usize {
    image.object_id.iter().filter(|found| **found == id).count()
}

#[test]
fn what_is_nearer_hides_the_rest() {
    for camera in cameras() {
        let with = |meshes: Vec<Mesh>| draw(&Scene { meshes, ..scene(vec![yarn()], camera) }, &sharp());
        let alone = with(vec![]);
        let before = with(vec![mesh(cube(), placed(0.2, [0.0, -0.6, 0.0]))]);
        let behind = with(vec![mesh(cube(), placed(0.2, [0.0, 0.6, 0.0]))]);
        let through = with(vec![mesh(cube(), placed(0.2, [0.0, 0.0, 0.0]))]);
        picture::show("cube before", &before);
        picture::show("cube behind", &behind);
        picture::show("cube through", &through);
        let yarn_pixels = pixels_with(&alone, 1);
        assert!(yarn_pixels > 400, "{yarn_pixels}");
        // The cube's front, in pixels, covers a part of the yarn; behind it, it is covered where the yarn has no gaps.
        assert!(pixels_with(&before, 1) < yarn_pixels * 7 / 10, "{} of {yarn_pixels}", pixels_with(&before, 1));
        assert_eq!(pixels_with(&behind, 1), yarn_pixels);
        assert!(pixels_with(&behind, 77) > 100);
        assert!(pixels_with(&through, 1) < yarn_pixels, "the yarn's middle is inside of the cube");
        assert!(pixels_with(&through, 1) > yarn_pixels / 3, "its ends are not");
        for (image, depth) in [(&before, 2.2), (&behind, 3.4)] {
            for i in 0..image.depth.len() {
                match image.object_id[i] {
                    77 => assert!((f64::from(image.depth[i]) - depth).abs() < 1e-3, "{}", image.depth[i]),
                    1 => assert_eq!((image.depth[i], image.combined[i][3]), (alone.depth[i], 1.0)),
                    _ => assert_eq!(image.combined[i], [0.0; 4]),
                }
            }
        }
    }
}

#[test]
fn a_plane_through_the_camera_is_cut_at_the_near_plane() {
    // A floor of 2 km that begins behind the camera: what it fills is what lies below the horizon, up to the far plane.
    let camera = perspective(looking(DVec3::new(0.0, -3.0, 0.5), DVec3::new(0.0, 0.0, 0.5)), 0.5, SIZE, [0.0, 0.0]);
    let floor = mesh(square(), placed(1000.0, [0.0; 3]));
    let image = draw(&Scene { meshes: vec![floor], ..scene(vec![], camera) }, &sharp());
    picture::show("floor", &image);
    for y in 0..SIZE[1] {
        let expected = if y < 24 { 0 } else { 77 };
        for x in 0..SIZE[0] {
            assert_eq!(image.object_id[(y * SIZE[0] + x) as usize], expected, "({x}, {y})");
        }
        if y >= 24 {
            // Height over depth is the slope of the ray.
            let slope = 0.5 * (f64::from(y) + 0.5 - 24.0) / 24.0;
            let depth = f64::from(image.depth[(y * SIZE[0] + 5) as usize]);
            assert!((depth * slope / 0.5 - 1.0).abs() < 1e-4, "row {y}: {depth}");
        }
    }
}

#[test]
fn a_surface_is_as_bright_as_lambert_says() {
    let front = looking(DVec3::new(0.0, -3.0, 4.0), DVec3::ZERO);
    let camera = orthographic(front, 1.0, SIZE, [0.0, 0.0]);
    let lit = |lights: Vec<Light>, ambient: f32, samples| {
        let meshes = vec![mesh(square(), DMat4::IDENTITY)];
        let scene = Scene { meshes, lights, ambient: Vec3::splat(ambient), ..scene(vec![], camera) };
        at(&draw(&scene, &soft(samples)), 32, 24).map(f64::from)
    };
    let toward = DVec3::new(0.4, 0.3, 0.8).normalize();
    let point = Light::Point { position: toward * 2.0, power: Vec3::splat(80.0), radius: 0.0, cone: None };
    for (name, lights, ambient, expected) in [
        ("sun", vec![sun_from(toward.to_array())], 0.0, toward.z),
        ("point", vec![point], 0.0, toward.z * 80.0 / (4.0 * PI * 4.0) / PI),
        ("sky", vec![], 0.7, 0.7),
        ("sun below", vec![sun_from([0.1, 0.0, -1.0])], 0.0, 0.0),
    ] {
        let found = lit(lights, ambient, 4);
        println!("{name}: {found:.4?} for {expected:.4}");
        for (channel, color) in [0.8, 0.5, 0.2].into_iter().enumerate() {
            // The point light's distance and slant vary within a pixel's filter.
            assert!((found[channel] - color * expected).abs() < 2e-3 * (1.0 + expected), "{name}: {found:?}");
        }
        assert_eq!(found[3], 1.0);
    }
}

#[test]
fn smooth_normals_are_those_of_the_sphere_flat_ones_those_of_its_faces() {
    let camera = orthographic(looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO), 2.4, SIZE, [0.0, 0.0]);
    // An ellipsoid, so that normals are no positions.
    let world_from_object = DMat4::from_scale(DVec3::new(1.2, 0.5, 0.8)) * DMat4::from_rotation_z(0.2);
    let worst = |smooth: bool, rings| {
        let meshes = vec![mesh(sphere(rings, smooth), world_from_object)];
        let image = draw(&Scene { meshes, ..scene(vec![], camera) }, &sharp());
        picture::show_directions(&format!("normals {smooth}"), SIZE, &image.normal);
        let mut worst = 0.0_f64;
        for (i, normal) in image.normal.iter().enumerate().filter(|(i, _)| image.object_id[*i] == 77) {
            let scale = 2.4 / 48.0;
            let (x, z) = (
                ((i as u32 % SIZE[0]) as f64 + 0.5 - 32.0) * scale / 1.2,
                (24.0 - (i as u32 / SIZE[0]) as f64 - 0.5) * scale / 0.8,
            );
            let rest = 1.0 - x * x - z * z;
            if rest > 0.1 {
                let expected = DVec3::new(x / 1.2, -rest.sqrt() / 0.5, z / 0.8).normalize();
                worst = worst.max(expected.distance(Vec3::from(*normal).as_dvec3()));
            }
        }
        worst
    };
    let (smooth, flat) = (worst(true, 24), worst(false, 24));
    println!("smooth within {smooth:.4}, flat within {flat:.4}");
    assert!(smooth < 0.02 && flat > 0.05, "smooth {smooth}, flat {flat}");
}

#[test]
fn normals_that_vanish_give_way_to_the_faces() {
    let camera = orthographic(looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO), 2.4, SIZE, [0.0, 0.0]);
    // A smooth ball pressed flat, some of whose normals are left without length; and a triangle whose normals cancel on its middle line.
    let flat = mesh(sphere(24, true), DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)));
    let turned = mesh(sphere(24, true), DMat4::from_rotation_x(0.7) * DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0)));
    let corners = vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
    let up_and_down = vec![[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]];
    let opposed = Triangles::new(corners, vec![[0, 1, 2]], Some(up_and_down)).expect("a triangle");
    for (name, mesh, [y, z]) in [
        ("flat", flat, [-1.0, 0.0]),
        ("flat and turned", turned, [-0.7_f64.sin(), 0.7_f64.cos()]),
        ("opposed", mesh(Arc::new(opposed), DMat4::IDENTITY), [0.0, 1.0]),
    ] {
        let lights = vec![sun_from([0.2, -1.0, 0.3])];
        // The middle line of the triangle lies on a row of pixels' centres.
        let camera = if name == "opposed" {
            orthographic(looking(DVec3::new(0.0, -3.0, 0.025), DVec3::new(0.0, 0.0, 0.025)), 2.4, SIZE, [0.0, 0.0])
        } else {
            camera
        };
        let image = draw(&Scene { meshes: vec![mesh], lights, ..scene(vec![], camera) }, &sharp());
        assert_eq!(measure::not_finite(&image), 0, "{name}");
        assert!(pixels_with(&image, 77) > 300, "{name}: {}", pixels_with(&image, 77));
        let mut of_face = 0;
        for (normal, _) in image.normal.iter().zip(&image.object_id).filter(|(_, id)| **id == 77) {
            let normal = Vec3::from(*normal).as_dvec3();
            assert!((normal.length() - 1.0).abs() < 1e-3, "{name}: {normal}");
            let along = DVec3::new(0.0, y, z).dot(normal).abs();
            of_face += u32::from(name == "opposed" && normal.y < -0.99);
            assert!(along > 0.99 || normal.y < -0.99, "{name}: {normal}");
        }
        assert_eq!(of_face > 0, name == "opposed", "{name}");
    }
}

#[test]
fn shadows_fall_from_yarn_on_plane_and_from_plane_on_yarn() {
    // A yarn 0.5 above a floor, a sun slanting along y: its shadow lies at y = 0.5 tan.
    let toward = [0.0, -0.6, 0.8];
    let camera = orthographic(looking(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO), 2.4, SIZE, [0.0, 0.0]);
    let lifted = Object { world_from_object: placed(1.0, [0.0, 0.0, 0.5]), ..yarn() };
    let floor = || mesh(square(), placed(4.0, [0.0; 3]));
    let with = |objects: Vec<Object>, meshes: Vec<Mesh>, light: Light| {
        draw(&Scene { meshes, lights: vec![light], ambient: Vec3::ZERO, ..scene(objects, camera) }, &sharp())
    };
    let image = with(vec![lifted.clone()], vec![floor()], sun_from(toward));
    picture::show("shadow on plane", &image);
    let row_of = |y: f64| ((1.2 - y) / 0.05) as u32;
    let (yarn_row, shadow_row) = (row_of(0.0), row_of(0.5 * 0.6 / 0.8));
    assert_eq!(image.object_id[(yarn_row * SIZE[0] + 32) as usize], 1);
    let lit = 0.8 * 0.8;
    let expect = |image: &Image, x, y, value: f32| {
        let found = at(image, x, y)[0];
        assert!((found - value).abs() < 0.01, "({x}, {y}): {found} for {value}");
    };
    expect(&image, 32, shadow_row, 0.0);
    for (x, y) in [(32, shadow_row - 5), (32, shadow_row + 4), (3, shadow_row), (32, 46), (60, 3)] {
        expect(&image, x, y, lit);
    }
    // A point light 4 above has the same shadow at another place.
    let point =
        Light::Point { position: DVec3::new(0.0, -1.0, 4.5), power: Vec3::splat(800.0), radius: 0.0, cone: None };
    let image = with(vec![lifted.clone()], vec![floor()], point);
    let shadow_row = row_of(0.5 * 1.0 / 4.0);
    assert!(at(&image, 32, shadow_row)[0] < 0.3 * at(&image, 32, shadow_row - 6)[0]);
    // A roof darkens the half of the yarn below it.
    let roof = mesh(square(), placed(1.0, [-1.0, 0.0, 0.9]));
    let [open, shaded] = [vec![], vec![Mesh { kind: MeshKind::Shaded, ..roof }]].map(|meshes| {
        // From below the roof.
        let camera =
            orthographic(looking(DVec3::new(0.0, -5.0, 0.5), DVec3::new(0.0, 0.0, 0.5)), 0.6, SIZE, [0.0, 0.0]);
        let scene = Scene {
            meshes,
            lights: vec![sun_from([0.0, -0.1, 1.0])],
            ambient: Vec3::ZERO,
            ..scene(vec![lifted.clone()], camera)
        };
        draw(&scene, &sharp())
    });
    picture::show("shadow on yarn", &shaded);
    let half = |image: &Image, left| measure::brightness(&measure::crop(image, [left, 16, 18, 16]));
    assert!(half(&shaded, 0) < 1e-3 * half(&open, 0), "{} of {}", half(&shaded, 0), half(&open, 0));
    assert!((half(&shaded, 46) / half(&open, 46) - 1.0).abs() < 0.01);
}

#[test]
fn meshes_shade_each_other_near_the_yarns_and_far_from_them() {
    // A short yarn; a cube over the floor at its side and one far away; a sun from above, slanting along x.
    let short = object(&yarns_of(curves::straight(0.3, 10), false, 0.05), &preset("cotton-2"));
    let camera = orthographic(looking(DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO), 6.0, [96, 72], [0.0, 0.0]);
    for (objects, name) in [(vec![short], "with yarn"), (vec![], "without")] {
        for cube_at in [[0.0, 0.0, 0.6], [-2.5, 1.5, 0.6]] {
            let meshes = vec![mesh(square(), placed(5.0, [0.0; 3])), mesh(cube(), placed(0.3, cube_at))];
            let lights = vec![sun_from([-0.6, 0.0, 0.8])];
            let scene = Scene { meshes, lights, ambient: Vec3::ZERO, ..scene(objects.clone(), camera) };
            let image = draw(&scene, &Settings { size: [96, 72], ..sharp() });
            picture::show(&format!("cube {name} {}", cube_at[0]), &image);
            // The middle of the cube throws its shadow 0.6 · 0.6 / 0.8 beside it.
            let place = |x: f64, y: f64| (((x + 4.0) * 12.0) as u32, ((3.0 - y) * 12.0) as u32);
            let (x, y) = place(cube_at[0] + 0.45, cube_at[1]);
            assert!(at(&image, x, y)[0] < 0.01, "{name}, {cube_at:?}: {:?}", at(&image, x, y));
            let (x, y) = place(cube_at[0] + 1.0, cube_at[1]);
            assert!((at(&image, x, y)[0] - 0.64).abs() < 0.01, "{name}, {cube_at:?}: {:?}", at(&image, x, y));
        }
    }
}

/// Whether a place may be in the shadow of [`yarn`], with its hairs and the texels of a map about it.
fn may_be_behind_yarn(place: DVec3, toward: DVec3) -> bool {
    // The least distance between the ray and the yarn's axis, from -1 to 1 along X: by the ray's points, of which few are needed.
    let reach = 0.1 * 1.6 + 0.03;
    (0..=4000)
        .map(|i| place + toward * (0.001 * f64::from(i)))
        .any(|p| p.distance(p * DVec3::X * (1.0 / p.x.abs().max(1.0))) < reach)
}

#[test]
fn a_surface_does_not_shade_itself() {
    // A slanting light over a floor and a ball: no speckles.
    let camera = orthographic(looking(DVec3::new(0.0, -4.0, 3.0), DVec3::ZERO), 3.0, SIZE, [0.0, 0.0]);
    for toward in [[0.1, -0.2, 1.0], [0.9, 0.1, 0.2], [0.99, 0.05, 0.03]].map(|t| DVec3::from(t).normalize()) {
        for objects in [vec![], vec![yarn()]] {
            let lit = |meshes: Vec<Mesh>| {
                let lights = vec![sun_from(toward.to_array())];
                let scene = Scene { meshes, lights, ambient: Vec3::ZERO, ..scene(objects.clone(), camera) };
                draw(&scene, &Settings { aovs: vec![Aov::Position], ..sharp() })
            };
            // Colours of the mesh beside what Lambert says, where no yarn can shade it; and how many there are.
            let wrong = |image: &Image, least: f64, bound: f64| {
                let (mut wrong, mut seen) = (0, 0);
                for (i, color) in image.combined.iter().enumerate().filter(|(i, _)| image.object_id[*i] == 77) {
                    let place = Vec3::from_slice(&image.aovs[0].1[3 * i..3 * i + 3]).as_dvec3();
                    let lambert = Vec3::from(image.normal[i]).as_dvec3().dot(toward);
                    if lambert > least && (objects.is_empty() || !may_be_behind_yarn(place, toward)) {
                        seen += 1;
                        wrong += u32::from((f64::from(color[0]) / (0.8 * lambert) - 1.0).abs() > bound);
                    }
                }
                (wrong, seen)
            };
            let floor = lit(vec![mesh(square(), placed(6.0, [0.0, 0.0, -0.5]))]);
            let (dark, seen) = wrong(&floor, 0.0, 0.01);
            assert!(dark == 0 && seen > 1500, "{toward}: {dark} of {seen} pixels of the floor, yarn {}", objects.len());
            let ball = lit(vec![mesh(sphere(48, true), DMat4::IDENTITY)]);
            let (dark, seen) = wrong(&ball, 0.15, 0.05);
            assert!(dark == 0 && seen > 300, "{toward}: {dark} of {seen} pixels of the ball, yarn {}", objects.len());
        }
    }
}

#[test]
fn a_shadow_catcher_is_its_shadows_and_a_holdout_is_a_hole() {
    let camera = orthographic(looking(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO), 2.4, SIZE, [0.0, 0.0]);
    let lifted = Object { world_from_object: placed(1.0, [0.0, 0.0, 0.5]), ..yarn() };
    let with = |kind, transparent| {
        let meshes = vec![Mesh { kind, ..mesh(square(), placed(0.9, [0.0; 3])) }];
        let scene = Scene {
            meshes,
            lights: vec![sun_from([0.0, -0.6, 0.8])],
            ambient: Vec3::splat(0.25),
            ..scene(vec![lifted.clone()], camera)
        };
        draw(&scene, &Settings { transparent, ..soft(32) })
    };
    let (yarn_row, shadow_row, lit_row) = (24, 16, 36);
    let catcher = with(MeshKind::ShadowCatcher, true);
    picture::show("catcher", &catcher);
    // The sun's share of the light is π 0.8 of π (0.8 + 0.25); the yarn hides a little of the sky besides.
    let shadow = at(&catcher, 32, shadow_row);
    assert_eq!([shadow[0], shadow[1], shadow[2]], [0.0; 3]);
    assert!((shadow[3] - 0.8 / 1.05).abs() < 0.06, "{shadow:?}");
    assert!(at(&catcher, 32, lit_row)[3] < 0.05, "{:?}", at(&catcher, 32, lit_row));
    assert!(at(&catcher, 32, yarn_row)[3] > 0.99);
    let over = with(MeshKind::ShadowCatcher, false);
    let ratio = at(&over, 32, shadow_row)[0] / 0.25;
    assert!((ratio - (1.0 - shadow[3])).abs() < 1e-3 && at(&over, 32, shadow_row)[3] == 1.0);
    for transparent in [true, false] {
        let holdout = with(MeshKind::Holdout, transparent);
        assert_eq!(at(&holdout, 32, shadow_row), [0.0; 4]);
        assert_eq!(at(&holdout, 32, lit_row), [0.0; 4]);
        assert!(at(&holdout, 32, yarn_row)[3] > 0.99);
        assert_eq!(at(&holdout, 32, 1)[3], if transparent { 0.0 } else { 1.0 });
    }
}

#[test]
fn sky_light_is_hidden_by_what_is_near() {
    // Close to a wall, half of the sky is gone; on the open floor, nothing.
    let camera = orthographic(looking(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO), 2.4, SIZE, [0.0, 0.0]);
    let wall = mesh(
        square(),
        DMat4::from_translation(DVec3::new(-1.0, 0.0, 0.0))
            * DMat4::from_rotation_y(0.5 * PI)
            * DMat4::from_scale(DVec3::new(4.0, 4.0, 1.0)),
    );
    let meshes = vec![mesh(square(), placed(1.5, [0.0; 3])), wall];
    let image = draw(&Scene { meshes, ..scene(vec![], camera) }, &Settings { shadow_resolution: 2048, ..soft(256) });
    picture::show("wall", &image);
    // The wall is 1 from the middle and stands 4 high: what comes from behind it is hidden, half of the light at its foot.
    let near = f64::from(at(&image, 14, 24)[0]) / 0.8;
    println!("{near:.3} by the wall");
    assert!((near - 0.5).abs() < 0.05, "{near}");
    let open = draw(&Scene { meshes: vec![mesh(square(), placed(1.5, [0.0; 3]))], ..scene(vec![], camera) }, &soft(8));
    assert!((f64::from(at(&open, 32, 24)[0]) / 0.8 - 1.0).abs() < 1e-5);
}

#[test]
fn instances_and_mirrored_ones_share_a_geometry() {
    let camera = orthographic(looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO), 2.4, SIZE, [0.0, 0.0]);
    let ball = sphere(16, true);
    let instance = |id, x: f64, scale: [f64; 3]| Mesh {
        id,
        ..mesh(
            Arc::clone(&ball),
            DMat4::from_translation(DVec3::new(x, 0.0, 0.0)) * DMat4::from_scale(DVec3::from(scale)),
        )
    };
    let meshes = vec![instance(2, -0.8, [0.5; 3]), instance(3, 0.8, [-0.5, 0.5, 0.5])];
    let image = draw(&Scene { meshes, ..scene(vec![], camera) }, &sharp());
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] / 2 {
            let (a, b) = ((y * SIZE[0] + x) as usize, (y * SIZE[0] + SIZE[0] - 1 - x) as usize);
            assert_eq!(
                image.object_id[a],
                match image.object_id[b] {
                    3 => 2,
                    other => other,
                }
            );
            let (mine, mut theirs) = (Vec3::from(image.normal[a]), Vec3::from(image.normal[b]));
            theirs.x = -theirs.x;
            assert!(mine.distance(theirs) < 1e-3, "({x}, {y}): {mine} and {theirs}");
        }
    }
}
