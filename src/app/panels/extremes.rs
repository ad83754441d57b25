//! Extreme cases: draws and judges their presets on a second device, while the window stays
//! responsive.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Mutex, MutexGuard},
    time::Duration,
};

use egui::{self, Color32, RichText, Ui};
use pollster::FutureExt as _;
use web_time::Instant;

use crate::app::panels::panel::Panel;
use crate::{
    app::{
        jobs::{Computing, memory, threads},
        shell::{command::Commands, log::Level, state::State},
        trade::pace::about,
        widgets::theme,
    },
    extremes::{Cases, Outcome, Report, names},
    gpu::{Gpu, Renderer, device::AdapterChoice},
    work::Work,
};

/// The window, and the run that it started last.
#[derive(Default)]
pub struct Extremes {
    is_open: bool,
    filter: String,
    run: Option<Arc<Run>>,
    /// The log says how the run ended.
    is_reported: bool,
}

/// Shared by the running thread and the window.
struct Run {
    planned: usize,
    /// What the oracle does for it; stopping the run cancels it.
    work: Arc<Work>,
    began: Instant,
    progress: Mutex<Progress>,
}

#[derive(Default)]
struct Progress {
    /// What is being drawn.
    now: String,
    reports: Vec<Report>,
    /// Why there is no run.
    error: Option<String>,
    is_over: bool,
}

impl Run {
    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Seconds that are left if the other cases take as long as those that are done; none before
    /// one is.
    fn left_s(&self, done: usize) -> Option<f64> {
        (done > 0).then(|| {
            self.began.elapsed().as_secs_f64() * (self.planned.saturating_sub(done)) as f64
                / done as f64
        })
    }

    /// Draws the cases one after another on a device of their own.
    fn draw(
        &self,
        names: &[&'static str],
        adapter: String,
        ctx: &egui::Context,
    ) -> Result<(), String> {
        let cases =
            Cases::unpack().map_err(|error| format!("the cases cannot be written: {error}"))?;
        let gpu = Gpu::open(&AdapterChoice::Named(adapter))
            .block_on()
            .map_err(|error| error.to_string())?;
        let mut renderer = Renderer::new(gpu.clone());
        for name in names {
            let run = || {
                cases.run(name, &mut renderer, &|what| {
                    self.progress().now = format!("{name}: {what}");
                    ctx.request_repaint_after(Duration::from_millis(100));
                    !self.work.is_canceled()
                })
            };
            // A case that is canceled ends as stopped, with a report.
            let report = self.work.run_to_its_end(run);
            let (is_failure, is_stopped) = (
                report.outcome.is_failure(),
                report.outcome == Outcome::Stopped,
            );
            self.progress().reports.push(report);
            ctx.request_repaint();
            if gpu.is_lost() {
                return Err("the device that drew the cases was lost".into());
            }
            if is_stopped {
                break;
            }
            if is_failure {
                // A failure may leave wrong data in queues and caches.
                renderer = Renderer::new(gpu.clone());
            }
        }
        Ok(())
    }
}

impl Extremes {
    /// True while a run is under way.
    pub fn is_running(&self) -> bool {
        self.run.as_ref().is_some_and(|run| !run.progress().is_over)
    }

    fn start(&mut self, adapter: String, computing: Computing, ctx: &egui::Context) {
        let names = names(Some(&self.filter));
        let run = Arc::new(Run {
            planned: names.len(),
            work: Arc::default(),
            began: Instant::now(),
            progress: Mutex::default(),
        });
        let (ctx, shared) = (ctx.clone(), run.clone());
        let work = move || {
            let _computing = computing;
            let result = catch_unwind(AssertUnwindSafe(|| shared.draw(&names, adapter, &ctx)))
                .unwrap_or_else(|_| {
                    Err("the run failed because of a bug; see the terminal for details".into())
                });
            memory::give_back();
            let mut progress = shared.progress();
            progress.error = result.err();
            progress.is_over = true;
            ctx.request_repaint();
        };
        if let Err(error) = threads::named("extremes").spawn(work) {
            *run.progress() = Progress {
                error: Some(format!("no thread could be started: {error}")),
                is_over: true,
                ..Progress::default()
            };
        }
        (self.run, self.is_reported) = (Some(run), false);
    }

    fn stop(&self) {
        if let Some(run) = &self.run {
            run.work.cancel();
        }
    }
}

impl Drop for Extremes {
    fn drop(&mut self) {
        self.stop();
    }
}

/// `52 cases: 51 passed, 1 failed`, without outcomes that did not occur.
fn summary(reports: &[Report]) -> String {
    let mut words = Vec::new();
    for report in reports {
        let word = report.outcome.word().to_lowercase();
        match words.iter_mut().find(|(known, _)| *known == word) {
            Some((_, count)) => *count += 1,
            None => words.push((word, 1)),
        }
    }
    let counts: Vec<String> = words
        .iter()
        .map(|(word, count)| format!("{count} {word}"))
        .collect();
    format!(
        "{} {}: {}",
        reports.len(),
        if reports.len() == 1 { "case" } else { "cases" },
        counts.join(", ")
    )
}

impl Extremes {
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Shows or hides the window.
    pub fn toggle(&mut self) {
        self.is_open = !self.is_open;
    }

