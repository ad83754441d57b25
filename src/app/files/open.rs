//! Opening presets and models. Their scenes are read first: what is shown stays until they have
//! loaded, and for good if they cannot be.
//!
//! While the scene is the user's own (a model, or a built-in scene that was chosen), a preset lands
//! on it: its look takes the place of the one that is shown, with lengths fitted from the box of
//! its own scene to that of the user's.

use std::{path::Path, sync::Arc};

use super::{
    command::{CodeUse, Manner},
    opening::{Opening, Request},
    reload::model_reloaded,
    scene_loader::SceneKey,
};
use crate::{
    app::{
        App,
        editing::history::History,
        settings::last_session::Restored,
        shell::{log::Level, state::State},
    },
    preset::{Output, SceneSource},
    preset_file::{self, PresetFile},
    scene::{Bounds, Scene, UpAxis},
};

/// How what a person names is opened. A picture holds a whole state, so it brings its scene.
pub fn manner_of(what: &str, opened: &PresetFile) -> Manner {
    let is_picture = Path::new(what)
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    match opened.chose_scene {
        true => Manner::Scene,
        false if is_picture => Manner::WithScene,
        false => Manner::Look,
    }
}

/// Makes `opened` the open preset, as a separate undo step.
fn open_preset(app: &mut App, mut opened: PresetFile) {
    app.state.history.close();
    for remark in opened.remarks() {
        app.state.log.add(Level::Warning, remark);
    }
    opened.effects = opened.effects.joined(&app.state.files.folders.effects);
    app.state.settings.recents.add_opened(&opened);
    app.state.session.open(opened);
    app.panels.timeline = Default::default();
    app.state.observe(false);
    app.state.history.close();
}

/// Opens a preset or model, after its scene has been read, and says `said` when it is shown.
pub fn begin(app: &mut App, mut opened: PresetFile, manner: Manner, said: String) {
    _ = app.state.settings.up_axes.give(&mut opened);
    let open = &app.state.session.preset_file;
    // A preset of the same model comes with its camera and clip.
    let is_of_this_model = matches!(opened.preset.scene, SceneSource::File(_))
        && opened.scene_source() == open.scene_source();
    // Of a model that may not be read only the look is used.
    let has_no_scene = opened.outside_model.is_some();
    let lands =
        manner != Manner::Look || has_no_scene || (open.has_own_scene() && !is_of_this_model);
    let manner = if lands { manner } else { Manner::WithScene };
    app.state.files.opening.waiting = Some(Request {
        opened: opened.into(),
        manner,
        said,
        loading: None,
    });
    go_on(app);
}

/// Opens what was open in the last session, with its unsaved edits. Code that it brings runs only
/// if the user has allowed it.
pub fn restore(app: &mut App, Restored { preset_file, filed }: Restored) {
    let said = format!("Opened {} as it was", preset_file.title());
    if !app
        .state
        .files
        .trust
        .allows(&preset_file, &app.state.files.folders.effects)
    {
        return app
            .panels
            .dialogs
            .ask_code(preset_file.into(), CodeUse::Open(Manner::WithScene, said));
    }
    let key = SceneKey::of(&preset_file);
    open_preset(app, filed);
    app.state.session.preset_file.preset = preset_file.preset;
    app.state.files.opening.waiting = None;
    app.state.files.opening.announced = Some((key, said));
}

/// Opens what waits, if everything that it needs has been read, or starts reading that.
fn go_on(app: &mut App) {
    let Some(mut request) = app.state.files.opening.waiting.take() else {
        return;
    };
    let key = SceneKey::of(&request.opened);
    let is_new_file = request.manner != Manner::Look
        && matches!(key.source, SceneSource::File(_))
        && !app.state.session.scenes.has(&key);
    if is_new_file {
        let work = app.state.session.scenes.reload(&key);
        app.state.jobs.load_scene(key.clone(), work);
        request.loading = Some(key);
        app.state.files.opening.waiting = Some(request);
        return;
    }
    if request.manner == Manner::Scene
        && matches!(key.source, SceneSource::File(_))
        && !app.state.session.has_chosen_look()
    {
        return finish_plain(app, *request.opened, request.said);
    }
    let (look, own) = match request.manner {
        Manner::WithScene => {
            app.state.session.chose_look = true;
            return finish(app, *request.opened, request.said);
        }
        Manner::Look => (&*request.opened, &app.state.session.preset_file),
        Manner::Scene => (&app.state.session.preset_file, &*request.opened),
    };
    let sources = [look, own].map(|of| (of.scene_source(), of.preset.parts.up));
    let mut boxes = [None; 2];
    if look.needs_fit() && look.outside_model.is_none() {
        for (source, found) in sources.iter().zip(&mut boxes) {
            *found = bounds(&app.state, source);
        }
        if boxes.iter().any(Option::is_none) {
            for source in sources
                .into_iter()
                .zip(boxes)
                .filter(|(_, found)| found.is_none())
                .map(|(source, _)| source)
            {
                if app.state.files.opening.start_measuring(&source) {
                    app.state.jobs.measure_scene(source);
                }
            }
            app.state.files.opening.waiting = Some(request);
            return;
        }
    }
    let [from, to] = boxes.map(Option::flatten);
    land(app, request, from.zip(to));
}

