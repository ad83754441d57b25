//! The job of a trade: the bench over combinations of options, judged by the oracle.

use std::{sync::Arc, time::Duration};

use web_time::Instant;

use super::{
    pace::Kind,
    point::{Metric, Point},
    request::{Progress, Report, Request, SAMPLES},
};
use crate::{
    accuracy::{Axis, PinnedOptions},
    app::jobs::threads,
    effects::Stack,
    gpu::{Capture, Gpu},
    oracle,
    scene::{Scene, draw::DrawError, view::View},
    trade::{Clock, Judged, Phase, Reference, Step, TradeOptions, TradeRow, Watch, factors, trade},
};

/// How often a measurement that waits looks whether it may go on.
const LOOK: Duration = Duration::from_millis(20);

/// A browser rounds the timestamps of an adapter.
const CLOCK: Clock = match cfg!(target_arch = "wasm32") {
    true => Clock::Processor,
    false => Clock::Adapter,
};

/// Measures every combination on a device that is not the window's. Canceled, it returns what has
/// been timed so far.
///
/// # Errors
/// In a sentence for people.
pub async fn measure(
    gpu: &Arc<Gpu>,
    scene: &Arc<Scene>,
    request: &Request,
    progress: &Progress,
) -> Result<Vec<Point>, String> {
    let Request {
        preset,
        size,
        axes,
        title,
    } = request;
    let preset = &preset.drawn_on(scene, size[1]);
    let view = preset.view(scene, *size);
    let began = Instant::now();
    let factors = factors(preset, axes);
    factors
        .iter()
        .try_for_each(|factor| oracle::can_judge(scene, &view, &preset.stack, *factor))
        .map_err(|e| e.to_string())?;
    let references = progress
        .work
        .run(|| oracle::references(scene, &view, &preset.stack, &factors));
    let Some(references) = references else {
        return Ok(Vec::new());
    };
    let references = references.map_err(|e| e.to_string())?;
    progress.report(Report {
        now: String::new(),
        done: Some((Kind::Reference, began.elapsed().as_secs_f64())),
        expected: None,
    });
    let judge = |view: &View, stack: &Stack, capture: &Capture| {
        let judged = progress.work.run(|| {
            let verdict = oracle::judge(scene, view, stack, &capture.picture())?;
            let light = oracle::shadow_errors(
                scene,
                view,
                stack,
                &capture.frame.triangle_id,
                &capture.geometry,
            )?;
            Ok::<_, DrawError>(Judged { verdict, light })
        });
        judged.map(|judged| judged.expect("a scene that was drawn can be judged"))
    };
    let options = TradeOptions {
        size: *size,
        samples: SAMPLES,
        clock: CLOCK,
        axes: axes.clone(),
        is_one_option_at_a_time: false,
    };
    let reference = Reference {
        references: &references,
        judge: &judge,
    };
    let mut watch = Watched {
        progress,
        step: None,
    };
    let rows = trade(gpu, preset, scene, title, &options, &reference, &mut watch)
        .await
        .map_err(|e| e.to_string())?;
    let pixels = view.pixels() as f64;
    let points = rows.into_iter().map(|row| point(row, axes, pixels));
    Ok(points.collect())
}

/// Reports a measurement to the window, and waits while the person works there.
struct Watched<'a> {
    progress: &'a Progress,
    /// The step that is being done, and when it began.
    step: Option<(Kind, Instant)>,
}

impl Watch for Watched<'_> {
    async fn goes_on(&mut self, step: &Step<'_>) -> bool {
        let done = self.step.take();
        let kind = if step.phase == Phase::SetUp {
            Kind::SetUp
        } else {
            Kind::Time
        };
        self.progress.report(Report {
            now: step.what.to_owned(),
            done: done.map(|(kind, began)| (kind, began.elapsed().as_secs_f64())),
            expected: Some((kind, step.all)),
        });
        // In a worker this lets in what the page has said meanwhile.
        threads::pause(Duration::ZERO).await;
        while self.progress.is_paused() && self.is_wanted() {
            threads::pause(LOOK).await;
        }
        self.step = Some((kind, Instant::now()));
        self.is_wanted()
    }

    fn is_wanted(&mut self) -> bool {
        !self.progress.is_canceled()
    }

    fn was_undisturbed(&mut self) -> bool {
        let is_undisturbed = !self.progress.is_paused();
        if !is_undisturbed {
            self.step = None; // The sample is taken again, so it is not done.
        }
        is_undisturbed
    }
}

/// A combination that was measured on a picture of so many pixels.
fn point(row: TradeRow, axes: &[&'static Axis], pixels: f64) -> Point {
    let mut pins = PinnedOptions::default();
    axes.iter()
        .for_each(|axis| pins.set(axis, row.pins.get(axis)));
    let errors = Metric::ALL.map(|metric| {
        let error = row.error.as_ref()?;
        Some(match metric {
            // Of the picture's pixels, also where another number of samples was drawn.
            Metric::Wrong => (error.wrong_ppm * pixels * 1e-6).round(),
            Metric::Color => error.max_color_delta.into(),
            Metric::Light => error.wrong_light_ppm?,
            Metric::Coverage => error.holes_per_mpx + error.double_hits_per_mpx,
        })
    });
    let more = row.error.iter().flat_map(|error| {
        [
            ("by rounding ppm", error.wrong_ppm),
            ("wrong depth winners ppm", error.wrong_depth_ppm),
            ("color RMS of 255", error.rms_color_delta),
            (
                "pixels that change between equal frames",
                error.changed_pixels as f64,
            ),
            ("corners moved px", error.moved_px),
            ("cracks per Mpx", error.cracks_per_mpx),
            ("queue entries lost", error.overflow as f64),
            ("depths without id", error.depth_without_id as f64),
            ("buffers MiB", row.bytes as f64 / 1_048_576.0),
        ]
        .into_iter()
        .chain(error.rms_light.map(|rms| ("light RMS, fraction", rms)))
    });
    Point {
        pins,
        ms: row.spread,
        samples: row.samples,
        errors,
        more: more.map(|(name, value)| (name.to_owned(), value)).collect(),
        note: row.note,
    }
}

#[cfg(test)]
mod tests {
    use pollster::FutureExt as _;

    use super::*;
    use crate::app::trade::pace::{Pace, Rates};

    #[test]
    fn a_sample_during_which_the_person_worked_does_not_count() {
        let progress = Progress::new(Pace::of(2, 3, 1e4, 1e4, 1.0, &Rates::default()));
        let mut watch = Watched {
            progress: &progress,
            step: None,
        };
        let step = Step {
            what: "depth=log16",
            phase: Phase::Time,
            done: 0,
            all: 6,
        };
        assert!(watch.goes_on(&step).block_on() && watch.was_undisturbed());
        assert!(watch.goes_on(&step).block_on());
        progress.pause();
        assert!(!watch.was_undisturbed(), "the sample counts");
        progress.cancel();
        assert!(
            !watch.goes_on(&step).block_on(),
            "it waits for the person although it is canceled"
        );
    }
}
