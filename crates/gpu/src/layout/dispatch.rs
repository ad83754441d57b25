//! How many workgroups each pass of a frame takes.

use std::mem::offset_of;

use super::{
    frame_layout::{
        FrameLayout, HIZ_BLOCK, ORDER_BLOCK, RESOLVE_TILE, Region, WORD, vertex_records,
    },
    glass::band_length,
    records::{CounterRecord, DispatchArgs},
    resource_id::BufferId,
};
use crate::{
    accuracy::DotCulling,
    shader::{
        key::KernelKey,
        pass::{Pass, TriangleSource},
    },
};

/// How many workgroups a pass takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dispatch {
    /// So many.
    Direct { groups: [u32; 2] },
    /// As many as a buffer says at this byte.
    Indirect { buffer: BufferId, offset: u64 },
}

/// Most workgroups that share a medium triangle or a tile of a large one, as the kernels have it.
const MOST_PARTS: u32 = 4;
/// Workgroups that a pass over a queue has even where a picture before had an empty queue: a fuller
/// one is then drawn by 1,024 workgroups in turn.
const LEAST_QUEUE_GROUPS: u32 = 1024;
/// Invocations of a workgroup of the passes over queues.
const QUEUE_GROUP: u32 = 64;
/// Most pixels, or pairs of words of sums, that an invocation of the first pass clears.
const CLEARED_PIXELS: u64 = 4;

/// Runs of dots that a workgroup culls at least, where there are so many. It lists their dots, up
/// to 64 to a run, 64 at a time.
const FEW_RUNS: u32 = 8;
/// Invocations of a workgroup of the passes over dots.
pub const DOT_GROUP: u32 = 64;
/// Invocations of a workgroup of the pass that composes layers of glass.
const GLASS_GROUP: u64 = 64;
/// Invocations of a workgroup of the pass that lists tiles.
const TILE_GROUP: u32 = 64;

impl FrameLayout {
    /// Workgroups that the entries of a pass's queue can keep busy, as a rule.
    fn usually_queued(&self, pass: Pass) -> u32 {
        let room = &self.capacities;
        // Large triangles are few, as a rule, and workgroups that find none cost a little too.
        let most_large = room.large.div_ceil(4);
        match pass {
            Pass::Clip => room.clip.div_ceil(64),
            Pass::TileLarge => most_large,
            // Several workgroups may share an entry.
            Pass::RasterMedium(_) => room.medium.saturating_mul(MOST_PARTS).max(most_large),
            Pass::RasterAll(_) => room
                .medium
                .saturating_mul(MOST_PARTS)
                .max(room.tiles.div_ceil(8)),
            _ => room.tiles.div_ceil(8),
        }
    }

    /// Workgroups of a pass over a queue, of which each takes entries in turn. `demand` is what a
    /// picture before counted: where its queues held little, fewer workgroups find work, and
    /// those that find none cost a little too. A queue that held more since is drawn whole.
    fn queue_groups(&self, key: &KernelKey, pass: Pass, demand: Option<&CounterRecord>) -> u32 {
        let most = key.work.queue_groups.max(1);
        let usual = most.min(self.usually_queued(pass)).max(1);
        let Some(demand) = demand else { return usual };
        let medium = demand.medium.saturating_mul(MOST_PARTS);
        let tiles = demand.tiles.saturating_mul(MOST_PARTS);
        let held = match pass {
            Pass::Clip => demand.clip.div_ceil(64),
            Pass::TileLarge => demand.large,
            Pass::RasterMedium(_) => medium.max(demand.large),
            Pass::RasterAll(_) => medium.max(tiles),
            _ => tiles,
        };
        held.clamp(LEAST_QUEUE_GROUPS.min(usual), most)
    }

