//! Unit tangents of a uniform Catmull-Rom curve at its knots.

use super::{Layout, split_mut};
use crate::curve::{to_f32, to_f64};
use glam::DVec3;
use rayon::prelude::*;

const STRETCH: usize = 4096;

/// One unit tangent per knot. Where the derivative vanishes (repeated points, a reversal), the tangent of the knot
/// before is kept, at a curve's start that of the knot after. If it vanishes everywhere, the first edge gives the
/// direction; a curve whose knots all coincide keeps `fallback`.
pub(super) fn tangents(positions: &[[f32; 3]], layout: Layout<'_>, fallback: Option<&[[f32; 3]]>) -> Vec<[f32; 3]> {
    let mut tangents = vec![[0.0; 3]; positions.len()];
    let stretches = layout.stretches(STRETCH);
    let vanishing: Vec<usize> = split_mut(&mut tangents, &stretches)
        .into_par_iter()
        .zip(&stretches)
        .filter_map(|(out, stretch)| {
            let range = layout.range(stretch.curve);
            let knots = &positions[range.clone()];
            let mut vanishes = false;
            for (k, slot) in out.iter_mut().enumerate() {
                *slot = tangent(knots, layout.closed[stretch.curve], stretch.start - range.start + k);
                vanishes |= *slot == [0.0; 3];
            }
            vanishes.then_some(stretch.curve)
        })
        .collect();
    let mut done = None;
    for curve in vanishing {
        if done != Some(curve) {
            let range = layout.range(curve);
            fill(&mut tangents[range.clone()], &positions[range.clone()], fallback.map(|f| &f[range]));
            done = Some(curve);
        }
    }
    tangents
}

/// The normalised derivative at a knot, or zero where it vanishes.
fn tangent(knots: &[[f32; 3]], closed: bool, k: usize) -> [f32; 3] {
    let last = knots.len() - 1;
    let at = |i: usize| to_f64(knots[i]);
    let difference = match k {
        0 if closed => at(1) - at(last),
        0 => at(1) - at(0),
        k if k < last => at(k + 1) - at(k - 1),
        _ if closed => at(0) - at(last - 1),
        _ => at(last) - at(last - 1),
    };
    to_f32(unit_or_zero(difference))
}

/// The unit vector; zero for zero. Any other f32 difference has a length that f64 can hold.
pub(super) fn unit_or_zero(v: DVec3) -> DVec3 {
    let length = v.length();
    if length > 0.0 { v / length } else { DVec3::ZERO }
}

fn fill(tangents: &mut [[f32; 3]], knots: &[[f32; 3]], fallback: Option<&[[f32; 3]]>) {
    let Some(first) = tangents.iter().position(|t| *t != [0.0; 3]) else {
        if let Some(edge) = knots.windows(2).find(|edge| edge[0] != edge[1]) {
            tangents.fill(to_f32(unit_or_zero(to_f64(edge[1]) - to_f64(edge[0]))));
        } else if let Some(fallback) = fallback {
            tangents.copy_from_slice(fallback);
        }
        return;
    };
    let start = tangents[first];
    tangents[..first].fill(start);
    for k in first + 1..tangents.len() {
        if tangents[k] == [0.0; 3] {
            tangents[k] = tangents[k - 1];
        }
    }
}
