use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use rayon::prelude::*;
use thiserror::Error;

use super::FiberAngles;
use super::longitudinal::gaussian;
use super::quadrature::simpson;

/// How one thread of a woven cloth, twisted or flat, scatters light as a whole [Sadeghi2012 §4.3]. Colours are scene-linear Rec.709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Index of refraction η, from 1.1 to 4: near 1, nothing damps the model's division by cosines at grazing angles.
    pub refraction: f64,
    /// A, each channel in [0, 1].
    pub color: DVec3,
    /// k_d, the isotropic share of what is scattered inside, in [0, 1].
    pub isotropic: f64,
    /// γ_s, width of the surface reflection in the half angle θ_h, radians.
    pub surface_width_rad: f64,
    /// γ_v, width of the scattering inside in θ_h, radians.
    pub volume_width_rad: f64,
}

/// A thread's parameter outside its range.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("thread parameter `{parameter}` is {value}: expected {expected}")]
pub struct ThreadError {
    /// Name of the field.
    pub parameter: &'static str,
    /// What it was set to.
    pub value: f64,
    /// What would be right.
    pub expected: &'static str,
}

impl Thread {
    /// Checks every parameter against its range.
    pub fn validate(&self) -> Result<(), ThreadError> {
        let check = |ok: bool, parameter, value, expected| {
            if ok { Ok(()) } else { Err(ThreadError { parameter, value, expected }) }
        };
        check((1.1..=4.0).contains(&self.refraction), "refraction", self.refraction, "a number from 1.1 to 4")?;
        for value in self.color.to_array() {
            check((0.0..=1.0).contains(&value), "color", value, "every channel from 0 to 1")?;
        }
        check((0.0..=1.0).contains(&self.isotropic), "isotropic", self.isotropic, "a number from 0 to 1")?;
        for (parameter, value) in
            [("surface_width_rad", self.surface_width_rad), ("volume_width_rad", self.volume_width_rad)]
        {
            check((1e-3..=FRAC_PI_2).contains(&value), parameter, value, "an angle from 0.001 to π/2")?;
        }
        Ok(())
    }
}

/// Unpolarised Fresnel reflectance of a smooth dielectric of index η > 1 from outside, for the cosine to its normal.
pub fn dielectric_reflectance(refraction: f64, cos_i: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i).max(0.0) / (refraction * refraction)).sqrt();
    let ratio = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    0.5 * (ratio(cos_i, refraction * cos_t) + ratio(refraction * cos_i, cos_t))
}

/// cos²θ_d, θ_d = (θ_i − θ_o)/2: ½ (1 + cos(θ_i − θ_o)), without the difference of near numbers where both are grazing and opposite.
fn cos_squared_difference(a: &FiberAngles) -> f64 {
    let (sines, cosines) = (a.sin_theta_i * a.sin_theta_o, a.cos_theta_i * a.cos_theta_o);
    if sines > 0.0 {
        0.5 * (1.0 + cosines + sines)
    } else {
        let squares = a.cos_theta_i.powi(2) + a.cos_theta_o.powi(2) - cosines * cosines;
        0.5 * (cosines + squares / (1.0 - sines))
    }
}

/// g: Gaussian of unit area in θ_h.
fn unit_gaussian(theta_h: f64, width: f64) -> f64 {
    gaussian(theta_h, width) / (TAU.sqrt() * width)
}

/// The two terms of f_s, each over cos²θ_d: F_r cos(φ/2) g(γ_s, θ_h), and F ((1 − k_d) g(γ_v, θ_h) + k_d) / (cos θ_i + cos θ_o) without A
/// [Sadeghi2012, Eq. 2–4]. Infinite where both directions lie along the thread, opposite.
///
/// g takes radians: in degrees it would be 57 times weaker beside k_d, which has no unit. F = F_t(η, ω_i) F_t(η', ω_r') is taken at the cosines to the plane across
/// the thread, cos θ_i and cos θ_o, which the paper leaves open; the second, from inside, equals that of the direction outside.
pub fn thread_terms(thread: &Thread, angles: &FiberAngles) -> [f64; 2] {
    let spread = cos_squared_difference(angles);
    let cos_half_phi = (0.5 + 0.5 * angles.cos_phi).max(0.0).sqrt();
    let theta_h = 0.5 * angles.cone_offset_rad();
    let reflected = dielectric_reflectance(thread.refraction, spread.sqrt() * cos_half_phi);
    let surface = reflected * cos_half_phi * unit_gaussian(theta_h, thread.surface_width_rad);
    let through = |cos: f64| 1.0 - dielectric_reflectance(thread.refraction, cos);
    let inside = (1.0 - thread.isotropic) * unit_gaussian(theta_h, thread.volume_width_rad) + thread.isotropic;
    let (cos_i, cos_o) = (angles.cos_theta_i, angles.cos_theta_o);
    let volume = through(cos_i) * through(cos_o) * inside / (cos_i + cos_o);
    [surface / spread, volume / spread]
}

