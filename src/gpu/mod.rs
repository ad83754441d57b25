//! The kernels on a device: [`Renderer`] records a frame as a straight list of passes and reads it back.

pub mod bench;
pub mod buffers;
pub mod culling;
pub mod deforms;
pub mod device;
mod dispatch;
mod dot_tree;
pub mod dots;
pub mod error;
mod explain;
pub mod hardware;
mod hardware_ids;
mod history;
pub mod naive;
mod packing;
pub mod particle_readback;
pub mod pipelines;
mod prepare;
pub mod readback;
mod scenes;
mod shadow_pass;
pub mod sweep;
pub mod texels;
pub mod timer;
pub mod uniforms;

use std::{collections::VecDeque, sync::Arc};

pub use buffers::BufferNote;
pub use device::Gpu;
pub use error::RenderError;
pub use explain::{Explanation, SizesNote};
pub use readback::Capture;

use self::{
    buffers::Buffers,
    culling::MeshletBuffers,
    dispatch::{Dispatch, dispatch},
    dots::DotStore,
    packing::Packing,
    pipelines::Pipelines,
    prepare::{bin_heads, record_count, recorded_capacities},
    readback::Pending,
    shadow_pass::ShadowPass,
    texels::Texels,
    timer::{Detail, Timer},
    uniforms::{Capacities, CounterRecord, color_stride},
};
pub use crate::plan::Note;
use crate::{
    accuracy::RenderScale,
    effects::{Stack, draw_order, hooks::Layers, xray},
    frame::{Counters, CullingStats, OrderStats},
    plan::{AccuracyRequest, Plan, Tuning},
    scene::{Scene, needs::Needs, particle_discs::ParticleSettings, view::View},
    shader::{key::KernelKey, library::Library, pass::Pass},
};

/// Figures of a finished frame.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Whole frame, clears included; none where the adapter has no timestamps.
    pub gpu_ms: Option<f64>,
    /// What the CPU did for the newest frame while the GPU waited: choosing dots and handing them over.
    pub cpu_ms: Option<f64>,
    pub passes: Vec<(String, f64)>,
    pub counters: Counters,
    /// What a draw order let through, where one is kept.
    pub order: Option<OrderStats>,
    /// What culling left out, where there is some.
    pub culled: Option<CullingStats>,
    /// A queue overflowed and has grown: the picture is incomplete, draw it again.
    pub redraw: bool,
    /// Particles are on their way to the frame that was asked for: draw it again.
    pub simulation_pending: bool,
}

