use std::f64::consts::TAU;

use super::SceneError;
use crate::sampling::concentric_disc;

/// A thin lens: what lies off the plane in focus is blurred.
///
/// Conventions are Blender's: seen along the view, with X to the right and Y up, a polygon without rotation has a side towards +X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the aperture, to the corners if it has blades; in the unit of the camera's space, > 0.
    pub aperture_radius: f64,
    /// Distance of the plane in focus along the view axis, in that unit, > 0.
    pub focus_distance: f64,
    /// Sides of a polygonal aperture; below 3 for a round one.
    pub blades: u32,
    /// Turns the polygon counterclockwise, radians.
    pub rotation_rad: f64,
    /// Anamorphic squeeze: the aperture is this many times as high as it is wide, > 0.
    pub ratio: f64,
}

impl Lens {
    /// The point of the aperture at two uniform numbers, X and Y of camera space; its centre for (½, ½).
    pub fn point(&self, uniform: [f64; 2]) -> [f64; 2] {
        let [x, y] = concentric_disc(uniform);
        let (x, y) = if self.blades < 3 { (x, y) } else { self.in_polygon(x.hypot(y), y.atan2(x)) };
        [x / self.ratio * self.aperture_radius, y * self.aperture_radius]
    }

    /// Where the polygon has the point of the unit disc: the same share of the way out, at the same share of a sector. Areas stay in
    /// proportion, as both are swept in triangles about the centre.
    fn in_polygon(&self, share: f64, angle: f64) -> (f64, f64) {
        let sector = TAU / f64::from(self.blades);
        // Corners half a sector to either side of the middle of a side.
        let turns = (angle / sector + 0.5).rem_euclid(f64::from(self.blades));
        let first = (turns.floor() - 0.5) * sector + self.rotation_rad;
        let along = turns.fract();
        let corner = |angle: f64| (share * angle.cos(), share * angle.sin());
        let ((ax, ay), (bx, by)) = (corner(first), corner(first + sector));
        (ax + along * (bx - ax), ay + along * (by - ay))
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`SceneError`] for the first that is out of range.
    pub(crate) fn validate(&self) -> Result<(), SceneError> {
        let positive = |what: &str, value: f64| {
            let valid = value.is_finite() && value > 0.0;
            let reason = || format!("{what} {value}: expected a finite number above 0");
            if valid { Ok(()) } else { Err(SceneError::input("camera", reason())) }
        };
        positive("aperture_radius", self.aperture_radius)?;
        positive("focus_distance", self.focus_distance)?;
        positive("ratio", self.ratio)?;
        if !self.rotation_rad.is_finite() {
            return Err(SceneError::input("camera", "the aperture's rotation is not finite"));
        }
        Ok(())
    }

    /// Area of the aperture.
    #[cfg(test)]
    fn area(&self) -> f64 {
        let n = f64::from(self.blades);
        let unit = if self.blades < 3 { 0.5 * TAU } else { 0.5 * n * (TAU / n).sin() };
        unit * self.aperture_radius * self.aperture_radius / self.ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Use, pair};

    const ROUND: Lens = Lens { aperture_radius: 0.3, focus_distance: 2.0, blades: 0, rotation_rad: 0.0, ratio: 1.0 };

    fn cases() -> [Lens; 5] {
        [
            ROUND,
            Lens { ratio: 2.0, ..ROUND },
            Lens { blades: 3, ..ROUND },
            Lens { blades: 6, rotation_rad: 0.4, ..ROUND },
            Lens { blades: 5, ratio: 0.5, ..ROUND },
        ]
    }

    #[test]
    fn the_centre_is_the_first() {
        for lens in cases() {
            let [x, y] = lens.point(pair(0, 0, Use::Lens));
            assert!(x.hypot(y) < 1e-12, "{lens:?}");
        }
    }

    #[test]
    fn points_fill_the_aperture_evenly() {
        // Second moments of a uniform regular polygon: area × (2 + cos(2π/n)) / 12 R² about either axis; of a disc: R²/4.
        for lens in cases() {
            let n = 20_000;
            let points: Vec<_> = (0..n).map(|i| lens.point(pair(i, 7, Use::Lens))).collect();
            let moment = |axis: usize| points.iter().map(|p| p[axis] * p[axis]).sum::<f64>() / f64::from(n);
            let unit = if lens.blades < 3 { 0.25 } else { (2.0 + (TAU / f64::from(lens.blades)).cos()) / 12.0 };
            let expected = unit * lens.aperture_radius * lens.aperture_radius;
            let (x, y) = (moment(0) * lens.ratio * lens.ratio, moment(1));
            assert!(
                (x / expected - 1.0).abs() < 5e-3 && (y / expected - 1.0).abs() < 5e-3,
                "{lens:?}: {x} {y} {expected}"
            );
            // As many in a small square as its share of the area.
            let side = 0.1 * lens.aperture_radius;
            let inside = points.iter().filter(|p| p[0].abs() < side && p[1].abs() < side).count();
            let share = inside as f64 / f64::from(n) / (4.0 * side * side / lens.area());
            assert!((share - 1.0).abs() < 0.05, "{lens:?}: {share}");
        }
    }

    #[test]
    fn a_polygon_has_a_side_towards_x() {
        let lens = Lens { blades: 6, ..ROUND };
        let inner = 0.3 * (TAU / 12.0).cos();
        let points: Vec<_> = (0..5000).map(|i| lens.point(pair(i, 1, Use::Lens))).collect();
        let most = |axis: usize| points.iter().map(|p| p[axis].abs()).fold(0.0, f64::max);
        assert!(most(0) <= inner + 1e-12 && most(0) > 0.98 * inner, "{}", most(0));
        assert!(most(1) <= 0.3 && most(1) > 0.29, "{}", most(1));
    }
}
