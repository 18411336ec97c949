// The scene's bindings, and how a segment is read from them.

// An array of one: Mesa's software driver would compile a shader anew for every value of a uniform that decides a branch, and keep them all,
// unless the compiler does not know which of several it reads.
@group(0) @binding(0) var<uniform> frame_buffer: array<Frame, 1>;
// Every entry point begins by reading it: inner loops then have it at hand.
var<private> frame: Frame;
@group(0) @binding(2) var<storage, read> curves: array<Curve>;
// What moves: position, octahedral normal.
@group(0) @binding(3) var knots: texture_2d<u32>;
// Length coordinate; radius and flags.
@group(0) @binding(4) var rest_knots: texture_2d<u32>;
@group(0) @binding(5) var knot_curves: texture_2d<u32>;

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

fn begins_segment(knot: u32) -> bool {
    return (textureLoad(rest_knots, texel_at(knot), 0).y & KNOT_BEGINS_SEGMENT) != 0u;
}

// Length coordinate, as a fraction of the curve's length.
fn knot_length(knot: u32) -> u32 {
    return textureLoad(rest_knots, texel_at(knot), 0).x;
}

fn knot_curve(knot: u32) -> u32 {
    return textureLoad(knot_curves, texel_at(knot), 0).x;
}

fn knot_at(draw: u32, knot: u32) -> Knot {
    let moving = textureLoad(knots, texel_at(knot), 0);
    let rest = textureLoad(rest_knots, texel_at(knot), 0);
    let p = vec4f(bitcast<vec3f>(moving.xyz), 1.0);
    let position = vec3f(
        dot(draws[draw].render_from_object_x, p),
        dot(draws[draw].render_from_object_y, p),
        dot(draws[draw].render_from_object_z, p),
    );
    let n = vec4f(unpack_unit_vector(moving.w), 0.0);
    let normal = vec3f(
        dot(draws[draw].render_from_object_x, n),
        dot(draws[draw].render_from_object_y, n),
        dot(draws[draw].render_from_object_z, n),
    );
    let radius = f32(rest.y & 0xffffu) / 65535.0 * draws[draw].radius_max;
    return Knot(position, normalize(normal), rest.x, radius);
}

fn segment_at(draw: u32, segment: u32) -> Segment {
    let knot = draws[draw].first_knot + segment - draws[draw].first_segment;
    var curve = curves[knot_curve(knot)];
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
    // Of the fibers drawn one by one.
    shares: vec2f,
}

fn scale_between(yarn: Yarn, start: vec3f, start_radius: f32, end: vec3f, end_radius: f32) -> Scale {
    let a = pixels_at(start, start_radius);
    let b = pixels_at(end, end_radius);
    return Scale(max(a, b), vec2f(fiber_share(yarn, a, frame.lod_pixels), fiber_share(yarn, b, frame.lod_pixels)));
}

fn scale_of(yarn: Yarn, s: Segment) -> Scale {
    return scale_between(yarn, s.position.a, s.radius.x, s.end.xyz, s.end.w);
}

fn most_fibers(yarn: Yarn, scale: Scale) -> u32 {
    return fiber_count(yarn, max(scale.shares.x, scale.shares.y));
}

fn share_at(scale: Scale, t: f32) -> f32 {
    return mix(scale.shares.x, scale.shares.y, t);
}
