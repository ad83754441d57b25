//! Opening a preset whose model must be read first: what is shown stays until the model has loaded, and for good if it cannot be.

use super::{
    command::CodeUse,
    log::Level,
    opening::Opening,
    panels::{Panels, timeline::Timeline},
    scene_loader::SceneKey,
    settings::last_session::Restored,
    state::State,
};
use crate::{preset::SceneSource, preset_file::PresetFile};

/// Makes `opened` the open preset, as a separate undo step.
fn open_preset(state: &mut State, panels: &mut Panels, mut opened: PresetFile) {
    state.history.close();
    for remark in opened.remarks() {
        state.log.add(Level::Warning, remark);
    }
    opened.effects = opened.effects.joined(&state.folders.effects);
    state.settings.recents.add_opened(&opened);
    state.session.open(opened);
    panels.timeline = Timeline::default();
    state.observe(false);
    state.history.close();
}

/// Opens a preset, after its model has loaded, and says `said` when its scene is shown.
pub fn begin(state: &mut State, panels: &mut Panels, opened: PresetFile, said: String) {
    let key = SceneKey::of(&opened);
    let is_file = matches!(opened.preset.scene, SceneSource::File(_));
    if is_file && !state.session.scenes.has(&key) {
        state.session.scenes.reload(&key);
        state.jobs.load_scene(key.clone());
        state.opening = Opening { waiting: Some((key, opened.into(), said)), announced: None };
        return;
    }
    open_preset(state, panels, opened);
    state.opening = Opening { waiting: None, announced: Some((key, said)) };
}

/// Opens what was open in the last session, with its unsaved edits. Code that it brings runs only if the user has allowed it.
pub fn restore(state: &mut State, panels: &mut Panels, Restored { preset_file, filed }: Restored) {
    let said = format!("Opened {} as it was", preset_file.title());
    if !state.trust.allows(&preset_file, &state.folders.effects) {
        return panels.dialogs.ask_code(preset_file.into(), CodeUse::Open(said));
    }
    let key = SceneKey::of(&preset_file);
    open_preset(state, panels, filed);
    state.session.preset_file.preset = preset_file.preset;
    state.opening = Opening { waiting: None, announced: Some((key, said)) };
}

/// A scene has loaded (true) or cannot be: opens the preset that waits for it. Returns true if one did.
pub fn scene_arrived(state: &mut State, panels: &mut Panels, key: &SceneKey, is_loaded: bool) -> bool {
    let Some((_, opened, said)) = state.opening.waiting.take_if(|(waiting, ..)| waiting == key) else { return false };
    if is_loaded {
        open_preset(state, panels, *opened);
        state.opening.announced = Some((key.clone(), said));
    }
    true
}

/// Says that a preset was opened, as soon as its scene is shown. Another preset that was opened meanwhile, or a scene that cannot be shown,
/// takes that back.
pub fn announce(state: &mut State) {
    let open = SceneKey::of(&state.session.preset_file);
    let Some((key, said)) = state.opening.announced.take_if(|(key, _)| *key != open || state.session.scenes.is_settled(key)) else {
        return;
    };
    if state.session.scenes.shown_for(&key).is_some() && key == open {
        state.notify(Level::Info, said);
    }
}