/// The box of a scene: none if it is not known, none in it if the scene cannot be loaded.
fn bounds(state: &State, source: &(SceneSource, UpAxis)) -> Option<Option<Bounds>> {
    state
        .session
        .scenes
        .bounds(source)
        .map(Some)
        .or_else(|| state.files.opening.bounds(source))
}

/// Puts a look on a scene: that of the request on the open one, or the open one on that of the
/// request.
fn land(app: &mut App, request: Request, boxes: Option<(Bounds, Bounds)>) {
    let Request {
        opened,
        manner,
        said,
        ..
    } = request;
    let open = &app.state.session.preset_file;
    let (looks, owner) = match manner {
        Manner::Look => (&*opened, open),
        _ => (open, &*opened),
    };
    let own = app.state.session.scenes.get(&SceneKey::of(owner)).cloned();
    let fit = boxes.and_then(|(from, to)| looks.fit_to(owner, [&from, &to], own.as_deref()));
    let mut landed = if manner == Manner::Look {
        // A model that cannot move misses no clip.
        let mut landed = match own.as_ref().is_some_and(|scene| scene.rig.clips.is_empty()) {
            true => without_clip(&opened).landed_on(open, fit.as_ref()),
            false => opened.landed_on(open, fit.as_ref()),
        };
        landed
            .warnings
            .splice(0..0, opened.warnings.iter().cloned());
        landed
    } else {
        // The frame of the picture stays, and the camera shows the whole model.
        let mut model = (*opened).clone();
        model.preset.output = Output {
            size: open.preset.output.size,
            ..model.preset.output
        };
        // The clip belongs to the scene that goes.
        without_clip(open).landed_on(&model, fit.as_ref())
    };
    // What was changed in a look stays a change of it.
    let filed = app.state.session.as_filed();
    let unchanged = (manner == Manner::Scene && app.state.session.is_modified())
        .then(|| without_clip(filed).landed_on(&landed, fit.as_ref()));
    if let Some(scene) = &own {
        landed.map_missing_parts(scene);
        landed.settle(scene, true);
    }
    if looks.needs_fit() && fit.is_none() {
        let text = format!(
            "{}: the scene of the preset cannot be measured or may not be read, so its lengths stay as they are",
            landed.title()
        );
        landed.warnings.push(text);
    }
    let key = SceneKey::of(&landed);
    if let Some(scene) = app.state.session.scenes.get(&key) {
        let title = landed.title().to_owned();
        landed.warnings.extend(
            landed
                .preset
                .missing_parts(scene)
                .into_iter()
                .map(|missing| format!("{title}: {missing}")),
        );
    }
    let said = match (manner, &landed.warnings[..]) {
        (_, []) if manner == Manner::Look => format!("Opened {}", landed.title()),
        (_, []) => said,
        (_, [warning]) => {
            let title = landed.title();
            format!(
                "Opened {title}; {}",
                warning
                    .strip_prefix(&format!("{title}: "))
                    .unwrap_or(warning)
            )
        }
        (_, warnings) => format!(
            "Opened {}; {} things were left out, see the log",
            landed.title(),
            warnings.len()
        ),
    };
    if manner == Manner::Look {
        app.state.session.chose_look = true;
        // The menu opens it with its scene.
        app.state.session.remember(*opened);
    }
    finish(app, landed, said);
    if let Some(unchanged) = unchanged {
        app.state.session.remember(unchanged);
    }
}

/// A look without the clip of its own scene.
fn without_clip(look: &PresetFile) -> PresetFile {
    let mut look = look.clone();
    look.preset.playback.clip.clear();
    look
}

/// Puts the plain look on the scene that is shown.
pub fn show_plain(app: &mut App) {
    app.state.files.opening.waiting = Some(Request {
        opened: preset_file::plain().clone().into(),
        manner: Manner::Look,
        said: String::new(),
        loading: None,
    });
    go_on(app);
}

/// Begins a preset of the scene that is shown, in the plain look.
pub fn begin_new(app: &mut App) {
    let open = &app.state.session.preset_file;
    let mut new = PresetFile::of_scene(&open.scene_name(), open.scene_source());
    new.preset.parts.up = open.preset.parts.up;
    if let Some(scene) = app.state.session.scene() {
        new.settle(scene, true);
    }
    let said = format!("A new preset of {}", new.title());
    finish_plain(app, new, said);
}

