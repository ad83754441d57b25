//! The layout of a frame, computed once from the kernel key, the scene's counts, the size of the
//! picture and the capacity of the queues: which buffers it has and how large they are, what lies
//! where in them, and which bytes are cleared. Buffers, uniforms, passes and readback all go by it.

use std::{collections::BTreeMap, ops::Range};

use super::{
    glass::{COMPOSED_BYTES, GlassRecord, HEAD_BYTES, OPAQUE_BYTES, band_length, layer_bytes},
    queues::Capacities,
    records::{
        ClippedTriangleRecord, CounterRecord, CullingUniform, DeformRecord, DispatchArgs,
        DispatchSize, DotFrame, DotPoints, DotRunRecord, DrawRecord, DrawShapeRecord, FrameUniform,
        InstanceRecord, InstancedDrawRecord, MeshletRecord, MorphTargetRecord, OrderRecord,
        PunctualLights, ScalingUniform, VertexRecord,
    },
    resource_id::{BufferId, ClearedBy},
};
use crate::{
    accuracy::{Culling, DotCulling},
    effects::{draw_order::Mode, hooks::Layers},
    math::rounded_columns,
    scene::{model::MOST_SHAPES, view::View},
    shader::{
        image_passes::IMAGE_SLOTS,
        key::{FramebufferLayout, KernelKey},
    },
};

/// For whom a view is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The picture that is shown.
    Picture,
    /// Depths alone, as a light sees the scene.
    ShadowMap,
    /// Geometry, counters and layers of all triangles, for the judge of a culled picture.
    Judge,
}

/// What is drawn, in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneCounts {
    /// Vertices of all draws of which a pass writes records.
    pub vertices: u64,
    /// Triangles of all draws.
    pub triangles: u64,
    /// Of those, points.
    pub points: u64,
    /// Blocks of points.
    pub point_blocks: u32,
    /// Word of the attributes at which the boxes of these begin.
    pub first_box: u32,
    pub draws: u64,
    /// Vertices in all draws that joints or morph targets can deform; the dispatch size of
    /// `deform`.
    pub deformable: u32,
    /// Deformed draws: one record each.
    pub deforms: u64,
    /// Vectors of four floats that hold the joint transforms.
    pub joint_vectors: u64,
    /// Morph targets of all deformed draws whose weight is not 0: one record each.
    pub morph_targets: u64,
    /// Meshlets of all instances.
    pub meshlets: u32,
    /// Meshlets of all primitives: one record each.
    pub meshlet_records: u64,
    /// Words that list the triangles and vertices of all primitives' meshlets.
    pub meshlet_words: u32,
    pub particles: u32,
}

/// Dots of a picture, in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DotCounts {
    pub dots: u32,
    pub runs: u32,
    pub segments: u32,
    /// Bytes that hold the ends of all segments.
    pub segment_bytes: u64,
    /// Dots that the CPU chose, where it does.
    pub chosen: u32,
}

/// Everything that a layout follows from.
#[derive(Clone, Debug)]
pub struct LayoutInputs<'a> {
    pub key: &'a KernelKey,
    pub target: Target,
    /// Width and height that are drawn, pixels.
    pub size: [u32; 2],
    /// Width and height that are shown, pixels.
    pub shown: [u32; 2],
    /// The background has a color for every row.
    pub has_gradient: bool,
    pub scene: SceneCounts,
    pub dots: Option<DotCounts>,
    /// Bytes of the effects' parameters; 0 where no uniform carries them.
    pub effect_bytes: u64,
    /// Capacity of the queues that the key's passes have.
    pub capacities: Capacities,
}

