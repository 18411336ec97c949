//! Edges that move or are out of focus: their profile, by formulas.

mod support;

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::Yarns;
use lisle_core::scene::{Camera, Lens, Mesh, MeshKind, Scene, Triangles};
use lisle_reference::{Error, Image, Reference, Settings};
use support::{RADIUS, draw, lambert, looking, object, orthographic, scene, single_fiber, straight};

const HEIGHT: f64 = 10.0 * RADIUS;
const ROWS: u32 = 100;

fn camera(z: f64, columns: u32) -> Camera {
    orthographic(looking(DVec3::new(0.0, -10.0, z), DVec3::Z * z), HEIGHT, [columns, ROWS])
}

/// A fiber along X at a height.
fn fiber() -> Scene {
    let yarns = straight(&[[DVec3::new(-5.0, 0.0, 0.0), DVec3::new(5.0, 0.0, 0.0)]], RADIUS);
    scene(object(&yarns, &single_fiber(), lambert(0.5)), vec![], 1.0, camera(0.0, 1))
}

fn expose(steps: &[Scene], samples: u32) -> Result<Image, Error> {
    let size = [1, ROWS];
    let settings = Settings { size, samples, bounces: Some(1), filter_width: 0.0, ..Settings::default() };
    let reference = Reference::exposed(steps, &settings, &mut || ControlFlow::Continue(()))?;
    let mut film = reference.film();
    reference.render(&mut film, &mut |_| ControlFlow::Continue(()))?;
    Ok(film.image())
}

/// Height of a row's middle above the middle of the picture.
fn height(row: u32) -> f64 {
    HEIGHT * (0.5 - (f64::from(row) + 0.5) / f64::from(ROWS))
}

/// Share of the time in which a fiber that goes from −way/2 to way/2 covers a height.
fn share_of_time(height: f64, way: f64) -> f64 {
    let [from, to] = [height - RADIUS, height + RADIUS].map(|edge| (edge / way + 0.5).clamp(0.0, 1.0));
    to - from
}

/// Greatest distance of coverage from the profile.
fn off(image: &Image, way: f64) -> f64 {
    let rows = (0..ROWS).zip(&image.combined);
    rows.map(|(row, color)| (f64::from(color[3]) - share_of_time(height(row), way)).abs()).fold(0.0, f64::max)
}

#[test]
fn what_moves_covers_each_place_for_its_time() {
    const SAMPLES: u32 = 256;
    let way = 3.0 * RADIUS;
    let still = fiber();
    let at = |z: f64| {
        let mut scene = still.clone();
        scene.objects[0].world_from_object = DMat4::from_translation(DVec3::Z * z);
        scene
    };
    let shaped = |scene: &Scene, z: f64| {
        let mut scene = scene.clone();
        let yarns: &Yarns = &scene.objects[0].yarns;
        let points: Vec<[f32; 3]> = yarns.points().iter().map(|[x, y, _]| [*x, *y, z as f32]).collect();
        scene.objects[0].yarns = Arc::new(yarns.with_points(&points).expect("points"));
        scene
    };
    let seen_from = |scene: &Scene, z: f64| Scene { camera: camera(z, 1), ..scene.clone() };
    let drawn = |steps: &[Scene]| expose(steps, SAMPLES).expect("a picture");
    let (low, high) = (-0.5 * way, 0.5 * way);
    let of_object = drawn(&[at(low), at(high)]);
    let shapes = drawn(&[low, 0.0, high].map(|z| shaped(&still, z)));
    let of_camera = drawn(&[high, 0.0, low].map(|z| seen_from(&still, z)));
    for (name, image) in [("object", &of_object), ("shape", &shapes), ("camera", &of_camera)] {
        // Of 256 evenly spread times, two ends are off by one each at most.
        assert!(off(image, way) < 2.1 / f64::from(SAMPLES), "{name}: {}", off(image, way));
        assert!(off(image, 1.1 * way) > 0.02, "{name}: a shutter open a tenth longer is told apart");
        // Depth and id are those of the middle of the time.
        let covered = |row: u32| height(row).abs() < RADIUS;
        assert!((0..ROWS).all(|row| (image.object_id[row as usize] == 1) == covered(row)), "{name}");
    }
    assert!(off(&expose(&[still], 4).expect("a picture"), way) > 0.3);
}

