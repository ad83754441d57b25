//! Explanation: which passes and buffers the last picture has, which it does without, and why.

use super::{BufferNote, Note, Renderer, dots::DotStore};
use crate::{
    plan::{Plan, Tolerance, predict::Prediction},
    scene::sizes::SizeClasses,
    shader::pass::{CullPhase, Pass, RasterPhase, TriangleSource},
};

/// Which passes and buffers exist for the last picture, and why.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Explanation {
    pub key: String,
    pub passes: Vec<Note>,
    pub buffers: Vec<BufferNote>,
    pub reasons: Vec<Note>,
    pub omitted: Vec<Note>,
    /// Triangles by their size on the screen, and the paths that they take.
    pub sizes: Option<SizesNote>,
    /// What the options are predicted to err by, and what they may.
    pub prediction: Option<Prediction>,
    pub tolerance: Option<Tolerance>,
}

/// Triangles by their size on the screen, from a look at some, and what the frame then counted.
#[derive(Clone, Debug, serde::Serialize)]
pub struct SizesNote {
    pub triangles: u64,
    pub sampled: u32,
    /// Of those, whole ones that face the viewer and lie in the picture.
    pub seen: u32,
    /// Reach before the near plane.
    pub cut: u32,
    /// Upper end of a power of two in pixels, and how many of the seen ones lie in it.
    pub bins: Vec<(f64, u32)>,
    /// How many take which path; not where effects move or reshape triangles.
    pub predicted: Option<SizeClasses>,
    /// What the queues of the frame counted: medium and large triangles. Not while figures are still to come.
    pub counted: Option<[u32; 2]>,
    /// The prediction holds, where both are known.
    pub prediction_holds: Option<bool>,
}

impl SizesNote {
    fn new(plan: &Plan, counted: Option<[u32; 2]>) -> Self {
        let Plan { key, needs, classes, .. } = plan;
        let sizes = &needs.sizes;
        // What is cut comes back as pieces of any size, and what is hidden may never be queued.
        let is_told = |_: &[u32; 2]| (!key.paths.has_clipping || sizes.near_clipped == 0) && !key.options.culling.occludes();
        let is_near = |c: SizeClasses, [medium, large]: [u32; 2]| {
            let near =
                |predicted: f64, counted: u32| (predicted - f64::from(counted)).abs() <= c.error_bound + 0.02 * f64::from(counted) + 1.0;
            // Those that exceed the pass which was left out are drawn by the one before.
            (near(c.medium, medium) || !key.paths.has_medium) && (near(c.large, large) || !key.paths.has_large)
        };
        let prediction_holds = classes.zip(counted.filter(is_told)).map(|(classes, counted)| is_near(classes, counted));
        Self {
            triangles: sizes.triangles,
            sampled: sizes.sampled,
            seen: sizes.visible(),
            cut: sizes.near_clipped,
            bins: sizes.bins(),
            predicted: *classes,
            counted,
            prediction_holds,
        }
    }
}

impl Renderer {
    /// What exists for the last picture, and why.
    pub fn explain(&self) -> Explanation {
        let Some(plan) = &self.last else {
            return Explanation {
                key: "nothing drawn yet".into(),
                passes: Vec::new(),
                buffers: self.buffers.notes(),
                reasons: Vec::new(),
                omitted: Vec::new(),
                sizes: None,
                prediction: None,
                tolerance: None,
            };
        };
        let own = plan.key.frame().into_iter().map(|pass| Note { name: pass.label(), why: pass_purpose(pass).into() });
        let light = || self.shadow_pass.iter();
        let mut reasons = plan.reasons();
        if let Some([dots, lines]) = self.dots.as_ref().map(DotStore::sample_counts) {
            reasons.push(Note { name: "dots".into(), why: format!("{dots} dots on {lines} lines, as far as the lines are long") });
        }
        let why = "a texture of words: what the materials of primitives are, and the levels of their images";
        let texels = self.texels.as_ref().map(|texels| BufferNote { name: "texels".into(), bytes: texels.bytes, why: why.into() });
        Explanation {
            key: plan.key.to_string(),
            passes: light().flat_map(|shadow_pass| shadow_pass.passes()).chain(own).collect(),
            buffers: self.buffers.notes().into_iter().chain(texels).chain(light().flat_map(|shadow_pass| shadow_pass.buffers())).collect(),
            reasons,
            omitted: plan.omissions(),
            sizes: Some(SizesNote::new(plan, self.demand)),
            prediction: Some(plan.prediction),
            tolerance: Some(plan.tolerance),
        }
    }
}

