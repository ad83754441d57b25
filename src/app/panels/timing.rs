//! The timing panel: the newest frames as a plot, and the median and spread of the frame and of its
//! passes.

use egui::{self, Color32, RichText, Ui, vec2};
use egui_plot::{Bar, BarChart, HLine, LineStyle};

use super::trade::plot::still_plot;

use crate::app::panels::panel::Panel;
use crate::{
    app::{
        picture::{
            measured::time_line,
            timings::{Cost, Occasion, Spread, Summary, Timings},
        },
        shell::{action::Action, command::Commands, state::State, ui_frames::UiFrames},
        widgets::{
            icons::{Icon, icon_button, swatch},
            panel::at_right,
            text::short,
            theme,
        },
    },
    measure::timing::percentile,
};

/// Width of the table, points.
const TABLE_WIDTH: f32 = 430.0;

/// The plot reaches this much above the slowest frame that compiled nothing.
const HEADROOM: f64 = 1.15;

/// Each occasion with its name in the legend.
const OCCASIONS: [(Occasion, &str); 3] = [
    (Occasion::Rest, "at rest"),
    (Occasion::Changed, "changed"),
    (Occasion::Compiled, "compiled"),
];

fn color(occasion: Occasion) -> Color32 {
    match occasion {
        Occasion::Rest => theme::accent(),
        Occasion::Changed => theme::text_weak(),
        Occasion::Compiled => theme::amber(),
    }
}

/// Shows what pictures cost.
pub struct TimingPanel;

impl Panel for TimingPanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let timings = state.picture.screen.timings();
        header_ui(ui, state, commands);
        ui.add_space(theme::HALF);
        if !state.picture.screen.gpu.caps.timestamps {
            ui.label(theme::weak(
                "This adapter has no timer, so frames cannot be timed.",
            ));
            return;
        }
        let height = ui.available_height();
        ui.horizontal_top(|ui| {
            let plot = vec2(
                (ui.available_width() - TABLE_WIDTH - 2.0 * theme::GAP).max(160.0),
                height,
            );
            ui.allocate_ui_with_layout(plot, egui::Layout::top_down(egui::Align::Min), |ui| {
                plot_ui(ui, timings)
            });
            ui.vertical(|ui| table_ui(ui, state));
        });
    }
}

fn header_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    ui.horizontal(|ui| {
        ui.label(theme::heading("Timing"));
        let (text, hint) = time_line(Some(&state.picture.screen));
        ui.label(theme::weak(text)).on_hover_text(hint);
        at_right(ui, |ui| {
            if icon_button(ui, Icon::Cross, "Close timing").clicked() {
                commands.perform(Action::Timing);
            }
            for (occasion, name) in OCCASIONS {
                ui.label(theme::small(name));
                swatch(ui, color(occasion));
            }
        });
    });
}

/// The newest frames, a bar each; a bar that compiled ends at the upper edge.
fn plot_ui(ui: &mut Ui, timings: &Timings) {
    let frames: Vec<(f64, Occasion)> = timings
        .history()
        .map(|(sample, occasion)| (sample.ms, occasion))
        .collect();
    if frames.is_empty() {
        ui.centered_and_justified(|ui| ui.label(theme::weak("Frames appear when they are drawn.")));
        return;
    }
    let top = top_ms(&frames);
    let charts = OCCASIONS.map(|(occasion, name)| {
        let color = color(occasion);
        let bars = frames.iter().enumerate();
        let bars = bars.filter(|(_, (_, other))| *other == occasion);
        let bars = bars.map(|(i, (ms, _))| {
            let bar = Bar::new(i as f64, ms.min(top)).width(0.9);
            bar.fill(color).stroke((0.0, color))
        });
        BarChart::new(name, bars.collect()).allow_hover(false)
    });
    let settled = match timings.cost() {
        Cost::Settled(summary) => Some(summary.frame.median),
        _ => None,
    };
    let count = frames.len();
    let response = still_plot("timing plot")
        .x_axis_formatter(|_, _| String::new())
        .y_axis_formatter(|mark, _| short(mark.value))
        .y_axis_label(RichText::new("milliseconds").size(11.0))
        .x_axis_label(RichText::new("newest frames, the last one at the right").size(11.0))
        .y_axis_min_width(40.0)
        .show(ui, |plot| {
            // Few frames stand at the right edge, at the width of many.
            let first = (count as f64 - 60.0).min(0.0);
            plot.set_plot_bounds_x(first - 0.5..=count as f64 - 0.5);
            plot.set_plot_bounds_y(0.0..=top);
            charts.into_iter().for_each(|chart| plot.bar_chart(chart));
            if let Some(median) = settled {
                let line = HLine::new("median", median)
                    .color(theme::green())
                    .width(1.0);
                plot.hline(line.style(LineStyle::dashed_dense()).allow_hover(false));
            }
        });
    let slowest = frames.iter().map(|(ms, _)| *ms).fold(0.0, f64::max);
    let text = format!("Times of {count} frames, the slowest {} ms", short(slowest));
    response
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &text));
    response.response.on_hover_text(text);
}

