//! Lights, shadows and scattering against closed forms and the f64 formulas of `lisle_core::scattering`.

mod support;

use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::sync::Arc;

use glam::{DMat4, DVec2, DVec3, Vec3};
use lisle_core::scattering::{
    FiberAngles, Material, Normalizers, ScatteringTables, physical_ambient, physical_reflected, simple_ambient,
    simple_reflected,
};
use lisle_gpu::{
    Camera, Cone, Image, Labels, Light, Mesh, MeshKind, Object, Occlusion, Scene, Settings, Shading, Triangles,
};
use lisle_precompute::{Bundle, SectionDensity, SelfShadow};
use support::fiber::{close_up, lone_fiber, straight_fiber};
use support::{curves, draw, exact, looking, measure, object, orthographic, picture, preset, scene, yarns_of};

const SIZE: [u32; 2] = [64, 48];

/// Point samples with shadow maps of fine texels.
fn sharp(size: [u32; 2]) -> Settings {
    Settings { shadow_resolution: 512, ..exact(size) }
}

fn dark(object: Object, camera: Camera) -> Scene {
    Scene { ambient: Vec3::ZERO, ..scene(vec![object], camera) }
}

fn sun_from(toward: DVec3) -> Light {
    Light::Sun { direction: -toward, irradiance: Vec3::ONE, angle_rad: 0.0 }
}

/// Largest difference between a picture and what a formula makes of its own normals and tangents, over the formula's largest value.
fn error(image: &Image, viewer: DVec3, radiance: impl Fn(&FiberAngles, DVec3, DVec3) -> DVec3, toward: DVec3) -> f64 {
    let (mut worst, mut largest, mut count) = (0.0_f64, 1e-6_f64, 0);
    for i in 0..image.combined.len() {
        let [color, normal, tangent] =
            [[image.combined[i][0], image.combined[i][1], image.combined[i][2]], image.normal[i], image.tangent[i]]
                .map(|v| Vec3::from(v).as_dvec3());
        if image.combined[i][3] < 1.0 {
            continue;
        }
        count += 1;
        let expected = radiance(&FiberAngles::from_directions(tangent, toward, viewer), normal, tangent);
        worst = worst.max((color - expected).abs().max_element());
        largest = largest.max(expected.max_element());
    }
    assert!(count > 1000, "the fiber fills {count} pixels");
    worst / largest
}

const MATERIALS: [&str; 4] = ["cotton-2", "silk", "gabardine", "polyester-1"];
const VIEWS: [[f64; 3]; 2] = [[0.0, -1.0, 0.0], [0.5, -0.8, 0.3]];

/// The simple and the physical formulas for a sun, times the irradiance of 1.
fn formulas(material: &Material) -> [(Shading, impl Fn(&FiberAngles, f64) -> DVec3); 2] {
    let material = *material;
    let evaluate = move |physical: bool| {
        move |angles: &FiberAngles, cos_normal: f64| {
            if physical {
                physical_reflected(&material, &Normalizers::exact(&material, angles.theta_i_rad()), angles, cos_normal)
            } else {
                simple_reflected(&material, angles, cos_normal)
            }
        }
    };
    [(Shading::Simple, evaluate(false)), (Shading::Physical, evaluate(true))]
}

