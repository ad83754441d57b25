//! Reloading what has changed on disk: effects, the open preset, the model and shaders. What cannot
//! be used leaves the last good version in place, with a fault that is shown until it is mended.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    command::CodeUse,
    live::{EffectReload, Subject, Waiting},
    scene_loader::SceneKey,
    watch::{Change, Effects, Targets},
};
use crate::{
    app::{
        App,
        picture::screen::Inputs,
        shell::{command::Edit, log::Level, state::State},
    },
    effect_files::{self, Catalog, EffectError},
    effects::Effect,
    host,
    preset::{
        SceneSource,
        rebind::{Replaced, rebind_stack},
    },
    preset_file::{self, PresetFile},
};

/// Watches what the open preset uses, and takes in what has changed.
pub fn take_changes(app: &mut App) {
    app.state.files.live.watcher.watch(targets(&app.state));
    while let Some(change) = app.state.files.live.watcher.next() {
        match change {
            Change::Effects(effects) => effects_changed(app, effects),
            Change::Preset(path, read) => preset_changed(app, &path, read),
            Change::Model(path) => model_changed(&mut app.state, &path),
            Change::Shaders => shaders_changed(app),
        }
    }
    enable_waiting(app);
}

/// What is watched for the open preset.
fn targets(state: &State) -> Targets {
    let open = &state.session.preset_file;
    let preset = open.path.clone().filter(|path| {
        path.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
    });
    let model = match &open.preset.scene {
        SceneSource::File(model) => Some(
            open.path
                .as_deref()
                .and_then(Path::parent)
                .unwrap_or(Path::new(""))
                .join(model),
        ),
        SceneSource::Builtin(_) => None,
    };
    let shaders = host::shaders::choose(None).map(Path::to_owned);
    Targets {
        effect_folders: state.files.folders.effect_folders.clone(),
        preset,
        model,
        surroundings: open.surroundings_path(),
        shaders,
    }
}

/// Logs what is wrong with a file and shows it until it is mended.
fn fault(state: &mut State, subject: Subject, text: String) {
    if state.files.live.set_fault(subject, text.clone()) {
        state.log.add(Level::Error, text);
    }
}

fn effects_changed(app: &mut App, effects: Effects) {
    let Effects {
        shared,
        open,
        faults,
    } = effects;
    let before = &app.state.session.preset_file.effects;
    let stack = &app.state.session.preset().stack;
    // Effects that came inside the preset stay, and so does one that is enabled and whose file is
    // gone.
    let kept = before.only(|name, effect| {
        effect.path.is_none()
            || open.custom().all(|(other, _)| other != name) && stack.get(name).is_some()
    });
    let gone: Vec<String> = kept
        .custom()
        .filter(|(_, effect)| effect.path.is_some())
        .map(|(name, _)| name.to_owned())
        .collect();
    let open = kept.joined(&open);
    let is_faulty = |name: &str| {
        faults.iter().any(|(faulty, _)| faulty == name) || gone.iter().any(|gone| gone == name)
    };
    app.state.files.live.keep_effect_faults(is_faulty);
    for (name, error) in faults {
        fault(&mut app.state, Subject::Effect(name), error.to_string());
    }
    for name in gone {
        let text = format!(
            "{name}.wgsl: no folder of effects has this file any more; the picture keeps the effect as it was"
        );
        fault(&mut app.state, Subject::Effect(name), text);
    }
    if let Some(path) = app.panels.code.path().map(Path::to_owned)
        && let Some(text) = shared.written(&path).or_else(|| open.written(&path))
    {
        app.panels.code.take_saved(&path, text);
    }
    compile_effects(app, shared, open);
}

/// Takes in an effect as its text was typed in the window; the file keeps its own.
pub fn code_tried(app: &mut App, path: &Path, read: Result<Arc<Effect>, EffectError>) {
    let name = effect_files::stem(path);
    match read {
        Err(error) => fault(&mut app.state, Subject::Effect(name), error.to_string()),
        Ok(effect) => {
            app.state.files.live.clear_fault(&Subject::Effect(name));
            let [shared, open] = [
                &app.state.files.folders.effects,
                &app.state.session.preset_file.effects,
            ]
            .map(|catalog| catalog.with_text_of(path, &effect));
            compile_effects(app, shared, open);
        }
    }
}

