//! What each pass does, in a line for `explain`.

use crate::shader::pass::{CullPhase, Pass, RasterPhase, TriangleSource};

pub fn pass_purpose(pass: Pass) -> &'static str {
    match pass {
        Pass::Particles => "takes every particle one step on and writes the triangle of its disc",
        Pass::Skin => "mixes shapes and follows joints, once per vertex of every mesh that bends",
        Pass::Project => "pulls, transforms and snaps every vertex once",
        Pass::Cull(CullPhase::FrustumOnly) => {
            "leaves out meshlets outside the picture and those that face away, lists the others"
        }
        Pass::Cull(CullPhase::PreviousFrame) => {
            "leaves out those too that the picture before hides"
        }
        Pass::Cull(CullPhase::Early) => "lists the meshlets that were seen in the picture before",
        Pass::Cull(CullPhase::Late) => {
            "lists those of the others that the first round does not hide"
        }
        Pass::ProjectMeshlets => {
            "pulls, transforms and snaps the vertices of the meshlets that are left"
        }
        Pass::DepthReduce => "finds the farthest depth of every tile, behind which meshlets hide",
        Pass::AdvanceQueues {
            reopens_queues: false,
        } => "ends the first round: what follows takes up what is listed from here on",
        Pass::AdvanceQueues {
            reopens_queues: true,
        } => "opens the lists of both rounds again",
        Pass::RasterSmall(RasterPhase::CountSamples) => {
            "culls and classifies every triangle, counts the samples of the small ones"
        }
        Pass::RasterSmall(RasterPhase::BoundaryTriangle) => {
            "marks the samples of the triangle in which the drawing stops"
        }
        Pass::RasterSmall(RasterPhase::TriangleId) => {
            "visits the small triangles again for the triangle id of each nearest key"
        }
        Pass::RasterSmall(RasterPhase::NearestAndSum) => {
            "culls and classifies every triangle, draws the small ones on the spot and adds every layer's color"
        }
        Pass::RasterSmall(RasterPhase::Sum) => {
            "visits the small triangles again and adds every layer's color"
        }
        Pass::RasterSmall(RasterPhase::Glass) => {
            "visits the small triangles again and lists every layer of glass with its color"
        }
        Pass::RasterSmall(RasterPhase::Count) => {
            "visits the small triangles again and counts layers"
        }
        Pass::RasterSmall(_) => {
            "culls and classifies every triangle, draws the small ones on the spot"
        }
        Pass::SampleSetup(TriangleSource::Triangles) => {
            "settles once per triangle what sample effects hold against"
        }
        Pass::SampleSetup(TriangleSource::ClippedTriangles) => {
            "settles the same for the pieces that clipping left"
        }
        Pass::OrderSums => "adds up the samples of every 1,024 triangles",
        Pass::OrderLimit => {
            "finds how many samples there are, how many to draw, and in which triangle that number is reached"
        }
        Pass::OrderRanks => "tells which share of all samples comes before each triangle",
        Pass::OrderCut => "finds the pixel at which the drawing stops",
        Pass::RasterPoints(_) => "draws the corners of every shown triangle as discs",
        Pass::RasterCloud(_) => {
            "projects and draws every small point, and sorts out the larger ones"
        }
        Pass::Args => "turns queue demand into dispatch sizes",
        Pass::Clip => "cuts triangles at the near plane and the guard band",
        Pass::TileLarge => "finds the tiles of each large triangle",
        Pass::RasterMedium(_) => {
            "draws triangles of up to 128 px, at least one workgroup each; if no pass of its own does so, finds the tiles of large ones"
        }
        Pass::RasterLarge(_) => {
            "draws large triangles, at least one workgroup for each tile of 64 x 64 pixels"
        }
        Pass::RasterAll(RasterPhase::TriangleId) => {
            "visits triangles of all sizes again for the triangle id of each nearest key"
        }
        Pass::RasterAll(_) => "visits triangles of all sizes again",
        Pass::DotsEnds => "takes both ends of every segment of a line to clip space",
        Pass::DotsCull => {
            "leaves out lines beyond the view, thins the others, lists the dots that may show"
        }
        Pass::DotsArgs => "turns the number of listed dots into a dispatch size",
        Pass::DotsDraw => "draws dots, one invocation each: the strongest on every pixel",
        Pass::DotsProbe => "reads back where every dot lies",
        Pass::GlassBand => "begins the next band of pixels whose layers of glass are drawn",
        Pass::GlassCompose => "composes each pixel's layers of glass",
        Pass::ListTiles => "gathers the tiles that hold something",
        Pass::Resolve => "shades every pixel once",
        Pass::ResolveBackground => "finishes the pixels of tiles that no triangle touches",
        Pass::ImageBegin => "takes the picture to linear light for image effects",
        Pass::Image(_) => "writes one pass of an image effect over the picture",
        Pass::Scale => "brings the pixels that were drawn to the size that is shown",
    }
}
