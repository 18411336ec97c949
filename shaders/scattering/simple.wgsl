// Lambert and the highlight of [WuYuksel2018 Eq. 5]; twin of native/core/src/scattering/simple.rs.

fn simple_lobes(material: Material, angles: FiberAngles, cos_normal_light: f32) -> Reflected {
    let highlight = sqrt(max(0.5 + 0.5 * angles.cos_phi, 0.0)) * gaussian(0.5 * angles.cone_offset, material.specular_beta);
    return Reflected(
        material.specular * (material.highlight_scale * highlight * angles.cos_theta_i),
        vec3f(0.0),
        material.diffuse * (max(cos_normal_light, 0.0) / PI),
    );
}

fn simple_ambient(material: Material, sin_theta_o: f32) -> vec3f {
    let narrowing = exp(-8.0 * material.specular_beta * material.specular_beta);
    let cos_2theta_o = 1.0 - 2.0 * sin_theta_o * sin_theta_o;
    return material.specular * ((1.0 + cos_2theta_o * narrowing) / (1.0 + narrowing)) + material.diffuse;
}
