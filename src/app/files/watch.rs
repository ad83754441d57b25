//! Watching files: a thread that reads effects, the open preset, the model and shaders again when
//! they change on disk. It reads, checks and compares, so the window only takes results.

use std::{
    path::{Path, PathBuf},
    sync::mpsc::{self, RecvTimeoutError},
    time::{Duration, SystemTime},
};

use super::system_watch::SystemWatch;
use crate::{
    effect_files::{Catalog, EffectError},
    preset_file::{self, MODEL_FORMATS, ModelFormat, PresetFile, surroundings},
};

/// Files are read when nothing has changed for this long: an editor may write a file in several
/// steps.
const DEBOUNCE: Duration = Duration::from_millis(50);

/// How often folders are looked at that the system does not watch, or that do not exist yet.
const POLL: Duration = Duration::from_secs(1);

/// Do files of this extension matter?
fn is_watched(extension: &str) -> bool {
    let models = MODEL_FORMATS
        .iter()
        .flat_map(|format| format.beside.iter().chain([&format.extension]));
    ["wgsl", "toml", "png", surroundings::EXTENSION]
        .iter()
        .chain(models)
        .any(|known| extension.eq_ignore_ascii_case(known))
}

/// What is watched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Targets {
    /// Folders of effects that any preset may use; a later one wins.
    pub effect_folders: Vec<PathBuf>,
    /// The open preset; its effects are in `effects` beside it.
    pub preset: Option<PathBuf>,
    /// The open model.
    pub model: Option<PathBuf>,
    /// The picture of what surrounds it.
    pub surroundings: Option<PathBuf>,
    /// The folder of shaders that replaces the built-in ones.
    pub shaders: Option<PathBuf>,
}

impl Targets {
    /// Folders that are watched, each with whether those inside it are too.
    fn folders(&self) -> Vec<(PathBuf, bool)> {
        let beside = self.preset_effects();
        let files = [&self.preset, &self.model, &self.surroundings]
            .into_iter()
            .flatten()
            .map(|file| folder_of(file).to_owned());
        let effects = self.effect_folders.iter().cloned().chain(beside);
        let mut folders: Vec<(PathBuf, bool)> =
            effects.chain(files).map(|folder| (folder, false)).collect();
        folders.extend(self.shaders.iter().map(|folder| (folder.clone(), true)));
        folders.sort();
        folders.dedup_by(|later, earlier| {
            later.0 == earlier.0 && {
                earlier.1 |= later.1;
                true
            }
        });
        folders
    }

    /// The folder of effects beside the preset.
    pub fn preset_effects(&self) -> Option<PathBuf> {
        self.preset
            .as_ref()
            .map(|preset| preset.with_file_name("effects"))
    }
}

/// What has changed on disk.
pub enum Change {
    Effects(Effects),
    /// The open preset as its file has it now. Errors are sentences for people.
    Preset(PathBuf, Result<Box<PresetFile>, String>),
    Model(PathBuf),
    Shaders,
}

/// The effects as their files have them now. In both catalogs a faulty file has its last good
/// effect, if there was one.
#[derive(Clone, PartialEq)]
pub struct Effects {
    /// For every preset.
    pub shared: Catalog,
    /// For the open preset: those beside it, too.
    pub open: Catalog,
    /// What is wrong with files, by the name of the effect.
    pub faults: Vec<(String, EffectError)>,
}

enum Message {
    Watch(Targets),
    /// Something has changed.
    Event,
}

/// The thread that watches.
pub struct Watcher {
    sender: mpsc::Sender<Message>,
    changes: mpsc::Receiver<Change>,
    targets: Targets,
}

impl Watcher {
    /// Starts the thread; it watches nothing yet. `known` are effects that need not be read anew.
    pub fn new(ctx: egui::Context, known: Catalog) -> Self {
        let (sender, messages) = mpsc::channel();
        let (changed, changes) = mpsc::channel();
        let events = sender.clone();
        let report = move |change| {
            let is_open = changed.send(change).is_ok();
            ctx.request_repaint();
            is_open
        };
        let work = move || Reader::new(known, Box::new(report)).run(&messages, &events);
        if let Err(error) = std::thread::Builder::new().name("watch".into()).spawn(work) {
            eprintln!("rasterlab: no thread could be started, so files are not watched: {error}");
        }
        Self {
            sender,
            changes,
            targets: Targets::default(),
        }
    }

    /// Watches `targets` and nothing else.
    pub fn watch(&mut self, targets: Targets) {
        if targets != self.targets {
            self.targets = targets.clone();
            // Without the thread nothing is watched, which was reported at the start.
            let _ = self.sender.send(Message::Watch(targets));
        }
    }

    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The next change, if any.
    pub fn next(&self) -> Option<Change> {
        self.changes.try_recv().ok()
    }
}

