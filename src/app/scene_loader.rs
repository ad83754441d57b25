//! Scene loader: the scene that is shown, the one that is loading, and recent ones that are kept in memory.

use std::{collections::VecDeque, sync::Arc};

use crate::{
    preset::SceneSource,
    preset_file::PresetFile,
    scene::{Bounds, Ground, Scene},
};

/// Identifies a scene: its source, with the path of a model as it is read, the room round it, and the ground under it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneKey {
    pub source: SceneSource,
    /// Width of the room over that of the scene; 0 for none.
    pub room: f64,
    pub ground: Option<Ground>,
}

impl SceneKey {
    pub fn of(preset_file: &PresetFile) -> Self {
        Self { source: preset_file.scene_source(), room: preset_file.preset.room, ground: preset_file.preset.ground }
    }
}

/// Number of recent scenes that are kept in memory.
const MAX_RECENT: usize = 4;

/// The scene that is shown, the one that is loading, and recent ones that are kept in memory.
#[derive(Default)]
pub struct SceneLoader {
    shown: Option<(SceneKey, Arc<Scene>)>,
    loading: Option<SceneKey>,
    failed: Option<SceneKey>,
    recent: VecDeque<(SceneKey, Arc<Scene>)>,
}

impl SceneLoader {
    pub fn shown(&self) -> Option<&Arc<Scene>> {
        self.shown.as_ref().map(|(_, scene)| scene)
    }

    /// The shown scene, if it is the one of `key`.
    pub fn shown_for(&self, key: &SceneKey) -> Option<&Arc<Scene>> {
        self.shown.as_ref().filter(|(shown, _)| shown == key).map(|(_, scene)| scene)
    }

    pub fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// True if the scene of the preset cannot be loaded.
    pub fn has_failed(&self) -> bool {
        self.failed.is_some()
    }

    /// Shows the scene of `key` if it is in memory. Otherwise returns true the first time: the scene must be loaded then.
    pub fn request(&mut self, key: &SceneKey) -> bool {
        if self.shown_for(key).is_some() {
            self.failed = None;
        } else if let Some(found) = self.recent.iter().find(|(recent, _)| recent == key) {
            self.shown = Some(found.clone());
            self.failed = None;
        } else if self.loading.as_ref() != Some(key) && self.failed.as_ref() != Some(key) {
            self.loading = Some(key.clone());
            return true;
        }
        false
    }

    /// True if the scene of `key` is in memory.
    pub fn has(&self, key: &SceneKey) -> bool {
        self.get(key).is_some()
    }

    /// The scene of `key`, if it is in memory.
    pub fn get(&self, key: &SceneKey) -> Option<&Arc<Scene>> {
        let recent = || self.recent.iter().find(|(recent, _)| recent == key).map(|(_, scene)| scene);
        self.shown_for(key).or_else(recent)
    }

    /// The box of a scene that is in memory, without ground and room.
    pub fn bounds(&self, source: &SceneSource) -> Option<Bounds> {
        let mut known = self.shown.iter().chain(&self.recent);
        known.find(|(key, _)| key.source == *source).map(|(_, scene)| scene.content_bounds())
    }

    /// True if the scene of `key` is shown or cannot be loaded.
    pub fn is_settled(&self, key: &SceneKey) -> bool {
        self.shown_for(key).is_some() || self.failed.as_ref() == Some(key)
    }

    /// Forgets that the scene of `key`, which no preset shows, is loading.
    pub fn abandon(&mut self, key: &SceneKey) {
        self.loading.take_if(|loading| loading == key);
    }

    /// Loads the scene of `key` again, since its file has changed; the caller starts that. What is shown stays until it has loaded.
    pub fn reload(&mut self, key: &SceneKey) {
        self.recent.retain(|(recent, _)| recent != key);
        self.failed = None;
        self.loading = Some(key.clone());
    }

    /// Takes a scene that was loaded; none if that failed.
    pub fn arrived(&mut self, key: SceneKey, scene: Option<Arc<Scene>>) {
        if self.loading.as_ref() == Some(&key) {
            self.loading = None;
        }
        match scene {
            Some(scene) => {
                if let Some((_, shown)) = self.shown.as_mut().filter(|(shown, _)| *shown == key) {
                    *shown = scene.clone();
                }
                self.recent.push_front((key, scene));
                self.recent.truncate(MAX_RECENT);
            }
            None => self.failed = Some(key),
        }
    }
}

/// What a preset calls a clip: its name, or its index where an earlier clip has the same name.
pub fn clip_id(scene: &Scene, index: usize) -> String {
    let name = &scene.rig.clips[index].name;
    if scene.rig.clip(name) == Some(index) { name.clone() } else { format!("#{index}") }
}
