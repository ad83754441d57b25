//! Exporting a film: its format, size, rate and range, and how far it is. It is drawn on another
//! thread and another device, in a page between the window's frames.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use egui::{self, Button, Key, Label, Ui, vec2};

use crate::app::panels::panel::Panel;
use crate::{
    accuracy::RenderScale,
    app::{
        files::apply::export_film,
        jobs::film::{Failure, Finished, Format, Progress, Request, time_left_text},
        panels::dialogs::places::places_ui,
        settings::{film::FilmSettings, recents::Recents},
        shell::{command::Commands, log::Level, state::State},
        widgets::{
            form::{field_ui, form_ui, menu_ui, number_ui, text_ui, words_ui},
            panel::{at_right, centered_window, main_button},
            size::size_ui,
            text::cut_middle,
            theme,
        },
    },
    film::{Turntable, find_ffmpeg},
    host::disk,
    preset::{Clock, Preset},
};

const MAX_SIDE: u32 = FilmSettings::MAX_SIDE;

/// Width of the window, points.
const WIDTH: f32 = 460.0;

/// What anti-aliasing may be chosen; none: as the preset has it.
const ANTI_ALIASING: [(Option<RenderScale>, &str, &str); 4] = [
    (None, "As the preset", ""),
    (Some(RenderScale::Full), "Off", ""),
    (Some(RenderScale::Double), "2×2", ""),
    (Some(RenderScale::Quadruple), "4×4", ""),
];

const TURNTABLES: [(Option<Turntable>, &str, &str); 3] = [
    (None, "None", "No turn beside that of the preset"),
    (
        Some(Turntable::Camera),
        "Camera",
        "The camera goes around the scene once",
    ),
    (
        Some(Turntable::Scene),
        "Scene",
        "The scene turns once, in front of a still camera and light",
    ),
];

/// What is said of a film of a scene that stands still.
const NOTHING_MOVES: &str = "Nothing in this film moves, so every frame shows the same. A turntable turns it; a clip, a spin or keys move the scene.";

/// Whether the film goes from the look of the kept preset to that of the open one.
const LOOKS: [(bool, &str, &str); 2] = [
    (false, "This preset", "Its own look in every frame"),
    (
        true,
        "From A to B",
        "The first frame has the look of the preset kept as A, the last one that of this preset, and numbers and colors are in between",
    ),
];

/// The dialog that exports a film.
#[derive(Default)]
pub struct FilmPanel {
    form: Option<Form>,
    is_open: bool,
    /// It has just been opened: the path gets the focus.
    takes_focus: bool,
    running: Option<(Request, Arc<Progress>)>,
    /// The film that was canceled, until its thread has written the frame it was at.
    ending: Option<Arc<Progress>>,
    /// Why the last film was not finished.
    failure: Option<Failure>,
    /// How the last film was exported.
    last: FilmSettings,
}

/// What the person has chosen.
struct Form {
    /// The preset that it was filled in for.
    preset: String,
    path: String,
    format: Format,
    size: [u32; 2],
    fps: f64,
    range_s: [f64; 2],
    turntable: Option<Turntable>,
    /// The preset that is kept as A, if there is one, and whether the film begins with its look.
    a: Option<Box<Preset>>,
    is_from_a: bool,
    scale: Option<RenderScale>,
    has_ffmpeg: bool,
}

impl Form {
    fn new(state: &State, last: &FilmSettings) -> Self {
        let session = &state.session;
        let id = if session.preset_file.id.is_empty() {
            "film"
        } else {
            &session.preset_file.id
        };
        let output = session.preset().output.size;
        let shown = state
            .picture
            .screen
            .requested()
            .map_or(output, |inputs| [inputs.view.width, inputs.view.height]);
        let own_range_s = last
            .range_s
            .filter(|_| last.range_of.as_ref() == Some(&session.preset_file.id));
        let format = Format::here()
            .find(|format| *format == last.format)
            .unwrap_or(Format::Apng);
        let path = format.named(&folder(last).join(format!("{id}-film.png")));
        Self {
            preset: session.preset_file.id.clone(),
            path: path.display().to_string(),
            format,
            // Even, as MP4 needs it.
            size: last
                .size
                .unwrap_or_else(|| shown.map(|side| (side & !1).clamp(2, MAX_SIDE))),
            fps: last.fps,
            range_s: own_range_s.unwrap_or(session.preset().clock.range_s),
            turntable: None,
            a: None,
            is_from_a: false,
            scale: last.scale,
            has_ffmpeg: find_ffmpeg().is_some(),
        }
    }

