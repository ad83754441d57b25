//! Frames: which passes draw a picture, and in which order.

use super::{
    key::KernelKey,
    pass::{CullPhase, Pass, RasterPhase, TriangleSource},
};
use crate::{
    accuracy::{Culling, DotCulling, Visibility},
    effects::{
        draw_order,
        hooks::{Layers, Shape},
    },
};

impl KernelKey {
    /// Every pass of one picture, in the order in which they are recorded.
    pub fn frame(&self) -> Vec<Pass> {
        let mut passes = self.passes(&self.phases());
        passes.extend(self.dot_passes());
        if self.options.culling == Culling::Hiz && !self.has_glass() {
            passes.push(Pass::DepthReduce);
        }
        if self.work.listed_tiles {
            passes.extend([Pass::ListTiles, Pass::Args]);
        }
        passes.push(Pass::Resolve);
        if self.lists_background() {
            passes.push(Pass::ResolveBackground);
        }
        passes.extend(self.image_passes());
        if self.is_scaled() {
            passes.push(Pass::Scale);
        }
        passes
    }

    /// Every pass of a shadow map of this kernel's scene: depth alone. The picture's own passes
    /// have written the vertices.
    pub fn light_frame(&self) -> Vec<Pass> {
        self.passes(&[RasterPhase::Depth])
            .into_iter()
            .filter(|pass| !matches!(pass, Pass::Particles | Pass::Skin))
            .collect()
    }

    /// Every pass of the frame that the judge asks for, which lists no layers of glass.
    pub fn judge_frame(&self) -> Vec<Pass> {
        let mut phases = self.phases();
        phases.retain(|phase| *phase != RasterPhase::Glass);
        self.passes(&phases)
    }

    /// The raster phases of one frame, in order.
    pub fn phases(&self) -> Vec<RasterPhase> {
        let nearest: &[RasterPhase] = match (self.framebuffer.layers, self.options.visibility) {
            (Some(Layers::Race), _) | (_, Visibility::Race) => &[RasterPhase::Race],
            (_, Visibility::Packed32) => &[RasterPhase::Packed32],
            (_, Visibility::Split32) => &[RasterPhase::Depth, RasterPhase::TriangleId],
            (_, Visibility::Packed64) if self.work.sums_with_nearest => {
                &[RasterPhase::NearestAndSum]
            }
            (_, Visibility::Packed64) => &[RasterPhase::Packed],
        };
        let layers: &[RasterPhase] = match self.framebuffer.layers {
            Some(Layers::Xray { .. }) if !self.work.sums_with_nearest => &[RasterPhase::Sum],
            Some(Layers::Overdraw) => &[RasterPhase::Count],
            Some(Layers::Glass) => &[RasterPhase::Glass],
            Some(Layers::Xray { .. } | Layers::Race) | None => &[],
        };
        [self.order_phases(), nearest, layers].concat()
    }

