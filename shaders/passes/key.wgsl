// Visibility keys: depth in the upper bits, then segment, slot (fiber or core of a ply) and place along the segment:
// a fiber's parameter t in steps of 1 / (2^place_bits - 1), a core's step.
// The largest key wins; ids come from the geometry, so the winner does not depend on the order of work.

struct Key {
    high: u32,
    low: u32,
}

struct KeyParts {
    segment: u32,
    slot: u32,
    place: u32,
}

// The bits of a key that all pixels of a fiber or core have in one segment.
fn key_owner(segment: u32, slot: u32) -> Key {
    let inner_bits = frame.slot_bits + frame.place_bits;
    return Key(segment >> (32u - inner_bits), (segment << inner_bits) | (slot << frame.place_bits));
}

fn make_key(owner: Key, depth: f32, place: u32) -> Key {
    let near_is_large = clamp(1.0 - (depth - frame.depth_min) * frame.depth_scale, 0.0, 1.0);
    // Never 0, which marks an empty pixel; in f32 only 24 bits of depth are significant.
    let code = max(u32(near_is_large * f32(1u << frame.depth_bits) * 0.99999994), 1u);
    return Key((code << (32u - frame.depth_bits)) | owner.high, owner.low | place);
}

// Distance along the view axis.
fn key_depth(key: Key) -> f32 {
    let code = f32(key.high >> (32u - frame.depth_bits)) + 0.5;
    return frame.depth_min + (1.0 - code / exp2(f32(frame.depth_bits))) / frame.depth_scale;
}

fn key_parts(key: Key) -> KeyParts {
    let inner_bits = frame.slot_bits + frame.place_bits;
    let id_high = key.high & ((1u << (32u - frame.depth_bits)) - 1u);
    return KeyParts(
        (id_high << (32u - inner_bits)) | (key.low >> inner_bits),
        (key.low >> frame.place_bits) & ((1u << frame.slot_bits) - 1u),
        key.low & ((1u << frame.place_bits) - 1u),
    );
}

// Steps of a fiber's place along its segment.
fn place_scale() -> f32 {
    return f32((1u << frame.place_bits) - 1u);
}

// Where a pixel of the frame is kept.
fn tile_index(pixel: vec2i) -> u32 {
    let local = vec2u(pixel) - frame.origin;
    return local.y * frame.size.x + local.x;
}
