//! The job behind the panel: the bench over combinations of rungs, with the oracle as its judge.

use std::sync::Arc;

use super::{Metric, Point, Progress, Question, SAMPLES};
use crate::{
    effects::Stack,
    gpu::{
        Capture, Gpu,
        device::AdapterChoice,
        trade::{Judged, TradeOptions, TradeRow, Truth, factors, trade},
    },
    ladder::{Axis, Pins},
    oracle,
    scene::{Scene, camera::View},
};

/// Measures every combination, on a device of its own.
///
/// # Errors
/// In a sentence for people.
pub fn measure(adapter: String, scene: &Arc<Scene>, question: &Question, progress: &Progress) -> Result<Vec<Point>, String> {
    let Question { session, size, axes, title } = question;
    progress.tell(0, 1, "the true picture");
    let gpu = Gpu::open(&AdapterChoice::Named(adapter)).map_err(|e| e.to_string())?;
    let view = session.view(scene, *size);
    let truths = oracle::truths(scene, &view, &session.stack, &factors(session, axes)).map_err(|e| e.to_string())?;
    let judge = |view: &View, stack: &Stack, capture: &Capture| {
        let (layers, previous) = (capture.layers.as_deref(), capture.previous.as_deref());
        let verdict = oracle::judge_after(scene, view, stack, &capture.frame, &capture.geometry, layers, previous);
        let light = oracle::light_errors(scene, view, stack, &capture.frame.owner, &capture.geometry);
        let known = "a scene that was drawn can be judged";
        Judged { verdict: verdict.expect(known), light: light.expect(known) }
    };
    let options = TradeOptions { size: *size, samples: SAMPLES, axes: axes.clone(), is_each_alone: false };
    let mut tell = |what: &str, done: usize, all: usize| progress.tell(done, all, what);
    let truth = Truth { truths: &truths, judge: &judge };
    let rows = trade(&gpu, session, scene, title, &options, &truth, &mut tell).map_err(|e| e.to_string())?;
    Ok(rows.into_iter().map(|row| point(row, axes)).collect())
}

fn point(row: TradeRow, axes: &[&'static Axis]) -> Point {
    let mut pins = Pins::default();
    axes.iter().for_each(|axis| pins.set(axis, row.pins.get(axis)));
    let errors = Metric::ALL.map(|metric| {
        let error = row.error.as_ref()?;
        Some(match metric {
            Metric::Wrong => error.wrong_ppm,
            Metric::Colour => error.max_colour_delta.into(),
            Metric::Light => error.wrong_light_ppm?,
            Metric::Coverage => error.holes_per_mpx + error.double_hits_per_mpx,
        })
    });
    let more = row.error.iter().flat_map(|error| {
        [
            ("wrong depth winners ppm", error.wrong_depth_ppm),
            ("colour RMS of 255", error.rms_colour_delta),
            ("pixels that change between equal frames", error.changed_pixels as f64),
            ("corners moved px", error.moved_px),
            ("cracks per Mpx", error.cracks_per_mpx),
            ("queue entries lost", error.overflow as f64),
            ("orphans", error.orphans as f64),
            ("buffers MiB", row.bytes as f64 / 1_048_576.0),
        ]
        .into_iter()
        .chain(error.rms_light.map(|rms| ("light RMS, share", rms)))
    });
    Point {
        pins,
        ms: row.ms_p50.zip(row.ms_p95).map(|(p50, p95)| [p50, p95]),
        samples: row.samples,
        errors,
        more: more.collect(),
        is_idle: row.is_beaten,
        note: row.note,
    }
}
