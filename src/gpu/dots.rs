//! Dots: the lines they are strung on, cut into dot_runs of consecutive dots, and three ways of choosing which are drawn.

use std::{sync::Arc, time::Instant};

use super::{
    RenderError, Renderer, STORAGE, buffers,
    dispatch::{Dispatch, folded},
    dot_tree::DotTree,
    uniforms::{GpuRecord, color_stride, gpu_record},
};
use crate::{
    accuracy::DotCulling,
    effects::{
        Stack,
        dots::{Dots, LineSource, MAX_DOTS},
        hooks::tone::encoded,
    },
    frame::SnappedVertex,
    math::rounded_columns,
    scene::{
        Scene,
        draw::DrawError,
        lines::{Lines, Segment, SegmentEnds},
        view::View,
    },
    shader::{key::KernelKey, pass::Pass},
};

gpu_record! {
    /// What of a picture concerns its dots. Each member is explained in `shaders/common/dot_frame.wgsl`.
    pub struct DotFrame = "DotFrame" {
        pub clip_from_scene: [[f32; 4]; 4],
        pub ink: [f32; 4],
        pub center: [f32; 2],
        pub dots: u32,
        pub dot_runs: u32,
        pub segments: u32,
        pub fade_from: u32,
        pub fade_rate: u32,
        pub levels: u32,
        pub radius: u32,
        pub bias: u32,
        pub hidden: u32,
        pub model: u32,
        pub first_probed: u32,
        pub zero: u32,
    }
}

gpu_record! {
    /// Consecutive dots of one segment. Each member is explained in `shaders/common/dots.wgsl`.
    pub struct DotRunRecord = "DotRun" {
        pub segment: u32,
        pub first: u32,
        pub count: u32,
        pub start: f32,
        pub step: f32,
    }
}

/// Most dots of a stretch: short ones are culled sharply and share out evenly.
const MAX_COUNT: u32 = 64;

/// Dots whose records are read back at a time: 16 bytes each stay far below any limit.
const PROBED: u32 = 1 << 20;

/// Bytes of a list without entries: a binding holds one at least.
const ROOM: u64 = 32;

/// Buffers that only pictures with dots have.
const BUFFERS: [&str; 8] = ["dot_frame", "dot_segments", "dot_runs", "dot_ends", "dot_list", "dot_count", "dot_args", "dot_records"];

/// What lines are made from.
#[derive(Clone, Debug, PartialEq)]
struct Source {
    line_source: LineSource,
    crease: u32,
    polyline: Arc<[[f32; 3]]>,
}

/// The dots of a scene.
pub struct DotStore {
    source: Source,
    lines: Lines,
    spacing: u32,
    dot_runs: Vec<DotRunRecord>,
    dots: u32,
    tree: Option<DotTree>,
    /// Dots that the CPU chose for the last picture.
    chosen: u32,
    frame: DotFrame,
    /// How long that took, their upload included.
    pub(super) chosen_ms: Option<f64>,
}

impl DotStore {
    fn new(scene: &Scene, source: Source) -> Result<Self, DrawError> {
        let lines = match source.line_source {
            LineSource::Edges => Lines::edges(scene, None)?,
            LineSource::Creases => Lines::edges(scene, Some(f32::from_bits(source.crease).into()))?,
            LineSource::Polyline => Lines::polyline(&source.polyline),
        };
        let (spacing, dot_runs, dots, tree, chosen, frame) = (0, Vec::new(), 0, None, 0, DotFrame::default());
        Ok(Self { source, lines, spacing, dot_runs, dots, tree, chosen, frame, chosen_ms: None })
    }

    /// Workgroups of a pass over dots.
    pub fn dispatch(&self, pass: Pass, key: &KernelKey) -> Dispatch {
        let over = |count: u32| Dispatch::Direct(folded(count.div_ceil(64)));
        match (pass, key.options.dot_culling) {
            (Pass::DotsEnds, _) => over(self.lines.segments.len() as u32),
            (Pass::DotsCull, _) => over(self.dot_runs.len() as u32),
            (Pass::DotsArgs, _) => Dispatch::Direct([1, 1]),
            (_, DotCulling::Brute) => over(self.dots),
            (_, DotCulling::Cpu) => over(self.chosen),
            (_, DotCulling::Gpu) => Dispatch::Listed,
        }
    }

