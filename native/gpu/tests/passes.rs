//! Passes that are drawn when asked for.

mod support;

use glam::{DMat4, DVec3, DVec4, Vec4Swizzles};
use lisle_core::scattering::Material;
use lisle_gpu::{
    Aov, Camera, Exposure, Image, Labels, Lens, Mesh, MeshKind, Object, Scene, Settings, Shading, Triangles,
    cryptomatte,
};
use support::{
    curves, draw, exact, expose, looking, measure, object, orthographic, perspective, preset, scene, yarns_of,
};

const SIZE: [u32; 2] = [96, 72];

fn wave() -> Object {
    object(&yarns_of(curves::wave(3.0, 0.5, 40), false, 0.12), &preset("cotton-1"))
}

fn front() -> Camera {
    perspective(looking(DVec3::new(0.3, -5.0, 0.4), DVec3::ZERO), 0.25, SIZE, [0.1, 0.0])
}

fn settings(aovs: &[Aov]) -> Settings {
    Settings { samples: 8, filter_width: 1.5, lod_pixels: 1.0, aovs: aovs.to_vec(), ..exact(SIZE) }
}

fn values(image: &Image, aov: Aov) -> impl Iterator<Item = &[f32]> {
    let found = image.aovs.iter().find(|(known, _)| *known == aov);
    found.expect("it was asked for").1.chunks_exact(aov.channels())
}

fn is_there(image: &Image) -> impl Iterator<Item = bool> + '_ {
    image.depth.iter().map(|depth| *depth < Image::EMPTY_DEPTH)
}

/// Where a point of the world is on the picture, pixels, and its w.
fn on_picture(camera: &Camera, point: DVec3) -> DVec3 {
    let clip: DVec4 = camera.clip_from_camera * camera.world_from_camera.inverse() * point.extend(1.0);
    let [width, height] = SIZE.map(f64::from);
    DVec3::new((0.5 + 0.5 * clip.x / clip.w) * width, (0.5 - 0.5 * clip.y / clip.w) * height, clip.w)
}

fn still() -> Vec<Aov> {
    Aov::ALL.into_iter().filter(|aov| *aov != Aov::Vector).collect()
}

#[test]
fn what_is_not_asked_for_takes_nothing_and_changes_nothing() {
    let scene = scene(vec![wave()], front());
    let plain = draw(&scene, &settings(&[]));
    assert!(plain.aovs.is_empty());
    let mut full = draw(&scene, &settings(&still()));
    assert!(full.statistics.gpu_bytes > plain.statistics.gpu_bytes);
    let few = draw(&scene, &settings(&[Aov::ObjectIndex, Aov::DenoisingNormal]));
    assert_eq!(few.statistics.gpu_bytes, plain.statistics.gpu_bytes);
    full.aovs.clear();
    assert_eq!(measure::difference(&full, &plain), None);
}

#[test]
fn a_region_has_the_passes_of_the_whole() {
    let scene = scene(vec![wave()], front());
    let whole = draw(&scene, &settings(&still()));
    let region = [30, 20, 41, 33];
    let part = draw(&scene, &Settings { region: Some(region), ..settings(&still()) });
    assert_eq!(measure::difference(&part, &measure::crop(&whole, region)), None);
    let mut broken = part.clone();
    broken.aovs[0].1[7] += 1.0;
    assert!(measure::difference(&broken, &part).is_some());
}

#[test]
fn positions_are_where_they_are_seen() {
    for offset in [DVec3::ZERO, DVec3::new(2e3, -3e3, 1e3)] {
        let shift = DMat4::from_translation(offset);
        let camera = Camera { world_from_camera: shift * front().world_from_camera, ..front() };
        let image =
            draw(&scene(vec![Object { world_from_object: shift, ..wave() }], camera), &settings(&[Aov::Position]));
        let mut seen = 0;
        for ((i, position), depth) in values(&image, Aov::Position).enumerate().zip(&image.depth) {
            if *depth == Image::EMPTY_DEPTH {
                assert_eq!(position, [0.0; 3]);
                continue;
            }
            let point = DVec3::new(position[0].into(), position[1].into(), position[2].into());
            let found = on_picture(&camera, point);
            let center = [(i as u32 % SIZE[0]) as f64 + 0.5, (i as u32 / SIZE[0]) as f64 + 0.5];
            let off = (found.x - center[0]).hypot(found.y - center[1]);
            assert!(off < 0.8, "pixel {i}: {off}");
            assert!((found.z - f64::from(*depth)).abs() < 1e-3 * (1.0 + 0.01 * offset.length()), "{} {depth}", found.z);
            seen += 1;
        }
        assert!(seen > 500, "{seen}");
    }
}

