//! Textures of 32-bit words, which kernels read texel by texel: they take none of the few storage
//! buffers that a pass may bind.

use super::buffers::next_revision;
use crate::{
    device::{Gpu, error::RenderError, memory::Reserved, preparations::Preparation},
    layout::TextureId,
};

/// Words in a line, and lines in a layer, of a row of words.
const WIDTH: u32 = 4096;

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

    /// A texture of a row of words, folded to `WIDTH` words a line and as many lines a layer.
    pub async fn of_words(
        gpu: &Gpu,
        id: TextureId,
        mut words: Vec<u32>,
    ) -> Result<Self, RenderError> {
        let line = WIDTH as usize;
        words.resize(words.len().next_multiple_of(line), 0);
        let lines = (words.len() / line) as u32;
        let size = wgpu::Extent3d {
            width: WIDTH,
            height: lines.min(WIDTH),
            depth_or_array_layers: lines.div_ceil(WIDTH),
        };
        let most = gpu.device.limits().max_texture_array_layers;
        if size.depth_or_array_layers > most {
            let limit = bytes_of(wgpu::Extent3d {
                width: WIDTH,
                height: WIDTH,
                depth_or_array_layers: most,
            });
            return Err(RenderError::TooLarge {
                buffer: id.name(),
                bytes: bytes_of(size),
                limit,
            });
        }
        let texture = Self::new(gpu, id, size, wgpu::TextureViewDimension::D2Array).await?;
        for (layer, words) in words.chunks(line * WIDTH as usize).enumerate() {
            let rows = (words.len() / line) as u32;
            let origin = wgpu::Origin3d {
                x: 0,
                y: 0,
                z: layer as u32,
            };
            let target = wgpu::TexelCopyTextureInfo {
                origin,
                ..texture.texture.as_image_copy()
            };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * WIDTH),
                rows_per_image: None,
            };
            let size = wgpu::Extent3d {
                width: WIDTH,
                height: rows,
                depth_or_array_layers: 1,
            };
            gpu.queue
                .write_texture(target, bytemuck::cast_slice(words), layout, size);
        }
        Ok(texture)
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
