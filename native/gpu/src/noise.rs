//! When a picture has samples enough.

/// The fewest samples whose halves say something.
const LEAST_SAMPLES: u32 = 16;

/// Colours are compared relative to their square root, as the eye does about; below this they are dark.
const DARK: f32 = 1e-3;

/// Watches a tile's film, at numbers of samples that are powers of two: then the first half has been seen before.
pub(crate) struct Noise {
    threshold: f32,
    /// Sums of the colours of half the samples.
    half: Vec<[f32; 4]>,
}

impl Noise {
    /// Never low with a threshold of 0.
    pub fn new(threshold: f32) -> Self {
        Self { threshold, half: Vec::new() }
    }

    /// Whether to look at the film after so many samples.
    pub fn wants(&self, samples: u32) -> bool {
        self.threshold > 0.0 && samples.is_power_of_two() && 2 * samples >= LEAST_SAMPLES
    }

    /// Whether the noise of a film, sums of so many samples, is low enough.
    pub fn is_low(&mut self, samples: u32, film: &[u8]) -> bool {
        let sums: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(film);
        let is_low = samples >= LEAST_SAMPLES && estimate(&self.half, &sums, samples) <= self.threshold;
        self.half = sums;
        is_low
    }
}

/// The noise of means over all samples, from sums over half of them and over all.
fn estimate(half: &[[f32; 4]], all: &[[f32; 4]], samples: u32) -> f32 {
    let scale = 2.0 / samples as f32;
    let (mut square, mut count) = (0.0_f64, 0_u64);
    for (half, all) in half.iter().zip(all) {
        if all[3] == 0.0 {
            continue;
        }
        for c in 0..4 {
            let (first, second) = (half[c] * scale, (all[c] - half[c]) * scale);
            let mean = 0.5 * (first + second);
            let error = 0.5 * (first - second) / mean.max(DARK).sqrt();
            square += f64::from(error * error);
        }
        count += 4;
    }
    if count == 0 { 0.0 } else { (square / count as f64).sqrt() as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_half_the_difference_of_the_halves() {
        // Two pixels of 0.25 on the average, whose halves are 0.04 apart: half of it, over the root. And an empty one.
        let (samples, n) = (16, 8.0);
        let half = [[0.27 * n; 4], [0.23 * n; 4], [0.0; 4]];
        let all = [[0.25 * 2.0 * n; 4], [0.25 * 2.0 * n; 4], [0.0; 4]];
        let found = estimate(&half, &all, samples);
        assert!((found - 0.04).abs() < 1e-5, "{found}");
        assert_eq!(estimate(&all[2..], &all[2..], samples), 0.0);
    }

    #[test]
    fn it_looks_at_powers_of_two() {
        let noise = Noise::new(0.01);
        assert_eq!((1..70).filter(|n| noise.wants(*n)).collect::<Vec<_>>(), [8, 16, 32, 64]);
        assert!(!Noise::new(0.0).wants(64));
    }
}
