//! What the figures should be, and what they are.

use crate::{models, multiple, raster, table};

/// What is held against a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Wall time per sample, seconds.
    Sample,
    /// GPU time of culling and visibility per sample, seconds.
    Visibility,
    /// Wall time for the table of a yarn and a material, seconds.
    Table,
    /// Wall time per sample with light scattered any number of times, by that of light scattered once.
    MultipleByOnce,
    /// GPU memory of control points and what belongs to each, MiB.
    Knots,
}

/// An upper bound.
struct Target {
    case: &'static str,
    figure: Figure,
    below: f64,
    unit: &'static str,
    /// Where it holds, and what it is about.
    about: &'static str,
}

const TARGETS: [Target; 5] = [
    Target {
        case: "glove.bcc, full, physical",
        figure: Figure::Sample,
        below: 0.5,
        unit: "s",
        about: "per sample, on 2 cores and the software driver",
    },
    Target {
        case: raster::NAME,
        figure: Figure::Visibility,
        below: 0.6,
        unit: "s",
        about: "10 M visible sub-pixel segments rasterised, on 2 cores and the software driver",
    },
    Target {
        case: multiple::NAME,
        figure: Figure::Table,
        below: 60.0,
        unit: "s",
        about: "table of multiple scattering for the slowest presets, on 2 cores",
    },
    Target {
        case: "glove.bcc, full",
        figure: Figure::MultipleByOnce,
        below: 1.3,
        unit: "times",
        about: "light scattered any number of times, by light scattered once",
    },
    Target {
        case: models::GARMENT,
        figure: Figure::Knots,
        below: 64.0,
        unit: "MiB",
        about: "2 M control points on the GPU, tables aside",
    },
];

/// A measured figure.
pub struct Finding {
    /// Model, or model, view and shading.
    pub case: String,
    pub figure: Figure,
    pub value: f64,
    /// What else to know about it.
    pub remark: String,
}

/// Every target and what was measured.
pub fn table(findings: &[Finding]) -> String {
    let row = |target: &Target| {
        let found = findings.iter().find(|found| found.case == target.case && found.figure == target.figure);
        let (value, verdict, remark) = match found {
            None => ("–".to_owned(), "not measured", ""),
            Some(found) => {
                let verdict = if found.value < target.below { "met" } else { "missed" };
                (format!("{:.3} {}", found.value, target.unit), verdict, found.remark.as_str())
            }
        };
        let below = format!("< {} {}", target.below, target.unit);
        [target.case, target.about, &below, &value, verdict, remark].map(str::to_owned).to_vec()
    };
    let rows: Vec<_> = TARGETS.iter().map(row).collect();
    table::markdown(&["case", "figure", "target", "measured", "", "beside it"], 6, &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_the_figures() {
        let finding = |case: &str, figure, value| Finding { case: case.into(), figure, value, remark: String::new() };
        let text = table(&[
            finding("glove.bcc, full, physical", Figure::Sample, 0.49),
            finding(raster::NAME, Figure::Visibility, 0.6),
            finding(models::GARMENT, Figure::Sample, 1.0),
        ]);
        let lines: Vec<&str> = text.lines().skip(2).collect();
        assert!(lines[0].contains("| met "), "{text}");
        assert!(lines[1].contains("| missed "), "{text}");
        assert!(lines[2..5].iter().all(|line| line.contains("| not measured ")), "{text}");
    }
}
