//! Sweep: what each option of the accuracy axes costs on this scene and how wrong it is, measured here and now. A plot of
//! error over milliseconds, its table, and a click that switches the preset to a combination.

mod measure;
mod plot;
mod point;
mod table;

use std::sync::{
    Arc, Mutex,
    atomic::{AtomicBool, Ordering},
};

use eframe::egui::{self, RichText, Ui};

use super::{
    App, Level,
    icons::{Icon, icon_button},
    log::first_line,
    theme,
};
use crate::{
    accuracy::{AXES, Axis},
    preset::{AccuracyRequest, Preset},
};
pub use measure::measure;
pub use point::{Metric, Point};

/// Samples of every combination.
pub const SAMPLES: usize = 30;

/// Combinations that are measured at once, at most.
const MOST: usize = 256;

/// Width of the column on the left, points.
const CHOICES: f32 = 232.0;

/// How far a measurement is; shared with the thread that measures.
#[derive(Default)]
pub struct Progress {
    is_cancelled: AtomicBool,
    state: Mutex<(usize, usize, String)>,
}

impl Progress {
    /// Says how far it is; false when nobody wants the rest any more.
    pub fn tell(&self, done: usize, all: usize, what: &str) -> bool {
        *self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = (done, all, what.to_owned());
        !self.is_cancelled.load(Ordering::Relaxed)
    }

    fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }

    fn read(&self) -> (usize, usize, String) {
        self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }
}

/// What is measured: the preset as it was, its size in pixels, and the axes.
#[derive(Clone)]
pub struct Question {
    pub preset: Preset,
    pub size: [u32; 2],
    pub axes: Vec<&'static Axis>,
    /// Name of the preset.
    pub title: String,
}

/// A finished measurement.
struct Answer {
    of: Question,
    points: Vec<Point>,
}

/// The panel's state; no part of the preset.
pub struct Sweep {
    /// Which axes are to be measured, in the order of [`AXES`].
    chosen: Vec<bool>,
    metric: Metric,
    running: Option<(Question, Arc<Progress>)>,
    answer: Option<Answer>,
    error: Option<String>,
}

impl Default for Sweep {
    fn default() -> Self {
        let chosen = AXES.iter().map(|axis| axis.name == "coverage").collect();
        Self { chosen, metric: Metric::default(), running: None, answer: None, error: None }
    }
}

impl Sweep {
    pub fn is_measuring(&self) -> bool {
        self.running.is_some()
    }

    fn axes(&self) -> Vec<&'static Axis> {
        AXES.iter().zip(&self.chosen).filter(|(_, chosen)| **chosen).map(|(axis, _)| axis).collect()
    }

    /// The measurement has ended; what went wrong in all its lines.
    pub fn arrived(&mut self, points: Result<Vec<Point>, String>) -> Option<String> {
        let (of, progress) = self.running.take()?;
        self.error = None;
        match points {
            _ if progress.is_cancelled.load(Ordering::Relaxed) => {}
            Ok(points) => self.answer = Some(Answer { of, points }),
            Err(error) => {
                self.error = Some(first_line(&error));
                return Some(error);
            }
        }
        None
    }
}

/// The preset without its options: the same of these is the same question.
fn bare(preset: &Preset) -> Preset {
    let mut bare = preset.evaluated();
    (bare.accuracy, bare.test, bare.name, bare.about) = (AccuracyRequest::default(), None, String::new(), String::new());
    bare.tags.clear();
    bare
}

impl App {
    /// The points of the newest measurement: for tests.
    pub fn sweep_points(&self) -> usize {
        self.sweep.answer.as_ref().map_or(0, |answer| answer.points.len())
    }

