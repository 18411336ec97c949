//! Tangents of fibers from the points of their chains: lobes a degree wide need them to a small part of that.

use glam::DVec3;

use crate::fibers::position;

/// Points on either side of which a tangent is made, at most.
const BESIDE: usize = 2;

/// Least distance of such points, radii of the fiber: closer ones tell no direction, by the rounding of f32.
const CLOSEST: f64 = 0.05;

/// The next point of the same chain, or the one before; a negative radius marks the last one.
fn neighbour(points: &[[f32; 4]], point: usize, forwards: bool) -> Option<usize> {
    if forwards {
        points[point][3].is_sign_positive().then_some(point + 1)
    } else {
        point.checked_sub(1).filter(|before| points[*before][3].is_sign_positive())
    }
}

/// The next point far enough away.
fn clear_neighbour(points: &[[f32; 4]], point: usize, forwards: bool) -> Option<usize> {
    let clear = CLOSEST * f64::from(points[point][3].abs());
    let mut next = neighbour(points, point, forwards)?;
    while position(points[next]).distance(position(points[point])) <= clear {
        next = neighbour(points, next, forwards)?;
    }
    Some(next)
}

/// Unit tangent at a point of a chain: of the polynomial through it and two points on either side, by the lengths of their chords.
///
/// A parabola through three points, as far apart as chords may be, is off by a third of a degree.
pub(crate) fn tangent_at(points: &[[f32; 4]], point: usize) -> DVec3 {
    let at = position(points[point]);
    let mut nodes = [(0.0, DVec3::ZERO); 2 * BESIDE];
    let mut count = 0;
    for (forwards, sign) in [(true, 1.0), (false, -1.0)] {
        let (mut last, mut length) = (point, 0.0);
        for _ in 0..BESIDE {
            let Some(next) = clear_neighbour(points, last, forwards) else { break };
            length += position(points[next]).distance(position(points[last]));
            nodes[count] = (sign * length, position(points[next]) - at);
            (last, count) = (next, count + 1);
        }
    }
    slope_at_zero(&nodes[..count]).normalize_or(DVec3::X)
}

/// Slope at 0 of the polynomial that is zero there and goes through all nodes: Lagrange's formula.
fn slope_at_zero(nodes: &[(f64, DVec3)]) -> DVec3 {
    let weight = |j: usize| {
        let at = nodes[j].0;
        let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
        others.map(|(_, (place, _))| place / (place - at)).product::<f64>() / at
    };
    (0..nodes.len()).map(|j| nodes[j].1 * weight(j)).sum()
}

/// Unit direction along the cubic over a chord with unit tangents at its ends; `along` from 0 to 1.
pub(crate) fn direction_along(chord: DVec3, tangents: [DVec3; 2], along: f64) -> DVec3 {
    let length = chord.length();
    let ends = [1.0 - along * (4.0 - 3.0 * along), along * (3.0 * along - 2.0)].map(|weight| weight * length);
    let middle = 6.0 * along * (1.0 - along);
    (chord * middle + tangents[0] * ends[0] + tangents[1] * ends[1]).normalize_or(tangents[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fiber that winds about its ply and wanders between half its radius and all of it.
    fn wandering(t: f64) -> DVec3 {
        let radius = 0.75 + 0.25 * (0.4 * t).cos();
        DVec3::new(1.2 * t, radius * t.cos(), radius * t.sin())
    }

    fn tangent(t: f64) -> DVec3 {
        (wandering(t + 1e-6) - wandering(t - 1e-6)).normalize()
    }

    /// Largest angle between the fiber's tangent and what is made of points about 0.35 radians apart, in steps that differ by a factor of two.
    fn error_rad(made: impl Fn(&[[f32; 4]], usize, f64) -> DVec3) -> f64 {
        let mut at = vec![0.0];
        for k in 0..60 {
            at.push(at[k] + if k % 5 < 2 { 0.175 } else { 0.35 });
        }
        let mut points: Vec<[f32; 4]> = at.iter().map(|t| wandering(*t).as_vec3().extend(0.05).to_array()).collect();
        points[60][3] = -0.05;
        let errors = (2..58).flat_map(|k| [0.0, 0.25, 0.5, 0.75].map(|along| (k, along))).map(|(k, along)| {
            let found = made(&points, k, along);
            found.angle_between(tangent(at[k] + along * (at[k + 1] - at[k])))
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn tangents_are_the_curves_to_a_twentieth_of_a_degree() {
        let found = error_rad(|points, k, along| {
            let chord = position(points[k + 1]) - position(points[k]);
            direction_along(chord, [tangent_at(points, k), tangent_at(points, k + 1)], along)
        });
        println!("within {:.4} degrees", found.to_degrees());
        assert!(found.to_degrees() < 0.05, "{}", found.to_degrees());
    }

    #[test]
    fn tangents_of_parabolas_mixed_evenly_are_rejected() {
        let parabola = |points: &[[f32; 4]], k: usize| {
            let [a, b] = [k - 1, k].map(|from| position(points[from + 1]) - position(points[from]));
            (a * b.length_squared() + b * a.length_squared()).normalize()
        };
        let found = error_rad(|points, k, along| parabola(points, k).lerp(parabola(points, k + 1), along).normalize());
        assert!(found.to_degrees() > 0.2, "{}", found.to_degrees());
    }

    #[test]
    fn short_chains_and_points_that_coincide_have_tangents() {
        let x = |x: f32, radius: f32| [x, 0.0, 0.0, radius];
        for chain in [
            vec![x(0.0, 1.0), x(1.0, -1.0)],
            vec![x(0.0, 1.0), x(1.0, 1.0), x(2.0, -1.0)],
            vec![x(0.0, 1.0), x(1.0, 1.0), x(1.0, 1.0), x(2.0, 1.0), x(3.0, -1.0)],
        ] {
            for point in 0..chain.len() {
                assert!(tangent_at(&chain, point).distance(DVec3::X) < 1e-9, "{point} of {chain:?}");
            }
        }
    }
}
