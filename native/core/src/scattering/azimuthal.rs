use std::f64::consts::{PI, TAU};

/// e^−x I₀(x) for x ≥ 0: the modified Bessel function of order 0 without its growth. Relative error below 1e-10.
///
/// Power series up to x = 30, beyond it the asymptotic series 1/√(2πx) Σ ((2k−1)!!)² / (k! (8x)^k).
fn bessel_i0_scaled(x: f64) -> f64 {
    let series = |first: f64, ratio: &dyn Fn(f64) -> f64, terms: u32| {
        let (mut term, mut sum) = (first, first);
        for k in 1..=terms {
            term *= ratio(f64::from(k));
            sum += term;
        }
        sum
    };
    if x < 30.0 {
        series((-x).exp(), &|k| (0.5 * x / k).powi(2), 80)
    } else {
        series((TAU * x).sqrt().recip(), &|k| (2.0 * k - 1.0).powi(2) / (8.0 * k * x), 12)
    }
}

/// Factor of [`von_mises`] that makes it a density over the circle: 1 / (2π e^−κ I₀(κ)), κ = γ⁻².
///
/// [WuYuksel2018, Eq. 10] prints γ⁻² I₀(1) / I₀(γ⁻²) for the integral; that of a density is 1.
pub fn von_mises_scale(gamma_rad: f64) -> f64 {
    (TAU * bessel_i0_scaled(gamma_rad.powi(-2))).recip()
}

/// N_TT: von Mises density of φ about π with concentration γ⁻² [Khungurn2015]; `scale` is [`von_mises_scale`].
///
/// The exponent is at most 0, so that no γ overflows.
pub fn von_mises(cos_phi: f64, gamma_rad: f64, scale: f64) -> f64 {
    scale * (-(1.0 + cos_phi) * gamma_rad.powi(-2)).exp()
}

/// N_R: R is uniform around the fiber [WuYuksel2018, Eq. 9].
pub const UNIFORM: f64 = 0.5 / PI;

#[cfg(test)]
mod tests {
    use super::super::quadrature::simpson;
    use super::*;

    fn circle_integral(gamma: f64, scale: f64) -> f64 {
        let reach = (12.0 * gamma).min(PI);
        2.0 * simpson(PI - reach, PI, 2000, |phi| von_mises(phi.cos(), gamma, scale))
    }

    #[test]
    fn von_mises_is_a_density_for_every_width() {
        for gamma in [0.001, 0.01, 0.1, 0.18, 0.1826, 0.35, 0.67, 1.0, 1.57] {
            let integral = circle_integral(gamma, von_mises_scale(gamma));
            assert!((integral - 1.0).abs() < 1e-9, "γ {gamma}: {integral}");
        }
    }

    #[test]
    fn the_factor_as_printed_is_rejected_by_the_same_check() {
        // (Near γ = 38° it happens to be about 1.)
        for gamma_deg in [10.0_f64, 20.0, 26.0] {
            let gamma = gamma_deg.to_radians();
            let i0 = |x: f64| bessel_i0_scaled(x) * x.exp();
            let printed = gamma.powi(-2) / i0(gamma.powi(-2)) * i0(1.0);
            assert!((circle_integral(gamma, von_mises_scale(gamma) * printed) - 1.0).abs() > 0.05, "γ {gamma_deg}°");
        }
    }

    #[test]
    fn bessel_function_has_its_tabulated_values() {
        // e^−x I₀(x) from Abramowitz & Stegun, table 9.8.
        for (x, expected) in [(0.0, 1.0), (1.0, 0.465_759_607_6), (5.0, 0.183_540_812_6), (10.0, 0.127_833_337_1)] {
            assert!((bessel_i0_scaled(x) - expected).abs() < 1e-9, "x {x}");
        }
        assert!((bessel_i0_scaled(30.0 - 1e-9) / bessel_i0_scaled(30.0) - 1.0).abs() < 1e-9, "the branches meet");
    }
}
