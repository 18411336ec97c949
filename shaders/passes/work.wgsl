// Work counted by cull and scan: which fiber of which segment a thread draws.
@group(0) @binding(12) var<storage, read_write> segment_work: array<u32>;
@group(0) @binding(13) var<storage, read_write> block_work: array<u32>;

// Segments whose work is summed up together.
const BLOCK: u32 = 256u;
// Fibers of a ply that one thread draws: they share the yarn's and the ply's frame.
const CHUNK: u32 = 8u;
// Threads of one workgroup of the visibility pass.
const LANES: u32 = 64u;
// Workgroups in one row of a folded dispatch; a device takes at most 65535.
const ROW: u32 = 32768u;

fn folded_index(workgroup: vec3u, local: u32, lanes: u32) -> u32 {
    return (workgroup.y * ROW + workgroup.x) * lanes + local;
}