/// Length and time of a file's last change.
type Stamp = (PathBuf, u64, Option<SystemTime>);

/// What the thread knows of the files.
struct Reader {
    targets: Targets,
    /// Reports a change; false if the window is closed.
    report: Box<dyn Fn(Change) -> bool + Send>,
    effects: Effects,
    /// Text of the preset as it was read last, and whether it was faulty.
    preset: Option<(Vec<u8>, bool)>,
    model: Vec<Stamp>,
    shaders: Vec<Stamp>,
    /// The targets are new, so the effects are reported even if they are the same.
    is_new: bool,
    /// All files at the last look, for folders that the system does not watch.
    stamps: Vec<Stamp>,
}

impl Reader {
    fn new(known: Catalog, report: Box<dyn Fn(Change) -> bool + Send>) -> Self {
        Self {
            targets: Targets::default(),
            report,
            effects: Effects {
                shared: known.clone(),
                open: known,
                faults: Vec::new(),
            },
            preset: None,
            model: Vec::new(),
            shaders: Vec::new(),
            is_new: false,
            stamps: Vec::new(),
        }
    }

    /// Reads what changes until the window is closed.
    fn run(mut self, messages: &mpsc::Receiver<Message>, events: &mpsc::Sender<Message>) {
        let mut watched = Watched::new(events.clone());
        let mut is_stale = false;
        loop {
            let wait = if is_stale {
                Some(DEBOUNCE)
            } else {
                watched.is_incomplete().then_some(POLL)
            };
            let message = match wait {
                Some(wait) => messages.recv_timeout(wait),
                None => messages.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match message {
                Ok(Message::Watch(targets)) => {
                    watched.set(targets.folders());
                    self.begin(targets);
                    is_stale = true;
                }
                Ok(Message::Event) => is_stale = true,
                Err(RecvTimeoutError::Timeout) => {
                    watched.retry();
                    let stamps = self.all_stamps();
                    if (is_stale || stamps != self.stamps) && !self.read() {
                        return;
                    }
                    (self.stamps, is_stale) = (stamps, false);
                }
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    /// Watches `targets` from now on.
    fn begin(&mut self, targets: Targets) {
        if targets.preset != self.targets.preset {
            self.preset = None;
        }
        if (&targets.model, &targets.surroundings)
            != (&self.targets.model, &self.targets.surroundings)
        {
            self.model = model_stamps(&targets);
        }
        if targets.shaders != self.targets.shaders {
            self.shaders = shader_stamps(&targets);
        }
        (self.targets, self.is_new) = (targets, true);
    }

    /// Reads everything again and reports what differs. Returns false if the window is closed.
    fn read(&mut self) -> bool {
        self.read_effects() && self.read_preset() && self.read_model() && self.read_shaders()
    }

    fn read_effects(&mut self) -> bool {
        let (folders, beside) = (
            self.targets.effect_folders.clone(),
            self.targets.preset_effects(),
        );
        let folders = || folders.iter().map(PathBuf::as_path);
        let known = self.effects.open.joined(&self.effects.shared);
        let shared = known.reread(folders());
        let open = known
            .joined(&shared)
            .reread(folders().chain(beside.as_deref()));
        let faults = |catalog: &Catalog| -> Vec<(String, EffectError)> {
            catalog
                .custom()
                .filter_map(|(name, effect)| Some((name.to_owned(), effect.read.clone().err()?)))
                .collect()
        };
        let effects = Effects {
            faults: faults(&open),
            shared: shared.or_last_good(&known),
            open: open.or_last_good(&known),
        };
        let is_new = std::mem::take(&mut self.is_new);
        if effects == self.effects && !is_new {
            return true;
        }
        self.effects = effects.clone();
        (self.report)(Change::Effects(effects))
    }

    fn read_preset(&mut self) -> bool {
        let Some(path) = self.targets.preset.clone() else {
            return true;
        };
        // A file that is gone for a moment is being written; one that is gone for good leaves the
        // preset open.
        let Ok(bytes) = std::fs::read(&path) else {
            return true;
        };
        match &self.preset {
            // As it was when it was opened.
            None => {
                self.preset = Some((bytes, false));
                return true;
            }
            Some((read, false)) if *read == bytes => return true,
            Some(_) => {}
        }
        let read = preset_file::load_with(&path, &self.effects.open)
            .map(Box::new)
            .map_err(|error| error.to_string());
        self.preset = Some((bytes, read.is_err()));
        (self.report)(Change::Preset(path, read))
    }

    fn read_model(&mut self) -> bool {
        let stamps = model_stamps(&self.targets);
        let targets = &self.targets;
        let Some(path) = targets
            .model
            .clone()
            .or_else(|| targets.surroundings.clone())
            .filter(|path| stamps != self.model && path.is_file())
        else {
            return true;
        };
        self.model = stamps;
        (self.report)(Change::Model(path))
    }

    fn read_shaders(&mut self) -> bool {
        let stamps = shader_stamps(&self.targets);
        if stamps == self.shaders {
            return true;
        }
        self.shaders = stamps;
        (self.report)(Change::Shaders)
    }

    fn all_stamps(&self) -> Vec<Stamp> {
        let effects = self
            .targets
            .effect_folders
            .iter()
            .cloned()
            .chain(self.targets.preset_effects());
        let mut stamps: Vec<Stamp> = effects
            .flat_map(|folder| stamps_in(&folder, &["wgsl"], false))
            .collect();
        stamps.extend(self.targets.preset.as_deref().and_then(stamp));
        stamps.extend(model_stamps(&self.targets));
        stamps.extend(shader_stamps(&self.targets));
        stamps
    }
}

/// The system's watches.
struct Watched {
    /// None where the system has none.
    system: Option<SystemWatch>,
    /// Folders, whether those inside are watched too, and whether the system watches them.
    folders: Vec<(PathBuf, bool, bool)>,
}

impl Watched {
    fn new(events: mpsc::Sender<Message>) -> Self {
        let matters = |path: &PathBuf| {
            let extension = path.extension().and_then(|extension| extension.to_str());
            path.is_dir() || extension.is_none_or(is_watched)
        };
        let system = SystemWatch::new(move |paths| {
            if paths.is_none_or(|paths| paths.iter().any(matters)) {
                let _ = events.send(Message::Event);
            }
        });
        Self {
            system,
            folders: Vec::new(),
        }
    }

    fn set(&mut self, folders: Vec<(PathBuf, bool)>) {
        if let Some(system) = &mut self.system {
            self.folders
                .iter()
                .filter(|(_, _, is_watched)| *is_watched)
                .for_each(|(folder, _, _)| system.unwatch(folder));
        }
        self.folders = folders
            .into_iter()
            .map(|(folder, is_deep)| (folder, is_deep, false))
            .collect();
        self.retry();
    }

    /// Watches the folders that are not watched, where that is possible now.
    fn retry(&mut self) {
        let Some(system) = &mut self.system else {
            return;
        };
        for (folder, is_deep, is_watched) in &mut self.folders {
            if *is_watched && !folder.is_dir() {
                *is_watched = false; // The system forgets a folder that is removed.
            } else if !*is_watched && folder.is_dir() {
                *is_watched = system.watch(folder, *is_deep);
            }
        }
    }

    /// True if some folders must be looked at instead.
    fn is_incomplete(&self) -> bool {
        self.folders.iter().any(|(_, _, is_watched)| !is_watched)
    }
}

fn folder_of(file: &Path) -> &Path {
    file.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

fn stamp(path: &Path) -> Option<Stamp> {
    let about = std::fs::metadata(path)
        .ok()
        .filter(std::fs::Metadata::is_file)?;
    Some((path.to_owned(), about.len(), about.modified().ok()))
}

/// Stamps of the files of a folder with one of these extensions, sorted by path.
fn stamps_in(folder: &Path, extensions: &[&str], is_deep: bool) -> Vec<Stamp> {
    let mut stamps = Vec::new();
    for path in std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
    {
        if is_deep && path.is_dir() {
            stamps.extend(stamps_in(&path, extensions, true));
        } else if path.extension().is_some_and(|extension| {
            extensions
                .iter()
                .any(|known| extension.eq_ignore_ascii_case(known))
        }) {
            stamps.extend(stamp(&path));
        }
    }
    stamps.sort();
    stamps
}

/// The model, the files beside it that it may refer to, and the picture of its surroundings.
fn model_stamps(targets: &Targets) -> Vec<Stamp> {
    let surroundings = targets.surroundings.as_deref();
    let mut stamps: Vec<Stamp> = surroundings.and_then(stamp).into_iter().collect();
    let Some(model) = &targets.model else {
        return stamps;
    };
    stamps.extend(stamp(model));
    if let Some(format) = ModelFormat::of(model).filter(|format| !format.beside.is_empty()) {
        stamps.extend(stamps_in(folder_of(model), format.beside, false));
    }
    stamps
}

fn shader_stamps(targets: &Targets) -> Vec<Stamp> {
    targets
        .shaders
        .as_ref()
        .map_or(Vec::new(), |folder| stamps_in(folder, &["wgsl"], true))
}
