use std::f64::consts::TAU;

use super::{hash_combine, unit_from_hash};
use glam::DVec3;

/// Point `index` of the R2 sequence (Roberts 2018: powers of the plastic number), shifted by `seed` and `dimension`.
///
/// With seed 0 and dimension 0 it starts at (0.5, 0.5): the first sample of a pixel is its centre.
pub fn r2(index: u32, seed: u32, dimension: u32) -> [f64; 2] {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let shift = |axis| {
        if seed == 0 && dimension == 0 {
            0.5
        } else {
            unit_from_hash(hash_combine(hash_combine(seed, dimension), axis))
        }
    };
    let i = f64::from(index);
    [(shift(0) + i / PLASTIC).fract(), (shift(1) + i / (PLASTIC * PLASTIC)).fract()]
}

/// A uniform direction.
pub fn sphere([u, v]: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u;
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * (TAU * v).cos(), r * (TAU * v).sin(), z)
}

/// A uniform point of the unit disc.
pub fn disc([u, v]: [f64; 2]) -> [f64; 2] {
    let r = u.sqrt();
    [r * (TAU * v).cos(), r * (TAU * v).sin()]
}

/// Two unit vectors that complete `z` to a right-handed frame (Duff et al. 2017).
pub fn basis(z: DVec3) -> (DVec3, DVec3) {
    z.any_orthonormal_pair()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_cover_the_sphere() {
        let n = 4096;
        let mean: DVec3 = (0..n).map(|i| sphere(r2(i, 3, 1))).sum::<DVec3>() / f64::from(n);
        assert!(mean.length() < 0.01, "{mean}");
    }
}
