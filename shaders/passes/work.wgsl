// Work counted by cull and scan: which fiber of which segment a thread draws.
@group(0) @binding(12) var<storage, read_write> segment_work: array<u32>;
@group(0) @binding(13) var<storage, read_write> block_work: array<u32>;

// Segments whose work is summed up together.
const BLOCK: u32 = 256u;
// Fibers that one thread draws: they share the segment, and its plies' frames.
const CHUNK: u32 = 16u;
// Pixels that one thread visits, about: a software driver ends a thread after 65535 turns of its loops, and on a GPU long
// threads make the others wait. Larger lines are shared by a power of two of threads, which take turns along them.
const VISITS: f32 = 24000.0;
// Items of one segment, at most, and what the items of a block's segments up to one of them take of its word; above it are
// the number of sharing threads, as a power of two, and whether the segment is in view.
const MOST_ITEMS: u32 = 65535u;
const WORK_BITS: u32 = 24u;
const WORK_MASK: u32 = 0xffffffu;
const EXPONENT_MASK: u32 = 0xfu;
const IS_IN_VIEW: u32 = 0x80000000u;

// Plies that have threads of their own, for so many fibers each: if there are few, one thread draws all plies.
fn plies_apart(plies: u32, fibers: u32) -> u32 {
    return select(plies, 1u, plies * fibers <= CHUNK);
}

// Power of two of threads that share lines of that length and width in all, pixels.
fn parts_exponent(length: f32, width: f32) -> u32 {
    return u32(clamp(ceil(log2(max(length * width / VISITS, 1.0))), 0.0, 12.0));
}
// Threads of one workgroup of the visibility pass.
const LANES: u32 = 64u;
// Workgroups in one row of a folded dispatch; a device takes at most 65535.
const ROW: u32 = 32768u;

fn folded_index(workgroup: vec3u, local: u32, lanes: u32) -> u32 {
    return (workgroup.y * ROW + workgroup.x) * lanes + local;
}
