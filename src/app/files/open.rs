//! Opening presets and models. Their scenes are read first: what is shown stays until they have
//! loaded, and for good if they cannot be.
//!
//! While the scene is the user's own (a model, or a built-in scene that was chosen), a preset lands
//! on it: its look takes the place of the one that is shown, with lengths fitted from the box of
//! its own scene to that of the user's.

use std::path::Path;

use super::{
    command::{CodeUse, Manner},
    opening::{Opening, Request},
    scene_loader::SceneKey,
};
use crate::{
    app::{
        panels::{Panels, timeline::Timeline},
        settings::last_session::Restored,
        shell::{log::Level, state::State},
    },
    preset::{Output, SceneSource},
    preset_file::PresetFile,
    scene::Bounds,
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
fn open_preset(state: &mut State, panels: &mut Panels, mut opened: PresetFile) {
    state.history.close();
    for remark in opened.remarks() {
        state.log.add(Level::Warning, remark);
    }
    opened.effects = opened.effects.joined(&state.files.folders.effects);
    state.settings.recents.add_opened(&opened);
    state.session.open(opened);
    panels.timeline = Timeline::default();
    state.observe(false);
    state.history.close();
}

/// Opens a preset or model, after its scene has been read, and says `said` when it is shown.
pub fn begin(
    state: &mut State,
    panels: &mut Panels,
    opened: PresetFile,
    manner: Manner,
    said: String,
) {
    let open = &state.session.preset_file;
    // A preset of the same model comes with its camera and clip.
    let is_of_this_model = matches!(opened.preset.scene, SceneSource::File(_))
        && opened.scene_source() == open.scene_source();
    // Of a model that may not be read only the look is used.
    let has_no_scene = opened.outside_model.is_some();
    let lands =
        manner != Manner::Look || has_no_scene || (open.has_own_scene() && !is_of_this_model);
    let manner = if lands { manner } else { Manner::WithScene };
    state.files.opening.waiting = Some(Request {
        opened: opened.into(),
        manner,
        said,
        loading: None,
    });
    go_on(state, panels);
}

/// Opens what was open in the last session, with its unsaved edits. Code that it brings runs only
/// if the user has allowed it.
pub fn restore(state: &mut State, panels: &mut Panels, Restored { preset_file, filed }: Restored) {
    let said = format!("Opened {} as it was", preset_file.title());
    if !state
        .files
        .trust
        .allows(&preset_file, &state.files.folders.effects)
    {
        return panels
            .dialogs
            .ask_code(preset_file.into(), CodeUse::Open(Manner::WithScene, said));
    }
    let key = SceneKey::of(&preset_file);
    open_preset(state, panels, filed);
    state.session.preset_file.preset = preset_file.preset;
    state.files.opening.waiting = None;
    state.files.opening.announced = Some((key, said));
}

/// Opens what waits, if everything that it needs has been read, or starts reading that.
fn go_on(state: &mut State, panels: &mut Panels) {
    let Some(mut request) = state.files.opening.waiting.take() else {
        return;
    };
    let key = SceneKey::of(&request.opened);
    let is_new_file = request.manner != Manner::Look
        && matches!(key.source, SceneSource::File(_))
        && !state.session.scenes.has(&key);
    if is_new_file {
        let work = state.session.scenes.reload(&key);
        state.jobs.load_scene(key.clone(), work);
        request.loading = Some(key);
        state.files.opening.waiting = Some(request);
        return;
    }
    let (look, own) = match request.manner {
        Manner::WithScene => return finish(state, panels, *request.opened, request.said),
        Manner::Look => (&*request.opened, &state.session.preset_file),
        Manner::Scene => (&state.session.preset_file, &*request.opened),
    };
    let sources = [look.scene_source(), own.scene_source()];
    let mut boxes = [None; 2];
    if look.needs_fit() && look.outside_model.is_none() {
        for (source, found) in sources.iter().zip(&mut boxes) {
            *found = bounds(state, source);
        }
        if boxes.iter().any(Option::is_none) {
            for source in sources
                .into_iter()
                .zip(boxes)
                .filter(|(_, found)| found.is_none())
                .map(|(source, _)| source)
            {
                if state.files.opening.start_measuring(&source) {
                    state.jobs.measure_scene(source);
                }
            }
            state.files.opening.waiting = Some(request);
            return;
        }
    }
    let [from, to] = boxes.map(Option::flatten);
    land(state, panels, request, from.zip(to));
}

/// The box of a scene: none if it is not known, none in it if the scene cannot be loaded.
fn bounds(state: &State, source: &SceneSource) -> Option<Option<Bounds>> {
    state
        .session
        .scenes
        .bounds(source)
        .map(Some)
        .or_else(|| state.files.opening.bounds(source))
}

/// Puts a look on a scene: that of the request on the open one, or the open one on that of the
/// request.
fn land(state: &mut State, panels: &mut Panels, request: Request, boxes: Option<(Bounds, Bounds)>) {
    let Request {
        opened,
        manner,
        said,
        ..
    } = request;
    let open = &state.session.preset_file;
    let (looks, owner) = match manner {
        Manner::Look => (&*opened, open),
        _ => (open, &*opened),
    };
    let own = state.session.scenes.get(&SceneKey::of(owner)).cloned();
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
    if let Some(scene) = &own {
        landed.map_missing_parts(scene);
    }
    if looks.needs_fit() && fit.is_none() {
        let text = format!(
            "{}: the scene of the preset cannot be measured or may not be read, so its lengths stay as they are",
            landed.title()
        );
        landed.warnings.push(text);
    }
    let key = SceneKey::of(&landed);
    if let Some(scene) = state.session.scenes.get(&key) {
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
        // The menu opens it with its scene.
        state.session.remember(*opened);
    }
    finish(state, panels, landed, said);
}

/// A look without the clip of its own scene.
fn without_clip(look: &PresetFile) -> PresetFile {
    let mut look = look.clone();
    look.preset.playback.clip.clear();
    look
}

fn finish(state: &mut State, panels: &mut Panels, opened: PresetFile, said: String) {
    let key = SceneKey::of(&opened);
    open_preset(state, panels, opened);
    state.files.opening.waiting = None;
    state.files.opening.announced = Some((key, said));
}

/// A scene has loaded (true) or cannot be: opens what waits for it. Returns true if something did.
pub fn scene_arrived(
    state: &mut State,
    panels: &mut Panels,
    key: &SceneKey,
    is_loaded: bool,
) -> bool {
    if state
        .files
        .opening
        .waiting
        .as_ref()
        .is_none_or(|request| request.loading.as_ref() != Some(key))
    {
        return false;
    }
    if is_loaded {
        go_on(state, panels);
    } else {
        state.files.opening.waiting = None;
    }
    true
}

/// Stops loading a scene. What is shown stays; where nothing is, another scene must be chosen.
pub fn cancel_loading(state: &mut State, panels: &mut Panels) {
    let Some(key) = state.session.scenes.cancel() else {
        return;
    };
    if !scene_arrived(state, panels, &key, false) && state.session.scenes.shown_for(&key).is_none()
    {
        state.session.scenes.arrived(key, None);
    }
    state.notify(Level::Info, "Loading was stopped");
}

/// The box of a scene has been found, or cannot be: opens what waits for it.
pub fn bounds_arrived(
    state: &mut State,
    panels: &mut Panels,
    source: SceneSource,
    bounds: Result<Bounds, String>,
) {
    if let Err(error) = &bounds {
        state.log.add(Level::Warning, error.clone());
    }
    state.files.opening.measured(source, bounds.ok());
    go_on(state, panels);
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
    if state.session.scenes.shown_for(&key).is_some() && key == open {
        state.notify(Level::Info, said);
    }
}
