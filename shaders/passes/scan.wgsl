// How it works: one workgroup turns the blocks' sums into the work before each block, and sizes the dispatch that follows.

// Indirect dispatch of the visibility pass, then statistics: items of work, and 1 if they did not fit 32 bits.
@group(0) @binding(14) var<storage, read_write> dispatch: array<u32, 8>;

var<workgroup> sums: array<u32, BLOCK>;
var<workgroup> overflow: atomic<u32>;

@compute @workgroup_size(256)
fn scan(@builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let blocks = (frame.segment_count + BLOCK - 1u) / BLOCK;
    let chunk = (blocks + BLOCK - 1u) / BLOCK;
    let first = min(local * chunk, blocks);
    let last = min(first + chunk, blocks);
    var sum = 0u;
    for (var i = first; i < last; i++) {
        let next = sum + block_work[i];
        if next < sum {
            atomicStore(&overflow, 1u);
        }
        sum = next;
    }
    sums[local] = sum;
    for (var reach = 1u; reach < BLOCK; reach *= 2u) {
        workgroupBarrier();
        var add = 0u;
        if local >= reach {
            add = sums[local - reach];
        }
        workgroupBarrier();
        if sums[local] + add < add {
            atomicStore(&overflow, 1u);
        }
        sums[local] += add;
    }
    workgroupBarrier();
    var before = sums[local] - sum;
    for (var i = first; i < last; i++) {
        let own = block_work[i];
        block_work[i] = before;
        before += own;
    }
    if local == BLOCK - 1u {
        let total = sums[local];
        let groups = (total + LANES - 1u) / LANES;
        dispatch[0] = min(groups, ROW);
        dispatch[1] = (groups + ROW - 1u) / ROW;
        dispatch[2] = 1u;
        dispatch[3] = total;
        dispatch[4] = atomicLoad(&overflow);
    }
}
