//! The panel Trade: choose axes, measure every combination of their options, and see the error over
//! the time as a plot and a table. A click pins the options of a combination.

pub mod plot;
mod table;

use std::sync::Arc;

use egui::{self, RichText, Ui};

use crate::app::panels::panel::Panel;
use crate::{
    accuracy::{AXES, Axis},
    app::{
        editing::apply::pin_options,
        picture::{measured::others_text, screen::Inputs},
        shell::apply::measure_trade,
        shell::{action::Action, command::Commands, log::Level, state::State},
        trade::{
            pace::{Pace, Rates, about},
            point::{Metric, Point, csv},
            request::{MOST_PIXELS, Progress, Request, SAMPLES, measured_size},
        },
        widgets::{
            icons::{Icon, icon_button},
            panel::{at_right, main_button},
            text::first_line,
            theme,
        },
    },
    preset::{AccuracyRequest, Preset},
    trade::factors,
};

/// Most combinations that are measured at once.
const MAX_COMBINATIONS: usize = 256;

/// Width of the column of axes, points.
const AXES_WIDTH: f32 = 232.0;

/// A measurement that has ended.
struct Measured {
    request: Request,
    points: Vec<Point>,
}

/// A measurement under way.
struct Running {
    request: Request,
    progress: Arc<Progress>,
    workload: Workload,
}

/// What the time of a measurement depends on.
#[derive(Clone, Copy)]
struct Workload {
    combinations: usize,
    /// Of all pictures of the combinations, on average.
    pixels: f64,
    reference_pixels: f64,
    frame_ms: f64,
}

impl Workload {
    fn of(request: &Request, frame_ms: f64) -> Self {
        let factors = factors(&request.preset, &request.axes);
        let shown = request.size.into_iter().map(f64::from).product::<f64>();
        let squares: f64 = factors.iter().map(|factor| factor * factor).sum();
        // Where sizes are compared, the oracle also draws 64 pictures for the mean of 64 samples
        // per pixel.
        let supersampled = if factors.len() > 1 { 64.0 } else { 0.0 };
        Self {
            combinations: request.combinations(),
            pixels: shown * squares / factors.len() as f64,
            reference_pixels: shown * (squares + supersampled),
            frame_ms,
        }
    }

    fn pace(&self, rates: &Rates) -> Pace {
        Pace::of(
            self.combinations,
            SAMPLES,
            self.pixels,
            self.reference_pixels,
            self.frame_ms,
            rates,
        )
    }
}

/// The panel Trade: chooses axes, measures their options, and shows the error over the time.
pub struct TradePanel {
    /// Which axes are to be measured, in the order of [`AXES`].
    chosen: Vec<bool>,
    metric: Metric,
    running: Option<Running>,
    /// What the measurements of this session have taught about the machine.
    rates: Rates,
    measured: Option<Measured>,
    error: Option<String>,
}

impl Default for TradePanel {
    fn default() -> Self {
        let chosen = AXES.iter().map(|axis| axis.name == "coverage").collect();
        Self {
            chosen,
            metric: Metric::default(),
            running: None,
            rates: Rates::default(),
            measured: None,
            error: None,
        }
    }
}

/// The preset without its accuracy options and names: two presets that draw the same picture are
/// equal.
fn picture_of(preset: &Preset) -> Preset {
    let accuracy = AccuracyRequest::default();
    Preset {
        accuracy,
        test: None,
        name: String::new(),
        about: String::new(),
        tags: Vec::new(),
        ..preset.evaluated()
    }
}

impl TradePanel {
    pub fn is_measuring(&self) -> bool {
        self.running.is_some()
    }

    /// The measurement under way waits, since the person works in the window.
    pub fn pause(&self) {
        if let Some(running) = &self.running {
            running.progress.pause();
        }
    }

    /// Number of points of the newest measurement.
    pub fn points(&self) -> usize {
        self.measured
            .as_ref()
            .map_or(0, |measured| measured.points.len())
    }

