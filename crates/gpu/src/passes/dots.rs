//! Dots on lines: runs of consecutive dots on line segments, and the list of those that the CPU
//! finds visible where it chooses.

use std::sync::Arc;

use web_time::Instant;

use super::{
    dot_choice::DotBoxes,
    recording::{Device, Resources},
};
use crate::{
    accuracy::DotCulling,
    device::{Gpu, error::RenderError},
    effects::{
        Stack,
        dots::{Dots, LineSource, MAX_DOTS},
        hooks::tone::encoded,
    },
    frame::SnappedVertex,
    layout::{
        BufferId,
        dispatch::{DOT_GROUP, fold_groups},
        frame_layout::DotCounts,
        records::{DotFrame, DotRunRecord, VertexRecord},
    },
    math::rounded_columns,
    resources::buffers::{self, Buffers},
    scene::{
        Scene,
        draw::DrawError,
        lines::{Lines, Segment, SegmentEnds},
        view::View,
    },
    shader::{key::KernelKey, pass::Pass},
};

/// Most dots of a run: short runs are culled tightly and give every invocation about as much work.
const MAX_COUNT: u32 = 64;

/// Dots whose records are read back at a time: 16 bytes each stay far below any limit.
const PROBED: u32 = 1 << 20;

/// What lines are made from.
#[derive(Clone, Debug, PartialEq)]
struct Source {
    line_source: LineSource,
    /// Bits of the crease angle.
    crease: u32,
    polyline: Arc<[[f32; 3]]>,
}

/// The dots of a view.
pub struct DotStore {
    source: Source,
    lines: Lines,
    /// Bits of the spacing, and of the lengths of dashes and gaps.
    spacing: [u32; 3],
    dot_runs: Vec<DotRunRecord>,
    dots: u32,
    /// Segments and runs are not on the device yet.
    is_stale: bool,
    boxes: Option<DotBoxes>,
    /// Run and position of every dot that the CPU chose for the last picture, where it does.
    chosen: Option<Vec<[u32; 2]>>,
    frame: DotFrame,
    /// Milliseconds that the CPU took for choosing and uploading them.
    pub chosen_ms: Option<f64>,
}

impl DotStore {
    fn new(scene: &Scene, source: Source) -> Result<Self, DrawError> {
        let lines = match source.line_source {
            LineSource::Edges => Lines::edges(scene, None)?,
            LineSource::Creases => Lines::edges(scene, Some(f32::from_bits(source.crease).into()))?,
            LineSource::Polyline => Lines::polyline(&source.polyline),
        };
        let (spacing, dot_runs, dots, boxes, chosen, frame) =
            ([0; 3], Vec::new(), 0, None, None, DotFrame::default());
        Ok(Self {
            source,
            lines,
            spacing,
            dot_runs,
            dots,
            is_stale: true,
            boxes,
            chosen,
            frame,
            chosen_ms: None,
        })
    }

