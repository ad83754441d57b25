//! The window: its state and its panels, and what happens in a frame.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use egui::{self, Ui, ViewportCommand};

use super::{
    escape::escape,
    fold::{Fold, handles_ui},
    input,
    loss::LossFlag,
    pointer_frames::PointerFrames,
    typing::HeldTyping,
};
use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::{history::History, trust::Trust},
        files::{
            command::{CodeUse, Manner},
            favorites::Favorites,
            live::Live,
            open,
            opening::Opening,
            recovery, reload,
            scene_loader::SceneKey,
            state::FileState,
            watch::Watcher,
        },
        jobs::Jobs,
        panels::{Panels, dialogs::Dialogs, log::toasts_ui},
        picture::{
            apply::verify_shown, precision::REST_S, screen::Screen, state::PictureState, tier_times,
        },
        settings::{OpenPanels, keeper::Keeper, last_session::Restored, recents::Recents},
        shell::{
            command::Commands,
            device::{self, Devices},
            log::{Level, Log},
            state::{Clipboard, Closing, State},
            ui_frames::UiFrames,
        },
        widgets::{self, panel::is_phone, theme},
    },
    effect_files::has_f32_error,
    gpu::device::AdapterChoice,
    host,
    preset_file::{self, Folders, PresetFile},
};

/// How the window is opened.
#[derive(Clone, Default)]
pub struct Options {
    /// A preset's id or file, a model, an exported picture, or `builtin:QUERY`.
    pub open: Option<String>,
    /// What `open` names, where it has been read, perhaps with changes.
    pub opened: Option<PresetFile>,
    pub adapter: AdapterChoice,
    /// The window's devices and the pipelines compiled for them; none before the first window.
    pub devices: Option<Devices>,
    /// Where presets and effects are, beside the user's own presets.
    pub folders: Folders,
    /// The folder where settings and session are kept; none keeps nothing.
    pub config: Option<PathBuf>,
    /// The file that messages of the log are appended to.
    pub log: Option<Arc<std::fs::File>>,
    /// Set when the device is lost.
    pub loss: LossFlag,
}

/// Most seconds between two frames of the window while a preset plays.
const PLAY_STEP_S: f32 = 1.0 / 30.0;
/// Width of the text of an effect where there is room, points: 80 columns and line numbers. Then the
/// width that it needs beside the presets, its least width, and that of the picture beside it.
const CODE_WIDTH: f32 = 640.0;
const CODE_BESIDE_PRESETS: f32 = 440.0;
const LEAST_CODE: f32 = 260.0;
const LEAST_PICTURE: f32 = 200.0;
/// Least width of the picture for which the presets stay beside the text, points.
const PICTURE_BESIDE_PRESETS: f32 = 400.0;

/// Asks about what a start must not do by itself.
fn ask_about(asks: Option<PresetFile>, crashed: Option<Box<Restored>>, dialogs: &mut Dialogs) {
    if let Some(asks) = asks {
        let said = format!("Opened {}", asks.title());
        match asks.outside_model {
            Some(_) => dialogs.ask_outside(asks.into(), Manner::WithScene, said),
            None => dialogs.ask_code(asks.into(), CodeUse::Open(Manner::WithScene, said)),
        }
    }
    if let Some(crashed) = crashed {
        dialogs.ask_restore(crashed);
    }
}

/// The whole window.
pub struct App {
    pub(in crate::app) ctx: egui::Context,
    pub(in crate::app) state: State,
    pub(in crate::app) panels: Panels,
    pub(in crate::app) commands: Commands,
    /// What was typed while a dialog opened.
    typing: HeldTyping,
    /// A text field had the focus when the last frame ended.
    was_typing: bool,
    pub(super) keeper: Keeper,
    /// The recent files that were looked for, and whether the window had the focus then.
    pub(super) looked_for: (Recents, bool),
    pub(super) loss: LossFlag,
    /// When the time was last advanced, while the preset plays.
    played_at_s: Option<f64>,
    pub(super) fold: Fold,
    title: String,
}

