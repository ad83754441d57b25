//! What the newest picture cost and how it was drawn: the folders Timing and Kernel.

use egui::{self, RichText, Ui};

use crate::{
    app::{
        picture::{
            findings::Findings,
            measured::time_line,
            timings::{Cost, Summary},
        },
        shell::state::State,
        widgets::{
            text::{self, group_digits},
            theme,
        },
    },
    gpu::{Explanation, Report},
};

/// What the newest frame cost, pass by pass, beside its error.
pub fn timing_ui(ui: &mut Ui, state: &State) {
    let Some(report) = state.picture.screen.report() else {
        ui.label(theme::weak("Times appear with the first frame."));
        return;
    };
    let drawn = state
        .picture
        .verification
        .verdict_on(state.picture.screen.drawn());
    let mut main = vec![("frame".to_owned(), time_line(Some(&state.picture.screen)).0)];
    main.extend(error_lines(drawn.map(|verdict| &*verdict.findings)));
    let main_count = main.len();
    let summary = match state.picture.screen.timings().cost() {
        Cost::Settled(summary) => Some(summary),
        _ => None,
    };
    egui::Grid::new("timing")
        .num_columns(2)
        .spacing([16.0, 4.0])
        .min_col_width(96.0)
        .show(ui, |ui| {
            for (index, (name, value)) in main.into_iter().chain(lines(report, summary)).enumerate()
            {
                let is_main = index < main_count;
                ui.label(RichText::new(name).color(if is_main {
                    theme::text_strong()
                } else {
                    theme::text_weak()
                }));
                ui.label(RichText::new(value).monospace().color(if is_main {
                    theme::text_strong()
                } else {
                    theme::text()
                }));
                ui.end_row();
            }
        });
    if state.picture.screen.gpu.summary.software {
        ui.label(
            RichText::new("Compare software-adapter timings only with each other.")
                .color(theme::amber()),
        );
    }
}

/// The error of the picture, a row for each number: one long row would make the inspector wider,
/// and so the picture another one.
fn error_lines(findings: Option<&Findings>) -> Vec<(String, String)> {
    let Some(findings) = findings else {
        return vec![("error".into(), "not of this picture".into())];
    };
    let against_true = findings.wrong_against_true().map_or_else(
        || "not known".into(),
        |count| format!("{} px", group_digits(count)),
    );
    vec![
        (
            "wrong".into(),
            format!("{} px", group_digits(findings.accuracy.wrong_triangles)),
        ),
        ("by rounding".into(), against_true),
        (
            "max Δ".into(),
            format!("{} of 255", findings.accuracy.max_color_delta),
        ),
    ]
}

/// Medians of the passes and of what the frame takes beyond them, then the counters that are not 0.
fn lines(report: &Report, summary: Option<&Summary>) -> Vec<(String, String)> {
    let mut lines = Vec::new();
    if let Some(Summary { passes, rest, .. }) = summary {
        lines.extend(
            passes
                .iter()
                .map(|(name, spread)| (name.clone(), format!("{:.3} ms", spread.median))),
        );
        lines.push(("rest".into(), format!("{:.3} ms", rest.median)));
    }
    if let Some(culled) = report.culled {
        lines.push(("meshlets drawn".into(), culled.drawn.to_string()));
        lines.push(("culled".into(), culled.reasons()));
    }
    let c = &report.counters;
    let counters = [
        ("non-finite", c.rejected_nonfinite),
        ("out of range", c.rejected_range),
        ("no area", c.degenerate),
        ("clipped", c.clipped),
        ("flipped clips", c.flipped_clips),
        ("overflow", c.overflow),
        ("depth without id", c.depth_without_id),
    ];
    lines.extend(
        counters
            .into_iter()
            .filter(|(_, count)| *count != 0)
            .map(|(name, count)| (name.to_owned(), count.to_string())),
    );
    lines
}

/// Which passes and buffers the newest picture has, and why.
pub fn kernel_ui(ui: &mut Ui, state: &State) {
    let Some(Explanation {
        key,
        passes,
        buffers,
        reasons,
        omitted,
        ..
    }) = state.picture.screen.explanation()
    else {
        ui.label(theme::weak("The kernel appears with the first frame."));
        return;
    };
    ui.label(theme::strong(key).monospace());
    let bytes: u64 = buffers.iter().map(|buffer| buffer.bytes).sum();
    ui.add_space(theme::HALF);
    ui.label(theme::weak(format!(
        "{} passes; {} buffers, {} in total",
        passes.len(),
        buffers.len(),
        text::bytes(bytes)
    )));
    for pass in passes {
        ui.label(RichText::new(&pass.name).monospace())
            .on_hover_text(&pass.why);
    }
    ui.add_space(theme::HALF);
    for buffer in buffers {
        ui.horizontal(|ui| {
            ui.label(RichText::new(&buffer.name).monospace())
                .on_hover_text(&buffer.why);
            ui.label(theme::weak(text::bytes(buffer.bytes)));
        });
    }
    for (title, notes) in [("chosen because", reasons), ("left out because", omitted)] {
        if !notes.is_empty() {
            ui.add_space(theme::HALF);
            ui.label(theme::heading(title));
        }
        for note in notes {
            ui.label(RichText::new(&note.name).monospace());
            ui.label(theme::weak(&note.why));
        }
    }
}
