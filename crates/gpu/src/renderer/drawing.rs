//! The renderer: draws pictures of one scene on one device, and hands back what they show and what
//! they cost.

use std::{collections::VecDeque, sync::Arc};

use super::{
    explain::{Explained, Explanation},
    frame_stats::{Pending, Staged, StatSources},
};
use crate::{
    accuracy::RenderScale,
    device::{
        Gpu,
        compile_watch::CompileWatch,
        error::RenderError,
        preparations::Preparation,
        timer::{Detail, Timer},
    },
    effects::{Stack, draw_order::Mode},
    frame::{Counters, CullingStats, OrderStats},
    layout::{
        BufferId, ClearedBy, TextureId,
        frame_layout::{Region, Target, color_stride},
        queues::{Capacities, recorded_capacities},
    },
    passes::{
        hardware_ids,
        history::{History, fill_background},
        particles::{ParticleSimulation, Wait},
        recording::{Device, Resources, Timing},
        shadow_pass::ShadowPass,
        view_resources::{Request, ViewResources},
    },
    plan::{AccuracyRequest, Plan, Tuning},
    resources::{buffers, pipelines::Pipelines},
    scene::{Scene, view::View},
    scene_data::scene_resources::SceneResources,
    shader::{key::KernelKey, library::Library, pass::Pass},
};

/// Statistics of a finished frame.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Whole frame, clears included, milliseconds; none where the adapter has no timestamps.
    pub gpu_ms: Option<f64>,
    /// Milliseconds in which the CPU chose and uploaded dots for the newest frame while the GPU
    /// waited.
    pub cpu_ms: Option<f64>,
    pub passes: Vec<(String, f64)>,
    pub counters: Counters,
    /// How many samples a draw order let through, where the stack has one.
    pub order: Option<OrderStats>,
    /// Which meshlets were culled, where the frame culls.
    pub culled: Option<CullingStats>,
    /// A queue overflowed and has grown: the picture is incomplete, draw it again.
    pub redraw: bool,
    /// A band of pixels has so many layers of glass, more than there can be room for.
    pub lost_layers: Option<u32>,
    /// The picture shows an earlier frame of the particles than it was asked for: draw it again.
    pub simulation_pending: bool,
}

/// The texture that a window shows.
struct Presentation {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

/// Draws scenes on one device.
pub struct Renderer {
    pub(crate) device: Device,
    pub(crate) scene: Option<SceneResources>,
    pub(crate) picture: ViewResources,
    /// The view of the light that casts shadows, where an effect asks for them.
    pub(crate) shadow: Option<ShadowPass>,
    pub(crate) particles: ParticleSimulation,
    pub(crate) history: History,
    /// Statistics of frames in flight, oldest first.
    pending: VecDeque<Pending>,
    /// Buffers of finished frames, for the statistics of the next.
    spare_stats: Vec<wgpu::Buffer>,
    /// Through which shown pictures are read.
    shown_staging: Option<wgpu::Buffer>,
    explained: Explained,
    culled: Option<CullingStats>,
    presentation: Option<Presentation>,
}

impl Renderer {
    /// A renderer whose shaders come from the library of the process, as a rule from inside this
    /// program.
    pub fn new(gpu: Arc<Gpu>) -> Self {
        Self::with_library(gpu, Library::of_process())
    }

    /// A renderer whose shaders come from `library`.
    pub fn with_library(gpu: Arc<Gpu>, library: Library) -> Self {
        let device = Device {
            timer: Timer::new(&gpu),
            tuning: gpu.caps.tuning(),
            pipelines: Pipelines::new(library),
            gpu,
        };
        Self {
            device,
            scene: None,
            picture: ViewResources::new(Target::Picture, None),
            shadow: None,
            particles: ParticleSimulation::default(),
            history: History::default(),
            pending: VecDeque::new(),
            spare_stats: Vec::new(),
            shown_staging: None,
            explained: Explained::default(),
            culled: None,
            presentation: None,
        }
    }

    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.device.gpu
    }

