// Fibers on the screen.

struct FiberEnd {
    line: LineEnd,
    // Of the depth along the segment.
    depth_rate: f32,
    piece: u32,
    period: u32,
}

// What the fibers of a ply share at one parameter: its frame in pixel space, where every fiber is a sum of it.
struct ScreenPly {
    yarn: YarnPoint,
    // Of the fibers drawn one by one.
    share: f32,
    position: vec4f,
    radial: vec4f,
    tangential: vec4f,
    // Rates of the depth.
    position_rate: f32,
    radial_rate: f32,
    tangential_rate: f32,
}

fn screen_ply(yarn: Yarn, s: Segment, scale: Scale, t: f32, ply: u32) -> ScreenPly {
    let p = yarn_point(s, t);
    let q = ply_point(yarn, s, p, ply);
    let m = frame.pixel_from_render;
    let depth = vec3f(m[0].w, m[1].w, m[2].w);
    return ScreenPly(
        p,
        share_at(scale, t),
        m * vec4f(q.position, 1.0),
        m * vec4f(q.radial, 0.0),
        m * vec4f(q.tangential, 0.0),
        dot(depth, q.velocity),
        dot(depth, q.radial_rate),
        dot(depth, q.tangential_rate),
    );
}

fn fiber_end(yarn: Yarn, q: ScreenPly, fiber: Fiber, f: FiberSection) -> FiberEnd {
    let width = width_factor(yarn, q.share, fiber.rank, f.profile.taper);
    let p = q.position + q.radial * f.offset.x + q.tangential * f.offset.y;
    let scale = 1.0 / p.z;
    // A point behind the near plane has no width.
    let radius = select(0.0, yarn.fiber_radius * q.yarn.radius * width * frame.pixels_per_unit * scale, p.w > frame.near);
    let depth_rate = q.position_rate + q.radial_rate * f.offset.x + q.tangential_rate * f.offset.y
        + q.radial.w * f.rate.x + q.tangential.w * f.rate.y;
    return FiberEnd(LineEnd(p.xy * scale, p.w, radius), depth_rate, f.profile.piece, f.period);
}
