// The simple model for a path tracer; twin of native/core/src/scattering/fiber.rs, where the contract is.

fn simple_mixture(material: Material) -> Mixture {
    return Mixture(array<Lobe, 3>(
        Lobe(mean_of(material.specular), LOBE_CONE_HALF_COSINE, 2.0 * material.specular_beta, 0.0),
        Lobe(mean_of(material.diffuse), LOBE_LAMBERT, 0.0, 0.0),
        Lobe(0.0, LOBE_EVEN, 0.0, 0.0),
    ));
}

// Share of the light from θ_i that is scattered.
fn simple_albedo(material: Material, theta_i: f32) -> vec3f {
    let shape = gaussian_integral(theta_i, 2.0 * material.specular_beta);
    return material.specular * (material.highlight_scale * 4.0 * shape) + material.diffuse;
}
