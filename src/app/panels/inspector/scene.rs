//! The folder of the scene: its settings, its cameras and its images.

use eframe::egui::{ComboBox, Ui};

use super::rows::{folder, setting_ui};
use crate::{
    app::{
        command::{Commands, Edit},
        state::State,
        text, theme,
    },
    preset::Preset,
    scene::{Scene, texture::Image},
};

pub fn scene_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    folder(ui, "Scene", true, |ui| {
        let preset = state.session.preset();
        setting_ui(ui, state, commands, "scene.room");
        setting_ui(ui, state, commands, "scene.spin_deg_per_s");
        setting_ui(ui, state, commands, "output.background");
        if preset.stack.0.iter().any(|enabled| enabled.effect.hooks.has_lines) {
            setting_ui(ui, state, commands, "scene.polyline");
        }
        let Some(scene) = state.session.scene() else { return };
        if !scene.cameras.is_empty() {
            cameras_ui(ui, scene, preset, commands);
        }
        if let Some(text) = images_text(scene) {
            ui.horizontal(|ui| {
                ui.set_min_height(theme::ROW);
                ui.add_space(theme::GAP);
                ui.label(theme::weak(text)).on_hover_ui(|ui| {
                    for image in &scene.images {
                        let [width, height] = image.size();
                        ui.label(format!("{}: {width} x {height}, {}", image.name, text::bytes(image.bytes())));
                    }
                });
            });
        }
    });
}

/// A menu of the scene's cameras. A camera of the preset takes precedence.
fn cameras_ui(ui: &mut Ui, scene: &Scene, preset: &Preset, commands: &Commands) {
    let id = |index: usize| {
        let name = &scene.cameras[index].name;
        // Of cameras with the same name, all but the first go by their index.
        if scene.camera(name) == Some(index) { name.clone() } else { format!("#{index}") }
    };
    let chosen = preset.camera.is_none().then(|| scene.camera(&preset.scene_camera).unwrap_or(0));
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let shown = chosen.map_or_else(|| "the preset's own camera".to_owned(), |index| format!("camera {}", id(index)));
        let menu = ComboBox::from_id_salt("scene.camera").selected_text(shown).width(ui.available_width() - theme::GAP);
        let menu = menu.show_ui(ui, |ui| {
            for index in 0..scene.cameras.len() {
                if ui.selectable_label(chosen == Some(index), id(index)).clicked() {
                    // The first camera is the default, so it needs no name.
                    commands.edit(Edit::SceneCamera(if index == 0 { String::new() } else { id(index) }));
                }
            }
        });
        menu.response
            .on_hover_text("Cameras of the scene. Moving the camera in the picture gives the preset its own.")
            .accessible_name("scene.camera");
    });
}

/// `3 images, 1.5 MiB`; none without images.
fn images_text(scene: &Scene) -> Option<String> {
    let bytes: u64 = scene.images.iter().map(Image::bytes).sum();
    match scene.images.len() {
        0 => None,
        1 => Some(format!("1 image, {}", text::bytes(bytes))),
        count => Some(format!("{count} images, {}", text::bytes(bytes))),
    }
}
