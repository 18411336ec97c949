//! Woven cloth over a surface.

use crate::Error;
use crate::distance::{Polyline, closest_approach};
use crate::surface::{Surface, lay};
use crate::weave::Weave;
use glam::{DVec2, DVec3};
use lisle_core::curve::{Basis, Curves};
use std::f64::consts::PI;

/// Spacing of yarns that does not ask for another, where 1 is as tight as round yarns can be.
pub const SPACING: f64 = 1.01;

/// Control points from one crossing to the next. Even, so that a yarn can begin halfway.
const POINTS_PER_CROSSING: usize = 8;

/// Centre lines keep this many diameters apart. The quarter percent covers the chords of the measurement.
const CLEARANCE: f64 = 1.0025;

/// A rectangular piece of woven cloth, before it is laid on a surface.
///
/// A Catmull-Rom curve for each yarn: first the warp, which runs along `v`, from left to right; then the weft, which runs
/// along `u`, from the bottom up. Number and order of the points depend on the cloth only, never on the surface: lay it
/// on each frame's surface to animate it.
///
/// The path of a yarn is that of [Peirce1937] for round yarns of one kind: an arc about every yarn that it passes, and
/// straight lines between. A weave that shows as much warp as weft crimps both alike; one that shows more warp, a satin
/// for example, lets the warp take more of the crimp, up to where warp yarns touch and cover the cloth ([`Weave::balance`]).
/// On a surface of the cloth's own size ([`size_m`](Self::size_m)) the centre
/// lines keep two yarn radii apart: where arcs of two yarns hook into each other with sections A = √(D² − x²) and
/// B = √(D² − y²) about the diameter D, their squared distance is D² + 2 (A − D) (B − D).
#[derive(Clone, Debug)]
pub struct Woven {
    weave: Weave,
    warp: usize,
    weft: usize,
    yarn_radius_m: f64,
    /// Of the warp and of the weft.
    crimps: [Crimp; 2],
}

impl Woven {
    /// A piece of `warp` × `weft` yarns, `spacing` times as far apart as where they jam ([`SPACING`] for tight cloth).
    ///
    /// # Errors
    /// [`Error::WovenSize`], [`Error::YarnRadius`] or [`Error::Spacing`].
    pub fn new(weave: &Weave, warp: usize, weft: usize, yarn_radius_m: f64, spacing: f64) -> Result<Self, Error> {
        let points = |along: usize, across: usize| {
            along.checked_mul(POINTS_PER_CROSSING).and_then(|n| n.checked_add(1)?.checked_mul(across))
        };
        let all = points(weft, warp).and_then(|n| n.checked_add(points(warp, weft)?));
        if warp == 0 || weft == 0 || all.is_none_or(|all| all > u32::MAX as usize) {
            return Err(Error::WovenSize { warp, weft });
        }
        if !(yarn_radius_m.is_finite() && yarn_radius_m > 0.0) {
            return Err(Error::YarnRadius { value_m: yarn_radius_m });
        }
        if !(spacing.is_finite() && spacing >= 1.0) {
            return Err(Error::Spacing { value: spacing });
        }
        Ok(Self { weave: weave.clone(), warp, weft, yarn_radius_m, crimps: crimps(weave.balance(), spacing) })
    }

    /// The cloth at rest: width and height in metres. Yarns end half a spacing beyond their last crossing.
    #[must_use]
    pub fn size_m(&self) -> DVec2 {
        self.extent() * self.yarn_radius_m
    }

    /// The same in yarn radii.
    fn extent(&self) -> DVec2 {
        DVec2::new(self.warp as f64, self.weft as f64) * self.spacings()
    }

    /// From warp yarn to warp yarn, which is from crossing to crossing of the weft, and from weft to weft.
    fn spacings(&self) -> DVec2 {
        let [warp, weft] = &self.crimps;
        DVec2::new(weft.spacing, warp.spacing)
    }

    /// Number of control points.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.warp * self.yarn_points(0) + self.weft * self.yarn_points(self.warp)
    }

    /// Number of curves, the warp's first.
    #[must_use]
    pub fn yarn_count(&self) -> usize {
        self.warp + self.weft
    }

    /// Lays the cloth on a surface: the control points of all yarns, in metres.
    ///
    /// # Errors
    /// [`Error::Surface`] where the surface has no finite position or normal.
    pub fn points_on(&self, surface: &impl Surface) -> Result<Vec<[f32; 3]>, Error> {
        let extent = self.extent();
        let place = |yarn, index| {
            let point = self.point(yarn, index);
            (point.truncate() / extent, point.z * self.yarn_radius_m)
        };
        lay(surface, self.yarn_count(), |yarn| self.yarn_points(yarn), place)
    }

    /// Lays the cloth on a surface: a curve per yarn, with the yarn radius.
    ///
    /// # Errors
    /// As [`points_on`](Self::points_on).
    pub fn swatch(&self, surface: &impl Surface) -> Result<Curves, Error> {
        let mut offsets = vec![0];
        for yarn in 0..self.yarn_count() {
            offsets.push(offsets[yarn] + self.yarn_points(yarn) as u32);
        }
        Ok(Curves {
            points: self.points_on(surface)?,
            offsets,
            closed: vec![false; self.yarn_count()],
            basis: vec![Basis::CatmullRom; self.yarn_count()],
            radii: Some(vec![self.yarn_radius_m as f32; self.point_count()]),
        })
    }

    fn yarn_points(&self, yarn: usize) -> usize {
        let crossings = if yarn < self.warp { self.weft } else { self.warp };
        crossings * POINTS_PER_CROSSING + 1
    }

    /// A control point in the plane of the cloth, in yarn radii from its lower left corner.
    fn point(&self, yarn: usize, index: usize) -> DVec3 {
        let is_warp = yarn < self.warp;
        let crimp = &self.crimps[usize::from(!is_warp)];
        // Crossings are counted one up, so that the half before the first has a number too.
        let place = index + POINTS_PER_CROSSING / 2;
        let (crossing, step) = (place / POINTS_PER_CROSSING, place % POINTS_PER_CROSSING);
        let [first, second] = [crossing, crossing + 1].map(|crossing| self.side(yarn, crossing));
        let path = crimp.point(first, second, step);
        let along = path.x + (crossing as f64 - 0.5) * crimp.spacing;
        let spacings = self.spacings();
        if is_warp {
            DVec3::new((yarn as f64 + 0.5) * spacings.x, along, path.y)
        } else {
            DVec3::new(along, ((yarn - self.warp) as f64 + 0.5) * spacings.y, path.y)
        }
    }

    /// +1 where a yarn is in front at its crossing `number − 1`, −1 where it is behind.
    fn side(&self, yarn: usize, number: usize) -> f64 {
        let before = |count: usize| number + count - 1;
        let is_in_front = if yarn < self.warp {
            self.weave.warp_is_in_front(before(self.weave.rows()), yarn)
        } else {
            !self.weave.warp_is_in_front(yarn - self.warp, before(self.weave.columns()))
        };
        if is_in_front { 1.0 } else { -1.0 }
    }
}

