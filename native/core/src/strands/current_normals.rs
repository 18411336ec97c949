//! Current normals: rest normals carried by the local rotation from rest to current shape.
//!
//! # How it works
//! For each knot the rotation that best carries the rest edges of a window of ±7 edges onto the current ones turns
//! the rest normal; the smallest rotation onto the current tangent then makes it perpendicular. The window makes
//! this local: a control point has no influence beyond 7 knots, except through the rotation below. Edges count by
//! weights that fall smoothly to zero at the window's ends, so nothing jumps as the window moves along.
//!
//! Where the window is straight at rest, its edges leave the turn about it open. The rotation of the whole curve,
//! with a small weight, decides there: so a rigid motion carries every fiber exactly, and a nearly straight stretch
//! goes over into a straight one without a jump. A whole curve that is straight turns by the smallest rotation.
//!
//! No rule that is local and takes no account of the frames between can be continuous for a straight stretch whose
//! tangent turns by exactly 180° against the rotation of its curve: the turn about the tangent is arbitrary there, and changes at
//! once when the motion passes through that pose.

use super::rest_normals::rotate_between;
use super::rotation::Correlation;
use super::tangents::unit_or_zero;
use super::{Layout, Stretch, split_mut};
use crate::curve::{to_f32, to_f64};
use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;

/// Edges on either side of a knot that its rotation depends on.
const REACH: usize = 7;

/// Weight of the whole curve's rotation against the window's edges. Edges that deviate by more than the square root of this (about
/// 2°) from one line decide by themselves.
const CURVE_WEIGHT: f64 = 1e-3;

/// Weight of the identity in the rotation of a whole curve, and how often the result replaces it: a curve that
/// deviates from a line by 3° or more forgets the identity, a straight one keeps it.
const IDENTITY_WEIGHT: f64 = 1e-4;
const IDENTITY_ROUNDS: usize = 4;

/// Knots per parallel task; their edge products fit the first-level cache.
const STRETCH: usize = 256;

/// Components of an edge product: nine of the matrix, one of the scale.
const PRODUCT: usize = 10;

/// Rest and current state of all knots.
pub(super) struct Shapes<'a> {
    pub layout: Layout<'a>,
    pub rest_positions: &'a [[f32; 3]],
    pub rest_tangents: &'a [[f32; 3]],
    pub rest_normals: &'a [[f32; 3]],
    pub positions: &'a [[f32; 3]],
    pub tangents: &'a [[f32; 3]],
}

/// One unit normal per knot, perpendicular to its current tangent. A curve in its rest shape gets its rest normals, bit for bit.
pub(super) fn current_normals(shapes: &Shapes<'_>) -> Vec<[f32; 3]> {
    let rotations = curve_rotations(shapes);
    let weights = window();
    let stretches = shapes.layout.stretches(STRETCH);
    let mut normals = vec![[0.0; 3]; shapes.positions.len()];
    split_mut(&mut normals, &stretches).into_par_iter().zip(&stretches).for_each_init(
        Scratch::default,
        |scratch, (normals, stretch)| match rotations[stretch.curve] {
            Some(rotation) => turn_stretch(shapes, stretch, rotation, &weights, scratch, normals),
            None => normals.copy_from_slice(&shapes.rest_normals[stretch.start..stretch.end]),
        },
    );
    normals
}

/// Weights of the `2 REACH` edges about a knot.
fn window() -> [f64; 2 * REACH] {
    std::array::from_fn(|j| {
        let x = (j as f64 + 0.5 - REACH as f64) / REACH as f64;
        (1.0 - x * x).powi(2)
    })
}

/// The best rotation of each whole curve; `None` for a curve in its rest shape.
fn curve_rotations(shapes: &Shapes<'_>) -> Vec<Option<DQuat>> {
    let stretches = shapes.layout.stretches(16 * STRETCH);
    let sums: Vec<(bool, Correlation)> =
        stretches.par_iter().map(|stretch| correlate_stretch(shapes, stretch)).collect();
    let mut curves = vec![(false, Correlation::ZERO); shapes.layout.len()];
    for (stretch, (moved, sum)) in stretches.iter().zip(sums) {
        let curve = &mut curves[stretch.curve];
        curve.0 |= moved;
        curve.1.matrix += sum.matrix;
        curve.1.scale += sum.scale;
    }
    let rotation =
        |sum: &Correlation| (0..IDENTITY_ROUNDS).fold(DQuat::IDENTITY, |prior, _| sum.rotation(prior, IDENTITY_WEIGHT));
    curves.par_iter().map(|(moved, sum)| moved.then(|| rotation(sum))).collect()
}

