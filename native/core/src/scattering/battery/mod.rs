//! One battery of tests over every model and parameter set. Each comparator is also given something wrong, and has to reject it.

mod chi_square;
mod continuity;
mod energy;
mod reciprocity;
mod sampling;
mod sphere;

use glam::DVec3;

use super::{FiberScattering, MATERIAL_NAMES, Material, Thread, fabric_threads};
use crate::sampling::{hash_combine, unit_from_hash};

/// A model with parameters, and what the tests need to know of it.
struct Case {
    name: String,
    fiber: FiberScattering,
    /// Widths of its lobes in θ, radians.
    widths: Vec<f64>,
    /// Width of transmission in φ, radians.
    gamma: f64,
}

fn material_cases(name: &str, material: Material) -> [Case; 2] {
    material.validate().expect(name);
    [
        Case {
            name: format!("simple {name}"),
            fiber: FiberScattering::simple(material),
            widths: vec![2.0 * material.specular_beta_rad],
            gamma: 1.0,
        },
        Case {
            name: format!("physical {name}"),
            fiber: FiberScattering::physical(material),
            widths: vec![material.beta_r_rad, material.beta_tt_rad],
            gamma: material.gamma_tt_rad,
        },
    ]
}

/// Materials at the ends of what [`Material::validate`] lets through, and without the Lambert term.
fn extremes() -> Vec<(&'static str, Material)> {
    let silk = Material::preset("silk").expect("preset");
    vec![
        (
            "narrow",
            Material {
                beta_r_rad: 0.001,
                beta_tt_rad: 0.002,
                gamma_tt_rad: 0.002,
                specular_beta_rad: 0.001,
                diffuse_weight: 0.1,
                ..silk
            },
        ),
        ("wide", Material { beta_r_rad: 1.57, beta_tt_rad: 1.2, gamma_tt_rad: 1.57, specular_beta_rad: 1.57, ..silk }),
        (
            "white",
            Material {
                color_r: DVec3::ONE,
                specular: DVec3::ONE,
                diffuse: DVec3::ZERO,
                diffuse_weight: 0.0,
                beta_r_rad: 0.1,
                ..silk
            },
        ),
        (
            "dark",
            Material {
                color_r: DVec3::ZERO,
                color_tt: DVec3::ZERO,
                specular: DVec3::X * 0.1,
                diffuse: DVec3::ZERO,
                diffuse_weight: 0.0,
                beta_r_rad: 0.2,
                ..silk
            },
        ),
    ]
}

fn cases() -> Vec<Case> {
    let presets = MATERIAL_NAMES.iter().map(|name| (*name, Material::preset(name).expect("preset")));
    let materials = presets.chain(extremes()).flat_map(|(name, material)| material_cases(name, material));
    materials.chain(threads().into_iter().map(|(name, thread)| thread_case(&name, thread))).collect()
}

fn thread_case(name: &str, thread: Thread) -> Case {
    thread.validate().expect(name);
    Case {
        name: format!("thread {name}"),
        fiber: FiberScattering::thread(thread),
        widths: vec![2.0 * thread.surface_width_rad, 2.0 * thread.volume_width_rad],
        gamma: 1.0,
    }
}

/// The fitted threads, and some at the ends of what [`Thread::validate`] lets through.
fn threads() -> Vec<(String, Thread)> {
    let mut threads = fabric_threads();
    let linen = threads[0].1;
    let narrow = Thread { surface_width_rad: 0.002, volume_width_rad: 0.004, isotropic: 0.0, ..linen };
    let white = Thread { color: DVec3::ONE, surface_width_rad: 0.1, ..linen };
    let metal = Thread { refraction: 4.0, color: DVec3::ZERO, ..linen };
    let faint = Thread { refraction: 1.1, isotropic: 1.0, ..linen };
    let extremes = [("narrow", narrow), ("white", white), ("metal", metal), ("faint", faint)];
    threads.extend(extremes.map(|(name, thread)| (name.to_owned(), thread)));
    threads
}

/// A direction in the axes of [`super::FiberFrame`].
fn direction(theta_deg: f64, phi_deg: f64) -> DVec3 {
    let (theta, phi) = (theta_deg.to_radians(), phi_deg.to_radians());
    DVec3::new(theta.cos() * phi.cos(), theta.cos() * phi.sin(), theta.sin())
}

/// Viewers: normal, oblique, grazing across and along the fiber.
fn viewers() -> [DVec3; 6] {
    [
        direction(0.0, 0.0),
        direction(30.0, 40.0),
        direction(-55.0, -70.0),
        direction(10.0, 89.0),
        direction(82.0, 15.0),
        direction(-89.0, 60.0),
    ]
}

/// Uniform numbers in [0, 1) by hashing.
struct Random {
    seed: u32,
    count: u32,
}

impl Random {
    fn new(seed: u32) -> Self {
        Self { seed, count: 0 }
    }

    fn unit(&mut self) -> f64 {
        self.count += 1;
        unit_from_hash(hash_combine(self.seed, self.count))
    }

    fn triple(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.unit())
    }

    /// Uniform over the sphere.
    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let phi = std::f64::consts::TAU * self.unit();
        DVec3::new((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z)
    }
}