/// Draws scenes on one device.
pub struct Renderer {
    gpu: Arc<Gpu>,
    pipelines: Pipelines,
    buffers: Buffers,
    timer: Option<Timer>,
    base: Option<Arc<Scene>>,
    /// The base with the cloud that the stack puts beside it: what is on the device.
    scene: Option<Arc<Scene>>,
    /// Images and materials of the scene, where it has any that are more than a base colour.
    texels: Option<Texels>,
    particle_settings: Option<ParticleSettings>,
    tuning: Tuning,
    capacities: Capacities,
    /// A proof from bounds failed: queues and clipping are kept from now on.
    force_all_paths: bool,
    target: Option<(wgpu::Texture, wgpu::TextureView)>,
    last: Option<Plan>,
    /// What the colour buffer shows, where an effect will read it as the picture before; none: nothing of use.
    history: Option<(View, Stack)>,
    last_picture: Option<(View, Stack)>,
    /// The last picture whose sums of layers overflowed, and the bits per channel that it gets instead.
    full: Option<(View, Stack, u32)>,
    pending: VecDeque<Pending>,
    /// What the last pictures required, with their scenes and views.
    needs: Vec<(Arc<Scene>, View, Needs)>,
    /// Positions in fewer bits, which lie behind everything else in `vertex_bytes`: so many bits, and where.
    packed: Option<(u32, Packing)>,
    /// Medium and large triangles of the newest finished frame.
    demand: Option<[u32; 2]>,
    /// Size at which the picture is shown.
    shown: [u32; 2],
    /// Which vertices, of all that may bend, the last picture bent.
    deformed: Vec<std::ops::Range<u32>>,
    /// Meshlets of the scene, once a picture asks for them.
    meshlet_buffers: Option<MeshletBuffers>,
    /// Size and stack of the picture whose depths and meshlets the next one may start from; none: nothing of use.
    occluders: Option<([u32; 2], Stack)>,
    /// What culling left out of the last finished picture.
    culled: Option<CullingStats>,
    /// A picture is drawn once more for the judge, after which the next one goes on as if it had not been.
    is_judged: bool,
    /// Lines and their dots, while a stack has them.
    dots: Option<DotStore>,
    /// Vertices and triangles of the last picture's draws.
    totals: [u64; 2],
    /// What draws the shadow map, where an effect asks for one.
    shadow_pass: Option<Box<ShadowPass>>,
    /// This is such a one itself: it draws depths, no picture.
    is_shadow_pass: bool,
    /// The particles that the device keeps.
    kept: Option<particle_readback::Kept>,
    /// The last picture shows particles on their way to its own frame.
    simulation_pending: bool,
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
            base: None,
            scene: None,
            texels: None,
            particle_settings: None,
            capacities: Capacities::default(),
            force_all_paths: false,
            target: None,
            last: None,
            history: None,
            last_picture: None,
            full: None,
            pending: VecDeque::new(),
            needs: Vec::new(),
            packed: None,
            demand: None,
            shown: [0; 2],
            deformed: Vec::new(),
            meshlet_buffers: None,
            occluders: None,
            culled: None,
            is_judged: false,
            dots: None,
            totals: [0; 2],
            shadow_pass: None,
            is_shadow_pass: false,
            kept: None,
            simulation_pending: false,
        }
    }

    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Shares out work in another way than suits the adapter, from the next picture on.
    pub fn set_tuning(&mut self, tuning: Tuning) {
        self.tuning = tuning;
    }

    /// Room for so many queue entries, at least 1 of each, in the next picture of the scene that is set; too few grow and
    /// are drawn again.
    pub fn set_capacities(&mut self, capacities: Capacities) {
        self.capacities = capacities.at_least_one();
    }

    /// Room in the queues by now.
    pub fn capacities(&self) -> Capacities {
        self.capacities
    }

    /// Key of the last picture's kernel.
    pub fn key(&self) -> Option<&KernelKey> {
        self.last.as_ref().map(|plan| &plan.key)
    }

    /// What culling left out of the last finished picture; none where everything is drawn.
    pub fn culled(&self) -> Option<CullingStats> {
        self.culled
    }

    /// Pipelines compiled so far; a switch back to a known key adds none.
    pub fn compiled(&self) -> usize {
        self.pipelines.compiled()
    }

    /// Records and submits one frame; never waits. A picture of 0 pixels dispatches nothing.
    pub fn draw(&mut self, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<(), RenderError> {
        self.draw_timed(view, stack, accuracy, Detail::Passes, false)
    }

    pub(crate) fn draw_timed(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        detail: Detail,
        is_patient: bool,
    ) -> Result<(), RenderError> {
        let scale = accuracy.scale();
        self.shown = [view.width, view.height];
        if scale == RenderScale::Full {
            return self.draw_pixels(view, stack, accuracy, detail, is_patient);
        }
        let drawn = view.scaled(scale.factor());
        let stack = &stack.scaled(scale.factor());
        self.draw_pixels(&drawn, stack, accuracy, detail, is_patient).map_err(|error| error.at_scale(scale, view, &drawn))
    }

    /// Draws as many pixels as `view` has, whatever the size at which they are shown. Who is patient waits for particles.
    fn draw_pixels(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        detail: Detail,
        is_patient: bool,
    ) -> Result<(), RenderError> {
        if self.gpu.is_lost() {
            return Err(RenderError::Lost);
        }
        self.attach_particles(stack)?;
        let plan = self.prepare(view, stack, accuracy)?;
        if view.pixels() == 0 {
            self.target = None;
            return Ok(());
        }
        self.simulation_pending = self.simulate_particles(&plan.key, view, stack, is_patient)?;
        self.prepare_shadow_pass(view, stack)?;
        let passes = plan.key.frame();
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        if let Some(timer) = &mut self.timer {
            timer.begin(&mut encoder, detail);
        }
        self.clear(
            &mut encoder,
            &[
                "counters",
                "depth_keys",
                "triangle_ids",
                "depth_and_id",
                "packed",
                "layers",
                "tile_mask",
                "sample_counts",
                "boundary_samples",
            ],
        );
        if plan.key.effects.dots.is_some() {
            self.clear_dots(&mut encoder, &plan.key, view);
        }
        if self.buffers.has("bins") {
            encoder.clear_buffer(self.buffers.get("bins"), 0, Some(4 * bin_heads(view)));
        }
        if plan.key.work.listed_tiles {
            self.fill_background(&mut encoder, view);
        }
        self.keep_previous(&mut encoder, &plan.key, view, stack);
        self.keep_occluders(&mut encoder, &plan.key, view, stack);
        // The light comes after whatever bends the scene for both.
        let deforming = if self.shadow_pass.is_some() {
            passes.iter().take_while(|pass| matches!(pass, Pass::Particles | Pass::Skin)).count()
        } else {
            0
        };
        self.record(&mut encoder, &plan.key, &passes[..deforming], view, false)?;
        self.record_shadow_pass(&mut encoder)?;
        self.record(&mut encoder, &plan.key, &passes[deforming..], view, true)?;
        self.present(&mut encoder);
        let order = self.buffers.has("order").then(|| self.buffers.get("order"));
        let light = self.shadow_pass.as_ref().map(|shadow_pass| shadow_pass.counters());
        let stats = [Some(self.buffers.get("counters")), light, order];
        let pending = Pending::stage(&self.gpu, &mut encoder, stats, self.timer.as_ref());
        self.gpu.queue.submit([encoder.finish()]);
        self.pending.push_back(pending.begin());
        self.last = Some(plan);
        self.last_picture = Some((view.clone(), stack.clone()));
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
        newest.and_then(|finished| self.collect_stats(finished))
    }

    /// Are figures of a submitted frame still to come?
    pub fn is_pending(&self) -> bool {
        !self.pending.is_empty()
    }

    /// Waits for every frame in flight and returns the newest one's figures.
    pub fn finish(&mut self) -> Result<Report, RenderError> {
        buffers::wait(&self.gpu)?;
        let finished = self.pending.drain(..).next_back().ok_or(RenderError::NoScene)?;
        self.collect_stats(finished).ok_or(RenderError::Lost)
    }

    fn collect_stats(&mut self, finished: Pending) -> Option<Report> {
        let ([record, light], order, times) = finished.read(self.timer.as_ref())?;
        self.demand = Some([record.medium, record.large]);
        let key = self.last.as_ref()?.key.clone();
        let recorded = recorded_capacities(&key, &self.capacities);
        let mut counters = record.counters(&recorded);
        let mut redraw = counters.overflow > 0 && self.grow_queues(&key, &record);
        let lost_light = self.collect_shadow_stats(&light);
        counters.overflow = counters.overflow.saturating_add(lost_light);
        redraw |= lost_light > 0;
        redraw |= counters.full_pixels > 0 && self.pending.is_empty() && self.take_fewer_bits();
        let key = &self.last.as_ref()?.key;
        let order = (key.samples.draw_order.is_some())
            .then(|| order.stats(key.samples.draw_order == Some(draw_order::Mode::Scheduler), record.next_sample_index));
        let culled = key.culls().then(|| record.culled());
        if !self.is_judged {
            self.culled = culled;
        }
        let cpu_ms = self.dots.as_ref().and_then(|dots| dots.chosen_ms);
        Some(Report {
            gpu_ms: times.total_ms,
            cpu_ms,
            passes: times.passes,
            counters,
            order,
            culled,
            redraw,
            simulation_pending: self.simulation_pending,
        })
    }

    /// Makes room for what the queues lost, or gives up a proof that was wrong; true if either may help.
    fn grow_queues(&mut self, key: &KernelKey, record: &CounterRecord) -> bool {
        let is_proof_wrong = record.clip > 0 && !key.paths.has_clipping
            || record.medium > 0 && !key.paths.has_medium
            || record.large > 0 && !key.paths.has_large;
        self.force_all_paths |= is_proof_wrong;
        self.capacities.grow(record) || is_proof_wrong
    }

    /// Begins anew: the next picture stands after nothing but background.
    pub fn clear_history(&mut self) {
        self.history = None;
        self.occluders = None;
    }

    /// The last picture's sums overflowed: next time it gets the next smaller number of bits, if there is one.
    fn take_fewer_bits(&mut self) -> bool {
        let bits = match self.key().and_then(|key| key.framebuffer.layers) {
            Some(Layers::Xray { bits }) => xray::fewer(bits),
            _ => None,
        };
        let Some((bits, (view, stack))) = bits.zip(self.last_picture.clone()) else { return false };
        self.full = Some((view, stack, bits));
        true
    }

    fn clear(&self, encoder: &mut wgpu::CommandEncoder, names: &[&str]) {
        for name in names.iter().filter(|name| self.buffers.has(name)) {
            encoder.clear_buffer(self.buffers.get(name), 0, None);
        }
    }

    /// The straight list of passes; `ends` says whether the frame ends with the last of them.
    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        key: &KernelKey,
        passes: &[Pass],
        view: &View,
        ends: bool,
    ) -> Result<(), RenderError> {
        let (vertices, triangles) = (record_count(key, self.totals) as u32, self.totals[1] as u32);
        let deformed = self.deformed.last().map_or(0, |range| range.end);
        let (meshlets, particles) = (
            self.meshlet_buffers.as_ref().map_or(0, |meshlet_buffers| meshlet_buffers.count),
            self.particle_settings.map_or(0, |particle_settings| particle_settings.count),
        );
        self.pipelines.prepare(&self.gpu, key, passes)?;
        for (i, &pass) in passes.iter().enumerate() {
            let pipeline = self.pipelines.get(&self.gpu, key, pass)?;
            let is_last = ends && i + 1 == passes.len();
            let label = if self.is_shadow_pass { format!("light {}", pass.label()) } else { pass.label() };
            let timestamp_writes = self.timer.as_mut().and_then(|timer| timer.compute(&label, is_last));
            let mut recorded = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(&label), timestamp_writes });
            pipeline.bind(&self.gpu, &mut recorded, |name| match &self.texels {
                Some(texels) if name == "texels" => wgpu::BindingResource::TextureView(&texels.view),
                _ => self.buffers.resource(name),
            });
            let size = match &self.dots {
                Some(dots) if pass.is_of_dots() => dots.dispatch(pass, key),
                _ => dispatch(pass, [vertices, triangles, deformed, meshlets, particles], view, self.shown, key),
            };
            match size {
                // A list may be longer than one dispatch walks.
                Dispatch::Direct([x, y]) if pass == Pass::RasterTiles => {
                    (0..self.capacities.listed.div_ceil(key.work.max_list_entries).max(1))
                        .for_each(|_| recorded.dispatch_workgroups(x, y, 1));
                }
                Dispatch::Direct([x, y]) => recorded.dispatch_workgroups(x, y, 1),
                Dispatch::Listed => recorded.dispatch_workgroups_indirect(self.buffers.get("dot_args"), 0),
                Dispatch::Indirect(offset) => recorded.dispatch_workgroups_indirect(self.buffers.get("args"), offset),
            }
        }
        Ok(())
    }

    /// Copies the picture into the texture that a window shows.
    fn present(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let [width, height] = self.shown;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
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
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * color_stride(width)), rows_per_image: None };
        let picture = if self.buffers.has("shown") { "shown" } else { "color" };
        let source = wgpu::TexelCopyBufferInfo { buffer: self.buffers.get(picture), layout };
        encoder.copy_buffer_to_texture(source, texture.as_image_copy(), size);
    }
}

/// What a frame counted, before it is read as [`Counters`].
pub(crate) type Demand = CounterRecord;