    /// Raster phases that find the sample at which a draw order stops, before anything is drawn.
    pub const fn order_phases(&self) -> &'static [RasterPhase] {
        match self.samples.draw_order {
            None => &[],
            Some(draw_order::Mode::Submission) => {
                &[RasterPhase::CountSamples, RasterPhase::BoundaryTriangle]
            }
            Some(draw_order::Mode::Scheduler) => &[RasterPhase::CountSamples],
        }
    }

    /// Passes up to the last of the given raster phases.
    pub fn passes(&self, phases: &[RasterPhase]) -> Vec<Pass> {
        let mut passes = Vec::new();
        if self.generated.has_particles {
            passes.push(Pass::Particles);
        }
        if self.deforms() {
            passes.push(Pass::Skin);
        }
        // Sample setups are computed for all triangles, which takes all vertices.
        let projects_all = !self.culls() || self.sample_setups() > 0;
        let writes_records = !(self.work.projects_points && self.samples.only_points);
        if projects_all && writes_records {
            passes.push(Pass::Project);
        }
        if self.sample_setups() > 0 {
            passes.push(Pass::SampleSetup(TriangleSource::Triangles));
        }
        let Some((&first, others)) = phases.split_first() else {
            return passes;
        };
        for &cull_phase in self.cull_phases() {
            if cull_phase == CullPhase::Late {
                passes.extend([
                    Pass::DepthReduce,
                    Pass::AdvanceQueues {
                        reopens_queues: false,
                    },
                ]);
            }
            passes.extend([Pass::Cull(cull_phase), Pass::Args]);
            if !projects_all {
                passes.push(Pass::ProjectMeshlets);
            }
            passes.extend(self.raster_passes(first, true));
        }
        if !self.culls() {
            passes.extend(self.raster_passes(first, true));
        }
        if self.options.culling == Culling::TwoPass && !others.is_empty() {
            passes.extend([
                Pass::AdvanceQueues {
                    reopens_queues: true,
                },
                Pass::Args,
            ]);
        }
        passes.extend(others.iter().flat_map(|&phase| match phase {
            RasterPhase::Glass => self.glass_passes(),
            _ => self.raster_passes(phase, false),
        }));
        passes
    }

    /// The culling phases in which meshlets are drawn.
    const fn cull_phases(&self) -> &'static [CullPhase] {
        match self.options.culling {
            Culling::None => &[],
            Culling::Frustum => &[CullPhase::FrustumOnly],
            Culling::Hiz => &[CullPhase::PreviousFrame],
            Culling::TwoPass => &[CullPhase::Early, CullPhase::Late],
        }
    }

    /// The passes of a raster phase; the first phase of a frame fills the queues.
    fn raster_passes(&self, phase: RasterPhase, is_first: bool) -> Vec<Pass> {
        let mut passes = Vec::new();
        match self.samples.shape {
            Shape::Triangles if self.draws_cloud() => {
                passes.push(Pass::RasterCloud(phase));
                passes.extend((!self.samples.only_points).then_some(Pass::RasterSmall(phase)));
            }
            Shape::Triangles | Shape::Boxes if self.draws_all_at_once() && !is_first => {
                passes.push(Pass::RasterAll(phase))
            }
            Shape::Triangles | Shape::Boxes => passes.push(Pass::RasterSmall(phase)),
            Shape::Points => passes.push(Pass::RasterPoints(phase)),
        }
        if is_first {
            passes.extend(self.queue_passes());
        }
        if passes != [Pass::RasterAll(phase)] {
            passes.extend(self.paths.has_medium.then_some(Pass::RasterMedium(phase)));
            passes.extend(self.paths.has_large.then_some(Pass::RasterLarge(phase)));
        }
        match phase {
            RasterPhase::CountSamples => {
                passes.extend([Pass::OrderSums, Pass::OrderLimit, Pass::OrderRanks])
            }
            RasterPhase::BoundaryTriangle => passes.push(Pass::OrderCut),
            _ => {}
        }
        passes
    }

    /// The passes that draw and compose layers of glass, band after band. They put the first layer in
    /// the place of what is opaque, so the depths that the next picture is culled against are taken
    /// before.
    fn glass_passes(&self) -> Vec<Pass> {
        let mut passes = Vec::new();
        if self.options.culling == Culling::Hiz {
            passes.push(Pass::DepthReduce);
        }
        for _ in 0..self.framebuffer.glass_bands {
            passes.push(Pass::GlassBand);
            passes.extend(self.raster_passes(RasterPhase::Glass, false));
            passes.push(Pass::GlassCompose);
        }
        passes
    }

    /// The passes that clip and divide the triangles which the first raster pass has queued.
    fn queue_passes(&self) -> Vec<Pass> {
        let mut passes = Vec::new();
        // Passes of a fixed size need no arguments.
        let is_indirect = self.work.queue_groups == 0;
        let sets_up_clipped = self.paths.has_clipping && self.sample_setups() > 0;
        if self.paths.has_clipping {
            passes.extend(is_indirect.then_some(Pass::Args));
            passes.push(Pass::Clip);
        }
        if self.has_queues() && is_indirect || sets_up_clipped {
            passes.push(Pass::Args);
        }
        if sets_up_clipped {
            passes.push(Pass::SampleSetup(TriangleSource::ClippedTriangles));
        }
        if self.paths.has_large && !self.divides_in_medium() {
            passes.push(Pass::TileLarge);
            passes.extend(is_indirect.then_some(Pass::Args));
        }
        passes
    }

    /// Does the first pass over the medium queue find the tiles of large triangles, too? No count
    /// decides how many workgroups it has.
    pub const fn divides_in_medium(&self) -> bool {
        self.paths.has_medium && self.paths.has_large && self.work.queue_groups > 0
    }

    /// Does each raster phase but the first draw the triangles of all queues in one pass? No count
    /// decides how many workgroups that has.
    const fn draws_all_at_once(&self) -> bool {
        (self.paths.has_medium || self.paths.has_large) && self.work.queue_groups > 0
    }

    /// The passes that draw dots, after those that find the nearest depths.
    fn dot_passes(&self) -> &'static [Pass] {
        match (self.effects.dots, self.options.dot_culling) {
            (None, _) => &[],
            (Some(_), DotCulling::Brute | DotCulling::Cpu) => &[Pass::DotsEnds, Pass::DotsDraw],
            (Some(_), DotCulling::Gpu) => &[
                Pass::DotsEnds,
                Pass::DotsCull,
                Pass::DotsArgs,
                Pass::DotsDraw,
            ],
        }
    }

    /// Does this pass visit every triangle first, and so fill the queues and count?
    pub(super) fn is_first_visit(&self, pass: Pass) -> bool {
        match self.order_phases().first() {
            Some(&first) => pass.phase() == Some(first),
            None => {
                let is_second_visit = pass.phase() == Some(RasterPhase::TriangleId);
                !is_second_visit && !self.uses_second_counter(pass)
            }
        }
    }

    /// Does this pass visit all layers of a frame that has found the nearest before, and so count
    /// in the second counter? The judge counts layers in a frame of its own, unless the picture
    /// itself shows the count.
    pub(super) fn uses_second_counter(&self, pass: Pass) -> bool {
        match pass.phase() {
            Some(RasterPhase::Sum | RasterPhase::Glass) => true,
            Some(RasterPhase::Count) => self.framebuffer.layers == Some(Layers::Overdraw),
            _ => false,
        }
    }
}
