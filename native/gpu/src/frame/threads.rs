//! How work is shared by threads.

use super::{FrameInput, ROW};
use crate::Object;
use crate::layout;
use crate::upload::Draws;

/// Splits workgroups over two dimensions: a device takes at most 65535 in each.
pub(super) fn fold(workgroups: u32) -> (u32, u32) {
    (workgroups.min(ROW), workgroups.div_ceil(ROW))
}

/// Threads that share lines of so many pixels' length and width, with `steps` joints, inside of `most` pixels: a power of two.
///
/// As `parts_exponent` in `shaders/passes/work.wgsl`, from a bound on all lines of a pass.
pub(super) fn parts(length: f64, width: f64, steps: f64, most: f64) -> u32 {
    const VISITS: f64 = 24_000.0;
    const MOST: u32 = 64;
    let visits = (length.min(most) + steps * width) * width;
    ((visits / VISITS).ceil().clamp(1.0, f64::from(MOST)) as u32).next_power_of_two()
}

/// Layers of a dispatch that a device takes.
pub(super) const MOST_LAYERS: u64 = 65535;

/// As many threads, or fewer where so many layers of a dispatch each take them: a power of two.
pub(super) fn parts_within(parts: u32, layers: u32) -> u32 {
    let most = (MOST_LAYERS as u32 / layers).max(1);
    parts.min(1 << most.ilog2())
}

/// Threads that share a segment's cores: they are drawn while a fiber is thinner than the level of detail's threshold.
pub(super) fn core_parts(input: &FrameInput, draws: &Draws, most: u32) -> u32 {
    let of = |object: &Object| {
        let yarn = &object.yarn;
        let radius = f64::from(input.settings.lod_pixels) * yarn.outer_radius() / (2.0 * yarn.fiber_radius);
        let width = 2.2 * yarn.ellipse_long.max(yarn.ellipse_short) / yarn.outer_radius() * radius + 2.0;
        let plies = f64::from(yarn.plies);
        parts(plies * draws.slenderness * radius, width, 16.0 * plies, 2.0 * plies * f64::from(most))
    };
    input.scene.objects.iter().map(of).max().unwrap_or(1)
}

/// Least w that a shadow view measures sizes at: 1 for a parallel one.
pub(super) fn nearest_w(view: &layout::ShadowView) -> f64 {
    if view.parallel == 1 { 1.0 } else { f64::from(view.near).max(1e-30) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_stay_within_what_a_device_takes() {
        for (parts, layers, expected) in [(64, 8, 64), (64, 1023, 64), (64, 1024, 32), (64, 40000, 1), (1, 65535, 1)] {
            let found = parts_within(parts, layers);
            assert_eq!(found, expected, "{parts} for {layers} layers");
            assert!(u64::from(found) * u64::from(layers) <= MOST_LAYERS);
        }
    }
}
