// How it works: one thread a pixel finds where the yarn's point that it shows is in a frame: the draws, knots and camera that are bound are
// those of that frame. What is not seen there stays where it was written to before. Meshes are followed in native/gpu/src/frame/read_back.rs.

@group(0) @binding(40) var<storage, read_write> aov_planes: array<u32>;

@compute @workgroup_size(64)
fn follow(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
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
    let t = bitcast<f32>(aov_planes[first + VECTOR_PARAMETER * pixels]);
    var place: vec3f;
    for (var i = 0u; i < 3u; i++) {
        place[i] = bitcast<f32>(aov_planes[first + (VECTOR_PLACE + i) * pixels]);
    }
    let p = yarn_point(segment_at(find_draw(segment), segment), t);
    let position = p.position + p.radius * (p.normal * place.x + p.binormal * place.y + p.tangent * place.z);
    let there = to_pixel(frame.pixel_from_render, position);
    if there.w > frame.near {
        for (var word = frame.frame_word; word < frame.frame_word_end; word += 2u) {
            aov_planes[first + word * pixels] = bitcast<u32>(there.x);
            aov_planes[first + (word + 1u) * pixels] = bitcast<u32>(there.y);
        }
    }
}
