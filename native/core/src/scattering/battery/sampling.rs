use glam::DVec3;
use rayon::prelude::*;

use super::super::FiberScattering;
use super::{Case, Random, cases, viewers};

const SAMPLES: u32 = 20_000;

/// Distance of the mean weight from `expected` in standard errors, the greatest of the channels; and the largest weight.
fn deviation(fiber: &FiberScattering, wo: DVec3, expected: DVec3, seed: u32) -> (f64, f64) {
    let mut random = Random::new(seed);
    let (mut sum, mut squares, mut largest) = (DVec3::ZERO, DVec3::ZERO, 0.0_f64);
    for _ in 0..SAMPLES {
        let weight = fiber.sample(wo, random.triple()).map_or(DVec3::ZERO, |sample| {
            assert!(sample.wi.is_normalized() && sample.weight.is_finite() && sample.weight.min_element() >= 0.0);
            assert!((fiber.pdf(wo, sample.wi) / sample.pdf - 1.0).abs() < 1e-12);
            sample.weight
        });
        sum += weight;
        squares += weight * weight;
        largest = largest.max(weight.max_element());
    }
    let n = f64::from(SAMPLES);
    let mean = sum / n;
    let variance = (squares / n - mean * mean).max(DVec3::splat(1e-12));
    (((mean - expected) / (variance / n).map(f64::sqrt)).abs().max_element(), largest)
}

/// Two-sided 1 % over three channels of all tests (about 600): 4.5 standard errors.
const LIMIT: f64 = 4.5;

fn uniform(case: &Case, wo: DVec3) -> DVec3 {
    case.integrate(wo, |wi| case.fiber.evaluate(wo, wi))
}

#[test]
fn the_mean_weight_is_the_integral_over_all_light_and_weights_are_bounded() {
    let cases = cases();
    let worst = cases.par_iter().map(|case| {
        let mut bound = 0.0_f64;
        for (seed, wo) in viewers().into_iter().enumerate() {
            let (distance, largest) = deviation(&case.fiber, wo, uniform(case, wo), seed as u32);
            assert!(distance < LIMIT, "{}, viewer {wo}: {distance} standard errors", case.name);
            bound = bound.max(largest);
        }
        (bound, case.name.clone())
    });
    let worst: Vec<_> = worst.collect();
    for (bound, name) in &worst {
        println!("{name}: weights up to {bound:.2}");
    }
    assert!(worst.iter().all(|(bound, _)| *bound < 8.0));
}

#[test]
fn the_test_rejects_an_integral_of_another_material() {
    let cases = cases();
    let case = |name: &str| cases.iter().find(|case| case.name == name).expect(name);
    let wo = viewers()[1];
    for (a, b) in [("simple rayon-1", "simple rayon-2"), ("physical rayon-1", "physical rayon-2")] {
        let (distance, _) = deviation(&case(a).fiber, wo, uniform(case(b), wo), 1);
        assert!(distance > LIMIT, "{a}, {b}: {distance}");
    }
}
