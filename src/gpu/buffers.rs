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

/// See the module's first line.
#[derive(Default)]
pub struct Buffers {
    held: BTreeMap<&'static str, Held>,
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

    /// Gives up every buffer that `is_needed` does not name.
    pub fn keep(&mut self, is_needed: impl Fn(&str) -> bool) {
        self.held.retain(|name, _| is_needed(name));
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

    /// Every buffer, by name.
    pub fn notes(&self) -> Vec<BufferNote> {
        self.held.iter().map(|(name, held)| BufferNote { name: (*name).into(), bytes: held.bytes, why: held.why.into() }).collect()
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
