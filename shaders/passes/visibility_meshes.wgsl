// How it works: the hardware draws all triangles of all meshes with a depth buffer of its own. A pixel keeps the number of the
// nearest triangle + 1 and its distance along the view axis; where a yarn is nearer, later passes take that.

struct MeshVertex {
    @builtin(position) clip: vec4f,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) triangle: u32,
}

@vertex
fn mesh_vertex(@builtin(vertex_index) index: u32) -> MeshVertex {
    frame = read_frame();
    let triangle = index / 3u;
    let draw = find_mesh(triangle);
    let position = mesh_position(draw, mesh_corner(draw, triangle, index % 3u));
    // x, y, w and distance along the view axis.
    let p = frame.pixel_from_render * vec4f(position, 1.0);
    let in_tile = 2.0 * (p.xy - vec2f(frame.origin) * p.z) / vec2f(frame.size) - p.z;
    // Nearer is larger; 1 at the near plane, 0 at the far one.
    let clip = vec4f(in_tile.x, -in_tile.y, meshes.clip_depth.x * p.w + meshes.clip_depth.y, p.z);
    return MeshVertex(clip, p.w, triangle);
}

@fragment
fn mesh_fragment(vertex: MeshVertex) -> @location(0) vec2u {
    return vec2u(vertex.triangle + 1u, bitcast<u32>(vertex.depth));
}
