//! Pearson's chi-square test of the directions that a sampler draws against the density that it states.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use rayon::prelude::*;

use super::super::{FiberScattering, Material};
use super::sphere::nodes;
use super::{Case, Random, cases, viewers};

const SAMPLES: u32 = 20_000;
const AZIMUTHS: usize = 12;
/// Cells expected to hold fewer are put together.
const LEAST_EXPECTED: f64 = 8.0;

/// Upper tail Q(a, x) of the regularised incomplete gamma function: the chi-square p-value is Q(degrees/2, statistic/2).
///
/// Its power series below a + 1, its continued fraction above.
fn gamma_tail(a: f64, x: f64) -> f64 {
    // ln Γ(a) by Stirling's series from a + 10 down.
    let shift: f64 = (0..10).map(|k| (a + f64::from(k)).ln()).sum();
    let z = a + 10.0;
    let ln_gamma =
        (z - 0.5) * z.ln() - z + 0.5 * (2.0 * PI).ln() + 1.0 / (12.0 * z) - 1.0 / (360.0 * z.powi(3)) - shift;
    let front = (a * x.ln() - x - ln_gamma).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for k in 1..2000 {
            term *= x / (a + f64::from(k));
            sum += term;
        }
        1.0 - front * sum
    } else {
        // 1/(x + 1 − a − 1(1 − a)/(x + 3 − a − …)), from the far end.
        let mut fraction = x;
        for k in (1..2000).rev() {
            let k = f64::from(k);
            fraction = x + 2.0 * k - 1.0 - a - k * (k - a) / fraction;
        }
        front / fraction
    }
}

/// Edges of cells in θ: even ones, and finer ones about the specular cone.
fn longitude_edges(case: &Case, theta_o: f64) -> Vec<f64> {
    let mut edges: Vec<f64> = (0..=8).map(|k| -FRAC_PI_2 + PI * f64::from(k) / 8.0).collect();
    for width in &case.widths {
        edges.extend([-3.0, -1.5, -0.7, 0.0, 0.7, 1.5, 3.0].map(|k| k * width - theta_o));
    }
    edges.retain(|edge| edge.abs() <= FRAC_PI_2);
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|a, b| *a - *b < 1e-9);
    edges
}

/// P-value of `count` samples of `fiber` for the density of the case.
fn p_value(case: &Case, fiber: &FiberScattering, wo: DVec3, count: u32, seed: u32) -> f64 {
    let theta_o = wo.z.atan2(wo.truncate().length());
    let edges = longitude_edges(case, theta_o);
    // Azimuths are from the normal, so that the Lambert term's horizon is an edge, in quarters of an arc that is finer straight through.
    let cell = |wi: DVec3| {
        let theta = wi.z.atan2(wi.truncate().length());
        let row = edges.partition_point(|edge| *edge <= theta).clamp(1, edges.len() - 1) - 1;
        let column = ((wi.y.atan2(wi.x) + PI) / (2.0 * PI) * AZIMUTHS as f64) as usize;
        row * AZIMUTHS + column.min(AZIMUTHS - 1)
    };
    let mut expected = vec![0.0; (edges.len() - 1) * AZIMUTHS];
    let azimuths = {
        let edges = (0..=AZIMUTHS).map(|k| -PI + 2.0 * PI * k as f64 / AZIMUTHS as f64);
        let straight = wo.y.atan2(wo.x) + PI;
        let fine = [-20.0, -7.0, -3.0, -1.0, 0.0, 1.0, 3.0, 7.0, 20.0]
            .map(|k| (straight + (k * case.gamma).clamp(-PI, PI) + PI).rem_euclid(2.0 * PI) - PI);
        nodes(edges.chain(fine).chain([(straight + 2.0 * PI).rem_euclid(2.0 * PI) - PI]).collect())
    };
    let mut cuts = edges.clone();
    for width in &case.widths {
        cuts.extend(
            [-8.0, -5.0, -2.0, -1.0, 1.0, 2.0, 5.0, 8.0].map(|k| (k * width - theta_o).clamp(-FRAC_PI_2, FRAC_PI_2)),
        );
    }
    for (theta, weight_theta) in nodes(cuts) {
        for (phi, weight_phi) in &azimuths {
            let wi = DVec3::new(theta.cos() * phi.cos(), theta.cos() * phi.sin(), theta.sin());
            expected[cell(wi)] += case.fiber.pdf(wo, wi) * weight_theta * weight_phi * theta.cos();
        }
    }
    let total: f64 = expected.iter().sum();
    assert!((total - 1.0).abs() < 1e-4, "{}, viewer {wo}: the density integrates to {total}", case.name);

    let mut random = Random::new(seed);
    let mut observed = vec![0.0; expected.len()];
    for _ in 0..count {
        let sample = fiber.sample(wo, random.triple()).expect("a fiber that scatters");
        observed[cell(sample.wi)] += 1.0;
    }
    let (mut statistic, mut cells) = (0.0, 0);
    let (mut rest_expected, mut rest_observed) = (0.0, 0.0);
    let mut add = |e: f64, o: f64| {
        statistic += (o - e) * (o - e) / e;
        cells += 1;
    };
    for (e, o) in expected.iter().map(|e| e * f64::from(count)).zip(&observed) {
        if e >= LEAST_EXPECTED {
            add(e, *o);
        } else {
            rest_expected += e;
            rest_observed += o;
        }
    }
    if rest_expected > 0.0 || rest_observed > 0.0 {
        add(rest_expected.max(1e-3), rest_observed);
    }
    gamma_tail(0.5 * f64::from(cells - 1), 0.5 * statistic)
}