/// A part of a buffer that holds one thing where the buffer holds several, one behind the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Region {
    /// What a frame counts.
    Counts,
    /// The farthest key of every block of pixels that hides what lies behind it; behind the counts.
    HiddenBlocks,
    /// Projected vertices.
    VertexRecords,
    /// What sample effects and masks set up per triangle; behind the vertex records.
    SampleSetups,
    /// The rank of every triangle in a draw order; behind the sample setups.
    TriangleRanks,
    /// Depths and triangle ids of the nearest samples.
    Nearest,
    /// The sums of the x-ray; behind the nearest samples.
    XraySums,
    /// The heads of the lists of layers of glass of a band; behind the nearest samples.
    GlassHeads,
    /// What a frame counts of these layers.
    GlassCounts,
    /// The opaque triangle of every pixel.
    GlassOpaque,
    /// The layers; behind all of these.
    GlassLayers,
    /// The picture.
    Pixels,
    /// Tiles that the resolve visits; behind the picture.
    TileList,
    /// What the layers of glass of each pixel compose to; behind the list of tiles.
    GlassComposed,
    /// The strongest dot on every pixel; behind the picture.
    DotStrengths,
    /// A color for every row of a gradient; behind all else of the picture.
    BackgroundRows,
    ClipQueue,
    MediumQueue,
    LargeQueue,
    TileQueue,
    /// Triangles and vertices of all meshlets.
    MeshletWords,
    /// The visible meshlets; behind the words.
    VisibleMeshlets,
    /// Farthest depth of every tile of 8 x 8 pixels.
    HizTiles,
    /// Farthest depth of every block of 64 x 64 pixels; behind the tiles.
    HizBlocks,
}

/// Where a region lies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    pub buffer: BufferId,
    pub bytes: Range<u64>,
}

/// A buffer of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BufferSpec {
    pub bytes: u64,
    /// What it holds, for `explain`.
    pub purpose: &'static str,
    /// Bytes that are filled with zeros when [`BufferId::cleared_by`] says.
    pub cleared: Range<u64>,
}

/// Bytes of a word.
pub(super) const WORD: u64 = 4;
/// Bytes of an entry in the queue of tiles.
const TILE_ENTRY: u64 = 8;
/// Bytes of a visible meshlet.
const VISIBLE_MESHLET: u64 = 16;

/// Bytes of a pixel in linear light.
const LINEAR_PIXEL: u64 = 16;

/// The pictures that image passes read and write by turns, then the one that a kept pass writes.
pub const IMAGE_BUFFERS: [BufferId; IMAGE_SLOTS + 1] = [
    BufferId::ImageSource,
    BufferId::ImageBefore,
    BufferId::ImageTarget,
    BufferId::ImageKept,
];

/// Side of a tile of the resolve, which can be dispatched over listed tiles alone; pixels.
pub(super) const RESOLVE_TILE: u32 = 8;
/// Side of a block of pixels that hides what lies behind it, pixels.
const HIDDEN_BLOCK: u32 = 8;
/// Side of a block of Hi-Z depths, pixels.
pub(super) const HIZ_BLOCK: u32 = 64;

/// Triangles whose samples are added up by one workgroup.
pub(super) const ORDER_BLOCK: u64 = 1024;

/// Pixels from one row of the color buffer to the next: rows begin at multiples of 256 bytes, as
/// texture copies demand.
pub fn color_stride(width: u32) -> u32 {
    width.next_multiple_of(64)
}

/// What the first pass of a frame may clear beside its own work: `shaders/variants/clear_step`.
const CLEARED_IN_PASSES: &[BufferId] = &[
    BufferId::Counters,
    BufferId::DepthKeys,
    BufferId::TriangleIds,
    BufferId::DepthAndId,
    BufferId::PackedDepthId,
];
/// Rows of a background of one color that are kept, to be copied all over the picture.
const BACKGROUND_ROWS: u32 = 32;

/// The layout of a frame: its buffers, their regions and cleared bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameLayout {
    buffers: BTreeMap<BufferId, BufferSpec>,
    regions: BTreeMap<Region, Span>,
    pub target: Target,
    pub size: [u32; 2],
    pub shown: [u32; 2],
    pub has_gradient: bool,
    pub scene: SceneCounts,
    pub dots: Option<DotCounts>,
    /// Capacity of the queues that the key's passes have.
    pub capacities: Capacities,
}

