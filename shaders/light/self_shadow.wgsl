// Shadow of a yarn's fibers on each other, and its ambient occlusion [WuYuksel2018 §4.1, §4.2].

// A point of a yarn's section, in units of the yarn's radius, in the frame that turns with the plies.
struct SectionPoint {
    position: vec2f,
    // Directions of its axes, render space.
    x: vec3f,
    y: vec3f,
}

fn section_point(yarn: Yarn, s: Segment, p: YarnPoint, position: vec3f) -> SectionPoint {
    let first = ply_point(yarn, s, p, 0u);
    let offset = position - p.position;
    let place = vec2f(dot(offset, first.radial), dot(offset, first.tangential)) / p.radius;
    return SectionPoint(place, first.radial, first.tangential);
}

// The point of the tube's surface, or rather how far along `direction` a point must go to leave a tube of that radius.
fn distance_out_of_tube(offset: vec3f, tangent: vec3f, direction: vec3f, radius: f32) -> f32 {
    let o = offset - tangent * dot(offset, tangent);
    let d = direction - tangent * dot(direction, tangent);
    let a = max(dot(d, d), 1e-4);
    let b = dot(o, d);
    let discriminant = b * b - a * (dot(o, o) - radius * radius);
    if discriminant <= 0.0 {
        return 0.0;
    }
    return clamp((sqrt(discriminant) - b) / a, 0.0, 4.0 * radius);
}
