//! The rotation that carries one set of vectors best onto another, after [Horn1987], for sets that may lie in a plane
//! or on a line.

use glam::{DMat3, DQuat};

/// `Σ w b aᵀ` over pairs of vectors, and `Σ w |a| |b|`.
#[derive(Clone, Copy)]
pub(super) struct Correlation {
    pub matrix: DMat3,
    pub scale: f64,
}

impl Correlation {
    pub const ZERO: Self = Self { matrix: DMat3::ZERO, scale: 0.0 };

    /// The rotation `q` that maximises `Σ w b · (q a)`, plus `weight * scale * tr(priorᵀ q)`: where the pairs leave a
    /// rotation open (all on one line), the one nearest to `prior` among the best. Pairs and prior that contradict
    /// each other exactly have two best rotations; then `prior` itself is returned.
    pub fn rotation(&self, prior: DQuat, weight: f64) -> DQuat {
        let h = self.matrix + DMat3::from_quat(prior) * (weight * self.scale);
        let k = quaternion_form(&h);
        // The sum of singular values of `h` bounds the largest eigenvalue from above.
        let bound = self.scale * (1.0 + 3.0 * weight);
        let Some(eigenvalue) = largest_eigenvalue(&h, &k, bound) else {
            return prior;
        };
        let mut shifted = k;
        for (i, row) in shifted.iter_mut().enumerate() {
            row[i] -= eigenvalue;
        }
        // The adjugate of the singular matrix is the outer product of the eigenvector with itself, times a factor.
        let adjugate = adjugate(&shifted);
        let column = (0..4).max_by(|&i, &j| adjugate[i][i].abs().total_cmp(&adjugate[j][j].abs())).unwrap_or(0);
        let [w, x, y, z] = adjugate[column];
        let q = DQuat::from_xyzw(x, y, z, w);
        let length = q.length();
        if length > 1e-12 * bound * bound * bound { q / length } else { prior }
    }
}

/// The symmetric matrix whose quadratic form over unit quaternions (w, x, y, z) is `tr(hᵀ q)` ([Horn1987], section 4).
fn quaternion_form(h: &DMat3) -> [[f64; 4]; 4] {
    // `s(a, b)`: from component a to component b.
    let s = |a: usize, b: usize| h.col(a)[b];
    let (wx, wy, wz) = (s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0));
    let (xy, yz, zx) = (s(0, 1) + s(1, 0), s(1, 2) + s(2, 1), s(2, 0) + s(0, 2));
    let (x, y, z) = (s(0, 0), s(1, 1), s(2, 2));
    [[x + y + z, wx, wy, wz], [wx, x - y - z, xy, zx], [wy, xy, y - x - z, yz], [wz, zx, yz, z - x - y]]
}

/// Newton's iteration on the characteristic polynomial from an upper bound: it descends to the largest root, however
/// close the next one is [Theobald2005].
fn largest_eigenvalue(h: &DMat3, k: &[[f64; 4]; 4], bound: f64) -> Option<f64> {
    let norm_squared = h.x_axis.length_squared() + h.y_axis.length_squared() + h.z_axis.length_squared();
    if !(norm_squared > 0.0 && bound > 0.0) {
        return None;
    }
    let c2 = -2.0 * norm_squared;
    let c1 = -8.0 * h.determinant();
    let c0 = determinant(k);
    let mut x = bound;
    for _ in 0..64 {
        let square = x * x;
        let value = (square + c2) * square + c1 * x + c0;
        let slope = (4.0 * square + 2.0 * c2) * x + c1;
        if slope <= 0.0 {
            break;
        }
        let step = value / slope;
        x -= step;
        if step.abs() <= 1e-15 * bound {
            break;
        }
    }
    Some(x)
}

/// 2 × 2 minors of the upper two and of the lower two rows.
fn minors(a: &[[f64; 4]; 4]) -> ([f64; 6], [f64; 6]) {
    const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let of = |r: usize| PAIRS.map(|(i, j)| a[r][i] * a[r + 1][j] - a[r + 1][i] * a[r][j]);
    (of(0), of(2))
}

fn determinant(a: &[[f64; 4]; 4]) -> f64 {
    let (s, c) = minors(a);
    s[0] * c[5] - s[1] * c[4] + s[2] * c[3] + s[3] * c[2] - s[4] * c[1] + s[5] * c[0]
}