#[test]
fn a_stopped_exposure_goes_on_to_the_same_bits() {
    let first = fiber();
    let mut later = first.clone();
    later.objects[0].world_from_object = DMat4::from_translation(DVec3::Z * RADIUS);
    let settings = Settings { size: [1, ROWS], samples: 5, ..Settings::default() };
    let ready =
        |steps: &[Scene]| Reference::exposed(steps, &settings, &mut || ControlFlow::Continue(())).expect("a scene");
    let reference = ready(&[first.clone(), later.clone()]);
    let mut expected = reference.film();
    reference.render(&mut expected, &mut |_| ControlFlow::Continue(())).expect("a picture");
    let mut film = reference.film();
    for _ in 0..3 {
        let mut asked = 0;
        let result = reference.render(&mut film, &mut |_| {
            asked += 1;
            if asked > 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(matches!(result, Err(Error::Cancelled)) || film.is_done());
    }
    ready(&[first.clone(), later]).render(&mut film, &mut |_| ControlFlow::Continue(())).expect("a picture");
    assert_eq!(film, expected);
    let result = ready(&[first.clone(), first]).render(&mut film, &mut |_| ControlFlow::Continue(()));
    assert!(matches!(result, Err(Error::Checkpoint(_))), "of another motion");
}

#[test]
fn steps_of_other_things_are_refused() {
    let none = Scene { objects: vec![], ..fiber() };
    let message = |steps: &[Scene]| expose(steps, 1).expect_err("a refusal").to_string();
    assert!(message(&[]).contains("none"));
    assert!(message(&[fiber(), none]).contains("time step 1: 0 objects"));
    assert!(message(&[fiber(), fiber()]).contains("object \"yarn\": its yarns have another rest shape"));
}

/// Half of the picture, z < 0, at distance 10 from the camera.
fn half() -> Mesh {
    let positions = vec![[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 0.0, -9.0], [-9.0, 0.0, -9.0]];
    Mesh {
        name: "half".into(),
        id: 2,
        labels: Default::default(),
        triangles: Arc::new(Triangles::new(positions, vec![[0, 1, 2], [0, 2, 3]], None).expect("a mesh")),
        base_color: Vec3::ONE,
        texture: None,
        kind: MeshKind::Shaded,
        world_from_object: DMat4::IDENTITY,
    }
}

/// A lens of radius R in focus at f draws a point at distance z as a disc of radius R |1 − z/f|. An edge covers the share of the disc that is beyond it:
/// ½ − (s √(1 − s²) + asin s) / π at s radii from it.
#[test]
fn an_edge_out_of_focus_has_the_profile_of_a_disc() {
    const COLUMNS: u32 = 64;
    const SAMPLES: u32 = 64;
    let blurred = |focus_distance: f64| {
        let aperture_radius = 3.0 * RADIUS;
        let lens = Some(Lens { aperture_radius, focus_distance, blades: 0, rotation_rad: 0.0, ratio: 1.0 });
        let camera = Camera { lens, ..camera(0.0, COLUMNS) };
        let scene = Scene { objects: vec![], meshes: vec![half()], camera, ..fiber() };
        let size = [COLUMNS, ROWS];
        let image = draw(&scene, &Settings { size, samples: SAMPLES, filter_width: 0.0, ..Settings::default() });
        let mean = |row: &[[f32; 4]]| row.iter().map(|c| f64::from(c[3])).sum::<f64>() / f64::from(COLUMNS);
        image.combined.chunks(COLUMNS as usize).map(mean).collect::<Vec<f64>>()
    };
    let off = |rows: &[f64], radius: f64| {
        let profile = |row: u32| {
            let s = (height(row) / radius).clamp(-1.0, 1.0);
            0.5 - (s * (1.0 - s * s).sqrt() + s.asin()) / PI
        };
        let count = f64::from(COLUMNS * SAMPLES);
        let z = |(row, found): (u32, &f64)| {
            let share = profile(row);
            (found - share).abs() / (share * (1.0 - share) / count).sqrt().max(1.0 / count)
        };
        (0..ROWS).zip(rows).map(z).fold(0.0, f64::max)
    };
    // |1 − 10/5| = 1 and |1 − 10/20| = ½.
    for (focus, radius) in [(5.0, 3.0 * RADIUS), (20.0, 1.5 * RADIUS)] {
        let rows = blurred(focus);
        // A hundred rows beyond 4.5 standard errors: a chance of 7e-4.
        assert!(off(&rows, radius) < 4.5, "focus at {focus}: {}", off(&rows, radius));
        assert!(off(&rows, 1.1 * radius) > 4.5, "a lens a tenth wider is told apart");
    }
    let sharp = blurred(10.0);
    assert!((0..ROWS).zip(&sharp).all(|(row, share)| *share == f64::from(u8::from(height(row) < 0.0))));
}
