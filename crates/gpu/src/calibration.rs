//! The calibration of an adapter: a few small pictures of built-in scenes, each with much of another kind of work, are timed, and the unit
//! costs that explain the times best are computed.

use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use rayon::prelude::*;

use super::{
    device::Gpu,
    error::RenderError,
    option_times::{best_limit, limit_pictures, option_costs, option_pictures},
    timed_picture::{FrameTimes, Picture, TimedPicture},
    warm_up,
    workload::MovedSizes,
};
use crate::{
    accuracy::{Coverage, PinnedOptions, VertexTransform, Visibility},
    plan::{
        AccuracyRequest, Caps, Measured,
        cost_model::{FrameWork, MeasuredWork, PassWork, Unit, UnitCosts},
    },
};

/// What a calibration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibrated {
    /// What a unit of each kind of work costs.
    pub units: UnitCosts,
    /// What options and limits cost, which the planner asks for.
    pub measured: Measured,
    /// Pictures that were timed.
    pub pictures: usize,
    /// Seconds in which frames were timed.
    pub measuring_s: f64,
    /// Seconds in which kernels were compiled and everything was made ready.
    pub preparing_s: f64,
}

/// Size of a picture as a window shows it. On a CPU adapter, which takes long for one, its sides are a third of that.
const LARGE: [u32; 2] = [1920, 1080];

/// Kinds of work that come together in one picture come in other proportions in another, so that the cost of each can be told.
const PICTURES: &[Picture<'static>] = &[
    ("sphere?triangles=200", &[("lambert", &[])], [16, 12]),
    ("sphere?triangles=20000", &[("wireframe", &[]), ("lambert", &[])], [160, 120]),
    ("sphere?triangles=320", &[("triangle_id", &[])], [60, 45]),
    ("sphere?triangles=1200", &[("race", &[])], [120, 90]),
    ("sphere?triangles=2000", &[("lambert", &[])], LARGE),
    ("still-life?tess=3", &[("shadow", &[])], LARGE),
    ("knot?tess=8", &[("xray", &[]), ("lambert", &[])], LARGE),
    ("town", &[("fog", &[]), ("lambert", &[])], LARGE),
    ("teapot?tess=8", &[("outline", &[])], LARGE),
    ("walker", &[("hatch", &[])], LARGE),
    ("knot?tess=8", &[("dots", &[])], LARGE),
    ("cube-wall", &[("overdraw", &[])], LARGE),
    ("panels", &[("lambert", &[])], LARGE),
    ("leaves?n=400", &[("toon", &[])], LARGE),
    ("chamber", &[("shadow", &[]), ("fog", &[])], LARGE),
    ("near", &[("lambert", &[])], LARGE),
    ("sphere?triangles=20000", &[("dissolve", &[])], LARGE),
    ("sphere?triangles=6000", &[("explode", &[]), ("lambert", &[])], LARGE),
    ("still-life?tess=3", &[("particles", &[]), ("wireframe", &[])], LARGE),
    ("sphere?triangles=2000", &[("outline", &[("width_px", 5.0)]), ("fog", &[])], [320, 240]),
    ("teapot?tess=3", &[("outline", &[("width_px", 7.0)])], [80, 60]),
    ("teapot?tess=4", &[("hatch", &[]), ("normals", &[])], [120, 90]),
    ("stack?layers=24", &[("depth", &[])], [256, 256]),
    ("stack?layers=6", &[("overdraw", &[]), ("stipple", &[])], [120, 90]),
    ("near", &[("facet", &[])], [160, 120]),
    ("chamber", &[("shadow", &[])], [80, 60]),
    ("chamber", &[("toon", &[])], [96, 96]),
    ("panels", &[("toon", &[])], [120, 90]),
    ("panels", &[("smear", &[])], [40, 30]),
    ("globe?tess=6", &[("wireframe", &[])], [128, 96]),
    ("leaves?n=200", &[("dither", &[])], [160, 120]),
    ("tentacle?instances=6", &[("posterize", &[])], [96, 72]),
    ("tentacle?instances=60", &[("fog", &[])], [48, 36]),
    ("teapot?tess=6", &[("points", &[])], [120, 120]),
    ("teapot?tess=8", &[("points", &[("size_px", 48.0)])], [160, 120]),
    ("knot?tess=3", &[("dots", &[])], [160, 120]),
    ("teapot?tess=3", &[("dots", &[("spacing_m", 0.3), ("size_px", 16.0)])], [96, 72]),
    ("chamber", &[("particles", &[])], [120, 90]),
    ("teapot?tess=3", &[("particles", &[("count", 2000.0)])], [96, 72]),
    ("sphere?triangles=6000", &[("draw_order", &[])], [80, 60]),
    ("knot?tess=4", &[("xray", &[])], [120, 90]),
    ("globe?tess=5", &[("xray", &[]), ("hatch", &[])], [96, 72]),
    ("stack?layers=6", &[("xray", &[])], [90, 70]),
    ("cube-wall?columns=8&rows=6", &[("xray", &[]), ("lambert", &[])], [60, 45]),
    ("sphere?triangles=3000", &[("explode", &[]), ("stipple", &[])], [120, 90]),
    ("knot?tess=6", &[("wobble", &[]), ("triangle_id", &[])], [100, 75]),
    ("sphere?triangles=6000", &[("inflate", &[("amount_m", 8.0)])], [80, 60]),
    ("still-life?tess=1", &[("shadow", &[])], [96, 72]),
    ("cube-wall?columns=4&rows=3", &[("boxes", &[]), ("smear", &[])], [100, 80]),
    ("sphere?triangles=4000", &[("dissolve", &[])], [100, 75]),
    ("sphere?triangles=600", &[("dissolve", &[("mode", 3.0)])], [80, 60]),
    ("sphere?triangles=100", &[("inflate", &[("amount_m", 8.0)])], [40, 30]),
    ("slivers", &[("dissolve", &[])], [120, 90]),
    ("panels", &[("dissolve", &[("mode", 3.0)])], [80, 60]),
    ("sphere?triangles=2000", &[("dots", &[])], [40, 30]),
    ("stack?layers=24", &[("xray", &[]), ("lambert", &[])], [60, 45]),
    ("teapot?tess=3", &[("race", &[])], [60, 45]),
    ("teapot?tess=4", &[("points", &[("size_px", 16.0)]), ("race", &[])], [80, 60]),
    ("still-life?tess=2", &[("outline", &[("width_px", 6.0)])], [60, 45]),
    ("globe?tess=5", &[("lambert", &[])], [60, 45]),
    ("knot?tess=3", &[("points", &[("size_px", 10.0)])], [64, 48]),
    ("knot?tess=3", &[("toon", &[])], [64, 48]),
    ("near", &[("lambert", &[])], [100, 75]),
    ("near", &[("depth", &[])], [40, 30]),
];