/// 1 % over all tests (Bonferroni).
fn significance(tests: usize) -> f64 {
    0.01 / tests as f64
}

#[test]
fn every_sampler_draws_from_its_density() {
    let cases = cases();
    let threshold = significance(cases.len() * viewers().len());
    cases.par_iter().enumerate().for_each(|(k, case)| {
        for (j, wo) in viewers().into_iter().enumerate() {
            let p = p_value(case, &case.fiber, wo, SAMPLES, (k * 100 + j) as u32);
            assert!(p > threshold, "{}, viewer {wo}: p = {p:e}", case.name);
        }
    });
}

#[test]
fn a_wrong_sampler_is_rejected() {
    let cases = cases();
    let threshold = significance(cases.len() * viewers().len());
    let silk = Material::preset("silk-1").expect("preset");
    let case = |material| super::material_cases("silk-1", material);
    // Samples of a lobe 5 % wider, one turned about less, and another share of the Lambert term.
    let wrong = [
        (0, Material { specular_beta_rad: 1.05 * silk.specular_beta_rad, ..silk }),
        (1, Material { beta_tt_rad: 1.05 * silk.beta_tt_rad, ..silk }),
        (1, Material { gamma_tt_rad: 1.1 * silk.gamma_tt_rad, ..silk }),
        (1, Material { diffuse_weight: 0.55, ..silk }),
    ];
    for (model, material) in wrong {
        let (stated, drawn) = (&case(silk)[model], &case(material)[model]);
        let p = p_value(stated, &drawn.fiber, viewers()[1], 10 * SAMPLES, 5);
        assert!(p < threshold, "{material:?}: p = {p}");
        assert!(p_value(stated, &stated.fiber, viewers()[1], 10 * SAMPLES, 5) > threshold);
    }
}

#[test]
fn the_p_value_has_its_closed_forms() {
    // Two degrees of freedom: e^{−x/2}. Four: (1 + x/2) e^{−x/2}.
    for half in [0.3_f64, 1.0, 4.0, 20.0] {
        assert!((gamma_tail(1.0, half) / (-half).exp() - 1.0).abs() < 1e-7, "{half}");
        assert!((gamma_tail(2.0, half) / ((1.0 + half) * (-half).exp()) - 1.0).abs() < 1e-7, "{half}");
    }
}
