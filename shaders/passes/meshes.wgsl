// Meshes: triangles of all instances one after the other, and how a corner is read.

@group(0) @binding(32) var<storage, read> meshes: Meshes;
@group(0) @binding(33) var<storage, read> mesh_draws: array<MeshDraw>;
@group(0) @binding(34) var<storage, read> mesh_positions: array<f32>;
// Places of three corners each.
@group(0) @binding(35) var<storage, read> mesh_triangles: array<u32>;

// The instance that a triangle belongs to: the last one that begins at or before it.
fn find_mesh(triangle: u32) -> u32 {
    var low = 0u;
    var high = meshes.draw_count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if mesh_draws[middle].first_triangle <= triangle {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// Place of a corner (0 to 2) of a triangle among all corners of its geometry's triangles.
fn mesh_corner(draw: u32, triangle: u32, corner: u32) -> u32 {
    return mesh_draws[draw].first_corner + 3u * (triangle - mesh_draws[draw].first_triangle) + corner;
}

// Render space.
fn mesh_position(draw: u32, corner: u32) -> vec3f {
    let at = 3u * (mesh_draws[draw].first_position + mesh_triangles[corner]);
    let p = vec4f(mesh_positions[at], mesh_positions[at + 1u], mesh_positions[at + 2u], 1.0);
    return vec3f(
        dot(mesh_draws[draw].render_from_object_x, p),
        dot(mesh_draws[draw].render_from_object_y, p),
        dot(mesh_draws[draw].render_from_object_z, p),
    );
}
