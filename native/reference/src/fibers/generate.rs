use std::ops::{ControlFlow, RangeInclusive};

use glam::DMat4;
use lisle_core::strands::Strands;
use lisle_core::yarn::{Fiber, FiberTable, Segment, Twist, Yarn, fiber_seed};
use rayon::prelude::*;
use thiserror::Error;

use super::Fibers;
use super::chain::{Chains, Curve};
use super::detail::{CurveDetail, Detail};

/// Chord errors that make sense: below, f32 rounds more away.
const CHORD_ERRORS: RangeInclusive<f64> = 1e-3..=10.0;

/// Segments of fibers that are made between two calls of the progress callback, about: some hundredths of a second.
const BATCH: usize = 1 << 12;

/// How fibers become chains of points.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// How far a chord may depart from its curve, in radii of the fiber, 0.001 to 10.
    pub chord_error: f64,
    /// Number of the object, which seeds its fibers: that of [`lisle_core::scene::Object::id`].
    pub object_id: u32,
    /// To the space of the points. Radii grow by its mean scale, the cube root of its determinant.
    pub space_from_object: DMat4,
    /// Fewer and wider fibers where a view does not tell them apart; `None` for all.
    pub detail: Option<Detail>,
}

impl Default for Options {
    fn default() -> Self {
        Self { chord_error: 0.25, object_id: 1, space_from_object: DMat4::IDENTITY, detail: None }
    }
}

/// Why there are no fibers.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum FibersError {
    /// More points than 32-bit offsets count.
    #[error("the fibers have more than 4294967295 points: allow a larger chord error, or take fewer curves")]
    TooMany,
    /// A chord error that is not in its range.
    #[error("chord_error is not from 0.001 to 10 radii of a fiber")]
    ChordError,
    /// The progress callback asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// Every fiber of every curve, loops and hairs included, nothing merged, in the order of curves, plies and fibers. `yarn` is a valid one
/// ([`Yarn::validate`]). `progress` is called with the finished share several times a second and can
/// stop the work.
///
/// # Errors
/// [`FibersError`].
pub fn fibers(
    strands: &Strands,
    yarn: &Yarn,
    options: &Options,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Fibers, FibersError> {
    let mut all = Fibers { points: Vec::new(), offsets: vec![0] };
    append(&mut all, strands, yarn, options, progress)?;
    Ok(all)
}

/// Adds the fibers of one object to those of others.
pub(crate) fn append(
    all: &mut Fibers,
    strands: &Strands,
    yarn: &Yarn,
    options: &Options,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), FibersError> {
    if !CHORD_ERRORS.contains(&options.chord_error) {
        return Err(FibersError::ChordError);
    }
    let table = FiberTable::new(yarn);
    for index in 0..strands.closed().len() {
        let closed = strands.closed()[index];
        let segments = Segment::of_curve(strands, index);
        let scale = options.space_from_object.determinant().abs().cbrt();
        let to_space = |point| options.space_from_object.transform_point3(point);
        let detail = |detail| CurveDetail::new(detail, yarn, &table, &segments, to_space, scale);
        let curve = Curve {
            detail: options.detail.as_ref().map(detail),
            yarn,
            table: &table,
            twist: Twist::new(yarn, strands.total_lengths()[index], strands.reference_radii()[index], closed),
            segments,
            to_space: options.space_from_object,
            scale,
            chord_error: options.chord_error,
        };
        let seed = fiber_seed(options.object_id, index as u32);
        let fibers = yarn.plies * yarn.fibers_per_ply;
        let threads = rayon::current_num_threads();
        let count = curve.segments.len();
        let batch = (BATCH / count.max(1)).max(threads) as u32;
        // A long curve has more segments than are made at once.
        let stretch = (BATCH / threads).max(1);
        let curves = strands.closed().len() as f64;
        for first in (0..fibers).step_by(batch as usize) {
            let end = fibers.min(first + batch);
            let of_ply = |i: u32| Fiber { seed, ply: i / yarn.fibers_per_ply, index: i % yarn.fibers_per_ply };
            let mut made: Vec<(Fiber, Chains)> = (first..end).map(|i| (of_ply(i), Chains::default())).collect();
            for start in (0..count).step_by(stretch) {
                let segments = start..count.min(start + stretch);
                let done = f64::from(first) + f64::from(end - first) * segments.end as f64 / count as f64;
                made.par_iter_mut().for_each(|(fiber, chains)| curve.extend(chains, *fiber, segments.clone()));
                if progress((index as f64 + done / f64::from(fibers)) / curves).is_break() {
                    return Err(FibersError::Cancelled);
                }
            }
            let count: usize = made.iter().map(|(_, chains)| chains.points.len()).sum();
            if all.points.len() + count > u32::MAX as usize {
                return Err(FibersError::TooMany);
            }
            all.points.reserve(count);
            for (_, chains) in made {
                let first = all.points.len() as u32;
                all.points.extend(chains.points);
                all.offsets.extend(chains.ends.iter().map(|end| first + end));
            }
        }
    }
    Ok(())
}