/// The upper end of the plot: nothing that compiles, nor one frame in twenty, sets it.
fn top_ms(frames: &[(f64, Occasion)]) -> f64 {
    let warm: Vec<f64> = frames
        .iter()
        .filter(|(_, occasion)| *occasion != Occasion::Compiled)
        .map(|(ms, _)| *ms)
        .collect();
    let all: Vec<f64> = frames.iter().map(|(ms, _)| *ms).collect();
    let slow = percentile(&warm, 0.95)
        .or(percentile(&all, 1.0))
        .unwrap_or(1.0);
    (HEADROOM * slow).max(1e-3)
}

/// Frame, passes and rest: median, spread and fraction of the frame; and how long an input takes to
/// be seen.
fn table_ui(ui: &mut Ui, state: &State) {
    let timings = state.picture.screen.timings();
    if let Some((latency, count)) = timings.latency() {
        let text = format!(
            "input to picture: {:.0} ms, p95 {:.0} ms, {count} pictures",
            latency.median, latency.p95
        );
        let hint = "From the frame of the window that takes an input to the one that shows its picture, for pictures that compiled nothing.";
        ui.label(RichText::new(text).size(12.0).color(theme::text()))
            .on_hover_text(hint);
    }
    window_ui(ui);
    let Cost::Settled(summary) = timings.cost() else {
        ui.label(theme::weak(
            "Passes are listed when the picture is at rest and its times have settled.",
        ));
        return;
    };
    egui::ScrollArea::vertical()
        .id_salt("passes")
        .auto_shrink(false)
        .show(ui, |ui| {
            egui::Grid::new("passes")
                .num_columns(4)
                .spacing([14.0, 3.0])
                .show(ui, |ui| {
                    for title in ["", "median", "p5 – p95", "of frame"] {
                        ui.label(theme::small(title));
                    }
                    ui.end_row();
                    for (name, spread, color) in rows(summary) {
                        ui.label(RichText::new(&name).color(color));
                        let cell = |text: String| RichText::new(text).monospace().color(color);
                        ui.label(cell(format!("{:.3}", spread.median)));
                        let range = format!("{:.3} – {:.3}", spread.p5, spread.p95);
                        ui.label(cell(range).color(theme::text_weak()));
                        let whole = summary.frame.median.max(f64::MIN_POSITIVE);
                        ui.label(cell(format!("{:.0} %", 100.0 * spread.median / whole)));
                        ui.end_row();
                    }
                });
        });
}

/// How long the window itself takes.
fn window_ui(ui: &mut Ui) {
    let frames = ui
        .ctx()
        .with_plugin(|frames: &mut UiFrames| (frames.times_ms(), frames.longest_ms()));
    let Some((times, Some(longest))) = frames else {
        return;
    };
    let Some(Spread { median, .. }) = Spread::of(&times) else {
        return;
    };
    let count = times.len();
    let text = format!(
        "window: {} ms a frame, longest {} ms of {count}",
        short(median),
        short(longest)
    );
    let hint = "Time of the UI thread for the newest frames of the window, with painting; what you do is not seen meanwhile.";
    ui.label(RichText::new(text).size(12.0).color(theme::text()))
        .on_hover_text(hint);
}

fn rows(summary: &Summary) -> Vec<(String, Spread, Color32)> {
    let frame = [("frame".to_owned(), summary.frame, theme::text_strong())];
    let passes = summary
        .passes
        .iter()
        .map(|(name, spread)| (name.clone(), *spread, theme::text()));
    frame
        .into_iter()
        .chain(passes)
        .chain([("rest".to_owned(), summary.rest, theme::text_weak())])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_compiled_does_not_flatten_the_others() {
        let mut frames = vec![(10.0, Occasion::Rest); 20];
        frames.push((5000.0, Occasion::Compiled));
        assert!((top_ms(&frames) - 11.5).abs() < 1e-9);
        assert!(
            (top_ms(&[(5000.0, Occasion::Compiled)]) - 5750.0).abs() < 1e-9,
            "alone it is shown whole"
        );
        assert!(top_ms(&[(0.0, Occasion::Rest)]) > 0.0);
    }
}
