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
    draw: u32,
    point: YarnPoint,
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

fn fiber_surface(draw: u32, s: Segment, yarn: Yarn, ends: array<Detail, 2>, ply: u32, index: u32, step: u32, pixel: vec2f) -> Surface {
    let fiber = fiber_at(yarn, s.seed, ply, index);
    let steps = fiber_steps(yarn, s, segment_radius_pixels(s));
    let t0 = f32(step - 1u) / f32(steps);
    let t1 = f32(step) / f32(steps);
    let a = fiber_end(yarn, s, ends, ply, fiber, t0);
    let b = fiber_end(yarn, s, ends, ply, fiber, t1);
    let line = make_line(a.line, b.line);
    let hit = line_hit(line, pixel);
    // Equal steps on the screen are not equal steps in depth.
    let wa = select(1.0 / a.line.depth, 1.0, frame.viewer.w > 0.5);
    let wb = select(1.0 / b.line.depth, 1.0, frame.viewer.w > 0.5);
    let t = mix(t0, t1, hit.t * wb / mix(wa, wb, hit.t));
    let p = yarn_point(s, t);
    let f = fiber_point(yarn, s, p, ply, fiber);
    let tangent = normalize(f.velocity);
    let view = direction_to_viewer(frame.viewer, f.position);
    // Screen direction in which the offset grows, brought back to render space by its projection.
    let across = cross(tangent, view);
    let moved = (frame.pixel_from_render * vec4f(across, 0.0)).xyz;
    let on_screen = moved.xy - pixel * moved.z;
    let grows = vec2f(line.direction.y, -line.direction.x);
    let side = across * select(-1.0, 1.0, dot(on_screen, grows) >= 0.0);
    let normal = fiber_normal(tangent, side, view, hit.offset);
    return Surface(draw, p, f.position + normal * (yarn.fiber_radius * p.radius), tangent, normal);
}

fn core_surface(draw: u32, s: Segment, yarn: Yarn, ends: array<Detail, 2>, ply: u32, step: u32, pixel: vec2u) -> Surface {
    let steps = core_steps(yarn, s, segment_radius_pixels(s));
    let t0 = f32(step - 1u) / f32(steps);
    let t1 = f32(step) / f32(steps);
    let a = core_end(yarn, s, ply, t0);
    let b = core_end(yarn, s, ply, t1);
    let hit = core_hit(a, b, vec2f(pixel) + 0.5);
    let t = mix(t0, t1, hit.t);
    let p = yarn_point(s, t);
    let c = core_point(yarn, s, p, ply, frame.viewer);
    let layer = core_layer(yarn, mix_detail(ends, t).fibers, core_chance(pixel));
    let texel = core_texel(yarn, layer, hit.turns, hit.v);
    let height = tables[texel];
    let offset = c.toward * height + c.across * hit.v;
    let winding = (c.toward * tables[texel + 2u] + c.across * tables[texel + 3u]) * c.fiber_rate;
    let turning = c.ply.radial_rate * dot(offset, c.ply.radial) + c.ply.tangential_rate * dot(offset, c.ply.tangential);
    let tangent = normalize(c.velocity + turning + winding);
    let view = direction_to_viewer(frame.viewer, c.center);
    let normal = fiber_normal(tangent, c.side, view, tables[texel + 1u]);
    return Surface(draw, p, c.center + offset, tangent, normal);
}

fn surface_at(key: Key, pixel: vec2u) -> Surface {
    let parts = key_parts(key);
    let draw = find_draw(parts.segment);
    let yarn = yarns[draws[draw].yarn];
    let s = segment_at(draw, parts.segment);
    let ends = detail_ends(yarn, draw, parts.segment);
    let ply = parts.slot / (yarn.fibers + 1u);
    let slot = parts.slot % (yarn.fibers + 1u);
    if slot == 0u {
        return core_surface(draw, s, yarn, ends, ply, parts.step, pixel);
    }
    return fiber_surface(draw, s, yarn, ends, ply, slot - 1u, parts.step, vec2f(pixel) + 0.5);
}

fn shade(surface: Surface, s: Segment) -> vec3f {
    let draw = surface.draw;
    let yarn = yarns[draws[draw].yarn];
    let material = materials[draws[draw].material];
    let view = direction_to_viewer(frame.viewer, surface.position);
    let section = section_point(yarn, s, surface.point, surface.position);
    var radiance = vec3f(0.0);
    for (var i = 0u; i < frame.light_count; i++) {
        let light = lights[i];
        let incident = incident_light(light, surface.position);
        if all(incident.irradiance <= vec3f(0.0)) {
            continue;
        }
        let open = self_shadow(yarn, section, incident.direction) * light_shadow(light, incident, surface.point, surface.position);
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
    return radiance + ambient * frame.ambient * self_occlusion(yarn, section) * sky_shadow(surface.point, surface.position);
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
        let surface = surface_at(key, id.xy);
        let s = segment_at(surface.draw, key_parts(key).segment);
        color = vec4f(shade(surface, s), 1.0);
        normal = vec4f(surface.normal, 0.0);
        tangent = vec4f(surface.tangent, 0.0);
        if first {
            normal.w = to_pixel(frame.pixel_from_render, surface.position).w;
            tangent.w = f32(draws[surface.draw].object_id);
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
