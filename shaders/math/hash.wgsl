// Integer hashes; twin of native/core/src/sampling.rs, equal to the bit.

fn hash_u32(value: u32) -> u32 {
    var x = value;
    x ^= x >> 16u;
    x *= 0x7feb352du;
    x ^= x >> 15u;
    x *= 0x846ca68bu;
    return x ^ (x >> 16u);
}

fn hash_combine(seed: u32, key: u32) -> u32 {
    return hash_u32(seed ^ (key * 0x9e3779b9u + 0x7f4a7c15u));
}

fn unit_from_hash(hash: u32) -> f32 {
    return f32(hash >> 8u) * 0x1p-24;
}

fn normal_from_hash(hash: u32) -> f32 {
    let sum = (hash & 1023u) + ((hash >> 10u) & 1023u) + ((hash >> 20u) & 1023u);
    return (f32(sum) + 1.5) / 512.0 - 3.0;
}
