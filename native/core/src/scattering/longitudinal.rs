use std::f64::consts::FRAC_PI_2;

use super::quadrature::simpson;

/// g = exp(−x² / 2β²), x = θ_o + θ_i: the longitudinal lobe before normalisation, a Gaussian about the specular cone θ_o = −θ_i.
pub fn gaussian(cone_offset_rad: f64, beta_rad: f64) -> f64 {
    let x = cone_offset_rad / beta_rad;
    (-0.5 * x * x).exp()
}

/// ∫ g cos²θ_o dθ_o over [−π/2, π/2], by which M = g / ∫ sends all light of every θ_i somewhere [Khungurn2017, appendix A: G].
///
/// One cosine is the solid angle's, one the projection of the fiber's length. Relative error below 1e-6.
pub fn gaussian_integral(theta_i_rad: f64, beta_rad: f64) -> f64 {
    let reach = 8.0 * beta_rad;
    let (from, to) = ((-theta_i_rad - reach).max(-FRAC_PI_2), (-theta_i_rad + reach).min(FRAC_PI_2));
    simpson(from, to, 48, |theta_o| gaussian(theta_o + theta_i_rad, beta_rad) * theta_o.cos().powi(2))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn the_integral_has_its_closed_form_where_nothing_is_cut_off() {
        // ∫ g cos² over all θ = √(2π) β ½ (1 + cos 2θ_i exp(−2β²)).
        for beta in [0.001, 0.0175, 0.1, 0.13] {
            for theta_i in [0.0_f64, 0.2, -0.5] {
                let closed = TAU.sqrt() * beta * 0.5 * (1.0 + (2.0 * theta_i).cos() * (-2.0 * beta * beta).exp());
                let error = gaussian_integral(theta_i, beta) / closed - 1.0;
                assert!(error.abs() < 1e-6, "β {beta}, θ_i {theta_i}: {error}");
            }
        }
    }

    #[test]
    fn the_integral_has_its_limit_at_grazing_light() {
        // Half a Gaussian times x²: √(2π) β³ / 2 for small β.
        let beta = 0.01_f64;
        let limit = TAU.sqrt() * beta.powi(3) / 2.0;
        assert!((gaussian_integral(FRAC_PI_2, beta) / limit - 1.0).abs() < 2e-4);
    }
}