/// Whether a stretch has left its rest shape, and the correlation of its edges.
fn correlate_stretch(shapes: &Shapes<'_>, stretch: &Stretch) -> (bool, Correlation) {
    let knots = stretch.start..stretch.end;
    let moved = shapes.positions[knots.clone()] != shapes.rest_positions[knots.clone()];
    let mut sum = [0.0; PRODUCT];
    for knot in knots {
        if let Some(product) = edge_product(shapes, stretch.curve, knot as isize) {
            for (s, p) in sum.iter_mut().zip(product) {
                *s += p;
            }
        }
    }
    (moved, correlation(sum))
}

fn correlation(p: [f64; PRODUCT]) -> Correlation {
    let matrix =
        DMat3::from_cols(DVec3::new(p[0], p[1], p[2]), DVec3::new(p[3], p[4], p[5]), DVec3::new(p[6], p[7], p[8]));
    Correlation { matrix, scale: p[9] }
}

/// `e_current e_restᵀ` by columns, and the product of their lengths, for the edge from knot `from` (it may lie beyond the
/// curve's ends) to the next. `None` beyond the ends of an open curve.
fn edge_product(shapes: &Shapes<'_>, curve: usize, from: isize) -> Option<[f64; PRODUCT]> {
    let range = shapes.layout.range(curve);
    let n = range.len() as isize;
    let local = from - range.start as isize;
    let (a, b) = if shapes.layout.closed[curve] {
        (local.rem_euclid(n), (local + 1).rem_euclid(n))
    } else if local >= 0 && local + 1 < n {
        (local, local + 1)
    } else {
        return None;
    };
    let (a, b) = (range.start + a as usize, range.start + b as usize);
    let rest = to_f64(shapes.rest_positions[b]) - to_f64(shapes.rest_positions[a]);
    let current = to_f64(shapes.positions[b]) - to_f64(shapes.positions[a]);
    let (x, y, z) = (current * rest.x, current * rest.y, current * rest.z);
    let scale = (rest.length_squared() * current.length_squared()).sqrt();
    Some([x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z, scale])
}

/// Edge products and their weighted sums, component by component, so that the sums run over consecutive numbers.
struct Scratch {
    products: [[f64; STRETCH + 2 * REACH]; PRODUCT],
    sums: [[f64; STRETCH]; PRODUCT],
}

impl Default for Scratch {
    fn default() -> Self {
        Self { products: [[0.0; STRETCH + 2 * REACH]; PRODUCT], sums: [[0.0; STRETCH]; PRODUCT] }
    }
}

fn turn_stretch(
    shapes: &Shapes<'_>,
    stretch: &Stretch,
    curve_rotation: DQuat,
    weights: &[f64; 2 * REACH],
    Scratch { products, sums }: &mut Scratch,
    normals: &mut [[f32; 3]],
) {
    let count = stretch.end - stretch.start;
    for edge in 0..count + 2 * REACH - 1 {
        let from = (stretch.start + edge) as isize - REACH as isize;
        let product = edge_product(shapes, stretch.curve, from).unwrap_or([0.0; PRODUCT]);
        for (component, value) in products.iter_mut().zip(product) {
            component[edge] = value;
        }
    }
    for (sums, products) in sums.iter_mut().zip(products) {
        sums[..count].fill(0.0);
        for (j, weight) in weights.iter().enumerate() {
            for (sum, product) in sums[..count].iter_mut().zip(&products[j..]) {
                *sum += weight * product;
            }
        }
    }
    for (k, normal) in normals.iter_mut().enumerate() {
        let knot = stretch.start + k;
        let rotation = correlation(std::array::from_fn(|c| sums[c][k])).rotation(curve_rotation, CURVE_WEIGHT);
        let carried = rotation * to_f64(shapes.rest_normals[knot]);
        let from = unit_or_zero(rotation * to_f64(shapes.rest_tangents[knot]));
        let tangent = unit_or_zero(to_f64(shapes.tangents[knot]));
        let turned = rotate_between(carried, from, tangent);
        *normal = to_f32(unit_or_zero(turned - tangent * turned.dot(tangent)));
    }
}
