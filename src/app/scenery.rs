//! Scenery: what the scene brings along besides its triangles: cameras to look through, and images.

use eframe::egui::{ComboBox, Ui};

use super::{
    App,
    inspector::{bytes_text, folder},
    theme,
};
use crate::{preset::Preset, scene::Scene};

impl App {
    /// The folder of the scene.
    pub(super) fn scene_ui(&mut self, ui: &mut Ui) {
        folder(ui, "Scene", true, |ui| {
            self.key_ui(ui, "scene.room");
            self.key_ui(ui, "scene.spin_deg_per_s");
            self.key_ui(ui, "output.background");
            if self.preset_file.preset.stack.0.iter().any(|enabled| enabled.effect.hooks.has_lines) {
                self.key_ui(ui, "scene.polyline");
            }
            let Some(scene) = self.scene_loader.shown.as_ref().map(|(_, scene)| scene.clone()) else { return };
            if !scene.cameras.is_empty() {
                cameras_ui(ui, &scene, &mut self.preset_file.preset);
            }
            if let Some(text) = images_text(&scene) {
                ui.horizontal(|ui| {
                    ui.set_min_height(theme::ROW);
                    ui.add_space(theme::GAP);
                    ui.label(theme::weak(text)).on_hover_ui(|ui| {
                        for image in &scene.images {
                            let [width, height] = image.size();
                            ui.label(format!("{}: {width} x {height}, {}", image.name, bytes_text(image.bytes())));
                        }
                    });
                });
            }
        });
    }
}

/// A menu of the scene's cameras. A pose of the preset itself comes before them.
fn cameras_ui(ui: &mut Ui, scene: &Scene, preset: &mut Preset) {
    let id = |place: usize| {
        let name = &scene.cameras[place].name;
        // Of cameras with one name, later ones go by their place.
        if scene.camera(name) == Some(place) { name.clone() } else { format!("#{place}") }
    };
    let chosen = preset.camera.is_none().then(|| scene.camera(&preset.scene_camera).unwrap_or(0));
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let shown = chosen.map_or_else(|| "own camera".to_owned(), |place| format!("camera {}", id(place)));
        let menu = ComboBox::from_id_salt("scene.camera").selected_text(shown).width(ui.available_width() - theme::GAP);
        let menu = menu.show_ui(ui, |ui| {
            for place in 0..scene.cameras.len() {
                if ui.selectable_label(chosen == Some(place), id(place)).clicked() {
                    // The first is looked through unasked.
                    preset.scene_camera = if place == 0 { String::new() } else { id(place) };
                    preset.camera = None;
                }
            }
        });
        menu.response.on_hover_text("The scene's own cameras; moving the picture leaves them").accessible_name("scene.camera");
    });
}

/// How many images there are, and what they take; none without any.
fn images_text(scene: &Scene) -> Option<String> {
    let bytes: u64 = scene.images.iter().map(crate::scene::texture::Image::bytes).sum();
    match scene.images.len() {
        0 => None,
        1 => Some(format!("1 image, {}", bytes_text(bytes))),
        count => Some(format!("{count} images, {}", bytes_text(bytes))),
    }
}
