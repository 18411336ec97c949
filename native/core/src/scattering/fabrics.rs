use std::sync::LazyLock;

use glam::DVec3;

use super::Thread;

/// A woven cloth whose threads were fitted to photographs and measurements [Sadeghi2012, Table 2].
#[derive(Clone, Debug, PartialEq)]
pub struct Fabric {
    /// Lower case, words joined by hyphens.
    pub name: &'static str,
    /// One thread for both directions, or one for each.
    pub threads: Vec<(&'static str, Thread)>,
}

/// Thread, colour of A and its factor, k_d, γ_s and γ_v in degrees.
type Row = (&'static str, [f64; 3], f64, f64, [f64; 2]);

#[rustfmt::skip]
const TABLE: [(&str, f64, &[Row]); 5] = [
    ("linen-plain", 1.46, &[
        ("both", [0.2, 0.8, 1.0], 0.3, 0.3, [12.0, 24.0]),
    ]),
    ("silk-crepe-de-chine", 1.345, &[
        ("flat", [1.0, 0.95, 0.05], 0.12, 0.2, [5.0, 10.0]),
        ("twisted", [1.0, 0.95, 0.05], 0.16, 0.3, [18.0, 32.0]),
    ]),
    ("polyester-satin-charmeuse", 1.539, &[
        ("flat", [1.0, 0.37, 0.3], 0.035, 0.1, [2.5, 5.0]),
        ("twisted", [1.0, 0.37, 0.3], 0.2, 0.7, [30.0, 60.0]),
    ]),
    ("silk-shot", 1.345, &[
        ("direction-1", [0.1, 1.0, 0.4], 0.2, 0.1, [4.0, 8.0]),
        ("direction-2", [1.0, 0.0, 0.1], 0.6, 0.1, [5.0, 10.0]),
    ]),
    ("velvet", 1.46, &[
        ("both", [0.05, 0.02, 0.0], 0.3, 0.1, [6.0, 12.0]),
    ]),
];

/// The five fabrics of the table.
pub static FABRICS: LazyLock<Vec<Fabric>> = LazyLock::new(|| {
    let thread = |refraction, (name, color, factor, isotropic, [surface, volume]): Row| {
        let thread = Thread {
            refraction,
            color: DVec3::from(color) * factor,
            isotropic,
            surface_width_rad: surface.to_radians(),
            volume_width_rad: volume.to_radians(),
        };
        (name, thread)
    };
    let fabric = |&(name, refraction, rows): &(&'static str, f64, &[Row])| Fabric {
        name,
        threads: rows.iter().map(|row| thread(refraction, *row)).collect(),
    };
    TABLE.iter().map(fabric).collect()
});

/// Every thread of every fabric, named `fabric thread`.
pub fn fabric_threads() -> Vec<(String, Thread)> {
    let named = |fabric: &Fabric| {
        fabric.threads.iter().map(|(name, thread)| (format!("{} {name}", fabric.name), *thread)).collect::<Vec<_>>()
    };
    FABRICS.iter().flat_map(named).collect()
}
