//! Fewer fibers where a view does not tell them apart.

use glam::DVec3;
use lisle_core::sampling::even_ranks;
use lisle_core::view::View;
use lisle_core::yarn::{FiberTable, Segment, Yarn};

/// How far a chord may be off on the picture, pixels.
const CHORD_PIXELS: f64 = 0.25;

/// What a view sees. Fibers thinner than a width are merged: fewer are made, each as much wider, so that their area stays.
///
/// The renderer's own level of detail keeps the outermost fibers, and draws one core per ply for the others [WuYuksel2018 §3.3]. Here
/// those that remain are spread evenly over the section, since other renderers know no cores.
#[derive(Clone, Copy, Debug)]
pub struct Detail {
    /// The view; the space of the points is the world.
    pub view: View,
    /// Least width, pixels, above 0.
    pub lod_pixels: f64,
}

/// [`Detail`] of one curve.
pub(super) struct CurveDetail {
    /// Share of the fibers at each end of every segment.
    shares: Vec<[f64; 2]>,
    /// Chord error at the nearer end of every segment, units of length.
    chord_errors: Vec<f64>,
    /// Rank of each fiber of a ply: the first ranks remain.
    ranks: Vec<usize>,
}

impl CurveDetail {
    /// `to_space` takes a point to the space, `scale` is its mean scale.
    pub fn new(
        detail: &Detail,
        yarn: &Yarn,
        table: &FiberTable,
        segments: &[Segment],
        to_space: impl Fn(DVec3) -> DVec3,
        scale: f64,
    ) -> Self {
        let count = table.radius.len() as f64;
        let at = |segment: &Segment, t: f64| {
            let point = segment.at(t);
            let pixels = detail.view.pixels_per_unit_at(to_space(point.position) - detail.view.origin);
            let width = 2.0 * point.radius * scale * yarn.fiber_radius / yarn.outer_radius() * pixels;
            ((width / detail.lod_pixels).clamp(1.0 / count, 1.0), CHORD_PIXELS / pixels)
        };
        let (shares, chord_errors) = segments
            .iter()
            .map(|segment| (at(segment, 0.0), at(segment, 1.0)))
            .map(|(a, b)| ([a.0, b.0], a.1.min(b.1)))
            .unzip();
        Self { shares, chord_errors, ranks: even_ranks(table.radius.len()) }
    }

    /// Factor on the width of a fiber at a place on a segment.
    pub fn width(&self, segment: usize, t: f64, index: u32) -> f64 {
        let [a, b] = self.shares[segment];
        let share = a + (b - a) * t;
        (share * self.ranks.len() as f64 - self.ranks[index as usize] as f64).clamp(0.0, 1.0) / share
    }

    /// Whether a fiber is nowhere on a segment.
    pub fn is_hidden(&self, segment: usize, index: u32) -> bool {
        self.width(segment, 0.0, index) == 0.0 && self.width(segment, 1.0, index) == 0.0
    }

    /// Chord error on a segment, units of length.
    pub fn chord_error(&self, segment: usize) -> f64 {
        self.chord_errors[segment]
    }
}
