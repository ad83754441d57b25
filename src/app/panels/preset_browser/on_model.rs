//! Thumbnails of presets on the user's own scene. They are drawn as their rows come into view, one at a time, and kept by scene and
//! preset.

use std::{cell::RefCell, collections::HashMap};

use eframe::egui;

use crate::app::scene_loader::SceneKey;

/// Most scenes whose thumbnails are kept.
const MAX_SCENES: usize = 4;

/// Thumbnails of presets on the user's own scene.
#[derive(Default)]
pub struct OnModel {
    /// The user wants them.
    pub is_on: bool,
    /// By scene, then by preset id; none where a preset cannot be drawn.
    pictures: Vec<(SceneKey, HashMap<String, Option<egui::TextureHandle>>)>,
    /// Ids of presets that are in view and have no picture yet, in the order of their rows.
    wanted: RefCell<Vec<String>>,
    drawing: Option<(SceneKey, String)>,
}

impl OnModel {
    /// True while pictures are still to come.
    pub fn is_busy(&self) -> bool {
        self.drawing.is_some() || !self.wanted.borrow().is_empty()
    }

    /// A new frame: what is not in view any more is not wanted any more.
    pub fn begin_frame(&self) {
        self.wanted.borrow_mut().clear();
    }

    /// The picture of a preset on the scene of `key`. One that is missing is drawn if `is_in_view`.
    pub fn picture(&self, key: &SceneKey, id: &str, is_in_view: bool) -> Option<&egui::TextureHandle> {
        let known = self.of_scene(key).and_then(|pictures| pictures.get(id));
        let is_drawing = self.drawing.as_ref().is_some_and(|(scene, preset)| scene == key && preset == id);
        if known.is_none() && is_in_view && !is_drawing {
            self.wanted.borrow_mut().push(id.to_owned());
        }
        known?.as_ref()
    }

    /// The preset that is drawn next on the scene of `key`; none while one is being drawn.
    pub fn next(&mut self, key: &SceneKey) -> Option<String> {
        if self.drawing.is_some() || self.wanted.borrow().is_empty() {
            return None;
        }
        let id = self.wanted.borrow_mut().remove(0);
        self.drawing = Some((key.clone(), id.clone()));
        Some(id)
    }

    /// Takes a picture that was drawn; none if the preset or the scene does not allow it.
    pub fn arrived(&mut self, ctx: &egui::Context, key: SceneKey, id: String, image: Option<egui::ColorImage>) {
        if self.drawing.take_if(|(scene, preset)| *scene == key && *preset == id).is_none() {
            return; // It was forgotten meanwhile.
        }
        let texture = image.map(|image| ctx.load_texture(format!("preset {id} on a model"), image, egui::TextureOptions::LINEAR));
        if self.of_scene(&key).is_none() {
            self.pictures.truncate(MAX_SCENES - 1);
            self.pictures.insert(0, (key.clone(), HashMap::new()));
        }
        if let Some((_, pictures)) = self.pictures.iter_mut().find(|(scene, _)| *scene == key) {
            pictures.insert(id, texture);
        }
    }

    /// Forgets every picture of a preset that has changed.
    pub fn forget(&mut self, id: &str) {
        self.pictures.iter_mut().for_each(|(_, pictures)| drop(pictures.remove(id)));
        self.drawing.take_if(|(_, preset)| preset == id);
    }

    fn of_scene(&self, key: &SceneKey) -> Option<&HashMap<String, Option<egui::TextureHandle>>> {
        self.pictures.iter().find(|(scene, _)| scene == key).map(|(_, pictures)| pictures)
    }
}
