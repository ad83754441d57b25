//! The left panel: presets with thumbnails, and scenes with their parameters.

mod entry;
mod on_model;
mod scenes;

use std::collections::{HashMap, VecDeque};

use eframe::egui::{self, RichText, Ui, vec2};

use self::on_model::OnModel;
use crate::{
    app::{
        command::{Command, Commands, FileCommand, Manner},
        log::Level,
        panel::Panel,
        scene_loader::SceneKey,
        state::State,
        theme,
    },
    preset_file::{self, Folders, GalleryEntry, PresetFile},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tab {
    Presets,
    Scene,
}

/// The left panel: presets with thumbnails, and scenes with their parameters.
pub struct PresetBrowser {
    entries: Vec<GalleryEntry>,
    /// Thumbnails by preset id.
    thumbnails: HashMap<String, egui::TextureHandle>,
    /// Ids of the presets that wait for a thumbnail; one is drawn at a time.
    queue: VecDeque<String>,
    drawing: Option<String>,
    /// Thumbnails on the user's own scene.
    on_model: OnModel,
    tab: Tab,
}

impl PresetBrowser {
    /// The presets of `folders`, of the user's folder, and the built-in ones.
    pub fn new(folders: &Folders) -> Self {
        let entries = preset_file::gallery(folders);
        // The code of a preset runs only after the user has allowed it, so a preset that brings code has no thumbnail.
        let has_no_code = |entry: &&GalleryEntry| entry.preset_file.as_ref().is_ok_and(|found| found.brought_effects.is_empty());
        let queue = entries.iter().filter(has_no_code).map(|entry| entry.id.clone()).collect();
        Self { entries, queue, thumbnails: HashMap::new(), drawing: None, on_model: OnModel::default(), tab: Tab::Presets }
    }

    /// Is the scene shown, rather than the presets?
    pub fn shows_scene(&self) -> bool {
        self.tab == Tab::Scene
    }

    /// Shows the scene, or the presets.
    pub fn show_scene(&mut self, shows_scene: bool) {
        self.tab = if shows_scene { Tab::Scene } else { Tab::Presets };
    }

    /// True while thumbnails are still to come.
    pub fn is_busy(&self) -> bool {
        self.drawing.is_some() || !self.queue.is_empty() || self.on_model.is_busy()
    }

    /// Reads the folders again and redraws the thumbnail of the preset `changed`.
    pub fn refresh(&mut self, folders: &Folders, changed: &str) {
        self.entries = preset_file::gallery(folders);
        self.on_model.forget(changed);
        let is_there =
            |entry: &GalleryEntry| entry.id == changed && entry.preset_file.as_ref().is_ok_and(|found| found.brought_effects.is_empty());
        if self.entries.iter().any(is_there) && !self.queue.iter().any(|id| id == changed) {
            self.queue.push_back(changed.to_owned());
        }
    }

    /// The preset whose thumbnail is to be drawn next; none while one is being drawn.
    pub fn next_thumbnail(&mut self) -> Option<PresetFile> {
        if self.drawing.is_some() {
            return None;
        }
        let id = self.queue.pop_front()?;
        let found = self.entries.iter().find(|entry| entry.id == id)?.preset_file.as_ref().ok()?.clone();
        self.drawing = Some(id);
        Some(found)
    }

    /// The preset whose thumbnail is to be drawn next on the scene of `key`, the user's own; none while another is being drawn.
    pub fn next_on_model(&mut self, key: &SceneKey) -> Option<PresetFile> {
        if self.drawing.is_some() {
            return None;
        }
        let id = self.on_model.next(key)?;
        let found = self.entries.iter().find(|entry| entry.id == id).and_then(|entry| entry.preset_file.as_ref().ok().cloned());
        if found.is_none() {
            self.on_model.forget(&id);
        }
        found
    }

    /// Takes a thumbnail on the user's own scene; none if it could not be drawn.
    pub fn on_model_arrived(&mut self, ctx: &egui::Context, key: SceneKey, id: String, image: Option<egui::ColorImage>) {
        self.on_model.arrived(ctx, key, id, image);
    }

    /// The picture of a preset: on the user's own scene if the switch says so and it has been drawn.
    fn picture(&self, entry: &GalleryEntry, state: &State, is_in_view: bool) -> Option<&egui::TextureHandle> {
        let open = &state.session.preset_file;
        // The code of a preset runs only after the user has allowed it.
        let has_no_code = entry.preset_file.as_ref().is_ok_and(|found| found.brought_effects.is_empty());
        let is_on = self.on_model.is_on && open.has_own_scene() && has_no_code;
        let on_model = is_on.then(|| self.on_model.picture(&SceneKey::of(open), &entry.id, is_in_view)).flatten();
        on_model.or_else(|| self.thumbnails.get(&entry.id))
    }

    /// The switch for thumbnails on the user's own scene.
    fn on_model_ui(&mut self, ui: &mut Ui, state: &State) {
        let open = &state.session.preset_file;
        if open.has_own_scene() {
            let text = format!("Thumbnails on {}", open.scene_name());
            ui.checkbox(&mut self.on_model.is_on, text).on_hover_text("Show every preset on this model, drawn as it comes into view");
        }
    }

    /// Takes a thumbnail that was drawn; none if the scene is too large or broken.
    pub fn thumbnail_arrived(&mut self, ctx: &egui::Context, id: String, image: Option<egui::ColorImage>) {
        if self.drawing.as_ref() == Some(&id) {
            self.drawing = None;
        }
        if let Some(image) = image {
            let texture = ctx.load_texture(format!("preset {id}"), image, egui::TextureOptions::LINEAR);
            self.thumbnails.insert(id, texture);
        }
    }

    /// The preset `step` entries after the one called `id`, wrapping round; the first if `id` is not in the gallery.
    pub fn neighbor(&self, id: &str, step: isize) -> Option<&PresetFile> {
        let good: Vec<&GalleryEntry> = self.entries.iter().filter(|entry| entry.preset_file.is_ok()).collect();
        let here = good.iter().position(|entry| entry.id == id);
        let there = here.map_or(0, |here| (here as isize + step).rem_euclid(good.len() as isize) as usize);
        good.get(there)?.preset_file.as_ref().ok()
    }

    fn presets_ui(&self, ui: &mut Ui, state: &State, commands: &Commands) {
        if self.entries.is_empty() {
            ui.label(theme::weak("No presets found. Build one on the right and save it with Ctrl+S."));
        }
        let open = &state.session.preset_file;
        self.on_model.begin_frame();
        for entry in &self.entries {
            let is_open = open.is_look_of(&entry.id, entry.path.as_deref());
            let is_modified = is_open && state.session.is_modified();
            let is_in_view = ui.is_rect_visible(entry::row_rect(ui));
            let response = entry::entry_ui(ui, entry, self.picture(entry, state, is_in_view), is_open, is_modified);
            if let Some(manner) = chosen_manner(&response) {
                commands.send(match &entry.preset_file {
                    Ok(found) => Command::File(FileCommand::OpenPreset(Box::new(found.clone()), manner)),
                    Err(error) => Command::Notify(Level::Error, error.to_string()),
                });
            }
        }
    }
}

/// How the user opens a preset: by a click on the user's own scene, by a click with Shift or Alt or by the menu with the preset's.
fn chosen_manner(response: &egui::Response) -> Option<Manner> {
    let mut is_in_menu = false;
    response.context_menu(|ui| {
        if ui.button("Open with its scene").clicked() {
            is_in_menu = true;
            ui.close();
        }
    });
    let with_scene = response.ctx.input(|i| i.modifiers.shift || i.modifiers.alt);
    match (is_in_menu, response.clicked()) {
        (true, _) => Some(Manner::WithScene),
        (_, true) => Some(if with_scene { Manner::WithScene } else { Manner::Look }),
        _ => None,
    }
}

impl Panel for PresetBrowser {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (tab, text) in [(Tab::Presets, "Presets"), (Tab::Scene, "Scene")] {
                let button = egui::Button::selectable(self.tab == tab, RichText::new(text).strong()).min_size(vec2(72.0, theme::ROW));
                if ui.add(button).clicked() {
                    self.tab = tab;
                }
            }
        });
        ui.add_space(theme::HALF);
        if self.tab == Tab::Presets {
            self.on_model_ui(ui, state);
        }
        egui::ScrollArea::vertical().id_salt(self.tab as u8).auto_shrink(false).show(ui, |ui| match self.tab {
            Tab::Presets => self.presets_ui(ui, state, commands),
            Tab::Scene => scenes::scenes_ui(ui, state, commands),
        });
    }
}
