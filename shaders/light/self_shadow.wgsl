// Shadow of a yarn's fibers on each other, and its ambient occlusion [WuYuksel2018 §4.1, §4.2].

// A point of a yarn's section, in units of the yarn's radius, in the frame that turns with the plies.
struct SectionPoint {
    position: vec2f,
    // Directions of its axes, render space.
    x: vec3f,
    y: vec3f,
}

// In the frame of any of the plies: the section repeats from ply to ply.
fn section_point(center: vec3f, radius: f32, radial: vec3f, tangential: vec3f, position: vec3f) -> SectionPoint {
    let offset = position - center;
    return SectionPoint(vec2f(dot(offset, radial), dot(offset, tangential)) / radius, radial, tangential);
}

// The yarn as a tube about a point of its centre line.
struct Tube {
    center: vec3f,
    radius: f32,
    tangent: vec3f,
}

// How far along `direction` a point must go to leave the tube.
fn distance_out_of_tube(tube: Tube, position: vec3f, direction: vec3f) -> f32 {
    let offset = position - tube.center;
    let o = offset - tube.tangent * dot(offset, tube.tangent);
    let d = direction - tube.tangent * dot(direction, tube.tangent);
    let a = max(dot(d, d), 1e-4);
    let b = dot(o, d);
    let discriminant = b * b - a * (dot(o, o) - tube.radius * tube.radius);
    if discriminant <= 0.0 {
        return 0.0;
    }
    return clamp((sqrt(discriminant) - b) / a, 0.0, 4.0 * tube.radius);
}