    fn axes(&self) -> Vec<&'static Axis> {
        AXES.iter()
            .zip(&self.chosen)
            .filter(|(_, chosen)| **chosen)
            .map(|(axis, _)| axis)
            .collect()
    }

    /// Takes the points of the measurement that has ended. One that was canceled keeps those that
    /// were timed. Returns the whole message of an error.
    pub fn take_points(&mut self, points: Result<Vec<Point>, String>) -> Option<String> {
        let Running {
            request,
            progress,
            workload,
        } = self.running.take()?;
        let Workload {
            pixels,
            reference_pixels,
            frame_ms,
            ..
        } = workload;
        self.rates = progress
            .pace()
            .rates(pixels, reference_pixels, frame_ms, &self.rates);
        self.error = None;
        match points {
            Ok(points)
                if progress.is_canceled() && points.iter().all(|point| point.ms.is_none()) => {}
            Ok(points) => self.measured = Some(Measured { request, points }),
            Err(_) if progress.is_canceled() => {}
            Err(error) => {
                self.error = Some(first_line(&error));
                return Some(error);
            }
        }
        None
    }

    fn header_ui(&self, ui: &mut Ui, commands: &Commands) {
        ui.horizontal(|ui| {
            ui.label(theme::heading("Trade"));
            ui.label(theme::weak("time and error of the accuracy options"));
            at_right(ui, |ui| {
                if icon_button(ui, Icon::Cross, "Close Trade").clicked() {
                    commands.perform(Action::Trade);
                }
                if let Some(Measured { request, points }) = &self.measured {
                    if ui
                        .small_button("Copy as CSV")
                        .on_hover_text("Copy the whole table")
                        .clicked()
                    {
                        ui.copy_text(csv(points, &request.axes));
                        commands.notify(Level::Info, "Copied the table as CSV");
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
            Some(running) => progress_ui(ui, &running.progress),
            None => self.measure_ui(ui, state, commands, count),
        }
        ui.add_space(theme::HALF);
        let is_measuring = self.is_measuring();
        egui::ScrollArea::vertical()
            .id_salt("axes")
            .auto_shrink(false)
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 1.0;
                let plan = state.picture.screen.plan();
                let decides = |axis| plan.is_none_or(|plan| plan.reason(axis).is_some());
                let (shown, others): (Vec<_>, Vec<_>) = AXES
                    .iter()
                    .zip(&mut self.chosen)
                    .partition(|(axis, chosen)| **chosen || decides(axis));
                for (axis, chosen) in shown {
                    ui.horizontal(|ui| {
                        let hint = format!("{}\n{}", axis.about.trim(), axis.words.join(", "));
                        let checkbox = egui::Checkbox::new(chosen, axis.name.replace('_', " "));
                        ui.add_enabled(!is_measuring, checkbox)
                            .on_hover_text(hint)
                            .accessible_name(format!("Measure {}", axis.name));
                        at_right(ui, |ui| {
                            ui.label(theme::small(format!("{} options", axis.words.len())));
                        });
                    });
                }
                if !others.is_empty() {
                    ui.label(theme::small(others_text(others.len())));
                }
            });
    }

    /// The button that measures `count` combinations.
    fn measure_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands, count: usize) {
        let shown = state.session.scene().and(state.picture.screen.requested());
        let request = shown
            .filter(|_| count <= MAX_COMBINATIONS)
            .map(|inputs| self.request(state, inputs));
        ui.horizontal(|ui| {
            let is_ready = request.is_some() && count >= 2;
            let reason = match count {
                _ if shown.is_none() => "There is no picture yet",
                0..2 => "Choose an axis with more than one option",
                _ => "At most 256 combinations can be measured at once. Choose fewer axes.",
            };
            let limit = MOST_PIXELS.map_or_else(String::new, |most| {
                format!(" A page measures a picture of at most {most} pixels, and a sample is the mean of repeated frames.")
            });
            let hint = format!(
                "Draw every combination {SAMPLES} times on a second device, and compare each with the oracle. While you work in the window, the measurement waits.{limit}"
            );
            let button = main_button("Measure").min_size(egui::vec2(84.0, theme::ROW));
            let button = ui.add_enabled(is_ready, button).on_hover_text(hint);
            let button = button.on_disabled_hover_text(reason);
            if let Some((request, workload)) = request.as_ref().filter(|_| button.clicked()) {
                self.start(commands, request.clone(), *workload);
            }
            let text = RichText::new(format!("{count} combinations"));
            ui.label(text.color(match count > MAX_COMBINATIONS {
                true => theme::red(),
                false => theme::text_weak(),
            }));
        });
        if let Some((_, workload)) = request.as_ref().filter(|_| count >= 2) {
            ui.label(theme::small(format!("takes {}", about(workload.pace(&self.rates).left_s()))))
                .on_hover_text("How long it is expected to take, from the size and the time of the picture and from earlier measurements");
        }
        if let Some(error) = &self.error {
            theme::notice(ui, theme::red(), error);
        }
    }

    /// What would be measured, and how much work that is.
    fn request(&self, state: &State, shown: &Inputs) -> (Request, Workload) {
        let request = Request {
            preset: state.session.visible_preset().evaluated(),
            size: measured_size([shown.view.width, shown.view.height], MOST_PIXELS),
            axes: self.axes(),
            title: state.session.title().to_owned(),
        };
        // Without a timer, a frame of a software adapter.
        let frame_ms = state
            .picture
            .screen
            .timings()
            .cost_ms()
            .or(state.picture.screen.timings().newest_ms())
            .unwrap_or(30.0);
        let workload = Workload::of(&request, frame_ms);
        (request, workload)
    }

    fn start(&mut self, commands: &Commands, request: Request, workload: Workload) {
        let progress = Arc::new(Progress::new(workload.pace(&self.rates)));
        self.running = Some(Running {
            request: request.clone(),
            progress: progress.clone(),
            workload,
        });
        // A picture that plays keeps the device busy, so the measurement would wait for it.
        commands.run(|app| app.state.session.playback.pause());
        commands.run(|app| measure_trade(app, request, progress));
    }

    /// Plot and table. Returns the index of the combination that was clicked.
    fn points_ui(&mut self, ui: &mut Ui, state: &State) -> Option<usize> {
        let Some(Measured { request, points }) = &self.measured else {
            let text = if self.running.is_some() {
                "Measuring on a second device. While you work in the window, the measurement waits."
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
        let options = state.picture.screen.options();
        let axes = &request.axes;
        let is_current = |point: &Point| {
            options.is_some_and(|options| {
                axes.iter()
                    .all(|axis| point.pins.get(axis) == Some(options.get(axis)))
            })
        };
        let height = ui.available_height();
        let table = (ui.available_width() * 0.48).clamp(300.0, 560.0);
        let plot = egui::vec2(
            (ui.available_width() - table - 2.0 * theme::GAP).max(160.0),
            height,
        );
        let mut clicked = None;
        ui.allocate_ui_with_layout(plot, egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for metric in Metric::of(points) {
                    ui.selectable_value(
                        &mut self.metric,
                        metric,
                        RichText::new(metric.name()).size(12.0),
                    );
                }
            });
            clicked = plot::plot_ui(
                ui,
                &plot::Shown {
                    points,
                    metric,
                    current: &is_current,
                },
            );
        });
        ui.vertical(|ui| {
            let [width, height] = request.size;
            let is_stale =
                picture_of(&request.preset) != picture_of(&state.session.visible_preset());
            let software = if state.picture.screen.gpu.summary.software {
                "; compare software-adapter timings only with each other"
            } else {
                ""
            };
            let clock = match MOST_PIXELS {
                Some(_) => "; times of repeated frames",
                None => "",
            };
            let of = format!("{}, {width} × {height} px{clock}{software}", request.title);
            let (color, text) = if is_stale {
                (
                    theme::amber(),
                    format!("stale: measured on an earlier picture of {of}"),
                )
            } else {
                (theme::text_weak(), of)
            };
            ui.add(egui::Label::new(RichText::new(text).size(11.0).color(color)).truncate());
            clicked = table::table_ui(ui, points, axes, metric, &is_current).or(clicked);
        });
        clicked
    }
}

