const PI: f32 = 3.14159265358979;
const TAU: f32 = 6.28318530717959;

// A unit vector from its octahedral map in two 16-bit signed fractions.
fn unpack_unit_vector(packed: u32) -> vec3f {
    let e = unpack2x16snorm(packed);
    var v = vec3f(e, 1.0 - abs(e.x) - abs(e.y));
    let fold = max(-v.z, 0.0);
    v.x += select(fold, -fold, v.x >= 0.0);
    v.y += select(fold, -fold, v.y >= 0.0);
    return normalize(v);
}

// A colour of three mantissas of 9 bits and one exponent; native/gpu/src/tables.rs packs it.
fn shared_exponent(word: u32) -> vec3f {
    let mantissas = vec3f(vec3u(word, word >> 9u, word >> 18u) & vec3u(511u));
    return mantissas * exp2(f32(word >> 27u) - 24.0);
}

// The upper 32 bits of a 32 × 32 bit product.
fn multiply_high(a: u32, b: u32) -> u32 {
    let a_low = a & 0xffffu;
    let a_high = a >> 16u;
    let b_low = b & 0xffffu;
    let b_high = b >> 16u;
    let low = a_low * b_low;
    let middle = a_high * b_low + (low >> 16u);
    let other = a_low * b_high + (middle & 0xffffu);
    return a_high * b_high + (middle >> 16u) + (other >> 16u);
}

// Cosine and sine of an angle in turns.
fn circle(turns: f32) -> vec2f {
    let angle = TAU * fract(turns);
    return vec2f(cos(angle), sin(angle));
}
