use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::super::FiberScattering;
use super::sphere::nodes_of_order;
use super::{Case, cases, viewers};

/// Mean of f over the width of a fiber about z as the viewer sees it: f in the axes of each visible point.
fn over_width(fiber: &FiberScattering, wo: DVec3, wi: DVec3) -> DVec3 {
    let (across_o, across_i) = (wo.truncate().normalize(), wi.truncate().normalize());
    // A point whose normal is at angle a from the viewer's azimuth is at sin a of the half width. It is lit up to 90° from the light's.
    let from_viewer = across_o.angle_to(across_i);
    let cuts = [-FRAC_PI_2, FRAC_PI_2].map(|edge| (from_viewer + edge).clamp(-FRAC_PI_2, FRAC_PI_2));
    let points = nodes_of_order::<4>([-FRAC_PI_2, FRAC_PI_2, cuts[0], cuts[1]].into());
    let at = |angle: f64| {
        let normal = across_o.rotate(DVec2::from_angle(angle));
        let axes = |d: DVec3| DVec2::new(d.truncate().dot(normal), normal.perp_dot(d.truncate())).extend(d.z);
        fiber.evaluate(axes(wo), axes(wi))
    };
    points.iter().map(|(angle, weight)| at(*angle) * (0.5 * angle.cos() * weight)).sum()
}

/// Light that leaves a fiber, over what its width takes from a direction, by definition: viewers over all directions, points over the width.
fn furnace(case: &Case, wi: DVec3) -> DVec3 {
    let cos = |d: DVec3| d.truncate().length();
    case.integrate(wi, |wo| over_width(&case.fiber, wo, wi) * (cos(wo) / cos(wi)))
}

#[test]
fn a_fiber_gives_back_its_albedo_and_no_more_than_came_in() {
    cases().par_iter().for_each(|case| {
        // Across, oblique, and grazing along the fiber.
        for wi in [viewers()[0], viewers()[2], viewers()[4]] {
            let (exact, claimed) = (furnace(case, wi), case.fiber.albedo(wi));
            let error = (exact - claimed).abs().max_element();
            assert!(error < 1e-3, "{}, light {wi}: {exact}, claimed {claimed}", case.name);
            assert!(exact.max_element() <= 1.0 + 1e-3, "{}, light {wi}: {exact}", case.name);
        }
    });
}

#[test]
fn the_furnace_rejects_another_albedo() {
    let cases = cases();
    let case = |name: &str| cases.iter().find(|case| case.name == name).expect(name);
    let wi = viewers()[2];
    for (a, b) in [("simple silk", "simple silk-2"), ("physical cotton", "physical cotton-2")] {
        assert!((furnace(case(a), wi) - case(b).fiber.albedo(wi)).abs().max_element() > 0.02, "{a}, {b}");
    }
}

#[test]
fn ambient_is_the_integral_over_all_light() {
    cases().par_iter().for_each(|case| {
        for wo in viewers() {
            let exact = case.integrate(wo, |wi| case.fiber.evaluate(wo, wi));
            let error = (exact - case.fiber.ambient(wo)).abs().max_element();
            assert!(error < 1e-3, "{}, viewer {wo}: {exact}, claimed {}", case.name, case.fiber.ambient(wo));
        }
    });
}