    fn request(&self, replaces: bool) -> Request {
        Request {
            format: self.format,
            path: self.format.named(Path::new(self.path.trim())),
            size: self.size,
            fps: self.fps,
            range_s: self.range_s,
            turntable: self.turntable,
            from_look_of: self.a.clone().filter(|_| self.is_from_a),
            scale: self.scale,
            replaces,
        }
    }

    /// What is remembered of it.
    fn settings(&self, clock: &Clock) -> FilmSettings {
        let range_s = Some(self.range_s).filter(|range_s| *range_s != clock.range_s);
        let range_of = range_s.map(|_| self.preset.clone());
        let path = disk::absolute(self.path.trim()).unwrap_or_default();
        FilmSettings {
            format: self.format,
            size: Some(self.size),
            fps: self.fps,
            scale: self.scale,
            range_s,
            range_of,
            folder: path.parent().map(|path| path.display().to_string()),
        }
    }

    fn choose(&mut self, format: Format) {
        self.format = format;
        self.path = format
            .named(Path::new(self.path.trim()))
            .display()
            .to_string();
    }

    /// Why the film cannot be exported, in a sentence.
    fn fault(&self, clock: &Clock) -> Option<String> {
        if self.format.needs_ffmpeg() && !self.has_ffmpeg {
            let text = "needs ffmpeg, which is not installed (on Debian and Ubuntu: sudo apt install ffmpeg). PNG frames and animated PNG need no other program.";
            return Some(format!("{} {text}", self.format.name()));
        }
        if self.path.trim().is_empty() {
            return Some("Type a path.".into());
        }
        self.request(false)
            .schedule(clock)
            .err()
            .map(|error| error.to_string())
    }
}

impl FilmPanel {
    /// Shows or hides the dialog, filled in for the open preset; `a` is the preset that is kept as A.
    pub fn toggle(&mut self, state: &State, a: Option<&Preset>) {
        self.is_open = !self.is_open;
        self.takes_focus = self.is_open;
        if !self.is_open || self.running.is_some() {
            return;
        }
        match &mut self.form {
            // What was chosen before stays.
            Some(form) if form.preset == state.session.preset_file.id => {
                form.has_ffmpeg = find_ffmpeg().is_some()
            }
            form => (*form, self.failure) = (Some(Form::new(state, &self.last)), None),
        }
        if let Some(form) = &mut self.form {
            form.a = a.cloned().map(Box::new);
        }
    }

    /// How the last film was exported.
    pub fn last(&self) -> &FilmSettings {
        &self.last
    }

    /// The next film begins with these settings.
    pub fn begin_with(&mut self, last: FilmSettings) {
        self.last = last;
    }

    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Is its form shown, which keys are typed into?
    pub fn is_filled_in(&self) -> bool {
        self.is_open && !self.is_exporting()
    }

    pub fn is_exporting(&self) -> bool {
        self.running.is_some() || self.ending.is_some()
    }

    /// Takes the end of the film of `progress`. Returns what to say about it.
    pub fn take_end(
        &mut self,
        progress: &Arc<Progress>,
        ended: Result<Finished, Failure>,
    ) -> Option<(Level, String)> {
        self.ending.take_if(|ending| Arc::ptr_eq(ending, progress));
        let (request, _) = self
            .running
            .take_if(|(_, running)| Arc::ptr_eq(running, progress))?;
        match ended {
            Ok(Finished { drawn, kept }) => {
                (self.is_open, self.failure) = (false, None);
                let path = request.path.display();
                let kept = if kept > 0 {
                    format!(", {kept} were there")
                } else {
                    String::new()
                };
                Some((
                    Level::Info,
                    format!("Saved {path}: {drawn} frames drawn{kept}"),
                ))
            }
            Err(failure) => {
                self.is_open = true;
                let said = match &failure {
                    Failure::Stopped => None,
                    Failure::Taken(reason) | Failure::Other(reason) => {
                        Some((Level::Error, format!("The film was not exported: {reason}")))
                    }
                };
                self.failure = Some(failure);
                said
            }
        }
    }

    fn stop(&mut self) {
        if let Some((_, progress)) = self.running.take() {
            progress.stop();
            (self.ending, self.failure) = (Some(progress), Some(Failure::Stopped));
        }
    }

    fn start(&mut self, replaces: bool, clock: &Clock, commands: &Commands) {
        let Some(form) = &self.form else { return };
        self.last = form.settings(clock);
        let (request, progress) = (form.request(replaces), Arc::<Progress>::default());
        self.failure = None;
        let asked = (request.clone(), progress.clone());
        commands.run(|app| export_film(app, asked.0, asked.1));
        self.running = Some((request, progress));
    }

