//! Buffers by the name that the shaders give them: made at need, kept while they fit, listed with their reason.

use std::collections::BTreeMap;

use super::{Gpu, RenderError, uniforms::color_stride};

/// One buffer of the picture, for `explain`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct BufferNote {
    pub name: String,
    pub bytes: u64,
    pub why: String,
}

struct Held {
    buffer: wgpu::Buffer,
    bytes: u64,
    why: &'static str,
}

/// A picture of 32-bit words.
struct Texels {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    side: u32,
    why: &'static str,
}

/// See the module's first line.
#[derive(Default)]
pub struct Buffers {
    held: BTreeMap<&'static str, Held>,
    texels: BTreeMap<&'static str, Texels>,
}

impl Buffers {
    /// Makes `name` at least `bytes` long (and at least 16); true if it was made anew and so holds zeros.
    /// A buffer four times too large is made smaller.
    pub fn ensure(
        &mut self,
        gpu: &Gpu,
        name: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
        why: &'static str,
    ) -> Result<bool, RenderError> {
        let bytes = bytes.max(16).next_multiple_of(16);
        if let Some(held) = self.held.get_mut(name)
            && (bytes..=bytes.saturating_mul(4)).contains(&held.bytes)
        {
            held.why = why;
            return Ok(false);
        }
        let limit = gpu.caps.max_storage_binding_bytes.min(gpu.caps.max_buffer_bytes);
        if bytes > limit {
            return Err(RenderError::TooLarge { buffer: name, bytes, limit });
        }
        self.held.remove(name);
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let usage = usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(name), size: bytes, usage, mapped_at_creation: false });
        if pollster::block_on(scope.pop()).is_some() {
            return Err(RenderError::OutOfMemory { buffer: name, bytes });
        }
        self.held.insert(name, Held { buffer, bytes, why });
        Ok(true)
    }

    /// Makes `name` and fills its beginning.
    pub fn fill(
        &mut self,
        gpu: &Gpu,
        name: &'static str,
        data: &[u8],
        usage: wgpu::BufferUsages,
        why: &'static str,
    ) -> Result<(), RenderError> {
        self.fill_room(gpu, name, data, data.len() as u64, usage, why)
    }

    /// The same with room for so many bytes in all.
    pub fn fill_room(
        &mut self,
        gpu: &Gpu,
        name: &'static str,
        data: &[u8],
        room: u64,
        usage: wgpu::BufferUsages,
        why: &'static str,
    ) -> Result<(), RenderError> {
        self.ensure(gpu, name, room, usage, why)?;
        gpu.queue.write_buffer(self.get(name), 0, data);
        Ok(())
    }

    /// Makes a square texture of 32-bit words.
    pub fn ensure_texels(&mut self, gpu: &Gpu, name: &'static str, side: u32, why: &'static str) -> Result<(), RenderError> {
        if self.texels.get(name).is_some_and(|held| held.side == side) {
            return Ok(());
        }
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(name),
            size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        if pollster::block_on(scope.pop()).is_some() {
            return Err(RenderError::OutOfMemory { buffer: name, bytes: 4 * u64::from(side) * u64::from(side) });
        }
        self.texels.insert(name, Texels { texture, view, side, why });
        Ok(())
    }

    /// Copies a buffer of as many words into the texture called `name`; rows are multiples of 256 bytes.
    pub fn fill_texels(&self, encoder: &mut wgpu::CommandEncoder, name: &str, from: &wgpu::Buffer) {
        let Texels { texture, side, .. } = &self.texels[name];
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * side), rows_per_image: None };
        let source = wgpu::TexelCopyBufferInfo { buffer: from, layout };
        encoder.copy_buffer_to_texture(source, texture.as_image_copy(), texture.size());
    }

    /// Takes over the buffer called `name` of another list, to be used by both.
    pub fn share(&mut self, name: &'static str, other: &Self) {
        if let Some(Held { buffer, bytes, why }) = other.held.get(name) {
            self.held.insert(name, Held { buffer: buffer.clone(), bytes: *bytes, why });
        }
    }

    /// Gives up every buffer and texture that `is_needed` does not name.
    pub fn keep(&mut self, is_needed: impl Fn(&str) -> bool) {
        self.held.retain(|name, _| is_needed(name));
        self.texels.retain(|name, _| is_needed(name));
    }

    pub fn has(&self, name: &str) -> bool {
        self.held.contains_key(name)
    }

    /// The buffer called `name`; asking for one that was not made means that we erred.
    pub fn get(&self, name: &str) -> &wgpu::Buffer {
        match self.held.get(name) {
            Some(held) => &held.buffer,
            None => panic!("a pass uses the buffer {name:?}, which this frame does not have"),
        }
    }

    /// The buffer or texture called `name`, to be bound.
    pub fn resource(&self, name: &str) -> wgpu::BindingResource<'_> {
        match self.texels.get(name) {
            Some(held) => wgpu::BindingResource::TextureView(&held.view),
            None => self.get(name).as_entire_binding(),
        }
    }

    /// Every buffer by name, then every texture.
    pub fn notes(&self) -> Vec<BufferNote> {
        let note = |name: &str, bytes: u64, why: &str| BufferNote { name: name.into(), bytes, why: why.into() };
        let buffers = self.held.iter().map(|(name, held)| note(name, held.bytes, held.why));
        let texels = self.texels.iter().map(|(name, held)| note(name, 4 * u64::from(held.side) * u64::from(held.side), held.why));
        buffers.chain(texels).collect()
    }
}

/// Copies a buffer back and waits for it.
pub fn read(gpu: &Gpu, buffer: &wgpu::Buffer, bytes: u64) -> Result<Vec<u8>, RenderError> {
    if bytes == 0 {
        return Ok(Vec::new());
    }
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    read_staging(gpu, &staging)
}

/// Copies back a picture whose rows stand `color_stride` apart, row-major.
pub fn read_picture(gpu: &Gpu, buffer: &wgpu::Buffer, [width, height]: [u32; 2]) -> Result<Vec<[u8; 4]>, RenderError> {
    let row = 4 * color_stride(width) as usize;
    let bytes = read(gpu, buffer, row as u64 * u64::from(height))?;
    let pixels = |row: &[u8]| bytemuck::pod_collect_to_vec::<u8, [u8; 4]>(&row[..4 * width as usize]);
    Ok(bytes.chunks_exact(row.max(1)).flat_map(pixels).collect())
}

/// Waits for a mappable buffer and reads all of it.
pub fn read_staging(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<Vec<u8>, RenderError> {
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    wait(gpu)?;
    let view = staging.get_mapped_range(..).map_err(|_| RenderError::Lost)?;
    Ok(view.to_vec())
}

/// Waits until the queue is idle. A minute without an answer counts as a lost device: software adapters have no watchdog.
pub fn wait(gpu: &Gpu) -> Result<(), RenderError> {
    let patience = Some(std::time::Duration::from_secs(60));
    match gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: patience }) {
        Ok(_) if !gpu.is_lost() => Ok(()),
        _ => Err(RenderError::Lost),
    }
}
