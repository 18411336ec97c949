// Shadow of a yarn's fibers on each other, and its ambient occlusion [WuYuksel2018 §4.1, §4.2].

// The yarn as a tube about a point of its centre line.
struct Tube {
    center: vec3f,
    radius: f32,
    tangent: vec3f,
}

// A point of a yarn's section, in units of the yarn's radius, in the frame that turns with the plies.
struct SectionPoint {
    position: vec2f,
    // Directions of its axes and of the yarn, render space.
    x: vec3f,
    y: vec3f,
    yarn_axis: vec3f,
    // Angle by which the plies turn per radius along the yarn.
    winding: f32,
}

// In the frame of any of the plies: the section repeats from ply to ply.
fn section_point(tube: Tube, radial: vec3f, tangential: vec3f, winding: f32, position: vec3f) -> SectionPoint {
    let offset = position - tube.center;
    return SectionPoint(vec2f(dot(offset, radial), dot(offset, tangential)) / tube.radius, radial, tangential, tube.tangent, winding);
}

// How far along `direction` a point must go to have the tube behind it: all of it that lies within `reach` beside the way, since texels of a
// shadow map show that, too. From where the way is nearest to the axis, at y beside it and at an angle alpha to it, the surface is
// sqrt(r² - y²) / sin(alpha) off, and `reach` on along the axis, reach / tan(alpha) more.
fn distance_clear_of_tube(tube: Tube, position: vec3f, direction: vec3f, reach: f32) -> f32 {
    let offset = position - tube.center;
    let o = offset - tube.tangent * dot(offset, tube.tangent);
    let along = dot(direction, tube.tangent);
    let d = direction - tube.tangent * along;
    let sine_squared = max(dot(d, d), 1e-4);
    let to_axis = -dot(o, d) / sine_squared;
    let y = sqrt(max(dot(o, o) - sine_squared * to_axis * to_axis, 0.0));
    let nearest = max(y - reach, 0.0);
    let left = tube.radius * tube.radius - nearest * nearest;
    if left <= 0.0 {
        return 0.0;
    }
    let off = (sqrt(left) + reach * abs(along)) * inverseSqrt(sine_squared);
    return clamp(to_axis + off, 0.0, 4.0 * (tube.radius + reach));
}
