//! Words that shaders read in any order, in a texture.
//!
//! Texture units are made for that. Mesa's software driver, too, reads a word of a texture for all threads that run abreast at once, where it goes to a
//! buffer for one after the other: on two processors that takes five to ten times as long.

use crate::Error;
use crate::device::Gpu;

/// Words in a row: WORDS_IN_ROW of `shaders/passes/tables.wgsl`.
pub(crate) const WORDS_IN_ROW: u32 = 4096;

/// A texture of words, one row after the other.
pub(crate) struct WordTexture {
    view: wgpu::TextureView,
    rows: u32,
}

impl WordTexture {
    /// Uploads `words`. Fails if there are more than the device's textures have rows for.
    pub fn new(gpu: &Gpu, label: &str, words: &[u32]) -> Result<Self, Error> {
        let rows = words.len().div_ceil(WORDS_IN_ROW as usize).max(1);
        let most = gpu.limits.max_texture_dimension_2d;
        if rows > most as usize {
            let mebibytes = |rows: u64| (rows * 4 * u64::from(WORDS_IN_ROW)) >> 20;
            return Err(gpu.error(format!(
                "{label} need {} MiB; a texture holds at most {} MiB",
                mebibytes(rows as u64),
                mebibytes(most.into())
            )));
        }
        let rows = rows as u32;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: WORDS_IN_ROW, height: rows, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let write = |words: &[u32], first_row: u32, width: u32, height: u32| {
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    origin: wgpu::Origin3d { x: 0, y: first_row, z: 0 },
                    ..texture.as_image_copy()
                },
                bytemuck::cast_slice(words),
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * WORDS_IN_ROW), rows_per_image: None },
                wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            );
        };
        let (whole, rest) = words.split_at(words.len() - words.len() % WORDS_IN_ROW as usize);
        if !whole.is_empty() {
            write(whole, 0, WORDS_IN_ROW, whole.len() as u32 / WORDS_IN_ROW);
        }
        if !rest.is_empty() {
            write(rest, rows - 1, rest.len() as u32, 1);
        }
        Ok(Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()), rows })
    }

    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.view)
    }

    pub fn bytes(&self) -> u64 {
        u64::from(self.rows) * 4 * u64::from(WORDS_IN_ROW)
    }
}
