// How it works: one thread a pixel finds where the point that it shows is in another frame: the draws, knots and camera that are bound are
// those of that frame. What is not seen there stays where it is.

@group(0) @binding(40) var<storage, read_write> aov_planes: array<u32>;

@compute @workgroup_size(64)
fn follow(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = frame_buffer;
    let index = folded_index(workgroup, local, LANES);
    let pixels = frame.size.x * frame.size.y;
    if index >= pixels {
        return;
    }
    let first = frame.plane_vector * pixels + index;
    if aov_planes[first] == 0u {
        return;
    }
    let segment = aov_planes[first] - 1u;
    var place: array<f32, 4>;
    for (var i = 0u; i < 4u; i++) {
        place[i] = bitcast<f32>(aov_planes[first + (i + 1u) * pixels]);
    }
    let p = yarn_point(segment_at(find_draw(segment), segment), place[0]);
    let position = p.position + p.radius * (p.normal * place[1] + p.binormal * place[2] + p.tangent * place[3]);
    let there = to_pixel(frame.pixel_from_render, position);
    if there.w > frame.near {
        aov_planes[first + frame.neighbour_word * pixels] = bitcast<u32>(there.x);
        aov_planes[first + (frame.neighbour_word + 1u) * pixels] = bitcast<u32>(there.y);
    }
}
