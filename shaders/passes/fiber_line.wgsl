// A fiber on the screen.

struct FiberEnd {
    line: LineEnd,
    // Of the depth along the segment.
    depth_rate: f32,
    // Of its own width: above 1 it stands for several fibers, side by side.
    width: f32,
    piece: u32,
    period: u32,
}

fn fiber_end(yarn: Yarn, s: Segment, detail: Detail, p: YarnPoint, q: PlyPoint, fiber: Fiber) -> FiberEnd {
    let f = fiber_point(yarn, s, p, q, fiber);
    let width = width_factor(yarn, detail, fiber.index, f);
    let pixel = to_pixel(frame.pixel_from_render, f.position);
    // A point behind the near plane has no width.
    let radius = select(0.0, radius_in_pixels(yarn.fiber_radius * p.radius * width, pixel.z), pixel.w > frame.near);
    let depth_rate = (frame.pixel_from_render * vec4f(f.velocity, 0.0)).w;
    return FiberEnd(LineEnd(pixel.xy, pixel.w, radius), depth_rate, width, f.piece, f.period);
}
