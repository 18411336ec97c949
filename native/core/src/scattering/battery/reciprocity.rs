use glam::DVec3;

use super::super::{FiberScattering, Material};
use super::{Case, Random};

/// Largest |S(ω_o, ω_i) − S(ω_i, ω_o)| relative to the largest S, of f = S cos θ_i.
fn asymmetry(fiber: &FiberScattering) -> f64 {
    let mut random = Random::new(7);
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for _ in 0..20_000 {
        let (a, b) = (random.direction(), random.direction());
        let s = |wo: DVec3, wi: DVec3| fiber.evaluate(wo, wi) / wi.truncate().length();
        worst = worst.max((s(a, b) - s(b, a)).abs().max_element());
        largest = largest.max(s(a, b).max_element());
    }
    worst / largest
}

/// The fiber's own part: the Lambert term has the surface's reciprocity, not the fiber's.
fn without_lambert(material: Material) -> Material {
    Material { diffuse: DVec3::ZERO, ..material }
}

#[test]
fn the_simple_highlight_is_reciprocal() {
    for (name, material) in super::extremes() {
        let fiber = FiberScattering::simple(without_lambert(material));
        assert!(asymmetry(&fiber) < 1e-12, "{name}");
    }
}

#[test]
fn the_thread_model_is_reciprocal() {
    for (name, thread) in super::threads() {
        let asymmetry = asymmetry(&FiberScattering::thread(thread));
        assert!(asymmetry < 1e-9, "{name}: {asymmetry}");
    }
}

#[test]
fn the_lambert_term_is_reciprocal_at_the_surface() {
    let material = Material { specular: DVec3::ZERO, ..Material::preset("silk").expect("preset") };
    let fiber = FiberScattering::simple(material);
    let mut random = Random::new(8);
    for _ in 0..1000 {
        let [a, b] = [random.direction(), random.direction()].map(|d| DVec3::new(d.x.abs(), d.y, d.z));
        let error = fiber.evaluate(a, b) * a.x - fiber.evaluate(b, a) * b.x;
        assert!(error.abs().max_element() < 1e-12);
    }
}

#[test]
fn the_physical_model_is_not_reciprocal_since_it_is_normalised_by_the_light_alone() {
    let material = Material { diffuse_weight: 0.0, ..Material::preset("cotton").expect("preset") };
    assert!(asymmetry(&FiberScattering::physical(material)) > 0.1);
    // What reciprocity would bring: under uniform light a white fiber would not be seen. It is seen at a slant, though its albedo is 1.
    let white = Material { color_r: DVec3::ONE, color_tt: DVec3::ONE, beta_r_rad: 0.2, ..material };
    let fiber = FiberScattering::physical(white);
    let (across, slanted) = (super::direction(0.0, 0.0), super::direction(80.0, 0.0));
    assert!((fiber.albedo(slanted) - 1.0).abs().max_element() < 1e-12);
    println!("white, β 0.2: {:.4} across, {:.4} at 80°", fiber.ambient(across).x, fiber.ambient(slanted).x);
    assert!((1.03..1.05).contains(&fiber.ambient(across).x));
    assert!(fiber.ambient(slanted).x < 0.5);
}

#[test]
fn a_white_lambert_fiber_disappears_in_a_furnace_at_every_angle() {
    let material = Material { specular: DVec3::ZERO, diffuse: DVec3::ONE, ..Material::preset("silk").expect("preset") };
    let fiber = FiberScattering::simple(material);
    let case = Case { name: "white".into(), fiber, widths: vec![0.3], gamma: 1.0 };
    for wo in super::viewers() {
        let seen = case.integrate(wo, |wi| case.fiber.evaluate(wo, wi));
        assert!((seen - 1.0).abs().max_element() < 1e-9, "{seen}");
    }
}
