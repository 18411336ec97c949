use lisle_core::yarn::{FiberTable, Yarn};

use crate::{Bundle, CoreFiber, Occlusion, SectionDensity, SelfShadow};

/// Everything precomputed for one kind of yarn. The same yarn gives the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Tables {
    /// Optical depth towards a light.
    pub self_shadow: SelfShadow,
    /// Visibility from all sides.
    pub occlusion: Occlusion,
    /// The inner fibers of a ply as a texture.
    pub core_fiber: CoreFiber,
}

impl Tables {
    /// Tables of a yarn whose parameters are valid ([`Yarn::validate`]). `resolution`, ≥ 1: times as many texels along each side of those of
    /// self-shadow and occlusion.
    pub fn new(yarn: &Yarn, resolution: usize) -> Self {
        let table = FiberTable::new(yarn);
        let bundle = Bundle::new(yarn, &table);
        Self {
            self_shadow: SelfShadow::new(&bundle, &SectionDensity::new(yarn), resolution),
            occlusion: Occlusion::new(&bundle, resolution),
            core_fiber: CoreFiber::new(yarn, &table),
        }
    }
}

#[cfg(test)]
mod tests {
    use lisle_core::yarn::PRESET_NAMES;

    use super::*;
    use crate::explicit::extreme_yarns;

    #[test]
    fn tables_are_deterministic() {
        for name in PRESET_NAMES {
            let yarn = Yarn::preset(name).expect(name);
            let start = std::time::Instant::now();
            let tables = Tables::new(&yarn, 1);
            let seconds = start.elapsed().as_secs_f64();
            println!("{name}: {seconds:.3} s");
            assert_eq!(tables, Tables::new(&yarn, 1), "{name}");
        }
    }

    #[test]
    fn extreme_yarns_give_finite_tables() {
        for yarn in extreme_yarns() {
            let tables = Tables::new(&yarn, 1);
            assert!(tables.self_shadow.optical_depth.iter().all(|t| t.is_finite() && *t >= 0.0));
            assert!(tables.occlusion.visibility.iter().all(|v| (0.0..=1.0).contains(v)));
            assert!(tables.occlusion.cubic.iter().all(|c| c.is_finite()));
            assert!(tables.core_fiber.texels.iter().flatten().all(|x| x.is_finite()));
        }
    }
}
