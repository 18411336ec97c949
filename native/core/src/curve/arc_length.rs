//! Arc length by Gauss-Legendre quadrature with subdivision.

use super::evaluate::Segment;

/// Nodes in `[0, 1]` and weights of the five-point rule.
const NODES: [f64; 5] =
    [0.046_910_077_030_668_0, 0.230_765_344_947_158_5, 0.5, 0.769_234_655_052_841_5, 0.953_089_922_969_332];
const WEIGHTS: [f64; 5] = [
    0.118_463_442_528_094_5,
    0.239_314_335_249_683_2,
    0.284_444_444_444_444_4,
    0.239_314_335_249_683_2,
    0.118_463_442_528_094_5,
];

/// An interval is halved until the rule on it and the rule on its halves agree to this relative difference. The
/// halves' own error is far smaller, save at a cusp, where it shrinks fourfold per halving.
const AGREEMENT: f64 = 1e-6;

/// Halvings at most: an interval of 2^-24 of a segment no longer matters.
const MAX_DEPTH: u32 = 24;

/// Length between two parameters of a segment.
pub(super) fn arc_length(segment: &Segment<'_>, t0: f64, t1: f64) -> f64 {
    let whole = gauss_legendre(segment, t0, t1);
    refine(segment, t0, t1, whole, MAX_DEPTH)
}

fn refine(segment: &Segment<'_>, t0: f64, t1: f64, whole: f64, depth: u32) -> f64 {
    let middle = 0.5 * (t0 + t1);
    let left = gauss_legendre(segment, t0, middle);
    let right = gauss_legendre(segment, middle, t1);
    let halves = left + right;
    if depth == 0 || (whole - halves).abs() <= AGREEMENT * halves {
        return halves;
    }
    refine(segment, t0, middle, left, depth - 1) + refine(segment, middle, t1, right, depth - 1)
}

fn gauss_legendre(segment: &Segment<'_>, t0: f64, t1: f64) -> f64 {
    let width = t1 - t0;
    width * (0..5).map(|i| WEIGHTS[i] * segment.speed(t0 + width * NODES[i])).sum::<f64>()
}
