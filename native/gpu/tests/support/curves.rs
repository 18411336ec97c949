//! Curves to draw.

use glam::DVec3;

/// `count` points of a curve over t in [0, 1].
pub fn sampled(count: usize, at: impl Fn(f64) -> DVec3) -> Vec<[f32; 3]> {
    (0..count).map(|i| at(i as f64 / (count - 1) as f64).as_vec3().to_array()).collect()
}

/// A straight yarn along X, centred at the origin.
pub fn straight(length: f64, count: usize) -> Vec<[f32; 3]> {
    sampled(count, |t| DVec3::new((t - 0.5) * length, 0.0, 0.0))
}

/// A yarn along X that bends up, down and in depth.
pub fn wave(length: f64, height: f64, count: usize) -> Vec<[f32; 3]> {
    sampled(count, |t| {
        let a = std::f64::consts::TAU * 1.3 * t;
        DVec3::new((t - 0.5) * length, 0.6 * height * (0.8 * a + 0.4).cos(), height * a.sin())
    })
}

/// A closed, bent ring of radius 1 about the Y axis.
pub fn ring(count: usize) -> Vec<[f32; 3]> {
    (0..count)
        .map(|i| {
            let a = std::f64::consts::TAU * i as f64 / count as f64;
            DVec3::new(a.cos(), 0.3 * (2.0 * a).sin(), a.sin()).as_vec3().to_array()
        })
        .collect()
}

/// Rows of sine waves that touch each other, in the XZ plane: a patch of loose cloth.
pub fn patch(rows: usize, length: f64, count: usize) -> Vec<Vec<[f32; 3]>> {
    (0..rows)
        .map(|row| {
            let z = 0.18 * (row as f64 - 0.5 * (rows - 1) as f64);
            sampled(count, |t| {
                let a = std::f64::consts::TAU * 6.0 * t + row as f64 * std::f64::consts::PI;
                DVec3::new((t - 0.5) * length, 0.1 * a.cos(), z + 0.06 * (2.0 * a).sin())
            })
        })
        .collect()
}
