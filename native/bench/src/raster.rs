//! Ten million fiber segments, narrower than a pixel, all in view: the rasteriser alone.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4, Vec3};
use lisle_core::yarn::{Flyaways, Yarn};
use lisle_core::{Curves, Error as CurveError, Yarns};
use lisle_gpu::{Camera, Renderer, Scene, Settings, Shading};

use crate::options::Options;
use crate::table::{maybe_seconds, millions, milliseconds, seconds, tenths};
use crate::targets::{Figure, Finding};
use crate::views::SIZE;
use crate::{measure, scene, table};

pub const NAME: &str = "raster";
pub const TITLE: &str = "Ten million segments rasterised";

/// The patch: rows of wavy yarn, in pixels. Control points lie so closely that the chord between two of them departs from no fiber by a
/// quarter of a pixel: a fiber at 0.7 of the radius turns by 0.12 × 3.3 / 5 × 2π = 0.5 radians around the yarn between them, which
/// bends it by 0.7 × 5 × 0.5² / 8 = 0.11, and the wave by 0.03. So the renderer draws one line for each fiber and segment, and its
/// count of them is the count of lines.
const RADIUS: f64 = 5.0;
const STEP: f64 = 3.0;
const ROWS: usize = 108;
const SEGMENTS: usize = 413;
const WAVE_LENGTH: f64 = 160.0;
const WAVE_HEIGHT: f64 = 12.0;

fn patch() -> Result<Yarns, CurveError> {
    let height = f64::from(SIZE[1]);
    let spacing = (height - 2.0 * (RADIUS + WAVE_HEIGHT) - 10.0) / (ROWS - 1) as f64;
    let row = |row: usize| -> Vec<[f32; 3]> {
        let y = (row as f64 - 0.5 * (ROWS - 1) as f64) * spacing;
        // Rows are closer than their width: every other one lies below.
        let z = if row.is_multiple_of(2) { RADIUS } else { -RADIUS };
        let point = |i: usize| {
            let x = (i as f64 - 0.5 * SEGMENTS as f64) * STEP;
            let wave = WAVE_HEIGHT * (std::f64::consts::TAU * x / WAVE_LENGTH).sin();
            DVec3::new(x, y + wave, z).as_vec3().to_array()
        };
        (0..=SEGMENTS).map(point).collect()
    };
    Yarns::new(Curves::catmull_rom((0..ROWS).map(row).collect(), false), Some(RADIUS as f32))
}

/// The yarn without flyaways, which have gaps: every fiber counted is drawn.
fn yarn() -> Yarn {
    let yarn = scene::yarn();
    Yarn { flyaways: Flyaways { loop_density: 0.0, hair_density: 0.0, ..yarn.flyaways }, ..yarn }
}

/// Looks down on the patch, a unit of length a pixel.
fn camera() -> Camera {
    let [width, height] = SIZE.map(f64::from);
    let (near, far) = (1.0, 200.0);
    Camera {
        world_from_camera: DMat4::from_translation(DVec3::Z * 100.0),
        clip_from_camera: DMat4::from_cols(
            DVec4::new(2.0 / width, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 / height, 0.0, 0.0),
            DVec4::new(0.0, 0.0, -2.0 / (far - near), 0.0),
            DVec4::new(0.0, 0.0, -(far + near) / (far - near), 1.0),
        ),
        lens: None,
    }
}

/// Measures the passes from culling to visibility, without level of detail, under one sun with hardly a shadow map.
pub fn measure(
    renderer: &Renderer,
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Result<String, Box<dyn std::error::Error>> {
    let yarn = yarn();
    let width = 2.0 * RADIUS * yarn.fiber_radius / yarn.outer_radius();
    let objects = vec![scene::object(&Arc::new(patch()?), yarn)];
    let scene = Scene {
        objects,
        meshes: Vec::new(),
        lights: vec![scene::sun()],
        ambient: Vec3::ZERO,
        environment: None,
        camera: camera(),
    };
    let settings =
        Settings { lod_pixels: 0.0, shadow_resolution: 16, ..scene::settings(Shading::Simple, options.samples) };
    let figures = measure::picture(renderer, &scene, &settings)?;
    let is_raster = |name: &str| name == "cull" || name == "scan" || name.starts_with("visibility");
    let (raster, rest): (Vec<_>, Vec<_>) = figures.passes_ms.iter().partition(|(name, _)| is_raster(name));
    let sum = |passes: &[&(String, f64)]| passes.iter().map(|(_, ms)| ms).sum::<f64>();
    let drawn = millions(figures.statistics.fiber_segments);
    let cpu = maybe_seconds(figures.cpu_s);
    if !raster.is_empty() {
        let remark = format!(
            "{drawn} segments, processor time of the whole sample {cpu} s, {} cores taken by others",
            tenths(figures.noise.others)
        );
        let value = 1e-3 * sum(&raster);
        findings.push(Finding { case: NAME.into(), figure: Figure::Visibility, value, remark });
    }
    let head = [
        "segments drawn",
        "width px",
        "cull to visibility ms",
        "other passes ms",
        "s",
        "fastest",
        "CPU s",
        "load",
        "others",
    ];
    let row = vec![
        drawn,
        format!("{width:.2}"),
        milliseconds(sum(&raster)),
        milliseconds(sum(&rest)),
        seconds(figures.wall_s),
        seconds(figures.fastest_s),
        cpu,
        tenths(figures.noise.load),
        tenths(figures.noise.others),
    ];
    Ok(table::markdown(&head, 0, &[row]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_patch_has_ten_million_fiber_segments_in_view() {
        let (yarns, yarn) = (patch().expect("valid curves"), yarn());
        let count = ROWS * SEGMENTS * (yarn.plies * yarn.fibers_per_ply) as usize;
        assert!((9_900_000..10_200_000).contains(&count), "{count}");
        let limit = SIZE.map(|s| f64::from(s) / 2.0 - RADIUS);
        assert!(yarns.points().iter().all(|p| (0..2).all(|k| f64::from(p[k].abs()) <= limit[k])));
    }
}