    /// How many dots there are, on how many lines.
    pub fn sample_counts(&self) -> [usize; 2] {
        [self.dots as usize, self.lines.first_segments.len()]
    }

    fn segment_bytes(&self) -> Vec<u8> {
        let of = |ends: SegmentEnds| match ends {
            SegmentEnds::Edge { draw, vertices: [a, b], triangle } => vec![draw, a, b, triangle],
            SegmentEnds::Points(points) => {
                points.iter().flat_map(|p| [p[0].to_bits(), p[1].to_bits(), p[2].to_bits(), 1.0f32.to_bits()]).collect()
            }
        };
        self.lines.segments.iter().flat_map(|segment| bytemuck::pod_collect_to_vec::<u32, u8>(&of(segment.ends))).collect()
    }
}

/// Where the strengths of dots begin in the colour buffer, in words.
pub fn first_dot_word(view: &View) -> u64 {
    u64::from(color_stride(view.width)) * u64::from(view.height)
}

/// How many dots there are on lines.
///
/// # Errors
/// When one picture does not take so many.
pub fn counted(lines: &Lines, dots: &Dots) -> Result<u64, DrawError> {
    let on_line = |line: &[Segment]| line.last().map_or(0, |last| dots.count(last.start_m + last.length_m));
    let count = lines.each().fold(0u64, |sum, (_, line)| sum.saturating_add(on_line(line)));
    if count > MAX_DOTS { Err(DrawError::TooMany { what: "dots", count, limit: MAX_DOTS }) } else { Ok(count) }
}

/// Cuts lines into dot_runs. As many steps as there are dots, so these are [`counted`] first.
pub fn dot_runs(lines: &Lines, dots: &Dots) -> Vec<DotRunRecord> {
    let spacing_m = f64::from(dots.spacing_m);
    let (mut dot_runs, mut before) = (Vec::new(), 0);
    for (first_segment, line) in lines.each() {
        let count = line.last().map_or(0, |last| dots.count(last.start_m + last.length_m));
        let mut dot = 0;
        for (i, segment) in line.iter().enumerate() {
            let next_m = line.get(i + 1).map_or(f64::INFINITY, |next| next.start_m);
            while dot < count && dot as f64 * spacing_m < next_m {
                let first = dot;
                while dot < count && dot as f64 * spacing_m < next_m && dot - first < MAX_COUNT.into() {
                    dot += 1;
                }
                let share = |dot: u64| (((dot as f64 * spacing_m - segment.start_m) / segment.length_m) as f32).clamp(0.0, 1.0);
                dot_runs.push(DotRunRecord {
                    segment: (first_segment + i) as u32,
                    first: (before + first) as u32,
                    count: (dot - first) as u32,
                    start: share(first),
                    step: (spacing_m / segment.length_m) as f32,
                });
            }
        }
        before += count;
    }
    dot_runs
}