/// The card is kept busy for so long before anything is timed. It has drawn already, while the pictures were made ready.
const WARM_UP: Duration = Duration::from_millis(100);

/// The clock of a card counts as steady once so many pictures, one after another, took about as long when they were timed again.
const STEADY_PICTURES: usize = 8;
/// The first time of such a picture as a fraction of its second, at most.
const STEADY: f64 = 1.04;

/// So many of the last pictures are drawn on the finest grid with strict vertices.
const FINE: usize = 2;

/// Times the pictures of the calibration on a device and computes the unit costs. `moved_sizes` samples their triangles; `progress` is told
/// the number of pictures that are ready to be timed, and of all.
///
/// # Errors
/// When a picture cannot be drawn, the adapter writes no timestamps, or the device is lost.
pub fn calibrate(gpu: &Arc<Gpu>, moved_sizes: MovedSizes, progress: &(dyn Fn(usize, usize) + Sync)) -> Result<Calibrated, RenderError> {
    let begin = Instant::now();
    let is_software = gpu.caps.software;
    // How an earlier calibration divides work counts for nothing.
    let usual = Caps { measured: None, ..gpu.caps }.tuning();
    // All kernels are compiled before anything is timed, so that a card stays at the clock of one at work; those of several pictures at once,
    // since a driver compiles each on the thread that asks for it.
    let done = AtomicUsize::new(0);
    let made_ready = |(index, &(query, effects, size)): (usize, &Picture<'static>)| -> Result<(TimedPicture, FrameWork), RenderError> {
        let size = if is_software && size == LARGE { size.map(|side| side / 3) } else { size };
        let picture = TimedPicture::new(gpu, &(query, effects, size), accuracy_of(index), usual)?;
        let work = picture.work(moved_sizes)?;
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, PICTURES.len());
        Ok((picture, work))
    };
    let (ready, (options, limits)) = rayon::join(
        || PICTURES.par_iter().enumerate().map(made_ready).collect::<Result<Vec<_>, _>>(),
        || rayon::join(|| option_pictures(gpu, usual), || limit_pictures(gpu, usual)),
    );
    let (mut ready, options, limits) = (ready?, options?, limits?);
    let start = Instant::now();
    warm_up::warm_up(gpu, WARM_UP, ready.len(), |at, frames| {
        ready[at].0.draw(frames)?;
        Ok(true)
    })?;
    let passes_weight = PASSES_WEIGHT[usize::from(is_software)];
    let times = steady_times(&mut ready, is_software)?;
    let observed: Vec<_> = ready.iter().zip(&times).flat_map(|((_, work), times)| observations(work, times, passes_weight)).collect();
    let measured = Measured { options: option_costs(options)?, max_small_samples: best_limit(limits)? };
    let (measuring_s, all_s) = (start.elapsed().as_secs_f64(), begin.elapsed().as_secs_f64());
    Ok(Calibrated {
        units: UnitCosts::fitted(&observed, !is_software),
        measured,
        pictures: PICTURES.len(),
        measuring_s,
        preparing_s: all_s - measuring_s,
    })
}

