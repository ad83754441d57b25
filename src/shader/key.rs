//! The kernel key: everything that decides which shader text runs and with which constants. Equal keys, equal pipelines.

use std::fmt;

use crate::{
    accuracy::{
        AccuracyOptions, Clipping, Coverage, Culling, DepthFormat, DotCulling, Perspective, PositionFormat, RenderScale, VertexTransform,
        Visibility,
    },
    effects::{
        Effect, EnabledEffect, Stack,
        dots::LineSource,
        draw_order::Mode,
        hooks::{Layers, Shape},
        shadow::MAX_SHADOW_SLOPE,
    },
    frame::{NO_TRIANGLE, vertex_flags},
    scene::meshlets::MESHLET_TRIANGLES,
};

pub use super::pass::{CullPhase, Pass, RasterPhase, TriangleSource};

/// How corners find their vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fetch {
    Direct,
    Indexed,
}

/// How depth and triangle id of the pixels lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layout {
    /// A buffer of keys and one of complemented triangle ids.
    Split,
    /// One word for both.
    Word,
    /// Complemented triangle id and key side by side.
    Pairs,
}

/// Which samples are drawn, if not all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Order {
    Free,
    /// The first ones in the order of triangles.
    Submission,
    /// The first that the hardware comes to.
    Scheduler,
}

impl Order {
    /// The order that a stack keeps.
    pub fn of(stack: &Stack) -> Self {
        match stack.draw_order().map(|order| Mode::of(order.mode)) {
            None => Self::Free,
            Some(Mode::Submission) => Self::Submission,
            Some(Mode::Scheduler) => Self::Scheduler,
        }
    }
}

/// See the module's first line.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct KernelKey {
    pub fetch: Fetch,
    /// A option on every accuracy axis.
    pub options: AccuracyOptions,
    /// What an effect makes of the samples of a pixel; without one the nearest is shown.
    pub layers: Option<Layers>,
    /// Effects in stack order.
    pub effects: Vec<&'static Effect>,
    /// Parameters of each that stand in the text; empty where a uniform brings them.
    pub baked: Vec<Vec<u32>>,
    /// What a triangle covers.
    pub shape: Shape,
    /// Which samples are drawn.
    pub order: Order,
    /// What dots are strung on, if there are any.
    pub dots: Option<LineSource>,
    /// A sample effect may leave samples out.
    pub has_samples: bool,
    /// Records that are settled per triangle: one of every sample effect that does, and [`MASK_SETUPS`] of a mask.
    pub sample_setups: u32,
    /// Some triangle may need clipping.
    pub has_clipping: bool,
    /// Some triangle may be wider than one invocation's share.
    pub has_medium: bool,
    /// Some triangle may exceed 128 px.
    pub has_large: bool,
    pub single_draw: bool,
    pub only_triangle_lists: bool,
    pub u32_indices: bool,
    pub f32_positions: bool,
    pub f32_normals: bool,
    pub has_colors: bool,
    /// Some material is more than a base colour.
    pub has_texels: bool,
    /// The alpha of an image leaves samples out.
    pub has_mask: bool,
    /// Some mesh is held by joints.
    pub has_joints: bool,
    /// Some mesh is mixed from shapes.
    pub has_morph_targets: bool,
    /// Particles fly.
    pub has_particles: bool,
    /// The resolve computes plane normals and triangle centres: an effect reads them, or a normal may need a substitute.
    pub has_planes: bool,
    /// w is metres; else depth is linear and w is 1.
    pub perspective: bool,
    /// Most candidate samples that one invocation walks.
    pub max_small_samples: u32,
    /// Most pixels per side of such a box.
    pub max_small_side: u32,
    /// Among how many invocations the discs of one triangle are shared out, at least 1.
    pub invocations_per_triangle: u32,
    /// Most entries of a tile's list that one dispatch walks.
    pub max_list_entries: u32,
    /// The resolve visits only tiles that a triangle's box touches, without branches.
    pub listed_tiles: bool,
    /// Invocations in a workgroup of the passes over vertices and triangles.
    pub group_size: u32,
    /// Load before the depth atomic.
    pub early_load: bool,
    /// A light looks, not the eye: effects ask where things stand in the picture for which it does.
    pub is_light: bool,
    /// Bits of a triangle's id where it shares a word with its depth, else 0.
    pub id_bits: u32,
}

/// Records that a mask settles per triangle: where its corners lie in the image.
pub const MASK_SETUPS: u32 = 2;

