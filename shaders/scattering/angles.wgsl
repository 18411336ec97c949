// Directions about a fiber's tangent; twin of native/core/src/scattering/angles.rs. Both directions point away from the fiber.

struct FiberAngles {
    sin_theta_i: f32,
    cos_theta_i: f32,
    sin_theta_o: f32,
    cos_theta_o: f32,
    cos_phi: f32,
    // cos(phi / 2), without the difference of near numbers at phi = pi.
    cos_half_phi: f32,
    // theta_o + theta_i: 0 on the specular cone.
    cone_offset: f32,
}

fn fiber_angles(tangent: vec3f, toward_light: vec3f, toward_viewer: vec3f) -> FiberAngles {
    var a: FiberAngles;
    a.sin_theta_i = clamp(dot(tangent, toward_light), -1.0, 1.0);
    a.sin_theta_o = clamp(dot(tangent, toward_viewer), -1.0, 1.0);
    let light = toward_light - tangent * a.sin_theta_i;
    let viewer = toward_viewer - tangent * a.sin_theta_o;
    a.cos_theta_i = length(light);
    a.cos_theta_o = length(viewer);
    a.cos_phi = clamp(dot(light, viewer) / max(a.cos_theta_i * a.cos_theta_o, 1e-12), -1.0, 1.0);
    a.cos_half_phi = 0.5 * length(light / max(a.cos_theta_i, 1e-12) + viewer / max(a.cos_theta_o, 1e-12));
    // By the arc tangent, which keeps its digits where a direction is near the fiber.
    a.cone_offset = atan2(
        a.sin_theta_o * a.cos_theta_i + a.cos_theta_o * a.sin_theta_i,
        a.cos_theta_o * a.cos_theta_i - a.sin_theta_o * a.sin_theta_i,
    );
    return a;
}
