// How it works: one thread a pixel. It takes the winning key apart, evaluates that fiber again where the pixel lies on it,
// shades it, and adds one sample to the film.

// Two words per pixel: lower and upper half of the key.
@group(0) @binding(15) var<storage, read> keys: array<vec2u>;
@group(0) @binding(17) var<storage, read_write> film_color: array<vec4f>;
// Sum of normals; depth of the first sample.
@group(0) @binding(18) var<storage, read_write> film_normal: array<vec4f>;
// Sum of tangents; object id of the first sample.
@group(0) @binding(19) var<storage, read_write> film_tangent: array<vec4f>;

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

fn fiber_surface(s: Segment, yarn: Yarn, ends: array<Detail, 2>, ply: u32, index: u32, place: u32, pixel: vec2f) -> Surface {
    let t = f32(place) / place_scale();
    let p = yarn_point(s, t);
    let q = ply_point(yarn, s, p, ply);
    let f = fiber_point(yarn, s, p, q, fiber_at(yarn, s.seed, ply, index));
    let width = width_factor(yarn, mix_detail(ends, t), index, f);
    let at = to_pixel(frame.pixel_from_render, f.position);
    // The pixel relative to the fiber on the screen: along it, what is left of the place's rounding; across it, the offset.
    let moved = (frame.pixel_from_render * vec4f(f.velocity, 0.0)).xyz;
    let on_screen = (moved.xy - at.xy * moved.z) / at.z;
    let speed = max(length(on_screen), 1e-20);
    let to_pixel_center = pixel - at.xy;
    let rest = clamp(dot(to_pixel_center, on_screen) / (speed * speed), -1.0 / place_scale(), 1.0 / place_scale());
    let across = (to_pixel_center.x * on_screen.y - to_pixel_center.y * on_screen.x) / speed;
    let offset = across / max(radius_in_pixels(yarn.fiber_radius * p.radius * width, at.z), 1e-20);
    let center = f.position + f.velocity * rest;
    let tangent = normalize(f.velocity);
    let view = direction_to_viewer(frame.viewer, center);
    // Render-space direction that the offset grows in: (y, -x) of the fiber's direction on the screen.
    let side = cross(tangent, view);
    let side_on_screen = frame.pixel_from_render * vec4f(side, 0.0);
    let grows = dot(side_on_screen.xy - at.xy * side_on_screen.z, vec2f(on_screen.y, -on_screen.x)) >= 0.0;
    let normal = fiber_normal(tangent, side * select(-1.0, 1.0, grows), view, offset);
    let position = center + normal * (yarn.fiber_radius * p.radius);
    return Surface(Tube(p.position, p.radius, p.tangent), q.radial, q.tangential, position, tangent, normal);
}