impl FrameLayout {
    pub fn new(inputs: &LayoutInputs<'_>) -> Self {
        let LayoutInputs {
            key,
            target,
            size,
            shown,
            has_gradient,
            scene,
            dots,
            effect_bytes,
            capacities,
        } = inputs.clone();
        let (buffers, regions) = (BTreeMap::new(), BTreeMap::new());
        let mut layout = Self {
            buffers,
            regions,
            target,
            size,
            shown,
            has_gradient,
            scene,
            dots,
            capacities,
        };
        layout.add_uniforms(key, effect_bytes);
        layout.add_geometry(key);
        layout.add_queues(key);
        if key.culls() {
            layout.add_culling(key);
        }
        if key.samples.draw_order.is_some() {
            layout.add_draw_order(key);
        }
        layout.add_visibility(key);
        if target == Target::Picture {
            layout.add_picture(key);
            layout.add_dots(key);
        }
        if key.work.clears_in_passes {
            CLEARED_IN_PASSES
                .iter()
                .for_each(|&id| layout.clear_only(id, None));
        }
        if let Some(span) = layout.region(Region::GlassCounts)
            && key.work.clears_in_passes
        {
            layout.clear_only(span.buffer, Some(Region::GlassCounts));
        }
        if key.work.clears_order {
            [BufferId::SampleCounts, BufferId::BoundarySamples]
                .into_iter()
                .for_each(|id| layout.clear_only(id, None));
        }
        layout
    }

    /// Every buffer of the frame.
    pub fn buffers(&self) -> impl Iterator<Item = (BufferId, &BufferSpec)> {
        self.buffers.iter().map(|(id, spec)| (*id, spec))
    }

    pub fn has(&self, id: BufferId) -> bool {
        self.buffers.contains_key(&id)
    }

    /// Where a region lies; none where the frame has no such region.
    pub fn region(&self, region: Region) -> Option<&Span> {
        self.regions.get(&region)
    }

    /// First byte of a region within its buffer; 0 where there is none.
    fn first_byte(&self, region: Region) -> u64 {
        self.region(region).map_or(0, |span| span.bytes.start)
    }

    /// First word of a region within its buffer; 0 where there is none.
    pub fn first_word(&self, region: Region) -> u32 {
        (self.first_byte(region) / WORD) as u32
    }

    /// First record of 16 bytes of a region within its buffer; 0 where there is none.
    pub fn first_record(&self, region: Region) -> u32 {
        (self.first_byte(region) / size_of::<VertexRecord>() as u64) as u32
    }

    /// What is cleared on an occasion.
    pub fn cleared(
        &self,
        occasion: impl Fn(ClearedBy) -> bool,
    ) -> impl Iterator<Item = (BufferId, Range<u64>)> {
        let cleared = self
            .buffers
            .iter()
            .filter(move |(id, spec)| occasion(id.cleared_by()) && !spec.cleared.is_empty());
        cleared.map(|(id, spec)| (*id, spec.cleared.clone()))
    }

