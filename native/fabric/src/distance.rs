//! Distances between smooth curves, by dense sampling and exact segment distances.

use glam::{DVec3, IVec3};
use std::collections::HashMap;

/// Weights of the four control points of a uniform Catmull-Rom segment at `t` in [0, 1].
pub(crate) fn catmull_rom_weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (-t + 2.0 * t2 - t3), 0.5 * (2.0 - 5.0 * t2 + 3.0 * t3), 0.5 * (t + 4.0 * t2 - 3.0 * t3), 0.5 * (-t2 + t3)]
}

/// The shortest distance of two segments (clamped closest points of the two lines).
pub(crate) fn segment_distance(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (uu, uv, vv) = (u.length_squared(), u.dot(v), v.length_squared());
    let (uw, vw) = (u.dot(w), v.dot(w));
    let determinant = uu * vv - uv * uv;
    let s = if determinant > 1e-12 * uu * vv { ((uv * vw - vv * uw) / determinant).clamp(0.0, 1.0) } else { 0.0 };
    let t = if vv > 0.0 { ((uv * s + vw) / vv).clamp(0.0, 1.0) } else { 0.0 };
    let s = if uu > 0.0 { ((uv * t - uw) / uu).clamp(0.0, 1.0) } else { 0.0 };
    (w + u * s - v * t).length()
}

/// A polyline along a yarn's centre line.
#[derive(Clone, Debug)]
pub(crate) struct Polyline {
    /// Its points, in any one unit.
    pub points: Vec<DVec3>,
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

impl Polyline {
    /// `subdivision` chords for every segment of a uniform Catmull-Rom curve, its open ends extrapolated by reflection
    /// as in `lisle_core::curve::Basis::CatmullRom`.
    pub fn from_catmull_rom(control: &[DVec3], closed: bool, subdivision: usize) -> Self {
        let n = control.len() as isize;
        let at = |i: isize| {
            if closed {
                control[i.rem_euclid(n) as usize]
            } else if i < 0 {
                2.0 * control[0] - control[1]
            } else if i >= n {
                2.0 * control[n as usize - 1] - control[n as usize - 2]
            } else {
                control[i as usize]
            }
        };
        let segments = if closed { n } else { n - 1 };
        let mut points = Vec::with_capacity(segments as usize * subdivision + 1);
        for i in 0..segments {
            let window = [at(i - 1), at(i), at(i + 1), at(i + 2)];
            for k in 0..subdivision {
                let weights = catmull_rom_weights(k as f64 / subdivision as f64);
                points.push(window.iter().zip(weights).map(|(point, weight)| *point * weight).sum());
            }
        }
        if !closed {
            points.extend(control.last());
        }
        Self { points, closed }
    }

    fn segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len().saturating_sub(1) }
    }

    fn segment(&self, i: usize) -> [DVec3; 2] {
        [self.points[i], self.points[(i + 1) % self.points.len()]]
    }
}

/// The closest approach of yarns to each other and to themselves, if it is less than `reach`.
///
/// Segments of one yarn count only if at least `neighbourhood` of yarn lies between them. All arguments and the
/// result are in the points' unit. Every pair within reach is measured exactly: segments are binned by the cubes
/// that their bounding boxes, grown by half of `reach`, touch.
pub(crate) fn closest_approach(yarns: &[Polyline], reach: f64, neighbourhood: f64) -> Option<f64> {
    let mut bins: HashMap<IVec3, Vec<(u32, u32)>> = HashMap::new();
    let mut lengths = Vec::with_capacity(yarns.len());
    for (yarn, polyline) in yarns.iter().enumerate() {
        let mut along = vec![0.0];
        for i in 0..polyline.segments() {
            let [a, b] = polyline.segment(i);
            along.push(along[i] + a.distance(b));
            let low = ((a.min(b) - 0.5 * reach) / reach).floor().as_ivec3();
            let high = ((a.max(b) + 0.5 * reach) / reach).floor().as_ivec3();
            for x in low.x..=high.x {
                for y in low.y..=high.y {
                    for z in low.z..=high.z {
                        bins.entry(IVec3::new(x, y, z)).or_default().push((yarn as u32, i as u32));
                    }
                }
            }
        }
        lengths.push(along);
    }
    let mut closest = f64::INFINITY;
    for bin in bins.values() {
        for (k, &(yarn_a, a)) in bin.iter().enumerate() {
            for &(yarn_b, b) in &bin[k + 1..] {
                let (first, second) = (&yarns[yarn_a as usize], &yarns[yarn_b as usize]);
                if yarn_a == yarn_b {
                    let along = &lengths[yarn_a as usize];
                    let (low, high) = (a.min(b) as usize, a.max(b) as usize);
                    let mut between = along[high] - along[low + 1];
                    if first.closed {
                        between = between.min(along[low] + along[along.len() - 1] - along[high + 1]);
                    }
                    if between < neighbourhood {
                        continue;
                    }
                }
                closest = closest.min(segment_distance(first.segment(a as usize), second.segment(b as usize)));
            }
        }
    }
    (closest < reach).then_some(closest)
}

