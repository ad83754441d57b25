//! What the newest picture cost and how it was drawn: the folders Timing and Kernel.

use eframe::egui::{self, RichText, Ui};

use crate::{
    app::{measured::error_text, state::State, text, theme},
    gpu::{Explanation, Report},
};

/// What the newest frame cost, pass by pass, beside its error.
pub fn timing_ui(ui: &mut Ui, state: &State) {
    let Some(report) = state.screen.report() else {
        ui.label(theme::weak("Times appear with the first frame."));
        return;
    };
    let error = state.accuracy().map_or_else(|| "not measured".into(), error_text);
    egui::Grid::new("timing").num_columns(2).spacing([16.0, 4.0]).min_col_width(96.0).show(ui, |ui| {
        for (index, (name, value)) in lines(report, error).into_iter().enumerate() {
            let is_main = index < 2;
            ui.label(RichText::new(name).color(if is_main { theme::text_strong() } else { theme::text_weak() }));
            ui.label(RichText::new(value).monospace().color(if is_main { theme::text_strong() } else { theme::text() }));
            ui.end_row();
        }
    });
    if state.screen.gpu.summary.software {
        ui.label(RichText::new("Compare software-adapter timings only with each other.").color(theme::amber()));
    }
}

/// Names and values: frame time and error first, then the passes, then the counters that are not 0.
fn lines(report: &Report, error: String) -> Vec<(String, String)> {
    let frame = report.gpu_ms.map_or_else(|| "no timer on this adapter".into(), |ms| format!("{ms:.3} ms"));
    let mut lines = vec![("frame".to_owned(), frame), ("error".to_owned(), error)];
    lines.extend(report.passes.iter().map(|(name, ms)| (name.to_string(), format!("{ms:.3} ms"))));
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
    lines.extend(counters.into_iter().filter(|(_, count)| *count != 0).map(|(name, count)| (name.to_owned(), count.to_string())));
    lines
}

/// Which passes and buffers the newest picture has, and why.
pub fn kernel_ui(ui: &mut Ui, state: &State) {
    let Some(Explanation { key, passes, buffers, reasons, omitted, .. }) = state.screen.explanation() else {
        ui.label(theme::weak("The kernel appears with the first frame."));
        return;
    };
    ui.label(RichText::new(key).monospace().color(theme::text_strong()));
    let bytes: u64 = buffers.iter().map(|buffer| buffer.bytes).sum();
    ui.add_space(theme::HALF);
    ui.label(theme::weak(format!("{} passes; {} buffers, {} in total", passes.len(), buffers.len(), text::bytes(bytes))));
    for pass in passes {
        ui.label(RichText::new(&pass.name).monospace()).on_hover_text(&pass.why);
    }
    ui.add_space(theme::HALF);
    for buffer in buffers {
        ui.horizontal(|ui| {
            ui.label(RichText::new(&buffer.name).monospace()).on_hover_text(&buffer.why);
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
