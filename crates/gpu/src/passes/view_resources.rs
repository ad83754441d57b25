//! A view on the device: the plan and the layout of its frames, its buffers, and the passes that
//! draw it. The picture, a shadow map and the judge's redraw of a culled picture are views of the
//! same scene.

use std::{ops::Range, sync::Arc};

use super::{
    dots::DotStore,
    layer_sums::RoomForLayers,
    recording::{CommandList, Device, DispatchSizes, Resources, Timing},
};
use crate::{
    accuracy::PositionFormat,
    device::{Gpu, error::RenderError, preparations::Preparation},
    effects::{Stack, glass::GlassDraws},
    layout::{
        BufferId, ClearedBy,
        frame_layout::{FrameLayout, LayoutInputs, Region, Span, Target, color_stride},
        glass::{fewest_bands, most_layers},
        queues::{Capacities, first_capacities, recorded_capacities},
        records::{CounterRecord, ScalingUniform, punctual_lights},
    },
    plan::{AccuracyRequest, Plan, Planner, Tuning},
    resources::buffers::Buffers,
    scene::{Background, Scene, draw::Draw, needs::Needs, parts::Scope, view::View},
    scene_data::{
        draws::{DrawData, DrawInputs},
        scene_resources::SceneResources,
    },
    shader::{glue::uniform_bytes, key::KernelKey, pass::Pass},
};

/// The plan of a frame, the view on its grid, and that view's draws.
type PlannedView = (Arc<Plan>, View, Arc<Vec<Draw>>);

/// What is to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    pub view: &'a View,
    pub stack: &'a Stack,
    pub accuracy: &'a AccuracyRequest,
    /// Pixels of the picture that is shown.
    pub shown: [u32; 2],
    /// What the sums of an x-ray need.
    pub room: RoomForLayers,
}

impl Request<'_> {
    /// Which draws are drawn as glass.
    pub(crate) fn glass(&self) -> GlassDraws {
        if self.accuracy.is_seen_through() {
            self.stack.glass()
        } else {
            GlassDraws::Nothing
        }
    }
}

/// A frame for which every buffer is ready.
pub struct PreparedFrame {
    pub plan: Arc<Plan>,
    /// The view that was asked for, on the grid and with the origin that the plan takes.
    pub view: View,
    pub layout: FrameLayout,
}

/// The draws of a scene as a view has them, and what they require of the kernels.
struct Seen {
    scene: Arc<Scene>,
    view: View,
    /// Scopes of the stack that the draws are for, and which of them are glass.
    scopes: Vec<Scope>,
    glass: GlassDraws,
    draws: Arc<Vec<Draw>>,
    needs: Arc<Needs>,
    /// The same where every path is kept.
    needs_all_paths: Arc<Needs>,
}

/// See the module's first lines.
pub struct ViewResources {
    target: Target,
    pub buffers: Buffers,
    /// Room in the queues.
    pub capacities: Capacities,
    /// What the newest finished picture counted.
    pub demand: Option<CounterRecord>,
    /// The size estimate was wrong once: queues and clipping are kept for this scene.
    pub force_all_paths: bool,
    /// Requirements of the last views: one for the default grid, one for the grid that the plan
    /// then took.
    seen: Vec<Seen>,
    planner: Planner,
    draw_data: Option<DrawData>,
    pub dots: Option<DotStore>,
    /// The background whose rows the buffers hold, the size of the picture, and where the rows lie
    /// that the resolve reads.
    background: Option<(Background, [u32; 2], Option<Span>)>,
    /// The picture shows the background in every tile that the tile mask does not name: the last
    /// picture was resolved by listed tiles.
    pub shows_background: bool,
    frame: Option<PreparedFrame>,
    commands: Option<CommandList>,
    /// The last call of `prepare` succeeded.
    is_prepared: bool,
}

impl ViewResources {
    /// A view of a scene with an ordinary number of triangles in its queues.
    pub fn new(target: Target, scene: Option<&Scene>) -> Self {
        Self {
            target,
            buffers: Buffers::default(),
            capacities: scene.map_or_else(Capacities::default, first_capacities),
            demand: None,
            force_all_paths: false,
            seen: Vec::new(),
            planner: Planner::default(),
            draw_data: None,
            dots: None,
            background: None,
            shows_background: false,
            frame: None,
            commands: None,
            is_prepared: false,
        }
    }

