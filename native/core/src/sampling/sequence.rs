use std::f64::consts::{FRAC_PI_4, TAU};

use super::hash_combine;
use glam::DVec3;

/// What the numbers of a sample are for. Each use has a sequence of its own, so that places in the pixel combine with those on a light in
/// all ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Places in a pixel.
    Pixel,
    /// Places on the lens.
    Lens,
    /// Times while the shutter is open; the first of the two numbers.
    Time,
    /// Directions of an even sky.
    Sky,
    /// Directions of a picture of the sky.
    Environment,
    /// Places on a light, by its number.
    Light(u32),
}

impl Use {
    fn key(self) -> u32 {
        match self {
            Self::Pixel => 0,
            Self::Lens => 1,
            Self::Time => 2,
            Self::Sky => 3,
            Self::Environment => 4,
            Self::Light(number) => number.wrapping_add(16),
        }
    }

    /// Whether the first sample is the middle: of the pixel, of the lens, of the time.
    fn begins_in_the_middle(self) -> bool {
        matches!(self, Self::Pixel | Self::Lens | Self::Time)
    }
}

/// Flips each binary digit of a fraction or not, as the digits above it and a key have it [Owen1995].
fn scrambled(fraction: u32, key: u32) -> u32 {
    (0..32).fold(0, |flips, place| {
        // The node of the tree of digits that the ones above lead to.
        let node = 1 << place | (u64::from(fraction) >> (32 - place)) as u32;
        flips | (hash_combine(key, node) & 1) << (31 - place)
    }) ^ fraction
}

/// The second axis of the sequence of Sobol', whose first one is the index with its digits reversed: Pascal's triangle modulo 2.
fn second_axis(index: u32) -> u32 {
    let mut column = 1_u32 << 31;
    (0..32).fold(0, |sum, digit| {
        let added = if index >> digit & 1 == 1 { sum ^ column } else { sum };
        column ^= column >> 1;
        added
    })
}

fn fractions(index: u32, seed: u32, of: Use) -> [u32; 2] {
    let key = |axis| hash_combine(hash_combine(seed, of.key()), axis);
    // Blocks of 2^k points remain, in another order within them.
    let place = scrambled(index, key(0));
    [scrambled(place.reverse_bits(), key(1)), scrambled(second_axis(place), key(2))]
}

/// Point `index` of a sequence in the unit square: the (0, 2)-sequence of Sobol', scrambled by use and seed [Owen1995] and in another order for
/// each use [Burley2020]. Every 2^k points from a multiple of 2^k on are even, and points of different uses are independent.
///
/// The first point is (½, ½) for a pixel, a lens and a time.
pub fn pair(index: u32, seed: u32, of: Use) -> [f64; 2] {
    const MIDDLE: u32 = 1 << 31;
    let mut point = fractions(index, seed, of);
    if of.begins_in_the_middle() {
        // The same digits flipped for all points, which are as even then.
        let first = fractions(0, seed, of);
        point = [0, 1].map(|axis| point[axis] ^ first[axis] ^ MIDDLE);
    }
    point.map(|fraction| f64::from(fraction) / 4_294_967_296.0)
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
        let points: Vec<_> = (0..n).map(|i| concentric_disc(pair(i, 0, Use::Lens))).collect();
        // A disc of half the radius has a quarter of the area; second moments are those of a disc.
        let inner = points.iter().filter(|p| p[0].hypot(p[1]) < 0.5).count() as f64 / f64::from(n);
        let square = points.iter().map(|p| p[0] * p[0]).sum::<f64>() / f64::from(n);
        assert!((inner - 0.25).abs() < 0.005 && (square - 0.25).abs() < 0.002, "{inner} {square}");
    }

    /// How unevenly the pairs of two numbers of as many samples fill a grid: χ² of its cells, over the number of these.
    fn unevenness(numbers: impl Iterator<Item = [f64; 2]>) -> f64 {
        const CELLS: usize = 16;
        let mut counts = [0.0_f64; CELLS * CELLS];
        let mut samples = 0.0;
        for [a, b] in numbers {
            counts[(a * CELLS as f64) as usize * CELLS + (b * CELLS as f64) as usize] += 1.0;
            samples += 1.0;
        }
        let expected = samples / counts.len() as f64;
        counts.iter().map(|count| (count - expected).powi(2) / expected).sum::<f64>() / counts.len() as f64
    }

    /// The worst of the axes of two uses.
    fn worst_axes(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
        let of = |x: usize, y: usize| unevenness(a.iter().zip(b).map(|(a, b)| [a[x], b[y]]));
        [of(0, 0), of(0, 1), of(1, 0), of(1, 1)].into_iter().fold(0.0, f64::max)
    }

    #[test]
    fn all_uses_combine_in_all_ways() {
        let mut uses = vec![Use::Pixel, Use::Lens, Use::Time, Use::Sky, Use::Environment];
        uses.extend((0..4).map(Use::Light));
        // Each sample takes one of a use, or several of one of them.
        let points = |of: Use, seed, stride: u32| (0..8192).map(|i| pair(stride * i, seed, of)).collect::<Vec<_>>();
        for seed in [0, 5] {
            let single: Vec<_> = uses.iter().map(|of| points(*of, seed, 1)).collect();
            let fourth: Vec<_> = uses.iter().map(|of| points(*of, seed, 4)).collect();
            for i in 0..uses.len() {
                for k in (0..uses.len()).filter(|k| *k != i) {
                    let found = worst_axes(&single[i], &single[k]).max(worst_axes(&single[i], &fourth[k]));
                    // 1 for independent ones, give or take a half.
                    assert!(found < 2.5, "{:?} and {:?}, seed {seed}: {found}", uses[i], uses[k]);
                }
            }
            // Shifts of one sequence leave most of the grid empty.
            let shifted: Vec<_> = single[0].iter().map(|point| point.map(|u| (u + 0.3).fract())).collect();
            let found = worst_axes(&single[0], &shifted);
            assert!(found > 10.0, "the test cannot fail: {found}");
        }
    }

    #[test]
    fn points_are_even_in_every_part_of_the_sequence() {
        for of in [Use::Pixel, Use::Light(3)] {
            for (seed, first) in [(0, 0), (7, 8), (9, 1 << 20)] {
                for k in 0..=6 {
                    // One point in each box of that area, whatever its shape.
                    for columns in (0..=k).map(|split| 1 << split) {
                        let rows = (1 << k) / columns;
                        let mut boxes: Vec<_> = (first >> k << k..)
                            .take(1 << k)
                            .map(|i| pair(i, seed, of))
                            .map(|[u, v]| (v * f64::from(rows)) as u32 * columns + (u * f64::from(columns)) as u32)
                            .collect();
                        boxes.sort_unstable();
                        assert!(boxes.into_iter().eq(0..1 << k), "{of:?}, {columns} × {rows} from {first}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_first_sample_is_the_middle() {
        for of in [Use::Pixel, Use::Lens, Use::Time] {
            for seed in [0, 9] {
                assert_eq!(pair(0, seed, of), [0.5; 2]);
            }
        }
        assert_ne!(pair(0, 0, Use::Light(0)), pair(0, 0, Use::Light(1)));
    }

    #[test]
    fn directions_cover_the_sphere() {
        let n = 4096;
        let mean: DVec3 = (0..n).map(|i| sphere(pair(i, 3, Use::Sky))).sum::<DVec3>() / f64::from(n);
        assert!(mean.length() < 0.01, "{mean}");
    }
}
