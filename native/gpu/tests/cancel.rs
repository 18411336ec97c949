//! Pictures that are stopped: whoever waits is let go, the adapter gets no more work, and the next picture is right.

mod support;

use std::ops::ControlFlow;
use std::thread::sleep;
use std::time::Duration;

use glam::DVec3;
use lisle_gpu::{Error, Progress, Scene, Settings};
use support::{
    another_renderer, curves, draw, exact, looking, measure, object, perspective, preset, scene, sun, yarns_of,
};

const SIZE: [u32; 2] = [96, 64];

fn thread() -> (Scene, Settings) {
    let camera = perspective(looking(DVec3::new(0.3, -3.0, 0.4), DVec3::ZERO), 0.25, SIZE, [0.0, 0.0]);
    let mut scene =
        scene(vec![object(&yarns_of(curves::wave(2.0, 0.25, 60), false, 0.15), &preset("cotton-1"))], camera);
    scene.lights = vec![sun([1.0, 1.0, -1.0], 2.0)];
    (scene, Settings { samples: 2, lod_pixels: 1.0, filter_width: 1.5, shadow_resolution: 256, ..exact(SIZE) })
}

/// A picture that would take for ever.
fn endless(settings: &Settings) -> Settings {
    Settings { samples: 1_000_000, ..settings.clone() }
}

#[test]
fn a_stopped_picture_hands_in_no_more_work() {
    let (scene, settings) = thread();
    let expected = draw(&scene, &settings);
    let renderer = another_renderer();
    for stop in [0, 1, 2, 3, 5, 8, 13, 21, 34] {
        let (mut asked, mut handed_in) = (0, vec![]);
        let stopped = renderer.render(&scene, &endless(&settings), &mut |_| {
            handed_in.push(renderer.submissions());
            asked += 1;
            if asked > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let left = renderer.submissions();
        assert!(matches!(stopped, Err(Error::Cancelled)));
        assert_eq!(asked, stop + 1, "it asked on after the answer");
        sleep(Duration::from_millis(100));
        // One may be on its way.
        let later = renderer.submissions();
        assert!(later <= left + 1, "{} submissions after the end", later - left);
        assert!(stop < 34 || handed_in[34] > handed_in[0] + 2, "a count that never rises: {handed_in:?}");
        let next = renderer.render(&scene, &settings, &mut |_| ControlFlow::Continue(())).expect("a picture");
        assert_eq!(measure::difference(&next, &expected), None, "after a stop at {stop}");
    }
}

#[test]
fn a_picture_that_waits_for_another_can_be_stopped() {
    let (scene, settings) = thread();
    let renderer = another_renderer();
    std::thread::scope(|scope| {
        let (tell, told) = std::sync::mpsc::channel();
        let (stop, stopped) = std::sync::mpsc::channel::<()>();
        let (renderer, scene, settings) = (&renderer, &scene, &settings);
        let first = scope.spawn(move || {
            renderer.render(scene, &endless(settings), &mut |progress| {
                if matches!(progress, Progress::Samples { .. }) {
                    let _ = tell.send(());
                }
                if stopped.try_recv().is_ok() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
        });
        told.recv().expect("the first one draws");
        let mut last = None;
        let second = renderer.render(scene, settings, &mut |progress| {
            last = Some(progress);
            ControlFlow::Break(())
        });
        assert!(matches!(second, Err(Error::Cancelled)));
        assert_eq!(last, Some(Progress::Preparing));
        stop.send(()).expect("the first one still draws");
        assert!(matches!(first.join().expect("no panic"), Err(Error::Cancelled)));
    });
}

#[test]
fn a_renderer_can_go_while_it_draws_what_was_stopped() {
    let (scene, settings) = thread();
    for _ in 0..3 {
        let renderer = another_renderer();
        let stopped = renderer.render(&scene, &endless(&settings), &mut |_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(Error::Cancelled)));
    }
}
