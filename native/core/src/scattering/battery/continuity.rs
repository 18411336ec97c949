use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use super::{Random, cases};

/// Largest step of a function of the angle along a great circle, in `steps` steps, and where.
fn largest_step(steps: u32, a: DVec3, b: DVec3, f: impl Fn(DVec3) -> DVec3) -> f64 {
    let at = |k: u32| {
        let angle = TAU * f64::from(k) / f64::from(steps);
        f(a * angle.cos() + b * angle.sin())
    };
    let mut before = at(0);
    let mut largest = 0.0_f64;
    for k in 1..=steps {
        let now = at(k);
        assert!(now.is_finite());
        largest = largest.max((now - before).abs().max_element());
        before = now;
    }
    largest
}

/// Steps a quarter as wide change a continuous function about a quarter as much; a jump stays.
fn is_continuous(steps: u32, a: DVec3, b: DVec3, f: impl Fn(DVec3) -> DVec3) -> bool {
    let (coarse, fine) = (largest_step(steps, a, b, &f), largest_step(4 * steps, a, b, &f));
    fine < 0.6 * coarse || coarse < 1e-9
}

#[test]
fn every_model_is_continuous_in_both_directions() {
    cases().par_iter().for_each(|case| {
        let mut random = Random::new(11);
        let narrow = case.widths.iter().fold(case.gamma, |a, b| a.min(*b));
        let steps = (16.0 / narrow).clamp(500.0, 16_000.0) as u32;
        for _ in 0..2 {
            let (given, a) = (random.direction(), random.direction());
            let b = a.cross(random.direction()).normalize();
            let fiber = &case.fiber;
            assert!(is_continuous(steps, a, b, |wi| fiber.evaluate(given, wi)), "{}, light along {a} {b}", case.name);
            assert!(is_continuous(steps, a, b, |wo| fiber.evaluate(wo, given)), "{}, viewer along {a} {b}", case.name);
        }
    });
}

#[test]
fn a_jump_is_noticed() {
    let cases = cases();
    let fiber = &cases[0].fiber;
    let given = super::direction(20.0, 10.0);
    let cut = |wi: DVec3| if wi.x > 0.1 { fiber.evaluate(given, wi) } else { DVec3::ZERO };
    assert!(!is_continuous(2000, DVec3::X, DVec3::Y, cut));
}
