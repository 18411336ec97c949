/// ∫ f over [a, b] by Simpson's rule with `panels` panels of two intervals each.
pub fn simpson(a: f64, b: f64, panels: u32, f: impl Fn(f64) -> f64) -> f64 {
    let h = (b - a) / (2.0 * f64::from(panels));
    let at = |k: u32| f(a + h * f64::from(k));
    let odd: f64 = (0..panels).map(|k| at(2 * k + 1)).sum();
    let even: f64 = (1..panels).map(|k| at(2 * k)).sum();
    (f(a) + 4.0 * odd + 2.0 * even + f(b)) * h / 3.0
}
