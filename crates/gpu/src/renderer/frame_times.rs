//! Times of the frames of one picture: as a whole and pass by pass, once its kernels are compiled.

use std::{collections::HashMap, time::Duration};

use web_time::Instant;

use super::{
    drawing::{Renderer, Report},
    warm_up::{self, FRAMES_PER_SAMPLE},
};
use crate::{
    device::{error::RenderError, timer::Detail},
    effects::Stack,
    measure::timing,
    passes::particles::Wait,
    plan::AccuracyRequest,
    scene::view::View,
};

/// Times of one picture, milliseconds: medians, and on a CPU adapter the shortest, since other work
/// on the machine only makes frames longer.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct FrameTimes {
    /// The whole frame: by timestamps, or the time that passed on the CPU where the adapter has
    /// none; above 0.
    pub whole_ms: f64,
    /// Every pass by its label, timed alone; empty without timestamps.
    pub passes: Vec<(String, f64)>,
    /// Frames that were timed as a whole.
    pub frames: usize,
}

/// Frames of a picture that are drawn before any is timed.
const FIRST_FRAMES: usize = 2;
/// Frames that are timed, at least and at most; each is drawn once as a whole and once pass by
/// pass.
const FRAMES: [usize; 2] = [3, 7];
/// Time for the frames of a picture beyond the least number of them.
const PICTURE_BUDGET: Duration = Duration::from_millis(40);

impl FrameTimes {
    /// Draws a picture until its kernels are compiled, keeps a card busy so that its clock is that
    /// of one at work, and times frames.
    pub async fn of(
        renderer: &mut Renderer,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<Self, RenderError> {
        draw_until_ready(renderer, view, stack, accuracy).await?;
        let gpu = renderer.gpu().clone();
        let draw = async |_, frames| {
            sample(renderer, view, stack, accuracy, Detail::Whole, frames)
                .await
                .map(|_| true)
        };
        warm_up::warm_up(&gpu, warm_up::FROM_IDLE, 1, draw).await?;
        timed(renderer, view, stack, accuracy).await
    }
}

/// Draws until kernels are compiled and queues are large enough.
async fn draw_until_ready(
    renderer: &mut Renderer,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<(), RenderError> {
    let mut left = FIRST_FRAMES;
    // Queues grow a few times at most.
    for _ in 0..16 {
        renderer
            .draw_timed(view, stack, accuracy, Detail::Whole, Wait::Simulation)
            .await?;
        left -= usize::from(!renderer.finish().await?.redraw);
        if left == 0 {
            break;
        }
    }
    Ok(())
}

/// Draws frames without a pause between them; the report is of the last.
async fn sample(
    renderer: &mut Renderer,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
    detail: Detail,
    frames: usize,
) -> Result<Report, RenderError> {
    for _ in 0..frames {
        renderer
            .draw_timed(view, stack, accuracy, detail, Wait::Simulation)
            .await?;
    }
    renderer.finish().await
}

/// Frames that are drawn for one time. On a software adapter a frame before the one that is timed
/// would only take time.
fn frames_per_sample(renderer: &Renderer) -> usize {
    if renderer.gpu().caps.software {
        1
    } else {
        FRAMES_PER_SAMPLE
    }
}

/// Milliseconds of one whole frame, above 0: by timestamps, or the time that passed on the CPU
/// where the adapter has none.
async fn whole_ms(
    renderer: &mut Renderer,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<Option<f64>, RenderError> {
    let frames = frames_per_sample(renderer);
    let begin = Instant::now();
    let report = sample(renderer, view, stack, accuracy, Detail::Whole, frames).await?;
    let passed_ms = begin.elapsed().as_secs_f64() * 1e3 / frames as f64;
    let ms = if renderer.gpu().caps.timestamps {
        report.gpu_ms
    } else {
        Some(passed_ms)
    };
    Ok(ms.filter(|ms| *ms > 0.0))
}

/// Times a picture: as a whole and pass by pass in turn.
async fn timed(
    renderer: &mut Renderer,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<FrameTimes, RenderError> {
    let has_timestamps = renderer.gpu().caps.timestamps;
    let frames = frames_per_sample(renderer);
    let (mut whole, mut passes): (Vec<f64>, Vec<(String, Vec<f64>)>) = (Vec::new(), Vec::new());
    let [least, most] = FRAMES;
    let begin = Instant::now();
    while whole.len() < least || whole.len() < most && begin.elapsed() < PICTURE_BUDGET {
        whole.extend(whole_ms(renderer, view, stack, accuracy).await?);
        if !has_timestamps {
            continue;
        }
        let mut seen = HashMap::new();
        for (label, ms) in sample(renderer, view, stack, accuracy, Detail::Passes, frames)
            .await?
            .passes
        {
            // A label may occur several times in a frame.
            let turn = seen
                .entry(label.clone())
                .and_modify(|turn| *turn += 1)
                .or_insert(0usize);
            match passes
                .iter_mut()
                .filter(|(known, _)| *known == label)
                .nth(*turn)
            {
                Some((_, times)) => times.push(ms),
                None => passes.push((label, vec![ms])),
            }
        }
        if begin.elapsed() > 20 * PICTURE_BUDGET {
            break;
        }
    }
    let percentile = if renderer.gpu().caps.software {
        0.0
    } else {
        0.5
    };
    let typical = |times: &[f64]| timing::percentile(times, percentile).unwrap_or(0.0);
    if whole.is_empty() {
        return Err(RenderError::NoTimestamps);
    }
    Ok(FrameTimes {
        whole_ms: typical(&whole),
        frames: whole.len(),
        passes: passes
            .iter()
            .map(|(label, times)| (label.clone(), typical(times)))
            .collect(),
    })
}
