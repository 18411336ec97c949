// The film, and the lists of pixels to resolve: written by classify, read by the two resolve passes.

// Two words per pixel: lower and upper half of the key.
@group(0) @binding(15) var<storage, read> keys: array<vec2u>;
@group(0) @binding(17) var<storage, read_write> film_color: array<vec4f>;
// Sum of normals; depth of the first sample.
@group(0) @binding(18) var<storage, read_write> film_normal: array<vec4f>;
// Sum of tangents; draw + 1 of the first sample, 0 for none.
@group(0) @binding(19) var<storage, read_write> film_tangent: array<vec4f>;
// Pixels that show fibers from the start, those that show cores from the end.
@group(0) @binding(20) var<storage, read_write> pixel_list: array<u32>;

// Threads of a workgroup of the resolve passes.
const RESOLVE_LANES: u32 = 64u;

// Dispatch arguments, and count of pixels, of the two resolve passes.
const FIBER_LIST: u32 = 0u;
const CORE_LIST: u32 = 4u;

// A sample in which nothing is seen but the background, if that.
fn add_nothing(index: u32, color: vec4f) {
    if frame.first == 1u {
        film_color[index] = color;
        film_normal[index] = vec4f(vec3f(0.0), 1e10);
        film_tangent[index] = vec4f(0.0);
    } else if color.w > 0.0 {
        film_color[index] += color;
    }
}

fn add_sample(index: u32, color: vec4f, normal: vec3f, tangent: vec3f, depth: f32, draw_number: f32) {
    if frame.first == 1u {
        film_color[index] = color;
        film_normal[index] = vec4f(normal, depth);
        film_tangent[index] = vec4f(tangent, draw_number);
    } else {
        film_color[index] += color;
        film_normal[index] += vec4f(normal, 0.0);
        film_tangent[index] += vec4f(tangent, 0.0);
    }
}