pub(super) fn pass_purpose(pass: Pass) -> &'static str {
    match pass {
        Pass::Particles => "takes every particle one step on and writes the triangle of its disc",
        Pass::Skin => "mixes shapes and follows joints, once per vertex of every mesh that bends",
        Pass::Project => "pulls, transforms and snaps every vertex once",
        Pass::Cull(CullPhase::FrustumOnly) => "leaves out meshlets outside the picture and those that face away, lists the others",
        Pass::Cull(CullPhase::PreviousFrame) => "leaves out those too that the picture before hides",
        Pass::Cull(CullPhase::Early) => "lists the meshlets that were seen in the picture before",
        Pass::Cull(CullPhase::Late) => "lists those of the others that the first round does not hide",
        Pass::ProjectMeshlets => "pulls, transforms and snaps the vertices of the meshlets that are left",
        Pass::DepthReduce => "finds the farthest depth of every tile, behind which meshlets hide",
        Pass::AdvanceQueues { reopens_queues: false } => "ends the first round: what follows takes up what is listed from here on",
        Pass::AdvanceQueues { reopens_queues: true } => "opens the lists of both rounds again",
        Pass::RasterSmall(RasterPhase::CountSamples) => "culls and classifies every triangle, counts the samples of the small ones",
        Pass::RasterSmall(RasterPhase::BoundaryTriangle) => "marks the samples of the triangle in which the drawing stops",
        Pass::RasterSmall(RasterPhase::TriangleId) => "visits the small triangles again for the triangle id of each nearest key",
        Pass::RasterSmall(RasterPhase::Sum) => "visits the small triangles again and adds every layer's colour",
        Pass::RasterSmall(RasterPhase::Count) => "visits the small triangles again and counts layers",
        Pass::RasterSmall(RasterPhase::BinCount) => "culls and classifies every triangle, counts the tiles of the small ones",
        Pass::RasterSmall(RasterPhase::BinFill) => "puts the small triangles on the lists of their tiles",
        Pass::RasterSmall(_) => "culls and classifies every triangle, draws the small ones on the spot",
        Pass::SampleSetup(TriangleSource::Triangles) => "settles once per triangle what sample effects hold against",
        Pass::SampleSetup(TriangleSource::ClippedTriangles) => "settles the same for the pieces that clipping left",
        Pass::OrderSums => "adds up the samples of every 1,024 triangles",
        Pass::OrderLimit => "finds how many samples there are, how many to draw, and in which triangle that number is reached",
        Pass::OrderRanks => "tells which share of all samples comes before each triangle",
        Pass::OrderCut => "finds the pixel at which the drawing stops",
        Pass::BinMedium(RasterPhase::BinFill) => "puts medium triangles on the lists of their tiles",
        Pass::BinMedium(_) => "counts the tiles of medium triangles, one workgroup each",
        Pass::BinLarge(RasterPhase::BinFill) => "puts large triangles on the lists of their tiles",
        Pass::BinLarge(_) => "counts the tiles of large triangles, one workgroup each",
        Pass::BinScan => "finds where the list of each tile begins",
        Pass::RasterTiles => "one workgroup per tile of 16 x 16 pixels walks its list, one invocation owns a pixel",
        Pass::RasterPoints(RasterPhase::BinCount) => "counts the tiles of the corners of every shown triangle",
        Pass::RasterPoints(RasterPhase::BinFill) => "puts triangles on the lists of their corners' tiles",
        Pass::RasterPoints(_) => "draws the corners of every shown triangle as discs",
        Pass::Args => "turns queue demand into dispatch sizes",
        Pass::Clip => "cuts triangles at the near plane and the guard band",
        Pass::TileLarge => "finds the tiles of each large triangle",
        Pass::RasterMedium(_) => "one workgroup per triangle of up to 128 px",
        Pass::RasterLarge(_) => "one workgroup per 64 x 64 tile of a large triangle",
        Pass::DotsEnds => "takes both ends of every segment of a line to clip space",
        Pass::DotsCull => "leaves out lines beyond the view, thins the others, lists the dots that may show",
        Pass::DotsArgs => "turns the number of listed dots into a dispatch size",
        Pass::DotsDraw => "draws dots, one invocation each: the strongest on every pixel",
        Pass::DotsProbe => "reads back where every dot lies",
        Pass::ListTiles => "gathers the tiles that hold something",
        Pass::Resolve => "shades every pixel once",
        Pass::Scale => "brings the pixels that were drawn to the size that is shown",
    }
}
