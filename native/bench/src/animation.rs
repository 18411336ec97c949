//! One frame of an animation: new control points, frames along the yarns, upload, picture.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use lisle_core::Yarns;
use lisle_gpu::{Renderer, Shading, Statistics};

use crate::measure::Stopwatch;
use crate::options::Options;
use crate::table::{maybe_seconds, mebibytes, milliseconds, tenths};
use crate::views::Views;
use crate::{measure, scene, table};

pub const NAME: &str = "animation";
pub const TITLE: &str = "A frame of an animation";

/// How far the cloth swings, as a share of its height.
const SWING: f32 = 0.05;

/// The garment swung to one side, more so towards its hem; `phase` in turns.
fn swung(yarns: &Yarns, phase: f32) -> Vec<[f32; 3]> {
    let heights = || yarns.rest_points().iter().map(|p| p[2]);
    let (low, high) = (heights().fold(f32::INFINITY, f32::min), heights().fold(f32::NEG_INFINITY, f32::max));
    let swing = SWING * (std::f32::consts::TAU * phase).sin();
    yarns.rest_points().iter().map(|[x, y, z]| [x + swing * (high - z).powi(2) / (high - low), *y, *z]).collect()
}

/// Measures frames of one sample in full view, each from its points to its pixels, after one to warm up.
pub fn measure(renderer: &Renderer, options: &Options, yarns: &Arc<Yarns>) -> Result<String, Box<dyn Error>> {
    let camera = Views::of(yarns).full();
    let settings = scene::settings(Shading::Physical, 1);
    let first_upload = measure::draw_once(renderer, &scene::lit(yarns, camera), &settings)?;
    let points = |frame: u32| swung(yarns, (frame + 1) as f32 / (4 * (options.samples + 1)) as f32);
    let draw = |points: &[[f32; 3]]| -> Result<(f64, Statistics), Box<dyn Error>> {
        let start = Instant::now();
        let moved = Arc::new(yarns.with_points(points)?);
        moved.strands();
        let shape_s = start.elapsed().as_secs_f64();
        Ok((shape_s, measure::draw_once(renderer, &scene::lit(&moved, camera), &settings)?))
    };
    draw(&points(0))?;
    let shapes: Vec<_> = (1..=options.samples).map(points).collect();
    let (mut shape_s, mut passes_ms, mut uploaded) = (0.0, 0.0, 0);
    let watch = Stopwatch::start();
    for points in &shapes {
        let (seconds, statistics) = draw(points)?;
        shape_s += seconds;
        passes_ms += statistics.passes.iter().map(|(_, ms)| ms).sum::<f64>();
        uploaded = statistics.uploaded_bytes;
    }
    let (wall_s, cpu_s, noise) = watch.stop();
    let count = f64::from(options.samples);
    let head = [
        "control points",
        "frames along the yarns ms",
        "upload and picture ms",
        "of it passes ms",
        "CPU s",
        "uploaded MiB",
        "all data MiB",
        "load",
        "others",
    ];
    let row = vec![
        yarns.points().len().to_string(),
        milliseconds(1e3 * shape_s / count),
        milliseconds(1e3 * (wall_s - shape_s) / count),
        milliseconds(passes_ms / count),
        maybe_seconds(cpu_s.map(|sum| sum / count)),
        mebibytes(uploaded),
        mebibytes(first_upload.knot_bytes),
        tenths(noise.load),
        tenths(noise.others),
    ];
    Ok(table::markdown(&head, 0, &[row]))
}
