// What lies behind everything, without a picture of the sky.

fn background_at(pixel: vec2f) -> vec3f {
    return frame.background;
}
