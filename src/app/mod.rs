//! The lab's window: looks and scenes on the left, the picture in the middle, every parameter on the right, the log
//! below. All of it edits one [`Look`]; what is drawn follows from that and from nothing else.
//!
//! Slow work happens in `jobs`; the window waits for no thread and for no device.

mod attraction;
mod blit;
mod clips;
mod compare;
mod dialogs;
mod edit;
mod extremes;
mod fields;
mod history;
mod icons;
mod inspector;
mod jobs;
mod keying;
mod legend;
mod light;
mod log;
mod orbit;
mod overlays;
mod playback;
mod presets;
mod scenery;
mod screen;
mod shortcuts;
mod start;
mod sweep;
mod theme;
mod timeline;
mod topbar;
mod verdict;
mod viewport;

use std::{
    collections::{BTreeSet, HashMap, VecDeque},
    path::PathBuf,
    sync::Arc,
};

use eframe::egui;

pub use history::History;
pub use log::Level;
pub use start::{DeviceLost, Options, adopt, run, wgpu_setup};

use crate::{
    effects::Effect,
    gpu::Gpu,
    params::Field,
    preset::Preset,
    preset_file::PresetFile,
    scene::{Scene, view::View},
};
use compare::Compare;
use dialogs::Dialog;
use extremes::Extremes;
use fields::Ask;
use jobs::{Done, Jobs, SceneKey};
use log::Log;
use overlays::Overlays;
use playback::Playback;
use presets::PresetBrowser;
use screen::{Inputs, Screen};
use start::Ending;
use sweep::Sweep;
use timeline::Timeline;
use verdict::Verdict;
use viewport::Motion;

/// Which file a preset is, as undo remembers it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct FileId {
    id: String,
    path: Option<PathBuf>,
}

impl FileId {
    fn of(preset_file: &PresetFile) -> Self {
        Self { id: preset_file.id.clone(), path: preset_file.path.clone() }
    }
}

/// All that undo takes back.
#[derive(Clone, Debug, PartialEq)]
struct UndoState {
    file: FileId,
    preset: Preset,
}

/// The scene that is shown, and the one that is on its way.
#[derive(Default)]
struct SceneLoader {
    shown: Option<(SceneKey, Arc<Scene>)>,
    loading: Option<SceneKey>,
    failed: Option<SceneKey>,
    /// Scenes to go back to without waiting.
    recent: VecDeque<(SceneKey, Arc<Scene>)>,
}

const RECENT_SCENES: usize = 4;

/// Which panels are open.
struct Panels {
    left: bool,
    right: bool,
    timeline: bool,
    sweep: bool,
    log: bool,
    cheat_sheet: bool,
    search: String,
}

/// The whole window.
pub struct App {
    options: Options,
    ending: Ending,
    preset_file: PresetFile,
    /// Every preset of this run as its file has it.
    files: HashMap<FileId, PresetFile>,
    history: History<UndoState>,
    scene_loader: SceneLoader,
    screen: Screen,
    jobs: Jobs,
    preset_browser: PresetBrowser,
    log: Log,
    /// Effects whose eye is shut: a viewing aid, no part of the preset.
    muted: BTreeSet<&'static str>,
    /// The point of an effect that the next click on the model gives.
    picking: Option<(&'static Effect, &'static Field)>,
    verdict: Option<Verdict>,
    /// Judgements under way.
    verifying: u32,
    overlays: Overlays,
    compare: Compare,
    sweep: Sweep,
    dialog: Option<Dialog>,
    extremes: Extremes,
    panels: Panels,
    playback: Playback,
    timeline: Timeline,
    motion: Motion,
    /// The way that a hand has led the particles.
    trail: attraction::Trail,
    /// Path and value of the row under the pointer.
    hovered_row: Option<(String, String)>,
    /// Where the next paste goes, when a menu asked for it.
    paste_into: Option<String>,
    seed: u32,
    title: String,
    may_quit: bool,
    now_s: f64,
}

impl App {
    /// The window's contents on a device made with [`wgpu_setup`].
    pub fn new(cc: &eframe::CreationContext<'_>, options: Options) -> anyhow::Result<Self> {
        Self::with_ending(cc, options, Ending::default())
    }

