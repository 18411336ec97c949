use glam::{DVec3, Vec3};

use crate::strands::Strands;

/// One knot of a yarn as the renderer stores it.
#[derive(Clone, Copy, Debug)]
pub struct Knot {
    /// Position, object space.
    pub position: DVec3,
    /// Unit normal of the yarn's frame, object space.
    pub normal: DVec3,
    /// Rest arc length from the curve's start; across the seam of a closed curve it keeps growing.
    pub length: f64,
    /// Yarn radius.
    pub radius: f64,
}

/// The stretch of a yarn between two knots, with the knots before and after: everything along it is continuous to first order.
///
/// Twin of `shaders/curve/segment.wgsl`. Positions are uniform Catmull-Rom; lengths and radii use the same
/// Hermite form with limited slopes, so that a length coordinate stays monotone; the frame's normal is
/// interpolated the same way and made perpendicular to the heading: the interpolated velocity, whose slope at a knot is the
/// second difference there. A Catmull-Rom curve's own tangent has a kink in its rate at every knot, which would show in the
/// direction of twisted fibers.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    position: [DVec3; 4],
    heading: [DVec3; 4],
    normal: [DVec3; 4],
    length: [f64; 4],
    radius: [f64; 4],
}

/// The yarn's centre and frame at one parameter; derivatives are with respect to the segment's parameter t.
#[derive(Clone, Copy, Debug)]
pub struct YarnPoint {
    /// Centre, object space.
    pub position: DVec3,
    /// d position / dt.
    pub velocity: DVec3,
    /// Unit heading: the tangent, smoothed between knots.
    pub tangent: DVec3,
    /// Unit normal, perpendicular to the tangent.
    pub normal: DVec3,
    /// tangent × normal.
    pub binormal: DVec3,
    /// d normal / dt.
    pub normal_rate: DVec3,
    /// d binormal / dt.
    pub binormal_rate: DVec3,
    /// Length coordinate.
    pub length: f64,
    /// d length / dt.
    pub length_rate: f64,
    /// Yarn radius.
    pub radius: f64,
    /// d radius / dt.
    pub radius_rate: f64,
}

/// Slope at a knot from the differences before and after it: their mean, limited to keep the interpolant monotone
/// (Fritsch and Carlson's bound of three times the smaller difference), zero at an extremum.
fn limited_slope(before: f64, after: f64) -> f64 {
    if before * after <= 0.0 {
        return 0.0;
    }
    let bound = 3.0 * before.abs().min(after.abs());
    (0.5 * (before + after)).clamp(-bound, bound)
}

/// Coefficients of t⁰ … t³ of the cubic with end values `a`, `b` and end slopes `da`, `db`.
fn hermite<T>(a: T, b: T, da: T, db: T) -> [T; 4]
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    [a, da, (b - a) * 3.0 - da * 2.0 - db, (a - b) * 2.0 + da + db]
}

fn value<T>(c: [T; 4], t: f64) -> T
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    c[0] + (c[1] + (c[2] + c[3] * t) * t) * t
}

fn slope<T>(c: [T; 4], t: f64) -> T
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    c[1] + (c[2] * 2.0 + c[3] * (3.0 * t)) * t
}

impl Segment {
    /// All segments of a curve in its current shape, object space. An open curve continues beyond its ends by reflection.
    pub fn of_curve(strands: &Strands, curve: usize) -> Vec<Self> {
        let (first, end) = (strands.offsets()[curve] as usize, strands.offsets()[curve + 1] as usize);
        let (count, closed, total) = (end - first, strands.closed()[curve], strands.total_lengths()[curve]);
        let inside = |i: usize| Knot {
            position: Vec3::from(strands.positions()[first + i]).as_dvec3(),
            normal: Vec3::from(strands.normals()[first + i]).as_dvec3(),
            length: strands.lengths()[first + i],
            radius: strands.radii()[first + i].into(),
        };
        let reflected = |end: Knot, next: Knot| Knot {
            position: end.position * 2.0 - next.position,
            length: end.length * 2.0 - next.length,
            ..end
        };
        // `i` counts from the knot before the first.
        let knot = |i: usize| {
            if closed {
                let i = i as isize - 1;
                let knot = inside(i.rem_euclid(count as isize) as usize);
                Knot { length: knot.length + total * i.div_euclid(count as isize) as f64, ..knot }
            } else if i == 0 {
                reflected(inside(0), inside(1))
            } else if i > count {
                reflected(inside(count - 1), inside(count - 2))
            } else {
                inside(i - 1)
            }
        };
        let segments = if closed { count } else { count - 1 };
        (0..segments).map(|i| Self::new([knot(i), knot(i + 1), knot(i + 2), knot(i + 3)])).collect()
    }

    /// The segment between `knots[1]` and `knots[2]`.
    pub fn new(knots: [Knot; 4]) -> Self {
        let vector = |[a, b, c, d]: [DVec3; 4]| hermite(b, c, (c - a) * 0.5, (d - b) * 0.5);
        let scalar = |[a, b, c, d]: [f64; 4]| hermite(b, c, limited_slope(b - a, c - b), limited_slope(c - b, d - c));
        let [a, b, c, d] = knots.map(|k| k.position);
        Self {
            heading: hermite((c - a) * 0.5, (d - b) * 0.5, a - b * 2.0 + c, b - c * 2.0 + d),
            position: vector(knots.map(|k| k.position)),
            normal: vector(knots.map(|k| k.normal)),
            length: scalar(knots.map(|k| k.length)),
            radius: scalar(knots.map(|k| k.radius)),
        }
    }

    /// Evaluates at t in [0, 1].
    pub fn at(&self, t: f64) -> YarnPoint {
        let heading = value(self.heading, t);
        let tangent = heading.normalize();
        let turning = slope(self.heading, t);
        let tangent_rate = (turning - tangent * turning.dot(tangent)) / heading.length();

        // The interpolated normal m is projected off the tangent; its rotation about the tangent is the frame's twist.
        let m = value(self.normal, t);
        let projected = m - tangent * m.dot(tangent);
        let normal = projected.normalize();
        let binormal = tangent.cross(normal);
        let twist =
            (slope(self.normal, t).dot(binormal) - m.dot(tangent) * tangent_rate.dot(binormal)) / projected.length();
        YarnPoint {
            position: value(self.position, t),
            velocity: slope(self.position, t),
            tangent,
            normal,
            binormal,
            normal_rate: binormal * twist - tangent * normal.dot(tangent_rate),
            binormal_rate: -normal * twist - tangent * binormal.dot(tangent_rate),
            length: value(self.length, t),
            length_rate: slope(self.length, t),
            radius: value(self.radius, t),
            radius_rate: slope(self.radius, t),
        }
    }
}