    /// The buttons, and what stands in the way.
    fn end_ui(&mut self, ui: &mut Ui, state: &State, is_entered: bool, commands: &Commands) {
        let fault = self
            .form
            .as_ref()
            .and_then(|form| form.fault(&state.session.preset().clock));
        let notice = match (&fault, &self.failure) {
            (Some(fault), _) => Some((theme::amber(), fault.clone())),
            (None, Some(Failure::Stopped)) => {
                let is_kept = |form: &Form| form.format.keeps_frames();
                let is_kept = self.form.as_ref().is_some_and(is_kept);
                Some((theme::amber(), stopped_text(is_kept).to_owned()))
            }
            (None, Some(Failure::Taken(reason))) => {
                Some((theme::amber(), format!("{reason}. Replace overwrites it.")))
            }
            (None, Some(Failure::Other(reason))) => Some((theme::red(), reason.clone())),
            (None, None) => None,
        };
        if let Some((color, text)) = notice {
            theme::notice(ui, color, &text);
        }
        ui.add_space(theme::HALF);
        let is_taken = matches!(self.failure, Some(Failure::Taken(_)));
        let is_ready = fault.is_none() && self.ending.is_none() && state.session.scene().is_some();
        let (mut is_started, mut is_closed) = (is_entered && is_ready && !is_taken, false);
        ui.horizontal(|ui| {
            at_right(ui, |ui| {
                let verb = if is_taken { "Replace" } else { "Export film" };
                let button = main_button(verb).min_size(vec2(96.0, theme::ROW));
                is_started |= ui.add_enabled(is_ready, button).clicked();
                let close = Button::new("Close").min_size(vec2(72.0, theme::ROW));
                is_closed = ui.add(close).clicked();
            });
        });
        if is_started {
            self.start(is_taken, &state.session.preset().clock, commands);
        }
        if is_closed {
            self.is_open = false;
        }
    }
}

impl Drop for FilmPanel {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Panel for FilmPanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        if !self.is_open {
            return;
        }
        let mut is_open = true;
        let area = ui.ctx().content_rect();
        let width = WIDTH.min(area.width() - 4.0 * theme::GAP);
        centered_window(ui.ctx(), "Export film", &mut is_open)
            .default_width(width)
            .show(ui.ctx(), |ui| {
                ui.set_width(width);
                if let Some((request, progress)) = self.running.clone() {
                    if progress_ui(ui, &request, &progress) {
                        self.stop();
                    }
                    return;
                }
                let clock = state.session.preset().clock;
                let before = self.form.as_ref().map(|form| form.request(false));
                let offers = (&state.settings.recents, commands);
                let takes_focus = std::mem::take(&mut self.takes_focus);
                let is_entered = self
                    .form
                    .as_mut()
                    .is_some_and(|form| film_ui(ui, form, &clock, takes_focus, offers));
                let form = self.form.as_ref();
                let moves = |form: &Form| form.turntable.is_some() || form.is_from_a;
                if !state.session.preset().is_moving() {
                    // Its room stays, so that no row moves under the pointer.
                    ui.scope(|ui| {
                        if form.is_some_and(moves) {
                            ui.set_invisible();
                        }
                        theme::notice(ui, theme::amber(), NOTHING_MOVES);
                    });
                }
                if before != self.form.as_ref().map(|form| form.request(false)) {
                    // What was agreed to, or failed, was another film.
                    self.failure = None;
                }
                self.end_ui(ui, state, is_entered, commands);
            });
        self.is_open &= is_open;
    }
}

/// Where a film is proposed: in the folder of the last one, else in that of videos or the home folder.
fn folder(last: &FilmSettings) -> PathBuf {
    let home = std::env::home_dir();
    let videos = home.as_ref().map(|home| home.join("Videos"));
    let folders = [last.folder.as_ref().map(PathBuf::from), videos, home];
    let mut folders = folders.into_iter().flatten();
    folders.find(|folder| folder.is_dir()).unwrap_or_default()
}

