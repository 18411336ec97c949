// How it works: one thread a pixel. Empty pixels take the background; the others go to the list of those that show fibers
// or of those that show cores, so that neighbouring threads of the resolve passes do the same. Those
// that show meshes are left to resolve_meshes. The lists' order varies, the
// picture does not: a pixel's sample depends on nothing else.

@group(0) @binding(21) var<storage, read_write> resolve_dispatch: array<atomic<u32>, 8>;

@compute @workgroup_size(64)
fn classify(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let index = folded_index(workgroup, local, LANES);
    let pixels = frame.size.x * frame.size.y;
    if index >= pixels {
        return;
    }
    if seen_triangle(index) != 0u {
        return;
    }
    let words = keys[index];
    if words.y == 0u {
        var color = vec4f(0.0);
        if frame.opaque_background == 1u {
            let pixel = frame.origin + vec2u(index % frame.size.x, index / frame.size.x);
            color = vec4f(background_at(vec2f(pixel) + 0.5), 1.0);
        }
        add_nothing(index, color);
        return;
    }
    let parts = key_parts(Key(words.y, words.x));
    let fibers = yarns[draws[find_draw(parts.segment)].yarn].fibers;
    if parts.slot % (fibers + 1u) == 0u {
        pixel_list[pixels - 1u - atomicAdd(&resolve_dispatch[CORE_LIST + 3u], 1u)] = index;
    } else {
        pixel_list[atomicAdd(&resolve_dispatch[FIBER_LIST + 3u], 1u)] = index;
    }
}
