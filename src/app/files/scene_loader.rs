//! Scene loader: the scene that is shown, the one that is loading, and recent ones that are kept in
//! memory.

use std::{collections::VecDeque, path::PathBuf, sync::Arc};

use crate::{
    preset::SceneSource,
    preset_file::PresetFile,
    scene::{Bounds, Ground, Scene, UpAxis, memory::MemoryBudget, parts::ShownParts},
    work::{Progress, Work},
};

/// Identifies a scene: its source, with the path of a model as it is read, the parts that are shown,
/// the room round it, the ground under it, and the picture of what surrounds it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneKey {
    pub source: SceneSource,
    pub parts: ShownParts,
    /// Width of the room over that of the scene; 0 for none.
    pub room: f64,
    pub ground: Option<Ground>,
    pub surroundings: String,
    /// The preset beside which that picture lies; none without one.
    pub beside: Option<PathBuf>,
}

impl SceneKey {
    pub fn of(preset_file: &PresetFile) -> Self {
        Self {
            source: preset_file.scene_source(),
            parts: preset_file.preset.parts.clone(),
            room: preset_file.preset.room,
            ground: preset_file.preset.ground,
            surroundings: preset_file.preset.surroundings.clone(),
            beside: preset_file
                .surroundings_path()
                .and(preset_file.path.clone()),
        }
    }
}

/// Number of recent scenes that are kept in memory, as far as the memory budget has room for them.
const MAX_RECENT: usize = 4;

/// The scene that is shown, the one that is loading, and recent ones that are kept in memory.
#[derive(Default)]
pub struct SceneLoader {
    shown: Option<(SceneKey, Arc<Scene>)>,
    /// The scene that is loading, and the work that loads it.
    loading: Option<(SceneKey, Arc<Work>)>,
    failed: Option<SceneKey>,
    recent: VecDeque<(SceneKey, Arc<Scene>)>,
}

impl SceneLoader {
    pub fn shown(&self) -> Option<&Arc<Scene>> {
        self.shown.as_ref().map(|(_, scene)| scene)
    }

    /// The shown scene, if it is the one of `key`.
    pub fn shown_for(&self, key: &SceneKey) -> Option<&Arc<Scene>> {
        self.shown
            .as_ref()
            .filter(|(shown, _)| shown == key)
            .map(|(_, scene)| scene)
    }

    pub fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// How far loading has come; none before bytes are read, and where the scene is built.
    pub fn progress(&self) -> Option<Progress> {
        self.loading.as_ref()?.1.progress()
    }

    /// Ends loading, and returns the scene that was loading. Whoever waits for it must be told.
    pub fn cancel(&mut self) -> Option<SceneKey> {
        let (key, work) = self.loading.take()?;
        work.cancel();
        Some(key)
    }

    /// True if the scene of the preset cannot be loaded.
    pub fn has_failed(&self) -> bool {
        self.failed.is_some()
    }

    /// Shows the scene of `key` if it is in memory. Otherwise returns the work of loading it the
    /// first time, which the caller starts.
    pub fn request(&mut self, key: &SceneKey) -> Option<Arc<Work>> {
        if self.shown_for(key).is_some() {
            self.failed = None;
        } else if let Some(found) = self.recent.iter().find(|(recent, _)| recent == key) {
            self.shown = Some(found.clone());
            self.failed = None;
        } else if self
            .loading
            .as_ref()
            .is_none_or(|(loading, _)| loading != key)
            && self.failed.as_ref() != Some(key)
        {
            return Some(self.begin(key));
        }
        None
    }

    fn begin(&mut self, key: &SceneKey) -> Arc<Work> {
        let work = Arc::new(Work::default());
        self.loading = Some((key.clone(), work.clone()));
        work
    }

    /// True if the scene of `key` is in memory.
    pub fn has(&self, key: &SceneKey) -> bool {
        self.get(key).is_some()
    }

    /// The scene of `key`, if it is in memory.
    pub fn get(&self, key: &SceneKey) -> Option<&Arc<Scene>> {
        let recent = || {
            self.recent
                .iter()
                .find(|(recent, _)| recent == key)
                .map(|(_, scene)| scene)
        };
        self.shown_for(key).or_else(recent)
    }

    /// The box of a scene that is in memory, without ground and room.
    pub fn bounds(&self, (source, up): &(SceneSource, UpAxis)) -> Option<Bounds> {
        let mut known = self.shown.iter().chain(&self.recent);
        known
            .find(|(key, _)| key.source == *source && key.parts.up == *up)
            .map(|(_, scene)| scene.subject_bounds(None))
    }

    /// Was a note told with the same source, as it was loaded for another look?
    pub fn has_told(&self, key: &SceneKey, note: &String) -> bool {
        let mut known = self.shown.iter().chain(&self.recent);
        known.any(|(other, scene)| {
            other != key && other.source == key.source && scene.notes.contains(note)
        })
    }

