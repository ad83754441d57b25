//! What a calibration measures for the planner: whole frames with options beside frames with the defaults, and with other limits of the samples
//! that one invocation walks.

use std::sync::Arc;

use rayon::prelude::*;

use super::{device::Gpu, error::RenderError, timed_picture::TimedPicture};
use crate::{
    accuracy::{AXES, PinnedOptions},
    plan::{AccuracyRequest, MEASURED_OPTIONS, MEASURED_TRIANGLES, MOST_SMALL_SAMPLES, OptionCosts, Tuning},
};

/// Size of the pictures that options and limits are measured with, pixels.
const OPTIONS_SIZE: [u32; 2] = [960, 540];

/// Triangles of the spheres that limits are measured with: some have more samples than a limit, some fewer.
const LIMITS_TRIANGLES: [u32; 3] = [3000, 12_000, 50_000];

/// Fraction of the usual limit's time below which another limit is taken instead.
const WORTHWHILE: f64 = 0.95;

/// Frames of each option and limit that are timed.
const OPTION_FRAMES: usize = 9;

/// The shortest of several whole frames of pictures that are drawn in turn, so that a clock that drifts meets all of them; other work on the
/// machine only makes frames longer.
///
/// # Errors
/// When the adapter writes no timestamps, or the device is lost.
fn in_turn(contenders: &mut [TimedPicture]) -> Result<Vec<f64>, RenderError> {
    let mut times = vec![Vec::new(); contenders.len()];
    for _ in 0..OPTION_FRAMES {
        for (contender, times) in contenders.iter_mut().zip(&mut times) {
            times.extend(contender.whole_ms()?);
        }
    }
    times.iter().map(|times| times.iter().copied().reduce(f64::min).ok_or(RenderError::NoTimestamps)).collect()
}

/// Both scenes drawn with an option.
pub(super) struct OptionPictures {
    /// Index in [`MEASURED_OPTIONS`]; none for the defaults.
    option: Option<usize>,
    scenes: [TimedPicture; 2],
}

/// All spheres drawn with a limit.
pub(super) struct LimitPictures {
    max_small_samples: u32,
    spheres: Vec<TimedPicture>,
}

/// The defaults first, then every measured option that this adapter can hold.
///
/// # Errors
/// When a picture cannot be drawn, or the device is lost.
pub(super) fn option_pictures(gpu: &Arc<Gpu>, tuning: Tuning) -> Result<Vec<OptionPictures>, RenderError> {
    let [few, many] = MEASURED_TRIANGLES.map(|triangles| format!("sphere?triangles={triangles}"));
    let ready = |pins: PinnedOptions| -> Result<[TimedPicture; 2], RenderError> {
        let accuracy = AccuracyRequest { pins, ..AccuracyRequest::default() };
        let picture = |query| TimedPicture::new(gpu, &(query, &[("lambert", &[])], OPTIONS_SIZE), accuracy, tuning);
        Ok([picture(&few)?, picture(&many)?])
    };
    let pinned = |(at, &(axis, option)): (usize, &(usize, usize))| {
        let mut pins = PinnedOptions::default();
        pins.set(&AXES[axis], Some(option));
        match ready(pins) {
            Ok(scenes) => Ok(Some(OptionPictures { option: Some(at), scenes })),
            // The adapter cannot hold it, so it is never chosen.
            Err(RenderError::Plan(_)) => Ok(None),
            Err(error) => Err(error),
        }
    };
    let mut pictures = vec![OptionPictures { option: None, scenes: ready(PinnedOptions::default())? }];
    let measured = MEASURED_OPTIONS.par_iter().enumerate().map(pinned).collect::<Result<Vec<_>, _>>()?;
    pictures.extend(measured.into_iter().flatten());
    Ok(pictures)
}

/// Limits of samples that one invocation walks: the usual one first, each once.
fn limits(usual: u32) -> Vec<u32> {
    let mut limits = vec![usual, usual / 4];
    limits.extend(Some((usual * 4).min(MOST_SMALL_SAMPLES)).filter(|more| *more > usual));
    limits
}

/// Every limit on every sphere.
///
/// # Errors
/// When a picture cannot be drawn, or the device is lost.
pub(super) fn limit_pictures(gpu: &Arc<Gpu>, usual: Tuning) -> Result<Vec<LimitPictures>, RenderError> {
    let of_limit = |max_small_samples: u32| {
        let tuning = Tuning { max_small_samples, ..usual };
        let of = |triangles: u32| {
            let query = format!("sphere?triangles={triangles}");
            TimedPicture::new(gpu, &(&query, &[("lambert", &[])], OPTIONS_SIZE), AccuracyRequest::default(), tuning)
        };
        let spheres = LIMITS_TRIANGLES.into_iter().map(of).collect::<Result<_, _>>()?;
        Ok(LimitPictures { max_small_samples, spheres })
    };
    limits(usual.max_small_samples).into_par_iter().map(of_limit).collect()
}

/// Milliseconds of every option; those of the defaults for options that the adapter cannot hold.
///
/// # Errors
/// When the adapter writes no timestamps, or the device is lost.
pub(super) fn option_costs(pictures: Vec<OptionPictures>) -> Result<OptionCosts, RenderError> {
    let options: Vec<_> = pictures.iter().map(|pictures| pictures.option).collect();
    let (mut few, mut many) = (Vec::new(), Vec::new());
    for OptionPictures { scenes: [with_few, with_many], .. } in pictures {
        few.push(with_few);
        many.push(with_many);
    }
    let [few, many] = [in_turn(&mut few)?, in_turn(&mut many)?];
    let defaults_ms = [few[0], many[0]];
    let mut costs = OptionCosts { defaults_ms, options_ms: [defaults_ms; MEASURED_OPTIONS.len()] };
    for (option, ms) in options.into_iter().zip(few.into_iter().zip(many)) {
        if let Some(option) = option {
            costs.options_ms[option] = ms.into();
        }
    }
    Ok(costs)
}

/// The limit that the spheres take least time with together; the usual one unless another saves more than noise.
///
/// # Errors
/// When the adapter writes no timestamps, or the device is lost.
pub(super) fn best_limit(pictures: Vec<LimitPictures>) -> Result<u32, RenderError> {
    let limits: Vec<u32> = pictures.iter().map(|pictures| pictures.max_small_samples).collect();
    let times = in_turn(&mut pictures.into_iter().flat_map(|pictures| pictures.spheres).collect::<Vec<_>>())?;
    let sums: Vec<f64> = times.chunks(LIMITS_TRIANGLES.len()).map(|times| times.iter().sum()).collect();
    let mut best = (limits[0], WORTHWHILE * sums[0]);
    for (limit, ms) in limits.into_iter().zip(sums).skip(1) {
        if ms < best.1 {
            best = (limit, ms);
        }
    }
    Ok(best.0)
}
