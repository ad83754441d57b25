//! The planner: the cheapest kernel that the scene, the stack and the tolerance allow on this adapter, and why.

mod costs;
mod explain;
mod loops;
mod options;
pub mod predict;

use self::{explain::explain, options::Choice, predict::Prediction};
use crate::{
    accuracy::{
        AXES, AccuracyOptions, Axis, Clipping, DepthFormat, Parameters, PinnedOptions, RenderScale, SampleCounter, VertexTransform,
        Visibility,
    },
    effects::{
        Conflict, EnabledEffect, Stack,
        dots::LineSource,
        draw_order,
        hooks::{Layers, Shape},
    },
    math::SMALL_EXTENT,
    scene::{
        needs::Needs,
        sizes::{SizeClasses, TriangleSizes},
    },
    shader::{
        glue::reads,
        key::{
            AttributeFormat, EffectList, Fetch, Framebuffer, GeneratedVertices, KernelKey, ProjectionKind, RasterPaths, SampleRules,
            SurfaceInputs, VertexInputs, ViewKind, WorkSharing,
        },
        library::Library,
    },
};

/// What an adapter can do for us.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Caps {
    /// 64-bit atomic maximum on storage buffers: the `packed64` option.
    pub int64_atomics: bool,
    /// GPU timestamps.
    pub timestamps: bool,
    pub max_storage_binding_bytes: u64,
    pub max_buffer_bytes: u64,
    pub max_texture_side: u32,
    /// Runs on the CPU: pictures are right, times say nothing about a graphics card.
    pub software: bool,
}

impl Caps {
    /// `native-int64` or `portable`.
    pub fn class(&self) -> &'static str {
        if self.int64_atomics { "native-int64" } else { "portable" }
    }

    /// How work is shared out on this adapter. On a GPU a whole workgroup takes over early, since one slow lane holds up
    /// its neighbours; a CPU adapter runs lanes in turn, executes both sides of every branch, and gains nothing by it.
    pub fn tuning(&self) -> Tuning {
        let (max_small_samples, max_small_side) = if self.software { (128 * 128, 128) } else { (32, 32) };
        let group_size = if self.software { 64 } else { 256 };
        Tuning {
            max_small_samples,
            max_small_side,
            group_size,
            max_list_entries: u32::MAX,
            listed_tiles: self.software,
            early_load: self.software,
            specialized: true,
        }
    }
}

/// How the kernels share out their work: a matter of speed alone, which no picture may show. [`Caps::tuning`] knows what
/// suits an adapter; benches and tests try others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tuning {
    /// Most candidate samples that one invocation walks, at least 1.
    pub max_small_samples: u32,
    /// Most pixels per side of such a box, 1 to 128.
    pub max_small_side: u32,
    /// Invocations in a workgroup of the passes over vertices and triangles, 1 to 256.
    pub group_size: u32,
    /// Most entries of a tile's list that one dispatch walks, at least 1 (tiled alone).
    pub max_list_entries: u32,
    /// The resolve visits only tiles that a triangle's box touches, without branches.
    pub listed_tiles: bool,
    /// Load before the depth atomic (split32 alone).
    pub early_load: bool,
    /// Leave out what the scene does not need; else keep every path and every branch.
    pub specialized: bool,
}

/// Named tolerances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tier {
    /// For looking around.
    Draft,
    /// Wrong where nobody looks.
    Fast,
    /// Exact given the snapped corners.
    #[default]
    Precise,
    /// Depths in integers too: no two answers are right.
    Reference,
    /// The same bits of triangle ids and depths on every adapter and on the CPU.
    Strict,
}

impl Tier {
    pub const ALL: [Self; 5] = [Self::Draft, Self::Fast, Self::Precise, Self::Reference, Self::Strict];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Fast => "fast",
            Self::Precise => "precise",
            Self::Reference => "reference",
            Self::Strict => "strict",
        }
    }

    /// What the name stands for.
    pub const fn tolerance(self) -> Tolerance {
        match self {
            Self::Draft => Tolerance { wrong_ppm: 20_000.0, channel: 48 },
            Self::Fast => Tolerance { wrong_ppm: 1000.0, channel: 6 },
            Self::Precise | Self::Reference | Self::Strict => Tolerance { wrong_ppm: 0.0, channel: 1 },
        }
    }

    /// The options that are left only for a gain within the tolerance.
    fn base(self) -> AccuracyOptions {
        match self {
            Self::Draft | Self::Fast | Self::Precise => AccuracyOptions::default(),
            Self::Reference => AccuracyOptions { depth: DepthFormat::Integer, ..AccuracyOptions::default() },
            Self::Strict => {
                AccuracyOptions { depth: DepthFormat::Integer, vertex_transform: VertexTransform::Strict, ..AccuracyOptions::default() }
            }
        }
    }
}

/// How far a picture may be off the oracle's.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Tolerance {
    /// Pixels with another triangle id, per million.
    pub wrong_ppm: f64,
    /// Difference of a colour channel, of 255.
    pub channel: u8,
}

