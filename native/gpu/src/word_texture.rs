//! Words that shaders read in any order, in a texture.
//!
//! Texture units are made for that. Mesa's software driver, too, reads a texel for all threads that run abreast at once, where it goes to a
//! buffer for one after the other: on two processors that takes five to ten times as long.

use std::marker::PhantomData;

use bytemuck::Pod;

use crate::Error;
use crate::device::Gpu;

/// Texels in a row, a power of two: TEXELS_IN_ROW of `shaders/math/texel.wgsl`.
pub(crate) const TEXELS_IN_ROW: u32 = 4096;

/// What a texel holds.
pub(crate) trait Texel: Pod {
    const FORMAT: wgpu::TextureFormat;
}

impl Texel for u32 {
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
}

impl Texel for [u32; 2] {
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
}

impl Texel for [u32; 4] {
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
}

/// A texture of words, one row after the other; a single row is no longer than it must be.
pub(crate) struct WordTexture<T> {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    texel: PhantomData<T>,
}

/// Rows for so many texels of so many bytes. Fails, with what it says of it, if there are more than `most`.
fn rows(texels: usize, texel_bytes: usize, most: u32) -> Result<u32, String> {
    let rows = texels.div_ceil(TEXELS_IN_ROW as usize).max(1);
    if rows <= most as usize {
        return Ok(rows as u32);
    }
    let mebibytes = |rows: usize| (rows * texel_bytes * TEXELS_IN_ROW as usize) >> 20;
    Err(format!("need {} MiB; a texture holds at most {} MiB", mebibytes(rows), mebibytes(most as usize)))
}

/// What single copies write of `count` texels from number `first` on: the first of each, and how many. Whole rows go together, what begins or
/// ends within a row alone.
fn runs(first: u32, count: u32) -> impl Iterator<Item = (u32, u32)> {
    let end = first + count;
    let after = move |at: u32| {
        let row_end = (at / TEXELS_IN_ROW + 1) * TEXELS_IN_ROW;
        let is_whole = at.is_multiple_of(TEXELS_IN_ROW) && row_end <= end;
        (at, if is_whole { end - end % TEXELS_IN_ROW - at } else { end.min(row_end) - at })
    };
    let next = move |(at, count): &(u32, u32)| Some(after(at + count));
    std::iter::successors(Some(after(first)), next).take_while(|(_, count)| *count > 0)
}

impl<T: Texel> WordTexture<T> {
    /// Uploads `texels`. Fails if there are more than the device's textures have rows for.
    pub fn new(gpu: &Gpu, label: &str, texels: &[T]) -> Result<Self, Error> {
        Self::with_usage(gpu, label, texels, wgpu::TextureUsages::empty())
    }

    /// The same for a texture that shaders write, too.
    pub fn writable(gpu: &Gpu, label: &str, texels: &[T]) -> Result<Self, Error> {
        Self::with_usage(gpu, label, texels, wgpu::TextureUsages::STORAGE_BINDING)
    }

    fn with_usage(gpu: &Gpu, label: &str, texels: &[T], usage: wgpu::TextureUsages) -> Result<Self, Error> {
        let height = rows(texels.len(), size_of::<T>(), gpu.limits.max_texture_dimension_2d)
            .map_err(|reason| gpu.error(format!("{label} {reason}")))?;
        let width = texels.len().clamp(1, TEXELS_IN_ROW as usize) as u32;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: T::FORMAT,
            usage: usage | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let made = Self { texture, view, texel: PhantomData };
        made.write(gpu, 0, texels);
        Ok(made)
    }

    /// Overwrites texels from number `first` on.
    pub fn write(&self, gpu: &Gpu, first: u32, texels: &[T]) {
        for (at, count) in runs(first, texels.len() as u32) {
            let from = (at - first) as usize;
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    origin: wgpu::Origin3d { x: at % TEXELS_IN_ROW, y: at / TEXELS_IN_ROW, z: 0 },
                    ..self.texture.as_image_copy()
                },
                bytemuck::cast_slice(&texels[from..from + count as usize]),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(size_of::<T>() as u32 * TEXELS_IN_ROW),
                    rows_per_image: None,
                },
                wgpu::Extent3d {
                    width: count.min(TEXELS_IN_ROW),
                    height: count.div_ceil(TEXELS_IN_ROW),
                    depth_or_array_layers: 1,
                },
            );
        }
    }

    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.view)
    }

    /// How many there is room for.
    pub fn texels(&self) -> u64 {
        u64::from(self.texture.width()) * u64::from(self.texture.height())
    }

    pub fn bytes(&self) -> u64 {
        size_of::<T>() as u64 * self.texels()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_parts_of_rows_and_whole_rows() {
        let of = |first, count| runs(first, count).collect::<Vec<_>>();
        assert_eq!(of(0, 0), []);
        assert_eq!(of(0, 5), [(0, 5)]);
        assert_eq!(of(0, 8192), [(0, 8192)]);
        assert_eq!(of(7, 20), [(7, 20)]);
        assert_eq!(of(4000, 96), [(4000, 96)]);
        assert_eq!(of(4000, 100), [(4000, 96), (4096, 4)]);
        assert_eq!(of(4000, 96 + 8192 + 3), [(4000, 96), (4096, 8192), (12288, 3)]);
        assert_eq!(of(4096, 4097), [(4096, 4096), (8192, 1)]);
    }

    #[test]
    fn more_texels_than_rows_hold_are_refused() {
        assert_eq!(rows(0, 16, 16384), Ok(1));
        assert_eq!(rows(4097, 16, 16384), Ok(2));
        assert_eq!(rows(16384 * 4096, 16, 16384), Ok(16384));
        let said = rows(16384 * 4096 + 1, 16, 8192).expect_err("too many");
        assert_eq!(said, "need 1024 MiB; a texture holds at most 512 MiB");
    }
}