    pub(super) fn pixels(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// Tiles of `side` pixels a side, over the width and the height.
    pub(super) fn tiles(&self, side: u32) -> [u32; 2] {
        self.size.map(|pixels| pixels.div_ceil(side))
    }

    pub(super) fn tile_count(&self, side: u32) -> u64 {
        self.tiles(side).map(u64::from).iter().product()
    }

    fn add(&mut self, id: BufferId, bytes: u64) {
        let cleared = if id.cleared_by() == ClearedBy::Nothing {
            0..0
        } else {
            0..bytes
        };
        self.buffers.insert(
            id,
            BufferSpec {
                bytes,
                purpose: id.purpose(),
                cleared,
            },
        );
    }

    /// A buffer of so many records.
    fn add_records<Record>(&mut self, id: BufferId, count: u64) {
        self.add(id, count * size_of::<Record>() as u64);
    }

    /// A buffer of regions of so many bytes, one behind the other.
    fn add_regions(&mut self, id: BufferId, regions: &[(Region, u64)]) {
        let mut end = 0;
        for &(region, bytes) in regions {
            self.regions.insert(
                region,
                Span {
                    buffer: id,
                    bytes: end..end + bytes,
                },
            );
            end += bytes;
        }
        self.add(id, end);
    }

    fn describe(&mut self, id: BufferId, purpose: &'static str) {
        if let Some(spec) = self.buffers.get_mut(&id) {
            spec.purpose = purpose;
        }
    }

    /// Clears nothing but one region of a buffer.
    fn clear_only(&mut self, id: BufferId, region: Option<Region>) {
        let cleared = region
            .and_then(|region| self.region(region))
            .map_or(0..0, |span| span.bytes.clone());
        if let Some(spec) = self.buffers.get_mut(&id) {
            spec.cleared = cleared;
        }
    }

    fn add_uniforms(&mut self, key: &KernelKey, effect_bytes: u64) {
        self.add_records::<FrameUniform>(BufferId::Frame, 1);
        if effect_bytes > 0 {
            self.add(BufferId::Effects, effect_bytes);
        }
        if key.surface.lights > 0 {
            self.add_records::<PunctualLights>(BufferId::PunctualLights, 1);
        }
        // The array at the end of the struct has at least one element, and the buffer whole records
        // of 16 bytes.
        let blocks = if key.hides_blocks() {
            self.tile_count(HIDDEN_BLOCK).next_multiple_of(4)
        } else {
            4
        };
        self.add_regions(
            BufferId::Counters,
            &[
                (Region::Counts, size_of::<CounterRecord>() as u64),
                (Region::HiddenBlocks, WORD * blocks),
            ],
        );
        if key.is_scaled() && self.target == Target::Picture {
            self.add_records::<ScalingUniform>(BufferId::Scaling, 1);
        }
    }

    fn add_geometry(&mut self, key: &KernelKey) {
        let scene = self.scene;
        // A binding needs at least one element, even for an empty scene.
        let draw = if key.vertices.is_instanced {
            let shapes = MOST_SHAPES * size_of::<DrawShapeRecord>();
            self.add(BufferId::Shapes, shapes as u64);
            size_of::<InstancedDrawRecord>()
        } else {
            size_of::<DrawRecord>()
        };
        self.add(BufferId::Draws, scene.draws.max(1) * draw as u64);
        if key.vertices.is_instanced {
            self.describe(
                BufferId::Draws,
                "matrix and first vertex and triangle, one record per instance",
            );
        }
        // The shadow map reuses the deformed vertices of the picture.
        if self.target != Target::ShadowMap {
            if key.deforms() {
                self.add_records::<DeformRecord>(BufferId::Deforms, scene.deforms);
            }
            if key.generated.has_joints {
                self.add_records::<[f32; 4]>(BufferId::Joints, scene.joint_vectors);
            }
            if key.generated.has_morph_targets {
                self.add_records::<MorphTargetRecord>(
                    BufferId::MorphTargets,
                    scene.morph_targets.max(1),
                );
            }
        }
        let record = size_of::<VertexRecord>() as u64;
        let setups = u64::from(key.sample_setups())
            * (scene.triangles + u64::from(self.capacities.clipped_triangles));
        let ranks = if key.samples.draw_order.is_none() {
            0
        } else {
            scene.triangles.div_ceil(4)
        };
        self.add_regions(
            BufferId::Vertices,
            &[
                (Region::VertexRecords, record * vertex_records(key, &scene)),
                (Region::SampleSetups, record * setups),
                (Region::TriangleRanks, record * ranks),
            ],
        );
        if setups + ranks > 0 {
            self.describe(BufferId::Vertices, "projected vertices, setups of sample effects, ranks of triangles; 16 bytes a record");
        }
    }

    fn add_queues(&mut self, key: &KernelKey) {
        let room = self.capacities;
        if key.has_queues() {
            self.add_regions(
                BufferId::Queues,
                &[
                    (Region::ClipQueue, WORD * u64::from(room.clip)),
                    (Region::MediumQueue, WORD * u64::from(room.medium)),
                    (Region::LargeQueue, WORD * u64::from(room.large)),
                    (Region::TileQueue, TILE_ENTRY * u64::from(room.tiles)),
                ],
            );
        }
        if key.has_queues() || key.work.listed_tiles || key.culls() {
            self.add_records::<DispatchArgs>(BufferId::DispatchArgs, 1);
        }
        if key.paths.has_clipping {
            self.add(
                BufferId::ClippedTriangles,
                u64::from(room.clipped_triangles) * size_of::<ClippedTriangleRecord>() as u64,
            );
        }
    }

    fn add_culling(&mut self, key: &KernelKey) {
        let (draws, meshlets) = (self.scene.draws.max(1), u64::from(self.scene.meshlets));
        self.add_records::<CullingUniform>(BufferId::Culling, 1);
        self.add_records::<InstanceRecord>(BufferId::Instances, draws);
        self.add_records::<MeshletRecord>(BufferId::Meshlets, self.scene.meshlet_records);
        let words = WORD * u64::from(self.scene.meshlet_words);
        self.add_regions(
            BufferId::MeshletLists,
            &[
                (Region::MeshletWords, words),
                (Region::VisibleMeshlets, VISIBLE_MESHLET * meshlets),
            ],
        );
        if key.options.culling == Culling::TwoPass {
            self.add(BufferId::MeshletVisibility, WORD * meshlets);
        }
        let blocks = self.tile_count(HIZ_BLOCK);
        let tiles = blocks * u64::from(HIZ_BLOCK / RESOLVE_TILE).pow(2);
        if key.options.culling.occludes() {
            self.add_regions(
                BufferId::Hiz,
                &[
                    (Region::HizTiles, WORD * tiles),
                    (Region::HizBlocks, WORD * blocks),
                ],
            );
        }
    }

    fn add_draw_order(&mut self, key: &KernelKey) {
        let triangles = self.scene.triangles;
        self.add_records::<OrderRecord>(BufferId::DrawOrder, 1);
        self.add(BufferId::SampleCounts, WORD * triangles);
        self.add(
            BufferId::BlockSums,
            2 * WORD * triangles.div_ceil(ORDER_BLOCK),
        );
        if key.samples.draw_order == Some(Mode::Submission) {
            // A bit for every pixel, and the first and last word that have any.
            self.add(
                BufferId::BoundarySamples,
                WORD * (self.pixels().div_ceil(32) + 2),
            );
        }
    }

    /// Depths, triangle ids and layers of every pixel.
    fn add_visibility(&mut self, key: &KernelKey) {
        let pixels = self.pixels();
        let is_summed = matches!(key.framebuffer.layers, Some(Layers::Xray { .. }));
        let sums = if is_summed {
            WORD * u64::from(key.sum_words()) * pixels
        } else {
            0
        };
        let (nearest, words, with_sums) = match key.framebuffer_layout() {
            FramebufferLayout::Split32 => (
                BufferId::DepthKeys,
                1,
                "nearest depth key per pixel, 4 bytes, then the sums of its layers",
            ),
            FramebufferLayout::Packed64 => (
                BufferId::DepthAndId,
                2,
                "depth key and triangle id per pixel, 8 bytes, then the sums of its layers",
            ),
            FramebufferLayout::Packed32 => (
                BufferId::PackedDepthId,
                1,
                "part of the depth key and triangle id per pixel, 4 bytes, then the sums of its layers",
            ),
        };
        self.add_regions(
            nearest,
            &[
                (Region::Nearest, words * WORD * pixels),
                (Region::XraySums, sums),
            ],
        );
        if is_summed {
            self.describe(nearest, with_sums);
        }
        if key.has_glass() && self.target != Target::ShadowMap {
            self.add_glass(key, nearest, words * WORD * pixels);
        }
        if key.framebuffer_layout() == FramebufferLayout::Split32
            && self.target != Target::ShadowMap
        {
            self.add(BufferId::TriangleIds, WORD * pixels);
        }
        if key.work.listed_tiles {
            self.add(BufferId::TileMask, WORD * self.tile_count(RESOLVE_TILE));
        }
        if key.framebuffer.layers == Some(Layers::Overdraw) {
            self.add(BufferId::LayerCounts, WORD * pixels);
        }
    }

    /// The layers of glass behind the nearest samples, which take so many bytes. Layers are written
    /// before they are read.
    fn add_glass(&mut self, key: &KernelKey, nearest: BufferId, nearest_bytes: u64) {
        let (pixels, counts) = (self.pixels(), size_of::<GlassRecord>() as u64);
        let heads = HEAD_BYTES * band_length(pixels, key.framebuffer.glass_bands);
        self.add_regions(
            nearest,
            &[
                (Region::Nearest, nearest_bytes),
                (Region::GlassHeads, heads),
                (Region::GlassCounts, counts),
                (Region::GlassOpaque, OPAQUE_BYTES * pixels),
                (Region::GlassLayers, layer_bytes(self.capacities.glass)),
            ],
        );
        self.describe(
            nearest,
            "depth and triangle of the nearest sample per pixel, 4 bytes per pixel for the opaque one and 4 per pixel of a band for the list of its layers of glass, then the layers of a band, 24 bytes each",
        );
        if let Some(spec) = self.buffers.get_mut(&nearest) {
            spec.cleared = 0..nearest_bytes + heads + counts;
        }
    }

    /// The picture, and what its resolve reads and writes.
    fn add_picture(&mut self, key: &KernelKey) {
        let rows =
            |[width, height]: [u32; 2]| WORD * u64::from(color_stride(width)) * u64::from(height);
        let picture = rows(self.size);
        let tiles = if key.work.listed_tiles || key.has_glass() {
            WORD * self.tile_count(RESOLVE_TILE)
        } else {
            0
        };
        let gradient = if self.has_gradient {
            vec![(Region::BackgroundRows, WORD * u64::from(self.size[1]))]
        } else {
            Vec::new()
        };
        let has_dots = key.effects.dots.is_some();
        let strengths = if has_dots { WORD * self.pixels() } else { 0 };
        let composed = if key.has_glass() {
            COMPOSED_BYTES * self.pixels()
        } else {
            0
        };
        let regions = [
            (Region::Pixels, picture),
            (Region::DotStrengths, strengths),
            (Region::TileList, tiles),
            (Region::GlassComposed, composed),
        ];
        self.add_regions(BufferId::Color, &[&regions[..], &gradient].concat());
        let purpose = match (has_dots, key.has_glass()) {
            (false, false) => "the picture, 4 bytes per pixel, and the list of tiles to resolve",
            (true, false) => {
                "the picture, 4 bytes per pixel, as many for the strongest dot on each, and the list of tiles to resolve"
            }
            (false, true) => {
                "the picture, 4 bytes per pixel, the list of tiles to resolve, and 12 bytes per pixel for what its layers of glass compose to"
            }
            (true, true) => {
                "the picture, 4 bytes per pixel, as many for the strongest dot on each, the list of tiles to resolve, and 12 bytes per pixel for what its layers of glass compose to"
            }
        };
        self.describe(BufferId::Color, purpose);
        self.clear_only(BufferId::Color, has_dots.then_some(Region::DotStrengths));
        for &slot in IMAGE_BUFFERS.iter().take(key.image_slots()) {
            self.add(slot, LINEAR_PIXEL * self.pixels());
        }
        if let Some(pass) = key.kept_pass() {
            let [width, height] = pass.size(self.size).map(u64::from);
            for buffer in [BufferId::ImageKept, BufferId::ImageKeptBefore] {
                self.add(buffer, LINEAR_PIXEL * width * height);
            }
        }
        if key.has_passes() {
            self.add(BufferId::Finished, picture);
        }
        if key.is_scaled() {
            self.add(BufferId::ScaledColor, rows(self.shown));
        }
        if key.reads_previous() {
            self.add(BufferId::Previous, picture);
        }
        if key.keeps_background() || key.reads_previous() {
            self.add(
                BufferId::Background,
                rows([self.size[0], self.background_rows()]),
            );
        }
    }

    /// Rows of the background that are kept, to be copied all over the picture.
    pub fn background_rows(&self) -> u32 {
        if self.has_gradient {
            self.size[1]
        } else {
            BACKGROUND_ROWS
        }
    }

    fn add_dots(&mut self, key: &KernelKey) {
        let Some(dots) = self.dots else { return };
        self.add_records::<DotFrame>(BufferId::DotFrame, 1);
        self.add(
            BufferId::DotSegments,
            dots.segment_bytes.max(size_of::<DotPoints>() as u64),
        );
        self.add(
            BufferId::DotRuns,
            u64::from(dots.runs.max(1)) * size_of::<DotRunRecord>() as u64,
        );
        self.add(
            BufferId::DotEnds,
            u64::from(dots.segments) * size_of::<DotPoints>() as u64,
        );
        if key.options.dot_culling != DotCulling::Brute {
            // The capacity is the number of all dots, so the list never overflows.
            self.add(
                BufferId::DotList,
                u64::from(dots.dots) * size_of::<[u32; 2]>() as u64,
            );
            self.add(BufferId::DotCount, WORD);
        }
        if key.options.dot_culling == DotCulling::Gpu {
            self.add_records::<DispatchSize>(BufferId::DotArgs, 1);
        } else {
            // The CPU writes the number of dots.
            self.clear_only(BufferId::DotCount, None);
        }
    }

    /// The frame uniform of a picture of `view`.
    pub fn frame_uniform(&self, view: &View, point_radius: u32) -> FrameUniform {
        let room = &self.capacities;
        FrameUniform {
            vertex_count: self.first_record(Region::SampleSetups),
            triangle_count: self.scene.triangles as u32,
            point_count: self.scene.points as u32,
            first_box: self.scene.first_box,
            draw_count: self.scene.draws as u32,
            clip_capacity: room.clip,
            clipped_triangle_capacity: room.clipped_triangles,
            medium_capacity: room.medium,
            large_capacity: room.large,
            tile_capacity: room.tiles,
            medium_first: self.first_word(Region::MediumQueue),
            large_first: self.first_word(Region::LargeQueue),
            tile_first: self.first_word(Region::TileQueue),
            point_radius,
            first_rank: self.first_record(Region::TriangleRanks),
            deform_count: self.scene.deforms as u32,
            background_first: self.first_word(Region::BackgroundRows),
            ..FrameUniform::of_view(view)
        }
    }

    /// The culling uniform.
    pub fn culling_uniform(&self) -> CullingUniform {
        CullingUniform {
            meshlet_count: self.scene.meshlets,
            first_visible: self.first_word(Region::VisibleMeshlets),
            hiz_width: self.tiles(HIZ_BLOCK)[0] * (HIZ_BLOCK / RESOLVE_TILE),
            hiz_first_block: self.first_word(Region::HizBlocks),
        }
    }
}

/// Projected records: one per vertex of each draw, or three per triangle where effects move
/// triangles apart; none of points that are projected as they are drawn.
pub(super) fn vertex_records(key: &KernelKey, scene: &SceneCounts) -> u64 {
    if key.samples.only_points && key.work.projects_points {
        0
    } else if key.unshares_vertices() {
        3 * scene.triangles
    } else {
        scene.vertices
    }
}

impl FrameUniform {
    /// Size and viewpoint of a picture; what its layout adds is 0.
    pub fn of_view(view: &View) -> Self {
        let is_perspective = view.linear_depth_m.is_none();
        let wide = |v: glam::DVec3, w: f32| [v.x as f32, v.y as f32, v.z as f32, w];
        Self {
            background: view
                .background
                .row(0, view.height)
                .map(|byte| f32::from(byte) / 255.0),
            eye: wide(view.eye, f32::from(u8::from(is_perspective))),
            forward: wide(view.forward, 0.0),
            ndc_x: wide(view.ndc_axes[0], 0.0),
            ndc_y: wide(view.ndc_axes[1], 0.0),
            clip_from_world: rounded_columns(&view.clip_from_world),
            picture_from_world: rounded_columns(
                &view.picture_from_world.unwrap_or(view.clip_from_world),
            ),
            center: [view.width, view.height]
                .map(|pixels| (pixels as i32 * view.units_per_pixel() / 2) as f32),
            depth_range_m: view.content_depth_m.map(|d| d as f32),
            linear_depth_m: view.linear_depth_m.unwrap_or_default().map(|d| d as f32),
            size: [view.width, view.height],
            stride: color_stride(view.width),
            ..Self::default()
        }
    }
}