    /// Tells `watch` before something is compiled, and lets it stop that.
    pub fn watch_compiling(&mut self, watch: Arc<CompileWatch>) {
        self.device.pipelines.watch(watch);
    }

    /// Shares out work differently from the next picture on; the default is what suits the adapter.
    pub fn set_tuning(&mut self, tuning: Tuning) {
        self.device.tuning = tuning;
    }

    /// Sets the capacity of the queues, at least 1 entry each, for the next picture of the current
    /// scene; queues that overflow grow and the picture is drawn again.
    pub fn set_capacities(&mut self, capacities: Capacities) {
        self.picture.capacities = capacities.at_least_one();
    }

    /// Room in the queues, as far as they have grown.
    pub fn capacities(&self) -> Capacities {
        self.picture.capacities
    }

    /// Key of the last picture's kernel.
    pub fn key(&self) -> Option<&KernelKey> {
        self.picture.frame().ok().map(|frame| &frame.plan.key)
    }

    /// Plan of the last picture.
    pub fn plan(&self) -> Option<&Arc<Plan>> {
        self.picture.frame().ok().map(|frame| &frame.plan)
    }

    /// Which meshlets were culled in the last finished picture; none where it does not cull.
    pub fn culled(&self) -> Option<CullingStats> {
        self.culled
    }

    /// Pipelines compiled so far; a switch back to a known key adds none.
    pub fn compiled(&self) -> usize {
        self.device.pipelines.compiled()
    }

    /// Uploads a scene's bytes as they are. The current scene stays when the new one is too large
    /// for the adapter.
    pub async fn set_scene(&mut self, scene: &Arc<Scene>) -> Result<(), RenderError> {
        if self
            .scene
            .as_ref()
            .is_some_and(|current| current.is_of(scene))
        {
            return Ok(());
        }
        SceneResources::check(&self.device.gpu, scene)?;
        self.change_scene(scene);
        // The memory of the old scene is free before the new one takes it.
        self.scene = None;
        self.scene = Some(SceneResources::new(&self.device.gpu, scene).await?);
        Ok(())
    }

    /// Drops what depends on the vertices of the scene.
    fn change_scene(&mut self, scene: &Scene) {
        self.picture.change_scene(scene);
        self.history.change_scene();
        self.shadow = None;
    }

