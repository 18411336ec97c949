// Axes at a point of a fiber; twin of native/core/src/scattering/frame.rs.

// World from local, as columns: the surface normal, tangent × normal, the tangent. The normal may lean along the fiber.
fn fiber_frame(tangent: vec3f, surface_normal: vec3f) -> mat3x3f {
    let normal = normalize(surface_normal - tangent * dot(tangent, surface_normal));
    return mat3x3f(normal, cross(tangent, normal), tangent);
}

// θ of a direction in those axes.
fn longitude(direction: vec3f) -> f32 {
    return atan2(direction.z, length(direction.xy));
}
