//! The same bits whatever the number of threads, after stops, and from checkpoints.

mod support;

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::DVec3;
use lisle_core::scattering::Material;
use lisle_core::scene::{Light, Scene};
use lisle_core::yarn::Yarn;
use lisle_core::{Curves, Yarns};
use lisle_reference::fibers::{Options, fibers};
use lisle_reference::{Error, Film, Image, Reference, Settings};
use support::{looking, object, orthographic, prepare, scene, sun};

const SIZE: [u32; 2] = [40, 30];

fn settings() -> Settings {
    Settings { size: SIZE, samples: 6, seed: 3, ..Settings::default() }
}

fn cloth() -> Scene {
    let rows = (0..4)
        .map(|row| (0..30).map(|i| [0.1 * i as f32 - 1.5, 0.1 * (i as f32).sin(), 0.2 * row as f32 - 0.3]).collect());
    let yarns = Arc::new(Yarns::new(Curves::catmull_rom(rows.collect(), false), Some(0.1)).expect("valid curves"));
    let camera = orthographic(looking(DVec3::new(0.2, -10.0, 1.0), DVec3::ZERO), 1.0, SIZE);
    let soft = Light::Sun { direction: DVec3::X, irradiance: glam::Vec3::ONE, angle_rad: 0.3 };
    let cotton = Material::preset("cotton-2").expect("preset");
    let yarn = Yarn::preset("silk-1").expect("preset");
    scene(object(&yarns, &yarn, cotton), vec![sun(DVec3::new(0.3, 1.0, -1.0), 3.0), soft], 0.3, camera)
}

/// Draws until the film has at least that many samples.
fn draw_until(reference: &Reference, film: &mut Film, share: f64) -> Result<(), Error> {
    reference.render(film, &mut |film| {
        if film.fraction() >= share { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}

fn whole(reference: &Reference) -> Film {
    let mut film = reference.film();
    reference.render(&mut film, &mut |_| ControlFlow::Continue(())).expect("a picture");
    film
}

fn on_threads(count: usize, seed: u32) -> Image {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
    pool.install(|| {
        let settings = Settings { seed, ..settings() };
        whole(&prepare(&cloth(), &settings)).image()
    })
}

#[test]
fn the_picture_depends_on_the_seed_and_not_on_the_threads() {
    let one = on_threads(1, 3);
    assert!(one.combined.iter().any(|c| c[3] > 0.9), "something is drawn");
    assert_eq!(one, on_threads(3, 3));
    assert_ne!(one.combined, on_threads(1, 4).combined);
}

#[test]
fn a_region_is_cut_from_the_whole() {
    let scene = cloth();
    let all = whole(&prepare(&scene, &settings())).image();
    let region = Some([7, 4, 20, 10]);
    let part = whole(&prepare(&scene, &Settings { region, ..settings() })).image();
    assert_eq!(part.size, [20, 10]);
    for y in 0..10 {
        for x in 0..20 {
            let (in_all, in_part) = ((y + 4) * SIZE[0] as usize + x + 7, y * 20 + x);
            assert_eq!(all.combined[in_all], part.combined[in_part]);
            assert_eq!(all.depth[in_all], part.depth[in_part]);
        }
    }
}

#[test]
fn stopping_and_going_on_changes_no_bit() {
    let scene = cloth();
    let reference = prepare(&scene, &settings());
    let expected = whole(&reference);
    let mut film = reference.film();
    for share in [0.05, 0.4, 0.41, 0.7] {
        assert!(matches!(draw_until(&reference, &mut film, share), Err(Error::Cancelled)));
        assert!(film.fraction() >= share && !film.is_done());
        // Another process goes on with it.
        film = Film::from_bytes(&film.to_bytes()).expect("a checkpoint");
    }
    let again = prepare(&scene, &settings());
    again.render(&mut film, &mut |_| ControlFlow::Continue(())).expect("a picture");
    assert_eq!(film, expected);
}

/// Whoever wants to stop is asked again before there are many more points, in long curves as in many short ones.
#[test]
fn fibers_are_made_a_few_at_a_time() {
    let waves = |curves: u32, knots: u32| {
        let knot = |row: u32, i: u32| [0.1 * i as f32, 0.1 * (i as f32).sin(), row as f32];
        let rows = (0..curves).map(|row| (0..knots).map(|i| knot(row, i)).collect());
        Yarns::new(Curves::catmull_rom(rows.collect(), false), Some(0.1)).expect("valid curves")
    };
    let yarn = Yarn { fibers_per_ply: 4, ..Yarn::preset("silk-1").expect("preset") };
    for (curves, knots) in [(1, 20_001), (100, 201)] {
        let (yarns, mut asked, mut last) = (waves(curves, knots), 0, 0.0);
        let mut count = |done| {
            assert!(done > last && done <= 1.0, "{done} after {last}");
            (asked, last) = (asked + 1, done);
            ControlFlow::Continue(())
        };
        fibers(yarns.strands(), &yarn, &Options::default(), &mut count).expect("fibers");
        let segments = curves * (knots - 1) * yarn.plies * yarn.fibers_per_ply;
        assert!(asked >= segments / 5000, "{asked} times for {segments} segments in {curves} curves");
        assert_eq!(last, 1.0);
    }
}

#[test]
fn a_finished_picture_takes_more_samples() {
    let scene = cloth();
    let few = prepare(&scene, &Settings { samples: 2, ..settings() });
    let all = prepare(&scene, &settings());
    let mut film = whole(&few);
    all.render(&mut film, &mut |_| ControlFlow::Continue(())).expect("a picture");
    assert_eq!(film, whole(&all));
    assert!(matches!(few.render(&mut film, &mut |_| ControlFlow::Continue(())), Err(Error::Checkpoint(_))));
}

#[test]
fn a_checkpoint_of_another_picture_is_refused() {
    let scene = cloth();
    let film = prepare(&scene, &settings()).film();
    let mut darker = cloth();
    darker.ambient *= 0.5;
    for (scene, settings) in [
        (&darker, settings()),
        (&scene, Settings { seed: 4, ..settings() }),
        (&scene, Settings { bounces: Some(2), ..settings() }),
        (&scene, Settings { chord_error: 0.2, ..settings() }),
    ] {
        let other = prepare(scene, &settings);
        let result = other.render(&mut film.clone(), &mut |_| ControlFlow::Continue(()));
        assert!(matches!(result, Err(Error::Checkpoint(_))));
    }
    let bytes = film.to_bytes();
    for wrong in [&bytes[..bytes.len() - 1], &bytes[..20], &[], &b"PNG"[..]] {
        assert!(matches!(Film::from_bytes(wrong), Err(Error::Checkpoint(_))));
    }
}