/// f_s as printed [Sadeghi2012, Eq. 4]. It does not conserve energy: see [`ThreadTables`].
pub fn thread_printed(thread: &Thread, angles: &FiberAngles) -> DVec3 {
    let [surface, volume] = thread_terms(thread, angles);
    DVec3::splat(surface) + thread.color * volume
}

/// Factor of f_s that makes its surface term the reflectance of a cylinder: a perfect mirror's ∫ f_s cos θ_o dω_o is 8 across the thread.
///
/// ∫ cos(φ/2) dφ = 4, of which [Marschner2003] has a quarter; and g of unit area in θ_h has 2 in θ_o = 2θ_h − θ_i.
pub const THREAD_SCALE: f64 = 0.125;

/// Entries of the tables of a thread.
pub const THREAD_TABLE_SIZE: usize = 256;

/// |θ| of an entry: π/2 (1 − (1 − x)²) with x from 0 to 1, dense at grazing angles, where everything changes the quickest.
fn entry_angle_rad(k: usize) -> f64 {
    let left = 1.0 - k as f64 / (THREAD_TABLE_SIZE - 1) as f64;
    FRAC_PI_2 * (1.0 - left * left)
}

/// Linear interpolation in x.
fn lookup(table: &[f64], theta_rad: f64) -> f64 {
    let x = 1.0 - (1.0 - theta_rad.abs() / FRAC_PI_2).max(0.0).sqrt();
    super::tables::lookup(table, FRAC_PI_2 * x)
}

/// What makes the thread model conserve energy and stay reciprocal: S = [`THREAD_SCALE`] f_s / max(1, a(θ_i), a(θ_o)).
///
/// a is the albedo of the brightest channel with the factor alone. Because of the division by cos²θ_d it grows towards grazing angles, up to
/// 2 for a narrow surface lobe, which has every fiber of a bundle add light. The divisor is symmetric, and at least a(θ_i), so
/// that ∫ S cos θ_o dω_o ≤ 1. All tables are over |θ| in [0, π/2], dense towards π/2, and read with linear interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadTables {
    /// max(1, a).
    pub limit: Vec<f64>,
    /// ∫ of the surface term of S.
    pub surface: Vec<f64>,
    /// ∫ of the volume term of S, without A.
    pub volume: Vec<f64>,
}

/// A node of [`rings`]: θ_o, and what the surface and the volume term add to ∫ f_s cos θ_o dω_o there, times [`THREAD_SCALE`].
type Ring = (f64, [f64; 2]);

