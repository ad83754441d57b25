//! What is being opened: a preset that waits for its model, or for the boxes of scenes.

use super::{command::Manner, scene_loader::SceneKey};
use crate::{
    preset::SceneSource,
    preset_file::PresetFile,
    scene::{Bounds, UpAxis},
};

/// What was chosen and waits.
pub struct Request {
    pub opened: Box<PresetFile>,
    pub manner: Manner,
    /// What is said when it is shown.
    pub said: String,
    /// The scene that is loading for it.
    pub loading: Option<SceneKey>,
}

/// What is being opened.
#[derive(Default)]
pub struct Opening {
    pub waiting: Option<Request>,
    /// What is said when this scene is shown.
    pub announced: Option<(SceneKey, String)>,
    /// Boxes of scenes that are not in memory; none for a scene that cannot be loaded.
    boxes: Vec<((SceneSource, UpAxis), Option<Bounds>)>,
    /// Scenes whose boxes are being found.
    measuring: Vec<(SceneSource, UpAxis)>,
}

impl Opening {
    pub fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    /// The box of a scene, if it was found; none in it for a scene that cannot be loaded.
    pub fn bounds(&self, source: &(SceneSource, UpAxis)) -> Option<Option<Bounds>> {
        self.boxes
            .iter()
            .find(|(known, _)| known == source)
            .map(|(_, bounds)| *bounds)
    }

    /// Notes that the box of a scene is being found. Returns false if it is already.
    pub fn start_measuring(&mut self, source: &(SceneSource, UpAxis)) -> bool {
        let is_new = !self.measuring.contains(source);
        if is_new {
            self.measuring.push(source.clone());
        }
        is_new
    }

    /// Keeps the box of a scene.
    pub fn measured(&mut self, source: (SceneSource, UpAxis), bounds: Option<Bounds>) {
        self.measuring.retain(|other| *other != source);
        self.boxes.push((source, bounds));
    }

    /// Forgets the boxes of models, since a file has changed.
    pub fn forget_models(&mut self) {
        self.boxes
            .retain(|((source, _), _)| matches!(source, SceneSource::Builtin(_)));
    }
}
