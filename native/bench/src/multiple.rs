//! The tables of multiple scattering: how long they take to make, for every preset of yarn and of material.

use std::ops::ControlFlow;

use lisle_core::scattering::{MATERIAL_NAMES, Material};
use lisle_core::yarn::{PRESET_NAMES, Yarn};
use lisle_gpu::Settings;
use lisle_precompute::Transport;

use crate::measure::Stopwatch;
use crate::options::Options;
use crate::table::{self, maybe_seconds, seconds, tenths};
use crate::targets::{Figure, Finding};

pub const NAME: &str = "tables";
pub const TITLE: &str = "Tables of multiple scattering";

/// A yarn's slowest material, in seconds, and all of them together.
struct Slowest {
    yarn: &'static str,
    material: &'static str,
    wall_s: f64,
    cpu_s: Option<f64>,
    others: Option<f64>,
    sum_s: f64,
    count: usize,
}

/// Makes the table of every pair, or with `--quick` of every yarn and the first material.
pub fn measure(options: &Options, findings: &mut Vec<Finding>) -> String {
    let photons = Settings::default().transport_photons;
    let materials = &MATERIAL_NAMES[..if options.quick { 1 } else { MATERIAL_NAMES.len() }];
    let slowest: Vec<Slowest> = PRESET_NAMES.iter().map(|yarn| slowest(yarn, materials, photons)).collect();
    if let Some(worst) = slowest.iter().max_by(|a, b| a.wall_s.total_cmp(&b.wall_s)) {
        findings.push(Finding {
            case: NAME.into(),
            figure: Figure::Table,
            value: worst.wall_s,
            remark: format!(
                "{} in {}, processor time {} s, {} cores taken by others",
                worst.yarn,
                worst.material,
                maybe_seconds(worst.cpu_s),
                tenths(worst.others)
            ),
        });
    }
    let row = |found: &Slowest| {
        vec![
            found.yarn.to_owned(),
            seconds(found.sum_s / found.count as f64),
            found.material.to_owned(),
            seconds(found.wall_s),
            maybe_seconds(found.cpu_s),
            tenths(found.others),
        ]
    };
    let rows: Vec<_> = slowest.iter().map(row).collect();
    format!(
        "{photons} photons, {} materials a yarn.\n\n{}",
        materials.len(),
        table::markdown(&["yarn", "mean s", "slowest material", "s", "CPU s", "others"], 1, &rows)
    )
}

fn slowest(yarn: &'static str, materials: &[&'static str], photons: u32) -> Slowest {
    let kind = Yarn::preset(yarn).expect("a preset");
    let mut worst = Slowest { yarn, material: "", wall_s: 0.0, cpu_s: None, others: None, sum_s: 0.0, count: 0 };
    for name in materials {
        let material = Material::preset(name).expect("a preset");
        let watch = Stopwatch::start();
        let made = Transport::new(&kind, &material, photons, &mut || ControlFlow::Continue(()));
        let (wall_s, cpu_s, noise) = watch.stop();
        assert!(made.is_continue(), "nobody stops it");
        eprintln!("  {yarn}, {name}: {} s", seconds(wall_s));
        worst.sum_s += wall_s;
        worst.count += 1;
        if wall_s > worst.wall_s {
            (worst.material, worst.wall_s, worst.cpu_s, worst.others) = (name, wall_s, cpu_s, noise.others);
        }
    }
    worst
}