/// The integral over all viewers for light from θ_i, as rings of constant θ_o.
fn rings(thread: &Thread, theta_i: f64) -> Vec<Ring> {
    const INTERVALS: u32 = 80;
    // Over θ_o within `reach` of the cone, by Simpson's rule; `ring` is the integral over φ.
    let over = |reach: f64, ring: &dyn Fn(FiberAngles) -> [f64; 2]| -> Vec<Ring> {
        // Both sides of the cone, each dense at its ends, since all changes within π/2 − |θ_i| of the poles; the very pole is left out.
        let edge = FRAC_PI_2 - 1e-9;
        let cuts = [-theta_i - reach, -theta_i, reach - theta_i].map(|cut| cut.clamp(-edge, edge));
        let node = |from: f64, to: f64, k: u32| {
            let s = f64::from(k) / f64::from(INTERVALS);
            let theta_o = from + (to - from) * s * s * (3.0 - 2.0 * s);
            let step = (to - from) * 6.0 * s * (1.0 - s);
            let simpson_weight = f64::from(2 + 2 * (k % 2)) / f64::from(3 * INTERVALS);
            let weight = THREAD_SCALE * simpson_weight * step * theta_o.cos().powi(2);
            (theta_o, ring(FiberAngles::from_radians(theta_i, theta_o, 0.0)).map(|term| weight * term))
        };
        // At the ends the step is 0.
        let side = |from: f64, to: f64| (1..INTERVALS).map(move |k| node(from, to, k));
        side(cuts[0], cuts[1]).chain(side(cuts[1], cuts[2])).collect()
    };
    let surface = over(16.0 * thread.surface_width_rad, &|angles| {
        let at = |phi: f64| thread_terms(thread, &FiberAngles { cos_phi: phi.cos(), ..angles })[0];
        [2.0 * simpson(0.0, PI, 16, at), 0.0]
    });
    // The volume term does not depend on φ, and is linear in k_d.
    let volume = |isotropic: f64, share: f64, reach: f64| {
        let pure = Thread { isotropic, ..*thread };
        over(reach, &|angles| [0.0, share * TAU * thread_terms(&pure, &angles)[1]])
    };
    let along = volume(0.0, 1.0 - thread.isotropic, 16.0 * thread.volume_width_rad);
    [surface, along, volume(1.0, thread.isotropic, PI)].concat()
}

/// Sum of rings times `factor`(θ_o).
fn integrate(rings: &[Ring], factor: impl Fn(f64) -> f64) -> [f64; 2] {
    rings.iter().fold([0.0; 2], |[surface, volume], (theta_o, [s, v])| {
        let factor = factor(*theta_o);
        [surface + factor * s, volume + factor * v]
    })
}

impl ThreadTables {
    /// Fills the tables; about a fifth of a second on one core.
    pub fn new(thread: &Thread) -> Self {
        let brightest = thread.color.max_element();
        let angles: Vec<Vec<Ring>> =
            (0..THREAD_TABLE_SIZE).into_par_iter().map(|k| rings(thread, entry_angle_rad(k))).collect();
        let limit_at = |rings: &Vec<Ring>| {
            let [surface, volume] = integrate(rings, |_| 1.0);
            (surface + brightest * volume).max(1.0)
        };
        let limit: Vec<f64> = angles.par_iter().map(limit_at).collect();
        let limited = |(rings, limit_i): (&Vec<Ring>, &f64)| {
            integrate(rings, |theta_o| lookup(&limit, theta_o).max(*limit_i).recip())
        };
        let terms: Vec<[f64; 2]> = angles.par_iter().zip(&limit).map(limited).collect();
        Self { surface: terms.iter().map(|t| t[0]).collect(), volume: terms.iter().map(|t| t[1]).collect(), limit }
    }

    /// S cos θ_i: the throughput of [`super::FiberScattering`]. Zero for light along the thread.
    pub fn evaluate(&self, thread: &Thread, angles: &FiberAngles) -> DVec3 {
        if angles.cos_theta_i <= 0.0 {
            return DVec3::ZERO;
        }
        let limit = lookup(&self.limit, angles.theta_i_rad()).max(lookup(&self.limit, angles.theta_o_rad()));
        thread_printed(thread, angles) * (THREAD_SCALE * angles.cos_theta_i / limit)
    }

    /// ∫ S cos θ_o dω_o for light from θ_i, and, as S is reciprocal, ∫ S cos θ_i dω_i for a viewer at that angle.
    pub fn albedo(&self, thread: &Thread, theta_rad: f64) -> DVec3 {
        let [surface, volume] = self.terms(theta_rad);
        DVec3::splat(surface) + thread.color * volume
    }