    fn with_ending(cc: &eframe::CreationContext<'_>, options: Options, ending: Ending) -> anyhow::Result<Self> {
        theme::apply(&cc.egui_ctx);
        let (window, gpu) = start::adopt(cc)?;
        let mut log = Log::default();
        let preset_file = start::first_preset(&options, &mut log);
        let history = History::new(UndoState { file: FileId::of(&preset_file), preset: preset_file.preset.clone() });
        let summary = &gpu.summary;
        log.add(Level::Info, format!("adapter: {}, {}, {}", summary.name, summary.backend, summary.driver));
        Ok(Self {
            preset_browser: PresetBrowser::new(options.presets_dir.as_deref()),
            files: HashMap::from([(FileId::of(&preset_file), preset_file.clone())]),
            screen: Screen::new(&window, gpu),
            jobs: Jobs::new(cc.egui_ctx.clone()),
            panels: Panels { left: true, right: true, timeline: true, sweep: false, log: false, cheat_sheet: false, search: String::new() },
            options,
            ending,
            preset_file,
            history,
            log,
            scene_loader: SceneLoader::default(),
            muted: BTreeSet::new(),
            picking: None,
            verdict: None,
            verifying: 0,
            overlays: Overlays::default(),
            compare: Compare::default(),
            sweep: Sweep::default(),
            dialog: None,
            extremes: Extremes::default(),
            playback: Playback::default(),
            timeline: Timeline::default(),
            motion: Motion::default(),
            trail: attraction::Trail::default(),
            hovered_row: None,
            paste_into: None,
            seed: 0,
            title: String::new(),
            may_quit: false,
            now_s: 0.0,
        })
    }

    /// The preset as it stands.
    pub fn preset_file(&self) -> &PresetFile {
        &self.preset_file
    }

    /// For tests: the preset to be changed as a hand would change it.
    pub fn preset_mut(&mut self) -> &mut Preset {
        &mut self.preset_file.preset
    }

    /// Frames dispatched so far: stays where it is while nothing changes.
    pub fn draws(&self) -> u64 {
        self.screen.draws()
    }

    /// Steps that undo can take back.
    pub fn undo_steps(&self) -> usize {
        self.history.steps()
    }

    /// Is there a picture of the preset as it stands, with nothing still on its way?
    pub fn is_idle(&self) -> bool {
        let scene = self.scene_loader.loading.is_none() && self.scene_loader.shown.is_some();
        let judged = self.verifying == 0 && self.overlays_are_settled();
        scene
            && !self.screen.is_waiting()
            && !self.compare.is_waiting()
            && judged
            && !self.sweep.is_measuring()
            && !self.preset_browser.is_busy()
    }

    /// Is there a picture at all?
    pub fn has_picture(&self) -> bool {
        self.screen.picture().is_some()
    }

    /// The log as text.
    pub fn log_text(&self) -> String {
        self.log.to_text()
    }

