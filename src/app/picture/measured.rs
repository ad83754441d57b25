//! Time and error of a picture in words and colors, as the top bar, the comparison and the
//! inspector show them.

use egui::Color32;

use super::{
    findings::Findings,
    screen::{Inputs, Screen},
    timings::{Cost, Summary},
    verification::Verdict,
};
use crate::app::widgets::{
    text::{group_digits, short},
    theme,
};

/// What the two counts of wrong pixels mean, wherever they stand.
pub const WRONG_HINT: &str = "Wrong: pixels that show another triangle than the oracle draws from the same snapped corners, so a fault of the \
     rasterizer. By rounding: pixels that show another triangle than the exact picture of the true positions, so the error that snapping and every \
     other option of accuracy make.";

/// What stands in place of milliseconds that are not known yet.
const UNTIMED: &str = "– ms";

/// What stands in place of an error that is not known yet.
const UNJUDGED: &str = "– wrong pixels";

/// The cost of the picture on a screen, and what the number is.
pub fn time_line(screen: Option<&Screen>) -> (String, String) {
    let Some(screen) = screen.filter(|screen| screen.drawn().is_some()) else {
        return (UNTIMED.into(), "There is no picture yet.".into());
    };
    if !screen.gpu.caps.timestamps {
        return ("no GPU timer".into(), "This adapter has no timer.".into());
    }
    match screen.timings().cost() {
        Cost::Settled(summary) => (format!("{:.2} ms GPU", summary.frame.median), summary_text(summary)),
        Cost::Moving(ms) => (format!("≈ {ms:.1} ms GPU"), "Median of the newest frames while the picture changes.".into()),
        Cost::Pending => {
            (UNTIMED.into(), "The first frames after a change are not the cost. A few are measured when the picture is at rest.".into())
        }
        Cost::Unknown => (UNTIMED.into(), "The picture could not be measured.".into()),
    }
}

fn summary_text(summary: &Summary) -> String {
    let Summary { frame, frames, .. } = summary;
    format!(
        "Median of {frames} frames at rest; 90 % of them between {:.2} and {:.2} ms. Timing lists the passes.",
        frame.p5, frame.p95
    )
}

/// The error of the picture `shown`: its color, a few words, and the details.
pub fn error_line(verdict: Option<&Verdict>, shown: Option<&Inputs>) -> (Color32, String, String) {
    let Some(Verdict { of, findings }) = verdict else {
        return (
            theme::text_weak(),
            UNJUDGED.into(),
            "Not measured yet: Verify compares every pixel with the oracle".into(),
        );
    };
    let (text, detail) = (error_text(findings), details(findings));
    if shown != Some(of) {
        return (
            theme::amber(),
            format!("{text} · stale"),
            format!(
                "Measured on an earlier picture, of {} × {} px. {detail}",
                of.view.width, of.view.height
            ),
        );
    }
    (error_color(findings), text, detail)
}

/// Green only if nothing at all is wrong, red for a fault of the rasterizer.
fn error_color(findings: &Findings) -> Color32 {
    let report = &findings.accuracy;
    let faults = report.wrong_triangles
        + report.holes
        + report.double_hits
        + report.depth_without_id
        + report.overflow;
    match (faults, findings.wrong_against_true()) {
        (0, Some(0)) => theme::green(),
        (0, _) => theme::text_strong(),
        _ => theme::red(),
    }
}

/// `no wrong pixel, 17 differ by rounding`: the error of a picture for a person. The numbers behind
/// it are in [`details`].
pub fn error_text(findings: &Findings) -> String {
    let report = &findings.accuracy;
    let counts = counts_text(report.wrong_triangles, findings.wrong_against_true());
    let race = match report.race_pixels {
        0 => String::new(),
        count => format!(", {} lost to the race", group_digits(count)),
    };
    format!("{counts}{race}{}", color_text(report.max_color_delta))
}

