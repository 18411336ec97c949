// The normaliser of a longitudinal lobe where no table is at hand; twin of native/core/src/scattering/longitudinal.rs.

// ∫ g cos² θ_o dθ_o over the fiber's half circle, by Simpson's rule with 48 panels.
fn gaussian_integral(theta_i: f32, beta: f32) -> f32 {
    let reach = 8.0 * beta;
    let first = max(-theta_i - reach, -0.5 * PI);
    let last = min(reach - theta_i, 0.5 * PI);
    let step = (last - first) / 96.0;
    var sum = 0.0;
    for (var k = 0u; k <= 96u; k++) {
        let theta_o = first + step * f32(k);
        let weight = select(select(2.0, 4.0, (k & 1u) == 1u), 1.0, k == 0u || k == 96u);
        // At the poles the cosine is the sine of what is left, which keeps its digits.
        let cosine = sin(0.5 * PI - abs(theta_o));
        sum += weight * gaussian(theta_o + theta_i, beta) * cosine * cosine;
    }
    return sum * step / 3.0;
}
