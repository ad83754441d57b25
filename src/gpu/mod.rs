//! The kernels on a device: [`Renderer`] records a frame as a straight list of passes and reads it back.

pub mod bench;
pub mod buffers;
pub mod device;
mod dispatch;
mod explain;
pub mod hardware;
pub mod naive;
pub mod pipelines;
pub mod readback;
pub mod timer;
pub mod uniforms;

use std::{collections::VecDeque, sync::Arc};

pub use buffers::BufferNote;
pub use device::Gpu;
pub use explain::Explanation;
pub use readback::Capture;

use self::{
    buffers::Buffers,
    dispatch::{Dispatch, dispatch},
    pipelines::Pipelines,
    readback::Pending,
    timer::{Detail, Timer},
    uniforms::{Capacities, CounterRecord, DrawRecord, FrameUniform, color_stride},
};
pub use crate::plan::Note;
use crate::{
    effects::Stack,
    frame::Counters,
    math::srgb_byte,
    plan::{Accuracy, Lacking, Plan, Tuning, plan},
    scene::{
        Scene,
        camera::View,
        draw::{DrawError, draws},
        needs::Needs,
    },
    shader::{
        glue::uniform_bytes,
        key::{KernelKey, Pass, Visibility},
        library::Library,
        link::LinkError,
        reflect::ShaderError,
    },
};

/// Why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    Draw(#[from] DrawError),
    #[error(transparent)]
    Lacking(#[from] Lacking),
    #[error("the buffer {buffer} would take {bytes} bytes; this adapter binds at most {limit}")]
    TooLarge { buffer: &'static str, bytes: u64, limit: u64 },
    #[error("the picture is {width} x {height}; this adapter's textures end at {limit} pixels a side")]
    TooWide { width: u32, height: u32, limit: u32 },
    #[error("no memory for the buffer {buffer} of {bytes} bytes")]
    OutOfMemory { buffer: &'static str, bytes: u64 },
    #[error("the device was lost")]
    Lost,
    #[error("no scene has been set")]
    NoScene,
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    Shader(#[from] ShaderError),
    #[error("the pipeline {label} was refused: {reason}")]
    Pipeline { label: String, reason: String },
    #[error("the queues still overflow after growing eight times; {0} entries were lost")]
    Overflow(u32),
}

impl RenderError {
    /// A pinned rung or a size that this adapter lacks.
    pub fn is_unsupported(&self) -> bool {
        matches!(self, Self::Lacking(_) | Self::TooLarge { .. } | Self::TooWide { .. } | Self::OutOfMemory { .. })
    }

    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Lost)
    }
}

/// Figures of a finished frame.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Whole frame, clears included; none where the adapter has no timestamps.
    pub gpu_ms: Option<f64>,
    pub passes: Vec<(String, f64)>,
    pub counters: Counters,
    /// A queue overflowed and has grown: the picture is incomplete, draw it again.
    pub redraw: bool,
}

/// Draws scenes on one device.
pub struct Renderer {
    gpu: Arc<Gpu>,
    pipelines: Pipelines,
    buffers: Buffers,
    timer: Option<Timer>,
    scene: Option<Arc<Scene>>,
    tuning: Tuning,
    capacities: Capacities,
    /// A proof from bounds failed: queues and clipping are kept from now on.
    distrust: bool,
    target: Option<(wgpu::Texture, wgpu::TextureView)>,
    last: Option<Plan>,
    pending: VecDeque<Pending>,
}

const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE;

impl Renderer {
    pub fn new(gpu: Arc<Gpu>) -> Self {
        Self::with_library(gpu, Library::from_env())
    }

    /// A renderer whose shaders come from `library`.
    pub fn with_library(gpu: Arc<Gpu>, library: Library) -> Self {
        let timer = Timer::new(&gpu);
        Self {
            tuning: gpu.caps.tuning(),
            gpu,
            pipelines: Pipelines::new(library),
            buffers: Buffers::default(),
            timer,
            scene: None,
            capacities: Capacities::default(),
            distrust: false,
            target: None,
            last: None,
            pending: VecDeque::new(),
        }
    }

    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Shares out work in another way than suits the adapter, from the next picture on.
    pub fn set_tuning(&mut self, tuning: Tuning) {
        self.tuning = tuning;
    }

    /// Room for so many queue entries in the next picture of the scene that is set; too few grow and are drawn again.
    pub fn set_capacities(&mut self, capacities: Capacities) {
        self.capacities = capacities;
    }

    /// Room in the queues by now.
    pub fn capacities(&self) -> Capacities {
        self.capacities
    }