impl Tolerance {
    /// Does a prediction stay within it?
    pub fn holds(&self, prediction: &Prediction) -> bool {
        prediction.wrong_ppm <= self.wrong_ppm && prediction.channel <= self.channel.into()
    }
}

/// Axes whose fast options lose nothing, or say for themselves what they lose.
const EXACT_AXES: [&str; 5] = ["visibility", "skinning", "scale", "parameters", "checks"];

/// How exact the picture must be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AccuracyRequest {
    pub tier: Tier,
    /// Pinned options beat the tier.
    pub pins: PinnedOptions,
    /// Another tolerance than the tier's, pixels with the wrong triangle id per million.
    pub wrong_ppm: Option<f64>,
    /// Another tolerance than the tier's, difference of a colour channel of 255.
    pub channel: Option<u8>,
}

impl AccuracyRequest {
    /// How many pixels are drawn for one that is shown: as the preset pins it.
    pub fn scale(&self) -> RenderScale {
        self.pins.option().unwrap_or_default()
    }

    /// Does it pin a option that lets chance decide?
    pub fn is_left_to_chance(&self) -> bool {
        self.pins.option() == Some(Visibility::Race) || self.pins.option() == Some(SampleCounter::Racy)
    }

    /// Does it ask for anything that promises less than exactness?
    pub fn may_err(&self) -> bool {
        let is_cheaper = |axis: &Axis| self.pins.get(axis).is_some_and(|place| place < axis.default && !EXACT_AXES.contains(&axis.name));
        let is_lossy = self.pins.option::<Visibility>().is_some_and(|option| !option.is_exact());
        let tolerance = self.tolerance();
        is_lossy || AXES.iter().any(is_cheaper) || tolerance.wrong_ppm > 0.0
    }

    /// The tier's tolerance, or what the preset says instead.
    pub fn tolerance(&self) -> Tolerance {
        let named = self.tier.tolerance();
        Tolerance { wrong_ppm: self.wrong_ppm.unwrap_or(named.wrong_ppm), channel: self.channel.unwrap_or(named.channel) }
    }
}

