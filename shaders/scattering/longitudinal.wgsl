// Twin of native/core/src/scattering/longitudinal.rs.

fn gaussian(cone_offset: f32, beta: f32) -> f32 {
    let x = cone_offset / beta;
    return exp(-0.5 * x * x);
}