    /// Key of the last picture's kernel.
    pub fn key(&self) -> Option<&KernelKey> {
        self.last.as_ref().map(|plan| &plan.key)
    }

    /// Pipelines compiled so far; a switch back to a known key adds none.
    pub fn compiled(&self) -> usize {
        self.pipelines.compiled()
    }

    /// Uploads a scene's bytes as they are. The one in place stays when the new one does not fit.
    pub fn set_scene(&mut self, scene: &Arc<Scene>) -> Result<(), RenderError> {
        if self.scene.as_ref().is_some_and(|current| Arc::ptr_eq(current, scene)) {
            return Ok(());
        }
        let limit = self.gpu.caps.max_storage_binding_bytes.min(self.gpu.caps.max_buffer_bytes);
        let vertices = 16 * scene.vertex_count();
        for (buffer, bytes) in
            [("vertex_bytes", scene.vertex_bytes.len() as u64), ("index_bytes", scene.index_bytes.len() as u64), ("vertices", vertices)]
        {
            if bytes > limit {
                return Err(RenderError::TooLarge { buffer, bytes, limit });
            }
        }
        self.buffers.keep(|name| !matches!(name, "vertex_bytes" | "index_bytes" | "vertices"));
        self.buffers.fill(
            &self.gpu,
            "vertex_bytes",
            &scene.vertex_bytes,
            STORAGE | wgpu::BufferUsages::VERTEX,
            "attributes as the file has them",
        )?;
        if !scene.index_bytes.is_empty() {
            self.buffers.fill(
                &self.gpu,
                "index_bytes",
                &scene.index_bytes,
                STORAGE | wgpu::BufferUsages::INDEX,
                "index lists as the file has them",
            )?;
        }
        self.capacities = first_capacities(scene);
        self.distrust = false;
        self.scene = Some(scene.clone());
        Ok(())
    }

    /// Records and submits one frame; never waits. A picture of 0 pixels dispatches nothing.
    pub fn draw(&mut self, view: &View, stack: &Stack, accuracy: &Accuracy) -> Result<(), RenderError> {
        self.draw_timed(view, stack, accuracy, Detail::Passes)
    }

    pub(crate) fn draw_timed(&mut self, view: &View, stack: &Stack, accuracy: &Accuracy, detail: Detail) -> Result<(), RenderError> {
        if self.gpu.is_lost() {
            return Err(RenderError::Lost);
        }
        let plan = self.prepare(view, stack, accuracy)?;
        if view.pixels() == 0 {
            self.target = None;
            return Ok(());
        }
        let passes = plan.key.frame();
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        if let Some(timer) = &mut self.timer {
            timer.begin(&mut encoder, detail);
        }
        self.clear(&mut encoder, &["counters", "depth_keys", "owners", "depth_owner", "marks"]);
        if plan.key.listed_tiles {
            self.fill_background(&mut encoder, view);
        }
        self.record(&mut encoder, &plan.key, &passes, view)?;
        self.present(&mut encoder, view);
        let pending = Pending::stage(&self.gpu, &mut encoder, Some(self.buffers.get("counters")), self.timer.as_ref());
        self.gpu.queue.submit([encoder.finish()]);
        self.pending.push_back(pending.begin());
        self.last = Some(plan);
        Ok(())
    }

    /// The finished picture: Rgba8Unorm with gamma-encoded bytes; none before the first draw and for 0 pixels.
    pub fn texture_view(&self) -> Option<&wgpu::TextureView> {
        self.target.as_ref().map(|(_, view)| view)
    }

    /// Figures of the newest finished frame, or none yet; does not wait.
    pub fn report(&mut self) -> Option<Report> {
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        let mut newest = None;
        while self.pending.front().is_some_and(Pending::is_ready) {
            let finished = self.pending.pop_front().expect("a front was just seen");
            newest = Some(finished);
        }
        newest.and_then(|finished| self.digest(finished))
    }

    /// Are figures of a submitted frame still to come?
    pub fn is_pending(&self) -> bool {
        !self.pending.is_empty()
    }

    /// Waits for every frame in flight and returns the newest one's figures.
    pub fn finish(&mut self) -> Result<Report, RenderError> {
        buffers::wait(&self.gpu)?;
        let finished = self.pending.drain(..).next_back().ok_or(RenderError::NoScene)?;
        self.digest(finished).ok_or(RenderError::Lost)
    }

