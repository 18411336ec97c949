// One step of a core fiber on the screen: a flat ribbon with a texture; shared by visibility and resolve.

struct CoreEnd {
    position: vec2f,
    depth: f32,
    // Half width, pixels; along +v on the screen: its direction.
    half_width: f32,
    side: vec2f,
    turns: f32,
    // Distance towards the viewer for h = 1 and v = 1.
    depth_h: f32,
    depth_v: f32,
}

fn core_end(c: CorePoint) -> CoreEnd {
    let pixel = to_pixel(frame.pixel_from_render, c.center);
    let view = direction_to_viewer(frame.viewer, c.center);
    let moved = (frame.pixel_from_render * vec4f(c.side, 0.0)).xyz;
    let side = moved.xy - pixel.xy * moved.z;
    return CoreEnd(
        pixel.xy,
        pixel.w,
        radius_in_pixels(c.half_width, pixel.z),
        side / max(length(side), 1e-20),
        c.turns,
        dot(c.toward, view),
        dot(c.across, view),
    );
}

struct CoreHit {
    covered: bool,
    t: f32,
    v: f32,
    turns: f32,
}

fn core_hit(a: CoreEnd, b: CoreEnd, pixel: vec2f) -> CoreHit {
    let direction = b.position - a.position;
    let from_a = pixel - a.position;
    let unclamped = dot(from_a, direction) / max(dot(direction, direction), 1e-20);
    let t = clamp(unclamped, 0.0, 1.0);
    let half_width = max(mix(a.half_width, b.half_width, t), 1e-20);
    let v = dot(from_a - t * direction, mix(a.side, b.side, t)) / half_width;
    // Past an end only as far as the joint with the next step may gape.
    let overhang = abs(unclamped - t) * length(direction);
    // psi jumps by a whole turn once around the ply.
    let difference = b.turns - a.turns;
    let turns = a.turns + t * (difference - round(difference));
    return CoreHit(overhang <= 0.2 * half_width + 0.01, t, v, turns);
}

fn core_chance(pixel: vec2u) -> f32 {
    return unit_from_hash(hash_combine(hash_combine(pixel.x + 1u, pixel.y), frame.sample_index));
}