impl App {
    /// The window's contents on a device that was opened with
    /// [`wgpu_setup`](crate::app::wgpu_setup).
    ///
    /// # Errors
    /// If the window has no wgpu device.
    pub fn new(cc: &eframe::CreationContext<'_>, options: Options) -> anyhow::Result<Self> {
        host::shaders::choose(None);
        let ctx = &cc.egui_ctx;
        widgets::apply(ctx);
        ctx.add_plugin(PointerFrames::default());
        ctx.add_plugin(UiFrames::default());
        ctx.options_mut(|options| options.zoom_with_keyboard = false); // The table of actions has these keys.
        let (window, devices) = device::adopt(cc, options.devices)?;
        let mut log = Log::kept_in(options.log);
        let (keeper, settings, remarks) = Keeper::new(options.config);
        remarks
            .into_iter()
            .for_each(|remark| log.add(Level::Warning, remark));
        settings.theme.choose(ctx);
        ctx.set_zoom_factor(settings.scale);
        let summary = &devices.picture.summary;
        // A page is told of no driver.
        let known = [&summary.name, &summary.backend, &summary.driver].map(String::as_str);
        let known: Vec<&str> = known.into_iter().filter(|word| !word.is_empty()).collect();
        log.add(Level::Info, format!("adapter: {}", known.join(", ")));
        let mut panels = Panels::new(&options.folders);
        panels.browser.show(settings.browsing);
        panels.film.begin_with(settings.film.clone());
        let trust = Trust::default();
        let is_named = options.opened.is_some() || options.open.is_some();
        let start = recovery::start(
            options.opened,
            options.open.as_deref(),
            &options.folders,
            (&keeper, &trust),
            &mut log,
        );
        ask_about(start.asks, start.crashed, &mut panels.dialogs);
        let mut session = start.session;
        session.chose_look = is_named;
        if settings.up_axes.give(&mut session.preset_file) {
            session.remember(session.preset_file.clone());
        }
        // The start preset plays, unless on a software adapter, which draws moving pictures at half
        // their size: there its own moment stands whole. A preset that the user named does not play.
        session.playback.playing = options.open.is_none()
            && !start.is_restored
            && session.preset().is_moving()
            && !devices.picture.summary.software;
        let (favorites, remarks) = Favorites::load(options.folders.user.as_deref());
        remarks
            .into_iter()
            .for_each(|remark| log.notify(Level::Warning, remark, 0.0));
        let values = options
            .folders
            .effect_values()
            .map_or_else(Vec::new, |folder| preset_file::saved_values(&folder));
        Ok(Self {
            ctx: ctx.clone(),
            panels,
            state: State {
                files: FileState {
                    live: Live::new(Watcher::new(
                        cc.egui_ctx.clone(),
                        session.preset_file.effects.clone(),
                    )),
                    folders: options.folders,
                    trust,
                    favorites,
                    deleted: Vec::new(),
                    values,
                    opening: Opening::default(),
                    missing_files: HashSet::new(),
                },
                history: History::new(session.undo_state()),
                session,
                jobs: Jobs::new(cc.egui_ctx.clone()),
                picture: PictureState {
                    review: keeper.kept_review().into(),
                    ..PictureState::new(Screen::new(&window, devices, cc.egui_ctx.clone()))
                },
                clipboard: Clipboard::default(),
                log,
                open: settings.open,
                settings,
                closing: Closing {
                    keeps_session: keeper.keeps_session(),
                    may_quit: false,
                    keeps_edits: false,
                },
                now_s: 0.0,
            },
            commands: Commands::default(),
            typing: HeldTyping::default(),
            was_typing: false,
            keeper,
            looked_for: (Recents::default(), false),
            loss: options.loss,
            played_at_s: None,
            fold: Fold::default(),
            title: String::new(),
        })
    }

    /// Shows a panel and carries out its commands.
    fn panel_ui(&mut self, ui: &mut Ui, panel: impl FnOnce(&mut Panels) -> &mut dyn Panel) {
        panel(&mut self.panels).ui(ui, &self.state, &self.commands);
        self.apply();
    }

    /// Saves the preset for a new start of the window, once, and closes it.
    fn rescue(&mut self, ctx: &egui::Context) {
        if self.loss.is_set() {
            return;
        }
        self.loss.set();
        #[cfg(not(target_arch = "wasm32"))]
        {
            let saved = recovery::write_recovery(&self.state.session.preset_file);
            eprintln!("rasterlab: the graphics device was lost; {saved}");
        }
        #[cfg(target_arch = "wasm32")]
        {
            let State {
                settings,
                session,
                picture,
                ..
            } = &self.state;
            self.keeper
                .close(settings, (session, picture.review.kept()), true);
            crate::app::shell::page::stop("the device was lost");
        }
        self.state.closing.may_quit = true;
        ctx.send_viewport_cmd(ViewportCommand::Close);
    }

