fn direction_to_viewer(viewer: vec4f, position: vec3f) -> vec3f {
    return select(normalize(viewer.xyz - position), viewer.xyz, viewer.w > 0.5);
}

// Pixel coordinates, w, and distance along the view axis.
fn to_pixel(pixel_from_render: mat4x4f, position: vec3f) -> vec4f {
    let p = pixel_from_render * vec4f(position, 1.0);
    return vec4f(p.xy / p.z, p.z, p.w);
}

// Unit direction of the view ray through a place on the frame: what all points on it leave at 0 of x - w pixel.x and y - w pixel.y.
fn view_direction(pixel_from_render: mat4x4f, pixel: vec2f) -> vec3f {
    let rows = transpose(pixel_from_render);
    let direction = cross(rows[0].xyz - pixel.x * rows[2].xyz, rows[1].xyz - pixel.y * rows[2].xyz);
    return normalize(select(-direction, direction, dot(direction, rows[3].xyz) > 0.0));
}

// Bound on 1 / sin of the angle between a fiber and the view: at its end, a fiber seen from its tip is a sphere.
const MOST_LEAN: f32 = 4.0;

// Cosine between the axis of a shadow's view and the ray through a place on its map.
fn axis_cosine(view: ShadowView, texel: vec2f) -> f32 {
    let aside = (texel - 0.5 * view.side) / view.texels_per_unit;
    return select(inverseSqrt(1.0 + dot(aside, aside)), 1.0, view.parallel == 1u);
}
