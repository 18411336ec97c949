// How it works: one thread a segment. A segment outside of the view gets no work; otherwise as many items as chunks of the
// fibers that its level of detail asks for. A scan over blocks (scan.wgsl) turns the counts into positions, so that the order of work,
// and with it everything that follows, depends on geometry alone.

// Dispatch of the visibility pass; at 5 the number of (segment, fiber) pairs to draw, at 6 that of their lines, in two words.
@group(0) @binding(14) var<storage, read_write> dispatch: array<atomic<u32>, 8>;

var<workgroup> sums: array<u32, BLOCK>;
// At most some 2³¹: 60,000 fibers a yarn, MOST_STEPS lines each.
var<workgroup> fibers: atomic<u32>;
var<workgroup> lines: atomic<u32>;

// Whether the sphere hull of a segment's Bézier points lies outside of one border of the region.
fn outside(plane: vec4f, hull: array<vec3f, 4>, radius: f32) -> bool {
    let margin = -radius * length(plane.xyz);
    for (var i = 0u; i < 4u; i++) {
        if dot(plane, vec4f(hull[i], 1.0)) >= margin {
            return false;
        }
    }
    return true;
}

struct Work {
    items: u32,
    parts_exponent: u32,
    fibers: u32,
    lines: u32,
    // IS_IN_VIEW or 0.
    in_view: u32,
}

const NO_WORK = Work(0u, 0u, 0u, 0u, 0u);

fn work_of(segment: u32) -> Work {
    let draw = find_draw(segment);
    let knot = draws[draw].first_knot + segment - draws[draw].first_segment;
    if !begins_segment(knot) {
        return NO_WORK;
    }
    let s = segment_at(draw, segment);
    let p1 = s.position.a;
    let p2 = s.end.xyz;
    let end_velocity = s.position.b + 2.0 * s.position.c + 3.0 * s.position.d;
    let hull = array<vec3f, 4>(p1, p1 + s.position.b / 3.0, p2 - end_velocity / 3.0, p2);
    let yarn = yarns[draws[draw].yarn];
    let radius = yarn.bound * max(s.radius.x, s.end.w);
    let rows = transpose(frame.pixel_from_render);
    let low = vec2f(frame.origin) - frame.cull_margin;
    let high = vec2f(frame.origin + frame.size) + frame.cull_margin;
    if outside(rows[0] - rows[2] * low.x, hull, radius) || outside(rows[2] * high.x - rows[0], hull, radius)
        || outside(rows[1] - rows[2] * low.y, hull, radius) || outside(rows[2] * high.y - rows[1], hull, radius)
        || outside(rows[3] - vec4f(0.0, 0.0, 0.0, frame.near), hull, radius) {
        return NO_WORK;
    }
    let scale = scale_of(yarn, s);
    let count = most_fibers(yarn, scale);
    let items = plies_apart(yarn.plies, count) * ((count + CHUNK - 1u) / CHUNK);

    let rates = segment_rates(yarn, s);
    let lines = lines_about(yarn, rates, scale.radius_pixels);
    let width = 2.0 * yarn.fiber_radius * scale.radius_pixels + 2.0;
    let chord = length(p2 - p1) * scale.radius_pixels / max(min(s.radius.x, s.end.w), 1e-30);
    let length = min(1.5 * chord, 2.0 * f32(frame.size.x + frame.size.y)) + lines * width;
    var exponent = parts_exponent(f32(CHUNK) * length, width);
    while (items << exponent) > MOST_ITEMS && exponent > 0u {
        exponent--;
    }
    let fibers = yarn.plies * count;
    return Work(items << exponent, exponent, fibers, fibers * fiber_steps(yarn, rates, scale.radius_pixels), IS_IN_VIEW);
}

@compute @workgroup_size(256)
fn cull(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let segment = folded_index(workgroup, local, BLOCK);
    var work = NO_WORK;
    if segment < frame.segment_count {
        work = work_of(segment);
    }
    sums[local] = work.items;
    // A software driver adds the numbers of one thread after the other.
    if work.fibers > 0u {
        atomicAdd(&fibers, work.fibers);
        atomicAdd(&lines, work.lines);
    }
    for (var reach = 1u; reach < BLOCK; reach *= 2u) {
        workgroupBarrier();
        var add = 0u;
        if local >= reach {
            add = sums[local - reach];
        }
        workgroupBarrier();
        sums[local] += add;
    }
    workgroupBarrier();
    if segment < frame.segment_count {
        segment_work[segment] = sums[local] | (work.parts_exponent << WORK_BITS) | work.in_view;
    }
    if local == BLOCK - 1u {
        atomicAdd(&dispatch[5], atomicLoad(&fibers));
        let own = atomicLoad(&lines);
        let before = atomicAdd(&dispatch[6], own);
        atomicAdd(&dispatch[7], select(0u, 1u, before + own < before));
    }
    if local == BLOCK - 1u && workgroup.y * ROW + workgroup.x < arrayLength(&block_work) {
        block_work[workgroup.y * ROW + workgroup.x] = sums[local];
    }
}
