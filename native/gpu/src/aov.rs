//! Passes that are drawn when asked for.

use crate::cryptomatte;

/// A pass beyond those that every picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// World space, of the sample at the pixel's centre; 0 where nothing is.
    Position,
    /// Along the yarn and around it, at the pixel's centre: length coordinate, and the angle from the yarn's normal in turns, 0 to 1.
    Uv,
    /// How far what is at the pixel's centre moves on the picture, pixels, X to the right, Y up: where it was in the frame before relative to
    /// where it is, then where it is relative to where it will be. Meshes move with their transforms, as if they kept their shapes. Needs
    /// [`crate::Exposure::neighbours`].
    Vector,
    /// `Labels::index` at the pixel's centre.
    ObjectIndex,
    /// `Labels::material_index` at the pixel's centre.
    MaterialIndex,
    /// Names of objects by coverage: pairs of id and share of the pixel, by falling share (`cryptomatte.rs`).
    CryptoObject,
    /// The same for `Labels::material`.
    CryptoMaterial,
    /// Light of lamps scattered once, by the diffuse term. With the next four it adds up to the colour of the yarn. Premultiplied, all of
    /// them.
    Diffuse,
    /// The same by reflection: R, or the highlight of simple shading.
    Specular,
    /// The same by transmission: TT.
    Transmission,
    /// Light of lamps scattered more than once.
    Scattered,
    /// Ambient light, however often it is scattered; without the background.
    Ambient,
    /// Share of the lamps' light, by luminance, that shadows of all kinds leave, 0 to 1. Premultiplied.
    Shadow,
    /// Share of light that a fiber there gives back under even light: colour without lighting, as denoisers want it. Premultiplied.
    Albedo,
    /// Mean normal, world space, not of unit length: as denoisers want it.
    DenoisingNormal,
}

impl Aov {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Position,
        Self::Uv,
        Self::Vector,
        Self::ObjectIndex,
        Self::MaterialIndex,
        Self::CryptoObject,
        Self::CryptoMaterial,
        Self::Diffuse,
        Self::Specular,
        Self::Transmission,
        Self::Scattered,
        Self::Ambient,
        Self::Shadow,
        Self::Albedo,
        Self::DenoisingNormal,
    ];

    /// In small letters.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Uv => "uv",
            Self::Vector => "vector",
            Self::ObjectIndex => "object_index",
            Self::MaterialIndex => "material_index",
            Self::CryptoObject => "crypto_object",
            Self::CryptoMaterial => "crypto_material",
            Self::Diffuse => "diffuse",
            Self::Specular => "specular",
            Self::Transmission => "transmission",
            Self::Scattered => "scattered",
            Self::Ambient => "ambient",
            Self::Shadow => "shadow",
            Self::Albedo => "albedo",
            Self::DenoisingNormal => "denoising_normal",
        }
    }

    /// Values of a pixel.
    pub fn channels(self) -> usize {
        match self {
            Self::ObjectIndex | Self::MaterialIndex | Self::Shadow => 1,
            Self::Uv => 2,
            Self::Vector => 4,
            Self::CryptoObject | Self::CryptoMaterial => 2 * cryptomatte::LEVELS,
            _ => 3,
        }
    }
}

/// No such plane.
pub(crate) const NO_PLANE: u32 = u32::MAX;

/// Words of a pixel's place on its yarn or mesh, and of where it is on three pictures: `shaders/passes/aov.wgsl`.
pub(crate) const VECTOR_WORDS: u32 = 11;
/// The word of a mesh's triangle, from the vector's first plane on.
pub(crate) const VECTOR_PARAMETER: u32 = 1;
/// The first of the three words of a point of a mesh, render space, from the vector's first plane on.
pub(crate) const VECTOR_PLACE: u32 = 2;
/// The first of the two words of this frame, of the one before and of the one after, from there on.
pub(crate) const FRAME_WORDS: [u32; 3] = [5, 7, 9];

/// Where the shaders write: planes of one word a pixel, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Planes {
    pub position: u32,
    pub uv: u32,
    pub vector: u32,
    pub matte: u32,
    pub albedo: u32,
    pub diffuse: u32,
    pub specular: u32,
    pub transmission: u32,
    pub scattered: u32,
    pub ambient: u32,
    pub shadow: u32,
    pub count: u32,
}

impl Planes {
    pub fn new(wanted: &[Aov]) -> Self {
        let mut count = 0;
        let mut plane = |of: &[Aov], words: u32| {
            if !of.iter().any(|aov| wanted.contains(aov)) {
                return NO_PLANE;
            }
            count += words;
            count - words
        };
        let matte_words = 2 * cryptomatte::SLOTS as u32;
        Self {
            position: plane(&[Aov::Position], 3),
            uv: plane(&[Aov::Uv], 2),
            vector: plane(&[Aov::Vector], VECTOR_WORDS),
            matte: plane(&[Aov::CryptoObject, Aov::CryptoMaterial], matte_words),
            albedo: plane(&[Aov::Albedo], 3),
            diffuse: plane(&[Aov::Diffuse], 3),
            specular: plane(&[Aov::Specular], 3),
            transmission: plane(&[Aov::Transmission], 3),
            scattered: plane(&[Aov::Scattered], 3),
            ambient: plane(&[Aov::Ambient], 3),
            shadow: plane(&[Aov::Shadow], 1),
            count,
        }
    }
}

/// What was read of a tile's planes.
pub(crate) struct Tile<'a> {
    pub planes: Planes,
    pub words: &'a [u32],
    pub pixels: usize,
}

impl Tile<'_> {
    pub fn word(&self, plane: u32, pixel: usize) -> u32 {
        self.words[plane as usize * self.pixels + pixel]
    }

    pub fn values<const N: usize>(&self, plane: u32, pixel: usize) -> [f32; N] {
        std::array::from_fn(|i| f32::from_bits(self.word(plane + i as u32, pixel)))
    }

    /// Draws (the first is 1) and samples of a pixel's mattes.
    pub fn matte(&self, pixel: usize) -> impl Iterator<Item = (u32, u32)> {
        let slot = move |slot: u32| {
            let plane = self.planes.matte + 2 * slot;
            (self.word(plane, pixel), self.word(plane + 1, pixel))
        };
        (0..cryptomatte::SLOTS as u32).map(slot).take_while(|(draw, _)| *draw != 0)
    }

    /// Where a yarn's point is in the three frames, pixels.
    pub fn yarn_pixels(&self, pixel: usize) -> [[f64; 2]; 3] {
        FRAME_WORDS.map(|word| self.values::<2>(self.planes.vector + word, pixel).map(f64::from))
    }
}

/// Where a point was or will be, as differences on the picture: from where it is in this frame, the one before and the one after, pixels.
pub(crate) fn vector([here, before, after]: [[f64; 2]; 3]) -> [f32; 4] {
    // Y of pixel space runs down.
    [before[0] - here[0], here[1] - before[1], here[0] - after[0], after[1] - here[1]]
        .map(|difference| difference as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_follow_each_other() {
        let none = Planes::new(&[Aov::ObjectIndex, Aov::DenoisingNormal]);
        assert_eq!((none.count, none.position, none.matte), (0, NO_PLANE, NO_PLANE));
        let some = Planes::new(&[Aov::CryptoMaterial, Aov::Uv, Aov::CryptoObject]);
        assert_eq!((some.uv, some.matte, some.count), (0, 2, 2 + 2 * cryptomatte::SLOTS as u32));
        assert_eq!((VECTOR_PLACE + 3, FRAME_WORDS[2] + 2), (FRAME_WORDS[0], VECTOR_WORDS));
    }
}
