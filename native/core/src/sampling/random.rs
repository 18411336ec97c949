//! Independent random numbers for every sample of every pixel.

/// A stream of uniform numbers, SplitMix64 [Steele2014]: the same for the same seed, pixel and sample on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Random {
    /// The stream of one sample of one pixel.
    pub fn new(seed: u32, pixel: u64, sample: u32) -> Self {
        let start = mix(mix(u64::from(seed) ^ 0x9e37_79b9_7f4a_7c15).wrapping_add(pixel));
        Self(mix(start.wrapping_add(u64::from(sample).wrapping_mul(0xd1b5_4a32_d192_ed03))))
    }

    /// Uniform in [0, 1), 53 bits.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (mix(self.0) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Two of [`Self::unit`].
    pub fn pair(&mut self) -> [f64; 2] {
        [self.unit(), self.unit()]
    }

    /// Three of [`Self::unit`].
    pub fn triple(&mut self) -> [f64; 3] {
        [self.unit(), self.unit(), self.unit()]
    }
}
