//! Draws and judges single pictures; the accuracy, stacks and work distributions that cases and
//! tests draw with.

use std::sync::Arc;

use pollster::FutureExt as _;

use super::checks::EarlyEnd;
use crate::{
    accuracy::{PinnedOptions, Visibility},
    effects::{Effect, Stack},
    gpu::{Capture, Renderer},
    measure::{Budget, ErrorReport, Verdict},
    oracle,
    plan::{AccuracyRequest, Caps, MOST_GLASS_LAYERS, Tuning},
    scene::{Scene, view::View},
};

/// Largest fraction of pixels in the depth band, where two triangle ids are correct. 16 pixels are
/// always allowed.
pub const MAX_DEPTH_BAND_FRACTION: f64 = 0.01;

/// Checks that all integers are exact, colors are within one step, and the depth band is small.
pub fn exactness(errors: &ErrorReport) -> Result<(), String> {
    errors.within(&Budget {
        max_depth_band_pixels: ((errors.pixels as f64 * MAX_DEPTH_BAND_FRACTION) as u64).max(16),
        ..Budget::default()
    })
}

/// How triangles are distributed over invocations and workgroups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkDistribution {
    /// A workgroup for each triangle that is not tiny.
    WorkgroupEach,
    /// The limits of a graphics card, with a resolve over listed tiles.
    CardListedTiles,
    /// The limits of a graphics card, with a resolve over all pixels.
    Card,
    /// One invocation for each triangle.
    InvocationEach,
}

impl WorkDistribution {
    /// Together they use every kernel.
    pub const ALL: [Self; 4] = [
        Self::WorkgroupEach,
        Self::CardListedTiles,
        Self::Card,
        Self::InvocationEach,
    ];

    /// The tuning that distributes work in this way.
    pub fn tuning(self) -> Tuning {
        let is_card = matches!(self, Self::CardListedTiles | Self::Card);
        let [max_small_samples, max_small_side] = match self {
            Self::WorkgroupEach => [1, 1],
            Self::CardListedTiles | Self::Card => [32, 32],
            Self::InvocationEach => [128 * 128, 128],
        };
        let listed_tiles = matches!(self, Self::CardListedTiles | Self::InvocationEach);
        Tuning {
            max_small_samples,
            group_size: if is_card { 256 } else { 64 },
            max_small_side,
            listed_tiles,
            early_load: listed_tiles,
            exchanges_maximum: self == Self::CardListedTiles,
            dot_groups: if is_card { 1024 } else { 1 },
            interleaves_triangles: !is_card,
            queue_groups: if self == Self::Card { 48 } else { 0 },
            hides_blocks: is_card,
            stored_uniforms: false,
            wide_loads: false,
            buffered_shadow_map: false,
            projects_points: true,
            glass_layers: MOST_GLASS_LAYERS,
            clears_in_passes: self == Self::Card,
            specialized: true,
        }
    }
}

/// The tunings of all work distributions.
pub fn tunings() -> [Tuning; 4] {
    WorkDistribution::ALL.map(WorkDistribution::tuning)
}

/// The visibility options that lose nothing and that an adapter has.
pub fn options(caps: &Caps) -> Vec<Visibility> {
    Visibility::EXACT
        .into_iter()
        .filter(|option| option.is_supported(caps.int64_atomics))
        .collect()
}

/// The exact option that a CPU adapter is quickest on, for what takes long.
pub fn quick_option(caps: &Caps) -> Visibility {
    if caps.int64_atomics {
        Visibility::Packed64
    } else {
        Visibility::Split32
    }
}

/// A request for one visibility option, all else planned.
pub fn pinned(visibility: Visibility) -> AccuracyRequest {
    AccuracyRequest {
        pins: PinnedOptions::of(visibility),
        ..AccuracyRequest::default()
    }
}

/// A stack of effects with default parameters.
///
/// # Panics
/// If an effect does not exist.
pub fn stack(names: &[&str]) -> Stack {
    let mut stack = Stack::default();
    for name in names {
        stack.enable(Effect::find(name).unwrap_or_else(|| panic!("no effect {name}")));
    }
    stack
}

/// Draws without judging.
///
/// # Errors
/// The error of the renderer or the device. A canceled picture is [`EarlyEnd::Stopped`].
pub fn captured(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<Capture, EarlyEnd> {
    let capture = async {
        renderer.set_scene(scene).await?;
        renderer.capture(view, stack, accuracy).await
    }
    .block_on()
    .map_err(|error| EarlyEnd::from(error).of(&scene.name))?;
    match renderer.gpu().take_error() {
        Some(error) => Err(format!("{}: the device reports {error}", scene.name).into()),
        None => Ok(capture),
    }
}

/// Draws and judges.
///
/// # Errors
/// The error of the renderer, the device or the oracle. A canceled picture is [`EarlyEnd::Stopped`].
pub fn judged(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<(Capture, Verdict), EarlyEnd> {
    let capture = captured(renderer, scene, view, stack, accuracy)?;
    let verdict = oracle::judge(scene, view, stack, &capture.picture())
        .map_err(|error| EarlyEnd::from(error).of(&scene.name))?;
    Ok((capture, verdict))
}
