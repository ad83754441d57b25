//! The kernel key: everything that decides which shader text runs and with which constants. Equal keys, equal pipelines.

use std::fmt;

use crate::{
    effects::{
        Effect, Enabled, Stack,
        dots::Strung,
        draw_order::Mode,
        hooks::{Layers, Shape},
        shadow::STEEPEST,
    },
    frame::{NO_OWNER, vertex_flags},
    ladder::{Clipping, Coverage, Culling, Depth, DotWay, Perspective, Rungs, Scale, Vertex, Vertices, Visibility},
    scene::meshlets::MESHLET_TRIANGLES,
};

pub use super::pass::{Entries, Pass, Phase, Round};

/// How corners find their vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fetch {
    Direct,
    Indexed,
}

/// How depth and owner of the pixels lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layout {
    /// A buffer of keys and one of complemented owners.
    Split,
    /// One word for both.
    Word,
    /// Complemented owner and key side by side.
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
    /// A rung on every axis of the ladder.
    pub rungs: Rungs,
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
    pub dots: Option<Strung>,
    /// A sample effect may leave samples out.
    pub has_samples: bool,
    /// Records that are settled per triangle: one of every sample effect that does, and [`MASK_RECORDS`] of a mask.
    pub decisions: u32,
    /// Some triangle may need clipping.
    pub has_clipping: bool,
    /// Some triangle may be wider than one invocation's share.
    pub has_medium: bool,
    /// Some triangle may exceed 128 px.
    pub has_large: bool,
    pub single_draw: bool,
    pub only_lists: bool,
    pub wide_indices: bool,
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
    pub has_shapes: bool,
    /// Particles fly.
    pub has_particles: bool,
    /// The resolve computes plane normals and triangle centres: an effect reads them, or a normal may need a substitute.
    pub has_planes: bool,
    /// w is metres; else depth is linear and w is 1.
    pub perspective: bool,
    /// Most candidate samples that one invocation walks.
    pub small_samples: u32,
    /// Most pixels per side of such a box.
    pub small_side: u32,
    /// Among how many invocations the discs of one triangle are shared out, at least 1.
    pub disc_shares: u32,
    /// Most entries of a tile's list that one dispatch walks.
    pub list_walk: u32,
    /// The resolve visits only tiles that a triangle's box touches, without branches.
    pub listed_tiles: bool,
    /// Invocations in a workgroup of the passes over vertices and triangles.
    pub list_group: u32,
    /// Load before the depth atomic.
    pub early_load: bool,
    /// A light looks, not the eye: effects ask where things stand in the picture for which it does.
    pub is_light: bool,
    /// Bits of a triangle's id where it shares a word with its depth, else 0.
    pub id_bits: u32,
}

/// Records that a mask settles per triangle: where its corners lie in the image.
pub const MASK_RECORDS: u32 = 2;