/// What there is to say of the accuracy axes that are not shown.
pub fn others_text(count: usize) -> String {
    format!("{count} more axes decide about nothing in this picture.")
}

/// `no wrong pixel, 17 differ by rounding`.
pub fn counts_text(wrong: u64, by_rounding: Option<u64>) -> String {
    let rounded = match by_rounding {
        None | Some(0) => String::new(),
        Some(1) => ", 1 differs by rounding".to_owned(),
        Some(count) => format!(", {} differ by rounding", group_digits(count)),
    };
    match wrong {
        0 => format!("no wrong pixel{rounded}"),
        1 => format!("1 wrong pixel{rounded}"),
        count => format!("{} wrong pixels{rounded}", group_digits(count)),
    }
}

/// A last bit is no difference that a person could see.
pub fn color_text(max_delta: u8) -> String {
    match max_delta {
        0 | 1 => String::new(),
        delta => format!(", colors off by up to {delta} of 255"),
    }
}

fn details(findings: &Findings) -> String {
    let report = &findings.accuracy;
    let count = |count: u64| {
        let ppm = 1e6 * count as f64 / report.pixels.max(1) as f64;
        format!("{} ({} ppm)", group_digits(count), short(ppm))
    };
    let against_true = match findings.wrong_against_true() {
        Some(rounded) => format!("{} differ by rounding", count(rounded)),
        None => {
            "not compared with the true positions, because its effects are not reproducible".into()
        }
    };
    format!(
        "{} pixels compared with the oracle: {} wrong, {against_true}; {} explained by a vertex one snap unit \
         away, {} depth ties, {} holes, {} drawn twice; color max Δ {} and RMS {:.3} of 255.\n\n{WRONG_HINT}",
        group_digits(report.pixels),
        count(report.wrong_triangles),
        report.explained_by_snap,
        report.depth_band_pixels,
        report.holes,
        report.double_hits,
        report.max_color_delta,
        report.rms_color_delta
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        frame::Frame,
        gpu::Capture,
        measure::{self, ErrorReport, error_map::ErrorMap},
    };

    /// Six pixels of which `wrong` are wrong against the snapped corners, and as many against the
    /// true positions as `reference` differs.
    fn findings(wrong: u64, reference: Option<Vec<u32>>) -> Findings {
        let picture = [[9; 4]; 6];
        let frame = Frame {
            width: 3,
            height: 2,
            triangle_id: vec![0; 6],
            color: picture.to_vec(),
            ..Default::default()
        };
        let capture = Capture {
            frame,
            geometry: Default::default(),
            layers: None,
            previous: None,
            shown: None,
        };
        let error_map = ErrorMap::new(&picture, &picture, |_| Vec::new());
        let report = ErrorReport {
            pixels: 6,
            wrong_triangles: wrong,
            ..Default::default()
        };
        Findings::new(
            capture,
            measure::Verdict {
                report,
                error_map,
                ..Default::default()
            },
            reference,
            Vec::new(),
        )
    }

    #[test]
    fn green_is_only_what_is_right_against_the_snapped_corners_and_the_true_positions() {
        let cases = [
            (
                findings(0, Some(vec![0; 6])),
                theme::green(),
                "no wrong pixel",
            ),
            (
                findings(0, Some(vec![0, 0, 7, 0, 7, 0])),
                theme::text_strong(),
                "no wrong pixel, 2 differ by rounding",
            ),
            (findings(0, None), theme::text_strong(), "no wrong pixel"),
            (
                findings(3, Some(vec![0; 6])),
                theme::red(),
                "3 wrong pixels",
            ),
        ];
        for (findings, color, text) in cases {
            assert_eq!(
                (error_color(&findings), error_text(&findings).as_str()),
                (color, text)
            );
            assert!(
                details(&findings).contains("Wrong: pixels")
                    && details(&findings).contains("By rounding: pixels")
            );
        }
    }
}