    /// [`Self::surface`] and [`Self::volume`] at an angle.
    pub fn terms(&self, theta_rad: f64) -> [f64; 2] {
        [lookup(&self.surface, theta_rad), lookup(&self.volume, theta_rad)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FABRICS, fabric_threads};
    use super::*;

    #[test]
    fn fresnel_has_its_known_values() {
        // ((η − 1)/(η + 1))² at normal incidence, 1 at grazing, and at Brewster's angle half the reflectance of s-polarised light.
        assert!((dielectric_reflectance(1.5, 1.0) - 0.04).abs() < 1e-12);
        assert_eq!(dielectric_reflectance(1.5, 0.0), 1.0);
        assert!(dielectric_reflectance(1.0, 0.3) < 1e-30);
        let brewster = 1.5_f64.atan();
        let s = ((1.0 - 1.5_f64.powi(2)) / (1.0 + 1.5_f64.powi(2))).powi(2);
        assert!((dielectric_reflectance(1.5, brewster.cos()) - 0.5 * s).abs() < 1e-12);
    }

    #[test]
    fn the_difference_angle_is_that_of_its_definition() {
        for (theta_i, theta_o) in [(0.3, 0.9), (-0.4, 1.1), (1.57, -1.57), (1.2, 1.5), (0.0, -1.0)] {
            let angles = FiberAngles::from_radians(theta_i, theta_o, 0.5);
            let expected = (0.5_f64 * (theta_i - theta_o)).cos().powi(2);
            assert!((cos_squared_difference(&angles) / expected - 1.0).abs() < 1e-9, "{theta_i} {theta_o}");
        }
    }

    /// ∫ of a perfect mirror's surface term: F = 1.
    fn mirror(width: f64) -> f64 {
        // Light across the thread: the term without F is cos(φ/2) g / cos²θ_d.
        simpson(-FRAC_PI_2, FRAC_PI_2, 4000, |theta_o| {
            4.0 * unit_gaussian(0.5 * theta_o, width) * (theta_o.cos() / (0.5 * theta_o).cos()).powi(2)
        })
    }

    #[test]
    fn the_scale_is_that_of_a_mirror() {
        assert!((mirror(0.01) * THREAD_SCALE - 1.0).abs() < 1e-3, "{}", mirror(0.01));
    }

    #[test]
    fn as_printed_the_model_gives_back_more_than_came_in_and_scaled_it_still_does_at_grazing_angles() {
        let (mut printed, mut scaled) = (0, 0);
        for (name, thread) in fabric_threads() {
            let albedo = |theta: f64| {
                let [surface, volume] = integrate(&rings(&thread, theta), |_| 1.0);
                surface + volume * thread.color.max_element()
            };
            let slanted = albedo(75_f64.to_radians());
            let grazing = albedo(FRAC_PI_2);
            println!("{name}: {:.2} across, {slanted:.2} at 75°, {grazing:.2} along", albedo(0.0));
            printed += usize::from(slanted / THREAD_SCALE > 1.0);
            scaled += usize::from(grazing > 1.0);
            assert!(albedo(0.0) < 0.5);
        }
        assert_eq!((printed, scaled), (8, 6));
    }

    #[test]
    fn tables_are_near_the_integrals_between_their_entries() {
        let mut worst = 0.0_f64;
        for (_, thread) in fabric_threads() {
            let tables = ThreadTables::new(&thread);
            for k in 0..60 {
                let theta = FRAC_PI_2 * (1.0 - ((f64::from(k) + 0.37) / 60.0).powi(3));
                let limit = |theta: f64| lookup(&tables.limit, theta);
                let exact = integrate(&rings(&thread, theta), |theta_o| limit(theta_o).max(limit(theta)).recip());
                let table = tables.terms(theta);
                worst = worst.max((exact[0] - table[0]).abs()).max((exact[1] - table[1]).abs());
            }
        }
        assert!(worst < 1e-3, "{worst}");
    }

    #[test]
    fn fabrics_are_valid_and_a_wrong_parameter_is_named() {
        assert_eq!((FABRICS.len(), fabric_threads().len()), (5, 8));
        for (name, thread) in fabric_threads() {
            thread.validate().expect(&name);
        }
        let (_, linen) = fabric_threads()[0];
        let wrong = [
            (Thread { refraction: 0.9, ..linen }, "refraction"),
            (Thread { color: DVec3::new(0.1, 1.1, 0.0), ..linen }, "color"),
            (Thread { isotropic: f64::NAN, ..linen }, "isotropic"),
            (Thread { volume_width_rad: 0.0, ..linen }, "volume_width_rad"),
        ];
        for (thread, parameter) in wrong {
            assert_eq!(thread.validate().expect_err(parameter).parameter, parameter);
        }
    }
}
