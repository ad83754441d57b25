//! Frames: which passes draw a picture, and in which order.

use super::{
    key::{KernelKey, RasterPhase},
    pass::{CullPhase, Pass, TriangleSource},
};
use crate::{accuracy::Culling, effects::hooks::Shape};

impl KernelKey {
    /// Are meshlets left out that cannot be seen?
    pub fn culls(&self) -> bool {
        self.options.culling != Culling::None
    }

    /// Rounds in which meshlets are drawn.
    const fn rounds(&self) -> &'static [CullPhase] {
        match self.options.culling {
            Culling::None => &[],
            Culling::Frustum => &[CullPhase::FrustumOnly],
            Culling::Hiz => &[CullPhase::PreviousFrame],
            Culling::TwoPass => &[CullPhase::Early, CullPhase::Late],
        }
    }

    /// Every pass of one picture, in the order in which they are recorded.
    pub fn frame(&self) -> Vec<Pass> {
        let mut passes = self.passes(&self.phases());
        passes.extend(self.dot_passes());
        if self.options.culling == Culling::Hiz {
            passes.push(Pass::DepthReduce);
        }
        if self.listed_tiles {
            passes.extend([Pass::ListTiles, Pass::Args]);
        }
        passes.push(Pass::Resolve);
        if self.is_scaled() {
            passes.push(Pass::Scale);
        }
        passes
    }

    /// Every pass of what a light sees of this kernel's scene: depth alone. Whatever bends has been bent for the picture.
    pub fn light_frame(&self) -> Vec<Pass> {
        self.passes(&[RasterPhase::Depth]).into_iter().filter(|pass| !matches!(pass, Pass::Particles | Pass::Skin)).collect()
    }

    /// Passes up to the last of the given raster phases.
    pub fn passes(&self, phases: &[RasterPhase]) -> Vec<Pass> {
        let mut passes = Vec::new();
        if self.has_particles {
            passes.push(Pass::Particles);
        }
        if self.deforms() {
            passes.push(Pass::Skin);
        }
        // What is settled per triangle is settled for all, so that all vertices are wanted.
        let is_whole = !self.culls() || self.sample_setups > 0;
        if is_whole {
            passes.push(Pass::Project);
        }
        if self.sample_setups > 0 {
            passes.push(Pass::SampleSetup(TriangleSource::Triangles));
        }
        let has_walks = phases.iter().any(|phase| !phase.is_tiled());
        let Some((&first, others)) = phases.split_first() else { return passes };
        for &round in self.rounds() {
            if round == CullPhase::Late {
                passes.extend([Pass::DepthReduce, Pass::AdvanceQueues { reopens_queues: false }]);
            }
            passes.extend([Pass::Cull(round), Pass::Args]);
            if !is_whole {
                passes.push(Pass::ProjectMeshlets);
            }
            self.visit(first, true, has_walks, &mut passes);
        }
        if !self.culls() {
            self.visit(first, true, has_walks, &mut passes);
        }
        if self.options.culling == Culling::TwoPass && !others.is_empty() {
            passes.extend([Pass::AdvanceQueues { reopens_queues: true }, Pass::Args]);
        }
        others.iter().for_each(|&phase| self.visit(phase, false, has_walks, &mut passes));
        passes
    }

    /// The passes of a raster phase; the first one fills the queues.
    fn visit(&self, phase: RasterPhase, is_first: bool, has_walks: bool, passes: &mut Vec<Pass>) {
        if phase == RasterPhase::Tiles {
            passes.push(Pass::RasterTiles);
            return;
        }
        passes.push(if self.shape == Shape::Points { Pass::RasterPoints(phase) } else { Pass::RasterSmall(phase) });
        if is_first && self.has_clipping {
            passes.extend([Pass::Args, Pass::Clip]);
        }
        if is_first && self.has_queues() {
            passes.push(Pass::Args);
        }
        if is_first && self.has_clipping && self.sample_setups > 0 {
            passes.push(Pass::SampleSetup(TriangleSource::ClippedTriangles));
        }
        if is_first && self.has_large && has_walks {
            passes.extend([Pass::TileLarge, Pass::Args]);
        }
        if self.has_medium {
            passes.push(if phase.is_bin() { Pass::BinMedium(phase) } else { Pass::RasterMedium(phase) });
        }
        if self.has_large {
            passes.push(if phase.is_bin() { Pass::BinLarge(phase) } else { Pass::RasterLarge(phase) });
        }
        match phase {
            RasterPhase::CountSamples => passes.extend([Pass::OrderSums, Pass::OrderLimit, Pass::OrderRanks]),
            RasterPhase::BoundaryTriangle => passes.push(Pass::OrderCut),
            RasterPhase::BinCount => passes.push(Pass::BinScan),
            _ => {}
        }
    }
}