/// Compiles what the picture shows of effects that have changed, and uses them then.
fn compile_effects(app: &mut App, shared: Catalog, open: Catalog) {
    let good = |catalog: &Catalog, name: &str| catalog.find(name).ok().flatten().cloned();
    let before = &app.state.session.preset_file.effects;
    let mut replaced: Vec<Replaced> = Vec::new();
    for (old, new) in [(before, &open), (&app.state.files.folders.effects, &shared)] {
        for (name, _) in new.custom() {
            if let (Some(old), Some(new)) = (good(old, name), good(new, name))
                && old != new
                && !replaced.iter().any(|(known, _)| *known == old)
            {
                replaced.push((old, new));
            }
        }
    }
    let instances: Vec<Arc<Effect>> = app
        .state
        .session
        .catalogs()
        .flat_map(Catalog::instances)
        .cloned()
        .collect();
    for instance in instances {
        let of_base = replaced
            .iter()
            .find(|(old, _)| instance.base.as_ref() == Some(old))
            .map(|(_, new)| new);
        if let Some(base) = of_base
            && !replaced.iter().any(|(known, _)| *known == instance)
        {
            let renewed = Effect::instance(&instance.name, base);
            replaced.push((instance, Arc::new(renewed)));
        }
    }
    let open = open.replaced(&replaced);
    let number = app.state.files.live.request();
    let reload = EffectReload {
        number,
        shared,
        open,
        replaced,
    };
    match compiled_inputs(&app.state, &reload.replaced) {
        Some(inputs) => {
            app.state.files.live.compiling_effects = Some(number);
            let gpu = app.state.picture.screen.gpu.clone();
            let then = move |app: &mut App, outcome| effects_compiled(app, reload, outcome);
            app.state.jobs.compile(gpu, inputs, then);
        }
        None => use_effects(app, reload),
    }
}

/// What is to be drawn with the new effects; none if the picture shows none of them.
fn compiled_inputs(state: &State, replaced: &[Replaced]) -> Option<Inputs> {
    let requested = state.picture.screen.requested()?;
    let is_replaced = |effect: &Effect| replaced.iter().any(|(old, _)| **old == *effect);
    requested
        .stack
        .0
        .iter()
        .find(|enabled| is_replaced(&enabled.effect))?;
    let mut inputs = requested.clone();
    rebind_stack(&mut inputs.stack, replaced);
    Some(inputs)
}

/// Takes in the result of compiling effects; an outdated one is dropped.
fn effects_compiled(app: &mut App, reload: EffectReload, outcome: Result<(), String>) {
    if app.state.files.live.compiling_effects != Some(reload.number) {
        return;
    }
    app.state.files.live.compiling_effects = None;
    match outcome {
        Ok(()) => use_effects(app, reload),
        Err(error) => {
            let replaced = reload.replaced.iter();
            let names: Vec<&str> = replaced.map(|(_, new)| new.name.as_str()).collect();
            let text = format!("{}: {error}", names.join(", "));
            fault(&mut app.state, Subject::Pipelines, text);
        }
    }
}

/// Takes in the result of compiling shaders; an outdated one is dropped.
fn shaders_compiled(app: &mut App, number: u64, outcome: Result<(), String>) {
    if app.state.files.live.compiling_shaders != Some(number) {
        return;
    }
    app.state.files.live.compiling_shaders = None;
    match outcome {
        Ok(()) => use_shaders(app),
        Err(error) => fault(&mut app.state, Subject::Shaders, error),
    }
}

/// Uses effects as their files have them now, in every preset that was opened and in every step of
/// undo.
fn use_effects(app: &mut App, reload: EffectReload) {
    let EffectReload {
        number: _,
        shared,
        open,
        replaced,
    } = reload;
    app.state.files.live.clear_fault(&Subject::Pipelines);
    app.state.files.folders.effects = shared;
    app.state.session.rebind(&replaced, &open);
    app.state
        .history
        .change_all(|step| step.preset.rebind(&replaced));
    let is_replaced = |effect: &Effect| replaced.iter().any(|(old, _)| **old == *effect);
    if app
        .state
        .picture
        .picking
        .as_ref()
        .is_some_and(|picking| is_replaced(picking.effect()))
    {
        app.state.picture.picking = None;
    }
    if app
        .panels
        .timeline
        .selected
        .as_ref()
        .is_some_and(|key| is_replaced(&key.effect))
    {
        app.panels.timeline.selected = None;
    }
    for (_, effect) in &replaced {
        if app.state.session.preset().stack.get(&effect.name).is_some() {
            app.notify(Level::Info, format!("{} was reloaded", effect.name));
        }
    }
    if replaced.iter().any(|(_, new)| {
        app.state
            .session
            .as_filed()
            .preset
            .stack
            .get(&new.name)
            .is_some()
    }) {
        recheck_golden(&mut app.state);
    }
    warn_of_other_file(&mut app.state);
}

