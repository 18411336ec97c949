//! Rest normals: a rotation-minimising frame along each rest curve, closed without a seam.

use super::{Layout, split_mut, tangents::unit_or_zero};
use crate::curve::{to_f32, to_f64};
use glam::{DQuat, DVec3};
use rayon::prelude::*;

/// One unit normal per knot, perpendicular to its tangent. A closed curve's frame, once around, misses its start by an
/// angle; that angle is distributed over the curve in proportion to the rest length.
pub(super) fn rest_normals(
    positions: &[[f32; 3]],
    tangents: &[[f32; 3]],
    lengths: &[f64],
    total_lengths: &[f64],
    layout: Layout<'_>,
) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; positions.len()];
    let curves = layout.stretches(usize::MAX / 2);
    split_mut(&mut normals, &curves).into_par_iter().zip(&curves).for_each(|(normals, curve)| {
        let knots = curve.start..curve.end;
        let total = layout.closed[curve.curve].then_some(total_lengths[curve.curve]);
        transport(&positions[knots.clone()], &tangents[knots.clone()], &lengths[knots], total, normals);
    });
    normals
}

/// Frames of one curve; `closed_length` is its total length if it is closed.
fn transport(
    positions: &[[f32; 3]],
    tangents: &[[f32; 3]],
    lengths: &[f64],
    closed_length: Option<f64>,
    normals: &mut [[f32; 3]],
) {
    let tangent = |k: usize| unit_or_zero(to_f64(tangents[k]));
    let step = |normal: DVec3, from: usize, to: usize| {
        double_reflection(normal, tangent(from), tangent(to), to_f64(positions[to]) - to_f64(positions[from]))
    };
    let start = tangent(0).any_orthonormal_vector();
    let mut normal = start;
    normals[0] = to_f32(normal);
    for (k, slot) in normals.iter_mut().enumerate().skip(1) {
        normal = step(normal, k - 1, k);
        *slot = to_f32(normal);
    }
    if let Some(total) = closed_length {
        let arrived = step(normal, positions.len() - 1, 0);
        let missed = arrived.cross(start).dot(tangent(0)).atan2(arrived.dot(start));
        for (k, slot) in normals.iter_mut().enumerate().skip(1) {
            let turn = DQuat::from_axis_angle(tangent(k), missed * lengths[k] / total);
            *slot = to_f32(turn * to_f64(*slot));
        }
    }
}

/// Carries a normal from one knot to the next without turning it about the tangent, to fourth order in the step, by
/// two reflections [Wang2008]. Knots that coincide leave the rotation between their tangents.
fn double_reflection(normal: DVec3, tangent: DVec3, next_tangent: DVec3, edge: DVec3) -> DVec3 {
    let reflect = |v: DVec3, axis: DVec3| {
        let square = axis.length_squared();
        if square > 0.0 { v - axis * (2.0 * axis.dot(v) / square) } else { v }
    };
    let (normal, tangent) =
        if edge == DVec3::ZERO { (normal, tangent) } else { (reflect(normal, edge), reflect(tangent, edge)) };
    let axis = next_tangent - tangent;
    let carried =
        if edge == DVec3::ZERO { rotate_between(normal, tangent, next_tangent) } else { reflect(normal, axis) };
    unit_or_zero(carried - next_tangent * carried.dot(next_tangent))
}

/// Turns `v`, perpendicular to the unit vector `from`, by the smallest rotation that takes `from` to `to`. Opposite
/// directions leave it as it is: it is perpendicular to both.
pub(super) fn rotate_between(v: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let c = 1.0 + from.dot(to);
    if c > 1e-12 { v - (from + to) * (v.dot(to) / c) } else { v }
}