impl Renderer {
    /// Makes the buffers hold what the passes over dots will read; chooses dots where that is the CPU's affair.
    pub(super) fn prepare_dots(&mut self, view: &View, stack: &Stack, key: &KernelKey) -> Result<(), RenderError> {
        let Some((dots, line_source)) = stack.dots().zip(key.effects.dots) else {
            self.dots = None;
            self.buffers.keep(|name| !BUFFERS.contains(&name));
            return Ok(());
        };
        let scene = self.scene.clone().ok_or(RenderError::NoScene)?;
        let (gpu, buffers) = (&self.gpu, &mut self.buffers);
        let source = Source {
            line_source,
            crease: if line_source == LineSource::Creases { dots.crease_deg.to_bits() } else { 0 },
            polyline: if line_source == LineSource::Polyline { view.scene_state.polyline.clone() } else { Arc::default() },
        };
        let known = self.dots.take().filter(|store| store.source == source);
        let mut store = known.map_or_else(|| DotStore::new(&scene, source), Ok)?;
        if store.spacing != dots.spacing_m.to_bits() {
            let count = counted(&store.lines, &dots)?;
            let dot_runs = dot_runs(&store.lines, &dots);
            (store.dot_runs, store.dots, store.tree, store.spacing) = (dot_runs, count as u32, None, dots.spacing_m.to_bits());
            let why = "both ends of every segment on which dots are strung";
            let (segments, records) = (store.segment_bytes(), bytemuck::cast_slice(&store.dot_runs));
            buffers.fill_room(gpu, "dot_segments", &segments, ROOM.max(segments.len() as u64), STORAGE, why)?;
            let why = "up to 64 dots of one segment each, 20 bytes";
            buffers.fill_room(gpu, "dot_runs", records, ROOM.max(records.len() as u64), STORAGE, why)?;
        }
        store.frame = DotFrame {
            clip_from_scene: rounded_columns(&(view.clip_from_world * view.scene_state.world_from_scene)),
            ink: encoded(dots.color).to_array().map(|lane| lane as f32),
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
        buffers.fill(gpu, "dot_frame", bytemuck::bytes_of(&store.frame), wgpu::BufferUsages::UNIFORM, "size, gap and colour of dots")?;
        buffers.ensure(gpu, "dot_ends", 32 * store.lines.segments.len() as u64, STORAGE, "ends of segments in clip space, 32 bytes")?;
        let way = key.options.dot_culling;
        buffers.keep(|name| match name {
            "dot_list" | "dot_count" => way != DotCulling::Brute,
            "dot_args" => way == DotCulling::Gpu,
            "dot_records" => false,
            _ => true,
        });
        if way != DotCulling::Brute {
            // Room for all of them: no list overflows, whatever shows.
            buffers.ensure(gpu, "dot_list", 8 * u64::from(store.dots), STORAGE, "dots that may show, room for all, 8 bytes each")?;
            buffers.ensure(gpu, "dot_count", 16, STORAGE, "how many dots may show")?;
        }
        if way == DotCulling::Gpu {
            buffers.ensure(gpu, "dot_args", 16, STORAGE | wgpu::BufferUsages::INDIRECT, "dispatch size of dots, written on the GPU")?;
        }
        store.chosen_ms = None;
        if way == DotCulling::Cpu {
            let lines = &store.lines;
            let tree = store.tree.get_or_insert_with(|| DotTree::new(&scene, lines, &store.dot_runs));
            let began = Instant::now();
            let chosen = tree.choose(&store.dot_runs, &dots, view);
            store.chosen = chosen.len() as u32;
            gpu.queue.write_buffer(buffers.get("dot_list"), 0, bytemuck::cast_slice(&chosen));
            gpu.queue.write_buffer(buffers.get("dot_count"), 0, bytemuck::bytes_of(&store.chosen));
            store.chosen_ms = Some(began.elapsed().as_secs_f64() * 1e3);
        }
        self.dots = Some(store);
        Ok(())
    }

    /// No dot on any pixel, and none on the list that the GPU makes.
    pub(super) fn clear_dots(&self, encoder: &mut wgpu::CommandEncoder, key: &KernelKey, view: &View) {
        encoder.clear_buffer(self.buffers.get("color"), 4 * first_dot_word(view), Some(4 * view.pixels() as u64));
        if key.options.dot_culling == DotCulling::Gpu {
            encoder.clear_buffer(self.buffers.get("dot_count"), 0, None);
        }
    }

    /// Records of all dots of the last picture, for a judge.
    pub(super) fn read_dots(&mut self, key: &KernelKey) -> Result<Vec<SnappedVertex>, RenderError> {
        let Some((count, frame)) = self.dots.as_ref().map(|store| (store.dots, store.frame)) else { return Ok(Vec::new()) };
        let mut records = Vec::with_capacity(count as usize);
        let pipeline = self.pipelines.get(&self.gpu, key, Pass::DotsProbe)?;
        for first in (0..count).step_by(PROBED as usize) {
            let probed = PROBED.min(count - first);
            self.buffers.ensure(&self.gpu, "dot_records", 16 * u64::from(probed), STORAGE, "where dots lie, only while verifying")?;
            let frame = DotFrame { first_probed: first, ..frame };
            self.gpu.queue.write_buffer(self.buffers.get("dot_frame"), 0, bytemuck::bytes_of(&frame));
            let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("probe dots") });
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("dots_probe"), timestamp_writes: None });
            pipeline.bind(&self.gpu, &mut pass, |name| self.buffers.resource(name));
            let [x, y] = folded(probed.div_ceil(64));
            pass.dispatch_workgroups(x, y, 1);
            drop(pass);
            self.gpu.queue.submit([encoder.finish()]);
            let bytes = buffers::read(&self.gpu, self.buffers.get("dot_records"), 16 * u64::from(probed))?;
            let words: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
            records.extend(words.iter().map(|words| super::readback::vertex(words)));
        }
        self.buffers.keep(|name| name != "dot_records");
        Ok(records)
    }
}