/// Draws the golden of the open preset again, if it has one, and compares.
fn recheck_golden(state: &mut State) {
    let filed = state.session.as_filed();
    if filed.preset.test.is_none() {
        return;
    }
    let filed = filed.clone();
    let number = state.files.live.request();
    state.files.live.checking_golden = Some(number);
    state.files.live.golden = None;
    state.jobs.check_golden(number, filed);
}

/// A file whose name another file has, in a folder that is searched later, cannot be enabled.
fn warn_of_other_file(state: &mut State) {
    let Some(Waiting { path, .. }) = state.files.live.enable.clone() else {
        return;
    };
    let Some(name) = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned())
    else {
        return;
    };
    let other = state
        .session
        .preset_file
        .effects
        .custom()
        .find(|(known, _)| *known == name)
        .map(|(_, effect)| effect.path.clone());
    if let Some(other) = other.filter(|other| other.as_deref() != Some(&path)) {
        state.files.live.enable = None;
        let place = other.map_or_else(
            || "the one inside the preset".into(),
            |other| other.display().to_string(),
        );
        state.notify(
            Level::Warning,
            format!(
                "{}: {place} has the same name and is used instead",
                path.display()
            ),
        );
    }
}

/// Enables the effect of a new or dropped file when it has been read, and shows its sliders.
fn enable_waiting(app: &mut App) {
    let state = &mut app.state;
    let Some(Waiting { path, replaces }) = &state.files.live.enable else {
        return;
    };
    let (path, replaces) = (path.as_path(), replaces.clone());
    let found = state
        .session
        .preset_file
        .effects
        .custom()
        .find(|(_, effect)| effect.path.as_deref() == Some(path));
    let Some(effect) = found.and_then(|(_, effect)| effect.read.as_ref().ok().cloned()) else {
        return;
    };
    state.files.live.enable = None;
    state.history.close();
    let name = effect.name.clone();
    let edit = match replaces.filter(|old| state.session.preset().stack.get(&old.name).is_some()) {
        Some(old) => Edit::Rebind(old, effect),
        None => Edit::Enable(effect),
    };
    match state.session.edit(edit) {
        Ok(()) => app.reveal(name),
        Err(error) => state.notify(Level::Error, error),
    }
}

/// Reads an effect file that was given to the page, and enables the effect.
#[cfg(target_arch = "wasm32")]
pub fn add_effect_file(app: &mut App, path: &Path) {
    let with_file = |catalog: &Catalog| {
        let mut read = catalog.clone();
        read.add_file(path);
        read
    };
    let (shared, open) = (
        with_file(&app.state.files.folders.effects),
        with_file(&app.state.session.preset_file.effects),
    );
    let faults = open
        .custom()
        .filter(|(_, effect)| effect.path.as_deref() == Some(path))
        .filter_map(|(name, effect)| Some((name.to_owned(), effect.read.clone().err()?)));
    let effects = Effects {
        faults: faults.collect(),
        shared: shared.or_last_good(&app.state.files.folders.effects),
        open: open.or_last_good(&app.state.session.preset_file.effects),
    };
    for (_, error) in &effects.faults {
        app.notify(Level::Error, error.to_string());
    }
    app.state.files.live.enable = effects.faults.is_empty().then(|| Waiting {
        path: path.to_owned(),
        replaces: None,
    });
    effects_changed(app, effects);
}

/// Adds the folder of an effect file to those that are watched, and enables the effect.
#[cfg(not(target_arch = "wasm32"))]
pub fn add_effect_file(app: &mut App, path: &Path) {
    let Ok(path) = std::path::absolute(path) else {
        return;
    };
    if !path.is_file() {
        return app.notify(
            Level::Error,
            format!("{}: there is no such file", path.display()),
        );
    }
    let watched = app.state.files.live.watcher.targets();
    let folders = watched
        .effect_folders
        .iter()
        .cloned()
        .chain(watched.preset_effects());
    // A folder that is watched already may be written in another way.
    let known = folders
        .into_iter()
        .find(|folder| std::path::absolute(folder).ok().as_deref() == path.parent());
    let folder = known
        .clone()
        .or_else(|| path.parent().map(Path::to_owned))
        .unwrap_or_default();
    if known.is_none() {
        app.state.files.folders.effect_folders.push(folder.clone());
    }
    app.state.files.live.enable = path.file_name().map(|name| Waiting {
        path: folder.join(name),
        replaces: None,
    });
}

