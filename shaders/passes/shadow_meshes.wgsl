// How it works: the hardware draws all triangles into depth maps, one instance for each view; each texel keeps the nearest. The lowest
// bit of a depth tells meshes, which let no light through, from yarns.

@group(0) @binding(11) var<storage, read_write> shadow_depths: array<atomic<u32>>;

struct MeshShadowVertex {
    @builtin(position) clip: vec4f,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) view: u32,
}

@vertex
fn mesh_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) view: u32) -> MeshShadowVertex {
    frame = read_frame();
    let triangle = index / 3u;
    let draw = find_mesh(triangle);
    let position = mesh_position(draw, mesh_corner(draw, triangle, index % 3u));
    let p = shadow_views[view].texel_from_render * vec4f(position, 1.0);
    let in_map = 2.0 * p.xy / f32(frame.shadow_resolution) - p.z;
    // Whatever lies between the light and the yarns counts; of a point light, what is all but at it does not.
    let m = shadow_views[view].texel_from_render;
    let parallel = abs(m[0].z) + abs(m[1].z) + abs(m[2].z) == 0.0;
    let least = select(1e-3 * shadow_views[view].near, 0.5, parallel);
    return MeshShadowVertex(vec4f(in_map.x, -in_map.y, least, p.z), p.w, view);
}

@fragment
fn mesh_shadow_fragment(vertex: MeshShadowVertex) {
    let side = read_frame().shadow_resolution;
    let texel = vec2u(vertex.clip.xy);
    let view = shadow_views[vertex.view];
    let nearness = clamp(1.0 - (vertex.depth - view.depth_min) * view.depth_scale, 0.0, 1.0);
    atomicMax(&shadow_depths[(vertex.view * side + texel.y) * side + texel.x], bitcast<u32>(nearness) | 1u);
}
