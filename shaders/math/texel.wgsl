// Textures of words, one row after the other: native/gpu/src/word_texture.rs fills them.

// A power of two.
const TEXELS_IN_ROW: u32 = 4096u;

// Where the texel of that number is.
fn texel_at(index: u32) -> vec2u {
    return vec2u(index % TEXELS_IN_ROW, index / TEXELS_IN_ROW);
}
