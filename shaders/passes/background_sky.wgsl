// What lies behind everything, with a picture of the sky.

@group(0) @binding(30) var<storage, read> sky: Sky;
// Red and green, blue: halves.
@group(0) @binding(31) var<storage, read> sky_texels: array<vec2u>;

fn sky_texel(column: i32, row: i32) -> vec3f {
    // Around the back columns go on at the other side; beyond the poles rows end.
    let width = i32(sky.size.x);
    let x = (column + width) % width;
    let y = clamp(row, 0, i32(sky.size.y) - 1);
    let words = sky_texels[u32(y) * sky.size.x + u32(x)];
    return vec3f(unpack2x16float(words.x), unpack2x16float(words.y).x);
}

// Radiance of the picture of the sky from a unit direction; the twin of EnvironmentImage in native/core/src/scene/environment.rs.
fn sky_radiance(direction: vec3f) -> vec3f {
    let d = vec3f(
        dot(sky.environment_from_render_x.xyz, direction),
        dot(sky.environment_from_render_y.xyz, direction),
        dot(sky.environment_from_render_z.xyz, direction),
    );
    let longitude = select(atan2(d.y, d.x), 0.0, all(abs(d.xy) < vec2f(1e-12)));
    let place = vec2f(0.5 - longitude / TAU, acos(clamp(d.z, -1.0, 1.0)) / PI) * vec2f(sky.size) - 0.5;
    let corner = floor(place);
    let share = place - corner;
    let at = vec2i(corner);
    let top = mix(sky_texel(at.x, at.y), sky_texel(at.x + 1, at.y), share.x);
    let bottom = mix(sky_texel(at.x, at.y + 1), sky_texel(at.x + 1, at.y + 1), share.x);
    return mix(top, bottom, share.y) * sky.strength;
}

fn background_at(pixel: vec2f) -> vec3f {
    if sky.size.x == 0u {
        return frame.background;
    }
    return frame.background + sky_radiance(view_direction(frame.pixel_from_render, pixel));
}