    /// The frame that was prepared last.
    pub fn frame(&self) -> Result<&PreparedFrame, RenderError> {
        self.frame.as_ref().ok_or(RenderError::NoScene)
    }

    /// Which of all vertices that may be deformed the last frame deformed.
    pub fn deformed(&self) -> &[Range<u32>] {
        self.draw_data.as_ref().map_or(&[], |data| &data.deformed)
    }

    /// Begins with another scene: what depends on the old one is dropped.
    pub fn change_scene(&mut self, scene: &Scene) {
        let of_scene = [
            BufferId::Vertices,
            BufferId::Meshlets,
            BufferId::MeshletLists,
            BufferId::MeshletVisibility,
            BufferId::Hiz,
        ];
        self.release_commands();
        self.buffers.keep(|id| !of_scene.contains(&id));
        (self.capacities, self.force_all_paths) = (first_capacities(scene), false);
        (self.draw_data, self.dots, self.demand) = (None, None, None);
        self.seen.clear();
    }

    /// Changes whenever passes, pipelines or bound buffers do; none before the passes were
    /// prepared.
    pub fn commands_revision(&self) -> Option<u64> {
        self.commands.as_ref().map(|commands| commands.revision)
    }

    /// Drops bind groups, which would hold buffers that are about to be made anew.
    pub fn release_commands(&mut self) {
        self.commands = None;
    }

    /// Plans a frame and makes the buffers hold what its passes will read. Nothing but uniforms is
    /// written where only parameters of effects changed.
    pub async fn prepare(
        &mut self,
        device: &Device,
        scene: &mut SceneResources,
        request: &Request<'_>,
    ) -> Result<(), RenderError> {
        let gpu = &*device.gpu;
        let (View { width, height, .. }, limit) = (request.view, gpu.caps.max_texture_side);
        if *width.max(height) > limit {
            return Err(RenderError::TooWide {
                width: *width,
                height: *height,
                limit,
            });
        }
        if !std::mem::take(&mut self.is_prepared) {
            // A frame that could not be prepared may have left buffers unwritten.
            (self.draw_data, self.dots, self.background) = (None, None, None);
            self.buffers
                .keep(|id| !matches!(id, BufferId::Meshlets | BufferId::MeshletLists));
        }
        let (plan, view, draws) = self.plan(device, scene.scene(), request)?;
        let key = &plan.key;
        let packed_bits = key.options.position_format.packed_bits();
        if self.target == Target::Picture {
            if scene.attributes().packed_bits != packed_bits {
                self.release_commands();
            }
            scene.pack_positions(gpu, packed_bits).await?;
            scene.keep_materials(gpu, &key.surface).await?;
            let shows_panorama = key.surface.has_panorama;
            scene
                .keep_image_files(gpu, request.stack, shows_panorama)
                .await?;
        }
        let is_changed = self.update_draw_data(scene, key, &view, &draws, request);
        if self.target == Target::Picture {
            self.dots =
                DotStore::update(self.dots.take(), scene.scene(), &view, request.stack, key)?;
        }
        let parameters = uniform_bytes(&request.stack.0);
        let mut capacities = recorded_capacities(key, &self.capacities);
        capacities.glass = capacities.glass.min(most_layers(
            view.pixels() as u64,
            key.framebuffer.glass_bands,
            &gpu.caps,
            device.tuning.glass_layers,
        ));
        let has_parameters = !parameters.is_empty() && key.effects.baked.is_empty();
        let layout = FrameLayout::new(&LayoutInputs {
            key,
            target: self.target,
            size: [view.width, view.height],
            shown: request.shown,
            has_gradient: view.background.is_gradient(),
            scene: self
                .draw_data
                .as_ref()
                .map(|data| data.counts)
                .unwrap_or_default(),
            dots: self.dots.as_ref().map(DotStore::counts),
            effect_bytes: if has_parameters {
                parameters.len() as u64
            } else {
                0
            },
            capacities,
        });
        let new = self.allocate(gpu, &layout).await?;
        self.write_draw_data(gpu, scene, &layout, &new, is_changed)
            .await?;
        self.write_uniforms(
            gpu,
            &layout,
            &view,
            request.stack.point_radius(),
            &parameters,
        )
        .await?;
        self.write_background(gpu, &layout, &view, |id| new.contains(&id))
            .await?;
        if let Some(dots) = &mut self.dots {
            dots.write(gpu, &self.buffers, |id| new.contains(&id))
                .await?;
        }
        self.frame = Some(PreparedFrame { plan, view, layout });
        self.is_prepared = true;
        Ok(())
    }

