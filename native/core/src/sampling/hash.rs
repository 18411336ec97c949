/// Mixes 32 bits (a bijection with low bias, two multiply–xorshift rounds).
pub fn hash_u32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Folds one more key into a hash.
pub fn hash_combine(seed: u32, key: u32) -> u32 {
    hash_u32(seed ^ key.wrapping_mul(0x9e37_79b9).wrapping_add(0x7f4a_7c15))
}

/// The upper 24 bits as a number in [0, 1); exact in f32 and f64.
pub fn unit_from_hash(hash: u32) -> f64 {
    f64::from(hash >> 8) / f64::from(1 << 24)
}

/// A bounded stand-in for a standard normal variate: the sum of three 10-bit uniforms, zero mean, unit variance, within ±3.
///
/// Pure arithmetic, so that CPU and GPU agree to rounding.
pub fn normal_from_hash(hash: u32) -> f64 {
    let sum = (hash & 1023) + ((hash >> 10) & 1023) + ((hash >> 20) & 1023);
    (f64::from(sum) + 1.5) / 512.0 - 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_stand_in_has_zero_mean_and_unit_variance() {
        let n = 200_000_u32;
        let (sum, square) =
            (0..n).map(|i| normal_from_hash(hash_u32(i))).fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
        let n = f64::from(n);
        // Standard errors: 1/sqrt(n) = 0.0022 for the mean, below sqrt(2/n) = 0.0032 for the variance.
        assert!((sum / n).abs() < 0.01, "mean {}", sum / n);
        assert!((square / n - 1.0).abs() < 0.015, "variance {}", square / n);
    }
}
