// Precomputed tables of every yarn and material, one after the other.
@group(0) @binding(8) var<storage, read> tables: array<f32>;

fn fiber_at(yarn: Yarn, ply: PlySeed, index: u32) -> Fiber {
    let row = yarn.fiber_table + 3u * index;
    return make_fiber(ply, index, vec3f(tables[row], tables[row + 1u], tables[row + 2u]));
}
