use super::{Flyaways, Variate, Yarn};

/// Names of the nine measured yarns, as [`Yarn::preset`] takes them.
pub const PRESET_NAMES: [&str; 9] =
    ["cotton-1", "cotton-2", "rayon-1", "rayon-2", "rayon-3", "rayon-4", "silk-1", "silk-2", "polyester-1"];

/// One row of [Zhao2016, Table 2]: K, m, β, ε, alpha, R_min, s, e long, e short, R_ply, alpha_ply.
type Row = (u32, u32, f64, f64, f64, f64, f64, f64, f64, f64, f64);
/// Its flyaways: loops, hairs, then (mean, deviation) of R_max^loop, R_min^hair, R_span, z_span, theta_span.
type FlyawayRow = (f64, f64, [(f64, f64); 5]);

#[rustfmt::skip]
const TABLE_2: [(Row, FlyawayRow); 9] = [
    ((3,  75, 0.148, 0.000, -0.369, 0.80, 1.1, 0.026, 0.020, 0.038,  0.453),
     (22.17, 33.77, [(0.024, 0.005), (0.020, 0.006), (0.016, 0.009), (-0.003, 0.057), (0.377, 0.326)])),
    ((3,  37, 0.430, 0.033, -0.436, 0.95, 1.9, 0.025, 0.018, 0.033,  0.336),
     (13.34, 19.50, [(0.026, 0.007), (0.021, 0.005), (0.014, 0.006), (0.019, 0.048), (0.480, 0.404)])),
    ((2, 150, 0.682, 0.139,  0.710, 0.85, 1.9, 0.053, 0.036, 0.051, -0.639),
     (62.40, 52.52, [(0.050, 0.009), (0.041, 0.007), (0.020, 0.018), (0.016, 0.059), (0.403, 0.437)])),
    ((2,  80, 0.293, 0.052, -0.381, 0.85, 1.6, 0.028, 0.021, 0.029,  0.372),
     (39.08, 50.39, [(0.026, 0.006), (0.018, 0.005), (0.012, 0.007), (0.001, 0.025), (0.439, 0.498)])),
    ((2, 143, 0.640, 0.000,  0.609, 0.95, 1.9, 0.044, 0.034, 0.042, -0.638),
     (44.51, 53.72, [(0.041, 0.015), (0.030, 0.005), (0.028, 0.017), (-0.014, 0.110), (0.821, 0.707)])),
    ((2, 122, 0.671, 0.361,  0.560, 0.70, 1.7, 0.048, 0.034, 0.045, -0.498),
     (59.40, 65.23, [(0.043, 0.008), (0.038, 0.007), (0.021, 0.016), (0.009, 0.048), (0.326, 0.287)])),
    ((3,  33, 0.462, 0.000, -0.458, 0.95, 1.8, 0.025, 0.022, 0.038,  0.526),
     (20.32, 23.82, [(0.024, 0.004), (0.021, 0.004), (0.014, 0.011), (0.010, 0.050), (0.407, 0.390)])),
    ((3,  47, 0.554, 0.405, -0.556, 0.70, 1.2, 0.031, 0.025, 0.045,  0.702),
     (18.89, 23.09, [(0.029, 0.004), (0.024, 0.005), (0.010, 0.008), (0.008, 0.038), (0.417, 0.446)])),
    ((2,  60, 0.258, 0.202, -0.379, 0.75, 1.5, 0.029, 0.021, 0.029,  0.370),
     (35.69, 30.44, [(0.027, 0.004), (0.021, 0.005), (0.011, 0.009), (-0.003, 0.036), (0.356, 0.400)])),
];

/// Fiber radius in the scenes of [Zhao2016], table units (about 10 µm).
const FIBER_RADIUS: f64 = 0.002;

impl Yarn {
    /// The measured yarn of that name ([`PRESET_NAMES`]), or `None`.
    pub fn preset(name: &str) -> Option<Self> {
        let index = PRESET_NAMES.iter().position(|preset| *preset == name)?;
        let ((plies, fibers_per_ply, beta, epsilon, alpha, r_min, rate, long, short, ply, alpha_ply), fly) =
            TABLE_2[index];
        let [loop_r_max, hair_r_min, hair_r_span, hair_z_span, hair_theta_span] =
            fly.2.map(|(mean, deviation)| Variate { mean, deviation });
        Some(Self {
            plies,
            fibers_per_ply,
            density_beta: beta,
            density_epsilon: epsilon,
            fiber_twist: alpha,
            ply_twist: alpha_ply,
            r_min,
            migration_rate: rate,
            ellipse_long: long,
            ellipse_short: short,
            ply_radius: ply,
            fiber_radius: FIBER_RADIUS,
            flyaways: Flyaways {
                loop_density: fly.0,
                hair_density: fly.1,
                loop_r_max,
                hair_r_min,
                hair_r_span,
                hair_z_span,
                hair_theta_span,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_valid_and_unknown_names_are_refused() {
        for name in PRESET_NAMES {
            Yarn::preset(name).expect(name).validate().expect(name);
        }
        assert_eq!(Yarn::preset("cotton"), None);
    }

    #[test]
    fn a_wrong_parameter_is_named() {
        let yarn = Yarn { r_min: 1.5, ..Yarn::preset("silk-1").expect("preset") };
        assert_eq!(yarn.validate().expect_err("r_min above 1").parameter, "r_min");
    }

    #[test]
    fn as_many_fibers_as_a_key_has_numbers_for_are_taken_and_no_more() {
        let of = |plies, fibers_per_ply| Yarn { plies, fibers_per_ply, ..Yarn::preset("silk-1").expect("preset") };
        for (plies, fibers_per_ply) in [(1, 60_000), (4, 15_000), (4000, 15)] {
            of(plies, fibers_per_ply).validate().expect("few enough");
        }
        for (plies, fibers_per_ply, parameter) in [
            (1, 60_001, "plies × fibers_per_ply"),
            (4000, 16, "plies × fibers_per_ply"),
            (4001, 1, "plies"),
            (0, 9, "plies"),
        ] {
            let error = of(plies, fibers_per_ply).validate().expect_err("too many or none");
            assert_eq!(error.parameter, parameter, "{error}");
        }
    }
}