/// Effects that settle something per triangle.
pub fn deciding(effects: &[&'static Effect]) -> u32 {
    effects.iter().filter(|effect| effect.hooks.sample.is_some_and(|hook| hook.has_setup)).count() as u32
}

impl KernelKey {
    /// A key that leaves nothing out, for a stack on a portable adapter: where every path of the text is wanted.
    pub fn whole(fetch: Fetch, visibility: Visibility, effects: Vec<&'static Effect>) -> Self {
        Self {
            fetch,
            options: AccuracyOptions { visibility, ..AccuracyOptions::default() },
            layers: Stack(effects.iter().map(|effect| EnabledEffect::new(effect)).collect()).layers(u64::MAX),
            shape: Shape::Triangles,
            order: Order::Free,
            dots: effects.iter().any(|effect| effect.hooks.has_lines).then_some(LineSource::Edges),
            has_samples: effects.iter().any(|effect| effect.hooks.sample.is_some()),
            sample_setups: deciding(&effects),
            effects,
            baked: Vec::new(),
            has_clipping: true,
            has_medium: true,
            has_large: true,
            single_draw: false,
            only_triangle_lists: false,
            u32_indices: false,
            f32_positions: false,
            f32_normals: false,
            has_colors: true,
            has_texels: true,
            has_mask: false,
            has_joints: true,
            has_morph_targets: true,
            has_particles: true,
            has_planes: true,
            perspective: true,
            max_small_samples: 64,
            max_small_side: 32,
            invocations_per_triangle: 1,
            max_list_entries: u32::MAX,
            listed_tiles: true,
            group_size: 64,
            early_load: true,
            is_light: false,
            id_bits: if visibility == Visibility::Packed32 { 24 } else { 0 },
        }
    }

    /// Does an effect move vertices?
    pub fn moves(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.vertex.is_some())
    }

    /// Does an effect move corners by their triangle, so that every triangle has three projected records to itself?
    pub fn unshares_vertices(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.vertex.is_some_and(|hook| hook.needs_triangle))
    }

    /// Are other pixels drawn than are shown?
    pub fn is_scaled(&self) -> bool {
        self.options.render_scale != RenderScale::Full
    }

    /// Does some mesh bend?
    pub const fn deforms(&self) -> bool {
        self.has_joints || self.has_morph_targets
    }

    /// Are splats drawn as discs? What fills boxes or draws corners shows no triangles.
    pub fn has_discs(&self) -> bool {
        self.has_particles && self.shape == Shape::Triangles
    }

    /// Are there queues at all?
    pub const fn has_queues(&self) -> bool {
        self.has_clipping || self.has_medium || self.has_large
    }

    /// Does an effect finish pixels? Then the resolve visits all of them, empty ones too.
    pub fn has_image(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.image.is_some())
    }

    /// Does an effect ask how much of a light arrives?
    pub fn reads_light(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.reads_light)
    }

    /// Does an effect read the picture before this one?
    pub fn reads_previous(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.image.is_some_and(|hook| hook.reads_previous))
    }

    /// Flags of a corner for which a triangle is left out instead of clipped.
    const fn dropped_flags(&self) -> u32 {
        match self.options.clipping {
            Clipping::Drop => vertex_flags::CLIPPED,
            Clipping::Near => vertex_flags::NEAR,
            Clipping::Exact => 0,
        }
    }

    /// Side of the pixel square that a workgroup of the resolve visits; listed tiles are the small ones that are marked.
    pub const fn tile_side(&self) -> u32 {
        if self.listed_tiles { 8 } else { 16 }
    }

    /// Raster phases that find out where the drawing stops, before anything is drawn.
    pub const fn lead(&self) -> &'static [RasterPhase] {
        match self.order {
            Order::Free => &[],
            Order::Submission => &[RasterPhase::CountSamples, RasterPhase::BoundaryTriangle],
            Order::Scheduler => &[RasterPhase::CountSamples],
        }
    }

    pub const fn layout(&self) -> Layout {
        match self.options.visibility {
            Visibility::Split32 => Layout::Split,
            Visibility::Packed32 => Layout::Word,
            Visibility::Race | Visibility::Packed64 | Visibility::Tiled => Layout::Pairs,
        }
    }

    /// Bits of a depth key that shares a word with an triangle id, before it is cut, and the least key that counts: two far
    /// depths below 2^-31 are one.
    const fn key_span(&self) -> (u32, u32) {
        match self.options.depth {
            DepthFormat::Ndc16 | DepthFormat::Log16 => (16, 0),
            DepthFormat::Log24 => (24, 0),
            DepthFormat::Standard => (30, 0),
            DepthFormat::Reversed | DepthFormat::Integer => (28, 0x3000_0000),
        }
    }

    /// Triangle id and key of a pixel from the word in which they share the bits, as `shaders/common/packed.wgsl` has them.
    pub fn unpacked(&self, word: u32) -> (u32, u32) {
        let (bits, least) = self.key_span();
        let loss = (bits + self.id_bits).saturating_sub(32);
        if word == 0 { (NO_TRIANGLE, 0) } else { (!word & ((1 << self.id_bits) - 1), (((word >> self.id_bits) << loss) + least).max(1)) }
    }

    /// The raster phases of one frame, in order.
    pub fn phases(&self) -> Vec<RasterPhase> {
        let nearest: &[RasterPhase] = match (self.layers, self.options.visibility) {
            (Some(Layers::Race), _) | (_, Visibility::Race) => &[RasterPhase::Race],
            (_, Visibility::Packed32) => &[RasterPhase::Packed32],
            (_, Visibility::Split32) => &[RasterPhase::Depth, RasterPhase::TriangleId],
            (_, Visibility::Packed64) => &[RasterPhase::Packed],
            (_, Visibility::Tiled) => &[RasterPhase::BinCount, RasterPhase::BinFill, RasterPhase::Tiles],
        };
        let layers: &[RasterPhase] = match self.layers {
            Some(Layers::Xray { .. }) => &[RasterPhase::Sum],
            Some(Layers::Overdraw) => &[RasterPhase::Count],
            Some(Layers::Race) | None => &[],
        };
        [self.lead(), nearest, layers].concat()
    }

    /// The passes that draw dots, behind those that find the nearest depths.
    pub(super) fn dot_passes(&self) -> &'static [Pass] {
        match (self.dots, self.options.dot_culling) {
            (None, _) => &[],
            (Some(_), DotCulling::Brute | DotCulling::Cpu) => &[Pass::DotsEnds, Pass::DotsDraw],
            (Some(_), DotCulling::Gpu) => &[Pass::DotsEnds, Pass::DotsCull, Pass::DotsArgs, Pass::DotsDraw],
        }
    }

    /// Does this pass come upon every triangle first, and so fill the queues and count?
    fn is_first(&self, pass: Pass) -> bool {
        match self.lead().first() {
            Some(&first) => pass.phase() == Some(first),
            None => !matches!(pass.phase(), Some(RasterPhase::TriangleId | RasterPhase::BinFill)) && !self.is_again(pass),
        }
    }

    /// Does this pass visit all layers of a frame that has found the nearest before? The judge counts in a frame of its own,
    /// unless the picture itself shows the count.
    fn is_again(&self, pass: Pass) -> bool {
        match pass.phase() {
            Some(RasterPhase::Sum) => true,
            Some(RasterPhase::Count) => self.layers == Some(Layers::Overdraw),
            _ => false,
        }
    }

    /// Values of the overrides; those that a pass does not declare are left out by the pipeline builder.
    pub fn constants(&self, pass: Pass) -> Vec<(&'static str, f64)> {
        let flag = |value: bool| f64::from(u8::from(value));
        vec![
            ("ONLY_TRIANGLE_LISTS", flag(self.only_triangle_lists)),
            ("U32_INDICES", flag(self.u32_indices)),
            ("IS_RELATIVE", flag(self.options.position_format == PositionFormat::Relative)),
            ("F32_POSITIONS", flag(self.f32_positions)),
            ("F32_NORMALS", flag(self.f32_normals)),
            ("HAS_COLORS", flag(self.has_colors)),
            ("HAS_PLANES", flag(self.has_planes)),
            ("IS_PERSPECTIVE", flag(self.perspective)),
            ("HAS_LARGE", flag(self.has_large)),
            ("HAS_CLIPPING", flag(self.has_clipping)),
            ("IS_AFFINE", flag(self.options.perspective == Perspective::Affine)),
            ("IS_TOP_LEFT", flag(self.options.coverage != Coverage::Float)),
            ("FLOAT_VIEWPORT", flag(self.options.vertex_transform == VertexTransform::Viewport)),
            ("SUBPIXEL_BITS", self.options.coverage.subpixel_bits().into()),
            ("DROPPED_FLAGS", self.dropped_flags().into()),
            ("IS_BRANCHLESS", flag(self.listed_tiles)),
            ("IS_TWO_PASS", flag(self.options.culling == Culling::TwoPass)),
            ("COUNTS_CULLED", flag(pass != Pass::Cull(CullPhase::Early))),
            ("REOPENS_QUEUES", flag(pass == Pass::AdvanceQueues { reopens_queues: true })),
            ("MESHLET_TRIANGLES", MESHLET_TRIANGLES as f64),
            ("IS_CLIPPED_TRIANGLES", flag(pass == Pass::SampleSetup(TriangleSource::ClippedTriangles))),
            ("SAMPLE_SETUPS", self.sample_setups.into()),
            ("SHAPE", (self.shape as u32).into()),
            ("GROUP_SIZE", self.group_size.into()),
            ("TILE_SIDE", self.tile_side().into()),
            ("MAX_SMALL_SAMPLES", self.max_small_samples.into()),
            ("MAX_SMALL_SIDE", self.max_small_side.into()),
            (
                "INVOCATIONS_PER_TRIANGLE",
                if pass.phase().is_some_and(RasterPhase::is_bin) { 1 } else { self.invocations_per_triangle }.into(),
            ),
            ("MAX_LIST_ENTRIES", self.max_list_entries.into()),
            ("EARLY_LOAD", flag(self.early_load)),
            ("ID_BITS", self.id_bits.into()),
            ("SCALE_SIDE", self.options.render_scale.factor().max(1.0)),
            ("DEPTH_KEY_BITS", self.key_span().0.into()),
            ("MIN_DEPTH_KEY", self.key_span().1.into()),
            ("IS_LARGE", flag(matches!(pass, Pass::BinLarge(_)))),
            ("TESTS_EVERY_SAMPLE", flag(self.order == Order::Scheduler)),
            ("IS_FIRST_VISIT", flag(self.is_first(pass))),
            ("USES_SECOND_COUNTER", flag(self.is_again(pass))),
            ("SHADOW_TAPS_SIDE", self.options.shadow_taps.side().into()),
            ("MAX_SHADOW_SLOPE", MAX_SHADOW_SLOPE),
            ("SUM_WORDS", self.options.xray_sums.words().into()),
            ("SUM_BITS", if let Some(Layers::Xray { bits }) = self.layers { bits.into() } else { 0.0 }),
        ]
    }
}