    /// The plan of a frame, with the view on its grid and that view's draws.
    fn plan(
        &mut self,
        device: &Device,
        scene: &Arc<Scene>,
        request: &Request<'_>,
    ) -> Result<PlannedView, RenderError> {
        let mut view = request.view.clone();
        let mut seen = self.see(&device.gpu, scene, &view, request)?;
        let mut plan = self.plan_of(device, seen, request)?;
        // Another grid has its guard band elsewhere, and another origin its matrices, so their
        // needs are their own.
        let options = &plan.key.options;
        let (subpixel_bits, is_relative) = (
            options.coverage.subpixel_bits(),
            options.position_format == PositionFormat::Relative,
        );
        view = view.with_grid(subpixel_bits, is_relative);
        if view.precision != request.view.precision {
            seen = self.see(&device.gpu, scene, &view, request)?;
            plan = self.plan_of(device, seen, request)?;
        }
        let mut room = request.room;
        let fewest = fewest_bands(view.pixels() as u64, &device.gpu.caps);
        room.glass_bands = room.glass_bands.max(fewest);
        if room.changes(&plan.key) {
            room.make(&mut Arc::make_mut(&mut plan).key);
        }
        Ok((plan, view, self.seen[seen].draws.clone()))
    }

    /// Position in `seen` of a scene as a view sees it, with the scopes of a stack. What is drawn as
    /// if it were opaque still needs to be seen through.
    fn see(
        &mut self,
        gpu: &Gpu,
        scene: &Arc<Scene>,
        view: &View,
        request: &Request<'_>,
    ) -> Result<usize, RenderError> {
        let (scopes, glass) = (request.stack.scopes(), request.glass());
        let is_known = |seen: &Seen| {
            Arc::ptr_eq(&seen.scene, scene)
                && seen.view == *view
                && (&seen.scopes, seen.glass) == (&scopes, glass)
        };
        if let Some(known) = self.seen.iter().position(is_known) {
            return Ok(known);
        }
        gpu.prepared.count(Preparation::View);
        let mut draws = request.stack.draws(scene, view)?;
        let needs = Needs::of(scene, &draws, view);
        (draws.iter_mut()).for_each(|draw| draw.is_glass = glass.has(draw.is_glass, draw.scopes));
        let needs_all_paths = Arc::new(Needs {
            clipping: true,
            largest_px: f64::INFINITY,
            ..needs.clone()
        });
        self.seen.truncate(1);
        self.seen.insert(
            0,
            Seen {
                scene: scene.clone(),
                view: view.clone(),
                scopes,
                glass,
                draws: Arc::new(draws),
                needs: Arc::new(needs),
                needs_all_paths,
            },
        );
        Ok(0)
    }

    /// The plan for a view in `seen`; the same as before where nothing that it depends on changed.
    fn plan_of(
        &mut self,
        device: &Device,
        seen: usize,
        request: &Request<'_>,
    ) -> Result<Arc<Plan>, RenderError> {
        let seen = &self.seen[seen];
        let needs = if self.force_all_paths {
            &seen.needs_all_paths
        } else {
            &seen.needs
        };
        // A shadow map has no picture whose tiles could be listed.
        let listed_tiles = device.tuning.listed_tiles && self.target != Target::ShadowMap;
        // The judge asks for the record of every point.
        let projects_points = device.tuning.projects_points && self.target != Target::Judge;
        let tuning = Tuning {
            listed_tiles,
            projects_points,
            ..device.tuning
        };
        let made = self.planner.made();
        let plan = self.planner.plan(
            needs,
            request.stack,
            &device.gpu.caps,
            &tuning,
            request.accuracy,
        )?;
        if self.planner.made() > made {
            device.gpu.prepared.count(Preparation::Plan);
        }
        Ok(plan)
    }