/// The times of all pictures. The clock of a card may still rise while they are timed, so they are timed once more from the first on, as far as
/// their times still fall: an H100 that was idle took up to 0.4 s, in which frames took about three times as long.
fn steady_times(ready: &mut [(TimedPicture, FrameWork)], is_software: bool) -> Result<Vec<FrameTimes>, RenderError> {
    let mut times = ready.iter_mut().map(|(picture, _)| picture.times()).collect::<Result<Vec<_>, _>>()?;
    let mut steady = 0;
    for ((picture, _), earlier) in ready.iter_mut().zip(&mut times) {
        if is_software || steady == STEADY_PICTURES {
            break;
        }
        let now = picture.times()?;
        steady = if earlier.whole_ms <= STEADY * now.whole_ms { steady + 1 } else { 0 };
        *earlier = now;
    }
    Ok(times)
}

/// Every second picture finds depths first and triangles then, as all do where an adapter has no 64-bit atomics: it has other passes.
fn accuracy_of(index: usize) -> AccuracyRequest {
    let pins = if index % 2 == 1 { PinnedOptions::of(Visibility::Split32) } else { PinnedOptions::default() };
    let is_fine = index + FINE >= PICTURES.len();
    let pins = if is_fine { pins.with(Coverage::Fixed12).with(VertexTransform::Strict) } else { pins };
    AccuracyRequest { pins, ..AccuracyRequest::default() }
}

/// How much the passes of a frame count together beside the whole frame: on a card, where a pass that is timed alone overlaps with no other,
/// and on a CPU adapter.
const PASSES_WEIGHT: [f64; 2] = [2.0, 1.0];

/// Times beside the work that was done in them: the whole frame, and every pass in proportion to its part of the frame.
fn observations(work: &FrameWork, times: &FrameTimes, passes_weight: f64) -> Vec<MeasuredWork> {
    let mut measured = vec![MeasuredWork { counts: work.counts(), ms: times.whole_ms, weight: 1.0 }];
    let all: f64 = times.passes.iter().map(|(_, ms)| ms).sum();
    for (pass, ms) in paired(work, times) {
        let counts = pass.counts.iter().copied().chain([(Unit::LonePass, 1.0)]).collect();
        measured.extend(ms.map(|ms| MeasuredWork { counts, ms, weight: passes_weight * (ms / all).max(0.02) }));
    }
    measured
}

/// Every pass of a frame with its measured milliseconds, where they are known.
pub fn paired<'a>(work: &'a FrameWork, times: &FrameTimes) -> Vec<(&'a PassWork, Option<f64>)> {
    let mut left = times.passes.clone();
    let mut take = |label: &str| left.iter().position(|(name, _)| name == label).map(|at| left.remove(at).1);
    work.passes.iter().map(|pass| (pass, take(&pass.label))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timed_picture::made;

    #[test]
    fn every_picture_of_the_calibration_can_be_made() {
        for picture in PICTURES {
            let (scene, view, stack) = made(picture);
            assert!(scene.triangle_count() > 0 && view.pixels() > 0 && stack.check().is_ok(), "{picture:?}");
        }
    }

    #[test]
    fn passes_of_one_name_are_paired_in_their_order() {
        let pass = |label: &str, count: f64| PassWork { label: label.into(), counts: vec![(Unit::Pass, count)] };
        let work = FrameWork { passes: vec![pass("clear", 0.0), pass("args", 1.0), pass("clip", 2.0), pass("args", 3.0)] };
        let passes = [("clear", 0.1), ("args", 0.2), ("args", 0.4)].map(|(label, ms)| (label.to_owned(), ms)).to_vec();
        let times = FrameTimes { whole_ms: 1.0, passes, frames: 1 };
        let pairs: Vec<_> = paired(&work, &times).into_iter().map(|(pass, ms)| (pass.counts[0].1, ms)).collect();
        assert_eq!(pairs, [(0.0, Some(0.1)), (1.0, Some(0.2)), (2.0, None), (3.0, Some(0.4))]);
    }
}