/// Adjugate of a symmetric matrix (itself symmetric).
fn adjugate(a: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let (s, c) = minors(a);
    [
        [
            a[1][1] * c[5] - a[1][2] * c[4] + a[1][3] * c[3],
            -a[0][1] * c[5] + a[0][2] * c[4] - a[0][3] * c[3],
            a[3][1] * s[5] - a[3][2] * s[4] + a[3][3] * s[3],
            -a[2][1] * s[5] + a[2][2] * s[4] - a[2][3] * s[3],
        ],
        [
            -a[1][0] * c[5] + a[1][2] * c[2] - a[1][3] * c[1],
            a[0][0] * c[5] - a[0][2] * c[2] + a[0][3] * c[1],
            -a[3][0] * s[5] + a[3][2] * s[2] - a[3][3] * s[1],
            a[2][0] * s[5] - a[2][2] * s[2] + a[2][3] * s[1],
        ],
        [
            a[1][0] * c[4] - a[1][1] * c[2] + a[1][3] * c[0],
            -a[0][0] * c[4] + a[0][1] * c[2] - a[0][3] * c[0],
            a[3][0] * s[4] - a[3][1] * s[2] + a[3][3] * s[0],
            -a[2][0] * s[4] + a[2][1] * s[2] - a[2][3] * s[0],
        ],
        [
            -a[1][0] * c[3] + a[1][1] * c[1] - a[1][2] * c[0],
            a[0][0] * c[3] - a[0][1] * c[1] + a[0][2] * c[0],
            -a[3][0] * s[3] + a[3][1] * s[1] - a[3][2] * s[0],
            a[2][0] * s[3] - a[2][1] * s[1] + a[2][2] * s[0],
        ],
    ]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use glam::DVec3;

    fn correlate(pairs: &[(DVec3, DVec3)]) -> Correlation {
        let mut c = Correlation::ZERO;
        for &(a, b) in pairs {
            c.matrix += DMat3::from_cols(b * a.x, b * a.y, b * a.z);
            c.scale += a.length() * b.length();
        }
        c
    }

    fn score(c: &Correlation, prior: DQuat, weight: f64, q: DQuat) -> f64 {
        let h = c.matrix + DMat3::from_quat(prior) * (weight * c.scale);
        let r = DMat3::from_quat(q);
        (0..3).map(|i| h.col(i).dot(r.col(i))).sum()
    }

    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 33) as f64 / f64::from(1u32 << 31) * 2.0 - 1.0
    }

    fn vector(seed: &mut u64) -> DVec3 {
        DVec3::new(noise(seed), noise(seed), noise(seed))
    }

    fn turn(seed: &mut u64) -> DQuat {
        DQuat::from_xyzw(noise(seed), noise(seed), noise(seed), noise(seed)).normalize()
    }

    #[test]
    fn recovers_a_rotation_from_vectors_in_space_and_in_a_plane() {
        let mut seed = 1;
        for flat in [1.0, 1e-3, 0.0] {
            for _ in 0..200 {
                let q = turn(&mut seed);
                let pairs: Vec<_> =
                    (0..9).map(|_| vector(&mut seed) * DVec3::new(1.0, 1.0, flat)).map(|a| (a, q * a)).collect();
                let found = correlate(&pairs).rotation(q, 1e-3);
                assert!(found.dot(q).abs() > 1.0 - 1e-13, "{found} is not {q}");
                // With a wrong prior the answer is off by about the prior's weight, no more.
                let found = correlate(&pairs).rotation(DQuat::IDENTITY, 1e-9);
                assert!(found.angle_between(q).min(found.angle_between(-q)) < 1e-6);
            }
        }
    }

    #[test]
    fn on_a_line_takes_the_rotation_nearest_to_the_prior() {
        let mut seed = 2;
        for _ in 0..200 {
            let (a, b) = (vector(&mut seed).normalize(), vector(&mut seed).normalize());
            let expected = DQuat::from_rotation_arc(a, b);
            if a.dot(b) < -0.9 {
                continue; // Close to 180° the nearest rotation is ill determined.
            }
            // The prior bends the line by its weight, which tilts the rotation by as much.
            for weight in [1e-3, 1e-4] {
                let found = correlate(&[(a, b), (a * 2.0, b * 3.0)]).rotation(DQuat::IDENTITY, weight);
                let error = (1.0 - found.dot(expected).powi(2)).max(0.0).sqrt();
                assert!(error < weight, "{found} is not {expected}: {error}");
            }
        }
    }

    #[test]
    fn no_rotation_scores_higher_even_for_reflections() {
        let mut seed = 3;
        for _ in 0..200 {
            let pairs: Vec<_> = (0..5).map(|_| (vector(&mut seed), vector(&mut seed))).collect();
            let (c, prior) = (correlate(&pairs), turn(&mut seed));
            let best = score(&c, prior, 1e-3, c.rotation(prior, 1e-3));
            for _ in 0..200 {
                assert!(score(&c, prior, 1e-3, turn(&mut seed)) <= best + 1e-12 * c.scale);
            }
        }
    }

    #[test]
    fn without_vectors_the_prior_remains() {
        let prior = DQuat::from_rotation_z(1.0);
        assert_eq!(Correlation::ZERO.rotation(prior, 1e-3), prior);
    }
}
