//! Models in close, worst and full view, with each shading [WuYuksel2018 Table 1].

use std::sync::Arc;

use lisle_core::Yarns;
use lisle_gpu::{Camera, Error, Renderer, Settings, Shading};

use crate::measure::{self, Measurement};
use crate::options::Options;
use crate::scene;
use crate::table::{maybe_seconds, mebibytes, millions, milliseconds, seconds, tenths};
use crate::targets::{Figure, Finding};
use crate::views::Views;

/// Distances tried for the worst view, from close to full.
const STEPS: u32 = 12;
const QUICK_STEPS: u32 = 4;

/// Shading models, photons of multiple scattering, and what the table calls them.
const SHADINGS: [(Shading, u32, &str); 3] =
    [(Shading::Simple, 0, "simple"), (Shading::Physical, 0, "physical"), (Shading::Physical, 500_000, "multiple")];

/// A line of the table.
pub struct Row {
    model: String,
    view: &'static str,
    shading: &'static str,
    figures: Measurement,
}

/// Measures a model in all views and shadings.
pub fn measure_views(
    renderer: &Renderer,
    options: &Options,
    model: &str,
    yarns: &Arc<Yarns>,
    findings: &mut Vec<Finding>,
) -> Result<Vec<Row>, Error> {
    let views = Views::of(yarns);
    let steps = if options.quick { QUICK_STEPS } else { STEPS };
    let mut rows = Vec::new();
    for view in ["close", "worst", "full"] {
        let wanted: Vec<_> = SHADINGS.into_iter().filter(|(.., name)| options.wants_case(view, name)).collect();
        if wanted.is_empty() {
            continue;
        }
        let camera = match view {
            "close" => views.close(),
            "worst" => worst(renderer, yarns, &views, steps)?,
            _ => views.full(),
        };
        let mut once_s = None;
        for (shading, photons, name) in wanted {
            let settings = Settings { transport_photons: photons, ..scene::settings(shading, options.samples) };
            let figures = measure::picture(renderer, &scene::lit(yarns, camera), &settings)?;
            eprintln!("  {view}, {name}: {} s per sample", seconds(figures.wall_s));
            findings.push(Finding {
                case: format!("{model}, {view}, {name}"),
                figure: Figure::Sample,
                value: figures.wall_s,
                remark: format!(
                    "fastest sample {} s, processor time {} s, {} cores taken by others",
                    seconds(figures.fastest_s),
                    maybe_seconds(figures.cpu_s),
                    tenths(figures.noise.others)
                ),
            });
            match name {
                "physical" => once_s = Some(figures.wall_s),
                "multiple" => findings.extend(once_s.map(|once_s| Finding {
                    case: format!("{model}, {view}"),
                    figure: Figure::MultipleByOnce,
                    value: figures.wall_s / once_s,
                    remark: format!("{} s by {} s", seconds(figures.wall_s), seconds(once_s)),
                })),
                _ => {}
            }
            rows.push(Row { model: model.into(), view, shading: name, figures });
        }
    }
    if let Some(row) = rows.last() {
        let knots = row.figures.statistics.knot_bytes;
        let remark = format!("{} control points", yarns.points().len());
        let value = knots as f64 / f64::from(1 << 20);
        findings.push(Finding { case: model.into(), figure: Figure::Knots, value, remark });
    }
    Ok(rows)
}

/// The view between close and full in which most fiber segments are drawn.
fn worst(renderer: &Renderer, yarns: &Arc<Yarns>, views: &Views, steps: u32) -> Result<Camera, Error> {
    // Only counts matter here, not shadows.
    let settings = Settings { shadow_resolution: 16, ..scene::settings(Shading::Simple, 1) };
    let mut most: Option<(u64, Camera)> = None;
    for step in 1..steps {
        let camera = views.between(f64::from(step) / f64::from(steps));
        let drawn = measure::draw_once(renderer, &scene::lit(yarns, camera), &settings)?.fiber_segments;
        if most.as_ref().is_none_or(|(known, _)| drawn > *known) {
            most = Some((drawn, camera));
        }
    }
    Ok(most.map_or_else(|| views.full(), |(_, camera)| camera))
}

/// All rows; one column for each pass that any of them has.
pub fn table(rows: &[Row]) -> String {
    let mut passes: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flat_map(|row| &row.figures.passes_ms) {
        if !passes.contains(&name.as_str()) {
            passes.push(name);
        }
    }
    let mut head = vec!["model", "view", "shading", "s", "fastest", "CPU s"];
    let names: Vec<String> = passes.iter().map(|pass| format!("{} ms", pass.replace("visibility_", ""))).collect();
    head.extend(names.iter().map(String::as_str));
    head.extend(["segments drawn", "points MiB", "GPU MiB", "load", "others"]);
    let line = |row: &Row| {
        let figures = &row.figures;
        let statistics = &figures.statistics;
        let mut cells = vec![row.model.clone(), row.view.into(), row.shading.into()];
        cells.extend([seconds(figures.wall_s), seconds(figures.fastest_s), maybe_seconds(figures.cpu_s)]);
        cells.extend(passes.iter().map(|pass| {
            let found = figures.passes_ms.iter().find(|(name, _)| name == pass);
            found.map_or_else(|| "–".into(), |(_, ms)| milliseconds(*ms))
        }));
        cells.push(millions(statistics.fiber_segments));
        cells.extend([mebibytes(statistics.knot_bytes), mebibytes(statistics.gpu_bytes)]);
        cells.extend([tenths(figures.noise.load), tenths(figures.noise.others)]);
        cells
    };
    crate::table::markdown(&head, 3, &rows.iter().map(line).collect::<Vec<_>>())
}
