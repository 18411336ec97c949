// Without 64-bit atomics, first of two passes: the upper halves.
@group(0) @binding(15) var<storage, read_write> keys: array<atomic<u32>>;

fn store_key(pixel: u32, key: Key) {
    atomicMax(&keys[2u * pixel + 1u], key.high);
}
