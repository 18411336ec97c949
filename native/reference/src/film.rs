//! What the samples add up to.

use rayon::prelude::*;

use crate::Error;

/// One sample of one pixel.
#[derive(Clone, Copy, Default)]
pub(crate) struct Sample {
    pub radiance: [f64; 3],
    pub alpha: f64,
    pub normal: [f64; 3],
    pub tangent: [f64; 3],
}

/// Sums over a pixel's samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pixel {
    pub radiance: [f64; 3],
    pub squares: [f64; 3],
    pub alpha: f64,
    pub normal: [f64; 3],
    pub tangent: [f64; 3],
    /// Of the ray through the pixel's centre.
    pub depth: f64,
    pub object_id: u32,
}

impl Pixel {
    /// All sums in order.
    fn sums(&self) -> [f64; SUMS] {
        let [[r0, r1, r2], [s0, s1, s2], [n0, n1, n2], [t0, t1, t2]] =
            [self.radiance, self.squares, self.normal, self.tangent];
        [r0, r1, r2, s0, s1, s2, n0, n1, n2, t0, t1, t2, self.alpha, self.depth]
    }

    fn from_bytes(bytes: &[u8; PIXEL]) -> Self {
        let value = |i: usize| bytes[8 * i..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        let triple = |i: usize| [value(i), value(i + 1), value(i + 2)].map(f64::from_bits);
        Self {
            radiance: triple(0),
            squares: triple(3),
            normal: triple(6),
            tangent: triple(9),
            alpha: f64::from_bits(value(12)),
            depth: f64::from_bits(value(13)),
            object_id: value(14) as u32,
        }
    }

    pub fn add(&mut self, sample: &Sample) {
        for c in 0..3 {
            self.radiance[c] += sample.radiance[c];
            self.squares[c] += sample.radiance[c] * sample.radiance[c];
            self.normal[c] += sample.normal[c];
            self.tangent[c] += sample.tangent[c];
        }
        self.alpha += sample.alpha;
    }
}

/// A picture in progress: sums in f64, added sample by sample, so that stopping and going on changes no bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub(crate) size: [u32; 2],
    pub(crate) samples: u32,
    /// What it is a picture of.
    pub(crate) digest: u64,
    /// Samples done, all pixels counted: those of the first sample of every pixel, then the second.
    pub(crate) done: u64,
    pub(crate) pixels: Vec<Pixel>,
}

/// A picture. Row 0 is the top one; arrays hold `size[0] × size[1]` pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width and height of the drawn region.
    pub size: [u32; 2],
    /// Scene-linear Rec.709 radiance, premultiplied by alpha.
    pub combined: Vec<[f32; 4]>,
    /// Variance of each colour in `combined`, which is a mean over the samples: the square of its standard error. Infinite with one sample.
    pub variance: Vec<[f32; 3]>,
    /// Distance along the view axis where the ray through the pixel's centre meets a fiber; 1e10 where it meets none.
    pub depth: Vec<f32>,
    /// Mean surface normal, world space; zero where nothing is.
    pub normal: Vec<[f32; 3]>,
    /// Mean fiber tangent, world space, towards growing length coordinates.
    pub tangent: Vec<[f32; 3]>,
    /// Object id at the pixel's centre, 0 where nothing is.
    pub object_id: Vec<u32>,
}

/// How a checkpoint begins: name and version.
const MAGIC: &[u8] = b"Lisle reference 1\n";

/// Bytes of a checkpoint's header: the above, digest, samples done, size, samples.
const HEADER: usize = MAGIC.len() + 28;

/// Numbers of a pixel, and its bytes in a checkpoint.
const SUMS: usize = 14;
const PIXEL: usize = 8 * (SUMS + 1);

/// Depth of an empty pixel.
pub(crate) const EMPTY_DEPTH: f64 = 1e10;

impl Film {
    /// Share of the samples that are done, 0 to 1.
    pub fn fraction(&self) -> f64 {
        self.done as f64 / self.total() as f64
    }

    /// Whether all samples are done.
    pub fn is_done(&self) -> bool {
        self.done == self.total()
    }

    pub(crate) fn total(&self) -> u64 {
        self.pixels.len() as u64 * u64::from(self.samples)
    }

    /// As a checkpoint: a header, and 120 bytes a pixel, little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + PIXEL * self.pixels.len());
        bytes.extend(MAGIC);
        bytes.extend(self.digest.to_le_bytes());
        bytes.extend(self.done.to_le_bytes());
        self.size.iter().chain([&self.samples]).for_each(|value| bytes.extend(value.to_le_bytes()));
        for pixel in &self.pixels {
            pixel.sums().iter().for_each(|value| bytes.extend(value.to_le_bytes()));
            bytes.extend(u64::from(pixel.object_id).to_le_bytes());
        }
        bytes
    }

    /// The film of a checkpoint.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] for bytes that are not one, or not all of it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let refuse = |reason| Err(Error::Checkpoint(reason));
        let Some((header, rest)) = bytes.split_at_checked(HEADER) else { return refuse("is cut off") };
        if !header.starts_with(MAGIC) {
            return refuse("is none of this version of Lisle");
        }
        let word = |at: usize| header[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        let half = |at: usize| header[at..].first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes));
        let at = MAGIC.len();
        let (size, samples) = ([half(at + 16), half(at + 20)], half(at + 24));
        let (pixels, []) = rest.as_chunks::<PIXEL>() else { return refuse("is cut off") };
        let count = u64::from(size[0]) * u64::from(size[1]);
        let film = Self {
            size,
            samples,
            digest: word(at),
            done: word(at + 8),
            pixels: pixels.iter().map(Pixel::from_bytes).collect(),
        };
        if film.pixels.len() as u64 != count || count == 0 || film.done > film.total() {
            return refuse("is cut off, or damaged");
        }
        Ok(film)
    }

    /// The picture so far.
    pub fn image(&self) -> Image {
        let pixels = self.pixels.len() as u64;
        // Pixels before `more` have one sample more.
        let (least, more) = (self.done / pixels, self.done % pixels);
        let map = |place: usize, pixel: &Pixel| {
            let n = (least + u64::from((place as u64) < more)) as f64;
            let mean = |v: f64| (v / n.max(1.0)) as f32;
            let [r, g, b] = pixel.radiance.map(mean);
            let variance = |c: usize| {
                if n < 2.0 {
                    return f32::INFINITY;
                }
                let spread = pixel.squares[c] - pixel.radiance[c] * pixel.radiance[c] / n;
                (spread.max(0.0) / (n * (n - 1.0))) as f32
            };
            ([r, g, b, mean(pixel.alpha)], [0, 1, 2].map(variance))
        };
        let (combined, variance) = self.pixels.par_iter().enumerate().map(|(place, pixel)| map(place, pixel)).unzip();
        let unit = |sum: [f64; 3]| glam::DVec3::from(sum).normalize_or_zero().as_vec3().to_array();
        Image {
            size: self.size,
            combined,
            variance,
            depth: self.pixels.iter().map(|p| p.depth as f32).collect(),
            normal: self.pixels.iter().map(|p| unit(p.normal)).collect(),
            tangent: self.pixels.iter().map(|p| unit(p.tangent)).collect(),
            object_id: self.pixels.iter().map(|p| p.object_id).collect(),
        }
    }
}
