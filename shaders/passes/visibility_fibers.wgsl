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
    let lean = line_lean(line, orthographic);
    let thickness = lean / frame.pixels_per_unit;
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
    return Found(first, rest - before, (segment_work[first] >> WORK_BITS) & EXPONENT_MASK);
}

// What the fibers of a segment share.
struct Bundle {
    yarn: Yarn,
    segment: Segment,
    number: u32,
    scale: Scale,
    rates: Rates,
    steps: u32,
}

// Fibers of one ply that stay in it, by rank: the first, and one past the last.
fn draw_regular(b: Bundle, ply: u32, first: u32, last: u32, parts: Parts) {
    let seed = ply_seed(b.segment.seed, ply);
    let first_slot = ply * (b.yarn.fibers + 1u) + 1u;
    var start = screen_ply(b.yarn, b.segment, b.scale, 0.0, ply);
    var step = 1u;
    loop {
        let t0 = f32(step - 1u) / f32(b.steps);
        let t1 = f32(step) / f32(b.steps);
        let end = screen_ply(b.yarn, b.segment, b.scale, t1, ply);
        var rank = first;
        loop {
            // Both ends anew each step: an array of the last step's ends would be memory, dearer than they are.
            let fiber = fiber_at(b.yarn, seed, rank);
            let from_end = fiber_end(b.yarn, start, fiber, regular_section(b.yarn, b.segment, start.yarn, fiber));
            let to_end = fiber_end(b.yarn, end, fiber, regular_section(b.yarn, b.segment, end.yarn, fiber));
            if rank < last && is_in_view(from_end, to_end) {
                draw_between(from_end, to_end, t0, t1, key_owner(b.number, first_slot + rank), parts);
            }
            rank++;
            if rank >= last {
                break;
            }
        }
        start = end;
        step++;
        if step > b.steps || first >= last {
            break;
        }
    }
}

// Those that may fly away, of every so many plies.
struct Flyaways {
    first_ply: u32,
    plies: u32,
    // By rank: the first, and how many. At most CHUNK in all plies.
    first: u32,
    count: u32,
}

// In floating point, since a software driver divides integers one by one.
fn flyaway_turn(group: Flyaways, number: u32) -> u32 {
    return u32((f32(number) + 0.5) / f32(group.count));
}

fn flyaway_ply(group: Flyaways, number: u32) -> u32 {
    return group.first_ply + group.plies * flyaway_turn(group, number);
}

fn flyaway_at(b: Bundle, group: Flyaways, number: u32) -> Fiber {
    let rank = group.first + number - group.count * flyaway_turn(group, number);
    return fiber_at(b.yarn, ply_seed(b.segment.seed, flyaway_ply(group, number)), rank);
}

// One loop over all lines of all of them, since threads that run abreast wait for the one with most lines.
fn draw_flyaways(b: Bundle, group: Flyaways, parts: Parts) {
    let plies = (b.yarn.plies - group.first_ply + group.plies - 1u) / group.plies;
    let all = plies * group.count;
    var number = 0u;
    var step = 1u;
    var begin = 0.0;
    loop {
        let ply = flyaway_ply(group, number);
        let fiber = flyaway_at(b, group, number);
        let ends = vec2f(f32(step - 1u), f32(step)) / f32(b.steps);
        let lines = step_lines(b.yarn, b.segment, b.rates, fiber, b.scale.radius_pixels, ends.x, ends.y);
        let line = line_from(b.segment, fiber, lines, begin);
        let from_end = flyaway_end(b, ply, fiber, lines, begin);
        let to_end = flyaway_end(b, ply, fiber, lines, line.end);
        if is_in_view(from_end, to_end) && joined(from_end.piece, from_end.period, to_end.piece, to_end.period) {
            let slot = ply * (b.yarn.fibers + 1u) + 1u + fiber.rank;
            draw_between(from_end, to_end, begin, line.end, key_owner(b.number, slot), parts);
        }
        begin = line.next;
        step += select(0u, 1u, begin >= ends.y);
        if step > b.steps {
            number++;
            step = 1u;
            begin = 0.0;
        }
        if number >= all {
            break;
        }
    }
}

fn flyaway_end(b: Bundle, ply: u32, fiber: Fiber, lines: StepLines, t: f32) -> FiberEnd {
    let at = screen_ply(b.yarn, b.segment, b.scale, t, ply);
    return fiber_end(b.yarn, at, fiber, section_in(b.yarn, b.segment, at.yarn, fiber, period_on(b.segment, fiber, lines, at.yarn.length)));
}

@compute @workgroup_size(64)
fn visibility_fibers(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let item = folded_index(workgroup, local, LANES);
    if item >= dispatch[3] {
        return;
    }
    let found = find_segment(item);
    let draw = find_draw(found.segment);
    let yarn = yarns[draws[draw].yarn];
    let s = segment_at(draw, found.segment);
    let scale = scale_of(yarn, s);
    let rates = segment_rates(yarn, s);
    let bundle = Bundle(yarn, s, found.segment, scale, rates, fiber_steps(yarn, rates, scale.radius_pixels));
    // Items run over plies first, then over the threads that share a line, then over chunks.
    let count = most_fibers(yarn, scale);
    let plies = plies_apart(yarn.plies, count);
    let turn = found.item / plies;
    let parts = Parts(1u << found.parts_exponent, turn & ((1u << found.parts_exponent) - 1u));
    let first = (turn >> found.parts_exponent) * CHUNK;
    let last = min(first + CHUNK, count);
    // Those that may fly away have the first ranks.
    let first_regular = max(first, yarn.flyaway_fibers);
    let last_flyaway = min(last, yarn.flyaway_fibers);
    var ply = found.item % plies;
    loop {
        draw_regular(bundle, ply, first_regular, last, parts);
        ply += plies;
        if ply >= yarn.plies || first_regular >= last {
            break;
        }
    }
    if first < last_flyaway {
        draw_flyaways(bundle, Flyaways(found.item % plies, plies, first, last_flyaway - first), parts);
    }
}