    /// Computes what the passes read about every instance, unless it is known; true if it changed.
    fn update_draw_data(
        &mut self,
        scene: &mut SceneResources,
        key: &KernelKey,
        view: &View,
        draws: &[Draw],
        request: &Request<'_>,
    ) -> bool {
        let inputs = DrawInputs {
            view: view.clone(),
            attributes: scene.attributes(),
            culls: key.culls(),
            is_instanced: key.vertices.is_instanced,
            // A light sees the instances of the picture where that has them.
            places_instances: self.target != Target::ShadowMap,
            projects_points: key.work.projects_points,
            deforms_offscreen: !key.culls() || request.stack.light().is_some(),
            scopes: request.stack.scopes(),
            glass: request.glass(),
        };
        if self
            .draw_data
            .as_ref()
            .is_some_and(|data| data.is_of(scene.scene(), &inputs))
        {
            return false;
        }
        let meshlets = key.culls().then(|| scene.meshlets());
        let boxes = if key.options.position_format.packed_bits().is_some() {
            scene.packed_boxes()
        } else {
            &[]
        };
        let before = self.draw_data.take();
        let mut data = DrawData::new(
            scene.scene(),
            draws,
            inputs,
            boxes,
            meshlets.as_deref(),
            before,
        );
        data.counts.particles = scene.particle_count();
        self.draw_data = Some(data);
        true
    }

    /// Makes and drops buffers so that those of the layout are there; returns the new ones.
    async fn allocate(
        &mut self,
        gpu: &Gpu,
        layout: &FrameLayout,
    ) -> Result<Vec<BufferId>, RenderError> {
        if self
            .frame
            .as_ref()
            .is_none_or(|frame| frame.layout != *layout)
        {
            self.release_commands();
        }
        self.buffers.keep(|id| layout.has(id));
        let mut new = Vec::new();
        for (id, spec) in layout.buffers() {
            if self
                .buffers
                .ensure_for(gpu, id, spec.bytes, spec.purpose)
                .await?
            {
                new.push(id);
            }
        }
        Ok(new)
    }

    /// Writes draw data that changed, or whose buffers are new.
    async fn write_draw_data(
        &self,
        gpu: &Gpu,
        scene: &mut SceneResources,
        layout: &FrameLayout,
        new: &[BufferId],
        is_changed: bool,
    ) -> Result<(), RenderError> {
        let Some(data) = &self.draw_data else {
            return Ok(());
        };
        let contents: [(BufferId, &[u8]); 6] = [
            (BufferId::Draws, data.records.draws()),
            (BufferId::Shapes, data.records.shapes()),
            (
                BufferId::Deforms,
                bytemuck::cast_slice(&data.deforms.records),
            ),
            (BufferId::Joints, bytemuck::cast_slice(&data.deforms.joints)),
            (
                BufferId::MorphTargets,
                bytemuck::cast_slice(&data.deforms.morph_targets),
            ),
            (BufferId::Instances, bytemuck::cast_slice(&data.instances)),
        ];
        for (id, bytes) in contents
            .into_iter()
            .filter(|(id, _)| layout.has(*id) && (is_changed || new.contains(id)))
        {
            self.buffers.write_at(gpu, id, 0, bytes).await?;
        }
        if is_changed && data.has_new_placements {
            scene.place_instances(gpu, &data.placements).await?;
        }
        if new.contains(&BufferId::Meshlets) || new.contains(&BufferId::MeshletLists) {
            scene.meshlets().write(gpu, &self.buffers).await?;
        }
        Ok(())
    }

    async fn write_uniforms(
        &self,
        gpu: &Gpu,
        layout: &FrameLayout,
        view: &View,
        point_radius: u32,
        parameters: &[u8],
    ) -> Result<(), RenderError> {
        let scaling = ScalingUniform {
            size: layout.shown,
            stride: color_stride(layout.shown[0]),
            spare: 0,
        };
        let (frame, culling) = (
            layout.frame_uniform(view, point_radius),
            layout.culling_uniform(),
        );
        let lights = punctual_lights(&view.scene_state.lights);
        let uniforms: [(BufferId, &[u8]); 5] = [
            (BufferId::Frame, bytemuck::bytes_of(&frame)),
            (BufferId::Effects, parameters),
            (BufferId::PunctualLights, bytemuck::cast_slice(&lights)),
            (BufferId::Culling, bytemuck::bytes_of(&culling)),
            (BufferId::Scaling, bytemuck::bytes_of(&scaling)),
        ];
        for (id, bytes) in uniforms.into_iter().filter(|(id, _)| layout.has(*id)) {
            self.buffers.write_at(gpu, id, 0, bytes).await?;
        }
        Ok(())
    }

