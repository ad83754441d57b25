//! Preparation of a frame: the plan, and buffers that hold what its passes will read.

use std::sync::Arc;

use super::{
    RenderError, Renderer, STORAGE,
    culling::{self, MeshletBuffers},
    deforms::{DEFORMED_BYTES, Deforms, deformed_ranges},
    packing::{Packing, bytes_of},
    texels::Texels,
    uniforms::{Capacities, CounterRecord, DrawRecord, FrameUniform, OrderRecord, ScalingUniform, color_stride},
};
use crate::{
    accuracy::{Culling, PositionFormat, Visibility},
    effects::{Stack, draw_order, hooks::Layers},
    math::{SUBPIXEL_BITS, srgb_byte},
    plan::{AccuracyRequest, Plan, StackTraits, plan},
    scene::{
        Scene,
        draw::{Draw, draws as drawn, totals},
        needs::Needs,
        view::View,
    },
    shader::{
        glue::uniform_bytes,
        key::{FramebufferLayout, KernelKey},
    },
};

impl Renderer {
    /// The plan for what the scene requires as `view` sees it. The last requirements are kept: a picture that is drawn again has
    /// the same, and a look at thousands of triangles takes longer than many a card takes for all of them.
    fn planned(
        &mut self,
        scene: &Arc<Scene>,
        draws: &[Draw],
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<Plan, RenderError> {
        let is_known = |(of, meshlet_visibility, _): &(Arc<Scene>, View, Needs)| Arc::ptr_eq(of, scene) && meshlet_visibility == view;
        let place = self.needs.iter().position(is_known).unwrap_or_else(|| {
            // One for the grid that is usual, one for the grid that the plan then asks for.
            self.needs.truncate(1);
            self.needs.insert(0, (scene.clone(), view.clone(), Needs::of(scene, draws, view)));
            0
        });
        let mut needs = self.needs[place].2.clone();
        if self.force_all_paths {
            (needs.clipping, needs.largest_px) = (true, f64::INFINITY);
        }
        let stack = StackTraits::of(stack, accuracy)?;
        Ok(plan(&Arc::new(needs), &stack, &self.gpu.caps, &self.tuning, accuracy)?)
    }

    /// Plans the picture and makes its buffers hold what the passes will read.
    pub(super) fn prepare(&mut self, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<Plan, RenderError> {
        let scene = self.scene.clone().ok_or(RenderError::NoScene)?;
        let gpu = &self.gpu;
        let limit = gpu.caps.max_texture_side;
        if view.width.max(view.height) > limit {
            return Err(RenderError::TooWide { width: view.width, height: view.height, limit });
        }
        let mut draws = drawn(&scene, view)?;
        let mut plan = self.planned(&scene, &draws, view, stack, accuracy)?;
        // Another grid has its guard band elsewhere, and another origin its matrices, so their needs are their own.
        let options = &plan.key.options;
        let (subpixel_bits, is_relative) = (options.coverage.subpixel_bits(), options.position_format == PositionFormat::Relative);
        let asked = view;
        let view = &view.with_grid(subpixel_bits, is_relative);
        if is_relative {
            draws = drawn(&scene, view)?;
        }
        if is_relative || view.precision.subpixel_bits != SUBPIXEL_BITS {
            plan = self.planned(&scene, &draws, view, stack, accuracy)?;
        }
        let packed_bits = plan.key.options.position_format.packed_bits();
        if self.packed.as_ref().map(|(bits, _)| *bits) != packed_bits {
            self.hold_attributes(&scene, packed_bits)?;
        }
        let (gpu, buffers) = (&self.gpu, &mut self.buffers);
        if let (Some(Layers::Xray { bits }), Some((full_view, full_stack, fewer))) = (&mut plan.key.framebuffer.layers, &self.full)
            && (full_view, full_stack) == (asked, stack)
        {
            *bits = (*bits).min(*fewer);
        }
        let key = &plan.key;
        match (key.surface.has_material_atlas, &self.texels) {
            (true, None) => self.texels = Some(Texels::new(gpu, &scene)?),
            (false, Some(_)) => self.texels = None,
            _ => {}
        }
        let recorded = recorded_capacities(key, &self.capacities);

        let first_packed = attribute_bytes(&scene) as u32;
        let record = |draw: &Draw| {
            let record = DrawRecord::new(draw, &scene);
            self.packed.as_ref().map_or(record, |(_, packing)| record.packed(&packing.boxes[draw.primitive], first_packed))
        };
        let mut records: Vec<DrawRecord> = draws.iter().map(record).collect();
        // A binding holds an element at least, even where nothing is to be drawn.
        records.resize(draws.len().max(1), DrawRecord::default());
        // Nobody draws what lies outside the picture, so nothing bends it, unless it may throw a shadow into it.
        let is_deformed = |draw: &&Draw| !key.culls() || stack.light().is_some() || !culling::is_outside(draw, &scene);
        let deforms = Deforms::of(&scene, draws.iter().filter(is_deformed));
        self.totals = totals(&scene, &draws);
        let (triangles, vertex_records) = (self.totals[1], record_count(key, self.totals));
        let sample_setups = u64::from(key.sample_setups()) * (triangles + u64::from(recorded.pieces));
        let first_rank = vertex_records + sample_setups;
        let uniform = FrameUniform {
            vertex_count: vertex_records as u32,
            triangle_count: triangles as u32,
            point_radius: stack.point_radius(),
            first_rank: first_rank as u32,
            deform_count: deforms.records.len() as u32,
            ..FrameUniform::new(view, &scene, draws.len(), &recorded)
        };
        let parameters = uniform_bytes(&stack.0);
        let has_uniform = !parameters.is_empty() && key.effects.baked.is_empty();
        self.deformed = deformed_ranges(&scene, &draws);
        let is_judged = self.is_judged;
        buffers.keep(|name| match name {
            "queues" => key.has_queues(),
            "args" => key.has_queues() || key.work.listed_tiles || key.culls(),
            "culling" | "instances" | "meshlets" | "meshlet_lists" => key.culls() || is_judged,
            "meshlet_visibility" => key.options.culling == Culling::TwoPass || is_judged,
            "hiz" => key.options.culling.occludes() || is_judged,
            "tile_mask" => key.work.listed_tiles,
            "background" => key.work.listed_tiles || key.reads_previous(),
            "previous" => key.reads_previous(),
            "pieces" => key.paths.has_clipping,
            "effects" => has_uniform,
            "deforms" => key.deforms(),
            "joints" => key.generated.has_joints,
            "morph_targets" => key.generated.has_morph_targets,
            "particle_states" | "step_params" | "particle_step" => key.generated.has_particles,
            "depth_keys" | "triangle_ids" => key.framebuffer_layout() == FramebufferLayout::Split32,
            "depth_and_id" => key.framebuffer_layout() == FramebufferLayout::Packed64,
            "packed" => key.framebuffer_layout() == FramebufferLayout::Packed32,
            "bins" => key.options.visibility == Visibility::Tiled,
            "order" | "sample_counts" | "sums" => key.samples.draw_order.is_some(),
            "shown" | "scaling" => key.is_scaled(),
            "boundary_samples" => key.samples.draw_order == Some(draw_order::Mode::Submission),
            "layers" => key.framebuffer.layers == Some(Layers::Overdraw),
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
        if has_uniform {
            buffers.fill(gpu, "effects", &parameters, wgpu::BufferUsages::UNIFORM, "parameters of the stack")?;
        }
        if key.deforms() && !self.is_shadow_pass {
            let why = "where the bytes of every mesh lie that bends";
            buffers.fill(gpu, "deforms", bytemuck::cast_slice(&deforms.records), STORAGE, why)?;
        }
        if key.generated.has_joints && !self.is_shadow_pass {
            let why = "joints of every skin as they stand: three rows each, or a dual quaternion and a stretch";
            buffers.fill(gpu, "joints", bytemuck::cast_slice(&deforms.joints), STORAGE, why)?;
        }
        if key.generated.has_morph_targets && !self.is_shadow_pass {
            buffers.fill(
                gpu,
                "morph_targets",
                bytemuck::cast_slice(&deforms.morph_targets),
                STORAGE,
                "weights and places of morph targets",
            )?;
        }
        let ranks = if key.samples.draw_order.is_none() { 0 } else { triangles.div_ceil(4) };
        let why = match sample_setups + ranks {
            0 => "projected vertices, 16 bytes each",
            _ => "projected vertices, what sample effects decided, ranks of triangles; 16 bytes a record",
        };
        buffers.ensure(gpu, "vertices", 16 * (first_rank + ranks), STORAGE, why)?;
        if key.samples.draw_order.is_some() {
            let usage = STORAGE | wgpu::BufferUsages::UNIFORM;
            buffers.ensure(gpu, "order", size_of::<OrderRecord>() as u64, usage, "where the drawing stops")?;
            buffers.ensure(gpu, "sample_counts", 4 * triangles, STORAGE, "samples per triangle")?;
            buffers.ensure(gpu, "sums", 8 * triangles.div_ceil(1024), STORAGE, "samples before every block of 1,024 triangles")?;
        }
        if key.samples.draw_order == Some(draw_order::Mode::Submission) {
            buffers.ensure(
                gpu,
                "boundary_samples",
                (view.pixels() as u64).div_ceil(32) * 4,
                STORAGE,
                "samples of one triangle, a bit per pixel",
            )?;
        }
        buffers.ensure(gpu, "counters", size_of::<CounterRecord>() as u64, STORAGE, "queue demand and what was not drawn")?;
        if key.has_queues() {
            buffers.ensure(
                gpu,
                "queues",
                4 * recorded.queue_words(),
                STORAGE,
                "triangles waiting for clip, medium, large and tile kernels",
            )?;
        }
        if key.culls() {
            let meshlet_buffers = self.meshlet_buffers.get_or_insert_with(|| MeshletBuffers::of(&scene));
            buffers.fill_culling(gpu, meshlet_buffers, key.options.culling, (&scene, &draws, view))?;
        }
        if key.has_queues() || key.work.listed_tiles || key.culls() {
            buffers.ensure(gpu, "args", 84, STORAGE | wgpu::BufferUsages::INDIRECT, "dispatch sizes written on the GPU")?;
        }
        if key.paths.has_clipping {
            buffers.ensure(gpu, "pieces", 64 * u64::from(recorded.pieces), STORAGE, "what clipping leaves of a triangle")?;
        }
        let pixels = view.pixels() as u64;
        let (sums, why) = match key.framebuffer.layers {
            Some(Layers::Xray { .. }) => (
                4 * u64::from(key.options.xray_sums.words()) * pixels,
                [
                    "nearest depth key per pixel, 4 bytes, and behind them the sums of its layers",
                    "depth key and triangle id per pixel, 8 bytes, and behind them the sums of its layers",
                    "part of the depth key and triangle id per pixel, 4 bytes, and behind them the sums of its layers",
                ],
            ),
            _ => (
                0,
                [
                    "nearest depth key per pixel, 4 bytes",
                    "depth key and triangle id per pixel, 8 bytes",
                    "part of the depth key and triangle id per pixel, 4 bytes",
                ],
            ),
        };
        if key.framebuffer.layers == Some(Layers::Overdraw) {
            buffers.ensure(gpu, "layers", 4 * pixels, STORAGE, "layers per pixel, 4 bytes")?;
        }
        match key.framebuffer_layout() {
            FramebufferLayout::Split32 => {
                buffers.ensure(gpu, "depth_keys", 4 * pixels + sums, STORAGE, why[0])?;
                if !self.is_shadow_pass {
                    buffers.ensure(gpu, "triangle_ids", 4 * pixels, STORAGE, "triangle id per pixel, 4 bytes")?;
                }
            }
            FramebufferLayout::Packed64 => {
                buffers.ensure(gpu, "depth_and_id", 8 * pixels + sums, STORAGE, why[1])?;
            }
            FramebufferLayout::Packed32 => {
                buffers.ensure(gpu, "packed", 4 * pixels + sums, STORAGE, why[2])?;
            }
        }
        if key.options.visibility == Visibility::Tiled {
            let words = bin_heads(view) + u64::from(recorded.bins);
            buffers.ensure(gpu, "bins", 4 * words, STORAGE, "which triangles each tile of 16 x 16 pixels has to look at")?;
        }
        let tiles = if key.work.listed_tiles { u64::from(view.width.div_ceil(8)) * u64::from(view.height.div_ceil(8)) } else { 0 };
        if self.is_shadow_pass {
            return Ok(plan);
        }
        let picture = 4 * u64::from(color_stride(view.width)) * u64::from(view.height);
        let (behind, why) = match key.effects.dots {
            None => (tiles, "the picture, 4 bytes per pixel, and the list of tiles to resolve"),
            Some(_) => (pixels, "the picture, 4 bytes per pixel, and as many for the strongest dot on each"),
        };
        buffers.ensure(gpu, "color", picture + 4 * behind, STORAGE, why)?;
        if key.is_scaled() {
            let [width, height] = self.shown;
            let scaling = ScalingUniform { size: self.shown, stride: color_stride(width), spare: 0 };
            buffers.fill(gpu, "scaling", bytemuck::bytes_of(&scaling), wgpu::BufferUsages::UNIFORM, "size of what is shown")?;
            let bytes = 4 * u64::from(color_stride(width)) * u64::from(height);
            buffers.ensure(gpu, "shown", bytes, STORAGE, "the picture at the size that is shown, 4 bytes per pixel")?;
        }
        if key.work.listed_tiles {
            buffers.ensure(gpu, "tile_mask", 4 * tiles, STORAGE, "which 8 x 8 tiles the resolve must visit")?;
        }
        if key.reads_previous() {
            buffers.ensure(gpu, "previous", picture, STORAGE, "the picture before this one, which an effect keeps")?;
        }
        if key.work.listed_tiles || key.reads_previous() {
            let rows = background_word(view).repeat((color_stride(view.width) * BACKGROUND_ROWS) as usize);
            buffers.fill(gpu, "background", &rows, STORAGE, "a few rows of background, copied all over the picture first")?;
        }
        self.prepare_dots(view, stack, &plan.key)?;
        Ok(plan)
    }
}

impl Renderer {
    /// Uploads the bytes of all attributes with room for what lies behind them, and positions in `bits` an axis if any.
    pub(super) fn hold_attributes(&mut self, scene: &Scene, bits: Option<u32>) -> Result<(), RenderError> {
        let first = attribute_bytes(scene);
        let packing = bits.map(|bits| (bits, Packing::new(scene, bits)));
        let room = first + bits.map_or(0, |bits| bytes_of(scene, bits));
        let why = match (scene.deformable_vertex_count(), bits) {
            (0, None) => "attributes as the file has them",
            (0, Some(10)) => "attributes as the file has them, and behind them packed positions, 4 bytes each",
            (0, Some(_)) => "attributes as the file has them, and behind them packed positions, 8 bytes each",
            _ => "attributes as the file has them, and behind them bent vertices, 24 bytes each",
        };
        let usage = STORAGE | wgpu::BufferUsages::VERTEX;
        self.buffers.keep(|name| name != "vertex_bytes");
        self.packed = None;
        self.buffers.fill_room(&self.gpu, "vertex_bytes", &scene.vertex_bytes, room, usage, why)?;
        if let Some((_, packing)) = &packing {
            self.gpu.queue.write_buffer(self.buffers.get("vertex_bytes"), first, bytemuck::cast_slice(&packing.words));
        }
        // Where each lies is all that is needed from now on.
        self.packed = packing.map(|(bits, packing)| (bits, Packing { words: Vec::new(), ..packing }));
        Ok(())
    }
}

/// Bytes of the file's attributes and of every vertex that may bend.
fn attribute_bytes(scene: &Scene) -> u64 {
    scene.vertex_bytes.len() as u64 + u64::from(DEFORMED_BYTES) * scene.deformable_vertex_count()
}

/// Projected records of so many vertices and triangles: one per vertex of each draw, or three per triangle where effects part them.
pub fn record_count(key: &KernelKey, [vertices, triangles]: [u64; 2]) -> u64 {
    if key.unshares_vertices() { 3 * triangles } else { vertices }
}

/// Rows that the background buffer holds.
pub const BACKGROUND_ROWS: u32 = 32;

/// The background as the resolve would pack it.
fn background_word(view: &View) -> [u8; 4] {
    let [r, g, b, alpha] = view.background.map(f64::from);
    [srgb_byte(r), srgb_byte(g), srgb_byte(b), (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8]
}

/// Words before the lists of triangles: two for each tile of 16 x 16 pixels.
pub fn bin_heads(view: &View) -> u64 {
    2 * u64::from(view.width.div_ceil(16)) * u64::from(view.height.div_ceil(16))
}

/// Capacities of the queues that this key's passes have; 0 where a pass is left out.
pub fn recorded_capacities(key: &KernelKey, all: &Capacities) -> Capacities {
    let kept = |is_there: bool, capacity: u32| if is_there { capacity } else { 0 };
    Capacities {
        clip: kept(key.paths.has_clipping, all.clip),
        pieces: kept(key.paths.has_clipping, all.pieces),
        medium: kept(key.paths.has_medium, all.medium),
        large: kept(key.paths.has_large, all.large),
        tiles: kept(key.paths.has_large, all.tiles),
        bins: kept(key.options.visibility == Visibility::Tiled, all.bins),
        listed: kept(key.options.visibility == Visibility::Tiled, all.listed.max(key.work.max_list_entries)),
    }
}

/// Room for an ordinary picture of the scene; demand beyond it grows the queues and draws again.
pub fn first_capacities(scene: &Scene) -> Capacities {
    let triangles = scene.triangle_count().min(u64::from(u32::MAX)) as u32;
    let room = |most: u32| triangles.clamp(16, most).next_power_of_two();
    Capacities {
        clip: room(4096),
        pieces: 2 * room(4096),
        medium: room(65_536),
        large: room(16_384),
        tiles: 16 * room(4096),
        bins: 4 * triangles.clamp(1024, 1 << 20),
        listed: 0,
    }
}
