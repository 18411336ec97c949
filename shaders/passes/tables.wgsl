// Precomputed tables of every yarn and material, one after the other.
@group(0) @binding(8) var<storage, read> tables: array<u32>;

fn table_word(index: u32) -> u32 {
    return tables[index];
}

fn table_value(index: u32) -> f32 {
    return bitcast<f32>(tables[index]);
}

fn fiber_at(yarn: Yarn, ply: PlySeed, rank: u32) -> Fiber {
    let row = yarn.fiber_table + 4u * rank;
    return make_fiber(ply, rank, vec4f(table_value(row), table_value(row + 1u), table_value(row + 2u), table_value(row + 3u)));
}
