// The scene's bindings, and how a segment is read from them.

// An array of one: Mesa's software driver would compile a shader anew for every value of a uniform that decides a branch, and keep them all,
// unless the compiler does not know which of several it reads.
@group(0) @binding(0) var<uniform> frame_buffer: array<Frame, 1>;
// Every entry point begins by reading it: inner loops then have it at hand.
var<private> frame: Frame;
@group(0) @binding(2) var<storage, read> curves: array<Curve>;
@group(0) @binding(3) var<storage, read> knot_positions: array<f32>;
// Length coordinate, octahedral normal.
@group(0) @binding(4) var<storage, read> knot_frames: array<vec2u>;
// Radius and flags, curve.
@group(0) @binding(5) var<storage, read> knot_radii: array<vec2u>;

// 0, which the compiler does not know: no buffer holds 2³¹ bytes.
fn unknown_zero() -> u32 {
    return arrayLength(&curves) >> 28u;
}

fn read_frame() -> Frame {
    return frame_buffer[unknown_zero()];
}

// Set on a knot where a segment begins.
const KNOT_BEGINS_SEGMENT: u32 = 0x10000u;

// The draw that a segment belongs to: the last one that begins at or before it.
fn find_draw(segment: u32) -> u32 {
    var low = 0u;
    var high = frame.draw_count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if draws[middle].first_segment <= segment {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

fn knot_position(draw: u32, knot: u32) -> vec3f {
    let p = vec4f(knot_positions[3u * knot], knot_positions[3u * knot + 1u], knot_positions[3u * knot + 2u], 1.0);
    return vec3f(
        dot(draws[draw].render_from_object_x, p),
        dot(draws[draw].render_from_object_y, p),
        dot(draws[draw].render_from_object_z, p),
    );
}

fn knot_radius(draw: u32, knot: u32) -> f32 {
    return f32(knot_radii[knot].x & 0xffffu) / 65535.0 * draws[draw].radius_max;
}

fn knot_at(draw: u32, index: u32) -> Knot {
    let frame_word = knot_frames[index];
    let n = vec4f(unpack_unit_vector(frame_word.y), 0.0);
    let normal = vec3f(
        dot(draws[draw].render_from_object_x, n),
        dot(draws[draw].render_from_object_y, n),
        dot(draws[draw].render_from_object_z, n),
    );
    return Knot(knot_position(draw, index), normalize(normal), frame_word.x, knot_radius(draw, index));
}

fn segment_at(draw: u32, segment: u32) -> Segment {
    let knot = draws[draw].first_knot + segment - draws[draw].first_segment;
    let curve_index = knot_radii[knot].y;
    var curve = curves[curve_index];
    curve.seed = hash_combine(draws[draw].seed, curve.seed);
    return segment_between(
        knot_at(draw, knot - 1u),
        knot_at(draw, knot),
        knot_at(draw, knot + 1u),
        knot_at(draw, knot + 2u),
        curve,
        draws[draw].handedness,
    );
}

fn radius_in_pixels(radius: f32, w: f32) -> f32 {
    return radius * frame.pixels_per_unit / w;
}

fn pixels_at(position: vec3f, radius: f32) -> f32 {
    let w = (frame.pixel_from_render * vec4f(position, 1.0)).z;
    return radius_in_pixels(radius, max(w, frame.least_w));
}

// A segment's size and level of detail on the screen, at its two ends.
struct Scale {
    radius_pixels: f32,
    ends: array<Detail, 2>,
}

fn scale_between(yarn: Yarn, start: vec3f, start_radius: f32, end: vec3f, end_radius: f32) -> Scale {
    let a = pixels_at(start, start_radius);
    let b = pixels_at(end, end_radius);
    let ends = array<Detail, 2>(detail_at(yarn, a, frame.lod_pixels), detail_at(yarn, b, frame.lod_pixels));
    return Scale(max(a, b), ends);
}

fn scale_of(yarn: Yarn, s: Segment) -> Scale {
    return scale_between(yarn, s.position.a, s.radius.x, s.end.xyz, s.end.w);
}

fn most_fibers(yarn: Yarn, scale: Scale) -> u32 {
    return max(fiber_count(yarn, scale.ends[0]), fiber_count(yarn, scale.ends[1]));
}

fn mix_detail(ends: array<Detail, 2>, t: f32) -> Detail {
    return Detail(mix(ends[0].fibers, ends[1].fibers, t), mix(ends[0].flyaways, ends[1].flyaways, t));
}