    /// How many workgroups a pass takes. `demand` is what the queues of a picture before held,
    /// where it is known.
    pub fn dispatch(
        &self,
        key: &KernelKey,
        pass: Pass,
        demand: Option<&CounterRecord>,
    ) -> Dispatch {
        let scene = &self.scene;
        let (triangles, group) = (scene.triangles as u32, key.work.group_size);
        let over = |count: u32| Dispatch::once(fold_groups(count.div_ceil(group)));
        let dots = self.dots.unwrap_or_default();
        let over_dots = |count: u32| Dispatch::once(fold_groups(count.div_ceil(DOT_GROUP)));
        match pass {
            Pass::Particles => over(scene.particles),
            Pass::Skin => over(scene.deformable),
            Pass::Project if key.work.clears_in_passes => {
                let sums = self
                    .region(Region::XraySums)
                    .map_or(0, |span| (span.bytes.end - span.bytes.start) / (2 * WORD));
                let clearing = (self.pixels() + sums).div_ceil(CLEARED_PIXELS) as u32;
                over((vertex_records(key, scene) as u32).max(clearing).max(1))
            }
            Pass::Project => over(vertex_records(key, scene) as u32),
            Pass::Cull(_) => over(scene.meshlets),
            Pass::DepthReduce => Dispatch::once(self.tiles(HIZ_BLOCK)),
            Pass::ProjectMeshlets => Dispatch::args(offset_of!(DispatchArgs, meshlets)),
            Pass::RasterSmall(_) if key.culls() => {
                Dispatch::args(offset_of!(DispatchArgs, meshlets))
            }
            Pass::RasterPoints(_) => {
                over(triangles.saturating_mul(key.work.invocations_per_triangle))
            }
            Pass::RasterCloud(_) => Dispatch::once(fold_groups(scene.point_blocks)),
            Pass::RasterSmall(_) if key.draws_cloud() => over(triangles - scene.points as u32),
            Pass::RasterSmall(_) => over(triangles),
            Pass::SampleSetup(TriangleSource::Triangles) => over(triangles),
            Pass::SampleSetup(TriangleSource::ClippedTriangles) => {
                Dispatch::args(offset_of!(DispatchArgs, clipped_triangles))
            }
            Pass::OrderSums | Pass::OrderRanks => {
                Dispatch::once(fold_groups(triangles.div_ceil(ORDER_BLOCK as u32)))
            }
            Pass::OrderLimit
            | Pass::OrderCut
            | Pass::Args
            | Pass::AdvanceQueues { .. }
            | Pass::GlassBand
            | Pass::DotsArgs => Dispatch::once([1, 1]),
            Pass::GlassCompose => {
                let band = band_length(self.pixels(), key.framebuffer.glass_bands);
                Dispatch::once(fold_groups(band.div_ceil(GLASS_GROUP) as u32))
            }
            Pass::Clip | Pass::TileLarge | Pass::RasterMedium(_) | Pass::RasterLarge(_)
                if key.work.queue_groups > 0 =>
            {
                Dispatch::once([self.queue_groups(key, pass, demand), 1])
            }
            Pass::RasterAll(_) => Dispatch::once(fold_groups(
                triangles.div_ceil(QUEUE_GROUP) + self.queue_groups(key, pass, demand),
            )),
            Pass::Clip => Dispatch::args(offset_of!(DispatchArgs, clip)),
            Pass::RasterMedium(_) => Dispatch::args(offset_of!(DispatchArgs, medium)),
            Pass::TileLarge => Dispatch::args(offset_of!(DispatchArgs, large)),
            Pass::RasterLarge(_) => Dispatch::args(offset_of!(DispatchArgs, tiles)),
            Pass::DotsEnds => over_dots(dots.segments),
            Pass::DotsCull => {
                let groups = dots.runs.div_ceil(FEW_RUNS).min(key.work.dot_groups);
                Dispatch::once(fold_groups(groups.max(dots.runs.div_ceil(DOT_GROUP))))
            }
            Pass::DotsDraw | Pass::DotsProbe => match key.options.dot_culling {
                DotCulling::Brute => over_dots(dots.dots),
                DotCulling::Cpu => over_dots(dots.chosen),
                DotCulling::Gpu => Dispatch::Indirect {
                    buffer: BufferId::DotArgs,
                    offset: 0,
                },
            },
            Pass::ListTiles => Dispatch::once(fold_groups(
                (self.tile_count(RESOLVE_TILE) as u32).div_ceil(TILE_GROUP),
            )),
            Pass::Resolve if key.work.listed_tiles => {
                Dispatch::args(offset_of!(DispatchArgs, resolve))
            }
            Pass::Resolve => Dispatch::once(self.tiles(key.tile_side())),
            Pass::ResolveBackground => Dispatch::args(offset_of!(DispatchArgs, background)),
            Pass::ImageBegin => Dispatch::once(self.tiles(RESOLVE_TILE)),
            Pass::Image(_) => {
                let scale = key.image_step(pass).map_or(1, |step| step.scale);
                Dispatch::once(self.tiles(scale).map(|side| side.div_ceil(RESOLVE_TILE)))
            }
            Pass::Scale => Dispatch::once(self.shown.map(|side| side.div_ceil(RESOLVE_TILE))),
        }
    }
}

impl Dispatch {
    fn once(groups: [u32; 2]) -> Self {
        Self::Direct { groups }
    }

    /// By a member of [`DispatchArgs`].
    fn args(offset: usize) -> Self {
        Self::Indirect {
            buffer: BufferId::DispatchArgs,
            offset: offset as u64,
        }
    }
}

/// Folds more than 65,535 workgroups into two dimensions; the kernel guards the tail.
pub fn fold_groups(groups: u32) -> [u32; 2] {
    [groups.min(65_535), groups.div_ceil(65_535)]
}
