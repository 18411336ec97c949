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