    /// The dots of a picture, from those of the one before where that had the same lines; none
    /// where no effect draws dots.
    pub fn update(
        previous: Option<Self>,
        scene: &Scene,
        view: &View,
        stack: &Stack,
        key: &KernelKey,
    ) -> Result<Option<Self>, RenderError> {
        let Some((dots, line_source)) = stack.dots().zip(key.effects.dots) else {
            return Ok(None);
        };
        let source = Source {
            line_source,
            crease: if line_source == LineSource::Creases {
                dots.crease_deg.to_bits()
            } else {
                0
            },
            polyline: if line_source == LineSource::Polyline {
                view.scene_state.polyline.clone()
            } else {
                Arc::default()
            },
        };
        let known = previous.filter(|store| store.source == source);
        let mut store = known.map_or_else(|| Self::new(scene, source), Ok)?;
        let spacing = [dots.spacing_m, dots.dash_m, dots.gap_m].map(f32::to_bits);
        if store.spacing != spacing {
            let count = counted(&store.lines, &dots)?;
            (store.dot_runs, store.dots, store.spacing) =
                (dot_runs(&store.lines, &dots), count as u32, spacing);
            (store.boxes, store.is_stale) = (None, true);
        }
        store.frame = DotFrame {
            clip_from_scene: rounded_columns(
                &(view.clip_from_world * view.scene_state.world_from_scene),
            ),
            ink: encoded(dots.color)
                .to_array()
                .map(|component| component as f32),
            center: [view.width, view.height].map(|pixels| (128 * pixels) as f32),
            dots: store.dots,
            dot_runs: store.dot_runs.len() as u32,
            segments: store.lines.segments.len() as u32,
            fade_from: dots.fade_from(view),
            fade_rate: dots.fade_rate(),
            levels: dots.levels,
            radius: dots.radius(),
            bias: dots.bias_steps(),
            hidden: dots.hidden_share(),
            model: dots.show_model,
            first_probed: 0,
            zero: 0,
        };
        (store.chosen, store.chosen_ms) = (None, None);
        if key.options.dot_culling == DotCulling::Cpu {
            let lines = &store.lines;
            let boxes = store
                .boxes
                .get_or_insert_with(|| DotBoxes::new(scene, lines, &store.dot_runs));
            let began = Instant::now();
            store.chosen = Some(boxes.choose(&store.dot_runs, &dots, view));
            store.chosen_ms = Some(began.elapsed().as_secs_f64() * 1e3);
        }
        Ok(Some(store))
    }

    /// How many dots there are, for the layout of the frame.
    pub fn counts(&self) -> DotCounts {
        DotCounts {
            dots: self.dots,
            runs: self.dot_runs.len() as u32,
            segments: self.lines.segments.len() as u32,
            segment_bytes: self
                .lines
                .segments
                .iter()
                .map(|segment| 4 * words(segment.ends).len() as u64)
                .sum(),
            chosen: self.chosen.as_ref().map_or(0, |chosen| chosen.len() as u32),
        }
    }

    /// Lines that carry dots.
    pub fn line_count(&self) -> usize {
        self.lines.first_segments.len()
    }

    /// Writes what the passes over dots read. `is_new` tells of buffers that were made for this
    /// picture.
    pub async fn write(
        &mut self,
        gpu: &Gpu,
        buffers: &Buffers,
        is_new: impl Fn(BufferId) -> bool,
    ) -> Result<(), RenderError> {
        if self.is_stale || is_new(BufferId::DotSegments) || is_new(BufferId::DotRuns) {
            let segments: Vec<u32> = self
                .lines
                .segments
                .iter()
                .flat_map(|segment| words(segment.ends))
                .collect();
            buffers
                .write_at(
                    gpu,
                    BufferId::DotSegments,
                    0,
                    bytemuck::cast_slice(&segments),
                )
                .await?;
            buffers
                .write_at(
                    gpu,
                    BufferId::DotRuns,
                    0,
                    bytemuck::cast_slice(&self.dot_runs),
                )
                .await?;
            self.is_stale = false;
        }
        buffers
            .write_at(gpu, BufferId::DotFrame, 0, bytemuck::bytes_of(&self.frame))
            .await?;
        if let Some(chosen) = &self.chosen {
            let began = Instant::now();
            buffers
                .write_at(gpu, BufferId::DotList, 0, bytemuck::cast_slice(chosen))
                .await?;
            buffers
                .write_at(
                    gpu,
                    BufferId::DotCount,
                    0,
                    bytemuck::bytes_of(&(chosen.len() as u32)),
                )
                .await?;
            self.chosen_ms = self
                .chosen_ms
                .map(|ms| ms + began.elapsed().as_secs_f64() * 1e3);
        }
        Ok(())
    }