#[test]
fn uv_is_the_length_coordinate_and_the_angle() {
    let camera = orthographic(looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO), 1.0, SIZE, [0.0, 0.0]);
    // At twice the size: lengths are those of the object at rest.
    let yarns = yarns_of(curves::straight(2.0, 30), false, 0.1);
    let twice = DMat4::from_scale(DVec3::splat(2.0));
    let thread = Object { world_from_object: twice, ..object(&yarns, &support::without_flyaways(preset("silk-1"))) };
    let image = draw(&scene(vec![thread], camera), &settings(&[Aov::Uv, Aov::Position]));
    let mut angles = Vec::new();
    for ((uv, position), there) in values(&image, Aov::Uv).zip(values(&image, Aov::Position)).zip(is_there(&image)) {
        if there {
            assert!((uv[0] - (0.5 * position[0] + 1.0)).abs() < 0.002, "{uv:?} at {position:?}");
            assert!((0.0..1.0).contains(&uv[1]));
            // Y and Z about the yarn's axis, X.
            angles.push((uv[1] - position[2].atan2(position[1]) / std::f32::consts::TAU).rem_euclid(1.0));
        } else {
            assert_eq!(uv, [0.0; 2]);
        }
    }
    assert!(angles.len() > 1000);
    let spread = |angle: &f32| (angle - angles[0] + 0.5).rem_euclid(1.0) - 0.5;
    let most = angles.iter().map(|a| spread(a).abs()).fold(0.0, f32::max);
    assert!(most < 0.01, "{most}");
}

#[test]
fn vectors_point_from_frame_to_frame() {
    let camera = orthographic(looking(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO), 2.0, SIZE, [0.0, 0.0]);
    // Half a unit is 18 pixels.
    let pixels = f64::from(SIZE[1]) / 2.0;
    let (before, after) = (DVec3::new(-0.1, 0.3, -0.05), DVec3::new(0.2, 0.0, 0.1));
    let expected = [before.x * pixels, before.z * pixels, -after.x * pixels, -after.z * pixels];
    let wave = wave();
    let here = scene(vec![wave.clone()], camera);
    let by_object = |offset: DVec3| {
        scene(vec![Object { world_from_object: DMat4::from_translation(offset), ..wave.clone() }], camera)
    };
    let by_points = |offset: DVec3| {
        let mut moved = here.clone();
        let shifted: Vec<[f32; 3]> =
            wave.yarns.points().iter().map(|p| (glam::Vec3::from(*p) + offset.as_vec3()).to_array()).collect();
        moved.objects[0].yarns =
            std::sync::Arc::new(here.objects[0].yarns.with_points(&shifted).expect("as many points"));
        moved
    };
    let by_camera = |offset: DVec3| {
        let moved = DMat4::from_translation(-offset) * camera.world_from_camera;
        scene(here.objects.clone(), Camera { world_from_camera: moved, ..camera })
    };
    type Move<'a> = &'a dyn Fn(DVec3) -> Scene;
    for (what, moved) in [("object", &by_object as Move), ("points", &by_points), ("camera", &by_camera)] {
        let [first, last] = [moved(before), moved(after)];
        let exposure = Exposure { steps: vec![here.clone()], neighbours: Some([first.clone(), last.clone()]) };
        let image = expose(&exposure, &settings(&[Aov::Vector]));
        let mut seen = 0;
        for (vector, there) in values(&image, Aov::Vector).zip(is_there(&image)) {
            for (found, expected) in vector.iter().zip(expected) {
                let expected = if there { expected } else { 0.0 };
                assert!((f64::from(*found) - expected).abs() < 0.02, "{what}: {vector:?} for {expected}");
            }
            seen += u32::from(there);
        }
        assert!(seen > 500, "{what}: {seen}");
        let still = draw(&here, &settings(&[]));
        assert_eq!(image.combined, still.combined);
    }
    let error = support::renderer()
        .render(&here, &settings(&[Aov::Vector]), &mut |_| std::ops::ControlFlow::Continue(()))
        .expect_err("no frames before and after");
    assert!(error.to_string().contains("vector"), "{error}");
}

