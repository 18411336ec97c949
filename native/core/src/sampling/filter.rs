use std::f64::consts::TAU;

/// How samples spread about a pixel's centre. Widths are from one end to the other, as in Blender.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The four-term window of [Harris 1978].
    #[default]
    BlackmanHarris,
    /// A Gaussian with a standard deviation of a twelfth of the width.
    Gaussian,
    /// Even.
    Box,
}

impl Filter {
    /// Not normalised; `x` runs from −1 to 1.
    fn density(self, x: f64) -> f64 {
        match self {
            Self::BlackmanHarris => {
                let t = TAU * (0.5 + 0.5 * x);
                0.35875 - 0.48829 * t.cos() + 0.14128 * (2.0 * t).cos() - 0.01168 * (3.0 * t).cos()
            }
            Self::Gaussian => (-18.0 * x * x).exp(),
            Self::Box => 1.0,
        }
    }
}

/// Offsets drawn with the density of a filter, so that every sample has the same weight.
pub struct PixelFilter {
    /// Cumulative distribution at evenly spaced offsets from −1 to 1.
    cumulative: Vec<f64>,
    half_width: f64,
}

impl PixelFilter {
    /// `width`: pixels from one end of the filter to the other, as in Cycles; 0 samples the pixel's centre alone.
    pub fn new(filter: Filter, width: f32) -> Self {
        const STEPS: usize = 1024;
        let mut cumulative = vec![0.0; STEPS + 1];
        for i in 0..STEPS {
            let x = (i as f64 + 0.5) / STEPS as f64 * 2.0 - 1.0;
            cumulative[i + 1] = cumulative[i] + filter.density(x);
        }
        let total = cumulative[STEPS];
        cumulative.iter_mut().for_each(|c| *c /= total);
        Self { cumulative, half_width: 0.5 * f64::from(width) }
    }

    /// Offset from the pixel's centre, pixels, for two uniform numbers.
    pub fn offset(&self, uniform: [f64; 2]) -> [f64; 2] {
        uniform.map(|u| {
            let steps = self.cumulative.len() - 1;
            let i = self.cumulative.partition_point(|c| *c <= u).clamp(1, steps);
            let (low, high) = (self.cumulative[i - 1], self.cumulative[i]);
            let share = if high > low { (u - low) / (high - low) } else { 0.5 };
            ((i as f64 - 1.0 + share) / steps as f64 * 2.0 - 1.0) * self.half_width
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Use, pair};
    use super::*;

    #[test]
    fn the_first_sample_is_the_centre() {
        let offset = PixelFilter::new(Filter::default(), 1.5).offset(pair(0, 0, Use::Pixel));
        assert!(offset[0].abs() < 1e-12 && offset[1].abs() < 1e-12, "{offset:?}");
    }

    #[test]
    fn offsets_have_the_filters_spread() {
        // Variance of the window over [−1, 1] in closed form: (2/3 a₀ + Σ ∓ 4 a_k / (kπ)²) / 2a₀ = 0.076737.
        // Of an even one: 1/3; of the Gaussian: 1/36.
        for (kind, expected) in
            [(Filter::BlackmanHarris, 0.076_737), (Filter::Box, 1.0 / 3.0), (Filter::Gaussian, 1.0 / 36.0)]
        {
            let filter = PixelFilter::new(kind, 2.0);
            let n = 20_000;
            let variance = (0..n).map(|i| filter.offset(pair(i, 0, Use::Pixel))[0].powi(2)).sum::<f64>() / f64::from(n);
            assert!((variance - expected).abs() < 2e-4, "{kind:?}: {variance}");
        }
    }
}
