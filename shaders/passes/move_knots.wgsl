// How it works: one thread a knot puts it between two time steps: position and normal of the shape that is drawn.

struct Move {
    knots: u32,
    // Of the way to the later step.
    share: f32,
    padding_0: u32,
    padding_1: u32,
}
@group(0) @binding(16) var<uniform> move_pass: Move;
@group(0) @binding(41) var earlier_knots: texture_2d<u32>;
@group(0) @binding(42) var later_knots: texture_2d<u32>;
@group(0) @binding(43) var moved_knots: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(64)
fn move_knots(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let knot = folded_index(workgroup, local, LANES);
    if knot >= move_pass.knots {
        return;
    }
    let at = texel_at(knot);
    let earlier = textureLoad(earlier_knots, at, 0);
    let later = textureLoad(later_knots, at, 0);
    let position = mix(bitcast<vec3f>(earlier.xyz), bitcast<vec3f>(later.xyz), move_pass.share);
    let normal = mix(unpack_unit_vector(earlier.w), unpack_unit_vector(later.w), move_pass.share);
    textureStore(moved_knots, at, vec4u(bitcast<vec3u>(position), pack_unit_vector(normal)));
}
