// How it works: one thread a pixel that shows a core fiber. It takes the winning key apart, evaluates that core again where the
// pixel lies on it, shades it, and adds one sample to the film.

@group(0) @binding(21) var<storage, read> resolve_dispatch: array<u32, 8>;

fn core_surface(s: Segment, yarn: Yarn, ply: u32, step: u32, pixel: vec2u) -> Surface {
    let scale = scale_of(yarn, s);
    let steps = core_steps(yarn, s, scale.radius_pixels);
    let t0 = f32(step - 1u) / f32(steps);
    let t1 = f32(step) / f32(steps);
    let pa = yarn_point(s, t0);
    let pb = yarn_point(s, t1);
    let ca = core_point(yarn, s, pa, ply, frame.viewer);
    let cb = core_point(yarn, s, pb, ply, frame.viewer);
    let hit = core_hit(core_end(ca), core_end(cb), vec2f(pixel) + 0.5);
    // Steps are short: in between, everything is as good as linear.
    let fibers = mix_detail(scale.ends, mix(t0, t1, hit.t)).fibers;
    let texel = core_texel(yarn, core_texture(yarn, hit.depth_share, fibers, core_chance(pixel)), hit.turns, hit.v);
    let surface = core_surface_at(texel);
    let slopes = core_slopes_at(yarn, texel);
    let toward = mix(ca.toward, cb.toward, hit.t);
    let across = mix(ca.across, cb.across, hit.t);
    let radial = normalize(mix(ca.ply.radial, cb.ply.radial, hit.t));
    let tangential = normalize(mix(ca.ply.tangential, cb.ply.tangential, hit.t));
    let offset = toward * surface.height + across * hit.v;
    let winding = (toward * slopes.x + across * slopes.y) * mix(ca.fiber_rate, cb.fiber_rate, hit.t);
    let turning = mix(ca.ply.radial_rate, cb.ply.radial_rate, hit.t) * dot(offset, radial)
        + mix(ca.ply.tangential_rate, cb.ply.tangential_rate, hit.t) * dot(offset, tangential);
    let tangent = normalize(mix(ca.velocity, cb.velocity, hit.t) + turning + winding);
    let center = mix(ca.center, cb.center, hit.t);
    let view = direction_to_viewer(frame.viewer, center);
    let normal = fiber_normal(tangent, mix(ca.side, cb.side, hit.t), view, surface.offset);
    let tube = Tube(
        mix(pa.position, pb.position, hit.t),
        mix(pa.radius, pb.radius, hit.t),
        normalize(mix(pa.tangent, pb.tangent, hit.t)),
    );
    return Surface(tube, radial, tangential, center + offset, tangent, normal);
}

@compute @workgroup_size(64)
fn resolve_cores(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let item = folded_index(workgroup, local, RESOLVE_LANES);
    if item >= resolve_dispatch[CORE_LIST + 3u] {
        return;
    }
    let index = pixel_list[frame.size.x * frame.size.y - 1u - item];
    let pixel = frame.origin + vec2u(index % frame.size.x, index / frame.size.x);
    let winner = winner_at(index);
    let yarn = yarns[draws[winner.draw].yarn];
    let s = segment_at(winner.draw, winner.parts.segment);
    add_surface(index, winner.draw, core_surface(s, yarn, winner.ply, winner.parts.place, pixel));
}
