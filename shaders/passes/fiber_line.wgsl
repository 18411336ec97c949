// A fiber on the screen.

// Most lines that one fiber of one segment is drawn with.
const MOST_STEPS: u32 = 128u;

// How many steps a fiber of a segment takes.
fn fiber_steps(yarn: Yarn, s: Segment, radius_pixels: f32) -> u32 {
    let per_length = s.radius.x;
    let bend = length(0.5 * s.position.c + 1.5 * s.position.d) + length(0.5 * s.position.c);
    let bend_pixels = 2.0 * bend * radius_pixels / max(per_length, 1e-30);
    let length_share_here = dot(s.length, vec4f(0.0, 1.0, 1.0, 1.0));
    let turning = TAU * length_share_here * (abs(yarn.ply_sign * s.turns.x + yarn.fiber_sign * s.turns.y) + s.turns.x);
    return step_count(bend_pixels, turning, 0.7, radius_pixels, MOST_STEPS);
}

fn core_steps(yarn: Yarn, s: Segment, radius_pixels: f32) -> u32 {
    return fiber_steps(yarn, s, radius_pixels);
}

struct FiberEnd {
    line: LineEnd,
    piece: u32,
    period: u32,
}

fn fiber_end(yarn: Yarn, s: Segment, detail: Detail, p: YarnPoint, q: PlyPoint, fiber: Fiber) -> FiberEnd {
    let f = fiber_point(yarn, s, p, q, fiber);
    let width = width_factor(yarn, detail, fiber.index, f);
    let pixel = to_pixel(frame.pixel_from_render, f.position);
    // A point behind the near plane has no width.
    let radius = select(0.0, radius_in_pixels(yarn.fiber_radius * p.radius * width, pixel.z), pixel.w > frame.near);
    return FiberEnd(LineEnd(pixel.xy, pixel.w, radius), f.piece, f.period);
}