    /// Reports in the log how a run ended, once.
    fn report(&mut self, commands: &Commands) {
        let Some(run) = self.run.clone().filter(|_| !self.is_reported) else {
            return;
        };
        let progress = run.progress();
        if !progress.is_over {
            return;
        }
        self.is_reported = true;
        for report in progress
            .reports
            .iter()
            .filter(|report| report.outcome.is_failure())
        {
            let why = report.outcome.why().unwrap_or_default();
            let text = format!("extreme case {}: {why}", report.name);
            commands.run(|app| app.state.log.add(Level::Error, text));
        }
        match &progress.error {
            Some(error) => commands.notify(Level::Error, format!("Extreme cases: {error}")),
            None => {
                let text = format!("Extreme cases: {}", summary(&progress.reports));
                commands.notify(Level::Info, text);
            }
        }
    }

    fn start_ui(&mut self, ui: &mut Ui, state: &State) {
        let about = "Slivers, ties, needles, deep stacks, huge numbers: each case is compared with the oracle, on a second device.";
        ui.label(theme::weak(about));
        ui.add_space(theme::HALF);
        let is_running = self.is_running();
        ui.horizontal(|ui| {
            let found = names(Some(&self.filter)).len();
            if is_running {
                if ui.button("Stop the run").clicked() {
                    self.stop();
                }
            } else {
                let text = if found == 1 {
                    "Run 1 case".to_owned()
                } else {
                    format!("Run {found} cases")
                };
                let button = egui::Button::new(text).fill(theme::accent_ground());
                if ui.add_enabled(found > 0, button).clicked() {
                    self.start(
                        state.picture.screen.gpu.summary.name.clone(),
                        state.jobs.busy(),
                        ui.ctx(),
                    );
                }
            }
            let filter =
                egui::TextEdit::singleline(&mut self.filter).hint_text("All; a part of a name");
            ui.add_enabled(!is_running, filter.desired_width(220.0))
                .accessible_name("Cases");
        });
    }
}

impl Panel for Extremes {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        self.report(commands);
        let mut is_open = self.is_open;
        let area = ui.ctx().content_rect();
        egui::Window::new("Extreme cases")
            .open(&mut is_open)
            .collapsible(false)
            .resizable(false)
            .default_width(560.0)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(area.center())
            .show(ui.ctx(), |ui| {
                ui.set_width(560.0);
                self.start_ui(ui, state);
                if let Some(run) = &self.run {
                    let height = (area.height() - 260.0).max(120.0);
                    run_ui(ui, run, height);
                }
            });
        self.is_open = is_open;
    }
}

fn run_ui(ui: &mut Ui, run: &Run, height: f32) {
    let progress = run.progress();
    let done = progress.reports.len();
    ui.add_space(theme::HALF);
    if progress.is_over {
        let failed = progress
            .reports
            .iter()
            .any(|report| report.outcome.is_failure());
        let color = if failed || progress.error.is_some() {
            theme::red()
        } else {
            theme::green()
        };
        ui.label(RichText::new(summary(&progress.reports)).color(color));
    } else {
        let text = match run.left_s(done) {
            _ if run.work.is_canceled() => "stopping".to_owned(),
            Some(left_s) => format!("{done} of {}, {} left", run.planned, about(left_s)),
            None => format!("{done} of {}", run.planned),
        };
        ui.add(egui::ProgressBar::new(done as f32 / run.planned.max(1) as f32).text(text));
        ui.add(egui::Label::new(theme::weak(progress.now.as_str())).truncate());
    }
    if let Some(error) = &progress.error {
        theme::notice(ui, theme::red(), error);
    }
    egui::ScrollArea::vertical()
        .max_height(height)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            let (failed, others): (Vec<_>, Vec<_>) = progress
                .reports
                .iter()
                .partition(|report| report.outcome.is_failure());
            for report in failed.into_iter().chain(others) {
                report_ui(ui, report);
            }
        });
}

fn report_ui(ui: &mut Ui, report: &Report) {
    let color: Color32 = match report.outcome {
        Outcome::Passed | Outcome::Refused(_) => theme::green(),
        Outcome::Stopped => theme::amber(),
        Outcome::Failed(_) => theme::red(),
    };
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(report.name).color(theme::text_strong())).truncate())
            .on_hover_text(&report.about);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(theme::weak(format!("{:.0} ms", report.ms)));
            ui.label(RichText::new(report.outcome.word().to_lowercase()).color(color));
        });
    });
    if let Some(why) = report.outcome.why() {
        ui.label(theme::weak(why));
    }
}
