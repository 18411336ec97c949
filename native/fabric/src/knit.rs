//! Knitted cloth over a surface.

use crate::Error;
use crate::cell::{Cell, POINTS_PER_STITCH};
use crate::distance::{Polyline, closest_approach};
use crate::pattern::Pattern;
use crate::relax::relax;
use crate::surface::{Surface, lay};
use glam::{DVec2, DVec3};
use lisle_core::curve::{Basis, Curves};
use std::f64::consts::{PI, TAU};

/// Yarn radius of cloth that does not ask for another, in metres.
pub const YARN_RADIUS_M: f64 = 1e-3;

/// The first guess: wale and course spacing and height of the crossings, loose enough for thin yarns not to touch.
const FIRST_GUESS: [f64; 3] = [9.0, 6.5, 1.5];
/// Yarn in one loop, in yarn radii. Less and stockinette jams: its loops bend tighter than the yarn is thick.
const LOOP_LENGTH: f64 = 26.0;
/// Centre lines keep at least this many diameters apart. The half percent covers the chords of the measurement
/// (8 a segment stand off the curve by up to 0.003 radii).
const CLEARANCE: f64 = 1.005;

/// A rectangular piece of knitted cloth, flat or in the round, before it is laid on a surface.
///
/// Each course is one Catmull-Rom curve of [`POINTS_PER_STITCH`] control points a stitch, from left to right as seen
/// from the front; the curves are ordered from the first course to the last. Number and order of the points depend on
/// the cloth only, never on the surface: lay it on each frame's surface to animate it.
///
/// The loops are the key points of [Chen2003] §3, relaxed as a springy yarn (see the `relax` module). On a surface of
/// the cloth's own size ([`size_m`](Self::size_m), [`tube_radius_m`](Self::tube_radius_m)) the centre lines keep
/// two yarn radii apart; a surface that is smaller presses the yarns into each other, a larger one pulls them apart.
#[derive(Clone, Debug)]
pub struct Knit {
    courses: usize,
    wales: usize,
    round: bool,
    yarn_radius_m: f64,
    /// One repeat, in yarn radii.
    cell: Cell,
    /// The lowest x and y of the cloth's points, and its extent, in yarn radii; in the round x begins at 0.
    low: DVec2,
    extent: DVec2,
}

impl Knit {
    /// A flat piece of `courses` × `wales` stitches; its courses are open yarns.
    ///
    /// # Errors
    /// [`Error::EmptyCloth`], [`Error::TooManyPoints`] or [`Error::YarnRadius`].
    pub fn flat(pattern: &Pattern, courses: usize, wales: usize, yarn_radius_m: f64) -> Result<Self, Error> {
        Self::new(pattern, courses, wales, yarn_radius_m, false)
    }

    /// A tube of `courses` × `wales` stitches; its courses are closed yarns.
    ///
    /// # Errors
    /// As [`flat`](Self::flat), and [`Error::BrokenRound`] if the pattern does not fit round the tube.
    pub fn round(pattern: &Pattern, courses: usize, wales: usize, yarn_radius_m: f64) -> Result<Self, Error> {
        if !wales.is_multiple_of(pattern.columns()) {
            return Err(Error::BrokenRound { wales, columns: pattern.columns() });
        }
        Self::new(pattern, courses, wales, yarn_radius_m, true)
    }

    fn new(pattern: &Pattern, courses: usize, wales: usize, yarn_radius_m: f64, round: bool) -> Result<Self, Error> {
        // Before the relaxation, which takes its time.
        check(courses, wales, yarn_radius_m, round)?;
        Self::of_cell(relaxed(pattern), courses, wales, yarn_radius_m, round)
    }

    /// Cloth of a cell that [`relaxed`] has made, flat or in the round.
    pub(crate) fn of_cell(
        cell: Cell,
        courses: usize,
        wales: usize,
        yarn_radius_m: f64,
        round: bool,
    ) -> Result<Self, Error> {
        check(courses, wales, yarn_radius_m, round)?;
        let columns = cell.row_points / POINTS_PER_STITCH;
        let mut knit = Self { courses, wales, round, yarn_radius_m, cell, low: DVec2::ZERO, extent: DVec2::ZERO };
        let (mut low, mut high) = (DVec2::MAX, DVec2::MIN);
        for course in 0..courses {
            for index in 0..knit.course_points() {
                let point = knit.point(course, index).truncate();
                low = low.min(point);
                high = high.max(point);
            }
        }
        if round {
            low.x = 0.0;
            high.x = knit.cell.size.x * (wales / columns) as f64;
        }
        knit.low = low;
        knit.extent = high - low;
        Ok(knit)
    }

    /// The cloth at rest: width and height of its centre lines in metres. In the round the width is the circumference
    /// of the cloth's middle.
    #[must_use]
    pub fn size_m(&self) -> DVec2 {
        self.extent * self.yarn_radius_m
    }

