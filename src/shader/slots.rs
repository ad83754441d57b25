//! Slots: which file of `shaders/slots` fills each part that a pass leaves open.

use super::key::{CullPhase, Fetch, KernelKey, Layout, Order, Pass, RasterPhase};
use crate::{
    accuracy::{DepthFormat, DotCulling, SampleCounter, VertexTransform},
    effects::{
        dots::LineSource,
        hooks::{Layers, Shape},
    },
};

impl KernelKey {
    /// File of each slot for a pass.
    pub fn slots(&self, pass: Pass) -> Vec<(&'static str, String)> {
        let fetch = match self.fetch {
            Fetch::Direct => "direct",
            Fetch::Indexed => "indexed",
        };
        let queues = if self.has_queues() { "kept" } else { "none" };
        let is_marking = self.listed_tiles
            && !matches!(
                pass.phase(),
                Some(
                    RasterPhase::TriangleId
                        | RasterPhase::Count
                        | RasterPhase::Sum
                        | RasterPhase::CountSamples
                        | RasterPhase::BoundaryTriangle
                )
            );
        let marks = if is_marking { "kept" } else { "none" };
        let pixels = if self.listed_tiles { "listed" } else { "all" };
        let pieces = if self.has_clipping { "kept" } else { "none" };
        let records = if self.unshares_vertices() { "own" } else { "shared" };
        let movement = match (self.moves(), self.unshares_vertices()) {
            (false, _) => "none",
            (true, false) => "vertices",
            (true, true) => "triangles",
        };
        let shape = if self.moves() { "moved" } else { "still" };
        let finish = if self.has_image() { "image" } else { "none" };
        let shading = match self.layers {
            Some(Layers::Xray { .. }) => "average",
            Some(Layers::Overdraw) => "heat",
            Some(Layers::Race) | None => "owner",
        };
        let coverage = match self.shape {
            Shape::Boxes => "boxes",
            _ if self.options.coverage.is_float() => "float",
            _ => "fixed",
        };
        let layout = match self.layout() {
            Layout::Split => "split32",
            Layout::Word => "packed32",
            Layout::Pairs => "packed64",
        };
        let is_bin = pass.phase().is_some_and(RasterPhase::is_bin);
        let cells = match self.shape {
            Shape::Points => "points",
            Shape::Triangles if self.has_large => "all",
            Shape::Triangles | Shape::Boxes => "small",
        };
        let walk = if is_bin { "tiles" } else { "samples" };
        let keys = if self.options.depth == DepthFormat::Integer { "integer" } else { "float" };
        let mask = match (self.has_mask, pass) {
            (false, _) => "none",
            (true, Pass::SampleSetup(_)) => "settled",
            (true, _) => "asked",
        };
        let mut slots = vec![
            ("bytes", format!("slots/bytes/{}", if matches!(pass, Pass::Particles | Pass::Skin) { "write" } else { "read" })),
            ("shapes", format!("slots/shapes/{}", if self.has_morph_targets { "kept" } else { "none" })),
            ("skinning", format!("slots/skinning/{}", if self.has_joints { self.options.skinning.name() } else { "none" })),
            ("texels", format!("slots/texels/{}", if self.has_texels { "atlas" } else { "none" })),
            ("mask", format!("slots/mask/{mask}")),
            ("corners", format!("slots/corners/{records}")),
            ("sources", format!("slots/sources/{records}")),
            (
                "positions",
                format!(
                    "slots/positions/{}",
                    self.options.position_format.packed_bits().map_or("stored", |_| self.options.position_format.name())
                ),
            ),
            ("screen", format!("slots/screen/{}", if self.is_light { "picture" } else { "own" })),
            ("light", format!("slots/light/{}", if self.reads_light() { "mapped" } else { "none" })),
            ("movement", format!("slots/movement/{movement}")),
            ("shape", format!("slots/shape/{shape}")),
            ("pieces", format!("slots/pieces/{pieces}")),
            (
                "records",
                format!("slots/records/{}", if matches!(pass, Pass::SampleSetup(_) | Pass::OrderRanks) { "write" } else { "read" }),
            ),
            ("order", format!("slots/order/{}", self.order_file(pass))),
            ("ranks", format!("slots/ranks/{}", if self.order == Order::Free { "none" } else { "kept" })),
            ("splats", format!("slots/splats/{}", if self.has_discs() { "discs" } else { "none" })),
            ("curl", format!("slots/curl/{}", self.options.curl_noise.name())),
            ("state", format!("slots/state/{}", self.options.particle_storage.name())),
            ("samples", format!("slots/samples/{}", if self.has_samples { "hooked" } else { "all" })),
            ("draws", format!("slots/draws/{}", if self.single_draw { "one" } else { "many" })),
            ("fetch", format!("slots/fetch/{fetch}")),
            ("share", format!("slots/share/{}", if self.culls() { "meshlets" } else { "all" })),
            ("occlusion", format!("slots/occlusion/{}", occlusion(pass))),
            ("queues", format!("slots/queues/{queues}")),
            ("marks", format!("slots/marks/{marks}")),
            ("pixels", format!("slots/pixels/{pixels}")),
            ("coverage", format!("slots/coverage/{coverage}")),
            ("blocks", format!("slots/blocks/{}", if self.options.coverage.is_float() { "float" } else { "rebased" })),
            (
                "projection",
                format!("slots/projection/{}", if self.options.vertex_transform == VertexTransform::Strict { "strict" } else { "float" }),
            ),
            ("keys", format!("slots/keys/{keys}")),
            ("block_keys", format!("slots/block_keys/{keys}")),
            ("cell_keys", format!("slots/cell_keys/{keys}")),
            ("depth", format!("slots/depth/{}", self.options.depth.name())),
            ("owner", format!("slots/owner/{layout}")),
            ("scaling", format!("slots/scaling/{}", if self.options.render_scale.factor() > 1.0 { "average" } else { "between" })),
            ("finish", format!("slots/finish/{finish}")),
            ("dots", format!("slots/dots/{}", if self.dots.is_some() { "over" } else { "none" })),
            ("dot_ends", format!("slots/dot_ends/{}", if self.dots == Some(LineSource::Polyline) { "points" } else { "edges" })),
            ("dot_list", format!("slots/dot_list/{}", if self.options.dot_culling == DotCulling::Brute { "every" } else { "kept" })),
            ("image", format!("slots/image/{}", if pass == Pass::Resolve { "seen" } else { "none" })),
            ("sums", format!("slots/sums/{layout}")),
            ("walk", format!("slots/walk/{walk}")),
            ("discs", format!("slots/discs/{walk}")),
            ("bins", format!("slots/bins/{}", if pass.phase() == Some(RasterPhase::BinFill) { "fill" } else { "count" })),
            ("cells", format!("slots/cells/{cells}")),
            ("delay", format!("slots/delay/{}", if self.layers == Some(Layers::Race) { "raced" } else { "none" })),
            ("shading", format!("slots/shading/{shading}")),
            ("totals", format!("slots/totals/{}", self.options.xray_sums.name())),
            ("average", format!("slots/average/{}", self.options.xray_sums.name())),
        ];
        if let Some(phase) = pass.phase() {
            let file = match phase {
                RasterPhase::Packed => "packed64",
                RasterPhase::Packed32 => "packed32",
                RasterPhase::Depth => "split32_depth",
                RasterPhase::TriangleId => "split32_owner",
                RasterPhase::Count => "count",
                RasterPhase::CountSamples => "tally",
                RasterPhase::BoundaryTriangle => "straddle",
                RasterPhase::Sum => "sum",
                RasterPhase::Race => "race",
                RasterPhase::BinCount | RasterPhase::BinFill | RasterPhase::Tiles => return slots,
            };
            slots.push(("visibility", format!("slots/visibility/{file}")));
        }
        slots
    }

    /// The file of the order slot: tickets are drawn once, where depth is decided, and counts count everything.
    fn order_file(&self, pass: Pass) -> &'static str {
        match (self.order, pass.phase()) {
            (_, Some(RasterPhase::BoundaryTriangle)) => "straddler",
            (Order::Free, _) | (_, Some(RasterPhase::CountSamples)) | (Order::Scheduler, Some(RasterPhase::TriangleId)) => "free",
            _ if self.options.sample_counter == SampleCounter::Racy => "racy",
            (Order::Submission, _) => "submission",
            (Order::Scheduler, _) => "scheduler",
        }
    }
}

/// The file of the occlusion slot.
fn occlusion(pass: Pass) -> &'static str {
    match pass {
        Pass::Cull(CullPhase::PreviousFrame) => "before",
        Pass::Cull(CullPhase::Early) => "seen",
        Pass::Cull(CullPhase::Late) => "behind",
        _ => "none",
    }
}