#[test]
fn a_winding_yarn_that_turns_is_followed() {
    // Rotation about the view axis: positions before and after are those of the rotated points.
    let camera = front();
    let wave = wave();
    let here = scene(vec![wave.clone()], camera);
    let turn = |angle: f64| {
        let turned = DMat4::from_rotation_y(angle);
        scene(vec![Object { world_from_object: turned, ..wave.clone() }], camera)
    };
    let [first, last] = [turn(-0.05), turn(0.08)];
    let exposure = Exposure { steps: vec![here.clone()], neighbours: Some([first.clone(), last.clone()]) };
    let image = expose(&exposure, &settings(&[Aov::Vector, Aov::Position]));
    let mut worst = 0.0_f64;
    for ((vector, position), there) in
        values(&image, Aov::Vector).zip(values(&image, Aov::Position)).zip(is_there(&image))
    {
        if there {
            let point = DVec3::new(position[0].into(), position[1].into(), position[2].into());
            let at = |angle: f64| on_picture(&camera, (DMat4::from_rotation_y(angle) * point.extend(1.0)).xyz());
            let [before, now, after] = [at(-0.05), at(0.0), at(0.08)];
            let expected = [before.x - now.x, now.y - before.y, now.x - after.x, after.y - now.y];
            let off = vector.iter().zip(expected).map(|(v, e)| (f64::from(*v) - e).abs()).fold(0.0, f64::max);
            worst = worst.max(off);
        }
    }
    assert!(worst > 0.0 && worst < 0.05, "{worst} pixels");
}

#[test]
fn what_stands_still_has_no_vector_through_any_lens_and_sample() {
    let lens = Lens { aperture_radius: 0.2, focus_distance: 3.0, blades: 0, rotation_rad: 0.0, ratio: 1.0 };
    let still = scene(vec![wave()], Camera { lens: Some(lens), ..front() });
    let exposure = Exposure { neighbours: Some([still.clone(), still.clone()]), ..Exposure::still(still.clone()) };
    for first_sample in [0, 5] {
        let image = expose(&exposure, &Settings { first_sample, ..settings(&[Aov::Vector]) });
        assert!(is_there(&image).filter(|there| *there).count() > 500);
        let most = values(&image, Aov::Vector).flatten().fold(0.0_f32, |most, v| most.max(v.abs()));
        assert!(most < 1e-3, "from sample {first_sample} on: {most} pixels");
    }
}

#[test]
fn another_material_in_the_frames_beside_changes_nothing() {
    let here = scene(vec![wave()], front());
    let mut other = here.clone();
    other.objects[0].material = std::sync::Arc::new(Material::preset("silk").expect("preset"));
    assert_ne!(other.objects[0].material, here.objects[0].material);
    let image = |beside: &Scene| {
        let exposure = Exposure { steps: vec![here.clone()], neighbours: Some([beside.clone(), beside.clone()]) };
        expose(&exposure, &settings(&[Aov::Vector]))
    };
    let [same, apart] = [image(&here), image(&other)];
    assert_eq!(values(&same, Aov::Vector).collect::<Vec<_>>(), values(&apart, Aov::Vector).collect::<Vec<_>>());
    assert_eq!(same.combined, apart.combined);
}

