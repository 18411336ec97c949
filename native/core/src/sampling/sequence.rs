use std::f64::consts::{FRAC_PI_4, TAU};

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

/// Point `index` of the sequence for a lens: powers of the root of x³ = x² + 1, which are independent of those of [`r2`], so that places
/// on the lens and on lights combine in all ways. Shifted by `seed`, but the first one is (½, ½) for every seed.
pub fn lens_pair(index: u32, seed: u32) -> [f64; 2] {
    const SUPERGOLDEN: f64 = 1.465_571_231_876_768;
    /// Beside the dimensions of [`r2`].
    const DIMENSION: u32 = 3;
    if index == 0 {
        return [0.5; 2];
    }
    let shift = |axis| {
        if seed == 0 { 0.5 } else { unit_from_hash(hash_combine(hash_combine(seed, DIMENSION), axis)) }
    };
    let i = f64::from(index);
    [(shift(0) + i / SUPERGOLDEN).fract(), (shift(1) + i / (SUPERGOLDEN * SUPERGOLDEN)).fract()]
}

/// Number `index` of the sequence for times, in [0, 1): multiples of the golden ratio, shifted by `seed`. The first is ½ for every seed.
pub fn time(index: u32, seed: u32) -> f64 {
    const GOLDEN: f64 = 1.618_033_988_749_895;
    /// Beside the dimensions of [`r2`].
    const DIMENSION: u32 = 4;
    if index == 0 {
        return 0.5;
    }
    let shift = if seed == 0 { 0.5 } else { unit_from_hash(hash_combine(seed, DIMENSION)) };
    (shift + f64::from(index) / GOLDEN).fract()
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

/// The same, by a map that keeps neighbours together and (½, ½) at the centre [ShirleyChiu1997].
pub fn concentric_disc(uniform: [f64; 2]) -> [f64; 2] {
    let [x, y] = uniform.map(|u| 2.0 * u - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0; 2];
    }
    let (r, angle) =
        if x.abs() > y.abs() { (x, FRAC_PI_4 * (y / x)) } else { (y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (x / y)) };
    [r * angle.cos(), r * angle.sin()]
}

/// Two unit vectors that complete `z` to a right-handed frame (Duff et al. 2017).
pub fn basis(z: DVec3) -> (DVec3, DVec3) {
    z.any_orthonormal_pair()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_concentric_map_keeps_areas() {
        let n = 4096;
        let points: Vec<_> = (0..n).map(|i| concentric_disc(r2(i, 0, 0))).collect();
        // A disc of half the radius has a quarter of the area; second moments are those of a disc.
        let inner = points.iter().filter(|p| p[0].hypot(p[1]) < 0.5).count() as f64 / f64::from(n);
        let square = points.iter().map(|p| p[0] * p[0]).sum::<f64>() / f64::from(n);
        assert!((inner - 0.25).abs() < 0.005 && (square - 0.25).abs() < 0.002, "{inner} {square}");
    }

    /// The mean of (-1)^(half in which the lens is, and the light), which is 0 for sequences that are independent.
    #[test]
    fn lens_and_lights_combine_in_all_ways() {
        let correlation = |lens: &dyn Fn(u32) -> [f64; 2]| {
            let n = 4096;
            let sign = |u: f64| if u < 0.5 { -1.0 } else { 1.0 };
            let mut most = 0.0_f64;
            for axes in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let sum: f64 = (0..n).map(|i| sign(lens(i)[axes.0]) * sign(r2(i, 5, 16)[axes.1])).sum();
                most = most.max((sum / f64::from(n)).abs());
            }
            most
        };
        assert!(correlation(&|i| lens_pair(i, 5)) < 0.02, "{}", correlation(&|i| lens_pair(i, 5)));
        assert!(correlation(&|i| r2(i, 5, 2)) > 0.1, "the test cannot fail");
    }

    #[test]
    fn times_fill_the_shutter() {
        assert_eq!((time(0, 0), time(0, 9)), (0.5, 0.5));
        for seed in [0, 9] {
            let mut times: Vec<_> = (0..32).map(|i| time(i, seed)).collect();
            times.sort_by(f64::total_cmp);
            let widest = times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
            assert!(widest < 2.5 / 32.0, "{widest}");
        }
    }

    #[test]
    fn directions_cover_the_sphere() {
        let n = 4096;
        let mean: DVec3 = (0..n).map(|i| sphere(r2(i, 3, 1))).sum::<DVec3>() / f64::from(n);
        assert!(mean.length() < 0.01, "{mean}");
    }
}
