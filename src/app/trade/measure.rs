//! The job of a trade: the bench over combinations of options, judged by the oracle.

use std::sync::Arc;

use super::{
    point::{Metric, Point},
    request::{Progress, Request, SAMPLES},
};
use crate::{
    accuracy::{Axis, PinnedOptions},
    effects::Stack,
    gpu::{
        Capture, Gpu,
        device::AdapterChoice,
        trade::{Judged, Reference, TradeOptions, TradeRow, factors, trade},
    },
    oracle,
    scene::{Scene, view::View},
};

/// Measures every combination, on a second device.
///
/// # Errors
/// In a sentence for people.
pub fn measure(adapter: String, scene: &Arc<Scene>, request: &Request, progress: &Progress) -> Result<Vec<Point>, String> {
    let Request { preset, size, axes, title } = request;
    progress.report(0, 1, "the reference picture");
    let gpu = Gpu::open(&AdapterChoice::Named(adapter)).map_err(|e| e.to_string())?;
    let view = preset.view(scene, *size);
    let references = oracle::references(scene, &view, &preset.stack, &factors(preset, axes)).map_err(|e| e.to_string())?;
    let judge = |view: &View, stack: &Stack, capture: &Capture| {
        let verdict = oracle::judge(scene, view, stack, &capture.picture());
        let light = oracle::shadow_errors(scene, view, stack, &capture.frame.triangle_id, &capture.geometry);
        let reason = "a scene that was drawn can be judged";
        Judged { verdict: verdict.expect(reason), light: light.expect(reason) }
    };
    let options = TradeOptions { size: *size, samples: SAMPLES, axes: axes.clone(), is_one_option_at_a_time: false };
    let mut report = |what: &str, done: usize, all: usize| progress.report(done, all, what);
    let reference = Reference { references: &references, judge: &judge };
    let rows = trade(&gpu, preset, scene, title, &options, &reference, &mut report).map_err(|e| e.to_string())?;
    Ok(rows.into_iter().map(|row| point(row, axes)).collect())
}

fn point(row: TradeRow, axes: &[&'static Axis]) -> Point {
    let mut pins = PinnedOptions::default();
    axes.iter().for_each(|axis| pins.set(axis, row.pins.get(axis)));
    let errors = Metric::ALL.map(|metric| {
        let error = row.error.as_ref()?;
        Some(match metric {
            Metric::Wrong => error.wrong_ppm,
            Metric::Color => error.max_color_delta.into(),
            Metric::Light => error.wrong_light_ppm?,
            Metric::Coverage => error.holes_per_mpx + error.double_hits_per_mpx,
        })
    });
    let more = row.error.iter().flat_map(|error| {
        [
            ("wrong depth winners ppm", error.wrong_depth_ppm),
            ("color RMS of 255", error.rms_color_delta),
            ("pixels that change between equal frames", error.changed_pixels as f64),
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
        ms: row.ms_p50.zip(row.ms_p95).map(|(p50, p95)| [p50, p95]),
        samples: row.samples,
        errors,
        more: more.collect(),
        is_dominated: row.is_dominated,
        note: row.note,
    }
}
