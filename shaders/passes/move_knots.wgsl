// How it works: one thread a knot puts it between two time steps: positions and frames of the shape that is drawn.

struct Move {
    knots: u32,
    // Of the way to the later step.
    share: f32,
    padding_0: u32,
    padding_1: u32,
}
@group(0) @binding(16) var<uniform> move_pass: Move;
@group(0) @binding(41) var<storage, read> earlier_positions: array<f32>;
@group(0) @binding(42) var<storage, read> later_positions: array<f32>;
@group(0) @binding(43) var<storage, read> earlier_frames: array<vec2u>;
@group(0) @binding(44) var<storage, read> later_frames: array<vec2u>;
@group(0) @binding(45) var<storage, read_write> moved_positions: array<f32>;
@group(0) @binding(46) var<storage, read_write> moved_frames: array<vec2u>;

@compute @workgroup_size(64)
fn move_knots(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let knot = folded_index(workgroup, local, LANES);
    if knot >= move_pass.knots {
        return;
    }
    for (var i = 3u * knot; i < 3u * knot + 3u; i++) {
        moved_positions[i] = mix(earlier_positions[i], later_positions[i], move_pass.share);
    }
    let earlier = earlier_frames[knot];
    let normal = mix(unpack_unit_vector(earlier.y), unpack_unit_vector(later_frames[knot].y), move_pass.share);
    moved_frames[knot] = vec2u(earlier.x, pack_unit_vector(normal));
}
