//! What a calibration measures for the planner: whole frames with options beside frames with the defaults, and with other limits of the samples
//! that one invocation walks.

use std::sync::Arc;

use super::{calibration::Ready, device::Gpu, error::RenderError};
use crate::{
    accuracy::{AXES, PinnedOptions},
    measure::timing,
    plan::{AccuracyRequest, MEASURED_OPTIONS, MEASURED_TRIANGLES, OptionCosts, Tuning},
};

/// Size of the pictures that options and limits are measured with, pixels.
const OPTIONS_SIZE: [u32; 2] = [960, 540];

/// Triangles of the spheres that limits are measured with: some have more samples than a limit, some fewer.
const LIMITS_TRIANGLES: [u32; 3] = [3000, 12_000, 50_000];

/// Fraction of the usual limit's time below which another limit is taken instead.
const WORTHWHILE: f64 = 0.97;

/// Frames of each option and limit that are timed.
const OPTION_FRAMES: usize = 9;

/// Medians of whole frames of pictures that are drawn in turn, so that a clock that drifts or other work on the machine meets all of them.
fn in_turn(contenders: &mut [Ready]) -> Result<Vec<f64>, RenderError> {
    let mut times = vec![Vec::new(); contenders.len()];
    for _ in 0..OPTION_FRAMES {
        for (contender, times) in contenders.iter_mut().zip(&mut times) {
            times.push(contender.whole_ms()?);
        }
    }
    Ok(times.iter().map(|times| timing::percentile(times, 0.5).unwrap_or(0.0).max(f64::MIN_POSITIVE)).collect())
}

/// The defaults first, then every measured option that this adapter can hold, each on both scenes.
pub(super) fn option_pictures(gpu: &Arc<Gpu>, tuning: Tuning) -> Result<Vec<(Option<usize>, [Ready; 2])>, RenderError> {
    let [few, many] = MEASURED_TRIANGLES.map(|triangles| format!("sphere?triangles={triangles}"));
    let ready = |pins: PinnedOptions| -> Result<[Ready; 2], RenderError> {
        let accuracy = AccuracyRequest { pins, ..AccuracyRequest::default() };
        let picture = |query| Ready::new(gpu, &(query, &[("lambert", &[])], OPTIONS_SIZE), accuracy, tuning);
        Ok([picture(&few)?, picture(&many)?])
    };
    let mut pictures = vec![(None, ready(PinnedOptions::default())?)];
    for (at, (axis, option)) in MEASURED_OPTIONS.into_iter().enumerate() {
        let mut pins = PinnedOptions::default();
        pins.set(&AXES[axis], Some(option));
        match ready(pins) {
            Ok(both) => pictures.push((Some(at), both)),
            // The adapter cannot hold it, so it is never chosen.
            Err(RenderError::Plan(_)) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(pictures)
}

/// Limits of samples that one invocation walks: the usual one first.
fn limits(usual: u32) -> [u32; 3] {
    [usual, usual / 4, (usual * 4).min(128 * 128)]
}

/// Every limit on every sphere.
pub(super) fn limit_pictures(gpu: &Arc<Gpu>, usual: Tuning) -> Result<Vec<(u32, Vec<Ready>)>, RenderError> {
    let mut pictures: Vec<(u32, Vec<Ready>)> = Vec::new();
    for max_small_samples in limits(usual.max_small_samples) {
        if pictures.iter().any(|(limit, _)| *limit == max_small_samples) {
            continue;
        }
        let tuning = Tuning { max_small_samples, ..usual };
        let of = |triangles: u32| {
            let query = format!("sphere?triangles={triangles}");
            Ready::new(gpu, &(&query, &[("lambert", &[])], OPTIONS_SIZE), AccuracyRequest::default(), tuning)
        };
        pictures.push((max_small_samples, LIMITS_TRIANGLES.into_iter().map(of).collect::<Result<_, _>>()?));
    }
    Ok(pictures)
}

/// Milliseconds of every option, and of none that the adapter cannot hold: those of the defaults.
pub(super) fn option_costs(pictures: Vec<(Option<usize>, [Ready; 2])>) -> Result<OptionCosts, RenderError> {
    let (names, both): (Vec<_>, Vec<_>) = pictures.into_iter().unzip();
    let (mut few, mut many) = (Vec::new(), Vec::new());
    for [with_few, with_many] in both {
        few.push(with_few);
        many.push(with_many);
    }
    let [few, many] = [in_turn(&mut few)?, in_turn(&mut many)?];
    let defaults_ms = [few[0], many[0]];
    let mut costs = OptionCosts { defaults_ms, options_ms: [defaults_ms; MEASURED_OPTIONS.len()] };
    for (at, ms) in names.into_iter().zip(few.into_iter().zip(many)) {
        if let Some(at) = at {
            costs.options_ms[at] = ms.into();
        }
    }
    Ok(costs)
}

/// The limit that the spheres take least time with together; the usual one unless another saves more than noise.
pub(super) fn best_limit(pictures: Vec<(u32, Vec<Ready>)>) -> Result<u32, RenderError> {
    let usual = pictures[0].0;
    let (limits, spheres): (Vec<u32>, Vec<Vec<Ready>>) = pictures.into_iter().unzip();
    let per_limit = LIMITS_TRIANGLES.len();
    let times = in_turn(&mut spheres.into_iter().flatten().collect::<Vec<_>>())?;
    let sums = times.chunks(per_limit).map(|times| times.iter().sum::<f64>());
    let mut best = (usual, WORTHWHILE * times[..per_limit].iter().sum::<f64>());
    for (limit, ms) in limits.into_iter().zip(sums).skip(1) {
        if ms < best.1 {
            best = (limit, ms);
        }
    }
    Ok(best.0)
}
