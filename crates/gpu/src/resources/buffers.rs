//! Buffers on the device by their `BufferId`: made when first needed, kept while they fit, listed
//! with their purpose.

use std::{
    collections::BTreeMap,
    sync::atomic::{AtomicU64, Ordering},
};

use crate::{
    device::{
        Gpu,
        completion::{Mapping, idle},
        error::RenderError,
        memory::Reserved,
        preparations::Preparation,
    },
    layout::{BufferId, frame_layout::color_stride},
};

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
    purpose: &'static str,
    /// Freed with the buffer.
    _memory: Reserved,
}

/// Buffers on the device by their `BufferId`: made when first needed, kept while they fit, listed
/// with their purpose.
#[derive(Default)]
pub struct Buffers {
    held: BTreeMap<BufferId, Held>,
    /// Changes whenever a buffer is made or dropped; no two lists of buffers ever have the same,
    /// but for 0, which is empty.
    revision: u64,
}

/// Most bytes that are written to a buffer at a time: a large scene must not lie in memory twice
/// while it is uploaded.
const UPLOAD: usize = 64 << 20;

/// A number that was never given before.
pub fn next_revision() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl Buffers {
    /// Makes a buffer at least `bytes` long (and at least 16); true if it was made anew and so
    /// holds zeros. A buffer more than four times too large is made smaller.
    pub async fn ensure(
        &mut self,
        gpu: &Gpu,
        id: BufferId,
        bytes: u64,
    ) -> Result<bool, RenderError> {
        self.ensure_for(gpu, id, bytes, id.purpose()).await
    }

    /// [`Self::ensure`] with another purpose than the usual one.
    pub async fn ensure_for(
        &mut self,
        gpu: &Gpu,
        id: BufferId,
        bytes: u64,
        purpose: &'static str,
    ) -> Result<bool, RenderError> {
        let bytes = bytes.max(16).next_multiple_of(16);
        if let Some(held) = self.held.get_mut(&id)
            && (bytes..=bytes.saturating_mul(4)).contains(&held.bytes)
        {
            held.purpose = purpose;
            return Ok(false);
        }
        let limit = gpu
            .caps
            .max_storage_binding_bytes
            .min(gpu.caps.max_buffer_bytes);
        if bytes > limit {
            return Err(RenderError::TooLarge {
                buffer: id.name(),
                bytes,
                limit,
            });
        }
        self.held.remove(&id);
        self.revision = next_revision();
        let no_memory = RenderError::OutOfMemory {
            buffer: id.name(),
            bytes,
        };
        let Some(memory) = gpu.memory.reserve(bytes) else {
            return Err(no_memory);
        };
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let usage = id.usage() | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor {
            label: Some(id.name()),
            size: bytes,
            usage,
            mapped_at_creation: false,
        };
        let buffer = gpu.device.create_buffer(&descriptor);
        gpu.prepared.count(Preparation::Buffer);
        if scope.pop().await.is_some() {
            return Err(no_memory);
        }
        self.held.insert(
            id,
            Held {
                buffer,
                bytes,
                purpose,
                _memory: memory,
            },
        );
        Ok(true)
    }

    /// Makes a buffer that holds `data` and writes it.
    pub async fn fill(&mut self, gpu: &Gpu, id: BufferId, data: &[u8]) -> Result<(), RenderError> {
        self.ensure(gpu, id, data.len() as u64).await?;
        self.write_at(gpu, id, 0, data).await
    }

    /// Writes `data` from a byte on.
    pub async fn write_at(
        &self,
        gpu: &Gpu,
        id: BufferId,
        offset: u64,
        data: &[u8],
    ) -> Result<(), RenderError> {
        let buffer = self.get(id)?;
        for (at, part) in (offset..).step_by(UPLOAD).zip(data.chunks(UPLOAD)) {
            gpu.queue.write_buffer(buffer, at, part);
            if part.len() == UPLOAD {
                // What is written waits in memory of its own until it is submitted and done.
                gpu.queue.submit([]);
                idle(gpu).await?;
            }
        }
        Ok(())
    }

    /// Drops every buffer that is not needed.
    pub fn keep(&mut self, is_needed: impl Fn(BufferId) -> bool) {
        let before = self.held.len();
        self.held.retain(|id, _| is_needed(*id));
        if self.held.len() != before {
            self.revision = next_revision();
        }
    }

    pub fn has(&self, id: BufferId) -> bool {
        self.held.contains_key(&id)
    }

    /// Equal numbers, equal buffers.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// A buffer of this frame.
    pub fn get(&self, id: BufferId) -> Result<&wgpu::Buffer, RenderError> {
        self.held
            .get(&id)
            .map(|held| &held.buffer)
            .ok_or(RenderError::NoResource { name: id.name() })
    }

    /// Every buffer, in the order of the table.
    pub fn notes(&self) -> Vec<BufferNote> {
        let note = |(id, held): (&BufferId, &Held)| BufferNote {
            name: id.name().into(),
            bytes: held.bytes,
            why: held.purpose.into(),
        };
        self.held.iter().map(note).collect()
    }
}

/// Copies a buffer back.
pub async fn read(gpu: &Gpu, buffer: &wgpu::Buffer, bytes: u64) -> Result<Vec<u8>, RenderError> {
    read_through(gpu, buffer, bytes, &mut None).await
}

/// A buffer that the program can map and read.
pub fn new_staging(gpu: &Gpu, label: &str, bytes: u64) -> wgpu::Buffer {
    gpu.prepared.count(Preparation::Buffer);
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// [`read`] through a buffer that the caller keeps for the next time.
async fn read_through(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    bytes: u64,
    kept: &mut Option<wgpu::Buffer>,
) -> Result<Vec<u8>, RenderError> {
    if bytes == 0 {
        return Ok(Vec::new());
    }
    let staging = kept
        .take()
        .filter(|staging| staging.size() == bytes)
        .unwrap_or_else(|| new_staging(gpu, "readback", bytes));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    let read = read_staging(gpu, &staging).await?;
    *kept = Some(staging);
    Ok(read)
}

/// Copies back a picture whose rows stand `color_stride` apart, row-major.
pub async fn read_picture(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    size: [u32; 2],
) -> Result<Vec<[u8; 4]>, RenderError> {
    read_picture_through(gpu, buffer, size, &mut None).await
}

/// [`read_picture`] through a buffer that the caller keeps for the next picture.
pub async fn read_picture_through(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    [width, height]: [u32; 2],
    kept: &mut Option<wgpu::Buffer>,
) -> Result<Vec<[u8; 4]>, RenderError> {
    let row = 4 * color_stride(width) as usize;
    let bytes = read_through(gpu, buffer, row as u64 * u64::from(height), kept).await?;
    let pixels =
        |row: &[u8]| bytemuck::pod_collect_to_vec::<u8, [u8; 4]>(&row[..4 * width as usize]);
    Ok(bytes.chunks_exact(row.max(1)).flat_map(pixels).collect())
}

/// All of a mappable buffer, once what was submitted has written it.
async fn read_staging(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<Vec<u8>, RenderError> {
    Mapping::begin(staging).ready(gpu).await?;
    let bytes = staging
        .get_mapped_range(..)
        .map_err(|_| RenderError::Lost)?
        .to_vec();
    staging.unmap();
    Ok(bytes)
}
