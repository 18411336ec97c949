// How it works: one thread draws a chunk of one ply's fibers along one segment, each as a chain of round-ended lines rasterised in software; each
// covered pixel keeps the largest key, that is the nearest fiber.
//
// Loops end with the test whether to go on: where it comes first, as a `for` has it, a software driver goes through the body once more, with no
// thread left, since it skips nothing.

@group(0) @binding(14) var<storage, read> dispatch: array<u32, 8>;

// A view ray meets the surface of a fiber that leans towards the viewer this much farther from its centre line.
fn line_lean(line: Line, orthographic: bool) -> f32 {
    let w = select(line.a.depth, 1.0, orthographic);
    let across = length(line.direction) * w / frame.pixels_per_unit;
    let along = line.b.depth - line.a.depth;
    return min(sqrt(1.0 + along * along / max(across * across, 1e-30)), MOST_LEAN);
}

// A fiber between two of its ends: what its pixels share.
struct Stroke {
    owner: Key,
    // Place along the segment at a, and on to b.
    place: f32,
    place_span: f32,
    // Of the depth at the ends, per whole line, beside those of the chord.
    rate_a: f32,
    rate_b: f32,
    // Depth that the fiber's surface is before its centre line, per pixel of bulge, at both ends.
    bulge_a: f32,
    bulge_b: f32,
    // Factor on it past an end: a ball bulges as far from every side, and lies within the tube; farther out it would hide the next line's.
    past_end: f32,
}

fn stroke_key(line: Line, stroke: Stroke, hit: LineHit) -> Key {
    let share = line_share(line, hit.t);
    let behind = depth_beyond_chord(stroke.rate_a, stroke.rate_b, share);
    let along = select(stroke.past_end, 1.0, hit.t > 0.0 && hit.t < 1.0);
    let bulge = hit.bulge * along * mix(stroke.bulge_a, stroke.bulge_b, share);
    let place = u32(stroke.place + share * stroke.place_span);
    return make_key(stroke.owner, line_depth(line, share) + behind - bulge, place);
}

fn draw_line(line: Line, stroke: Stroke, parts: Parts) {
    let walk = line_walk(line, vec2f(frame.origin), vec2f(frame.origin + frame.size));
    var place = walk_begin(walk, parts);
    loop {
        if walk_is_on_pixel(walk, place) {
            let pixel = walk_pixel(walk, place);
            let hit = line_hit(line, vec2f(pixel) + 0.5);
            // The software driver stores one thread's key after the other: chosen before, it is made for all of them at once.
            var key = Key(0u, 0u);
            if hit.covered {
                key = stroke_key(line, stroke, hit);
            }
            if key.high != 0u {
                store_key(tile_index(pixel), key);
            }
        }
        place = walk_next(walk, place, parts);
        if place.i > walk.last {
            break;
        }
    }
}

// A fiber's line between two parameters.
fn draw_between(a: FiberEnd, b: FiberEnd, begin: f32, to: f32, owner: Key, parts: Parts) {
    let orthographic = frame.viewer.w > 0.5;
    let line = make_line(a.line, b.line, orthographic);
    let chord = b.line.depth - a.line.depth;
    // Of its own width, the fiber is round: where it stands for several, it is flatter.
    let lean = line_lean(line, orthographic);
    let thickness = lean / (max(a.width, 1.0) * frame.pixels_per_unit);
    let stroke = Stroke(
        owner,
        begin * place_scale() + 0.5,
        (to - begin) * place_scale(),
        a.depth_rate * (to - begin) - chord,
        b.depth_rate * (to - begin) - chord,
        thickness * select(a.line.depth, 1.0, orthographic),
        thickness * select(b.line.depth, 1.0, orthographic),
        1.0 / lean,
    );
    draw_line(line, stroke, parts);
}

fn is_in_view(a: FiberEnd, b: FiberEnd) -> bool {
    return max(a.line.radius, b.line.radius) > 0.0 && min(a.line.depth, b.line.depth) > frame.near;
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
    let rates = segment_rates(yarn, s);
    let steps = fiber_steps(yarn, rates, scale.radius_pixels);
    let seed = ply_seed(s.seed, ply);
    let first_slot = ply * (yarn.fibers + 1u) + 1u;
    // Those that may fly away have the first ranks.
    let first_regular = max(first, yarn.flyaway_fibers);
    var start = screen_ply(yarn, s, scale.ends, 0.0, ply);
    var step = 1u;
    loop {
        let t0 = f32(step - 1u) / f32(steps);
        let t1 = f32(step) / f32(steps);
        let end = screen_ply(yarn, s, scale.ends, t1, ply);
        var rank = first_regular;
        loop {
            // Both ends anew each step: an array of the last step's ends would be memory, dearer than they are.
            let fiber = fiber_at(yarn, seed, rank);
            let a = fiber_end(yarn, start, fiber, regular_section(yarn, s, start.yarn, fiber));
            let b = fiber_end(yarn, end, fiber, regular_section(yarn, s, end.yarn, fiber));
            if rank < last && is_in_view(a, b) {
                draw_between(a, b, t0, t1, key_owner(segment, first_slot + rank), parts);
            }
            rank++;
            if rank >= last {
                break;
            }
        }
        start = end;
        step++;
        if step > steps || first_regular >= last {
            break;
        }
    }
    let last_flyaway = min(last, yarn.flyaway_fibers);
    var rank = first;
    loop {
        let fiber = fiber_at(yarn, seed, rank);
        var at = screen_ply(yarn, s, scale.ends, 0.0, ply);
        var a = fiber_end(yarn, at, fiber, fiber_section(yarn, s, at.yarn, fiber));
        var begin = 0.0;
        step = 1u;
        loop {
            let t1 = f32(step) / f32(steps);
            let to = line_end(yarn, s, rates, fiber, scale.radius_pixels, begin, t1);
            at = screen_ply(yarn, s, scale.ends, to, ply);
            let b = fiber_end(yarn, at, fiber, fiber_section(yarn, s, at.yarn, fiber));
            if rank < last_flyaway && is_in_view(a, b) && joined(a.piece, a.period, b.piece, b.period) {
                draw_between(a, b, begin, to, key_owner(segment, first_slot + rank), parts);
            }
            a = b;
            begin = to;
            step += select(0u, 1u, to >= t1);
            if step > steps || rank >= last_flyaway {
                break;
            }
        }
        rank++;
        if rank >= last_flyaway {
            break;
        }
    }
}