    /// Records of all dots of the last picture, for a judge. `own` are the buffers of the view,
    /// `others` those that it shares.
    pub async fn read(
        &self,
        device: &mut Device,
        key: &KernelKey,
        own: &mut Buffers,
        others: &Resources<'_>,
    ) -> Result<Vec<SnappedVertex>, RenderError> {
        let mut records = Vec::with_capacity(self.dots as usize);
        let Device { gpu, pipelines, .. } = device;
        let pipeline = pipelines.get(gpu, key, Pass::DotsProbe).await?;
        for first in (0..self.dots).step_by(PROBED as usize) {
            let probed = PROBED.min(self.dots - first);
            let bytes = u64::from(probed) * size_of::<VertexRecord>() as u64;
            own.ensure(gpu, BufferId::DotRecords, bytes).await?;
            let frame = DotFrame {
                first_probed: first,
                ..self.frame
            };
            own.write_at(gpu, BufferId::DotFrame, 0, bytemuck::bytes_of(&frame))
                .await?;
            let group = others.with(own).bind_group(gpu, &pipeline)?;
            let mut encoder = gpu
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                    label: Some("probe dots"),
                });
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("dots_probe"),
                timestamp_writes: None,
            });
            pass.set_pipeline(&pipeline.pipeline);
            pass.set_bind_group(0, &group, &[]);
            let [x, y] = fold_groups(probed.div_ceil(DOT_GROUP));
            pass.dispatch_workgroups(x, y, 1);
            drop(pass);
            gpu.queue.submit([encoder.finish()]);
            let bytes = buffers::read(gpu, own.get(BufferId::DotRecords)?, bytes).await?;
            records.extend(
                bytemuck::pod_collect_to_vec::<u8, VertexRecord>(&bytes)
                    .into_iter()
                    .map(VertexRecord::snapped),
            );
        }
        own.keep(|id| id != BufferId::DotRecords);
        Ok(records)
    }
}

/// The ends of a segment as the kernels read them: draw, both vertices and triangle, or two
/// [`crate::layout::records::DotPoints`].
fn words(ends: SegmentEnds) -> Vec<u32> {
    match ends {
        SegmentEnds::Edge {
            draw,
            vertices: [a, b],
            triangle,
        } => vec![draw, a, b, triangle],
        SegmentEnds::Points(points) => points
            .iter()
            .flat_map(|p| {
                [
                    p[0].to_bits(),
                    p[1].to_bits(),
                    p[2].to_bits(),
                    1.0f32.to_bits(),
                ]
            })
            .collect(),
    }
}

/// How many dots there are on lines.
pub fn counted(lines: &Lines, dots: &Dots) -> Result<u64, DrawError> {
    let on_line = |line: &[Segment]| {
        line.last()
            .map_or(0, |last| dots.row(last.start_m + last.length_m).count())
    };
    let count = lines
        .each()
        .fold(0u64, |sum, (_, line)| sum.saturating_add(on_line(line)));
    if count > MAX_DOTS {
        Err(DrawError::TooMany {
            what: "dots",
            count,
            limit: MAX_DOTS,
        })
    } else {
        Ok(count)
    }
}

/// Cuts lines into runs of dots, none longer than a dash. As many steps as there are dots, so these are [`counted`] first.
pub fn dot_runs(lines: &Lines, dots: &Dots) -> Vec<DotRunRecord> {
    let (mut dot_runs, mut before) = (Vec::new(), 0);
    for (first_segment, line) in lines.each() {
        let Some(last) = line.last() else { continue };
        let row = dots.row(last.start_m + last.length_m);
        let (count, mut dot) = (row.count(), 0);
        for (i, segment) in line.iter().enumerate() {
            let next_m = line.get(i + 1).map_or(f64::INFINITY, |next| next.start_m);
            while dot < count && row.place_m(dot) < next_m {
                let first = dot;
                while dot < count
                    && row.place_m(dot) < next_m
                    && dot - first < MAX_COUNT.into()
                    && row.dash(dot) == row.dash(first)
                {
                    dot += 1;
                }
                let fraction = |dot: u64| {
                    (((row.place_m(dot) - segment.start_m) / segment.length_m) as f32)
                        .clamp(0.0, 1.0)
                };
                dot_runs.push(DotRunRecord {
                    segment: (first_segment + i) as u32,
                    first: (before + first) as u32,
                    count: (dot - first) as u32,
                    start: fraction(first),
                    step: (row.step_m / segment.length_m) as f32,
                });
            }
        }
        before += count;
    }
    dot_runs
}