/// A yarn between two crossings, in yarn radii.
#[derive(Clone, Copy, Debug)]
struct Crimp {
    /// From crossing to crossing.
    spacing: f64,
    /// How far from the middle of the cloth it lies at a crossing.
    height: f64,
    /// Radius of the arcs: the distance of the centre lines at a crossing.
    diameter: f64,
    /// Slope of the straight part.
    angle_rad: f64,
    /// Length of the straight part.
    straight: f64,
}

/// Paths of warp and weft, as wide as needed for the Catmull-Rom curves through their points to keep [`CLEARANCE`].
fn crimps(balance: f64, spacing: f64) -> [Crimp; 2] {
    let of_diameter = |diameter: f64| {
        // The warp's height is that of the weft at 0, and what lets yarns of the warp touch at 1.
        let warp_height = 0.5 * diameter * (1.0 + balance * (3.0_f64.sqrt() - 1.0));
        let weft_height = diameter - warp_height;
        let jam = |height: f64| 2.0 * (diameter * diameter - height * height).sqrt();
        // The spacing of the weft is the warp's from crossing to crossing.
        let warp = Crimp::new(spacing * jam(weft_height), warp_height, diameter);
        [warp, Crimp::new(spacing * jam(warp_height), weft_height, diameter)]
    };
    let touching = closest_at_crossings(&of_diameter(2.0));
    of_diameter(2.0 * 2.0 * CLEARANCE / touching)
}

/// How near two yarns come where they cross, whichever sides they are on at the crossings before and after.
fn closest_at_crossings([warp, weft]: &[Crimp; 2]) -> f64 {
    const CHORDS: usize = 10;
    let n = POINTS_PER_CROSSING as isize;
    let paths = |crimp: &Crimp| {
        [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[before, after]| {
            let at = |i: isize| {
                let (first, second, start) = if i < 0 { (before, 1.0, -crimp.spacing) } else { (1.0, after, 0.0) };
                crimp.point(first, second, i.rem_euclid(n) as usize) + DVec2::new(start, 0.0)
            };
            (-n..n).map(at).collect::<Vec<_>>()
        })
    };
    let line = |points: Vec<DVec3>| Polyline::from_catmull_rom(&points, false, CHORDS);
    let weft_paths = paths(weft);
    let mut closest = warp.diameter;
    for over in paths(warp) {
        let over = line(over.iter().map(|p| DVec3::new(0.0, p.x, p.y)).collect());
        for under in &weft_paths {
            let under = line(under.iter().map(|p| DVec3::new(p.x, 0.0, -p.y)).collect());
            closest = closest.min(closest_approach(&[over.clone(), under], warp.diameter, PI).unwrap_or(closest));
        }
    }
    closest
}

impl Crimp {
    fn new(spacing: f64, height: f64, diameter: f64) -> Self {
        // [Peirce1937], for arcs whose centres lie 2 (D − height) below each other: spacing = straight cos θ + 2 D sin θ and
        // 2 height = straight sin θ + 2 D (1 − cos θ).
        let offset = 2.0 * (diameter - height);
        let straight = (spacing * spacing + offset * offset - 4.0 * diameter * diameter).max(0.0).sqrt();
        let angle_rad = (2.0 * diameter).atan2(straight) - offset.atan2(spacing);
        Self { spacing, height, diameter, angle_rad, straight }
    }

    /// Point `step` of [`POINTS_PER_CROSSING`], evenly spaced along the yarn from a crossing on the side `first` to one on
    /// the side `second`: distance along the cloth, and height.
    fn point(&self, first: f64, second: f64, step: usize) -> DVec2 {
        let share = step as f64 / POINTS_PER_CROSSING as f64;
        if first == second {
            return DVec2::new(share * self.spacing, first * self.height);
        }
        // The second half is the first one turned about its end.
        let from_end = share.min(1.0 - share);
        let arc = self.diameter * self.angle_rad;
        let length = from_end * (2.0 * arc + self.straight);
        let angle = length.min(arc) / self.diameter;
        let beyond = (length - arc).max(0.0);
        let half = DVec2::new(
            self.diameter * angle.sin() + beyond * self.angle_rad.cos(),
            self.height - self.diameter * (1.0 - angle.cos()) - beyond * self.angle_rad.sin(),
        );
        let path = if share <= 0.5 { half } else { DVec2::new(self.spacing - half.x, -half.y) };
        DVec2::new(path.x, first * path.y)
    }
}
