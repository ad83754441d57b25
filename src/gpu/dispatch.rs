//! Dispatch: how many workgroups each pass of a frame takes, or where on the device that stands.

use crate::{
    scene::view::View,
    shader::{
        key::KernelKey,
        pass::{Pass, TriangleSource},
    },
};

/// How many workgroups a pass takes.
pub enum Dispatch {
    Direct([u32; 2]),
    /// Byte offset in the argument buffer.
    Indirect(u64),
    /// As many as the dots that were listed on the device.
    Listed,
}

/// Workgroups of `pass` over so many projected vertices, triangles, vertices that may bend, meshlets of all instances, and
/// particles, in a picture of `view` that is shown at another size.
pub fn dispatch(
    pass: Pass,
    [vertices, triangles, deformed, meshlets, particles]: [u32; 5],
    view: &View,
    shown: [u32; 2],
    key: &KernelKey,
) -> Dispatch {
    match pass {
        Pass::Particles => Dispatch::Direct(folded(particles.div_ceil(key.work.group_size))),
        Pass::Skin => Dispatch::Direct(folded(deformed.div_ceil(key.work.group_size))),
        Pass::Project => Dispatch::Direct(folded(vertices.div_ceil(key.work.group_size))),
        Pass::Cull(_) => Dispatch::Direct(folded(meshlets.div_ceil(key.work.group_size))),
        Pass::DepthReduce => Dispatch::Direct([view.width.div_ceil(64), view.height.div_ceil(64)]),
        Pass::AdvanceQueues { .. } => Dispatch::Direct([1, 1]),
        Pass::ProjectMeshlets => Dispatch::Indirect(72),
        Pass::RasterSmall(_) if key.culls() => Dispatch::Indirect(72),
        Pass::RasterPoints(phase) if !phase.is_bin() => {
            Dispatch::Direct(folded(triangles.saturating_mul(key.work.invocations_per_triangle).div_ceil(key.work.group_size)))
        }
        Pass::RasterSmall(_) | Pass::RasterPoints(_) => Dispatch::Direct(folded(triangles.div_ceil(key.work.group_size))),
        Pass::SampleSetup(TriangleSource::Triangles) => Dispatch::Direct(folded(triangles.div_ceil(key.work.group_size))),
        Pass::SampleSetup(TriangleSource::ClippedTriangles) => Dispatch::Indirect(60),
        Pass::OrderSums | Pass::OrderRanks => Dispatch::Direct(folded(triangles.div_ceil(1024))),
        Pass::OrderLimit | Pass::OrderCut => Dispatch::Direct([1, 1]),
        Pass::Args => Dispatch::Direct([1, 1]),
        Pass::Clip => Dispatch::Indirect(0),
        Pass::RasterMedium(_) => Dispatch::Indirect(12),
        Pass::TileLarge | Pass::BinLarge(_) => Dispatch::Indirect(24),
        Pass::BinMedium(_) => Dispatch::Indirect(12),
        Pass::BinScan => Dispatch::Direct([1, 1]),
        Pass::RasterTiles => Dispatch::Direct([view.width.div_ceil(16), view.height.div_ceil(16)]),
        Pass::RasterLarge(_) => Dispatch::Indirect(36),
        Pass::DotsEnds | Pass::DotsCull | Pass::DotsArgs | Pass::DotsDraw | Pass::DotsProbe => {
            unreachable!("how many dots there are, only their store knows")
        }
        Pass::ListTiles => Dispatch::Direct(folded((view.width.div_ceil(8) * view.height.div_ceil(8)).div_ceil(64))),
        Pass::Resolve if key.work.listed_tiles => Dispatch::Indirect(48),
        Pass::Scale => Dispatch::Direct(shown.map(|side| side.div_ceil(8))),
        Pass::Resolve => Dispatch::Direct([view.width.div_ceil(key.tile_side()), view.height.div_ceil(key.tile_side())]),
    }
}

/// Folds more than 65,535 workgroups into two dimensions; the kernel guards the tail.
pub fn folded(groups: u32) -> [u32; 2] {
    [groups.min(65_535), groups.div_ceil(65_535)]
}
