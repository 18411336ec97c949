// How it works: one thread a pixel that shows a core fiber. It takes the winning key apart, evaluates that core again where the
// pixel lies on it, shades it, and adds one sample to the film.

@group(0) @binding(21) var<storage, read> resolve_dispatch: array<u32, 8>;

// Segments; where points repeat, they may have no length at all.
const MOST_AHEAD: f32 = 1e3;

// Direction of a yarn `ahead` of where it is `tangent`, as it bends there; no farther than half way round a corner.
fn bent(tangent: vec3f, bending: vec3f, ahead: f32) -> vec3f {
    let most = 1.0 / max(length(bending), 1e-20);
    let direction = tangent + bending * clamp(ahead, -most, most);
    return direction / max(length(direction), 1e-20);
}

// What a vector becomes that turns with an axis, without turning about it.
fn carried(v: vec3f, axis: vec3f, new_axis: vec3f) -> vec3f {
    let turning = cross(axis, new_axis);
    let once = cross(turning, v);
    return v + once + cross(turning, once) / (1.0 + dot(axis, new_axis));
}

fn core_surface(s: Segment, yarn: Yarn, ply: u32, parts: KeyParts, pixel: vec2u) -> Surface {
    let step = parts.place;
    let scale = scale_of(yarn, s);
    let steps = core_steps(yarn, s, scale.radius_pixels);
    let t0 = f32(step - 1u) / f32(steps);
    let t1 = f32(step) / f32(steps);
    let a = core_end(core_point(yarn, s, yarn_point(s, t0), ply, frame.viewer));
    let b = core_end(core_point(yarn, s, yarn_point(s, t1), ply, frame.viewer));
    let hit = core_hit(a, b, vec2f(pixel) + 0.5);
    let t = mix(t0, t1, hit.t);
    let texel = core_shown(yarn, hit, share_at(scale, t), core_chance(pixel)).texel;
    let surface = core_surface_at(yarn, texel);
    let slopes = core_slopes_at(yarn, texel, hit.turns);
    // The step may be a long chord: what is shaded lies where the curve is.
    let p = yarn_point(s, t);
    let c = core_point(yarn, s, p, ply, frame.viewer);
    let offset = c.toward * surface.height + c.across * hit.v;
    // The fiber's axis turns with the ply, not its surface: that lies before it, and to a side.
    let radius = yarn.fiber_radius * p.radius;
    let bulge = radius * sqrt(max(1.0 - surface.offset * surface.offset, 0.0));
    // No ply is thinner than a fiber, but where points repeat it may have no section at all.
    let thinnest = max(radius, 1e-20);
    let below = offset - c.toward * (bulge / max(length(c.toward), thinnest));
    let axis = below - c.across * (surface.offset * radius / max(c.half_width, thinnest));
    let winding = (c.toward * slopes.x + c.across * slopes.y) * c.fiber_rate;
    let turning = c.ply.radial_rate * dot(axis, c.ply.radial) + c.ply.tangential_rate * dot(axis, c.ply.tangential);
    let straight = normalize(c.velocity + turning + winding);
    let view = direction_to_viewer(frame.viewer, c.center);
    // Where the view ray meets the fiber's surface, as in resolve_fibers.wgsl.
    let nearer = core_nearness(c, below, view) + bulge * min(1.0 / max(length(cross(straight, view)), 1e-6), MOST_LEAN);
    let position = c.center + c.side * dot(offset, c.side) + view * nearer;
    // Seen at a slant, that is in another section than the centre of the ply, in which the ply has turned and the yarn has bent.
    let per_length = 1.0 / max(dot(c.velocity, p.tangent), thinnest);
    let bending = -(p.normal * dot(p.normal_rate, p.tangent) + p.binormal * dot(p.binormal_rate, p.tangent));
    let about = nearer * per_length * dot(view, p.tangent);
    let ahead = clamp(nearer * per_length * dot(view, bent(p.tangent, bending, about)), -MOST_AHEAD, MOST_AHEAD);
    let axis_tangent = bent(p.tangent, bending, ahead);
    let turned = vec2f(cos(c.ply.angle_rate * ahead), sin(c.ply.angle_rate * ahead));
    let radial = carried(c.ply.radial * turned.x + c.ply.tangential * turned.y, p.tangent, axis_tangent);
    let tangential = carried(c.ply.tangential * turned.x - c.ply.radial * turned.y, p.tangent, axis_tangent);
    let tangent = carried(straight, p.tangent, axis_tangent);
    let normal = fiber_normal(tangent, c.side, view, surface.offset);
    let tube = Tube(p.position + (p.velocity + 0.5 * ahead * p.acceleration) * ahead, p.radius, axis_tangent);
    return Surface(tube, radial, tangential, c.ply.angle_rate * per_length * p.radius, position, tangent, normal, parts.segment, t);
}

@compute @workgroup_size(64)
fn resolve_cores(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let item = folded_index(workgroup, local, RESOLVE_LANES);
    if item >= resolve_dispatch[CORE_LIST + 3u] {
        return;
    }
    let index = pixel_list[frame.size.x * frame.size.y - 1u - item];
    let pixel = frame.origin + vec2u(index % frame.size.x, index / frame.size.x);
    let winner = winner_at(index);
    let yarn = yarns[draws[winner.draw].yarn];
    let s = segment_at(winner.draw, winner.parts.segment);
    add_surface(index, winner.draw, core_surface(s, yarn, winner.ply, winner.parts, pixel));
}
