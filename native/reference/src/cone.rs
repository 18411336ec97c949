//! Where a ray meets a round cone: two spheres and the cone that touches both.

use glam::DVec3;

/// A sphere at either end, and the cone that touches both.
#[derive(Clone, Copy, Debug)]
pub struct RoundCone {
    /// Centre of one end.
    pub a: DVec3,
    /// Centre of the other.
    pub b: DVec3,
    /// Radius at `a`.
    pub radius_a: f64,
    /// Radius at `b`.
    pub radius_b: f64,
}

/// Where a ray enters.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Distance along the ray.
    pub t: f64,
    /// Place along the axis, 0 at `a` and 1 at `b`: that of the sphere that touches the surface there.
    pub along: f64,
}

impl RoundCone {
    /// Where a ray of unit direction enters, at any distance; a ray from inside, or away, does not.
    ///
    /// The surface is that of the spheres of centre a + s (b − a) and radius r_a + s (r_b − r_a), s from 0 to 1. With w = o − a, e = b − a and
    /// δ = r_a − r_b, a point w + t d is touched from inside where |w + t d − s e| = r_a − s δ with the derivative in s zero:
    /// s = (e·(w + t d) − δ r_a) / (e² − δ²), and |w + t d|² (e² − δ²) = (e·(w + t d))² − 2 δ r_a e·(w + t d) + r_a² e².
    pub fn enter(&self, origin: DVec3, direction: DVec3) -> Option<Entry> {
        // From the place on the ray that is nearest: digits stay even if the ray comes from far.
        let ahead = (0.5 * (self.a + self.b) - origin).dot(direction);
        let w = origin + direction * ahead - self.a;
        let axis = self.b - self.a;
        let narrowing = self.radius_a - self.radius_b;
        let (axis_axis, axis_w, axis_d) = (axis.dot(axis), axis.dot(w), axis.dot(direction));
        let slant = axis_axis - narrowing * narrowing;
        let entry = |t: f64, along: f64| Entry { t: t + ahead, along };
        if slant <= 0.0 {
            // One sphere holds the other.
            let (center, radius, along) =
                if narrowing >= 0.0 { (self.a, self.radius_a, 0.0) } else { (self.b, self.radius_b, 1.0) };
            return sphere(w + self.a - center, direction, radius).map(|t| entry(t, along));
        }
        let grown = narrowing * self.radius_a;
        let w_d = w.dot(direction);
        let k2 = slant - axis_d * axis_d;
        let k1 = slant * w_d - axis_w * axis_d + grown * axis_d;
        let k0 = slant * w.dot(w) - axis_w * axis_w + 2.0 * grown * axis_w - axis_axis * self.radius_a * self.radius_a;
        if k2.abs() > 1e-12 * axis_axis {
            let discriminant = k1 * k1 - k0 * k2;
            if discriminant < 0.0 {
                return None;
            }
            let t = -(k1 + discriminant.sqrt()) / k2;
            let along = axis_w - grown + t * axis_d;
            if along > 0.0 && along < slant {
                return Some(entry(t, along / slant));
            }
        }
        let a = sphere(w, direction, self.radius_a).map(|t| entry(t, 0.0));
        let b = sphere(w - axis, direction, self.radius_b).map(|t| entry(t, 1.0));
        match (a, b) {
            (Some(a), Some(b)) => Some(if a.t <= b.t { a } else { b }),
            (a, b) => a.or(b),
        }
    }

    /// Whether a point lies inside by more than a share of the radius.
    pub fn holds(&self, point: DVec3, margin: f64) -> bool {
        let axis = self.b - self.a;
        let along = ((point - self.a).dot(axis) / axis.length_squared().max(1e-300)).clamp(0.0, 1.0);
        let radius = self.radius_a + (self.radius_b - self.radius_a) * along;
        (point - self.a - axis * along).length_squared() < (radius * (1.0 - margin)).powi(2)
    }
}

fn sphere(from_center: DVec3, direction: DVec3, radius: f64) -> Option<f64> {
    let half = from_center.dot(direction);
    let discriminant = half * half - from_center.dot(from_center) + radius * radius;
    (discriminant >= 0.0 && radius > 0.0).then(|| -half - discriminant.sqrt())
}

#[cfg(test)]
mod tests {
    use lisle_core::sampling::{hash_combine, sphere, unit_from_hash};

    use super::*;

    fn unit(i: u32, key: u32) -> f64 {
        unit_from_hash(hash_combine(i, key))
    }

    /// Distance of a point from the surface, negative inside, by the definition: the least over all spheres, by golden-section search.
    fn distance(cone: &RoundCone, point: DVec3) -> f64 {
        let to_sphere =
            |s: f64| point.distance(cone.a.lerp(cone.b, s)) - (cone.radius_a + (cone.radius_b - cone.radius_a) * s);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..80 {
            let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
            if to_sphere(a) < to_sphere(b) { high = b } else { low = a }
        }
        to_sphere(0.5 * (low + high)).min(to_sphere(0.0)).min(to_sphere(1.0))
    }

