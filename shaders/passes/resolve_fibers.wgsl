// How it works: one thread a pixel that shows a fiber. It takes the winning key apart, evaluates that fiber again where the
// pixel lies on it, shades it, and adds one sample to the film.

@group(0) @binding(21) var<storage, read> resolve_dispatch: array<u32, 8>;

// The drawn chord lies beside the curve by up to a quarter of a pixel, and always on the side that the curve bends to. Offsets are measured from it, by its
// second derivatives: from the curve, more of them would be on that side, and fibers as wide as a pixel up to a tenth too dark under light from another. Of a
// fiber thinner than a quarter of a pixel, what is left of the difference may be more than its width, and is folded back, where every offset is as likely.
fn is_thin(radius_pixels: f32) -> bool {
    return radius_pixels < CHORD_ERROR;
}

fn within_fiber(offset: f32, radius_pixels: f32) -> f32 {
    let folded = abs(fract(0.25 * offset + 0.75) * 4.0 - 2.0) - 1.0;
    return select(clamp(offset, -1.0, 1.0), folded, is_thin(radius_pixels));
}

// From a fiber's point to its chord, from one parameter to another, at the same parameter.
fn to_chord(f: FiberPoint, t: f32, line: vec2f) -> vec3f {
    return f.acceleration * (0.5 * max(t - line.x, 0.0) * max(line.y - t, 0.0));
}

fn fiber_surface(s: Segment, yarn: Yarn, ply: u32, rank: u32, parts: KeyParts, pixel: vec2f) -> Surface {
    let t = f32(parts.place) / place_scale();
    let p = yarn_point(s, t);
    let q = ply_point(yarn, s, p, ply);
    let fiber = fiber_at(yarn, ply_seed(s.seed, ply), rank);
    let f = fiber_point(yarn, s, p, q, fiber);
    let scale = scale_of(yarn, s);
    let width = width_factor(yarn, share_at(scale, t), rank, f.taper);
    let radius_pixels = max(pixels_at(f.position, yarn.fiber_radius * p.radius * width), 1e-20);
    let beside = to_chord(f, t, line_about(yarn, s, segment_rates(yarn, s), fiber, scale.radius_pixels, t));
    let at = to_pixel(frame.pixel_from_render, f.position + beside);
    // The pixel relative to the fiber on the screen: along it, what is left of the place's rounding; across it, the offset.
    let moved = (frame.pixel_from_render * vec4f(f.velocity, 0.0)).xyz;
    let on_screen = (moved.xy - at.xy * moved.z) / at.z;
    let speed = max(length(on_screen), 1e-20);
    let to_pixel_center = pixel - at.xy;
    let rest = clamp(dot(to_pixel_center, on_screen) / (speed * speed), -1.0 / place_scale(), 1.0 / place_scale());
    let across = (to_pixel_center.x * on_screen.y - to_pixel_center.y * on_screen.x) / speed;
    let offset = within_fiber(across / radius_pixels, radius_pixels);
    let center = f.position + f.velocity * rest;
    let view = direction_to_viewer(frame.viewer, center);
    // Where the view ray meets the fiber's surface: nearer to the viewer than its centre line, and if that leans, beside a place of it farther along. No farther than
    // its radius: what points at the viewer may have bent away by then, and so have loops and hairs.
    let radius = yarn.fiber_radius * p.radius * width;
    let straight = normalize(f.velocity);
    let sine = max(length(cross(straight, view)), 1e-6);
    let rise = radius * sqrt(max(1.0 - offset * offset, 0.0));
    let nearer = rise * min(1.0 / sine, MOST_LEAN);
    let farther = select(rise * clamp(dot(straight, view) / sine, -1.0, 1.0), 0.0, rank < yarn.flyaway_fibers);
    let tangent = normalize(f.velocity + f.acceleration * (farther / max(length(f.velocity), 1e-20)));
    // Render-space direction that the offset grows in: (y, -x) of the fiber's direction on the screen.
    let side = cross(tangent, view);
    let side_on_screen = frame.pixel_from_render * vec4f(side, 0.0);
    let grows = dot(side_on_screen.xy - at.xy * side_on_screen.z, vec2f(on_screen.y, -on_screen.x)) >= 0.0;
    let normal = fiber_normal(tangent, side * select(-1.0, 1.0, grows), view, offset);
    let outward = side * (select(-1.0, 1.0, grows) * offset / max(length(side), 1e-6));
    let position = center + radius * outward + view * nearer;
    let winding = q.angle_rate * p.radius / max(dot(p.velocity, p.tangent), 1e-20);
    return Surface(Tube(p.position, p.radius, p.tangent), q.radial, q.tangential, winding, position, tangent, normal, parts.segment, t);
}

@compute @workgroup_size(64)
fn resolve_fibers(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let item = folded_index(workgroup, local, RESOLVE_LANES);
    if item >= resolve_dispatch[FIBER_LIST + 3u] {
        return;
    }
    let index = pixel_list[item];
    let pixel = frame.origin + vec2u(index % frame.size.x, index / frame.size.x);
    let winner = winner_at(index);
    let yarn = yarns[draws[winner.draw].yarn];
    let s = segment_at(winner.draw, winner.parts.segment);
    add_surface(index, winner.draw, fiber_surface(s, yarn, winner.ply, winner.slot - 1u, winner.parts, vec2f(pixel) + 0.5));
}
