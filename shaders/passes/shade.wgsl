// Shading of a point on a fiber: shared by the two resolve passes.

struct Surface {
    tube: Tube,
    // Section axes of the fiber's ply.
    radial: vec3f,
    tangential: vec3f,
    position: vec3f,
    tangent: vec3f,
    normal: vec3f,
}

// The normal of a round fiber seen at `offset` (-1 … 1) across it; `side` points where the offset grows.
fn fiber_normal(tangent: vec3f, side: vec3f, view: vec3f, offset: f32) -> vec3f {
    let across = normalize(cross(tangent, view) + vec3f(1e-12, 0.0, 0.0));
    let right = across * select(-1.0, 1.0, dot(across, side) >= 0.0);
    let forward = normalize(view - tangent * dot(view, tangent) + vec3f(0.0, 0.0, 1e-12));
    let x = clamp(offset, -1.0, 1.0);
    return normalize(right * x + forward * sqrt(max(1.0 - x * x, 0.0)));
}

fn shade(draw: u32, surface: Surface) -> vec3f {
    let yarn = yarns[draws[draw].yarn];
    let material = materials[draws[draw].material];
    let view = direction_to_viewer(frame.viewer, surface.position);
    let section = section_point(surface.tube.center, surface.tube.radius, surface.radial, surface.tangential, surface.position);
    let seen = seen_point(yarn, section, view);
    var radiance = vec3f(0.0);
    for (var i = 0u; i < frame.light_count; i++) {
        let light = lights[i];
        let incident = incident_light(light, surface.position);
        if all(incident.irradiance <= vec3f(0.0)) {
            continue;
        }
        let open = self_shadow(yarn, seen, incident.direction) * light_shadow(light, incident, surface.tube, surface.position);
        let angles = fiber_angles(surface.tangent, incident.direction, view);
        let cos_normal = dot(surface.normal, incident.direction);
        var reflected: vec3f;
        if frame.physical == 1u {
            reflected = physical_reflected(material, normalizers_at(material, angles.sin_theta_i), angles, cos_normal);
        } else {
            reflected = simple_reflected(material, angles, cos_normal);
        }
        radiance += reflected * incident.irradiance * open;
    }
    let sin_theta_o = dot(surface.tangent, view);
    var ambient: vec3f;
    if frame.physical == 1u {
        ambient = physical_ambient(material, ambient_factors(material, sin_theta_o));
    } else {
        ambient = simple_ambient(material, sin_theta_o);
    }
    return radiance + ambient * frame.ambient * self_sky(yarn, seen) * sky_shadow(surface.tube, surface.position);
}

// The key of a pixel taken apart.
struct Winner {
    draw: u32,
    parts: KeyParts,
    ply: u32,
    // 0 for the core, else the fiber's rank + 1.
    slot: u32,
}

fn winner_at(index: u32) -> Winner {
    let words = keys[index];
    let parts = key_parts(Key(words.y, words.x));
    let draw = find_draw(parts.segment);
    let slots = yarns[draws[draw].yarn].fibers + 1u;
    return Winner(draw, parts, parts.slot / slots, parts.slot % slots);
}

fn add_surface(index: u32, draw: u32, surface: Surface) {
    let depth = to_pixel(frame.pixel_from_render, surface.position).w;
    let color = vec4f(shade(draw, surface), 1.0);
    add_sample(index, color, surface.normal, surface.tangent, depth, f32(draw + 1u));
}