    /// Where a ray enters, by steps of the distance; `None` if it starts inside or passes by.
    fn march(cone: &RoundCone, origin: DVec3, direction: DVec3) -> Option<f64> {
        let mut t = 0.0;
        while t < 20.0 {
            let left = distance(cone, origin + direction * t);
            if left < 1e-9 {
                return Some(t);
            }
            t += left;
        }
        None
    }

    fn cones() -> impl Iterator<Item = RoundCone> {
        (0..200).map(|i| RoundCone {
            a: sphere([unit(i, 0), unit(i, 1)]),
            b: sphere([unit(i, 2), unit(i, 3)]) * if i % 7 == 0 { 0.1 } else { 1.0 },
            radius_a: 0.6 * unit(i, 4),
            // Some as thick as the other end, some a point, some within the other sphere.
            radius_b: [0.6 * unit(i, 4), 0.0, 1.5 * unit(i, 5), 0.3 * unit(i, 5)][i as usize % 4],
        })
    }

    fn rays(i: u32) -> impl Iterator<Item = (DVec3, DVec3)> {
        (0..30).map(move |k| {
            let key = 10 * k;
            let origin = sphere([unit(i, key + 100), unit(i, key + 101)]) * 5.0;
            let target = sphere([unit(i, key + 102), unit(i, key + 103)]) * unit(i, key + 104);
            (origin, (target - origin).normalize())
        })
    }

    #[test]
    fn rays_enter_where_the_nearest_sphere_begins() {
        let (mut met, mut passed) = (0, 0);
        for (cone, i) in cones().zip(0..) {
            for (origin, direction) in rays(i) {
                let (found, expected) = (cone.enter(origin, direction), march(&cone, origin, direction));
                match (found, expected) {
                    (Some(found), Some(expected)) => {
                        assert!((found.t - expected).abs() < 1e-5, "{cone:?}: {found:?} for {expected}");
                        let place = origin + direction * found.t;
                        let center = cone.a.lerp(cone.b, found.along);
                        let radius = cone.radius_a + (cone.radius_b - cone.radius_a) * found.along;
                        assert!((place.distance(center) - radius).abs() < 1e-9, "{cone:?}: {found:?}");
                        met += 1;
                    }
                    // At the rim steps of the distance end just short of it.
                    (Some(found), None) => assert!(distance(&cone, origin + direction * found.t).abs() < 1e-6),
                    (None, Some(expected)) => {
                        let nearest =
                            (0..100).map(|k| distance(&cone, origin + direction * (expected + 1e-4 * f64::from(k))));
                        assert!(nearest.fold(f64::INFINITY, f64::min) > -1e-7, "{cone:?}: missed at {expected}");
                    }
                    (None, None) => passed += 1,
                }
            }
        }
        assert!(met > 1000 && passed > 1000, "{met} {passed}");
    }

    #[test]
    fn far_rays_keep_their_digits() {
        let cone = RoundCone { a: DVec3::ZERO, b: DVec3::X, radius_a: 1e-3, radius_b: 1e-3 };
        let found = cone.enter(DVec3::new(0.5, -1e7, 0.0), DVec3::Y).expect("a hit");
        assert!((found.t - (1e7 - 1e-3)).abs() < 1e-8 && (found.along - 0.5).abs() < 1e-9);
        assert!(cone.enter(DVec3::new(0.5, -1e7, 1.001e-3), DVec3::Y).is_none());
    }

    #[test]
    fn a_ray_along_the_axis_enters_an_end() {
        let cone = RoundCone { a: DVec3::ZERO, b: DVec3::X, radius_a: 0.1, radius_b: 0.1 };
        for direction in [DVec3::X, DVec3::new(1.0, 1e-9, 0.0).normalize()] {
            let found = cone.enter(DVec3::NEG_X * 2.0, direction).expect("a hit");
            assert!((found.t - 1.9).abs() < 1e-7 && found.along == 0.0);
        }
    }

    #[test]
    fn insides_are_those_of_the_distance() {
        for (cone, i) in cones().zip(0..).filter(|(cone, _)| (cone.radius_a - cone.radius_b).abs() < 0.01) {
            for k in 0..30 {
                let point = sphere([unit(i, 3 * k), unit(i, 3 * k + 1)]) * (1.5 * unit(i, 3 * k + 2));
                let inside = distance(&cone, point) < -0.02;
                assert!(!inside || cone.holds(point, 1e-6), "{cone:?} {point}");
                assert!(distance(&cone, point) < 0.02 || !cone.holds(point, 1e-6), "{cone:?} {point}");
            }
        }
    }
}
