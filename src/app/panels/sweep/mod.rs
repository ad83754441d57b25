//! The panel of the accuracy sweep: choose axes, measure every combination of their options, and see the error over the
//! time as a plot and a table. A click pins the options of a combination.

mod plot;
mod table;

use std::sync::Arc;

use eframe::egui::{self, RichText, Ui};

use crate::{
    accuracy::{AXES, Axis},
    app::{
        action::Action,
        command::{Command, Commands},
        icons::{Icon, icon_button},
        log::Level,
        panel::Panel,
        screen::Inputs,
        state::State,
        sweep::{
            point::{Metric, Point, csv},
            request::{Progress, Request, SAMPLES},
        },
        text::first_line,
        theme,
    },
    preset::{AccuracyRequest, Preset},
};

/// Most combinations that are measured at once.
const MAX_COMBINATIONS: usize = 256;

/// Width of the column of axes, points.
const AXES_WIDTH: f32 = 232.0;

/// A finished sweep.
struct Measured {
    request: Request,
    points: Vec<Point>,
}

/// The panel of the accuracy sweep: chooses axes, measures their options, and shows the error over the time.
pub struct SweepPanel {
    /// Which axes are to be measured, in the order of [`AXES`].
    chosen: Vec<bool>,
    metric: Metric,
    running: Option<(Request, Arc<Progress>)>,
    measured: Option<Measured>,
    error: Option<String>,
}

impl Default for SweepPanel {
    fn default() -> Self {
        let chosen = AXES.iter().map(|axis| axis.name == "coverage").collect();
        Self { chosen, metric: Metric::default(), running: None, measured: None, error: None }
    }
}

/// The preset without its accuracy options and names: two presets that draw the same picture are equal.
fn picture_of(preset: &Preset) -> Preset {
    let accuracy = AccuracyRequest::default();
    Preset { accuracy, test: None, name: String::new(), about: String::new(), tags: Vec::new(), ..preset.evaluated() }
}

impl SweepPanel {
    pub fn is_measuring(&self) -> bool {
        self.running.is_some()
    }

    /// Number of points of the newest sweep.
    pub fn points(&self) -> usize {
        self.measured.as_ref().map_or(0, |measured| measured.points.len())
    }

