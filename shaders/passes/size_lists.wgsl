// How it works: one thread sizes the dispatches of the two resolve passes by the lengths of their lists.

@group(0) @binding(21) var<storage, read_write> resolve_dispatch: array<u32, 8>;

@compute @workgroup_size(1)
fn size_lists() {
    for (var list = FIBER_LIST; list <= CORE_LIST; list += CORE_LIST) {
        let groups = (resolve_dispatch[list + 3u] + RESOLVE_LANES - 1u) / RESOLVE_LANES;
        resolve_dispatch[list] = min(groups, ROW);
        resolve_dispatch[list + 1u] = (groups + ROW - 1u) / ROW;
        resolve_dispatch[list + 2u] = 1u;
    }
}
