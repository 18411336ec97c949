// R + TT for a path tracer; twin of native/core/src/scattering/fiber.rs, where the contract is.

fn fresnel(color_r: vec3f, cos_theta_i: f32) -> vec3f {
    return color_r + (1.0 - color_r) * schlick(cos_theta_i);
}

fn physical_mixture(material: Material, viewer: vec3f) -> Mixture {
    let w = material.diffuse_weight;
    let theta = abs(longitude(viewer));
    // F at the cone, from θ ± β, so that neither F nor 1 - F is 0 where the lobe has more of it.
    let reflect = fresnel(material.color_r, cos(min(theta + material.beta_r, 0.5 * PI)));
    let enter = 1.0 - fresnel(material.color_r, cos(max(theta - material.beta_tt, 0.0)));
    return Mixture(array<Lobe, 3>(
        Lobe((1.0 - w) * mean_of(reflect), LOBE_CONE_UNIFORM, material.beta_r, 0.0),
        Lobe((1.0 - w) * mean_of(enter * material.color_tt), LOBE_CONE_STRAIGHT, material.beta_tt, straight_excess(material.gamma_tt)),
        Lobe(w * mean_of(material.diffuse), LOBE_LAMBERT, 0.0, 0.0),
    ));
}

// Share of the light from θ_i that is scattered.
fn physical_albedo(material: Material, cos_theta_i: f32) -> vec3f {
    let f = fresnel(material.color_r, cos_theta_i);
    return mix(f + (1.0 - f) * material.color_tt, material.diffuse, material.diffuse_weight);
}

// The normalisers of `physical_lobes` where no table is at hand.
fn exact_normalizers(material: Material, theta_i: f32) -> Normalizers {
    return Normalizers(gaussian_integral(theta_i, material.beta_r), gaussian_integral(theta_i, material.beta_tt));
}