/// The smallest radius of curvature of a yarn, from circles through three successive points.
#[cfg(test)]
pub(crate) fn tightest_bend(yarn: &Polyline) -> f64 {
    let n = yarn.points.len();
    let inner = if yarn.closed { 0..n } else { 1..n.saturating_sub(1) };
    inner
        .map(|i| {
            let [a, b, c] = [(i + n - 1) % n, i, (i + 1) % n].map(|k| yarn.points[k]);
            let twice_area = (b - a).cross(c - a).length();
            a.distance(b) * b.distance(c) * c.distance(a) / (2.0 * twice_area)
        })
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn circle(radius: f64, height: f64, n: usize) -> Polyline {
        let point = |i: usize| {
            let angle = TAU * i as f64 / n as f64;
            DVec3::new(radius * angle.cos(), radius * angle.sin(), height)
        };
        Polyline { points: (0..n).map(point).collect(), closed: true }
    }

    #[test]
    fn segments_crossing_parallel_and_end_to_end() {
        let x = [DVec3::NEG_X, DVec3::X];
        assert_eq!(segment_distance(x, [DVec3::new(0.3, -1.0, 0.5), DVec3::new(0.3, 1.0, 0.5)]), 0.5);
        assert_eq!(segment_distance(x, [DVec3::new(-5.0, 2.0, 0.0), DVec3::new(5.0, 2.0, 0.0)]), 2.0);
        assert_eq!(segment_distance(x, [DVec3::new(4.0, 4.0, 0.0), DVec3::new(9.0, 9.0, 0.0)]), 5.0);
        assert_eq!(segment_distance(x, [DVec3::new(0.0, 3.0, 0.0), DVec3::new(0.0, 1.0, 0.0)]), 1.0);
    }

    #[test]
    fn two_rings_are_as_far_apart_as_their_heights() {
        let rings = [circle(10.0, 0.0, 400), circle(10.0, 1.75, 400)];
        let closest = closest_approach(&rings, 3.0, PI).expect("within reach");
        assert!((closest - 1.75).abs() < 1e-12, "{closest}");
        assert_eq!(closest_approach(&rings, 1.5, PI), None);
    }

    #[test]
    fn a_yarn_meets_itself_beyond_its_neighbourhood_only() {
        // A flat figure of two parallel strands joined by a half circle of radius 0.5: they come within 1 of each other.
        let mut points: Vec<DVec3> = (0..=40).map(|i| DVec3::new(4.0 - 0.1 * f64::from(i), 0.5, 0.0)).collect();
        points.extend((1..20).map(|i| {
            let angle = PI / 2.0 + PI * f64::from(i) / 20.0;
            DVec3::new(0.5 * angle.cos(), 0.5 * angle.sin(), 0.0)
        }));
        points.extend((0..=40).map(|i| DVec3::new(0.1 * f64::from(i), -0.5, 0.0)));
        let hairpin = [Polyline { points, closed: false }];
        let closest = closest_approach(&hairpin, 2.5, PI).expect("the strands touch");
        assert!((closest - 1.0).abs() < 1e-3, "{closest}");
        assert_eq!(closest_approach(&hairpin, 2.5, 20.0), None);
        assert!((tightest_bend(&hairpin[0]) - 0.5).abs() < 1e-2);
        // Round a ring the neighbourhood reaches across the joint.
        assert_eq!(closest_approach(&[circle(10.0, 0.0, 400)], 2.0, PI), None);
    }

    #[test]
    fn chords_lie_on_the_curve_that_is_rendered() {
        let control: Vec<[f32; 3]> =
            (0..9_i16).map(|i| [f32::from(i), f32::from(i * i % 5), f32::from(i % 3)]).collect();
        for closed in [false, true] {
            let curves = lisle_core::curve::Curves::catmull_rom(vec![control.clone()], closed);
            let curve = curves.curve(0);
            let points: Vec<DVec3> = control.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
            let line = Polyline::from_catmull_rom(&points, closed, 8);
            assert_eq!(line.points.len(), 8 * curve.segment_count() + usize::from(!closed));
            for (i, point) in line.points.iter().enumerate() {
                let segment = (i / 8).min(curve.segment_count() - 1);
                let expected = curve.position(segment, i as f64 / 8.0 - segment as f64);
                assert!(point.distance(expected) < 1e-12, "{closed}, {i}: {point} {expected}");
            }
        }
    }
}
