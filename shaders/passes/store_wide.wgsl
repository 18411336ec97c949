// One 64-bit atomic per covered pixel.
@group(0) @binding(15) var<storage, read_write> keys: array<atomic<u64>>;

fn store_key(pixel: u32, key: Key) {
    atomicMax(&keys[pixel], (u64(key.high) << 32u) | u64(key.low));
}
