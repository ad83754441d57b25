//! GPU timestamps: one span per pass, and the whole frame from before the clears to the end of the
//! last pass.

use super::adapter::Gpu;

/// Most spans in one frame.
const MAX_SPANS: u32 = 64;

/// Milliseconds of a finished frame; spans whose stamps were not written, or run backwards, are
/// left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Times {
    pub total_ms: Option<f64>,
    pub passes: Vec<(String, f64)>,
}

/// What is stamped: every stamp costs a little, so the whole frame is timed with two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    Whole,
    Passes,
}

/// Stamps of one frame at a time.
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    period_ns: f64,
    detail: Detail,
    labels: Vec<String>,
}

impl Timer {
    /// None where the adapter has no timestamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        gpu.caps.timestamps.then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MAX_SPANS,
            }),
            resolved: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: Self::BYTES,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            period_ns: f64::from(gpu.queue.get_timestamp_period()),
            detail: Detail::Passes,
            labels: Vec::new(),
        })
    }

    /// Size of the resolved stamps.
    pub const BYTES: u64 = 2 * MAX_SPANS as u64 * 8;

    /// Begins a frame: an empty pass carries the first stamp, ahead of the clears.
    pub fn begin(&mut self, encoder: &mut wgpu::CommandEncoder, detail: Detail) {
        self.labels.clear();
        self.labels.push("clear".into());
        self.detail = detail;
        let timestamp_writes = Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        });
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("begin"),
            timestamp_writes,
        });
    }

    /// Is only the whole frame timed?
    pub fn is_whole(&self) -> bool {
        self.detail == Detail::Whole
    }

    /// Indices of the stamps of the next span, labeled. A pass's two stamps must be neighbors: wgpu
    /// resets the whole range between them, and a stamp that was reset makes some drivers wait
    /// for ever.
    fn span(&mut self, label: &str, is_last: bool) -> Option<(Option<u32>, Option<u32>)> {
        let slot = self.labels.len() as u32;
        if self.detail == Detail::Whole {
            return is_last.then_some((None, Some(2)));
        }
        if slot >= MAX_SPANS {
            return None;
        }
        self.labels.push(label.to_owned());
        Some((Some(2 * slot), Some(2 * slot + 1)))
    }

    /// Stamps for a compute pass.
    pub fn compute(
        &mut self,
        label: &str,
        is_last: bool,
    ) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (begin, end) = self.span(label, is_last)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: begin,
            end_of_pass_write_index: end,
        })
    }

    /// Stamps for a render pass.
    pub fn render(
        &mut self,
        label: &str,
        is_last: bool,
    ) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (begin, end) = self.span(label, is_last)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: begin,
            end_of_pass_write_index: end,
        })
    }

    /// Ends the frame: the stamps go to `staging` at `offset`.
    pub fn end(&self, encoder: &mut wgpu::CommandEncoder, staging: &wgpu::Buffer, offset: u64) {
        // Only stamps that were written: some drivers wait for the others for ever.
        let written = if self.detail == Detail::Whole {
            3
        } else {
            2 * self.labels.len() as u32
        };
        encoder.resolve_query_set(&self.queries, 0..written, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, staging, offset, u64::from(written) * 8);
    }

    /// Labels of the spans recorded since [`Self::begin`], for [`Self::times`].
    pub fn labels(&self) -> Vec<String> {
        if self.detail == Detail::Whole {
            Vec::new()
        } else {
            self.labels.clone()
        }
    }

    /// Reads what [`Self::end`] stored.
    pub fn times(&self, bytes: &[u8], labels: &[String]) -> Times {
        let stamps: Vec<u64> = bytes
            .chunks_exact(8)
            .map(bytemuck::pod_read_unaligned)
            .collect();
        let span = |from: usize, to: usize| {
            let (begin, end) = (stamps[from], stamps[to]);
            (begin != 0 && end >= begin).then(|| (end - begin) as f64 * self.period_ns * 1e-6)
        };
        let passes = labels.iter().enumerate().filter_map(|(i, label)| {
            // The clears lie between the empty first pass and the first that works.
            let (from, to) = if i == 0 { (0, 2) } else { (2 * i, 2 * i + 1) };
            Some((label.clone(), span(from, to)?))
        });
        let end = if labels.is_empty() {
            2
        } else {
            2 * labels.len() - 1
        };
        Times {
            total_ms: span(0, end),
            passes: passes.collect(),
        }
    }
}