    fn update_title(&mut self, ctx: &egui::Context) {
        let session = &self.state.session;
        let title = format!(
            "{}{} - rasterlab",
            if session.is_modified() { "• " } else { "" },
            session.title()
        );
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            #[cfg(target_arch = "wasm32")]
            crate::app::shell::page::tell_shown(
                &title,
                session.is_modified(),
                &session.preset_file,
            );
            self.title = title;
        }
    }

    /// Asks before the window closes with unsaved changes.
    fn guard_close(&mut self, ctx: &egui::Context) {
        if ctx.input(|i| i.viewport().close_requested())
            && self.state.session.is_modified()
            && !self.state.closing.may_quit
        {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.panels.dialogs.ask_unsaved();
        } else if ctx.input(|i| i.viewport().close_requested())
            && let Some(path) = self.panels.code.unsaved().map(Path::to_owned)
        {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.panels.code.ask();
            let text = format!("{} has changes that are not saved", path.display());
            self.state.notify(Level::Warning, text);
        }
    }

    /// Advances the time while the preset plays. A film that is drawn gets the device and the
    /// processor for itself: meanwhile nothing plays, and no pictures of the panels are drawn.
    fn play(&mut self, ctx: &egui::Context) {
        let State {
            session,
            picture: PictureState { screen, .. },
            now_s,
            ..
        } = &mut self.state;
        if !session.playback.playing || self.panels.film.is_exporting() {
            self.played_at_s = None;
            return;
        }
        let before_s = self.played_at_s.replace(*now_s);
        session.advance(before_s.map_or(0.0, |before_s| *now_s - before_s));
        // A software adapter draws on the processor of the window. A finished picture repaints.
        if screen.gpu.summary.software && screen.is_waiting() {
            ctx.request_repaint_after_secs(PLAY_STEP_S);
        } else {
            ctx.request_repaint();
        }
    }

    /// Shows the scene of the preset, or loads it.
    fn request_scene(&mut self) {
        let key = SceneKey::of(&self.state.session.preset_file);
        if let Some(work) = self.state.session.scenes.request(&key) {
            self.state.jobs.load_scene(key, work);
        }
        open::announce(&mut self.state);
    }

    /// Starts drawing a thumbnail when nothing more urgent needs the processor.
    fn request_thumbnail(&mut self, ctx: &egui::Context) {
        let screen = &self.state.picture.screen;
        let is_playing = self.state.session.playback.playing;
        let is_busy = self.panels.film.is_exporting()
            || self.state.session.scenes.is_loading()
            || screen.is_awaited(is_playing)
            || (!is_playing && screen.needs_measuring());
        let browser = &mut self.panels.browser;
        // A page fetches goldens instead.
        if (!is_busy || cfg!(target_arch = "wasm32"))
            && let Some((next, size)) = browser.next_thumbnail(ctx)
        {
            return self.state.jobs.thumbnail(next, size);
        }
        let own = &self.state.session.preset_file;
        let key = SceneKey::of(own);
        let scene = self.state.session.scenes.shown_for(&key);
        let Some(scene) = scene.filter(|_| !is_busy) else {
            return;
        };
        if let Some((next, size)) = browser.next_on_model(ctx, &key) {
            self.state
                .jobs
                .thumbnail_on(next, own.clone(), scene.clone(), size);
        } else if let Some(next) = browser.effects.next_picture(ctx, &self.state.session) {
            self.state.jobs.effect_picture(next);
        }
    }

    /// Starts to measure the f32 errors of the effects when the picture is at rest. They are
    /// shown in the inspector alone.
    fn request_precision(&mut self, ctx: &egui::Context, is_held: bool) {
        let State {
            picture:
                PictureState {
                    precision,
                    screen,
                    verification,
                    ..
                },
            session,
            jobs,
            open,
            now_s,
            ..
        } = &mut self.state;
        let Some(requested) = screen.requested() else {
            return;
        };
        let rest_s = precision.rest_s(requested, *now_s);
        let is_known = precision.is_running()
            || precision.of(Some(requested)).is_some()
            || precision.has_failed(Some(requested));
        let is_busy = is_held
            || session.playback.playing
            || screen.is_waiting()
            || screen.is_measuring()
            || verification.is_running();
        let is_used = requested
            .stack
            .0
            .iter()
            .any(|enabled| has_f32_error(&enabled.effect));
        if !is_used || is_known || is_busy || !open.right || screen.drawn() != Some(requested) {
            return;
        }
        if rest_s < REST_S {
            return ctx.request_repaint_after_secs((REST_S - rest_s) as f32 + 0.01);
        }
        let cancelled = precision.start(requested.clone());
        let requested = requested.clone();
        #[cfg(target_arch = "wasm32")]
        return jobs.measure_precision(requested.preset(session), requested, cancelled);
        #[cfg(not(target_arch = "wasm32"))]
        jobs.measure_precision(requested, cancelled);
    }

    /// A panel over the timeline, of this name, usual height and least height.
    fn bottom_panel(
        &mut self,
        ui: &mut Ui,
        (name, [height, least]): (&'static str, [f32; 2]),
        is_open: fn(&mut OpenPanels) -> &mut bool,
        panel: fn(&mut Panels) -> &mut dyn Panel,
    ) {
        let frame = egui::Panel::bottom(name)
            .frame(theme::panel_frame())
            .resizable(true)
            .drag_to_open(name == "log")
            .default_size(height)
            .min_size(least);
        let was_open = *is_open(&mut self.state.open);
        let mut stays_open = was_open;
        frame.show_collapsible(ui, &mut stays_open, |ui| self.panel_ui(ui, panel));
        // A button of the panel may have closed it.
        if stays_open != was_open {
            *is_open(&mut self.state.open) = stays_open;
        }
    }

    fn panels_ui(&mut self, ui: &mut Ui) {
        egui::Panel::top("top")
            .frame(theme::bar_frame())
            .show_separator_line(false)
            .show(ui, |ui| self.panel_ui(ui, |panels| &mut panels.topbar));
        if is_phone(ui.ctx()) {
            egui::Panel::bottom("handles")
                .frame(theme::bar_frame())
                .show(ui, |ui| handles_ui(ui, &mut self.state.open));
        }
        let height = self.panels.timeline.height(&self.state.session);
        let timeline = egui::Panel::bottom("timeline")
            .frame(theme::bar_frame())
            .exact_size(height)
            .resizable(false)
            .drag_to_open(false);
        let mut is_open = self.state.open.timeline;
        timeline.show_collapsible(ui, &mut is_open, |ui| {
            self.panel_ui(ui, |panels| &mut panels.timeline)
        });
        self.state.open.timeline = is_open;
        self.bottom_panel(
            ui,
            ("trade", [304.0, 190.0]),
            |open| &mut open.trade,
            |panels| &mut panels.trade,
        );
        self.bottom_panel(
            ui,
            ("timing", [230.0, 150.0]),
            |open| &mut open.timing,
            |panels| &mut panels.timing,
        );
        self.bottom_panel(
            ui,
            ("log", [150.0, 72.0]),
            |open| &mut open.log,
            |panels| &mut panels.log,
        );
        let window = ui.ctx().content_rect().width();
        let [left_width, right_width] = self.state.settings.panel_widths(window);
        // Where there is no room for both, the text stands in place of the presets.
        let beside = left_width + CODE_BESIDE_PRESETS + PICTURE_BESIDE_PRESETS + right_width;
        if !self.panels.code.is_open() || beside <= window {
            let left = egui::Panel::left("left")
                .frame(theme::panel_frame())
                .default_size(left_width)
                .size_range(200.0..=420.0);
            let mut is_open = self.state.open.left;
            let shown = left.show_collapsible(ui, &mut is_open, |ui| {
                self.panel_ui(ui, |panels| &mut panels.browser)
            });
            self.state.settings.keep_width(
                0,
                self.state.open.left && is_open,
                shown.map(|shown| shown.response.rect),
                window,
            );
            self.state.open.left = is_open;
            if !is_open {
                self.panels.browser.close();
            }
        }
        if self.panels.code.is_open() {
            let widest = ui.available_width() - right_width - LEAST_PICTURE;
            egui::Panel::left("code")
                .frame(theme::panel_frame())
                .default_size(CODE_WIDTH.min((widest - LEAST_PICTURE).max(LEAST_CODE)))
                .size_range(LEAST_CODE..=widest.max(LEAST_CODE))
                .show(ui, |ui| self.panel_ui(ui, |panels| &mut panels.code));
        }
        let right = egui::Panel::right("right")
            .frame(theme::panel_frame())
            .default_size(right_width)
            .size_range(272.0..=520.0);
        let mut is_open = self.state.open.right;
        let shown = right.show_collapsible(ui, &mut is_open, |ui| {
            self.panel_ui(ui, |panels| &mut panels.inspector)
        });
        self.state.settings.keep_width(
            1,
            self.state.open.right && is_open,
            shown.map(|shown| shown.response.rect),
            window,
        );
        self.state.open.right = is_open;
        let rect = egui::CentralPanel::no_frame()
            .show(ui, |ui| self.viewport_ui(ui))
            .response
            .rect;
        toasts_ui(ui.ctx(), &self.state.log, rect, self.state.now_s);
    }

    /// Takes input, draws the picture, and shows it.
    fn viewport_ui(&mut self, ui: &mut Ui) {
        let interaction = self
            .panels
            .viewport
            .interact(ui, &self.state, &self.commands);
        self.apply();
        self.panels
            .viewport
            .draw(ui.ctx(), &mut self.state, &interaction);
        if !self.panels.film.is_exporting()
            && self.panels.viewport.needs_verdict(ui.ctx(), &self.state)
        {
            verify_shown(&mut self.state);
        }
        self.panels
            .viewport
            .show(ui, &self.state, &self.commands, interaction.response.rect);
        self.apply();
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        if let Some(taken_s) = frame.info().cpu_usage {
            ctx.with_plugin(|frames: &mut UiFrames| {
                frames.painted(Duration::from_secs_f32(taken_s))
            });
        }
        while let Some(done) = self.state.jobs.next() {
            done(self);
            self.apply();
        }
        #[cfg(target_arch = "wasm32")]
        crate::app::shell::page::send_waiting(&self.commands);
        reload::take_changes(self);
        if self.state.picture.screen.is_lost() {
            self.rescue(ctx);
        }
        if let Some(error) = self.state.picture.screen.take_error() {
            self.state.log.add(
                Level::Error,
                format!(
                    "the graphics driver reports an error, which is a bug of rasterlab: {error}"
                ),
            );
        }
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        if self.loss.is_set() {
            return; // egui panics if it has something to paint on a lost device.
        }
        let ctx = ui.ctx().clone();
        theme::follow(&ctx);
        self.state.settings.keys.show();
        device::tune(frame, &self.state.picture.screen.gpu);
        let (now_s, is_pressed, is_held) =
            ctx.input(|i| (i.time, i.pointer.any_pressed(), i.pointer.any_down()));
        self.state.now_s = now_s;
        if is_pressed {
            self.state.history.close(); // A press begins another gesture.
        }
        if ctx.input(|i| !i.events.is_empty()) || self.state.session.playback.playing {
            self.panels.trade.pause();
        }
        input::dropped_files(&ctx, &self.state, &self.commands);
        self.apply();
        escape(self, self.was_typing);
        if !self.panels.has_dialog() && !self.panels.settings.takes_key() {
            let given = (&self.state, self.panels.film.is_filled_in());
            input::shortcuts(&ctx, given, &mut self.typing, &self.commands);
            self.apply();
        }
        let is_awaited =
            self.panels.takes_text() || (self.state.open.settings && !self.panels.has_dialog());
        self.typing.follow(&ctx, is_awaited, now_s);
        self.state.clipboard.hovered_row = None;
        self.play(&ctx);
        self.request_scene();
        self.state.session.follow_particles();
        if cfg!(target_arch = "wasm32") {
            let width = ctx.content_rect().width();
            self.fold.follow(width, &mut self.state.open);
        }
        self.panels_ui(ui);
        self.panel_ui(ui, |panels| &mut panels.dialogs);
        self.panel_ui(ui, |panels| &mut panels.palette);
        self.panel_ui(ui, |panels| &mut panels.naming);
        self.panel_ui(ui, |panels| &mut panels.browser.effects);
        self.panel_ui(ui, |panels| &mut panels.settings);
        self.panel_ui(ui, |panels| &mut panels.extremes);
        self.panel_ui(ui, |panels| &mut panels.review);
        self.panel_ui(ui, |panels| &mut panels.randomize);
        self.panel_ui(ui, |panels| &mut panels.sweep);
        self.panel_ui(ui, |panels| &mut panels.film);
        self.panel_ui(ui, |panels| &mut panels.help);
        self.request_thumbnail(&ctx);
        self.request_precision(&ctx, is_held || self.panels.film.is_exporting());
        let compare = &self.panels.viewport.compare;
        tier_times::follow(
            &ctx,
            &mut self.state,
            is_held || compare.is_waiting() || compare.needs_measuring(),
        );
        self.state.observe(is_held);
        if let Some(wait_s) = self.state.history.wake_in_s(now_s).filter(|_| !is_held) {
            ctx.request_repaint_after_secs(wait_s as f32 + 0.01);
        }
        self.guard_close(&ctx);
        self.update_title(&ctx);
        self.keep(&ctx);
        self.was_typing = ctx.text_edit_focused();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}
