//! Time and error of a picture in words and colors, as the top bar, the comparison and the inspector show them.

use eframe::egui::Color32;

use super::{screen::Inputs, theme, verification::Verdict};
use crate::{gpu::Report, measure::ErrorReport};

/// The time of a frame on the device.
pub fn time_text(report: Option<&Report>) -> String {
    match report.map(|report| report.gpu_ms) {
        Some(Some(ms)) => format!("{ms:.2} ms GPU"),
        Some(None) => "no GPU timer".into(),
        None => "not timed".into(),
    }
}

/// The error of the picture `shown`: its color, a few words, and the details.
pub fn error_line(verdict: Option<&Verdict>, shown: Option<&Inputs>) -> (Color32, String, String) {
    let Some(Verdict { of, findings }) = verdict else {
        return (theme::text_weak(), "error not measured".into(), "Verify compares every pixel with the oracle".into());
    };
    let report = &findings.accuracy;
    let (text, detail) = (error_text(report), details(report));
    if shown != Some(of) {
        return (theme::amber(), format!("{text} · stale"), format!("Measured on an earlier picture. {detail}"));
    }
    let wrong = report.wrong_triangles + report.holes + report.double_hits + report.depth_without_id + report.overflow;
    (if wrong == 0 { theme::green() } else { theme::red() }, text, detail)
}

/// `0 wrong triangles, max Δ 1`.
pub fn error_text(report: &ErrorReport) -> String {
    let count = report.wrong_triangles;
    let race = if report.race_pixels > 0 { format!(", {} lost to the race", report.race_pixels) } else { String::new() };
    format!("{count} wrong {}{race}, max Δ {}", if count == 1 { "triangle" } else { "triangles" }, report.max_color_delta)
}

fn details(report: &ErrorReport) -> String {
    format!(
        "{} pixels compared with the oracle: {} wrong triangles, {} explained by a vertex one snap unit away, {} depth ties, {} holes, \
         {} drawn twice; color max Δ {} and RMS {:.3} of 255",
        report.pixels,
        report.wrong_triangles,
        report.explained_by_snap,
        report.depth_band_pixels,
        report.holes,
        report.double_hits,
        report.max_color_delta,
        report.rms_color_delta
    )
}