impl fmt::Display for KernelKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fetch = match self.fetch {
            Fetch::Direct => "direct",
            Fetch::Indexed => "indexed",
        };
        let visibility = match self.options.visibility {
            Visibility::Packed32 => format!("packed32/{}", self.id_bits),
            other => other.name().into(),
        };
        let coverage = self.options.coverage.name();
        write!(f, "raster[fetch={fetch} coverage={coverage} visibility={visibility} small={}", self.max_small_samples)?;
        for (axis, word) in self.options.non_default().filter(|(axis, _)| !matches!(axis.name, "coverage" | "visibility")) {
            write!(f, " {}={word}", axis.name)?;
        }
        match self.layers {
            Some(Layers::Xray { bits }) => write!(f, " layers=xray/{bits}")?,
            Some(Layers::Overdraw) => write!(f, " layers=overdraw")?,
            Some(Layers::Race) | None => {}
        }
        for (name, is_on) in [
            ("clip", self.has_clipping),
            ("medium", self.has_medium),
            ("large", self.has_large),
            ("colors", self.has_colors),
            ("texels", self.has_texels),
            ("mask", self.has_mask),
            ("planes", self.has_planes),
            ("joints", self.has_joints),
            ("shapes", self.has_morph_targets),
            ("particles", self.has_particles),
            ("moved", self.moves()),
            ("parted", self.unshares_vertices()),
            ("dots", self.dots.is_some()),
            ("image", self.has_image()),
            ("orthographic", !self.perspective),
            ("light", self.is_light),
        ] {
            if is_on {
                write!(f, " {name}")?;
            }
        }
        match self.shape {
            Shape::Triangles => {}
            Shape::Boxes => f.write_str(" shape=boxes")?,
            Shape::Points => f.write_str(" shape=points")?,
        }
        match self.order {
            Order::Free => {}
            Order::Submission => f.write_str(" order=submission")?,
            Order::Scheduler => f.write_str(" order=scheduler")?,
        }
        for effect in &self.effects {
            write!(f, " +{}", effect.name)?;
        }
        f.write_str("]")
    }
}
