//! Statistics of a frame: its counters and timestamps, read back when the device has finished it.

use std::mem::offset_of;

use crate::{
    device::{
        Gpu,
        completion::Mapping,
        error::RenderError,
        timer::{Timer, Times},
    },
    frame::CullingStats,
    layout::{
        glass::GlassRecord,
        records::{CounterRecord, OrderRecord},
    },
    resources::buffers,
};

/// What a frame counted; zeros where it has no shadow map, no draw order or no
/// glass.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct FrameStats {
    pub picture: CounterRecord,
    pub shadow: CounterRecord,
    pub order: OrderRecord,
    pub glass: GlassRecord,
}

/// The buffers that hold what a frame counted.
#[derive(Clone, Copy, Default)]
pub struct StatSources<'a> {
    pub picture: Option<&'a wgpu::Buffer>,
    pub shadow: Option<&'a wgpu::Buffer>,
    pub order: Option<&'a wgpu::Buffer>,
    /// And the byte at which its counts begin.
    pub glass: Option<(&'a wgpu::Buffer, u64)>,
}

/// Statistics of a frame that is not submitted yet.
pub struct Staged {
    staging: wgpu::Buffer,
    labels: Vec<String>,
}

/// Statistics of a frame in flight.
pub struct Pending {
    staging: wgpu::Buffer,
    labels: Vec<String>,
    mapping: Mapping,
}

/// Timestamps lie behind the counters.
const FIRST_STAMP: u64 = size_of::<FrameStats>() as u64;

impl Staged {
    /// Records the copies that end a frame. `spare` is the buffer of an earlier frame, if there is
    /// one.
    pub fn stage(
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        sources: StatSources<'_>,
        timer: Option<&Timer>,
        spare: Option<wgpu::Buffer>,
    ) -> Self {
        let staging = spare.unwrap_or_else(|| {
            buffers::new_staging(gpu, "frame stats", FIRST_STAMP + Timer::BYTES)
        });
        let whole = |source: Option<&'_ wgpu::Buffer>| source.map(|source| (source.clone(), 0));
        let copies = [
            (
                whole(sources.picture),
                offset_of!(FrameStats, picture),
                size_of::<CounterRecord>(),
            ),
            (
                whole(sources.shadow),
                offset_of!(FrameStats, shadow),
                size_of::<CounterRecord>(),
            ),
            (
                whole(sources.order),
                offset_of!(FrameStats, order),
                size_of::<OrderRecord>(),
            ),
            (
                sources.glass.map(|(source, first)| (source.clone(), first)),
                offset_of!(FrameStats, glass),
                size_of::<GlassRecord>(),
            ),
        ];
        for (source, offset, bytes) in copies {
            if let Some((source, first)) = source {
                encoder.copy_buffer_to_buffer(
                    &source,
                    first,
                    &staging,
                    offset as u64,
                    bytes as u64,
                );
            }
        }
        if let Some(timer) = timer {
            timer.end(encoder, &staging, FIRST_STAMP);
        }
        Self {
            staging,
            labels: timer.map(Timer::labels).unwrap_or_default(),
        }
    }

    /// Asks for the bytes, after the frame was submitted.
    pub fn begin(self) -> Pending {
        let Self { staging, labels } = self;
        Pending {
            mapping: Mapping::begin(&staging),
            staging,
            labels,
        }
    }
}

impl Pending {
    pub fn is_ready(&self) -> bool {
        self.mapping.is_ready()
    }

    /// Returns when the frame is finished.
    pub async fn ready(&self, gpu: &Gpu) -> Result<(), RenderError> {
        self.mapping.ready(gpu).await
    }

    /// What the frame counted, and its times; none when the device was lost.
    pub fn read(&self, timer: Option<&Timer>) -> Option<(FrameStats, Times)> {
        let bytes = self.staging.get_mapped_range(..).ok()?;
        let (stats, stamps) = bytes.split_at(FIRST_STAMP as usize);
        let times = timer
            .map(|timer| timer.times(stamps, &self.labels))
            .unwrap_or_default();
        Some((bytemuck::pod_read_unaligned(stats), times))
    }

    /// The buffer of a frame that is ready, for another frame.
    pub fn into_spare(self) -> wgpu::Buffer {
        self.staging.unmap();
        self.staging
    }
}

impl CounterRecord {
    /// Meshlets that were drawn, and why the others were not.
    pub fn culled(&self) -> CullingStats {
        let Self {
            visible_meshlets: drawn,
            outside,
            backfacing,
            hidden,
            ..
        } = *self;
        CullingStats {
            drawn,
            outside,
            backfacing,
            hidden,
        }
    }
}