    /// True if the scene of `key` is shown or cannot be loaded.
    pub fn is_settled(&self, key: &SceneKey) -> bool {
        self.shown_for(key).is_some() || self.failed.as_ref() == Some(key)
    }

    /// Forgets that the scene of `key`, which no preset shows, is loading.
    pub fn abandon(&mut self, key: &SceneKey) {
        self.loading.take_if(|(loading, _)| loading == key);
    }

    /// Loads the scene of `key` again, since its file has changed; the caller starts the work. What
    /// is shown stays until it has loaded.
    pub fn reload(&mut self, key: &SceneKey) -> Arc<Work> {
        self.recent.retain(|(recent, _)| recent != key);
        self.failed = None;
        self.begin(key)
    }

    /// Takes a scene that was loaded; none if that failed.
    pub fn take_scene(&mut self, key: SceneKey, scene: Option<Arc<Scene>>) {
        self.abandon(&key);
        match scene {
            Some(scene) => {
                if let Some((_, shown)) = self.shown.as_mut().filter(|(shown, _)| *shown == key) {
                    *shown = scene.clone();
                }
                self.recent.push_front((key, scene));
                self.forget(MemoryBudget::of_process());
            }
            None => self.failed = Some(key),
        }
    }
}

impl SceneLoader {
    /// Forgets the oldest scenes that are too many, or too large together. The newest stays.
    fn forget(&mut self, budget: MemoryBudget) {
        let mut bytes = 0;
        let mut fits = |(_, scene): &(SceneKey, Arc<Scene>)| {
            bytes += scene.byte_count();
            bytes <= budget.decoded()
        };
        let kept = self
            .recent
            .iter()
            .take(MAX_RECENT)
            .take_while(|recent| fits(recent))
            .count();
        self.recent.truncate(kept.max(1));
    }
}

/// What a preset calls a clip: its name, or its index where an earlier clip has the same name.
pub fn clip_id(scene: &Scene, index: usize) -> String {
    let name = &scene.rig.clips[index].name;
    if scene.rig.clip(name) == Some(index) {
        name.clone()
    } else {
        format!("#{index}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(query: &str) -> SceneKey {
        SceneKey {
            source: SceneSource::Builtin(query.into()),
            parts: ShownParts::default(),
            room: 0.0,
            ground: None,
            surroundings: String::new(),
            beside: None,
        }
    }

    #[test]
    fn recent_scenes_stay_within_the_memory_budget() {
        let mib = 1 << 20;
        let scene = |mib_of_vertices: usize| {
            Some(Arc::new(Scene {
                vertex_bytes: vec![0; mib_of_vertices * mib],
                ..Scene::default()
            }))
        };
        let mut loader = SceneLoader::default();
        for (name, size) in [("a", 200), ("b", 0), ("c", 200), ("d", 200)] {
            loader.take_scene(key(name), scene(size));
        }
        loader.forget(MemoryBudget::LEAST);
        assert_eq!(
            ["a", "b", "c", "d"].map(|name| loader.has(&key(name))),
            [false, true, true, true],
            "512 MiB of scenes are kept"
        );
        loader.take_scene(key("e"), scene(600));
        loader.forget(MemoryBudget::LEAST);
        assert_eq!(
            ["d", "e"].map(|name| loader.has(&key(name))),
            [false, true],
            "the newest is kept however large it is"
        );
    }

    #[test]
    fn a_scene_that_is_loaded_again_for_a_look_tells_its_notes_once() {
        let (plain, mut in_room, note) = (key("a"), key("a"), "it is truncated".to_owned());
        in_room.room = 2.0;
        let mut loader = SceneLoader::default();
        let mut scene = Scene::default();
        scene.notes.push(note.clone());
        loader.take_scene(plain.clone(), Some(Arc::new(scene)));
        assert_eq!(
            [plain, in_room, key("b")].map(|key| loader.has_told(&key, &note)),
            [false, true, false]
        );
    }

    #[test]
    fn canceled_loading_ends_its_work_and_is_not_begun_again() {
        let mut loader = SceneLoader::default();
        let work = loader.request(&key("a")).expect("it is not in memory");
        assert!(loader.is_loading() && loader.request(&key("a")).is_none());
        assert_eq!(loader.cancel(), Some(key("a")));
        assert!(work.is_canceled() && !loader.is_loading() && loader.cancel().is_none());
        loader.take_scene(key("a"), None);
        assert!(loader.has_failed() && loader.request(&key("a")).is_none());
        assert!(
            !loader.reload(&key("a")).is_canceled(),
            "opening it again loads it"
        );
    }
}
