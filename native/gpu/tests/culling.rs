//! What is not in view is not counted, and so not drawn.

mod support;

use glam::DVec3;
use support::{curves, draw, exact, looking, object, orthographic, preset, scene, yarns_of};

const SIZE: [u32; 2] = [96, 64];

/// Segments of which fibers are drawn, of a straight yarn along X from −20 to 20 that a camera over (x, 0, 0) sees: its picture is 12 wide.
fn drawn(x: f64) -> f64 {
    let yarns = yarns_of(curves::straight(40.0, 401), false, 0.15);
    let yarn = preset("cotton-1");
    let eye = DVec3::new(x, -5.0, 0.0);
    let camera = orthographic(looking(eye, eye + DVec3::Y), 8.0, SIZE, [0.0, 0.0]);
    let statistics = draw(&scene(vec![object(&yarns, &yarn)], camera), &exact(SIZE)).statistics;
    assert_eq!(statistics.segments, 400);
    statistics.fiber_segments as f64 / f64::from(yarn.plies * yarn.fibers_per_ply)
}

#[test]
fn segments_out_of_view_are_not_drawn() {
    // Ten segments a unit of length. Those at the border whose hairs may reach into the picture count as well: 0.4 on either side.
    let (middle, end, aside) = (drawn(0.0), drawn(20.0), drawn(60.0));
    println!("{middle}, {end} at its end, {aside} beside it");
    assert!((120.0..=128.0).contains(&middle), "{middle}");
    assert!((60.0..=64.0).contains(&end), "{end}");
    assert_eq!(aside, 0.0);
}
