// How it works: one thread draws the core fibers of one segment. A pixel takes the height of its texel, or nothing in a hole.
// Loops are as in visibility_fibers.wgsl.

fn draw_core(yarn: Yarn, parts: Parts, scale: Scale, t0: f32, t1: f32, a: CoreEnd, b: CoreEnd, segment: u32, slot: u32, step: u32) {
    let orthographic = frame.viewer.w > 0.5;
    let line = make_line(
        LineEnd(a.position, a.depth, a.half_width * core_half_width(yarn, a.aspect)),
        LineEnd(b.position, b.depth, b.half_width * core_half_width(yarn, b.aspect)),
        orthographic,
    );
    let chord = b.depth - a.depth;
    let owner = key_owner(segment, slot);
    let to_a = a.side * line.a.radius;
    let to_b = b.side * line.b.radius;
    let corners = array<vec2f, 4>(a.position - to_a, a.position + to_a, b.position + to_b, b.position - to_b);
    let walk = quad_walk(corners, vec2f(frame.origin), vec2f(frame.origin + frame.size));
    var place = quad_begin(walk, parts);
    loop {
        let pixel = vec2i(place.span.x, place.i);
        let hit = core_hit(a, b, vec2f(pixel) + 0.5);
        if quad_is_on_pixel(walk, place) && hit.covered && abs(hit.v) <= core_half_width(yarn, hit.aspect) {
            let share = share_at(scale, mix(t0, t1, hit.t));
            let height = core_shown(yarn, hit, share, core_chance(vec2u(pixel))).height;
            var key = Key(0u, 0u);
            if height > CORE_HOLE {
                let nearer = height * mix(a.depth_h, b.depth_h, hit.t) + hit.v * mix(a.depth_v, b.depth_v, hit.t);
                let behind = depth_beyond_chord(a.depth_rate * (t1 - t0) - chord, b.depth_rate * (t1 - t0) - chord, hit.t);
                let depth = line_depth(line, line_share(line, hit.t)) + behind - nearer;
                key = make_key(owner, depth, step);
            }
            if key.high != 0u {
                store_key(tile_index(pixel), key);
            }
        }
        place = quad_next(walk, place, parts);
        if place.i > walk.last {
            break;
        }
    }
}

@compute @workgroup_size(64)
fn visibility_cores(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let segment = folded_index(workgroup, local, LANES);
    if segment >= frame.segment_count {
        return;
    }
    if (segment_work[segment] & IS_IN_VIEW) == 0u {
        return;
    }
    let draw = find_draw(segment);
    let yarn = yarns[draws[draw].yarn];
    let s = segment_at(draw, segment);
    let scale = scale_of(yarn, s);
    if min(scale.shares.x, scale.shares.y) >= 1.0 {
        return;
    }
    let steps = core_steps(yarn, s, scale.radius_pixels);
    let parts = Parts(frame.core_parts, workgroup.z);
    var begin = yarn_point(s, 0.0);
    var step = 1u;
    loop {
        let t0 = f32(step - 1u) / f32(steps);
        let t1 = f32(step) / f32(steps);
        let end = yarn_point(s, t1);
        var ply = 0u;
        loop {
            // Both ends anew each step: an array of the last step's ends would be memory, dearer than they are.
            let a = core_end(core_point(yarn, s, begin, ply, frame.viewer));
            let b = core_end(core_point(yarn, s, end, ply, frame.viewer));
            if min(a.depth, b.depth) > frame.near {
                draw_core(yarn, parts, scale, t0, t1, a, b, segment, ply * (yarn.fibers + 1u), step);
            }
            ply++;
            if ply >= yarn.plies {
                break;
            }
        }
        begin = end;
        step++;
        if step > steps {
            break;
        }
    }
}
