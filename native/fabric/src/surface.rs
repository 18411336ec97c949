//! Surfaces that cloth is laid on.

use crate::Error;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A parametric surface in metres, right-handed, Z up.
///
/// `u` runs along the courses, `v` from the first course to the last, both over [0, 1]. The front of the cloth
/// faces along the normal, and looking at the front `u` runs to the right when `v` runs up. Cloth knitted in the round
/// needs a surface of period 1 in `u`.
///
/// Every function `Fn(f64, f64) -> DVec3 + Sync` is a surface: a deformation of another one, for instance, such as
/// `|u, v| wave(patch.position(u, v), time)`.
pub trait Surface: Sync {
    /// Position in metres.
    fn position(&self, u: f64, v: f64) -> DVec3;

    /// Unit normal, out of the front of the cloth.
    ///
    /// Unless a surface knows better, it is derived from positions up to 1e-5 outside of [0, 1]; where the
    /// surface has no tangent plane it is NaN, which the cloth laid on it reports.
    fn normal(&self, u: f64, v: f64) -> DVec3 {
        const H: f64 = 1e-5;
        let along_u = self.position(u + H, v) - self.position(u - H, v);
        let along_v = self.position(u, v + H) - self.position(u, v - H);
        along_u.cross(along_v).try_normalize().unwrap_or(DVec3::NAN)
    }
}

/// The control points of all yarns on a surface, one yarn after the other.
///
/// `count` gives a yarn's number of points, `place` where on the surface each of them lies and its height in metres.
///
/// # Errors
/// [`Error::Surface`] for the first point, by yarn and number, where the surface has no finite position or normal.
pub(crate) fn lay(
    surface: &impl Surface,
    yarns: usize,
    count: impl Fn(usize) -> usize + Sync,
    place: impl Fn(usize, usize) -> (DVec2, f64) + Sync,
) -> Result<Vec<[f32; 3]>, Error> {
    let point = |yarn: usize, index: usize| {
        let (DVec2 { x: u, y: v }, height_m) = place(yarn, index);
        let position = surface.position(u, v) + surface.normal(u, v) * height_m;
        position.is_finite().then(|| position.as_vec3().to_array()).ok_or(Error::Surface { yarn, index, u, v })
    };
    let laid: Vec<Result<Vec<[f32; 3]>, Error>> =
        (0..yarns).into_par_iter().map(|yarn| (0..count(yarn)).map(|index| point(yarn, index)).collect()).collect();
    // Only now is it looked for errors, so that the first is the same whichever thread is quicker.
    Ok(laid.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
}

impl<F: Fn(f64, f64) -> DVec3 + Sync> Surface for F {
    fn position(&self, u: f64, v: f64) -> DVec3 {
        self(u, v)
    }
}

/// An upright rectangle, centred on the origin, its front towards −Y: `u` runs along +X, `v` along +Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatPatch {
    /// Width and height in metres.
    pub size_m: DVec2,
}

impl Surface for FlatPatch {
    fn position(&self, u: f64, v: f64) -> DVec3 {
        DVec3::new((u - 0.5) * self.size_m.x, 0.0, (v - 0.5) * self.size_m.y)
    }

    fn normal(&self, _u: f64, _v: f64) -> DVec3 {
        DVec3::NEG_Y
    }
}

/// An upright round tube about the Z axis, standing on z = 0, its front outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube {
    /// Radius in metres.
    pub radius_m: f64,
    /// Height in metres.
    pub height_m: f64,
}

impl Surface for Tube {
    fn position(&self, u: f64, v: f64) -> DVec3 {
        self.normal(u, v) * self.radius_m + DVec3::Z * (v * self.height_m)
    }

    fn normal(&self, u: f64, _v: f64) -> DVec3 {
        let (sin, cos) = (TAU * u).sin_cos();
        DVec3::new(cos, sin, 0.0)
    }
}

/// Samples of a sleeve's centre line per given point.
const SAMPLES_PER_POINT: usize = 128;

/// A round tube about a smooth centre line, its front outside: a sleeve on an arm.
///
/// On the inside of a bend the surface shortens, so a bend of centre-line radius ρ presses yarns together by the
/// factor 1 − `radius_m` / ρ there.
#[derive(Clone, Debug)]
pub struct Sleeve {
    radius_m: f64,
    /// Length along the centre line up to each sample, in metres.
    lengths_m: Vec<f64>,
    frames: Vec<Frame>,
}

