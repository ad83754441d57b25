//! Textures of 32-bit words, which kernels read texel by texel: they take none of the few storage
//! buffers that a pass may bind.

use super::{
    buffers::next_revision, device::Gpu, device_memory::Reserved, error::RenderError,
    preparations::Preparation, resource_id::TextureId,
};

/// A texture on the device.
pub struct WordTexture {
    pub texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    /// Equal numbers, equal textures.
    pub revision: u64,
    /// Freed with the texture.
    _memory: Reserved,
}

impl WordTexture {
    /// Makes a texture of so many columns, rows and layers. Kernels see layers where `dimension`
    /// says so.
    ///
    /// # Errors
    /// When there is no memory for it.
    pub async fn new(
        gpu: &Gpu,
        id: TextureId,
        size: wgpu::Extent3d,
        dimension: wgpu::TextureViewDimension,
    ) -> Result<Self, RenderError> {
        let no_memory = RenderError::OutOfMemory {
            buffer: id.name(),
            bytes: bytes_of(size),
        };
        let Some(memory) = gpu.memory.reserve(bytes_of(size)) else {
            return Err(no_memory);
        };
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(id.name()),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        gpu.prepared.count(Preparation::Texture);
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            ..Default::default()
        });
        if scope.pop().await.is_some() {
            return Err(no_memory);
        }
        Ok(Self {
            texture,
            view,
            revision: next_revision(),
            _memory: memory,
        })
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        bytes_of(self.texture.size())
    }
}

/// Bytes of a texture of words of this size.
pub fn bytes_of(size: wgpu::Extent3d) -> u64 {
    [size.width, size.height, size.depth_or_array_layers]
        .into_iter()
        .fold(4, |bytes, side| bytes * u64::from(side))
}