    pub(super) fn sweep_ui(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label(theme::heading("Sweep"));
            ui.label(theme::weak("speed against accuracy, on this preset"));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if icon_button(ui, Icon::Cross, "Close the trade").clicked() {
                    self.panels.sweep = false;
                }
                if let Some(answer) = &self.sweep.answer {
                    if ui.small_button("Copy as CSV").on_hover_text("Copy the whole table").clicked() {
                        ui.copy_text(point::csv(&answer.points, &answer.of.axes));
                        self.log.tell(Level::Info, "Copied the table as CSV", self.now_s);
                    }
                    ui.add_space(theme::GAP);
                    plot::key_ui(ui);
                }
            });
        });
        ui.add_space(theme::HALF);
        let height = ui.available_height();
        ui.horizontal_top(|ui| {
            ui.allocate_ui_with_layout(egui::vec2(CHOICES, height), egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.set_width(CHOICES);
                self.choices_ui(ui);
            });
            ui.separator();
            let chosen = self.answer_ui(ui);
            if let Some(index) = chosen {
                self.take_options(index);
            }
        });
    }

    /// Axes to measure, and the button.
    fn choices_ui(&mut self, ui: &mut Ui) {
        let count = self.sweep.axes().iter().map(|axis| axis.words.len()).product();
        self.measure_ui(ui, count);
        ui.add_space(theme::HALF);
        let is_measuring = self.sweep.is_measuring();
        egui::ScrollArea::vertical().id_salt("axes").auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            for (axis, chosen) in AXES.iter().zip(&mut self.sweep.chosen) {
                ui.horizontal(|ui| {
                    let hint = format!("{}\n{}", axis.about.trim(), axis.words.join(", "));
                    let checkbox = egui::Checkbox::new(chosen, axis.name);
                    ui.add_enabled(!is_measuring, checkbox).on_hover_text(hint).accessible_name(format!("Measure {}", axis.name));
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        ui.label(theme::weak(format!("{} options", axis.words.len())).size(11.0));
                    });
                });
            }
        });
    }

    /// Measure, or progress with a way to end it.
    fn measure_ui(&mut self, ui: &mut Ui, count: usize) {
        if let Some((_, progress)) = &self.sweep.running {
            let (done, all, what) = progress.read();
            let share = if all > 0 { done as f32 / all as f32 } else { 0.0 };
            let is_cancelled = progress.is_cancelled.load(Ordering::Relaxed);
            let text = if is_cancelled { "Stopping".into() } else { format!("{:.0} %  {what}", 100.0 * share) };
            ui.horizontal(|ui| {
                let bar = egui::ProgressBar::new(share).desired_width(CHOICES - 76.0).text(RichText::new(text).size(11.0));
                ui.add(bar.fill(theme::ACCENT_GROUND));
                if ui.add_enabled(!is_cancelled, egui::Button::new("Cancel")).clicked() {
                    progress.cancel();
                }
            });
            ui.request_repaint_after_secs(0.1);
            return;
        }
        let has_scene = self.scene_loader.shown.is_some() && self.motion.wanted.is_some();
        ui.horizontal(|ui| {
            let ready = has_scene && (2..=MOST).contains(&count);
            let button = egui::Button::new("Measure").fill(theme::ACCENT_GROUND).min_size(egui::vec2(84.0, theme::ROW));
            let why = match count {
                _ if !has_scene => "There is no picture yet",
                0..2 => "Choose an axis with more than one option",
                _ => "At most 256 combinations are measured at once",
            };
            let hint = format!("Draw every combination {SAMPLES} times in turn on a device of its own, and let the oracle judge each");
            if ui.add_enabled(ready, button).on_hover_text(hint).on_disabled_hover_text(why).clicked() {
                self.measure();
            }
            let color = if count > MOST { theme::RED } else { theme::TEXT_WEAK };
            ui.label(RichText::new(format!("{count} combinations")).color(color));
        });
        if let Some(error) = &self.sweep.error {
            theme::notice(ui, theme::RED, error);
        }
    }

    fn measure(&mut self) {
        let (Some((_, scene)), Some(wanted)) = (&self.scene_loader.shown, &self.motion.wanted) else { return };
        let preset = Preset { stack: self.visible_stack(), ..self.shown_preset() }.evaluated();
        let size = [wanted.view.width, wanted.view.height];
        let question = Question { preset, size, axes: self.sweep.axes(), title: self.preset_file.title().to_owned() };
        let progress = Arc::new(Progress::default());
        self.sweep.running = Some((question.clone(), progress.clone()));
        self.jobs.measure(self.screen.gpu.summary.name.clone(), scene.clone(), question, progress);
    }

    /// Plot and table; the combination that was clicked.
    fn answer_ui(&mut self, ui: &mut Ui) -> Option<usize> {
        let Some(answer) = &self.sweep.answer else {
            let text = if self.sweep.is_measuring() {
                "Measuring. The picture stays live meanwhile, on a device of its own."
            } else {
                "Nothing is measured yet. Choose axes of the accuracy axes and press Measure: every combination of their options is \
                 drawn in turn, timed, and judged by the exact oracle."
            };
            ui.vertical_centered(|ui| {
                ui.add_space((ui.available_height() * 0.4).max(8.0));
                ui.add(egui::Label::new(theme::weak(text)).wrap());
            });
            return None;
        };
        let metric = self.sweep.metric;
        let options = self.screen.options();
        let axes = &answer.of.axes;
        let current =
            |point: &Point| options.is_some_and(|options| axes.iter().all(|axis| point.pins.get(axis) == Some(options.get(axis))));
        let height = ui.available_height();
        let table = (ui.available_width() * 0.48).clamp(300.0, 560.0);
        let plot = egui::vec2((ui.available_width() - table - 2.0 * theme::GAP).max(160.0), height);
        let mut clicked = None;
        let mut chosen_metric = metric;
        ui.allocate_ui_with_layout(plot, egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for metric in Metric::of(&answer.points) {
                    ui.selectable_value(&mut chosen_metric, metric, RichText::new(metric.name()).size(12.0));
                }
            });
            clicked = plot::plot_ui(ui, &plot::Shown { points: &answer.points, metric, current: &current });
        });
        ui.vertical(|ui| {
            let [width, height] = answer.of.size;
            let is_stale = bare(&answer.of.preset) != bare(&Preset { stack: self.visible_stack(), ..self.shown_preset() });
            let software = if self.screen.gpu.summary.software { "; times of a software adapter rank nothing but themselves" } else { "" };
            let of = format!("{}, {width} × {height} px{software}", answer.of.title);
            let (color, text) =
                if is_stale { (theme::AMBER, format!("stale: measured on another picture of {of}")) } else { (theme::TEXT_WEAK, of) };
            ui.add(egui::Label::new(RichText::new(text).size(11.0).color(color)).truncate());
            clicked = table::table_ui(ui, &answer.points, axes, metric, &current).or(clicked);
        });
        self.sweep.metric = chosen_metric;
        clicked
    }

    /// PinnedOptions the options of a measured combination, as one step.
    fn take_options(&mut self, index: usize) {
        let Some(answer) = &self.sweep.answer else { return };
        let pins = answer.points[index].pins;
        self.history.close();
        for axis in &answer.of.axes {
            self.preset_file.preset.accuracy.pins.set(axis, pins.get(axis));
        }
        self.observe(false);
        self.history.close();
        self.tell(Level::Info, format!("Switched to {}", pins.words()));
    }
}