/// A point of a sleeve's centre line and the two directions across it.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: DVec3,
    tangent: DVec3,
    /// Where u = 0.
    x: DVec3,
    /// Where u = 1/4.
    y: DVec3,
}

impl Sleeve {
    /// A sleeve of `radius_m` metres about the Catmull-Rom curve through `centre_line` (at least two points, in
    /// metres), on which `v` is proportional to length. `u` = 0 lies on the side of `seam_direction` where the
    /// sleeve begins and is carried along without twisting.
    ///
    /// # Errors
    /// [`Error::CentreLine`] if a point is not finite or equals the one before it, if there are fewer than two, if
    /// the seam direction is zero or along the beginning of the centre line, or if the radius is not positive.
    pub fn new(centre_line: &[DVec3], radius_m: f64, seam_direction: DVec3) -> Result<Self, Error> {
        let refuse = |index: usize, reason: &'static str| Err(Error::CentreLine { index, reason });
        if centre_line.len() < 2 {
            return refuse(centre_line.len(), "a centre line needs two points or more");
        }
        if !(radius_m.is_finite() && radius_m > 0.0) {
            return refuse(0, "the sleeve's radius must be finite and positive");
        }
        for (index, point) in centre_line.iter().enumerate() {
            if !point.is_finite() {
                return refuse(index, "it is not finite");
            }
            if index > 0 && *point == centre_line[index - 1] {
                return refuse(index, "it equals the point before it");
            }
        }
        let centres = crate::distance::Polyline::from_catmull_rom(centre_line, false, SAMPLES_PER_POINT).points;
        let last = centres.len() - 1;
        let tangent = |i: usize| (centres[(i + 1).min(last)] - centres[i.saturating_sub(1)]).try_normalize();
        let mut lengths_m = vec![0.0];
        let mut frames: Vec<Frame> = Vec::with_capacity(centres.len());
        for (i, &centre) in centres.iter().enumerate() {
            let Some(tangent) = tangent(i) else {
                return refuse(i / SAMPLES_PER_POINT, "the centre line turns back on itself after it");
            };
            let x = match frames.last() {
                None => seam_direction.reject_from_normalized(tangent).try_normalize(),
                Some(previous) => {
                    lengths_m.push(lengths_m[i - 1] + previous.centre.distance(centre));
                    previous.carried(centre, tangent).try_normalize()
                }
            };
            let Some(x) = x else { return refuse(i / SAMPLES_PER_POINT, "the seam has no direction there") };
            frames.push(Frame { centre, tangent, x, y: tangent.cross(x) });
        }
        Ok(Self { radius_m, lengths_m, frames })
    }

    /// Length of the centre line in metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.lengths_m[self.lengths_m.len() - 1]
    }

    fn frame(&self, v: f64) -> Frame {
        let target = v * self.length_m();
        let end = self.lengths_m.partition_point(|&length| length <= target).clamp(1, self.lengths_m.len() - 1);
        let t = (target - self.lengths_m[end - 1]) / (self.lengths_m[end] - self.lengths_m[end - 1]);
        let (a, b) = (self.frames[end - 1], self.frames[end]);
        // Neighbouring samples' directions differ by a fraction of a degree: their mixture has almost unit length.
        let tangent = a.tangent.lerp(b.tangent, t).normalize_or(a.tangent);
        let x = a.x.lerp(b.x, t).reject_from_normalized(tangent).normalize_or(a.x);
        Frame { centre: a.centre.lerp(b.centre, t), tangent, x, y: tangent.cross(x) }
    }
}

impl Frame {
    /// Where `x` goes when the frame moves to another point without twisting: the double reflection of
    /// Wang, Jüttler, Zheng, Liu 2008, "Computation of Rotation Minimizing Frames", §4.
    fn carried(&self, centre: DVec3, tangent: DVec3) -> DVec3 {
        let reflect = |vector: DVec3, axis: DVec3| match axis.length_squared() {
            0.0 => vector,
            length_squared => vector - axis * (2.0 * axis.dot(vector) / length_squared),
        };
        let chord = centre - self.centre;
        let (x, t) = (reflect(self.x, chord), reflect(self.tangent, chord));
        reflect(x, tangent - t).reject_from_normalized(tangent)
    }
}

