//! Fibers are smooth curves at every zoom: what is drawn departs from the exact curve by at most a quarter of a pixel.
//!
//! A pixel that is covered on the GPU and not by the twin's exact tubes, or the other way round, lies as far from their common silhouette
//! as the drawn line from the curve, at least. The pictures show few fibers, so that many pixels lie near a silhouette.

mod support;

use std::f64::consts::TAU;

use glam::DVec3;
use lisle_core::yarn::Yarn;
use lisle_gpu::{Camera, Object};
use support::twin::{self, Pixel};
use support::{curves, draw, exact, looking, object, perspective, picture, preset, scene, without_flyaways, yarns_of};

const SIZE: [u32; 2] = [200, 150];

/// Chord error bound of the issue, and what f32 and packed knots add, pixels.
const BOUND: f64 = 0.25;
const ROUNDING: f64 = 0.02;
/// What loops and hairs keep to instead, in yarn radii: all fibers of a chunk take as many steps as a typical hair needs, and a hair
/// ends with its last whole step.
const FLYAWAY_BOUND: f64 = 0.04;

/// Largest and 90 % quantile of the distances from the silhouette at which GPU and twin disagree; number of such pixels.
fn departures(alpha: &[bool], twin: &[Pixel]) -> (f64, f64, usize) {
    let mut found: Vec<f64> = alpha
        .iter()
        .zip(twin)
        .filter(|(alpha, pixel)| **alpha != pixel.hit.is_some())
        .map(|(_, pixel)| pixel.signed_distance.abs())
        .collect();
    found.sort_by(f64::total_cmp);
    let quantile =
        |q: f64| found.get(((found.len() as f64 * q) as usize).min(found.len().max(1) - 1)).copied().unwrap_or(0.0);
    (quantile(1.0), quantile(0.9), found.len())
}

/// Few fibers, thick enough to be seen from afar.
fn few(yarn: Yarn, plies: u32, fibers: u32) -> Yarn {
    Yarn { plies, fibers_per_ply: fibers, fiber_radius: 2.5 * yarn.fiber_radius, ..yarn }
}

struct Case {
    name: &'static str,
    object: Object,
    /// Chords of the twin per segment at the nearest zoom.
    steps: u32,
}

fn cases() -> Vec<Case> {
    // Knots as far apart as in knitted cloth: about a yarn radius; and a curve of few knots, each segment with many turns.
    let knitted = yarns_of(curves::wave(14.0, 0.9, 140), false, 0.12);
    let sparse = yarns_of(curves::wave(14.0, 0.9, 15), false, 0.12);
    let straight = yarns_of(curves::straight(14.0, 105), false, 0.12);
    let bare = |name| without_flyaways(preset(name));
    let case = |name, object, steps| Case { name, object, steps };
    vec![
        case("one fiber a ply, cotton-1", object(&knitted, &few(bare("cotton-1"), 3, 1)), 128),
        case("few fibers, rayon-4", object(&knitted, &few(bare("rayon-4"), 2, 4)), 128),
        case("one ply, fibers twisted against the ply, rayon-1", object(&straight, &few(bare("rayon-1"), 1, 3)), 128),
        case("few knots, silk-1", object(&sparse, &few(bare("silk-1"), 3, 1)), 1024),
        case("loops and hairs, rayon-3", object(&knitted, &few(preset("rayon-3"), 2, 3)), 128),
    ]
}

/// Zooms: the yarn's radius in pixels.
const ZOOMS: [f64; 6] = [2.0, 4.0, 16.0, 64.0, 300.0, 1500.0];

/// A view of the middle fiber such that the yarn's radius has a size in pixels.
fn camera(radius_pixels: f64, target: DVec3) -> Camera {
    let distance = 3.0;
    let tangent = 0.5 * f64::from(SIZE[1]) * 0.12 / (radius_pixels * distance);
    perspective(looking(target + DVec3::new(0.4, -distance, 0.5), target), tangent, SIZE, [0.0, 0.0])
}

/// A point of the first fiber near the middle of the curve: the extreme close-ups look at it.
fn target(object: &Object) -> DVec3 {
    twin::fiber_position(object, object.yarns.strands().positions().len() / 2, 0.3)
}

#[test]
fn lines_depart_from_their_curve_by_at_most_a_quarter_of_a_pixel() {
    let mut failures = Vec::new();
    for case in cases() {
        for zoom in ZOOMS {
            let camera = camera(zoom, target(&case.object));
            let image = draw(&scene(vec![case.object.clone()], camera), &exact(SIZE));
            let twin = twin::picture(std::slice::from_ref(&case.object), &camera, SIZE, case.steps);
            let alpha: Vec<bool> = image.combined.iter().map(|c| c[3] > 0.5).collect();
            let (worst, most, count) = departures(&alpha, &twin);
            let covered = twin.iter().filter(|p| p.hit.is_some()).count();
            println!(
                "{}, radius {zoom} px: {covered} covered, {count} differ, by up to {worst:.3} px, 90 % within {most:.3}",
                case.name
            );
            picture::show(&format!("smooth {} {zoom}", case.name), &image);
            assert!(covered > 20, "{}, radius {zoom} px: nothing to compare", case.name);
            let flies = case.object.yarn.flyaway_fibers() > 0;
            let bound = if flies { BOUND.max(FLYAWAY_BOUND * zoom) } else { BOUND };
            if worst > bound + ROUNDING {
                failures.push(format!("{}, radius {zoom} px: {worst:.3} px", case.name));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn coarse_lines_are_rejected_by_the_same_check() {
    let case = &cases()[0];
    for zoom in [16.0, 64.0, 300.0] {
        let camera = camera(zoom, target(&case.object));
        let exact = twin::picture(std::slice::from_ref(&case.object), &camera, SIZE, case.steps);
        // As many lines as keep within a pixel rather than a quarter: half as many as it takes.
        let turning = TAU * 14.0 / 139.0 / 0.12 * 0.045 / 0.369;
        let steps = (0.5 * (zoom * turning * turning / (8.0 * BOUND)).sqrt()).ceil().max(1.0) as u32;
        let coarse = twin::picture(std::slice::from_ref(&case.object), &camera, SIZE, (steps / 2).max(1));
        let alpha: Vec<bool> = coarse.iter().map(|p| p.hit.is_some()).collect();
        let (worst, _, count) = departures(&alpha, &exact);
        println!("radius {zoom} px, {steps} lines: {count} differ, by up to {worst:.3} px");
        assert!(worst > BOUND + ROUNDING, "radius {zoom} px passes with {steps} lines");
    }
}
