// Precomputed tables of every yarn and material, one after the other.
@group(0) @binding(8) var tables: texture_2d<u32>;

fn table_word(index: u32) -> u32 {
    return textureLoad(tables, texel_at(index), 0).x;
}

fn table_value(index: u32) -> f32 {
    return bitcast<f32>(table_word(index));
}

// A row of the fiber table: FiberTable::packed of native/core/src/yarn/table.rs.
fn fiber_at(yarn: Yarn, ply: PlySeed, rank: u32) -> Fiber {
    let radius = table_word(yarn.fiber_table + 2u * rank);
    let turns = table_word(yarn.fiber_table + 2u * rank + 1u);
    return make_fiber(ply, rank, 0x1p-16 * vec3f(vec3u(radius, turns, turns >> 16u) & vec3u(0xffffu)));
}