/// Opens a scene in the plain look. The frame of the picture stays.
fn finish_plain(app: &mut App, mut opened: PresetFile, said: String) {
    opened.preset.output.size = app.state.session.preset().output.size;
    finish(app, opened, said);
}

fn finish(app: &mut App, opened: PresetFile, said: String) {
    let key = SceneKey::of(&opened);
    open_preset(app, opened);
    app.state.files.opening.waiting = None;
    app.state.files.opening.announced = Some((key, said));
}

/// A scene has loaded (true) or cannot be: opens what waits for it. Returns true if something did.
fn scene_arrived(app: &mut App, key: &SceneKey, is_loaded: bool) -> bool {
    if app
        .state
        .files
        .opening
        .waiting
        .as_ref()
        .is_none_or(|request| request.loading.as_ref() != Some(key))
    {
        return false;
    }
    if is_loaded {
        go_on(app);
    } else {
        app.state.files.opening.waiting = None;
    }
    true
}

/// Stops loading a scene. What is shown stays; where nothing is, another scene must be chosen.
pub fn cancel_loading(app: &mut App) {
    let Some(key) = app.state.session.scenes.cancel() else {
        return;
    };
    if !scene_arrived(app, &key, false) && app.state.session.scenes.shown_for(&key).is_none() {
        app.state.session.scenes.take_scene(key, None);
    }
    app.notify(Level::Info, "Loading was stopped");
}

/// The box of a scene has been found, or cannot be: opens what waits for it.
pub fn take_bounds(app: &mut App, source: (SceneSource, UpAxis), bounds: Result<Bounds, String>) {
    if let Err(error) = &bounds {
        app.state.log.add(Level::Warning, error.clone());
    }
    app.state.files.opening.measured(source, bounds.ok());
    go_on(app);
}

/// Lets what waits for a scene, or was opened with it, take from it what it leaves open. Returns the
/// key of the scene from then on.
fn settle(state: &mut State, key: SceneKey, scene: &Scene) -> SceneKey {
    state.session.scenes.abandon(&key);
    let is_of = |file: &PresetFile| SceneKey::of(file) == key;
    if let Some(request) = &mut state.files.opening.waiting
        && request.loading.as_ref() == Some(&key)
        && is_of(&request.opened)
    {
        request.opened.settle(scene, true);
        let settled = SceneKey::of(&request.opened);
        request.loading = Some(settled.clone());
        return settled;
    }
    let session = &mut state.session;
    if !is_of(&session.preset_file) || session.is_modified() {
        return key;
    }
    session.preset_file.settle(scene, true);
    session.remember(session.preset_file.clone());
    if !state.history.can_undo() {
        state.history = History::new(session.undo_state());
    }
    SceneKey::of(&session.preset_file)
}

/// Takes a scene that has loaded, or why it cannot be.
pub fn take_scene(app: &mut App, key: SceneKey, loaded: Result<Arc<Scene>, String>) {
    match loaded {
        Ok(scene) => {
            let scenes = &app.state.session.scenes;
            for note in scene
                .notes
                .iter()
                .filter(|note| !scenes.has_told(&key, note))
            {
                let text = format!("{}: {note}", scene.name);
                app.state.log.add(Level::Warning, text);
            }
            model_reloaded(&mut app.state, &key, Ok(()));
            let key = settle(&mut app.state, key, &scene);
            app.state
                .session
                .scenes
                .take_scene(key.clone(), Some(scene));
            scene_arrived(app, &key, true);
        }
        Err(error) => {
            if scene_arrived(app, &key, false) {
                app.state.session.scenes.abandon(&key);
                return app.notify(Level::Error, error);
            }
            let is_again = model_reloaded(&mut app.state, &key, Err(&error));
            app.state.session.scenes.take_scene(key, None);
            if !is_again {
                app.notify(Level::Error, error);
            }
        }
    }
}

/// Says that a preset was opened, as soon as its scene is shown. Another preset that was opened
/// meanwhile, or a scene that cannot be shown, takes that back.
pub fn announce(state: &mut State) {
    let open = SceneKey::of(&state.session.preset_file);
    let Opening { announced, .. } = &mut state.files.opening;
    let Some((key, said)) =
        announced.take_if(|(key, _)| *key != open || state.session.scenes.is_settled(key))
    else {
        return;
    };
    let Some(scene) = state.session.scenes.shown_for(&key) else {
        return;
    };
    if key != open {
        return;
    }
    let told = match scene.notes.as_slice() {
        [] => return state.notify(Level::Info, said),
        [note] => format!("{said}; {note}"),
        [note, rest @ ..] => format!("{said}; {note}; the log has {} more", rest.len()),
    };
    // The log has the notes already.
    state.log.add(Level::Info, said);
    state.log.toast(Level::Warning, &told, state.now_s);
}
