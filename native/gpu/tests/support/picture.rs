//! Pictures to look at: with `LISLE_PICTURES` set to a folder, tests leave portable pixmaps there.

use std::io::Write;

use lisle_gpu::Image;

/// Writes the colours over a grey ground, by the sRGB curve.
pub fn show(name: &str, image: &Image) {
    let colors = image.combined.iter().map(|c| [c[0], c[1], c[2]].map(|v| v + 0.1 * (1.0 - c[3])));
    write(name, image.size, colors);
}

/// Writes directions in [−1, 1] as colours.
pub fn show_directions(name: &str, size: [u32; 2], directions: &[[f32; 3]]) {
    write(name, size, directions.iter().map(|d| d.map(|v| 0.5 + 0.5 * v)));
}

/// Writes any colours, 0 to 1.
pub fn write(name: &str, size: [u32; 2], colors: impl Iterator<Item = [f32; 3]>) {
    let Some(folder) = std::env::var_os("LISLE_PICTURES") else { return };
    let code = |v: f32| (v.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0).round() as u8;
    let bytes: Vec<u8> = colors.flat_map(|c| c.map(code)).collect();
    let path = std::path::Path::new(&folder).join(format!("{name}.ppm"));
    let mut file = std::fs::File::create(&path).expect("the folder of LISLE_PICTURES exists");
    write!(file, "P6\n{} {}\n255\n", size[0], size[1]).expect("written");
    file.write_all(&bytes).expect("written");
}