    fn axes(&self) -> Vec<&'static Axis> {
        AXES.iter().zip(&self.chosen).filter(|(_, chosen)| **chosen).map(|(axis, _)| axis).collect()
    }

    /// Takes the points of the sweep that has ended. Returns the whole message of an error.
    pub fn arrived(&mut self, points: Result<Vec<Point>, String>) -> Option<String> {
        let (request, progress) = self.running.take()?;
        self.error = None;
        match points {
            _ if progress.is_canceled() => {}
            Ok(points) => self.measured = Some(Measured { request, points }),
            Err(error) => {
                self.error = Some(first_line(&error));
                return Some(error);
            }
        }
        None
    }

    fn header_ui(&self, ui: &mut Ui, commands: &Commands) {
        ui.horizontal(|ui| {
            ui.label(theme::heading("Accuracy sweep"));
            ui.label(theme::weak("time and error of this preset"));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if icon_button(ui, Icon::Cross, "Close the accuracy sweep").clicked() {
                    commands.perform(Action::Sweep);
                }
                if let Some(Measured { request, points }) = &self.measured {
                    if ui.small_button("Copy as CSV").on_hover_text("Copy the whole table").clicked() {
                        ui.copy_text(csv(points, &request.axes));
                        commands.send(Command::Notify(Level::Info, "Copied the table as CSV".into()));
                    }
                    ui.add_space(theme::GAP);
                    plot::legend_ui(ui);
                }
            });
        });
    }

    /// Axes to measure, and the button.
    fn axes_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let count = self.axes().iter().map(|axis| axis.words.len()).product();
        match &self.running {
            Some((_, progress)) => progress_ui(ui, progress),
            None => self.measure_ui(ui, state, commands, count),
        }
        ui.add_space(theme::HALF);
        let is_measuring = self.is_measuring();
        egui::ScrollArea::vertical().id_salt("axes").auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            for (axis, chosen) in AXES.iter().zip(&mut self.chosen) {
                ui.horizontal(|ui| {
                    let hint = format!("{}\n{}", axis.about.trim(), axis.words.join(", "));
                    let checkbox = egui::Checkbox::new(chosen, axis.name.replace('_', " "));
                    ui.add_enabled(!is_measuring, checkbox).on_hover_text(hint).accessible_name(format!("Measure {}", axis.name));
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        ui.label(theme::weak(format!("{} options", axis.words.len())).size(11.0));
                    });
                });
            }
        });
    }

    /// The button that measures `count` combinations.
    fn measure_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands, count: usize) {
        let shown = state.session.scene().and(state.screen.requested());
        ui.horizontal(|ui| {
            let is_ready = shown.is_some() && (2..=MAX_COMBINATIONS).contains(&count);
            let button = egui::Button::new("Measure").fill(theme::accent_ground()).min_size(egui::vec2(84.0, theme::ROW));
            let reason = match count {
                _ if shown.is_none() => "There is no picture yet",
                0..2 => "Choose an axis with more than one option",
                _ => "At most 256 combinations can be measured at once. Choose fewer axes.",
            };
            let hint = format!("Draw every combination {SAMPLES} times on a second device, and compare each with the oracle");
            let button = ui.add_enabled(is_ready, button).on_hover_text(hint).on_disabled_hover_text(reason);
            if let Some(inputs) = shown.filter(|_| button.clicked()) {
                self.start(state, commands, inputs);
            }
            let color = if count > MAX_COMBINATIONS { theme::red() } else { theme::text_weak() };
            ui.label(RichText::new(format!("{count} combinations")).color(color));
        });
        if let Some(error) = &self.error {
            theme::notice(ui, theme::red(), error);
        }
    }

    fn start(&mut self, state: &State, commands: &Commands, shown: &Inputs) {
        let request = Request {
            preset: state.session.visible_preset().evaluated(),
            size: [shown.view.width, shown.view.height],
            axes: self.axes(),
            title: state.session.title().to_owned(),
        };
        let progress = Arc::new(Progress::default());
        self.running = Some((request.clone(), progress.clone()));
        commands.send(Command::MeasureSweep(Box::new(request), progress));
    }

    /// Plot and table. Returns the index of the combination that was clicked.
    fn points_ui(&mut self, ui: &mut Ui, state: &State) -> Option<usize> {
        let Some(Measured { request, points }) = &self.measured else {
            let text = if self.running.is_some() {
                "Measuring on a second device. The picture can be edited meanwhile."
            } else {
                "Nothing is measured yet. Choose accuracy axes and press Measure: every combination of their options is drawn, timed, \
                 and compared with the exact oracle."
            };
            ui.vertical_centered(|ui| {
                ui.add_space((ui.available_height() * 0.4).max(8.0));
                ui.add(egui::Label::new(theme::weak(text)).wrap());
            });
            return None;
        };
        let metric = self.metric;
        let options = state.screen.options();
        let axes = &request.axes;
        let is_current =
            |point: &Point| options.is_some_and(|options| axes.iter().all(|axis| point.pins.get(axis) == Some(options.get(axis))));
        let height = ui.available_height();
        let table = (ui.available_width() * 0.48).clamp(300.0, 560.0);
        let plot = egui::vec2((ui.available_width() - table - 2.0 * theme::GAP).max(160.0), height);
        let mut clicked = None;
        ui.allocate_ui_with_layout(plot, egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for metric in Metric::of(points) {
                    ui.selectable_value(&mut self.metric, metric, RichText::new(metric.name()).size(12.0));
                }
            });
            clicked = plot::plot_ui(ui, &plot::Shown { points, metric, current: &is_current });
        });
        ui.vertical(|ui| {
            let [width, height] = request.size;
            let is_stale = picture_of(&request.preset) != picture_of(&state.session.visible_preset());
            let software = if state.screen.gpu.summary.software { "; compare software-adapter timings only with each other" } else { "" };
            let of = format!("{}, {width} × {height} px{software}", request.title);
            let (color, text) = if is_stale {
                (theme::amber(), format!("stale: measured on an earlier picture of {of}"))
            } else {
                (theme::text_weak(), of)
            };
            ui.add(egui::Label::new(RichText::new(text).size(11.0).color(color)).truncate());
            clicked = table::table_ui(ui, points, axes, metric, &is_current).or(clicked);
        });
        clicked
    }
}

impl Panel for SweepPanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        self.header_ui(ui, commands);
        ui.add_space(theme::HALF);
        let height = ui.available_height();
        ui.horizontal_top(|ui| {
            ui.allocate_ui_with_layout(egui::vec2(AXES_WIDTH, height), egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.set_width(AXES_WIDTH);
                self.axes_ui(ui, state, commands);
            });
            ui.separator();
            let clicked = self.points_ui(ui, state);
            if let (Some(index), Some(Measured { request, points })) = (clicked, &self.measured) {
                commands.send(Command::PinOptions(points[index].pins, request.axes.clone()));
            }
        });
    }
}

/// How far the sweep is, and a button that cancels it.
fn progress_ui(ui: &mut Ui, progress: &Progress) {
    let (done, all, what) = progress.read();
    let fraction = if all > 0 { done as f32 / all as f32 } else { 0.0 };
    let is_canceled = progress.is_canceled();
    let text = if is_canceled { "Stopping".into() } else { format!("{:.0} %  {what}", 100.0 * fraction) };
    ui.horizontal(|ui| {
        let bar = egui::ProgressBar::new(fraction).desired_width(AXES_WIDTH - 76.0).text(RichText::new(text).size(11.0));
        ui.add(bar.fill(theme::accent_ground()));
        if ui.add_enabled(!is_canceled, egui::Button::new("Cancel")).clicked() {
            progress.cancel();
        }
    });
    ui.request_repaint_after_secs(0.1);
}