/// Effects that settle something per triangle.
pub fn deciding(effects: &[&'static Effect]) -> u32 {
    effects.iter().filter(|effect| effect.hooks.sample.is_some_and(|hook| hook.decides)).count() as u32
}

impl KernelKey {
    /// A key that leaves nothing out, for a stack on a portable adapter: where every path of the text is wanted.
    pub fn whole(fetch: Fetch, visibility: Visibility, effects: Vec<&'static Effect>) -> Self {
        Self {
            fetch,
            rungs: Rungs { visibility, ..Rungs::default() },
            layers: Stack(effects.iter().map(|effect| Enabled::new(effect)).collect()).layers(u64::MAX),
            shape: Shape::Triangles,
            order: Order::Free,
            dots: effects.iter().any(|effect| effect.hooks.has_lines).then_some(Strung::Edges),
            has_samples: effects.iter().any(|effect| effect.hooks.sample.is_some()),
            decisions: deciding(&effects),
            effects,
            baked: Vec::new(),
            has_clipping: true,
            has_medium: true,
            has_large: true,
            single_draw: false,
            only_lists: false,
            wide_indices: false,
            f32_positions: false,
            f32_normals: false,
            has_colors: true,
            has_texels: true,
            has_mask: false,
            has_joints: true,
            has_shapes: true,
            has_particles: true,
            has_planes: true,
            perspective: true,
            small_samples: 64,
            small_side: 32,
            disc_shares: 1,
            list_walk: u32::MAX,
            listed_tiles: true,
            list_group: 64,
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
    pub fn parts_corners(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.vertex.is_some_and(|hook| hook.needs_triangle))
    }

    /// Are other pixels drawn than are shown?
    pub fn is_scaled(&self) -> bool {
        self.rungs.scale != Scale::Whole
    }

    /// Does some mesh bend?
    pub const fn bends(&self) -> bool {
        self.has_joints || self.has_shapes
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
        match self.rungs.clipping {
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
    pub const fn lead(&self) -> &'static [Phase] {
        match self.order {
            Order::Free => &[],
            Order::Submission => &[Phase::Tally, Phase::Straddle],
            Order::Scheduler => &[Phase::Tally],
        }
    }

    pub const fn layout(&self) -> Layout {
        match self.rungs.visibility {
            Visibility::Split32 => Layout::Split,
            Visibility::Packed32 => Layout::Word,
            Visibility::Race | Visibility::Packed64 | Visibility::Tiled => Layout::Pairs,
        }
    }

    /// Bits of a depth key that shares a word with an owner, before it is cut, and the least key that counts: two far
    /// depths below 2^-31 are one.
    const fn key_span(&self) -> (u32, u32) {
        match self.rungs.depth {
            Depth::Ndc16 | Depth::Log16 => (16, 0),
            Depth::Log24 => (24, 0),
            Depth::Standard => (30, 0),
            Depth::Reversed | Depth::Integer => (28, 0x3000_0000),
        }
    }

    /// Owner and key of a pixel from the word in which they share the bits, as `shaders/common/packed.wgsl` has them.
    pub fn unpacked(&self, word: u32) -> (u32, u32) {
        let (bits, least) = self.key_span();
        let loss = (bits + self.id_bits).saturating_sub(32);
        if word == 0 { (NO_OWNER, 0) } else { (!word & ((1 << self.id_bits) - 1), (((word >> self.id_bits) << loss) + least).max(1)) }
    }

    /// The raster phases of one frame, in order.
    pub fn phases(&self) -> Vec<Phase> {
        let nearest: &[Phase] = match (self.layers, self.rungs.visibility) {
            (Some(Layers::Race), _) | (_, Visibility::Race) => &[Phase::Race],
            (_, Visibility::Packed32) => &[Phase::Packed32],
            (_, Visibility::Split32) => &[Phase::Depth, Phase::Owner],
            (_, Visibility::Packed64) => &[Phase::Packed],
            (_, Visibility::Tiled) => &[Phase::BinCount, Phase::BinFill, Phase::Tiles],
        };
        let layers: &[Phase] = match self.layers {
            Some(Layers::Xray { .. }) => &[Phase::Sum],
            Some(Layers::Overdraw) => &[Phase::Count],
            Some(Layers::Race) | None => &[],
        };
        [self.lead(), nearest, layers].concat()
    }

    /// The passes that draw dots, behind those that find the nearest depths.
    pub(super) fn dot_passes(&self) -> &'static [Pass] {
        match (self.dots, self.rungs.dots) {
            (None, _) => &[],
            (Some(_), DotWay::Brute | DotWay::Cpu) => &[Pass::DotsEnds, Pass::DotsDraw],
            (Some(_), DotWay::Gpu) => &[Pass::DotsEnds, Pass::DotsCull, Pass::DotsArgs, Pass::DotsDraw],
        }
    }

    /// Does this pass come upon every triangle first, and so fill the queues and count?
    fn is_first(&self, pass: Pass) -> bool {
        match self.lead().first() {
            Some(&first) => pass.phase() == Some(first),
            None => !matches!(pass.phase(), Some(Phase::Owner | Phase::BinFill)) && !self.is_again(pass),
        }
    }

    /// Does this pass visit all layers of a frame that has found the nearest before? The judge counts in a frame of its own,
    /// unless the picture itself shows the count.
    fn is_again(&self, pass: Pass) -> bool {
        match pass.phase() {
            Some(Phase::Sum) => true,
            Some(Phase::Count) => self.layers == Some(Layers::Overdraw),
            _ => false,
        }
    }

    /// Values of the overrides; those that a pass does not declare are left out by the pipeline builder.
    pub fn constants(&self, pass: Pass) -> Vec<(&'static str, f64)> {
        let flag = |value: bool| f64::from(u8::from(value));
        vec![
            ("ONLY_LISTS", flag(self.only_lists)),
            ("WIDE_INDICES", flag(self.wide_indices)),
            ("IS_RELATIVE", flag(self.rungs.vertices == Vertices::Relative)),
            ("F32_POSITIONS", flag(self.f32_positions)),
            ("F32_NORMALS", flag(self.f32_normals)),
            ("HAS_COLORS", flag(self.has_colors)),
            ("HAS_PLANES", flag(self.has_planes)),
            ("IS_PERSPECTIVE", flag(self.perspective)),
            ("HAS_LARGE", flag(self.has_large)),
            ("HAS_CLIPPING", flag(self.has_clipping)),
            ("IS_AFFINE", flag(self.rungs.perspective == Perspective::Affine)),
            ("IS_TOP_LEFT", flag(self.rungs.coverage != Coverage::Float)),
            ("FLOAT_VIEWPORT", flag(self.rungs.vertex == Vertex::Viewport)),
            ("SUBPIXEL_BITS", self.rungs.coverage.subpixel_bits().into()),
            ("DROPPED_FLAGS", self.dropped_flags().into()),
            ("IS_STRAIGHT", flag(self.listed_tiles)),
            ("HAS_ROUNDS", flag(self.rungs.culling == Culling::TwoPass)),
            ("IS_COUNTING", flag(pass != Pass::Cull(Round::Seen))),
            ("IS_OVER", flag(pass == Pass::Rounds { is_over: true })),
            ("MESHLET_TRIANGLES", MESHLET_TRIANGLES as f64),
            ("IS_PIECES", flag(pass == Pass::Decide(Entries::Pieces))),
            ("DECISIONS", self.decisions.into()),
            ("SHAPE", (self.shape as u32).into()),
            ("LIST_GROUP", self.list_group.into()),
            ("TILE_SIDE", self.tile_side().into()),
            ("SMALL_SAMPLES", self.small_samples.into()),
            ("SMALL_SIDE", self.small_side.into()),
            ("DISC_SHARES", if pass.phase().is_some_and(Phase::is_bin) { 1 } else { self.disc_shares }.into()),
            ("LIST_WALK", self.list_walk.into()),
            ("EARLY_LOAD", flag(self.early_load)),
            ("ID_BITS", self.id_bits.into()),
            ("SCALE_SIDE", self.rungs.scale.factor().max(1.0)),
            ("KEY_BITS", self.key_span().0.into()),
            ("KEY_LEAST", self.key_span().1.into()),
            ("IS_LARGE", flag(matches!(pass, Pass::BinLarge(_)))),
            ("IS_TICKETED", flag(self.order == Order::Scheduler)),
            ("IS_FIRST", flag(self.is_first(pass))),
            ("IS_AGAIN", flag(self.is_again(pass))),
            ("TAPS_SIDE", self.rungs.taps.side().into()),
            ("STEEPEST", STEEPEST),
            ("SUM_WORDS", self.rungs.sums.words().into()),
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
        let visibility = match self.rungs.visibility {
            Visibility::Packed32 => format!("packed32/{}", self.id_bits),
            other => other.name().into(),
        };
        let coverage = self.rungs.coverage.name();
        write!(f, "raster[fetch={fetch} coverage={coverage} visibility={visibility} small={}", self.small_samples)?;
        for (axis, word) in self.rungs.unusual().filter(|(axis, _)| !matches!(axis.name, "coverage" | "visibility")) {
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
            ("shapes", self.has_shapes),
            ("particles", self.has_particles),
            ("moved", self.moves()),
            ("parted", self.parts_corners()),
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
