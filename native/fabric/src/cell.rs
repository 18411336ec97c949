//! The first guess of a pattern's shape: key points after [Chen2003] §3, resampled evenly along the yarn.
//!
//! One *cell* is one repeat of the pattern in the plane of the cloth. Lengths are in yarn radii; x runs along the
//! wales' spacing (to the right), y along the courses (up), z out of the front of the cloth.

use crate::pattern::Pattern;
use glam::{DVec2, DVec3};

/// Control points of one stitch, from the middle of one sinker arc to just before the next.
pub const POINTS_PER_STITCH: usize = 20;

/// One repeat of a pattern: course after course, wale after wale, [`POINTS_PER_STITCH`] points a stitch.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    /// Courses in the repeat.
    pub rows: usize,
    /// Control points of one course of the repeat.
    pub row_points: usize,
    /// Width and height of the repeat, in yarn radii.
    pub size: DVec2,
    /// Positions in yarn radii; course `r` begins at `r * row_points`.
    pub points: Vec<DVec3>,
}

impl Cell {
    /// Point `index` of course `row`, where an index outside the repeat means the neighbouring repeat.
    pub fn point(&self, row: usize, index: isize) -> DVec3 {
        let n = self.row_points as isize;
        let shift = self.size.x * index.div_euclid(n) as f64;
        self.points[row * self.row_points + index.rem_euclid(n) as usize] + DVec3::new(shift, 0.0, 0.0)
    }

    /// Spacing of wales and of courses, in yarn radii.
    pub fn spacings(&self) -> [f64; 2] {
        let columns = self.row_points / POINTS_PER_STITCH;
        [self.size.x / columns as f64, self.size.y / self.rows as f64]
    }

    /// Loops of `wale` × `course` yarn radii with interlocking heights of `height` yarn radii.
    pub fn from_key_points(pattern: &Pattern, wale: f64, course: f64, height: f64) -> Self {
        let mut points = Vec::with_capacity(pattern.rows() * pattern.columns() * POINTS_PER_STITCH);
        let scale = DVec3::new(wale, course, height);
        for row in 0..pattern.rows() {
            for column in 0..pattern.columns() {
                let key = key_points(pattern, row, column);
                let origin = DVec3::new(column as f64, row as f64, 0.0);
                points.extend(resample(&key, scale).map(|point| point + origin * scale));
            }
        }
        Self {
            rows: pattern.rows(),
            row_points: pattern.columns() * POINTS_PER_STITCH,
            size: DVec2::new(wale * pattern.columns() as f64, course * pattern.rows() as f64),
            points,
        }
    }
}

/// Key points of one loop in units of (wale, course, height), from sinker arc to sinker arc.
///
/// [Chen2003] prints six points a loop, on a rectangle of nodes n0 … n3 whose loops hang towards −v; turned upside
/// down, so that loops are built upwards as on a needle, they are the rows marked `k0` … `k5` below, to the digit.
/// (k0 = 0.35 (n3 − n0) + n3 is a point on the rectangle's left SIDE, not in its middle as its twin k3: the sinker
/// arc, shared with the loop to the left. n4, which the paper does not define, can only be the node beyond n0.)
/// Between them come the points where the yarn crosses other yarns; those carry the offsets along the normal which
/// the paper leaves to "collision avoidance".
fn key_points(pattern: &Pattern, row: usize, column: usize) -> Vec<DVec3> {
    let columns = pattern.columns();
    let sign = |row: usize, column: usize| pattern.stitch(row, column).sign();
    let own = sign(row, column);
    let above = sign(row + 1, column);
    let left = sign(row, column + columns - 1);
    let right = sign(row, column + 1);
    let leg = [
        (0.160, -0.22, -own),               // the foot, behind (knit) the legs of the loop below
        (0.375, 0.00, 0.0),                 // k1
        (0.330, 0.33, own),                 // in front of the head of the loop below
        (0.250, 0.50, 0.5 * (own + above)), // the middle of the leg
        (0.170, 0.72, above),               // in front of the feet of the loop above
        (0.125, 1.00, 0.0),                 // k2
        (0.300, 1.30, -above),              // the head, behind the legs of the loop above
    ];
    let mut points = vec![DVec3::new(0.0, -0.35, -0.5 * (left + own))]; // k0
    points.extend(leg.iter().map(|&(x, y, z)| DVec3::new(x, y, z)));
    points.push(DVec3::new(0.5, 1.35, -above)); // k3
    points.extend(leg.iter().rev().map(|&(x, y, z)| DVec3::new(1.0 - x, y, z))); // … k4 … k5 …
    points.push(DVec3::new(1.0, -0.35, -0.5 * (own + right))); // k0 of the next loop
    points
}

/// [`POINTS_PER_STITCH`] points at equal lengths along the polyline through `key * scale`, its last point left out.
fn resample(key: &[DVec3], scale: DVec3) -> impl Iterator<Item = DVec3> {
    let key: Vec<DVec3> = key.iter().map(|&point| point * scale).collect();
    let mut lengths = vec![0.0];
    for pair in key.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
    }
    let total = lengths[lengths.len() - 1];
    (0..POINTS_PER_STITCH).map(move |i| {
        let target = total * i as f64 / POINTS_PER_STITCH as f64;
        let end = lengths.partition_point(|&length| length <= target).min(key.len() - 1);
        let t = (target - lengths[end - 1]) / (lengths[end] - lengths[end - 1]);
        key[end - 1].lerp(key[end], t)
    })
}
