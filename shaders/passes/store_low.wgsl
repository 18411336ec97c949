// Without 64-bit atomics, second of two passes: the lower half, where the upper one has won.
@group(0) @binding(15) var<storage, read_write> keys: array<atomic<u32>>;

fn store_key(pixel: u32, key: Key) {
    if atomicLoad(&keys[2u * pixel + 1u]) == key.high {
        atomicMax(&keys[2u * pixel], key.low);
    }
}