/// Returns true if Enter was pressed in the path.
fn film_ui(
    ui: &mut Ui,
    form: &mut Form,
    clock: &Clock,
    takes_focus: bool,
    (recents, commands): (&Recents, &Commands),
) -> bool {
    let mut format = form.format;
    let formats = Format::here().map(|format| (format, format.name(), ""));
    if ui
        .horizontal(|ui| words_ui(ui, "", &mut format, formats))
        .inner
    {
        form.choose(format);
    }
    ui.add_space(theme::HALF);
    let path = text_ui(ui, "Path of the film", "Path", &mut form.path);
    let is_entered = path.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
    if takes_focus {
        path.request_focus();
    }
    if let Some(folder) = places_ui(ui, recents) {
        let name = Path::new(&form.path).file_name().unwrap_or_default();
        form.path = folder.join(name).display().to_string();
    }
    let schedule = form.request(false).schedule(clock).ok();
    if let Some(schedule) = &schedule {
        ui.add(Label::new(theme::weak(about(form, schedule))).truncate());
    }
    if let Format::Video(container) = form.format
        && let Some(note) = container.fps_note(form.fps)
    {
        theme::notice(ui, theme::amber(), &note);
    }
    ui.add_space(theme::HALF);
    form_ui(ui, "film", |ui| {
        field_ui(ui, "Size", "", |ui| {
            let step = if form.format.needs_ffmpeg() { 2 } else { 1 };
            if let Some(said) = size_ui(ui, "the film", &mut form.size, step, MAX_SIDE) {
                commands.notify(Level::Info, said);
            }
        });
        field_ui(ui, "Frames per second", "", |ui| {
            let range = 1.0..=FilmSettings::MAX_FPS;
            number_ui(ui, "Frames per second", &mut form.fps, range, (0.5, ""));
        });
        field_ui(ui, "Range", "", |ui| {
            let [begin, end] = &mut form.range_s;
            for (time_s, name) in [(begin, "Begin of the film"), (end, "End of the film")] {
                number_ui(ui, name, time_s, f64::MIN..=f64::MAX, (0.05, " s"));
            }
            if form.range_s != clock.range_s && ui.small_button("Whole timeline").clicked() {
                form.range_s = clock.range_s;
            }
        });
        field_ui(ui, "AA", "Anti-aliasing: samples of a pixel", |ui| {
            let is_shown = |(scale, ..): &&(_, &str, &str)| *scale == form.scale;
            let now = ANTI_ALIASING
                .iter()
                .find(is_shown)
                .map_or("", |(_, name, _)| name);
            let name = "Anti-aliasing of the film";
            let (scale, _) = menu_ui(ui, name, (now, 100.0), Some(&form.scale), ANTI_ALIASING);
            form.scale = scale.unwrap_or(form.scale);
        });
        let hint = "One turn over the range. The preset is not changed.";
        field_ui(ui, "Turntable", hint, |ui| {
            words_ui(ui, "Turntable ", &mut form.turntable, TURNTABLES);
        });
        if form.a.is_some() {
            field_ui(ui, "Look", "", |ui| {
                words_ui(ui, "", &mut form.is_from_a, LOOKS);
            });
        }
    });
    ui.add_space(theme::HALF);
    is_entered
}

/// What a person reads when a film was stopped: which of its files are there.
const fn stopped_text(keeps_frames: bool) -> &'static str {
    if keeps_frames {
        "Stopped. Frames kept: the next export goes on after them."
    } else {
        "Stopped. No file was written: the next export begins again. PNG frames can go on."
    }
}

/// `120 frames, 4 s`, and the names of the files.
fn about(form: &Form, schedule: &crate::film::Schedule) -> String {
    let frames = schedule.frames.len();
    let length = format!(
        "{frames} {}, {:.2} s",
        if frames == 1 { "frame" } else { "frames" },
        frames as f64 / schedule.fps
    );
    let paths = form.request(false).frame_paths(schedule);
    let name = |path: &std::path::PathBuf| {
        path.file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    match (paths.first(), paths.last()) {
        (Some(first), Some(last)) => format!("{length}: {} to {}", name(first), name(last)),
        _ => length,
    }
}

/// Returns true if the film is to be stopped.
fn progress_ui(ui: &mut Ui, request: &Request, progress: &Progress) -> bool {
    let counts = progress.read();
    let path = request.path.display().to_string();
    ui.label(theme::strong(cut_middle(&path, 56)))
        .on_hover_text(path);
    ui.add_space(theme::HALF);
    let text = if counts.all == 0 {
        "Preparing".to_owned()
    } else {
        format!("{} of {} frames", counts.done, counts.all)
    };
    let part = counts.done as f32 / counts.all.max(1) as f32;
    ui.add(egui::ProgressBar::new(part).text(text).animate(true));
    let left = match counts.left_s() {
        Some(_) if counts.done == counts.all => "Finishing the file".into(),
        Some(left_s) => time_left_text(left_s),
        None => "The first frame is drawn".into(),
    };
    ui.add_space(theme::HALF);
    ui.horizontal(|ui| {
        ui.label(theme::weak(left));
        let cancel = Button::new("Cancel").min_size(vec2(72.0, theme::ROW));
        at_right(ui, |ui| ui.add(cancel).clicked())
    })
    .inner
}
