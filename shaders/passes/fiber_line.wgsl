// A fiber on the screen.

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