/// Why no kernel draws this stack here.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A option that was asked for by name.
    #[error("visibility packed64 needs 64-bit atomics, which this adapter lacks; use split32 or leave it out")]
    Lacking,
    #[error("visibility packed32 keeps triangle and depth in 32 bits, at most 2^24 triangles, and this scene has {triangles}; use split32")]
    Crowded { triangles: u64 },
    #[error("coverage {option} cannot draw the effect {effect}, which measures triangles in 1/256 px; use fixed8, float or float-top-left")]
    Grid { option: &'static str, effect: &'static str },
    #[error("sums {option} counts all layers alike, and this xray weighs them; use four32, or weight = \"equal\"")]
    Weights { option: &'static str },
    #[error("coverage fixed12 holds pictures of at most 2047 px a side, and this one has {}x{}; use fixed8", size[0], size[1])]
    Wide { size: [u32; 2] },
    #[error("depth {option} keeps no distances, so xray cannot count within a window; use reversed, or reach = \"all\"")]
    Window { option: &'static str },
    #[error("dots cpu searches a tree of lines that stay where they are, but {what}; use gpu")]
    Carried { what: String },
    #[error("vertex strict holds where integers decide, but {what}; take it out, or another option")]
    Floats { what: String },
    #[error("vertices {option} packs meshes that keep their shape, and here {what}; use stored")]
    Deformed { option: &'static str, what: &'static str },
    #[error("depth integer divides exact edges, which coverage {option} does not have; use fixed8")]
    Inexact { option: &'static str },
    #[error(transparent)]
    Conflict(#[from] Conflict),
}

/// One line of reasoning: what was chosen or left out, and why.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Note {
    pub name: String,
    pub why: String,
}

/// A kernel key with its reasons.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub key: KernelKey,
    /// Why each part of the key is as it is.
    pub reasons: Vec<Note>,
    /// What this picture does without.
    pub omitted: Vec<Note>,
    /// What the options are predicted to err by, against the oracle's picture.
    pub prediction: Prediction,
    /// How large triangles are, and how many are predicted to take which path; not where effects move them.
    pub sizes: TriangleSizes,
    pub classes: Option<SizeClasses>,
    /// What they may err by.
    pub tolerance: Tolerance,
}

/// Bits that tell so many triangles apart, and each from nothing.
const fn bit_length(triangles: u64) -> u32 {
    64 - (triangles | 1).leading_zeros()
}

const fn attribute_format(is_f32: bool) -> AttributeFormat {
    if is_f32 { AttributeFormat::F32 } else { AttributeFormat::Any }
}

/// Chooses the kernel.
///
/// # Errors
/// When the preset pins a option that the adapter lacks, or two effects take one slot.
pub fn plan(needs: &Needs, stack: &Stack, caps: &Caps, tuning: &Tuning, accuracy: &AccuracyRequest) -> Result<Plan, PlanError> {
    stack.check()?;
    let shape = stack.shape();
    let f32_positions = needs.f32_positions;
    let mut needs = if tuning.specialized { needs.clone() } else { needs.everything() };
    if stack.moves() {
        // Bounds of the scene say nothing of where effects move it, nor its normals of how they turn them.
        needs = Needs { clipping: true, largest_px: f64::INFINITY, normals_agree: false, ..needs };
    }
    if shape == Shape::Points {
        // Discs are small, and triangles that would be clipped show none.
        (needs.clipping, needs.largest_px) = (false, 0.0);
    }
    let needs = &needs;
    let mut layers = stack.layers(needs.triangles);
    let Choice { options, reasons: mut reasons_of_options, prediction } =
        options::choose(needs, f32_positions, stack, caps, accuracy, layers)?;
    if let (Some(Layers::Xray { bits }), Some(_)) = (&mut layers, options.xray_sums.capacity()) {
        *bits = 8;
    }
    // Whoever drops what would have to be clipped needs no clipper; what is left may still be wide.
    let has_clipping = needs.clipping && options.clipping != Clipping::Drop;
    // Boxes and discs show all of a material.
    let has_mask = needs.masked && shape == Shape::Triangles;
    let loops = loops::of_a_sample(has_mask, layers, &options);
    let max_small_samples = tuning.max_small_samples.min(loops::samples(caps, loops)).max(1);
    let max_small_side = tuning.max_small_side.clamp(1, 128);
    // A box of n px touches at most n + 1 sample columns.
    let widest = needs.largest_px.floor() + 1.0;
    let has_medium = has_clipping || widest > f64::from(max_small_side) || widest * widest > f64::from(max_small_samples);
    let has_large = needs.largest_px >= f64::from(SMALL_EXTENT >> options.coverage.subpixel_bits());
    let planes = ["flat_normal", "flat_depth_m", "center"];
    // Taps follow the plane of a triangle.
    let reads_planes = stack.light().is_some()
        || stack.0.iter().any(|enabled| planes.iter().any(|member| reads(&Library::Embedded, enabled.effect, member)));
    let has_planes = reads_planes || !needs.normals_agree;
    let effects: Vec<_> = stack.0.iter().map(|EnabledEffect { effect, .. }| *effect).collect();
    let key = KernelKey {
        options,
        vertices: VertexInputs {
            fetch: match (needs.indexed, needs.u32_indices) {
                (false, _) => Fetch::Direct,
                (true, false) => Fetch::Indexed,
                (true, true) => Fetch::IndexedU32,
            },
            positions: attribute_format(needs.f32_positions),
            normals: attribute_format(needs.f32_normals),
            has_colors: needs.colors,
            only_triangle_lists: !needs.has_strips_or_fans,
            is_single_draw: needs.draws == 1,
        },
        generated: GeneratedVertices {
            has_joints: needs.skinning.is_some(),
            has_morph_targets: needs.morph_targets,
            has_particles: needs.particle_discs,
        },
        samples: SampleRules { shape, draw_order: stack.draw_order().map(|order| draw_order::Mode::of(order.mode)), has_mask },
        paths: RasterPaths { has_clipping, has_medium, has_large, max_small_samples, max_small_side },
        work: WorkSharing {
            group_size: tuning.group_size,
            invocations_per_triangle: loops::invocations_per_triangle(caps, stack, loops),
            max_list_entries: tuning.max_list_entries.min(loops::samples(caps, loops::of_an_entry(has_mask, needs.draws, &options))).max(1),
            listed_tiles: tuning.listed_tiles && !stack.finishes() && stack.dots().is_none(),
            early_load: tuning.early_load,
        },
        framebuffer: Framebuffer {
            layers,
            triangle_id_bits: if options.visibility == Visibility::Packed32 { bit_length(needs.triangles) } else { 0 },
        },
        surface: SurfaceInputs { has_material_atlas: needs.material_count > 0, has_planes },
        view: ViewKind {
            projection: if needs.perspective { ProjectionKind::Perspective } else { ProjectionKind::Orthographic },
            is_light: needs.is_light,
        },
        effects: EffectList {
            baked: if options.parameters == Parameters::Baked {
                stack.0.iter().map(|enabled| enabled.words.clone()).collect()
            } else {
                Vec::new()
            },
            dots: stack.dots().map(|dots| LineSource::of(dots.lines)),
            list: effects,
        },
    };
    let (reasons, omitted) = explain(needs, tuning == &caps.tuning(), caps, &key);
    reasons_of_options.extend(reasons);
    let large_px = f64::from(SMALL_EXTENT >> options.coverage.subpixel_bits());
    let classes = (shape == Shape::Triangles && !stack.moves()).then(|| needs.sizes.classes(max_small_samples, max_small_side, large_px));
    let sizes = needs.sizes.clone();
    Ok(Plan { key, reasons: reasons_of_options, omitted, prediction, sizes, classes, tolerance: accuracy.tolerance() })
}
