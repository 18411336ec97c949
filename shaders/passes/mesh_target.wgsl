// Which meshes the camera sees, before yarns.

// Triangle + 1, or 0, and distance along the view axis.
@group(0) @binding(37) var mesh_target: texture_2d<u32>;

// The triangle + 1 that a pixel of the tile shows; 0 where there is none, or a yarn before it.
fn seen_triangle(index: u32) -> u32 {
    let seen = textureLoad(mesh_target, vec2u(index % frame.size.x, index / frame.size.x), 0).xy;
    let words = keys[index];
    if seen.x == 0u || words.y == 0u {
        return seen.x;
    }
    return select(0u, seen.x, bitcast<f32>(seen.y) < key_depth(Key(words.y, words.x)));
}