    fn digest(&mut self, finished: Pending) -> Option<Report> {
        let (record, times) = finished.read(self.timer.as_ref())?;
        let key = &self.last.as_ref()?.key;
        let recorded = recorded_capacities(key, &self.capacities);
        let counters = record.counters(&recorded);
        let mut redraw = false;
        if counters.overflow > 0 {
            let is_proof_wrong =
                record.clip > 0 && !key.has_clipping || record.medium > 0 && !key.has_medium || record.large > 0 && !key.has_large;
            self.distrust |= is_proof_wrong;
            redraw = self.capacities.grow(&record) || is_proof_wrong;
        }
        Some(Report { gpu_ms: times.total_ms, passes: times.passes, counters, redraw })
    }

    /// Plans the picture and makes its buffers hold what the passes will read.
    fn prepare(&mut self, view: &View, stack: &Stack, accuracy: &Accuracy) -> Result<Plan, RenderError> {
        let scene = self.scene.clone().ok_or(RenderError::NoScene)?;
        let (gpu, buffers) = (&self.gpu, &mut self.buffers);
        let limit = gpu.caps.max_texture_side;
        if view.width.max(view.height) > limit {
            return Err(RenderError::TooWide { width: view.width, height: view.height, limit });
        }
        let draws = draws(&scene, view)?;
        let mut needs = Needs::of(&scene, &draws, view);
        if self.distrust {
            (needs.clipping, needs.largest_px) = (true, f64::INFINITY);
        }
        let plan = plan(&needs, stack, &gpu.caps, &self.tuning, accuracy)?;
        let key = &plan.key;
        let recorded = recorded_capacities(key, &self.capacities);

        let records: Vec<DrawRecord> = draws.iter().map(|draw| DrawRecord::new(draw, &scene)).collect();
        let uniform = FrameUniform::new(view, &scene, draws.len(), &recorded);
        let parameters = uniform_bytes(&stack.0);
        buffers.keep(|name| match name {
            "queues" => key.has_queues(),
            "args" => key.has_queues() || key.listed_tiles,
            "marks" | "background" => key.listed_tiles,
            "pieces" => key.has_clipping,
            "effects" => !parameters.is_empty(),
            "depth_keys" | "owners" => key.visibility == Visibility::Split32,
            "depth_owner" => key.visibility == Visibility::Packed64,
            "layers" => false,
            _ => true,
        });
        buffers.fill(gpu, "frame", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM, "size, viewpoint, capacities")?;
        buffers.fill(
            gpu,
            "draws",
            bytemuck::cast_slice(&records),
            STORAGE | wgpu::BufferUsages::UNIFORM,
            "matrices and attribute places, one record per instance",
        )?;
        if !parameters.is_empty() {
            buffers.fill(gpu, "effects", &parameters, wgpu::BufferUsages::UNIFORM, "parameters of the stack")?;
        }
        buffers.ensure(gpu, "vertices", 16 * scene.vertex_count(), STORAGE, "projected vertices, 16 bytes each")?;
        buffers.ensure(gpu, "counters", 64, STORAGE, "queue demand and what was not drawn")?;
        if key.has_queues() {
            buffers.ensure(
                gpu,
                "queues",
                4 * recorded.queue_words(),
                STORAGE,
                "triangles waiting for clip, medium, large and tile kernels",
            )?;
        }
        if key.has_queues() || key.listed_tiles {
            buffers.ensure(gpu, "args", 60, STORAGE | wgpu::BufferUsages::INDIRECT, "dispatch sizes written on the GPU")?;
        }
        if key.has_clipping {
            buffers.ensure(gpu, "pieces", 64 * u64::from(recorded.pieces), STORAGE, "what clipping leaves of a triangle")?;
        }
        let pixels = view.pixels() as u64;
        match key.visibility {
            Visibility::Split32 => {
                buffers.ensure(gpu, "depth_keys", 4 * pixels, STORAGE, "nearest depth key per pixel, 4 bytes")?;
                buffers.ensure(gpu, "owners", 4 * pixels, STORAGE, "owner per pixel, 4 bytes")?;
            }
            Visibility::Packed64 => {
                buffers.ensure(gpu, "depth_owner", 8 * pixels, STORAGE, "depth key and owner per pixel, 8 bytes")?;
            }
        }
        let tiles = if key.listed_tiles { u64::from(view.width.div_ceil(8)) * u64::from(view.height.div_ceil(8)) } else { 0 };
        let picture = 4 * u64::from(color_stride(view.width)) * u64::from(view.height);
        buffers.ensure(gpu, "color", picture + 4 * tiles, STORAGE, "the picture, 4 bytes per pixel, and the list of tiles to resolve")?;
        if key.listed_tiles {
            buffers.ensure(gpu, "marks", 4 * tiles, STORAGE, "which 8 x 8 tiles the resolve must visit")?;
            let rows = background_word(view).repeat((color_stride(view.width) * BACKGROUND_ROWS) as usize);
            buffers.fill(gpu, "background", &rows, STORAGE, "a few rows of background, copied all over the picture first")?;
        }
        Ok(plan)
    }