fn preset_changed(app: &mut App, path: &PathBuf, read: Result<Box<PresetFile>, String>) {
    if app.state.session.preset_file.path.as_ref() != Some(path) {
        return;
    }
    match read {
        Err(error) => fault(&mut app.state, Subject::Preset, error),
        Ok(theirs) => {
            app.state.files.live.clear_fault(&Subject::Preset);
            if theirs.has_text_of(&app.state.session.preset_file) {
                return; // It was saved here.
            }
            if app.state.session.is_modified() {
                app.panels.dialogs.ask_changed(theirs, None);
            } else {
                offer_preset(app, theirs);
            }
        }
    }
}

/// Makes the open preset what its file has now; asks first if that brings code that has not been
/// allowed.
pub fn offer_preset(app: &mut App, theirs: Box<PresetFile>) {
    if app
        .state
        .files
        .trust
        .allows(&theirs, &app.state.files.folders.effects)
    {
        take_preset(app, *theirs);
    } else {
        app.panels.dialogs.ask_code(theirs, CodeUse::Reload);
    }
}

/// Makes the open preset what it and `theirs`, its file as it is now, have both, as a separate undo
/// step.
pub fn merge_preset(state: &mut State, theirs: PresetFile) {
    state.observe(false);
    state.history.close();
    let title = theirs.title().to_owned();
    let merged = preset_file::merge(
        &state.session.as_filed().preset,
        state.session.preset(),
        &theirs.preset,
    );
    let mut theirs = theirs;
    theirs.effects = theirs.effects.joined(&state.session.preset_file.effects);
    state.session.reload(theirs);
    *state.session.preset_mut() = merged.preset;
    state.observe(false);
    state.history.close();
    let kept = if merged.conflicts.is_empty() {
        String::new()
    } else {
        format!(
            "; both had changed {}, which keep your values",
            merged.conflicts.join(", ")
        )
    };
    state.notify(
        Level::Info,
        format!("Merged your changes of {title} with those of its file{kept}"),
    );
}

/// Makes the open preset what its file has now, as a separate undo step.
pub fn take_preset(app: &mut App, mut theirs: PresetFile) {
    app.state.observe(false);
    app.state.history.close();
    for remark in theirs.remarks() {
        app.state.log.add(Level::Warning, remark);
    }
    let (id, title) = (theirs.id.clone(), theirs.title().to_owned());
    theirs.effects = theirs
        .effects
        .joined(&app.state.session.preset_file.effects);
    app.state.session.reload(theirs);
    app.state.observe(false);
    app.state.history.close();
    app.panels.browser.refresh(&app.state.files.folders, &id);
    app.notify(Level::Info, format!("{title} was reloaded"));
    recheck_golden(&mut app.state);
}

fn model_changed(state: &mut State, path: &Path) {
    let targets = state.files.live.watcher.targets();
    if ![&targets.model, &targets.surroundings].contains(&&Some(path.to_owned())) {
        return;
    }
    let key = SceneKey::of(&state.session.preset_file);
    state.files.opening.forget_models();
    let work = state.session.scenes.reload(&key);
    state.jobs.load_scene(key, work);
}

/// Notes the outcome of loading a model again. Returns false if it was loaded for the first time.
pub fn model_reloaded(state: &mut State, key: &SceneKey, outcome: Result<(), &str>) -> bool {
    let is_again = state.session.scenes.shown_for(key).is_some();
    match outcome {
        Ok(()) => {
            state.files.live.clear_fault(&Subject::Model);
            if is_again {
                state.notify(Level::Info, "The model was reloaded");
                recheck_golden(state);
            }
        }
        Err(error) if is_again => fault(state, Subject::Model, error.to_owned()),
        Err(_) => {}
    }
    is_again
}

fn shaders_changed(app: &mut App) {
    let Some(inputs) = app.state.picture.screen.requested().cloned() else {
        return use_shaders(app);
    };
    let number = app.state.files.live.request();
    app.state.files.live.compiling_shaders = Some(number);
    let gpu = app.state.picture.screen.gpu.clone();
    let then = move |app: &mut App, outcome| shaders_compiled(app, number, outcome);
    app.state.jobs.compile(gpu, inputs, then);
}

fn use_shaders(app: &mut App) {
    app.state.files.live.clear_fault(&Subject::Shaders);
    app.state.picture.screen.reload_shaders();
    app.state.picture.tier_times.forget();
    app.panels.viewport.compare.reload_shaders();
    app.notify(Level::Info, "The shaders were reloaded");
}
