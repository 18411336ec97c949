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

// The same backwards, from a vector of any length but 0.
fn pack_unit_vector(vector: vec3f) -> u32 {
    let v = vector / (abs(vector.x) + abs(vector.y) + abs(vector.z));
    let folded = (1.0 - abs(v.yx)) * select(vec2f(-1.0), vec2f(1.0), v.xy >= vec2f(0.0));
    return pack2x16snorm(select(v.xy, folded, v.z < 0.0));
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

// Cosine and sine of an angle in turns, within 1.1e-7 up to some turns: the built-in ones may be off by 2^-11, and take a software
// driver three times as long. Polynomials over an eighth of a turn to either side of the nearest quarter.
fn circle(turns: f32) -> vec2f {
    let quarters = round(4.0 * turns);
    let x = turns - 0.25 * quarters;
    let z = x * x;
    let sine = x * (6.28318529 + z * (-41.34166257 + z * (81.59254287 - 75.4016127 * z)));
    let cosine = 1.0 + z * (-19.73915212 + z * (64.92123425 - 83.59181678 * z));
    let quarter = i32(quarters);
    let unit = select(vec2f(cosine, sine), vec2f(sine, cosine), (quarter & 1) != 0);
    return select(unit, -unit, vec2<bool>(((quarter + 1) & 2) != 0, (quarter & 2) != 0));
}
