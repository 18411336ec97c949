//! Non-uniform rational B-splines: knot vectors and basis functions.

/// The highest order (degree + 1) of a NURBS curve.
pub const MAX_ORDER: usize = 12;

/// What a NURBS curve has besides its control points.
#[derive(Debug, Clone, PartialEq)]
pub struct Nurbs {
    /// Degree + 1, in `2..=MAX_ORDER`.
    pub order: usize,
    /// One positive weight per control point; `None` means all 1.
    pub weights: Option<Vec<f32>>,
    /// The knot vector.
    pub knots: KnotMode,
}

/// A knot vector, by Blender's modes or explicitly.
#[derive(Debug, Clone, PartialEq)]
pub enum KnotMode {
    /// Uniform knots.
    Normal,
    /// Uniform knots, clamped: an open curve starts and ends at its end points.
    Endpoint,
    /// Inner knots of multiplicity `order - 1`: Bézier segments. A closed curve needs a multiple of `order - 1` points.
    Bezier,
    /// Bézier segments, clamped.
    EndpointBezier,
    /// `points + order` non-decreasing knots; for a closed curve `points + 2 order - 1`, where the last
    /// `2 order - 1` repeat the first ones, shifted by the period.
    Explicit(Vec<f64>),
}

/// Basis functions of one parameter: value, first and second derivative for each of `order` control points.
pub(super) struct Weights {
    pub value: [f64; MAX_ORDER],
    pub first: [f64; MAX_ORDER],
    pub second: [f64; MAX_ORDER],
}

impl Nurbs {
    /// Knots that a curve of `points` control points needs.
    pub(super) fn knot_count(&self, points: usize, closed: bool) -> usize {
        points + self.order + if closed { self.order - 1 } else { 0 }
    }

    /// The knot vector for `points` control points. Blender's modes are described by the multiplicities of
    /// successive integer knots.
    pub(super) fn knot_vector(&self, points: usize, closed: bool) -> Vec<f64> {
        let order = self.order;
        let (clamped, inner) = match &self.knots {
            KnotMode::Explicit(knots) => return knots.clone(),
            KnotMode::Normal => (false, 1),
            KnotMode::Endpoint => (true, 1),
            KnotMode::Bezier => (false, order - 1),
            KnotMode::EndpointBezier => (true, order - 1),
        };
        let count = self.knot_count(points, closed);
        // Multiplicities of the first knots: a clamped closed curve has a single knot, then one full group.
        let head: &[usize] = match (clamped, closed) {
            (true, true) => &[1, order - 1],
            (true, false) => &[order],
            (false, _) => &[inner.min(2)],
        };
        // The part before the repetition (closed) or before the clamped end (open).
        let body = count
            - if closed {
                2 * order - 1
            } else if clamped {
                order
            } else {
                0
            };
        let mut knots = Vec::with_capacity(count);
        let mut value = 0.0;
        let mut groups = head.iter().copied().chain(std::iter::repeat(inner));
        let mut left = groups.next().unwrap_or(1);
        while knots.len() < body {
            knots.push(value);
            left -= 1;
            if left == 0 {
                value += 1.0;
                left = groups.next().unwrap_or(1);
            }
        }
        for i in 0..count - body {
            knots.push(if closed { value + knots[i] - knots[0] } else { value });
        }
        knots
    }
}

/// Basis functions that are non-zero on the span `knots[span]..knots[span + 1]`, by the Cox-de Boor recursion, and
/// their derivatives by differences of the next lower degree ([PieglTiller1997], Eqs. 2.5 and 2.7).
/// Entry `j` belongs to control point `span - degree + j`.
pub(super) fn basis_functions(knots: &[f64], span: usize, order: usize, u: f64) -> Weights {
    let ratio = |numerator: f64, denominator: f64| if denominator > 0.0 { numerator / denominator } else { 0.0 };
    let mut w = Weights { value: [0.0; MAX_ORDER], first: [0.0; MAX_ORDER], second: [0.0; MAX_ORDER] };
    w.value[0] = 1.0;
    for degree in 1..order {
        let lower = Weights { value: w.value, first: w.first, second: w.second };
        for j in 0..=degree {
            let i = span - degree + j;
            let (mut value, mut first, mut second) = (0.0, 0.0, 0.0);
            if j > 0 {
                let width = knots[i + degree] - knots[i];
                value += ratio(u - knots[i], width) * lower.value[j - 1];
                first += ratio(degree as f64, width) * lower.value[j - 1];
                second += ratio(degree as f64, width) * lower.first[j - 1];
            }
            if j < degree {
                let width = knots[i + degree + 1] - knots[i + 1];
                value += ratio(knots[i + degree + 1] - u, width) * lower.value[j];
                first -= ratio(degree as f64, width) * lower.value[j];
                second -= ratio(degree as f64, width) * lower.first[j];
            }
            (w.value[j], w.first[j], w.second[j]) = (value, first, second);
        }
    }
    w
}

/// Turns basis functions into rational ones by the quotient rule; `weights[j]` belongs to entry `j`.
pub(super) fn rationalise(w: &mut Weights, weights: &[f64]) {
    let (mut sum, mut sum_1, mut sum_2) = (0.0, 0.0, 0.0);
    for (j, weight) in weights.iter().enumerate() {
        w.value[j] *= weight;
        w.first[j] *= weight;
        w.second[j] *= weight;
        sum += w.value[j];
        sum_1 += w.first[j];
        sum_2 += w.second[j];
    }
    for j in 0..weights.len() {
        w.value[j] /= sum;
        w.first[j] = (w.first[j] - w.value[j] * sum_1) / sum;
        w.second[j] = (w.second[j] - 2.0 * w.first[j] * sum_1 - w.value[j] * sum_2) / sum;
    }
}