    /// Records and submits one frame; never waits for it. A picture of 0 pixels dispatches nothing.
    pub async fn draw(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<(), RenderError> {
        self.draw_timed(view, stack, accuracy, Detail::Passes, Wait::None)
            .await
    }

    /// [`Self::draw`] with a choice of what is timed and what is waited for.
    pub async fn draw_timed(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        detail: Detail,
        wait: Wait,
    ) -> Result<(), RenderError> {
        let shown = [view.width, view.height];
        let scale = accuracy.scale();
        if scale == RenderScale::Full {
            return self
                .draw_pixels(view, stack, accuracy, shown, detail, wait)
                .await;
        }
        let (drawn, stack) = (view.scaled(scale.factor()), stack.scaled(scale.factor()));
        self.draw_pixels(&drawn, &stack, accuracy, shown, detail, wait)
            .await
            .map_err(|error| error.at_scale(scale, view, &drawn))
    }

    /// Draws as many pixels as `view` has, independent of the size at which they are shown.
    async fn draw_pixels(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        shown: [u32; 2],
        detail: Detail,
        wait: Wait,
    ) -> Result<(), RenderError> {
        if self.device.gpu.is_lost() {
            return Err(RenderError::Lost);
        }
        self.attach_particles(stack).await?;
        let room = self.history.room_for_layers(view, stack);
        let request = Request {
            view,
            stack,
            accuracy,
            shown,
            room,
        };
        while let Err(error) = self.prepare(&request, wait).await {
            if !self.makes_do_with_less_glass(&error) {
                return Err(error);
            }
        }
        if view.pixels() == 0 {
            self.presentation = None;
            return Ok(());
        }
        let gpu = self.device.gpu.clone();
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("frame"),
            });
        if let Some(timer) = &mut self.device.timer {
            timer.begin(&mut encoder, detail);
        }
        self.record(&mut encoder, view, stack)?;
        self.present(&mut encoder, shown)?;
        let shadow = self
            .shadow
            .as_ref()
            .map(|shadow| shadow.resources.buffers.get(BufferId::Counters))
            .transpose()?;
        let buffers = &self.picture.buffers;
        let sources = StatSources {
            picture: Some(buffers.get(BufferId::Counters)?),
            shadow,
            order: buffers.get(BufferId::DrawOrder).ok(),
            glass: self
                .picture
                .frame()?
                .layout
                .region(Region::GlassCounts)
                .map(|span| Ok::<_, RenderError>((buffers.get(span.buffer)?, span.bytes.start)))
                .transpose()?,
        };
        let staged = Staged::stage(
            &gpu,
            &mut encoder,
            sources,
            self.device.timer.as_ref(),
            self.spare_stats.pop(),
        );
        gpu.queue.submit([encoder.finish()]);
        self.picture.shows_background = self.picture.frame()?.plan.key.keeps_background();
        self.pending.push_back(staged.begin());
        self.history.finish(view, stack);
        Ok(())
    }

    /// Puts the particles of the stack into the scene.
    async fn attach_particles(&mut self, stack: &Stack) -> Result<(), RenderError> {
        let scene = self.scene.as_mut().ok_or(RenderError::NoScene)?;
        if scene.has_particles_of(stack) {
            return Ok(());
        }
        self.picture.release_commands();
        self.shadow
            .iter_mut()
            .for_each(|shadow| shadow.resources.release_commands());
        if scene.attach_particles(&self.device.gpu, stack).await? {
            let scene = scene.scene().clone();
            self.change_scene(&scene);
        }
        Ok(())
    }

    /// Makes everything ready for the passes of a picture: plan and buffers, the particles before
    /// their last step, the shadow pass.
    async fn prepare(&mut self, request: &Request<'_>, wait: Wait) -> Result<(), RenderError> {
        let Self {
            device,
            scene,
            picture,
            shadow,
            particles,
            ..
        } = self;
        let scene = scene.as_mut().ok_or(RenderError::NoScene)?;
        let Request { view, stack, .. } = *request;
        picture.prepare(device, scene, request).await?;
        if view.pixels() == 0 {
            return Ok(());
        }
        let key = &picture.frame()?.plan.key;
        particles
            .simulate(device, scene, &picture.buffers, (key, view, stack), wait)
            .await?;
        let passes = key.frame();
        *shadow = ShadowPass::prepare(shadow.take(), device, scene, view, stack).await?;
        picture
            .prepare_passes(device, passes, &shared(scene, particles, shadow.as_ref()))
            .await
    }

    /// Records the clears and passes of a picture and its shadow map.
    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
        stack: &Stack,
    ) -> Result<(), RenderError> {
        let Self {
            device,
            picture,
            shadow,
            history,
            ..
        } = self;
        // If recording fails, nothing is drawn, and the next picture copies the background again.
        let shows_background = std::mem::take(&mut picture.shows_background);
        picture.clear(encoder, |occasion| occasion != ClearedBy::History)?;
        let frame = picture.frame()?;
        if frame.plan.key.keeps_background() && !shows_background {
            fill_background(encoder, &picture.buffers, &frame.layout)?;
        }
        history.keep_previous(encoder, picture, view, stack)?;
        history.keep_pass(encoder, picture, view, stack)?;
        history.keep_occluders(encoder, picture, view, stack)?;
        let passes = frame.plan.key.frame();
        // The shadow map comes after the passes that deform the scene for both.
        let deforming = passes
            .iter()
            .take_while(|pass| matches!(pass, Pass::Particles | Pass::Skin))
            .count();
        let first = if shadow.is_some() { deforming } else { 0 };
        picture.record(
            0..first,
            encoder,
            Timing {
                timer: device.timer.as_mut(),
                ends_frame: false,
            },
        )?;
        if let Some(shadow) = shadow {
            shadow.record(encoder, device.timer.as_mut())?;
        }
        picture.record(
            first..passes.len(),
            encoder,
            Timing {
                timer: device.timer.as_mut(),
                ends_frame: true,
            },
        )
    }

    /// Copies the picture into the texture that a window shows.
    fn present(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        [width, height]: [u32; 2],
    ) -> Result<(), RenderError> {
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let known = self
            .presentation
            .take()
            .filter(|presentation| presentation.texture.size() == size);
        let presentation = known.unwrap_or_else(|| {
            let texture = self
                .device
                .gpu
                .device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some("picture"),
                    size,
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: wgpu::TextureFormat::Rgba8Unorm,
                    usage: wgpu::TextureUsages::COPY_DST
                        | wgpu::TextureUsages::COPY_SRC
                        | wgpu::TextureUsages::TEXTURE_BINDING,
                    view_formats: &[],
                });
            self.device.gpu.prepared.count(Preparation::Texture);
            let view = texture.create_view(&Default::default());
            Presentation { texture, view }
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * color_stride(width)),
            rows_per_image: None,
        };
        let picture = self.picture.buffers.get(self.shown_buffer())?;
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo {
                buffer: picture,
                layout,
            },
            presentation.texture.as_image_copy(),
            size,
        );
        self.presentation = Some(presentation);
        Ok(())
    }

    /// The buffer that holds what is shown.
    fn shown_buffer(&self) -> BufferId {
        [BufferId::ScaledColor, BufferId::Finished]
            .into_iter()
            .find(|&id| self.picture.buffers.has(id))
            .unwrap_or(BufferId::Color)
    }

    /// The finished picture: Rgba8Unorm with gamma-encoded bytes; none before the first draw and
    /// for 0 pixels.
    pub fn texture_view(&self) -> Option<&wgpu::TextureView> {
        self.presentation
            .as_ref()
            .map(|presentation| &presentation.view)
    }

    /// The texture of [`Self::texture_view`], which may be copied from.
    pub fn texture(&self) -> Option<&wgpu::Texture> {
        self.presentation
            .as_ref()
            .map(|presentation| &presentation.texture)
    }

    /// The pixels of the finished picture, row by row, as many as the view had. None before the
    /// first draw and for 0 pixels.
    pub async fn read_shown(&mut self) -> Result<Option<Vec<[u8; 4]>>, RenderError> {
        let Some(presentation) = &self.presentation else {
            return Ok(None);
        };
        let size = [presentation.texture.width(), presentation.texture.height()];
        let shown = self.picture.buffers.get(self.shown_buffer())?;
        buffers::read_picture_through(&self.device.gpu, shown, size, &mut self.shown_staging)
            .await
            .map(Some)
    }

    /// Statistics of the newest finished frame, or none yet; does not wait.
    pub fn report(&mut self) -> Option<Report> {
        let _ = self.device.gpu.device.poll(wgpu::PollType::Poll);
        let mut newest = None;
        while self.pending.front().is_some_and(Pending::is_ready) {
            self.spare_stats.extend(
                newest
                    .replace(self.pending.pop_front()?)
                    .map(Pending::into_spare),
            );
        }
        self.collect_stats(newest?)
    }

    /// Are statistics of a submitted frame still to come?
    pub fn is_pending(&self) -> bool {
        !self.pending.is_empty()
    }

    /// Waits for every frame in flight and returns the newest one's statistics.
    pub async fn finish(&mut self) -> Result<Report, RenderError> {
        let finished = self.pending.pop_back().ok_or(RenderError::NoScene)?;
        finished.ready(&self.device.gpu).await?;
        self.spare_stats
            .extend(self.pending.drain(..).map(Pending::into_spare));
        self.collect_stats(finished).ok_or(RenderError::Lost)
    }

    fn collect_stats(&mut self, finished: Pending) -> Option<Report> {
        let (stats, times) = finished.read(self.device.timer.as_ref())?;
        self.spare_stats.push(finished.into_spare());
        let record = &stats.picture;
        self.picture.demand = Some(*record);
        let frame = self.picture.frame().ok()?;
        let (key, glass_room) = (frame.plan.key.clone(), frame.layout.capacities.glass);
        let mut counters = record.counters(&recorded_capacities(&key, &self.picture.capacities));
        let mut redraw = counters.overflow > 0 && self.picture.grow_queues(record);
        let mut lost_layers = None;
        if key.has_glass() {
            counters.full_pixels = stats.glass.deep_pixels;
            let lost = stats.glass.demand().saturating_sub(glass_room);
            counters.overflow = counters.overflow.saturating_add(lost);
            if lost > 0 {
                let has_room = self.make_room_for_glass(&key, stats.glass.demand());
                redraw |= has_room;
                lost_layers = (!has_room).then_some(stats.glass.demand());
            }
        }
        let lost_shadow = self
            .shadow
            .as_mut()
            .map_or(0, |shadow| shadow.collect_stats(&stats.shadow));
        counters.overflow = counters.overflow.saturating_add(lost_shadow);
        redraw |= lost_shadow > 0;
        redraw |= counters.full_pixels > 0
            && !key.has_glass()
            && self.pending.is_empty()
            && self.history.make_room_for_layers(&key);
        let is_chosen = key.samples.draw_order == Some(Mode::Scheduler);
        self.culled = key.culls().then(|| record.culled());
        Some(Report {
            gpu_ms: times.total_ms,
            cpu_ms: self.picture.dots.as_ref().and_then(|dots| dots.chosen_ms),
            passes: times.passes,
            counters,
            order: (key.samples.draw_order.is_some())
                .then(|| stats.order.stats(is_chosen, record.next_sample_index)),
            culled: self.culled,
            redraw,
            lost_layers,
            simulation_pending: self.particles.is_pending,
        })
    }

    /// Forgets what the next picture would start from: background comes before it.
    pub fn clear_history(&mut self) {
        self.history.clear();
    }

    /// [`Self::explain`], kept while nothing that it says has changed.
    pub fn explained(&mut self) -> Arc<Explanation> {
        let Self {
            device,
            scene,
            picture,
            shadow,
            particles,
            explained,
            ..
        } = self;
        explained.of(&device.gpu, picture, shadow.as_ref(), || match scene {
            Some(scene) => shared(scene, particles, shadow.as_ref()),
            None => Resources::default(),
        })
    }

    /// Passes and buffers of the last picture, what it does without, and why.
    pub fn explain(&self) -> Explanation {
        let others = self
            .scene
            .as_ref()
            .map(|scene| shared(scene, &self.particles, self.shadow.as_ref()))
            .unwrap_or_default();
        Explanation::new(&self.picture, &others, self.shadow.as_ref())
    }

    /// Draws loose triangles with the adapter's own rasterizer: see `hardware_ids::triangle_ids`.
    pub async fn hardware_ids(
        &self,
        size: [u32; 2],
        corners: &[[f32; 3]],
    ) -> Result<Vec<u32>, RenderError> {
        hardware_ids::triangle_ids(
            &self.device.gpu,
            self.device.pipelines.library(),
            size,
            corners,
        )
        .await
    }
}

/// What the picture reads of other views and stages.
pub(crate) fn shared<'a>(
    scene: &'a SceneResources,
    particles: &'a ParticleSimulation,
    shadow: Option<&'a ShadowPass>,
) -> Resources<'a> {
    let mut resources = Resources::of_scene(scene);
    resources.buffers.push(&particles.buffers);
    if let Some(shadow) = shadow {
        resources.buffers.push(&shadow.uniform);
        resources
            .textures
            .extend(shadow.map.iter().map(|map| (TextureId::ShadowMap, map)));
        resources.light = Some(&shadow.resources.buffers);
    }
    resources
}