impl Panel for TradePanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        self.header_ui(ui, commands);
        ui.add_space(theme::HALF);
        let height = ui.available_height();
        ui.horizontal_top(|ui| {
            ui.allocate_ui_with_layout(
                egui::vec2(AXES_WIDTH, height),
                egui::Layout::top_down(egui::Align::Min),
                |ui| {
                    ui.set_width(AXES_WIDTH);
                    self.axes_ui(ui, state, commands);
                },
            );
            ui.separator();
            let clicked = self.points_ui(ui, state);
            if let (Some(index), Some(Measured { request, points })) = (clicked, &self.measured) {
                let (pins, axes) = (points[index].pins, request.axes.clone());
                commands.step(move |app| pin_options(&mut app.state, &pins, &axes));
            }
        });
    }
}

/// How far the measurement is, how long it still takes, and a button that cancels it.
fn progress_ui(ui: &mut Ui, progress: &Progress) {
    let (fraction, left_s, what) = progress.read();
    let is_canceled = progress.is_canceled();
    let state = match () {
        () if is_canceled => "Stopping".into(),
        () if progress.is_paused() => "Waiting while you work".into(),
        () => format!("{} left", about(left_s)),
    };
    ui.horizontal(|ui| {
        let text = RichText::new(format!("{:.0} %  {state}", 100.0 * fraction)).size(11.0);
        let bar = egui::ProgressBar::new(fraction as f32)
            .desired_width(AXES_WIDTH - 76.0)
            .text(text);
        ui.add(bar.fill(theme::accent_ground()));
        if ui
            .add_enabled(!is_canceled, egui::Button::new("Cancel"))
            .on_hover_text("Keep what has been timed")
            .clicked()
        {
            progress.cancel();
        }
    });
    ui.add(egui::Label::new(theme::small(what)).truncate());
    ui.request_repaint_after_secs(0.1);
}
