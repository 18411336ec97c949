use lisle_core::yarn::{PRESET_NAMES, Yarn};
use lisle_precompute::{SectionDensity, SelfShadow};
fn main() {
    for name in PRESET_NAMES {
        let yarn = Yarn::preset(name).unwrap();
        let s = SelfShadow::new(&SectionDensity::new(&yarn), 1);
        let n = s.size;
        let mut t = vec![0.0f64; n];
        for k in 0..s.slices {
            for y in 0..n {
                t[y] += (-(s.optical_depth[(k * n + y) * n] as f64)).exp() / s.slices as f64;
            }
        }
        let step = 2.0 * s.extent as f64 / n as f64;
        let blocked: f64 = t.iter().map(|t| (1.0 - t) * step).sum::<f64>() / 2.0;
        let prof: Vec<String> = (0..10)
            .map(|i| {
                let y = i as f64 * 0.125;
                let k = ((y / s.extent as f64 * 0.5 + 0.5) * n as f64) as usize;
                format!("{:.2}", t[k])
            })
            .collect();
        println!("{name}: through {:.3}, r_eff {:.3}, T(y=0,.125..) {}", s.through_circle, blocked, prof.join(" "));
    }
}
