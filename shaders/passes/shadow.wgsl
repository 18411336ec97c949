// How it works: yarns as opaque tubes [WuYuksel2018 §4.1], as thick as what they take of the light, rasterised like fibers into depth maps, one layer of the
// dispatch (or some that share the work) for each view. Larger is nearer to the light; 0 is empty. Loops are as in visibility_fibers.wgsl.

@group(0) @binding(11) var<storage, read_write> shadow_depths: array<atomic<u32>>;

struct ShadowPass {
    first_view: u32,
    // Threads that share a segment; a power of two.
    parts: u32,
    padding_0: u32,
    padding_1: u32,
}
@group(0) @binding(16) var<uniform> shadow_pass: ShadowPass;

// A tube between two points; `radii` are those in space.
fn draw_tube(view: ShadowView, line: Line, radii: vec2f, base: u32, parts: Parts) {
    let walk = line_walk(line, vec2f(0.0), vec2f(f32(frame.shadow_resolution)));
    var place = walk_begin(walk, parts);
    loop {
        let texel = walk_pixel(walk, place);
        let hit = line_hit(line, vec2f(texel) + 0.5);
        // A tube bulges towards the light, aside of the axis of a wide view.
        let cosine = axis_cosine(view, vec2f(texel) + 0.5);
        let bulge = cosine * hit.bulge / hit.radius * mix(radii.x, radii.y, hit.t);
        let depth = line_depth(line, line_share(line, hit.t)) - bulge;
        let nearness = clamp(1.0 - (depth - view.depth_min) * view.depth_scale, 0.0, 1.0);
        if walk_is_on_pixel(walk, place) && hit.covered {
            // Non-negative floats order like their bits.
            atomicMax(&shadow_depths[base + u32(texel.y) * frame.shadow_resolution + u32(texel.x)], bitcast<u32>(nearness) & 0xfffffffeu);
        }
        place = walk_next(walk, place, parts);
        if place.i > walk.last {
            break;
        }
    }
}

@compute @workgroup_size(64)
fn shadow(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let segment = folded_index(workgroup, local, LANES);
    if segment >= frame.segment_count {
        return;
    }
    let view_index = shadow_pass.first_view + workgroup.z / shadow_pass.parts;
    let parts = Parts(shadow_pass.parts, workgroup.z % shadow_pass.parts);
    let view = shadow_views[view_index];
    let draw = find_draw(segment);
    let knot = draws[draw].first_knot + segment - draws[draw].first_segment;
    if !begins_segment(knot) {
        return;
    }
    let s = segment_at(draw, segment);
    let tube_radius = yarns[draws[draw].yarn].tube_radius;
    let orthographic = view.parallel == 1u;
    let base = view_index * frame.shadow_resolution * frame.shadow_resolution;
    let bend = length(s.position.c) + 3.0 * length(s.position.d);
    let start = to_pixel(view.texel_from_render, s.position.a);
    let bend_texels = 0.25 * bend * view.texels_per_unit / max(start.z, view.near);
    let steps = clamp(u32(ceil(sqrt(bend_texels))), 1u, 32u);
    var previous = start;
    var previous_radius = tube_radius * s.radius.x;
    var step = 1u;
    loop {
        let t = f32(step) / f32(steps);
        let next = to_pixel(view.texel_from_render, cubic_value(s.position, t));
        let next_radius = tube_radius * scalar_value(s.radius, t);
        if min(previous.w, next.w) > view.near {
            let line = make_line(
                LineEnd(previous.xy, previous.w, previous_radius * view.texels_per_unit / previous.z),
                LineEnd(next.xy, next.w, next_radius * view.texels_per_unit / next.z),
                orthographic,
            );
            draw_tube(view, line, vec2f(previous_radius, next_radius), base, parts);
        }
        previous = next;
        previous_radius = next_radius;
        step++;
        if step > steps {
            break;
        }
    }
}