#[test]
fn meshes_are_followed() {
    let corners = vec![[-1.0, 0.5, -1.0], [1.0, 0.5, -1.0], [1.0, 0.8, 1.0], [-1.0, 0.8, 1.0]];
    let mesh = Mesh {
        name: "wall".into(),
        id: 7,
        labels: Labels::default(),
        triangles: std::sync::Arc::new(Triangles::new(corners, vec![[0, 1, 2], [0, 2, 3]], None).expect("a square")),
        base_color: glam::Vec3::ONE,
        texture: None,
        kind: MeshKind::Shaded,
        world_from_object: DMat4::from_translation(DVec3::new(0.1, 0.0, 0.2)),
    };
    let wave = wave();
    // Mesh and camera both move.
    let at = |time: f64| {
        let turned = mesh.world_from_object * DMat4::from_rotation_y(0.1 * time);
        let shift = DMat4::from_translation(DVec3::new(0.05 * time, 0.1 * time, -0.03 * time));
        let camera = Camera { world_from_camera: shift * front().world_from_camera, ..front() };
        let meshes = vec![Mesh { world_from_object: turned, ..mesh.clone() }];
        Scene { meshes, ..scene(vec![wave.clone()], camera) }
    };
    let [before, here, after] = [-1.0, 0.0, 1.5].map(at);
    let exposure = Exposure { steps: vec![here.clone()], neighbours: Some([before.clone(), after.clone()]) };
    for first_sample in [0, 3] {
        let image = expose(&exposure, &Settings { first_sample, ..settings(&[Aov::Vector, Aov::Position]) });
        let (mut worst, mut most, mut seen) = (0.0_f64, 0.0_f64, 0);
        for ((vector, position), id) in
            values(&image, Aov::Vector).zip(values(&image, Aov::Position)).zip(&image.object_id)
        {
            if *id == 7 {
                let point = DVec3::new(position[0].into(), position[1].into(), position[2].into());
                let own = here.meshes[0].world_from_object.inverse() * point.extend(1.0);
                let [a, b, c] = [&before, &here, &after]
                    .map(|scene| on_picture(&scene.camera, (scene.meshes[0].world_from_object * own).xyz()));
                let expected = [a.x - b.x, b.y - a.y, b.x - c.x, c.y - b.y];
                for (found, expected) in vector.iter().zip(expected) {
                    (worst, most) = (worst.max((f64::from(*found) - expected).abs()), most.max(expected.abs()));
                }
                seen += 1;
            }
        }
        assert!(seen > 1000 && most > 2.0 && worst < 0.01, "{seen} pixels move by {most}, off by {worst}");
    }
}

fn labelled(name: &str, material: &str, index: u32, at: f64) -> Object {
    Object {
        name: name.into(),
        id: index,
        labels: Labels { index, material: material.into(), material_index: 10 * index },
        world_from_object: DMat4::from_translation(DVec3::new(0.0, 0.4 * at, 0.12 * at)),
        ..wave()
    }
}

#[test]
fn mattes_hold_the_coverage_of_every_name() {
    let objects =
        vec![labelled("left", "wool", 1, -1.0), labelled("right", "silk", 2, 0.0), labelled("left", "silk", 3, 1.0)];
    let wanted = [Aov::CryptoObject, Aov::CryptoMaterial, Aov::ObjectIndex, Aov::MaterialIndex];
    let image = draw(&scene(objects.clone(), front()), &settings(&wanted));
    let id = |name: &str| cryptomatte::id(cryptomatte::hash(name));
    let coverage = |aov: Aov, name: &str| -> f64 {
        let of = |pairs: &[f32]| pairs.chunks(2).filter(|p| p[0] == id(name)).map(|p| f64::from(p[1])).sum::<f64>();
        values(&image, aov).map(of).sum()
    };
    for (pairs, color) in values(&image, Aov::CryptoObject).zip(&image.combined) {
        let sum: f32 = pairs.chunks(2).map(|pair| pair[1]).sum();
        assert!((sum - color[3]).abs() < 1e-6, "{sum} of {}", color[3]);
        assert!(pairs.chunks(2).is_sorted_by(|a, b| a[1] >= b[1]));
    }
    let area = measure::area(&image);
    let sum = |aov, names: [&str; 2]| names.iter().map(|name| coverage(aov, name)).sum::<f64>();
    assert!((sum(Aov::CryptoObject, ["left", "right"]) / area - 1.0).abs() < 1e-6);
    assert!((sum(Aov::CryptoMaterial, ["wool", "silk"]) / area - 1.0).abs() < 1e-6);
    // Without the others, the nearest object covers what its name does.
    let nearest = draw(&scene(vec![labelled("x", "wool", 1, -1.0)], front()), &settings(&[]));
    assert!((coverage(Aov::CryptoMaterial, "wool") / measure::area(&nearest) - 1.0).abs() < 1e-3);
    for ((object, material), id) in
        values(&image, Aov::ObjectIndex).zip(values(&image, Aov::MaterialIndex)).zip(&image.object_id)
    {
        assert_eq!((object[0], material[0]), (*id as f32, 10.0 * *id as f32));
    }
}