    /// Copies rows of background over the picture, for resolves that leave empty tiles alone.
    fn fill_background(&self, encoder: &mut wgpu::CommandEncoder, view: &View) {
        let (from, to) = (self.buffers.get("background"), self.buffers.get("color"));
        let row = 4 * u64::from(color_stride(view.width));
        for first in (0..view.height).step_by(BACKGROUND_ROWS as usize) {
            let rows = BACKGROUND_ROWS.min(view.height - first);
            encoder.copy_buffer_to_buffer(from, 0, to, row * u64::from(first), row * u64::from(rows));
        }
    }

    fn clear(&self, encoder: &mut wgpu::CommandEncoder, names: &[&str]) {
        for name in names.iter().filter(|name| self.buffers.has(name)) {
            encoder.clear_buffer(self.buffers.get(name), 0, None);
        }
    }

    /// The straight list of passes.
    fn record(&mut self, encoder: &mut wgpu::CommandEncoder, key: &KernelKey, passes: &[Pass], view: &View) -> Result<(), RenderError> {
        let scene = self.scene.as_ref().ok_or(RenderError::NoScene)?;
        let (vertices, triangles) = (scene.vertex_count() as u32, scene.triangle_count() as u32);
        for (i, &pass) in passes.iter().enumerate() {
            let pipeline = self.pipelines.get(&self.gpu, key, pass)?;
            let is_last = i + 1 == passes.len();
            let timestamp_writes = self.timer.as_mut().and_then(|timer| timer.compute(&pipeline.label, is_last));
            let mut recorded = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(&pipeline.label), timestamp_writes });
            pipeline.bind(&self.gpu, &mut recorded, |name| self.buffers.get(name));
            match dispatch(pass, vertices, triangles, view, key) {
                Dispatch::Direct([x, y]) => recorded.dispatch_workgroups(x, y, 1),
                Dispatch::Indirect(offset) => recorded.dispatch_workgroups_indirect(self.buffers.get("args"), offset),
            }
        }
        Ok(())
    }

    /// Copies the colour buffer into the texture that a window shows.
    fn present(&mut self, encoder: &mut wgpu::CommandEncoder, view: &View) {
        let size = wgpu::Extent3d { width: view.width, height: view.height, depth_or_array_layers: 1 };
        if self.target.as_ref().is_none_or(|(texture, _)| texture.size() != size) {
            let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            let texture_view = texture.create_view(&Default::default());
            self.target = Some((texture, texture_view));
        }
        let Some((texture, _)) = &self.target else { return };
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * color_stride(view.width)), rows_per_image: None };
        let source = wgpu::TexelCopyBufferInfo { buffer: self.buffers.get("color"), layout };
        encoder.copy_buffer_to_texture(source, texture.as_image_copy(), size);
    }
}

/// Rows that the background buffer holds.
const BACKGROUND_ROWS: u32 = 32;

/// The background as the resolve would pack it.
fn background_word(view: &View) -> [u8; 4] {
    let [r, g, b, alpha] = view.background.map(f64::from);
    [srgb_byte(r), srgb_byte(g), srgb_byte(b), (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8]
}

/// Capacities of the queues that this key's passes have; 0 where a pass is left out.
fn recorded_capacities(key: &KernelKey, all: &Capacities) -> Capacities {
    let kept = |is_there: bool, capacity: u32| if is_there { capacity } else { 0 };
    Capacities {
        clip: kept(key.has_clipping, all.clip),
        pieces: kept(key.has_clipping, all.pieces),
        medium: kept(key.has_medium, all.medium),
        large: kept(key.has_large, all.large),
        tiles: kept(key.has_large, all.tiles),
    }
}

/// Room for an ordinary picture of the scene; demand beyond it grows the queues and draws again.
fn first_capacities(scene: &Scene) -> Capacities {
    let triangles = scene.triangle_count().min(u64::from(u32::MAX)) as u32;
    let room = |most: u32| triangles.clamp(16, most).next_power_of_two();
    Capacities { clip: room(4096), pieces: 2 * room(4096), medium: room(65_536), large: room(16_384), tiles: 16 * room(4096) }
}

/// What a frame counted, before it is read as [`Counters`].
pub(crate) type Demand = CounterRecord;
