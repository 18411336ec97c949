// How it works: one thread draws a chunk of one ply's fibers along one segment, each as a chain of round-ended lines rasterised in software; each
// covered pixel keeps the largest key, that is the nearest fiber.

@group(0) @binding(14) var<storage, read> dispatch: array<u32, 8>;

// A view ray meets the surface of a fiber that leans towards the viewer this much farther from its centre line.
fn line_lean(line: Line, orthographic: bool) -> f32 {
    let w = select(line.a.depth, 1.0, orthographic);
    let across = sqrt(line.length_squared) * w / frame.pixels_per_unit;
    let along = line.b.depth - line.a.depth;
    return min(sqrt(1.0 + along * along / max(across * across, 1e-30)), MOST_LEAN);
}

// `rates`: of the depth at both ends, per whole line. `thickness`: depth of the fiber relative to its width on the screen.
fn draw_line(line: Line, rates: vec2f, thickness: f32, parts: Parts, segment: u32, slot: u32, t0: f32, t1: f32) {
    let orthographic = frame.viewer.w > 0.5;
    let lean = line_lean(line, orthographic);
    let walk = line_walk(line, vec2f(frame.origin), vec2f(frame.origin + frame.size));
    for (var i = first_turn(walk.first, parts); i <= walk.last; i += i32(parts.count)) {
        let span = line_span(line, walk, i);
        for (var j = span.x; j <= span.y; j++) {
            let pixel = select(vec2i(j, i), vec2i(i, j), walk.flat);
            let hit = line_hit(line, vec2f(pixel) + 0.5);
            if hit.covered {
                let depth = line_depth(line, hit.t, orthographic);
                // Equal steps on the screen are not equal steps in depth.
                let share = select(hit.t * depth / line.b.depth, hit.t, orthographic);
                let place = u32(mix(t0, t1, share) * place_scale() + 0.5);
                let behind = depth_beyond_chord(rates.x, rates.y, line.b.depth - line.a.depth, share);
                // The fiber is round: its surface is nearer than its centre line.
                let w = select(depth, 1.0, orthographic);
                let bulge = hit.bulge * thickness * lean * hit.radius * w / frame.pixels_per_unit;
                store_key(tile_index(pixel), make_key(depth + behind - bulge, segment, slot, place));
            }
        }
    }
}

// The segment whose work contains an item, and how far into it the item is.
struct Found {
    segment: u32,
    item: u32,
    parts_exponent: u32,
}

fn find_segment(item: u32) -> Found {
    var low = 0u;
    var high = (frame.segment_count + BLOCK - 1u) / BLOCK;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if block_work[middle] <= item {
            low = middle;
        } else {
            high = middle;
        }
    }
    let rest = item - block_work[low];
    // The first segment of the block whose inclusive sum exceeds the rest.
    var first = low * BLOCK;
    var last = min(first + BLOCK, frame.segment_count) - 1u;
    while first < last {
        let middle = (first + last) / 2u;
        if (segment_work[middle] & WORK_MASK) > rest {
            last = middle;
        } else {
            first = middle + 1u;
        }
    }
    let before = select(0u, segment_work[max(first, 1u) - 1u] & WORK_MASK, first > low * BLOCK);
    return Found(first, rest - before, segment_work[first] >> WORK_BITS);
}

@compute @workgroup_size(64)
fn visibility_fibers(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = frame_buffer;
    let item = folded_index(workgroup, local, LANES);
    if item >= dispatch[3] {
        return;
    }
    let found = find_segment(item);
    let segment = found.segment;
    let draw = find_draw(segment);
    let yarn = yarns[draws[draw].yarn];
    // Items run over plies first, then over the threads that share a line, then over chunks.
    let ply = found.item % yarn.plies;
    let turn = found.item / yarn.plies;
    let parts = Parts(1u << found.parts_exponent, turn & ((1u << found.parts_exponent) - 1u));
    let first = (turn >> found.parts_exponent) * CHUNK;
    let s = segment_at(draw, segment);
    let scale = scale_of(yarn, s);
    let last = min(first + CHUNK, most_fibers(yarn, scale));
    let steps = fiber_steps(yarn, s, first, scale.radius_pixels);
    let seed = ply_seed(s.seed, ply);
    let first_slot = ply * (yarn.fibers + 1u) + 1u;
    var previous: array<FiberEnd, CHUNK>;
    for (var step = 0u; step <= steps; step++) {
        let t = f32(step) / f32(steps);
        let before = f32(step) / f32(steps) - 1.0 / f32(steps);
        let p = yarn_point(s, t);
        let q = ply_point(yarn, s, p, ply);
        let detail = mix_detail(scale.ends, t);
        for (var index = first; index < last; index++) {
            let a = previous[index - first];
            let b = fiber_end(yarn, s, detail, p, q, fiber_at(yarn, seed, index));
            previous[index - first] = b;
            if step > 0u && max(a.line.radius, b.line.radius) > 0.0 && min(a.line.depth, b.line.depth) > frame.near
                && joined(a.piece, a.period, b.piece, b.period) {
                draw_line(make_line(a.line, b.line), vec2f(a.depth_rate, b.depth_rate) / f32(steps), 1.0 / max(a.width, 1.0), parts, segment, first_slot + index, before, t);
            }
        }
    }
}