    /// Writes the rows of background that are copied over the picture, and those that the resolve
    /// reads, where they changed. The picture does not show them then.
    async fn write_background(
        &mut self,
        gpu: &Gpu,
        layout: &FrameLayout,
        view: &View,
        is_new: impl Fn(BufferId) -> bool,
    ) -> Result<(), RenderError> {
        let background = Some((
            view.background,
            layout.size,
            layout.region(Region::BackgroundRows).cloned(),
        ));
        let is_changed = self.background != background;
        if layout.has(BufferId::Background) && (is_changed || is_new(BufferId::Background)) {
            let stride = color_stride(view.width) as usize;
            let words: Vec<u8> = view
                .background
                .rows(layout.background_rows())
                .iter()
                .flat_map(|row| row.repeat(stride))
                .collect();
            self.buffers
                .write_at(gpu, BufferId::Background, 0, &words)
                .await?;
        }
        if let Some(span) = layout.region(Region::BackgroundRows)
            && (is_changed || is_new(span.buffer))
        {
            let rows = view.background.rows(view.height);
            self.buffers
                .write_at(
                    gpu,
                    span.buffer,
                    span.bytes.start,
                    bytemuck::cast_slice(&rows),
                )
                .await?;
        }
        self.background = background;
        self.shows_background &=
            !is_changed && !is_new(BufferId::Color) && !is_new(BufferId::TileMask);
        Ok(())
    }

    /// Fills with zeros what is cleared on these occasions.
    pub fn clear(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        occasion: impl Fn(ClearedBy) -> bool,
    ) -> Result<(), RenderError> {
        for (id, bytes) in self.frame()?.layout.cleared(occasion) {
            encoder.clear_buffer(
                self.buffers.get(id)?,
                bytes.start,
                Some(bytes.end - bytes.start),
            );
        }
        Ok(())
    }

    /// Makes the passes of the frame ready to be recorded, unless they are. `others` are resources
    /// that the view shares.
    pub async fn prepare_passes(
        &mut self,
        device: &mut Device,
        passes: Vec<Pass>,
        others: &Resources<'_>,
    ) -> Result<(), RenderError> {
        let key = &self.frame.as_ref().ok_or(RenderError::NoScene)?.plan.key;
        let resources = others.with(&self.buffers);
        match &self.commands {
            Some(commands) if commands.is_for(key, &passes, &resources) => {
                commands.mark(&device.gpu.pipelines)
            }
            _ => {
                let prefix = if self.target == Target::ShadowMap {
                    "light "
                } else {
                    ""
                };
                let commands = CommandList::new(device, key, passes, prefix, &resources).await?;
                self.commands = Some(commands);
            }
        }
        Ok(())
    }

    /// Records a part of the passes that were prepared.
    pub fn record(
        &self,
        part: Range<usize>,
        encoder: &mut wgpu::CommandEncoder,
        timing: Timing<'_>,
    ) -> Result<(), RenderError> {
        let commands = self.commands.as_ref().ok_or(RenderError::NoScene)?;
        let sizes = DispatchSizes {
            layout: &self.frame()?.layout,
            demand: self.demand.as_ref(),
            buffers: &self.buffers,
        };
        commands.record(part, encoder, &sizes, timing)
    }

    /// All passes that were prepared.
    pub fn passes(&self) -> Range<usize> {
        0..self.commands.as_ref().map_or(0, CommandList::len)
    }

    /// Makes room for what the queues lost, or gives up an estimate that was wrong; true if either
    /// may help.
    pub fn grow_queues(&mut self, record: &CounterRecord) -> bool {
        let is_estimate_wrong = self.frame.as_ref().is_some_and(|frame| {
            let key = &frame.plan.key;
            record.clip > 0 && !key.paths.has_clipping
                || record.medium > 0 && !key.paths.has_medium
                || record.large > 0 && !key.paths.has_large
        });
        self.force_all_paths |= is_estimate_wrong;
        self.capacities.grow(record) || is_estimate_wrong
    }
}