#[test]
fn a_lone_fiber_scatters_a_ring_of_suns_as_the_formulas_say() {
    // 0.5 % of the tables' normalisers, and rounding.
    const BOUND: f64 = 0.01;
    let mut failures = Vec::new();
    for name in MATERIALS {
        let material = Material::preset(name).expect(name);
        let fiber = lone_fiber(material);
        for view in VIEWS.map(DVec3::from) {
            for (shading, formula) in formulas(&material) {
                let mut worst = [0.0_f64; 3];
                for k in 0..24 {
                    // Longitudes 0, the specular one, and another; azimuths all around.
                    let theta = [0.0, -view.normalize().x.asin(), 0.7][k / 8];
                    let phi = TAU * (k % 8) as f64 / 8.0 + 0.2;
                    let toward = DVec3::new(theta.sin(), theta.cos() * phi.cos(), theta.cos() * phi.sin());
                    let mut scene = dark(fiber.clone(), close_up(&fiber, view, SIZE));
                    scene.lights = vec![sun_from(toward)];
                    let image = draw(&scene, &Settings { shading, ..sharp(SIZE) });
                    assert_eq!(measure::not_finite(&image), 0);
                    let expected = |angles: &FiberAngles, normal: DVec3, _: DVec3| formula(angles, normal.dot(toward));
                    worst[k / 8] = worst[k / 8].max(error(&image, view.normalize(), expected, toward));
                }
                println!("{name}, {shading:?}, from {view}: at three longitudes within {worst:.5?}");
                if worst.iter().any(|error| *error > BOUND) {
                    failures.push(format!("{name}, {shading:?}, from {view}: {worst:.4?}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn a_yarns_own_tube_takes_no_light_from_any_side() {
    let material = Material::preset("cotton-2").expect("preset");
    let mut failures = Vec::new();
    for (knots, theta) in [(2, 0.7), (6, 0.7), (20, 0.0), (20, 0.35), (20, 0.7), (20, 1.2), (80, 0.7_f64)] {
        let fiber = straight_fiber(material, knots);
        let view = DVec3::NEG_Y;
        let mut least = 1.0_f64;
        for phi in [0.2, 1.7, 3.0, 4.5_f64] {
            let toward = DVec3::new(theta.sin(), theta.cos() * phi.cos(), theta.cos() * phi.sin());
            let mut scene = dark(fiber.clone(), close_up(&fiber, view, SIZE));
            scene.lights = vec![sun_from(toward)];
            let [_, (shading, formula)] = formulas(&material);
            let image = draw(&scene, &Settings { shading, ..sharp(SIZE) });
            let expected = |angles: &FiberAngles, normal: DVec3, _: DVec3| formula(angles, normal.dot(toward));
            least = least.min(1.0 - error(&image, view, expected, toward));
        }
        println!(
            "{knots} knots, light {theta} off the yarn's plane: {:.2} % of the light comes through",
            100.0 * least
        );
        if least < 0.99 {
            failures.push(format!("{knots} knots, {theta}: {least:.3}"));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn a_lone_yarn_is_as_bright_by_coarse_shadow_maps() {
    // A texel of 0.06, 0.7 and 2.5 of the yarn's radii.
    let yarn = object(&yarns_of(curves::straight(4.0, 60), false, 0.05), &preset("cotton-1"));
    let camera = orthographic(looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO), 0.3, SIZE, [0.0, 0.0]);
    let mut failures = Vec::new();
    for (name, toward) in [
        ("in front", DVec3::new(-0.3, -1.0, 0.4)),
        ("beside", DVec3::new(0.1, 0.1, 1.0)),
        ("along", DVec3::new(1.0, -0.3, 0.1)),
        ("behind", DVec3::new(0.2, 1.0, 0.4)),
    ] {
        let bright = |shadow_resolution: u32| {
            let scene = Scene { lights: vec![sun_from(toward.normalize())], ..dark(yarn.clone(), camera) };
            measure::brightness(&draw(&scene, &Settings { samples: 8, shadow_resolution, ..sharp(SIZE) }))
        };
        let fine = bright(1280);
        let coarse = [120, 40].map(|resolution| bright(resolution) / fine - 1.0);
        println!("{name}: {fine:.5}, by coarser maps {coarse:+.4?}");
        if coarse.iter().any(|difference| difference.abs() > 0.04) {
            failures.push(name);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn the_formulas_of_another_light_are_rejected() {
    let material = Material::preset("cotton-2").expect("preset");
    let fiber = lone_fiber(material);
    let view = DVec3::from(VIEWS[1]);
    let toward = DVec3::new(0.1, -0.6, 0.8).normalize();
    let mut scene = dark(fiber.clone(), close_up(&fiber, view, SIZE));
    scene.lights = vec![sun_from(toward)];
    for (shading, formula) in formulas(&material) {
        let image = draw(&scene, &Settings { shading, ..sharp(SIZE) });
        for wrong in [DVec3::new(0.1, -0.5, 0.9).normalize(), DVec3::new(0.5, -0.6, 0.8).normalize(), -toward] {
            let expected = |angles: &FiberAngles, normal: DVec3, _: DVec3| formula(angles, normal.dot(wrong));
            assert!(error(&image, view.normalize(), expected, wrong) > 0.02, "{shading:?}, {wrong} passes");
        }
    }
}

#[test]
fn in_a_furnace_a_lone_fiber_gives_back_its_ambient_colour() {
    for name in MATERIALS {
        let material = Material::preset(name).expect(name);
        let (fiber, tables) = (lone_fiber(material), ScatteringTables::new(&material));
        for view in VIEWS.map(DVec3::from) {
            for (shading, occlusion) in [
                (Shading::Simple, Occlusion::Distance),
                (Shading::Physical, Occlusion::Distance),
                (Shading::Physical, Occlusion::Table),
            ] {
                let scene = scene(vec![fiber.clone()], close_up(&fiber, view, SIZE));
                let image = draw(&scene, &Settings { shading, occlusion, ..sharp(SIZE) });
                let expected = |angles: &FiberAngles, _: DVec3, _: DVec3| match shading {
                    Shading::Simple => simple_ambient(&material, angles.sin_theta_o),
                    Shading::Physical => physical_ambient(&material, &tables.ambient(angles.theta_o_rad())),
                };
                let error = error(&image, view.normalize(), expected, DVec3::Z);
                let most = image.combined.iter().flat_map(|c| [c[0], c[1], c[2]]).fold(0.0, f32::max);
                println!("{name}, {shading:?}, {occlusion:?}: within {:.3} %, at most {most:.4}", 100.0 * error);
                assert!(error < 0.01, "{name}, {shading:?}, {occlusion:?}: {error}");
                // The lobes of R + TT are normalised by the light's angle alone: seen at a slant, they give back a little more.
                let bound = if shading == Shading::Simple { 1.0 + 1e-3 } else { 1.06 };
                assert!(most <= bound, "{name}: a fiber gives back {most} of 1");
            }
        }
    }
}

#[test]
fn in_a_furnace_a_whole_yarn_gives_back_at_most_what_comes_in() {
    let yarns = yarns_of(curves::wave(2.0, 0.2, 60), false, 0.2);
    let camera = orthographic(looking(DVec3::new(0.2, -3.0, 0.4), DVec3::ZERO), 0.8, SIZE, [0.0, 0.0]);
    let white = Material {
        color_r: DVec3::ONE,
        color_tt: DVec3::ONE,
        diffuse: DVec3::ONE,
        specular: DVec3::ZERO,
        ..Material::preset("cotton").expect("preset")
    };
    for lod_pixels in [0.0, 4.0] {
        for shading in [Shading::Simple, Shading::Physical] {
            let object = Object { material: Arc::new(white), ..object(&yarns, &preset("cotton-1")) };
            let settings =
                Settings { shading, lod_pixels, samples: 8, filter_width: 1.5, shadow_resolution: 256, ..sharp(SIZE) };
            let image = draw(&scene(vec![object], camera), &settings);
            let most = image.combined.iter().map(|c| c[0] / c[3].max(1e-3)).fold(0.0, f32::max);
            println!("{shading:?}, {lod_pixels} px: mean {:.3}, at most {most:.4}", measure::brightness(&image));
            assert!(most <= 1.0 + 1e-3, "{shading:?}: {most}");
            assert!(measure::brightness(&image) > 0.2, "{shading:?}: dark");
        }
    }
}

/// The middle of a straight yarn along X at the origin, from the front: the mean radiance.
fn patch(lights: Vec<Light>, ambient: f32, others: &[Object], meshes: Vec<Mesh>, samples: u32) -> f64 {
    let target = object(&yarns_of(curves::straight(0.6, 20), false, 0.05), &preset("cotton-2"));
    let camera = orthographic(looking(DVec3::new(0.0, -0.5, 0.0), DVec3::ZERO), 0.06, [40, 20], [0.0, 0.0]);
    let mut objects = vec![target];
    objects.extend(others.iter().cloned());
    let scene = Scene { lights, meshes, ambient: Vec3::splat(ambient), ..scene(objects, camera) };
    let settings = Settings { samples, ..sharp([40, 20]) };
    measure::brightness(&draw(&scene, &settings))
}

/// Where the tests' lights come from, and their distance.
fn toward() -> DVec3 {
    DVec3::new(0.1, -0.5, 0.85).normalize()
}

fn point(distance: f64, power: f32, radius: f64, cone: Option<Cone>) -> Light {
    Light::Point { position: toward() * distance, power: Vec3::splat(power), radius, cone }
}

/// An area light that shines towards the origin, turned away by an angle.
fn area(distance: f64, power: f32, size: f64, turned: f64) -> Light {
    let aimed = looking(toward() * distance, DVec3::ZERO);
    Light::Area {
        world_from_light: aimed * DMat4::from_rotation_y(turned),
        size: [size, size],
        ellipse: false,
        power: Vec3::splat(power),
    }
}

fn spot(angle_rad: f64, blend: f64, turned: f64) -> Option<Cone> {
    let aimed = looking(toward() * 4.0, DVec3::ZERO) * DMat4::from_rotation_y(turned);
    Some(Cone { direction: -aimed.z_axis.truncate(), angle_rad, blend })
}

#[test]
fn every_light_gives_the_irradiance_of_its_closed_form() {
    let sun = |irradiance: f64| {
        let light = Light::Sun { direction: -toward(), irradiance: Vec3::splat(irradiance as f32), angle_rad: 0.0 };
        patch(vec![light], 0.0, &[], vec![], 1)
    };
    let unit = sun(1.0);
    assert!(unit > 1e-3, "{unit}");
    // The patch is 0.06 wide: at a distance of 4 the light's direction varies by less than a degree.
    for (name, lights, samples, expected) in [
        ("sun of 3", vec![Light::Sun { direction: -toward(), irradiance: Vec3::splat(3.0), angle_rad: 0.0 }], 1, 3.0),
        ("soft sun", vec![Light::Sun { direction: -toward(), irradiance: Vec3::ONE, angle_rad: 0.02 }], 32, 1.0),
        ("point at 4", vec![point(4.0, 100.0, 0.0, None)], 1, 100.0 / (4.0 * PI * 16.0)),
        ("point at 8", vec![point(8.0, 100.0, 0.0, None)], 1, 100.0 / (4.0 * PI * 64.0)),
        ("soft point", vec![point(8.0, 100.0, 0.1, None)], 32, 100.0 / (4.0 * PI * 64.0)),
        ("spot", vec![point(4.0, 100.0, 0.0, spot(0.6, 0.0, 0.0))], 1, 100.0 / (4.0 * PI * 16.0)),
        ("spot aside, inside", vec![point(4.0, 100.0, 0.0, spot(0.6, 0.0, 0.27))], 1, 100.0 / (4.0 * PI * 16.0)),
        ("spot aside, outside", vec![point(4.0, 100.0, 0.0, spot(0.6, 0.0, 0.33))], 1, 0.0),
        ("area", vec![area(4.0, 50.0, 0.1, 0.0)], 16, 50.0 / (PI * 16.0)),
        ("area at 8", vec![area(8.0, 50.0, 0.1, 0.0)], 16, 50.0 / (PI * 64.0)),
        ("area turned by 60°", vec![area(4.0, 50.0, 0.1, PI / 3.0)], 16, 0.5 * 50.0 / (PI * 16.0)),
        ("area turned away", vec![area(4.0, 50.0, 0.1, 2.0)], 16, 0.0),
        (
            "two lights",
            vec![point(4.0, 100.0, 0.0, None), area(4.0, 50.0, 0.1, 0.0)],
            16,
            100.0 / (64.0 * PI) + 50.0 / (16.0 * PI),
        ),
    ] {
        let ratio = patch(lights, 0.0, &[], vec![], samples) / unit;
        println!("{name}: irradiance {ratio:.4}, expected {expected:.4}");
        assert!((ratio - expected).abs() <= 0.02 * expected + 1e-6, "{name}: {ratio} instead of {expected}");
    }
}

#[test]
fn a_spot_with_a_soft_edge_fades_within_its_cone() {
    // Full within the share (1 - blend) of the cone's cosines, dark at its edge of 0.3, smooth in between.
    let (angle, blend): (f64, f64) = (0.6, 0.8);
    // To both sides: what is bright need not lie in the middle of the patch.
    let to_one_side = |turned| patch(vec![point(4.0, 100.0, 0.0, spot(angle, blend, turned))], 0.0, &[], vec![], 1);
    let at = |turned: f64| 0.5 * (to_one_side(turned) + to_one_side(-turned));
    let full = at(0.0);
    let edge = (0.5 * angle).cos();
    for k in 0..8 {
        let turned = 0.045 * f64::from(k);
        let x = ((turned.cos() - edge) / ((1.0 - edge) * blend)).clamp(0.0, 1.0);
        let expected = x * x * (3.0 - 2.0 * x);
        let share = at(turned) / full;
        println!("turned by {turned:.3}: {share:.4}, expected {expected:.4}");
        assert!((share - expected).abs() < 0.01, "turned by {turned}: {share} instead of {expected}");
    }
}

/// Of the shares of a shadow map's texels.
const ROUNDING: f64 = 1e-7;

/// A thick yarn across the way from the patch to a direction.
fn blocker(toward: DVec3, distance: f64, radius: f32) -> Object {
    let straight = curves::straight(1.2, 12);
    let across = DMat4::from_rotation_z(0.6);
    Object {
        id: 5,
        world_from_object: DMat4::from_translation(toward * distance) * across,
        ..object(&yarns_of(straight, false, radius), &preset("cotton-2"))
    }
}

/// A square across the way from the origin to a direction, at a distance.
fn wall(toward: DVec3, distance: f64, side: f32) -> Mesh {
    let [a, b] = [-0.5 * side, 0.5 * side];
    let corners = vec![[a, a, 0.0], [b, a, 0.0], [b, b, 0.0], [a, b, 0.0]];
    let square = Triangles::new(corners, vec![[0, 1, 2], [0, 2, 3]], None).expect("a square");
    Mesh {
        name: "wall".into(),
        id: 6,
        labels: Labels::default(),
        triangles: Arc::new(square),
        base_color: Vec3::ONE,
        texture: None,
        kind: MeshKind::Shaded,
        world_from_object: looking(toward * distance, DVec3::ZERO),
    }
}

#[test]
fn a_yarn_in_the_way_shades_and_one_aside_does_not() {
    for (name, light, samples) in [
        ("sun", Light::Sun { direction: -toward(), irradiance: Vec3::ONE, angle_rad: 0.0 }, 1),
        ("soft sun", Light::Sun { direction: -toward(), irradiance: Vec3::ONE, angle_rad: 0.05 }, 16),
        ("point", point(4.0, 100.0, 0.0, None), 1),
        ("soft point", point(4.0, 100.0, 0.05, None), 16),
        ("spot", point(4.0, 100.0, 0.0, spot(0.8, 0.2, 0.0)), 1),
        ("area", area(4.0, 50.0, 0.1, 0.0), 16),
        ("point among the yarns", point(0.9, 10.0, 0.0, None), 1),
    ] {
        let lit = |others: &[Object], meshes: Vec<Mesh>| patch(vec![light], 0.0, others, meshes, samples);
        let open = lit(&[], vec![]);
        let far = lit(&[blocker(toward(), 0.45, 0.2)], vec![]) / open;
        // As wide as the patch, less its rims.
        let near = lit(&[blocker(toward(), 0.12, 0.06)], vec![]) / open;
        let behind = lit(&[blocker(-toward(), 0.6, 0.2)], vec![]) / open;
        let walled = lit(&[], vec![wall(toward(), 0.45, 0.6)]) / open;
        println!(
            "{name}: open {open:.4}; {far:e} and {near:.5} behind a yarn, {behind:.3} before it, {walled:e} behind a wall"
        );
        assert!(walled < ROUNDING, "{name}: light leaks past a wall, {walled}");
        assert!(far < ROUNDING, "{name}: {far} through the middle of a yarn");
        assert!(near < 0.2, "{name}: {near}");
        assert!((behind - 1.0).abs() < 0.02, "{name}: a yarn behind takes {behind}");
    }
    // The sky: a yarn hides its share of it.
    let sky = |others: &[Object]| patch(vec![], 1.0, others, vec![], 64);
    let share = sky(&[blocker(toward(), 0.3, 0.2)]) / sky(&[]);
    println!("sky: {share:.3}");
    assert!((0.3..0.95).contains(&share), "{share}");
}

#[test]
fn no_light_leaks_between_the_faces_of_a_cube() {
    // A light in the midst of yarns, blocked in the directions in which faces meet.
    let edge = |a: f64, b: f64| [DVec3::new(a, b, 0.0), DVec3::new(a, 0.0, b), DVec3::new(0.0, a, b)];
    let mut directions: Vec<DVec3> =
        [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].iter().flat_map(|(a, b)| edge(*a, *b)).collect();
    directions
        .extend((0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0));
    let yarns = yarns_of(curves::straight(0.5, 10), false, 0.05);
    let thick = yarns_of(curves::straight(1.0, 10), false, 0.2);
    for direction in directions.into_iter().map(DVec3::normalize) {
        let turned = |at: DVec3| {
            let (x, y) = direction.any_orthonormal_pair();
            DMat4::from_cols(x.extend(0.0), y.extend(0.0), direction.extend(0.0), at.extend(1.0))
        };
        let base = object(&yarns, &preset("cotton-2"));
        let target = Object { world_from_object: turned(direction * 2.0), ..base.clone() };
        let opposite = Object { id: 2, world_from_object: turned(direction * -2.0), ..base.clone() };
        let thick = Object { id: 3, world_from_object: turned(direction), ..object(&thick, &preset("cotton-2")) };
        // From between the light and the target, so that the blocker is behind the camera.
        let camera = orthographic(looking(direction * 1.6, direction * 2.0), 0.08, [24, 24], [0.0, 0.0]);
        let lit = |blockers: &[Object], meshes: Vec<Mesh>| {
            let light = Light::Point { position: DVec3::ZERO, power: Vec3::splat(100.0), radius: 0.0, cone: None };
            let objects = [&[target.clone(), opposite.clone()], blockers].concat();
            let scene = Scene { lights: vec![light], meshes, ambient: Vec3::ZERO, ..scene(objects, camera) };
            // A thin yarn far away in a face of 90°: with coarse texels it would shade itself in the open.
            measure::brightness(&draw(&scene, &Settings { shadow_resolution: 1024, ..sharp([24, 24]) }))
        };
        let open = lit(&[], vec![]);
        let shaded = lit(&[thick], vec![]);
        let walled = lit(&[], vec![wall(direction, 1.0, 0.6)]) / open;
        println!(
            "{direction:.2}: open {open:.4}, behind yarn {:.4} %, behind a wall {walled:e}",
            100.0 * shaded / open
        );
        assert!(open > 0.01, "{direction}: {open}");
        assert!(walled < ROUNDING, "{direction}: light leaks past a wall, {walled}");
        assert!(shaded / open < ROUNDING, "{direction}: light leaks past a yarn, {shaded}");
    }
}

/// A wall behind a yarn gets what the fibers leave of a sun.
#[test]
fn a_yarn_takes_as_much_light_as_its_fibers() {
    let (radius, side) = (0.1, 0.8);
    for name in ["cotton-1", "polyester-1", "rayon-3"] {
        let yarn = preset(name);
        let toward = DVec3::new(0.0, -1.0, 0.0);
        let across = object(&yarns_of(curves::straight(1.2, 12), false, radius as f32), &yarn);
        let across = Object { world_from_object: DMat4::from_translation(toward), ..across };
        // From between them.
        let camera = orthographic(looking(0.5 * toward, DVec3::ZERO), side, [8, 256], [0.0, 0.0]);
        let lit = |objects: Vec<Object>| {
            let scene = Scene { meshes: vec![wall(-toward, 0.3, 1.0)], ambient: Vec3::ZERO, ..scene(objects, camera) };
            let scene = Scene { lights: vec![sun_from(toward)], ..scene };
            measure::brightness(&draw(
                &scene,
                &Settings { shadow_resolution: 2048, samples: 8, filter_width: 1.5, ..sharp([8, 256]) },
            ))
        };
        let taken = 1.0 - lit(vec![across]) / lit(vec![]);
        // Rays through the section from all sides, by the table that rays through explicit fibers are compared with.
        let table = SelfShadow::new(&Bundle::of(&yarn), &SectionDensity::new(&yarn), 1);
        let rays = || {
            (0..64 * 200).map(|k| {
                let (psi, y) = (TAU * f64::from(k / 200) / 64.0, 0.0125 * (f64::from(k % 200) + 0.5) - 1.25);
                1.0 - (-table.at(psi, DVec2::from_angle(psi).rotate(DVec2::new(-1.2, y)))).exp()
            })
        };
        let expected = 2.5 * radius / side * rays().sum::<f64>() / rays().count() as f64;
        println!("{name}: {taken:.4} of the light taken, {expected:.4} by its fibers");
        assert!((taken / expected - 1.0).abs() < 0.02, "{name}: {taken} instead of {expected}");
        let opaque = 2.0 * radius / side;
        assert!(taken < 0.9 * opaque, "{name}: as much as by all of the yarn's circle");
    }
}

#[test]
fn yarns_that_touch_shade_each_other_at_the_contact() {
    // Two straight yarns side by side under a low sun: the near side of the far one is dark, its upper side is lit.
    let near = object(&yarns_of(curves::straight(4.0, 40), false, 0.1), &preset("cotton-1"));
    let far = Object { id: 2, world_from_object: DMat4::from_translation(DVec3::new(0.0, 0.0, -0.2)), ..near.clone() };
    let camera = orthographic(looking(DVec3::new(0.0, -3.0, 0.0), DVec3::new(0.0, 0.0, -0.1)), 0.44, SIZE, [0.0, 0.0]);
    let from = DVec3::new(0.0, -FRAC_PI_4.cos(), FRAC_PI_4.sin() * 3.0).normalize();
    let bright = |objects: Vec<Object>| {
        let scene = Scene { lights: vec![sun_from(from)], ambient: Vec3::ZERO, ..scene(objects, camera) };
        let image = draw(&scene, &Settings { samples: 8, filter_width: 1.5, shadow_resolution: 1024, ..sharp(SIZE) });
        picture::show("contact", &image);
        // The upper half of the lower yarn.
        measure::brightness(&measure::crop(&image, [0, 26, 64, 8]))
    };
    let alone = bright(vec![far.clone()]);
    let together = bright(vec![near, far]);
    println!("alone {alone:.4}, under another yarn {together:.4}");
    // By the path tracer 0.704, light scattered once.
    assert!((together / alone - 0.704).abs() < 0.04, "contact shadow: {together} of {alone}");
}