    /// Radius in metres of the tube on which cloth in the round has its own size at its INNER side, where the stitches
    /// are narrowest; the middle is wider by the cloth's inner half thickness.
    #[must_use]
    pub fn tube_radius_m(&self) -> f64 {
        self.extent.x / TAU * self.yarn_radius_m + self.inner_height_m()
    }

    /// How far the innermost centre lines lie behind the surface, in metres.
    pub(crate) fn inner_height_m(&self) -> f64 {
        self.cell.points.iter().map(|point| -point.z).fold(0.0, f64::max) * self.yarn_radius_m
    }

    /// Wale spacing, course spacing and thickness of the centre lines, in yarn radii; the thickness of the cloth is
    /// two radii more.
    #[must_use]
    pub fn gauge(&self) -> [f64; 3] {
        let [wale, course] = self.cell.spacings();
        let heights = self.cell.points.iter().map(|point| point.z);
        let thickness = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
        [wale, course, thickness]
    }

    /// Number of control points.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.courses * self.course_points()
    }

    /// Lays the cloth on a surface: the control points of all courses, in metres.
    ///
    /// # Errors
    /// [`Error::Surface`] where the surface has no finite position or normal.
    pub fn points_on(&self, surface: &impl Surface) -> Result<Vec<[f32; 3]>, Error> {
        lay(surface, self.courses, |_| self.course_points(), |course, index| self.place(course, index))
    }

    /// Lays the cloth on a surface: a curve per course, with the yarn radius.
    ///
    /// # Errors
    /// As [`points_on`](Self::points_on).
    pub fn swatch(&self, surface: &impl Surface) -> Result<Curves, Error> {
        let per_course = self.course_points() as u32;
        Ok(Curves {
            points: self.points_on(surface)?,
            offsets: (0..=self.courses as u32).map(|course| course * per_course).collect(),
            closed: vec![self.round; self.courses],
            basis: vec![Basis::CatmullRom; self.courses],
            radii: Some(vec![self.yarn_radius_m as f32; self.point_count()]),
        })
    }

    /// Control points of a course. An open yarn ends where the next stitch would begin.
    pub(crate) fn course_points(&self) -> usize {
        self.wales * POINTS_PER_STITCH + usize::from(!self.round)
    }

    /// Where on the surface a control point lies, and its height in metres.
    pub(crate) fn place(&self, course: usize, index: usize) -> (DVec2, f64) {
        let point = self.point(course, index);
        ((point.truncate() - self.low) / self.extent, point.z * self.yarn_radius_m)
    }

    /// A control point in the plane of the cloth, in yarn radii.
    fn point(&self, course: usize, index: usize) -> DVec3 {
        let up = self.cell.size.y * (course / self.cell.rows) as f64;
        self.cell.point(course % self.cell.rows, index as isize) + DVec3::new(0.0, up, 0.0)
    }
}

fn check(courses: usize, wales: usize, yarn_radius_m: f64, round: bool) -> Result<(), Error> {
    if courses == 0 || wales < if round { 3 } else { 1 } {
        return Err(Error::EmptyCloth { courses, wales });
    }
    if !(yarn_radius_m.is_finite() && yarn_radius_m > 0.0) {
        return Err(Error::YarnRadius { value_m: yarn_radius_m });
    }
    let points = wales.checked_mul(POINTS_PER_STITCH).and_then(|n| n.checked_add(1)?.checked_mul(courses));
    if points.is_none_or(|points| points > u32::MAX as usize) {
        return Err(Error::TooManyPoints { courses, wales });
    }
    Ok(())
}

/// One repeat of a pattern as its yarn comes to rest.
pub(crate) fn relaxed(pattern: &Pattern) -> Cell {
    let [wale, course, height] = FIRST_GUESS;
    clear(relax(Cell::from_key_points(pattern, wale, course, height), LOOP_LENGTH))
}

/// Scales a relaxed cell so that its centre lines come as near as [`CLEARANCE`] allows: contacts are springs, which
/// always give way a little.
fn clear(mut cell: Cell) -> Cell {
    const CHORDS: usize = 8;
    let wales = 1 + (3 * POINTS_PER_STITCH).div_ceil(cell.row_points);
    let yarns: Vec<Polyline> = (0..cell.rows + 4)
        .map(|course| {
            let up = DVec3::new(0.0, cell.size.y * (course / cell.rows) as f64, 0.0);
            let points = (-1..=(wales * cell.row_points) as isize + 1).map(|i| cell.point(course % cell.rows, i) + up);
            let mut yarn = Polyline::from_catmull_rom(&points.collect::<Vec<_>>(), false, CHORDS);
            // The outermost segments only lend their control points to the others.
            yarn.points.truncate(yarn.points.len() - CHORDS);
            yarn.points.drain(..CHORDS);
            yarn
        })
        .collect();
    let closest = closest_approach(&yarns, 3.0, PI).unwrap_or(3.0);
    let scale = 2.0 * CLEARANCE / closest;
    cell.size *= scale;
    for point in &mut cell.points {
        *point *= scale;
    }
    cell
}
