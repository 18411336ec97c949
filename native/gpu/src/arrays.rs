//! What a scene has few of: draws, kinds of yarn, materials, lights and shadow views.
//!
//! As uniforms, they are read faster: on Mesa's software driver by all threads that run abreast at once, where words of a storage buffer take five
//! to ten times as long. A uniform holds 64 KiB: scenes with more have shaders that find them in storage buffers.

use bytemuck::Pod;

use crate::Error;
use crate::device::Gpu;
use crate::upload::check_storage;

/// Bytes of an array that is a uniform.
pub(crate) const UNIFORM_BYTES: u64 = 1 << 16;

/// Where shaders find those arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrays {
    Uniform,
    Storage,
}

impl Arrays {
    #[cfg(test)]
    pub const ALL: [Self; 2] = [Self::Uniform, Self::Storage];

    /// Of these buffers, made by [`empty_array`].
    pub fn of(gpu: &Gpu, buffers: &[&wgpu::Buffer]) -> Self {
        let fits = |buffer: &&wgpu::Buffer| buffer.size() == UNIFORM_BYTES;
        let has_room = gpu.limits.max_uniform_buffer_binding_size >= UNIFORM_BYTES;
        if has_room && buffers.iter().all(fits) { Self::Uniform } else { Self::Storage }
    }
}

/// A buffer of such an array.
pub(crate) fn array<T: Pod>(gpu: &Gpu, label: &str, data: &[T]) -> Result<wgpu::Buffer, Error> {
    let buffer = empty_array(gpu, label, size_of_val(data) as u64)?;
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(data));
    Ok(buffer)
}

/// A buffer for such an array.
pub(crate) fn empty_array(gpu: &Gpu, label: &str, bytes: u64) -> Result<wgpu::Buffer, Error> {
    check_storage(gpu, label, bytes)?;
    Ok(gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.max(UNIFORM_BYTES).next_multiple_of(16),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}