#[test]
fn denoisers_get_colour_without_light_and_normals() {
    let mut scene = scene(vec![wave()], front());
    let wanted = [Aov::Albedo, Aov::DenoisingNormal];
    let lit = draw(&scene, &settings(&wanted));
    scene.ambient = glam::Vec3::ZERO;
    let dark = draw(&scene, &settings(&wanted));
    assert_eq!(lit.aovs, dark.aovs);
    assert!(measure::brightness(&dark) == 0.0);
    for ((albedo, normal), (color, unit)) in
        values(&lit, Aov::Albedo).zip(values(&lit, Aov::DenoisingNormal)).zip(lit.combined.iter().zip(&lit.normal))
    {
        let alpha = color[3];
        assert!(albedo.iter().all(|c| *c <= alpha + 1e-6 && (alpha == 0.0 || *c > 0.02 * alpha)), "{albedo:?} {alpha}");
        let normal = glam::Vec3::from_slice(normal);
        assert!(normal.length() <= alpha + 1e-5);
        assert!(normal.normalize_or_zero().distance((*unit).into()) < 1e-4);
    }
}

#[test]
fn components_add_up_to_the_picture() {
    let parts = [Aov::Diffuse, Aov::Specular, Aov::Transmission, Aov::Scattered, Aov::Ambient];
    let material = Material { diffuse_weight: 0.3, ..*wave().material };
    let mut scene = scene(vec![Object { material: material.into(), ..wave() }], front());
    scene.lights = vec![support::sun([1.0, 1.0, -1.0], 2.0), support::sun([-1.0, 0.5, -0.2], 1.0)];
    for shading in [Shading::Physical, Shading::Simple] {
        let mut wanted = parts.to_vec();
        wanted.push(Aov::Shadow);
        let settings = Settings { shading, transport_photons: 20_000, ..settings(&wanted) };
        let image = draw(&scene, &settings);
        let mut sums = vec![[0.0_f32; 3]; image.combined.len()];
        for aov in parts {
            let mut total = 0.0;
            for (sum, value) in sums.iter_mut().zip(values(&image, aov)) {
                assert!(value.iter().all(|v| v.is_finite() && *v >= 0.0));
                total += value.iter().sum::<f32>();
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
            }
            let is_there = shading == Shading::Physical || !matches!(aov, Aov::Transmission | Aov::Scattered);
            assert_eq!(total > 0.0, is_there, "{aov:?}");
        }
        for (sum, color) in sums.iter().zip(&image.combined) {
            for (sum, color) in sum.iter().zip(color) {
                assert!((sum - color).abs() <= 1e-5 * (1.0 + color), "{sum} of {color}");
            }
        }
        assert!(
            values(&image, Aov::Shadow)
                .zip(&image.combined)
                .all(|(open, color)| (0.0..=color[3] + 1e-5).contains(&open[0]))
        );
    }
    // Yarn alone in the light, and behind a wall of yarn.
    let shaded = |objects: Vec<Object>| -> f64 {
        let scene = Scene { objects, lights: vec![support::sun([0.0, 0.0, -1.0], 2.0)], ..scene.clone() };
        let image = draw(&scene, &Settings { transport_photons: 0, ..settings(&[Aov::Shadow]) });
        let open = values(&image, Aov::Shadow).zip(&image.object_id).filter(|(_, id)| **id == 1);
        let (sum, count) = open.fold((0.0, 0.0), |(s, n), (v, _)| (s + f64::from(v[0]), n + 1.0));
        sum / count
    };
    let roof = Object {
        id: 2,
        world_from_object: DMat4::from_translation(DVec3::new(0.0, 0.0, 3.0)),
        ..object(&yarns_of(curves::straight(9.0, 20), false, 1.0), &preset("cotton-1"))
    };
    let (alone, under) = (shaded(vec![wave()]), shaded(vec![wave(), roof]));
    assert!(under < 0.5 * alone, "{under} of {alone}");
}
