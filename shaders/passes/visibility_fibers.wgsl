// How it works: one thread draws one fiber of one segment, as a chain of round-ended lines rasterised in software; each
// covered pixel keeps the largest key, that is the nearest fiber.

@group(0) @binding(14) var<storage, read> dispatch: array<u32, 8>;

fn draw_line(line: Line, segment: u32, slot: u32, step: u32) {
    let orthographic = frame.viewer.w > 0.5;
    let walk = line_walk(line, vec2f(frame.size));
    for (var i = walk.first; i <= walk.last; i++) {
        let span = line_span(line, walk, i);
        for (var j = span.x; j <= span.y; j++) {
            let pixel = select(vec2i(j, i), vec2i(i, j), walk.flat);
            let hit = line_hit(line, vec2f(pixel) + 0.5);
            if hit.covered {
                let depth = line_depth(line, hit.t, orthographic);
                // The fiber is round: its surface is nearer than its centre line.
                let w = select(depth, 1.0, orthographic);
                let bulge = sqrt(max(1.0 - hit.offset * hit.offset, 0.0)) * hit.radius * w / frame.pixels_per_unit;
                store_key(u32(pixel.y) * frame.size.x + u32(pixel.x), make_key(depth - bulge, segment, slot, step));
            }
        }
    }
}

// The segment whose work contains an item, and how far into it the item is.
fn find_segment(item: u32) -> vec2u {
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
        if segment_work[middle] > rest {
            last = middle;
        } else {
            first = middle + 1u;
        }
    }
    let before = select(0u, segment_work[max(first, 1u) - 1u], first > low * BLOCK);
    return vec2u(first, rest - before);
}

@compute @workgroup_size(64)
fn visibility_fibers(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let item = folded_index(workgroup, local, LANES);
    if item >= dispatch[3] {
        return;
    }
    let found = find_segment(item);
    let segment = found.x;
    let draw = find_draw(segment);
    let yarn = yarns[draws[draw].yarn];
    let ply = found.y % yarn.plies;
    let index = found.y / yarn.plies;
    let ends = detail_ends(yarn, draw, segment);
    if index >= max(fiber_count(yarn, ends[0]), fiber_count(yarn, ends[1])) {
        return;
    }
    let s = segment_at(draw, segment);
    let fiber = fiber_at(yarn, s.seed, ply, index);
    let steps = fiber_steps(yarn, s, segment_radius_pixels(s));
    let slot = ply * (yarn.fibers + 1u) + 1u + index;
    var previous = fiber_end(yarn, s, ends, ply, fiber, 0.0);
    for (var step = 1u; step <= steps; step++) {
        let next = fiber_end(yarn, s, ends, ply, fiber, f32(step) / f32(steps));
        if previous.visible && next.visible && joined(previous.fiber, next.fiber) && max(previous.line.radius, next.line.radius) > 0.0 {
            draw_line(make_line(previous.line, next.line), segment, slot, step);
        }
        previous = next;
    }
}