    /// The view that a picture of `size` pixels shows; none while there is no scene.
    pub fn view(&self, size: [u32; 2]) -> Option<View> {
        self.scene_loader.shown.as_ref().map(|(_, scene)| self.view_at(scene, size))
    }

    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.screen.gpu
    }

    fn tell(&mut self, level: Level, text: impl Into<String>) {
        self.log.tell(level, text, self.now_s);
    }

    /// Has the preset changes that would be lost? A preset without a file has none until it is touched.
    fn is_modified(&self) -> bool {
        self.files.get(&FileId::of(&self.preset_file)).is_none_or(|as_opened| as_opened.preset != self.preset_file.preset)
    }

    /// Takes in what threads have finished.
    fn collect(&mut self, ctx: &egui::Context) {
        while let Some(done) = self.jobs.next() {
            match done {
                Done::Scene(key, scene) => self.scene_arrived(key, scene),
                Done::Verdict(inputs, findings) => self.verdict_arrived(*inputs, findings),
                Done::Sweep(points) => {
                    if let Some(error) = self.sweep.arrived(points) {
                        self.log.add(Level::Error, error);
                    }
                }
                Done::Thumbnail(id, image) => self.preset_browser.thumbnail_arrived(ctx, id, image),
                Done::Shot(path, Ok(())) => self.tell(Level::Info, format!("Saved {}", path.display())),
                Done::Shot(_, Err(error)) => self.tell(Level::Error, error),
                Done::Path(purpose, path) => self.path_arrived(purpose, path),
            }
        }
    }

    fn scene_arrived(&mut self, key: SceneKey, scene: Result<Arc<Scene>, String>) {
        if self.scene_loader.loading.as_ref() == Some(&key) {
            self.scene_loader.loading = None;
        }
        match scene {
            Ok(scene) => {
                for note in &scene.notes {
                    self.log.add(Level::Warning, format!("{}: {note}", scene.name));
                }
                self.scene_loader.recent.push_front((key, scene));
                self.scene_loader.recent.truncate(RECENT_SCENES);
            }
            Err(error) => {
                self.tell(Level::Error, error);
                self.scene_loader.failed = Some(key);
            }
        }
    }

    /// Brings the scene of the preset on stage, or asks for it.
    fn set_scene_loader(&mut self) {
        let key = SceneKey::of(&self.preset_file.preset, self.preset_file.path.as_ref());
        let SceneLoader { shown, loading, failed, recent } = &mut self.scene_loader;
        if shown.as_ref().is_some_and(|(shown, _)| *shown == key) {
            *failed = None;
            return;
        }
        if let Some(found) = recent.iter().find(|(recent, _)| *recent == key) {
            *shown = Some(found.clone());
            *failed = None;
        } else if loading.as_ref() != Some(&key) && failed.as_ref() != Some(&key) {
            *loading = Some(key.clone());
            self.jobs.load_scene(key);
        }
    }

    /// Saves the preset for a new start of the window, once.
    fn rescue(&mut self, ctx: &egui::Context) {
        if self.ending.is_lost() {
            return;
        }
        let saved = start::write_recovery(&self.preset_file);
        eprintln!("rasterlab: the graphics device was lost; {saved}");
        self.ending.lose();
        self.may_quit = true;
        ctx.send_viewport_cmd(egui::ViewportCommand::Close);
    }

    fn update_title(&mut self, ctx: &egui::Context) {
        let title = format!("{}{} - rasterlab", if self.is_modified() { "• " } else { "" }, self.preset_file.title());
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Asks before unsaved work is closed.
    fn guard_close(&mut self, ctx: &egui::Context) {
        if ctx.input(|i| i.viewport().close_requested()) && self.is_modified() && !self.may_quit {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.dialog = Some(Dialog::Unsaved);
        }
    }

    fn panels_ui(&mut self, ui: &mut egui::Ui) {
        egui::Panel::top("top").frame(theme::bar_frame()).show_separator_line(false).show(ui, |ui| self.topbar_ui(ui));
        let mut timeline = self.panels.timeline;
        let height = self.timeline_height();
        egui::Panel::bottom("timeline").frame(theme::bar_frame()).exact_size(height).resizable(false).drag_to_open(false).show_collapsible(
            ui,
            &mut timeline,
            |ui| self.timeline_ui(ui),
        );
        self.panels.timeline = timeline;
        let mut sweep = self.panels.sweep;
        egui::Panel::bottom("sweep").frame(theme::panel_frame()).resizable(true).default_size(304.0).min_size(190.0).show_collapsible(
            ui,
            &mut sweep,
            |ui| self.sweep_ui(ui),
        );
        // The panel has a button of its own to close it.
        self.panels.sweep &= sweep;
        let mut log = self.panels.log;
        egui::Panel::bottom("log").frame(theme::panel_frame()).resizable(true).default_size(150.0).min_size(72.0).show_collapsible(
            ui,
            &mut log,
            |ui| self.log.panel_ui(ui),
        );
        self.panels.log = log;
        let mut left = self.panels.left;
        egui::Panel::left("left").frame(theme::panel_frame()).default_size(264.0).size_range(200.0..=420.0).show_collapsible(
            ui,
            &mut left,
            |ui| {
                self.left_ui(ui);
            },
        );
        self.panels.left = left;
        let mut right = self.panels.right;
        let frame = theme::panel_frame();
        egui::Panel::right("right").frame(frame).default_size(344.0).size_range(272.0..=520.0).show_collapsible(ui, &mut right, |ui| {
            self.inspector_ui(ui);
        });
        self.panels.right = right;
        let view = egui::CentralPanel::no_frame().show(ui, |ui| self.viewport_ui(ui)).response.rect;
        self.log.toasts_ui(ui.ctx(), view, self.now_s);
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        self.collect(ctx);
        if self.screen.is_lost() {
            self.rescue(ctx);
        }
        if let Some(error) = self.screen.gpu.take_error() {
            self.log.add(Level::Error, format!("the graphics driver refused something, which is our mistake: {error}"));
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        if self.ending.is_lost() {
            return; // The toolkit panics when it has something to paint on a dead device.
        }
        let ctx = ui.ctx().clone();
        start::tune(frame, &self.screen.gpu);
        let (now_s, pressed, held) = ctx.input(|i| (i.time, i.pointer.any_pressed(), i.pointer.any_down()));
        self.now_s = now_s;
        if pressed {
            self.history.close(); // What follows is another gesture.
        }
        self.take_drops(&ctx);
        self.take_keys(&ctx);
        self.hovered_row = None;
        self.play(&ctx);
        self.set_scene_loader();
        self.follow_particles();
        self.panels_ui(ui);
        self.dialog_ui(&ctx);
        self.cheat_sheet_ui(&ctx);
        self.extremes_ui(&ctx);
        self.feed_thumbnails();
        self.observe(held);
        if let Some(wake_s) = self.history.wake_in_s(now_s).filter(|_| !held) {
            ctx.request_repaint_after_secs(wake_s as f32 + 0.01);
        }
        self.guard_close(&ctx);
        self.update_title(&ctx);
    }

    fn clear_color(&self, _: &egui::Visuals) -> [f32; 4] {
        theme::PANEL.to_normalized_gamma_f32()
    }
}