impl Surface for Sleeve {
    fn position(&self, u: f64, v: f64) -> DVec3 {
        let frame = self.frame(v);
        let (sin, cos) = (TAU * u).sin_cos();
        frame.centre + (frame.x * cos + frame.y * sin) * self.radius_m
    }

    fn normal(&self, u: f64, v: f64) -> DVec3 {
        let frame = self.frame(v);
        let (sin, cos) = (TAU * u).sin_cos();
        frame.x * cos + frame.y * sin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The orientation that the trait promises, by differences of positions.
    fn assert_oriented(surface: &dyn Surface, places: &[(f64, f64)]) {
        for &(u, v) in places {
            let numeric = (|u: f64, v: f64| surface.position(u, v)).normal(u, v);
            assert!(numeric.distance(surface.normal(u, v)) < 1e-3, "({u}, {v}): {numeric} {}", surface.normal(u, v));
        }
    }

    fn elbow() -> Sleeve {
        let line = [DVec3::ZERO, DVec3::new(0.0, 0.0, 0.3), DVec3::new(0.2, 0.1, 0.5), DVec3::new(0.5, 0.1, 0.5)];
        Sleeve::new(&line, 0.05, DVec3::X).expect("a valid sleeve")
    }

    #[test]
    fn normals_match_the_orientation_of_u_and_v() {
        let places = [(0.1, 0.2), (0.5, 0.5), (0.85, 0.9), (0.3, 0.333)];
        assert_oriented(&FlatPatch { size_m: DVec2::new(0.3, 0.2) }, &places);
        assert_oriented(&Tube { radius_m: 0.1, height_m: 0.4 }, &places);
        assert_oriented(&elbow(), &places);
    }

    #[test]
    #[should_panic]
    fn a_surface_turned_inside_out_is_noticed() {
        struct InsideOut;
        impl Surface for InsideOut {
            fn position(&self, u: f64, v: f64) -> DVec3 {
                FlatPatch { size_m: DVec2::ONE }.position(u, v)
            }
            fn normal(&self, _u: f64, _v: f64) -> DVec3 {
                DVec3::Y
            }
        }
        assert_oriented(&InsideOut, &[(0.5, 0.5)]);
    }

    #[test]
    fn a_sleeve_has_its_radius_everywhere_and_even_lengths() {
        let sleeve = elbow();
        for k in 0..=40 {
            let v = f64::from(k) / 40.0;
            let centre = 0.5 * (sleeve.position(0.0, v) + sleeve.position(0.5, v));
            for u in [0.0, 0.2, 0.7] {
                assert!((sleeve.position(u, v).distance(centre) - 0.05).abs() < 1e-9);
            }
            let next = 0.5 * (sleeve.position(0.0, v + 1e-3) + sleeve.position(0.5, v + 1e-3));
            assert!((centre.distance(next) / (1e-3 * sleeve.length_m()) - 1.0).abs() < 1e-3);
        }
        assert!(sleeve.position(0.0, 0.0).distance(DVec3::new(0.05, 0.0, 0.0)) < 1e-3);
    }

    #[test]
    fn bad_centre_lines_are_refused_with_their_place() {
        let line = [DVec3::ZERO, DVec3::Z, DVec3::Z];
        let index_of = |result: Result<Sleeve, Error>| match result {
            Err(Error::CentreLine { index, .. }) => index,
            other => panic!("{other:?}"),
        };
        assert_eq!(index_of(Sleeve::new(&line, 0.1, DVec3::X)), 2);
        assert_eq!(index_of(Sleeve::new(&line[..1], 0.1, DVec3::X)), 1);
        assert_eq!(index_of(Sleeve::new(&[DVec3::ZERO, DVec3::NAN], 0.1, DVec3::X)), 1);
        assert_eq!(index_of(Sleeve::new(&line[..2], 0.1, DVec3::Z)), 0);
        assert_eq!(index_of(Sleeve::new(&line[..2], -0.1, DVec3::X)), 0);
    }
}
