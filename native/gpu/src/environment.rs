//! The picture of the sky on the GPU: what the camera sees of it. Light from it comes by way of `lights.rs`.

use std::sync::Arc;

use glam::Vec4;
use lisle_core::scene::{Environment, EnvironmentImage};
use rayon::prelude::*;

use crate::Error;
use crate::device::Gpu;
use crate::layout::Sky;
use crate::upload::{empty_storage, storage};

/// Largest finite half.
const MOST: f32 = 65504.0;

/// The sky of the last picture.
pub(crate) struct SkyBuffers {
    image: Option<Arc<EnvironmentImage>>,
    size: [u32; 2],
    pub texels: wgpu::Buffer,
    pub sky: wgpu::Buffer,
}

impl SkyBuffers {
    /// Brings the GPU up to date, reusing what `previous` already holds.
    pub fn update(gpu: &Gpu, previous: Option<Self>, environment: Option<&Environment>) -> Result<Self, Error> {
        let environment = environment.filter(|environment| environment.shines());
        let image = environment.map(|environment| &environment.image);
        let kept = previous.filter(|p| match (&p.image, image) {
            (None, None) => true,
            (Some(kept), Some(image)) => Arc::ptr_eq(kept, image),
            _ => false,
        });
        let buffers = match kept {
            Some(buffers) => buffers,
            None => {
                let (size, texels) = image.map_or(([0, 0], Vec::new()), |image| {
                    halves(image, gpu.limits.max_storage_buffer_binding_size.min(gpu.limits.max_buffer_size))
                });
                Self {
                    image: image.cloned(),
                    size,
                    texels: storage(gpu, "environment", &texels)?,
                    sky: empty_storage(gpu, "sky", size_of::<Sky>() as u64)?,
                }
            }
        };
        let mut sky = Sky { size: buffers.size, ..Default::default() };
        if let Some(environment) = environment {
            // Render space has the world's axes.
            let rows = environment.world_from_environment.as_mat3();
            let row = |column: glam::Vec3| -> Vec4 { column.extend(0.0) };
            sky.environment_from_render_x = row(rows.x_axis);
            sky.environment_from_render_y = row(rows.y_axis);
            sky.environment_from_render_z = row(rows.z_axis);
            sky.strength = environment.strength;
        }
        gpu.queue.write_buffer(&buffers.sky, 0, bytemuck::bytes_of(&sky));
        Ok(buffers)
    }

    pub fn bytes(&self) -> u64 {
        self.texels.size() + self.sky.size()
    }
}

/// Texels as four halves each, red in the lowest bits; at half the size, and again, until they fit in so many bytes.
fn halves(image: &EnvironmentImage, most_bytes: u64) -> ([u32; 2], Vec<[u32; 2]>) {
    let mut size = image.size();
    let mut smaller = Vec::new();
    while 8 * u64::from(size[0]) * u64::from(size[1]) > most_bytes {
        smaller = halved(size, if smaller.is_empty() { image.radiance() } else { &smaller });
        size = size.map(|side| side.div_ceil(2));
    }
    let texels = if smaller.is_empty() { image.radiance() } else { &smaller };
    let word = |a: f32, b: f32| u32::from(half(a)) | u32::from(half(b)) << 16;
    (size, texels.par_iter().map(|[r, g, b]| [word(*r, *g), word(*b, 0.0)]).collect())
}

/// Means of two by two texels; at an odd edge, of those that there are.
fn halved([width, height]: [u32; 2], texels: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mean = |x: u32, y: u32| {
        let mut sum = glam::Vec3::ZERO;
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (x, y) = ((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
            sum += glam::Vec3::from(texels[y as usize * width as usize + x as usize]);
        }
        (0.25 * sum).to_array()
    };
    let columns = width.div_ceil(2);
    let row = |y: u32| (0..columns).into_par_iter().map(move |x| mean(x, y));
    (0..height.div_ceil(2)).into_par_iter().flat_map(row).collect()
}

/// The nearest half of a number of at least 0; what is larger than any becomes the largest.
fn half(value: f32) -> u16 {
    let value = value.min(MOST);
    // Below the least normal half, steps are even.
    if value < 6.103_515_6e-5 {
        return (value * 16_777_216.0).round_ties_even() as u16;
    }
    let bits = value.to_bits();
    // To nearest, ties to even, thirteen bits fewer; the exponent's bias goes from 127 to 15.
    let rounded = bits + 0xfff + (bits >> 13 & 1);
    ((rounded >> 13) - (112 << 10)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(half: u16) -> f32 {
        let (exponent, mantissa) = (i32::from(half >> 10), f32::from(half & 1023));
        if exponent == 0 { mantissa * 2f32.powi(-24) } else { (1.0 + mantissa / 1024.0) * 2f32.powi(exponent - 15) }
    }

    #[test]
    fn halves_are_the_nearest() {
        for i in 0..20_000_u32 {
            let x = 1e-8 * 1.0015_f32.powi(i as i32);
            let found = value(half(x));
            let bound = if x > MOST { x - MOST } else { (x / 2048.0).max(2f32.powi(-25)) };
            assert!((found - x).abs() <= bound * 1.0001, "{x} became {found}");
        }
        assert_eq!([0.0, 1.0, 0.5, 65504.0, 1e9].map(half), [0, 0x3c00, 0x3800, 0x7bff, 0x7bff]);
    }

    #[test]
    fn what_is_too_large_is_halved() {
        let texels: Vec<[f32; 3]> = (0..15).map(|i| [i as f32, 1.0, 0.0]).collect();
        let image = EnvironmentImage::new([5, 3], texels).expect("radiances");
        assert_eq!(halves(&image, 120).0, [5, 3]);
        let (size, words) = halves(&image, 119);
        assert_eq!(size, [3, 2]);
        // Of 0, 1, 5, 6; of 4, 9 at the right edge; of 10, 11 at the lower one.
        let red = |i: usize| value(words[i][0] as u16);
        assert_eq!([red(0), red(2), red(3)], [3.0, 6.5, 10.5]);
    }
}