fn core_surface(s: Segment, yarn: Yarn, ends: array<Detail, 2>, ply: u32, step: u32, pixel: vec2u) -> Surface {
    let steps = core_steps(yarn, s, segment_radius_pixels(s));
    let t0 = f32(step - 1u) / f32(steps);
    let t1 = f32(step) / f32(steps);
    let pa = yarn_point(s, t0);
    let pb = yarn_point(s, t1);
    let ca = core_point(yarn, s, pa, ply, frame.viewer);
    let cb = core_point(yarn, s, pb, ply, frame.viewer);
    let hit = core_hit(core_end(ca), core_end(cb), vec2f(pixel) + 0.5);
    // Steps are short: in between, everything is as good as linear.
    let layer = core_layer(yarn, mix_detail(ends, mix(t0, t1, hit.t)).fibers, core_chance(pixel));
    let texel = core_texel(yarn, layer, hit.turns, hit.v);
    let height = tables[texel];
    let toward = mix(ca.toward, cb.toward, hit.t);
    let across = mix(ca.across, cb.across, hit.t);
    let radial = normalize(mix(ca.ply.radial, cb.ply.radial, hit.t));
    let tangential = normalize(mix(ca.ply.tangential, cb.ply.tangential, hit.t));
    let offset = toward * height + across * hit.v;
    let winding = (toward * tables[texel + 2u] + across * tables[texel + 3u]) * mix(ca.fiber_rate, cb.fiber_rate, hit.t);
    let turning = mix(ca.ply.radial_rate, cb.ply.radial_rate, hit.t) * dot(offset, radial)
        + mix(ca.ply.tangential_rate, cb.ply.tangential_rate, hit.t) * dot(offset, tangential);
    let tangent = normalize(mix(ca.velocity, cb.velocity, hit.t) + turning + winding);
    let center = mix(ca.center, cb.center, hit.t);
    let view = direction_to_viewer(frame.viewer, center);
    let normal = fiber_normal(tangent, mix(ca.side, cb.side, hit.t), view, tables[texel + 1u]);
    let tube = Tube(
        mix(pa.position, pb.position, hit.t),
        mix(pa.radius, pb.radius, hit.t),
        normalize(mix(pa.tangent, pb.tangent, hit.t)),
    );
    return Surface(tube, radial, tangential, center + offset, tangent, normal);
}

fn surface_at(draw: u32, s: Segment, parts: KeyParts, pixel: vec2u) -> Surface {
    let yarn = yarns[draws[draw].yarn];
    let ends = detail_ends(yarn, draw, parts.segment);
    let ply = parts.slot / (yarn.fibers + 1u);
    let slot = parts.slot % (yarn.fibers + 1u);
    if slot == 0u {
        return core_surface(s, yarn, ends, ply, parts.place, pixel);
    }
    return fiber_surface(s, yarn, ends, ply, slot - 1u, parts.place, vec2f(pixel) + 0.5);
}

fn shade(draw: u32, surface: Surface) -> vec3f {
    let yarn = yarns[draws[draw].yarn];
    let material = materials[draws[draw].material];
    let view = direction_to_viewer(frame.viewer, surface.position);
    let section = section_point(surface.tube.center, surface.tube.radius, surface.radial, surface.tangential, surface.position);
    var radiance = vec3f(0.0);
    for (var i = 0u; i < frame.light_count; i++) {
        let light = lights[i];
        let incident = incident_light(light, surface.position);
        if all(incident.irradiance <= vec3f(0.0)) {
            continue;
        }
        let open = self_shadow(yarn, section, incident.direction) * light_shadow(light, incident, surface.tube, surface.position);
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
    return radiance + ambient * frame.ambient * self_occlusion(yarn, section) * sky_shadow(surface.tube, surface.position);
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = id.y * frame.size.x + id.x;
    let words = keys[index];
    let first = frame.sample_index == 0u;
    var color = select(vec4f(0.0), vec4f(frame.background, 1.0), frame.opaque_background == 1u);
    var normal = vec4f(0.0);
    var tangent = vec4f(0.0);
    if words.y != 0u {
        let key = Key(words.y, words.x);
        let parts = key_parts(key);
        let draw = find_draw(parts.segment);
        let s = segment_at(draw, parts.segment);
        let surface = surface_at(draw, s, parts, id.xy);
        color = vec4f(shade(draw, surface), 1.0);
        normal = vec4f(surface.normal, 0.0);
        tangent = vec4f(surface.tangent, 0.0);
        if first {
            normal.w = to_pixel(frame.pixel_from_render, surface.position).w;
            tangent.w = f32(draws[draw].object_id);
        }
    } else if first {
        normal.w = 1e10;
    }
    if first {
        film_color[index] = color;
        film_normal[index] = normal;
        film_tangent[index] = tangent;
    } else {
        film_color[index] += color;
        film_normal[index] += vec4f(normal.xyz, 0.0);
        film_tangent[index] = vec4f(film_tangent[index].xyz + tangent.xyz, film_tangent[index].w);
    }
}
