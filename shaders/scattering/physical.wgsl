// R + TT [Khungurn2015; WuYuksel2018 Eq. 6] mixed with a Lambert term; twin of native/core/src/scattering/physical.rs,
// where the contract and the energy tests are.

struct Normalizers {
    integral_r: f32,
    integral_tt: f32,
}

fn schlick(cos_theta_i: f32) -> f32 {
    let x = max(1.0 - cos_theta_i, 0.0);
    return x * x * x * x * x;
}

// What a fiber gives back: by reflection (R, or the highlight), by transmission (TT), and by Lambert's term.
struct Reflected {
    specular: vec3f,
    transmission: vec3f,
    diffuse: vec3f,
}

// Radiance per irradiance on a plane that faces the light.
fn physical_lobes(material: Material, normalizers: Normalizers, angles: FiberAngles, cos_normal_light: f32) -> Reflected {
    let f = material.color_r + (1.0 - material.color_r) * schlick(angles.cos_theta_i);
    let m_r = gaussian(angles.cone_offset, material.beta_r) / normalizers.integral_r;
    let m_tt = gaussian(angles.cone_offset, material.beta_tt) / normalizers.integral_tt;
    let n_tt = von_mises(angles.cos_phi, material.gamma_tt, material.azimuthal_tt);
    let fiber = (1.0 - material.diffuse_weight) * angles.cos_theta_i;
    return Reflected(
        f * (AZIMUTHAL_UNIFORM * m_r * fiber),
        (1.0 - f) * material.color_tt * (m_tt * n_tt * fiber),
        material.diffuse * (material.diffuse_weight / PI * max(cos_normal_light, 0.0)),
    );
}

// Radiance under even light: of what is scattered to all sides, of what goes straight on, and of what is taken in on the side that is seen.
struct EvenLight {
    around: vec3f,
    through: vec3f,
    facing: vec3f,
}

// `factors`: reflect, reflect at grazing angles, transmit.
fn physical_ambient(material: Material, factors: vec3f) -> EvenLight {
    let reflected = material.color_r * factors.x + (1.0 - material.color_r) * factors.y;
    let transmitted = (1.0 - material.color_r) * material.color_tt * factors.z;
    let w = material.diffuse_weight;
    return EvenLight(reflected * (1.0 - w), transmitted * (1.0 - w), material.diffuse * w);
}
