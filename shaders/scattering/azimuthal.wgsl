// Twin of native/core/src/scattering/azimuthal.rs.

// R is uniform around the fiber [WuYuksel2018 Eq. 9].
const AZIMUTHAL_UNIFORM: f32 = 0.15915494309;

fn von_mises(cos_phi: f32, gamma: f32, scale: f32) -> f32 {
    return scale * exp(-(1.0 + cos_phi) / (gamma * gamma));
}
