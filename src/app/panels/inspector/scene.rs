//! The folder of the scene: its settings, its cameras and its images.

use eframe::egui::{ComboBox, Ui};

use super::{
    parts::parts_ui,
    rows::{folder, setting_ui},
};
use crate::{
    app::{
        shell::{
            command::{Commands, Edit, RowCommand},
            state::State,
        },
        widgets::{text, theme},
    },
    params::{Stored as _, Value},
    preset::{
        Preset,
        settings::{GROUND, Setting},
    },
    preset_file::surroundings,
    scene::{Scene, parts::ShownParts, texture::Image},
};

pub fn scene_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    folder(ui, "Scene", true, |ui| {
        let preset = state.session.preset();
        setting_ui(ui, state, commands, "scene.room");
        surroundings_ui(ui, state, commands);
        setting_ui(ui, state, commands, "scene.spin_deg_per_s");
        setting_ui(ui, state, commands, "output.background");
        gradient_ui(ui, preset, commands);
        setting_ui(ui, state, commands, BOTTOM);
        ground_ui(ui, state, commands);
        GROUND
            .settings
            .iter()
            .for_each(|setting| setting_ui(ui, state, commands, &setting.path()));
        if preset
            .stack
            .0
            .iter()
            .any(|enabled| enabled.effect.hooks.has_lines)
        {
            setting_ui(ui, state, commands, "scene.polyline");
        }
        let Some(scene) = state.session.scene() else {
            return;
        };
        if !scene.cameras.is_empty() {
            cameras_ui(ui, scene, preset, commands);
        }
        if !scene.variants.is_empty() {
            variants_ui(ui, scene, &preset.parts, commands);
        }
        if let Some(text) = images_text(scene) {
            ui.horizontal(|ui| {
                ui.set_min_height(theme::ROW);
                ui.add_space(theme::GAP);
                ui.label(theme::weak(text)).on_hover_ui(|ui| {
                    for image in &scene.images {
                        let [width, height] = image.size();
                        ui.label(format!(
                            "{}: {width} x {height}, {}",
                            image.name,
                            text::bytes(image.bytes())
                        ));
                    }
                });
            });
        }
    });
}

/// A menu of the pictures that may surround the scene.
fn surroundings_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    const NONE: &str = "no picture around it";
    let Some(setting) = Setting::find("scene.surroundings") else {
        return;
    };
    let (file, named) = (
        &state.session.preset_file,
        &state.session.preset().surroundings,
    );
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let chosen = match named.as_str() {
            "" => NONE.to_owned(),
            name => format!("in {}", surroundings::shown(name)),
        };
        let menu = ComboBox::from_id_salt("scene.surroundings")
            .selected_text(chosen)
            .width(ui.available_width() - theme::GAP);
        let menu = menu.show_ui(ui, |ui| {
            let known = surroundings::known(file.path.as_deref()).into_iter();
            for name in [String::new()].into_iter().chain(known) {
                let label = if name.is_empty() { NONE } else { name.as_str() };
                let is_chosen = *named == name;
                if ui.selectable_label(is_chosen, label).clicked() && !is_chosen {
                    commands.edit(Edit::Setting(setting, name.to_value()));
                }
            }
        });
        menu.response
            .on_hover_text("The .hdr files beside the preset, and those of the gallery. Studio and sky show the picture where their environment is picture.")
            .accessible_name("scene.surroundings");
    });
}

/// The setting that makes the background a gradient.
const BOTTOM: &str = "output.background_bottom";

/// The tick of the gradient, which adds the color at the bottom or removes it.
fn gradient_ui(ui: &mut Ui, preset: &Preset, commands: &Commands) {
    let Some(setting) = Setting::find(BOTTOM) else {
        return;
    };
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let mut is_on = preset.output.background_bottom.is_some();
        let tick = ui.checkbox(&mut is_on, "gradient").on_hover_text(
            "The background changes from this color at the top to another at the bottom",
        );
        if tick.changed() && is_on {
            commands.edit(Edit::Setting(
                setting,
                first_bottom(preset.output.background).to_value(),
            ));
        } else if tick.changed() {
            commands.row(RowCommand::Reset(BOTTOM.into()));
        }
    });
}

/// The tick of the ground, which adds it or removes it, and the parts of the scene.
fn ground_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let preset = state.session.preset();
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let mut is_on = preset.ground.is_some();
        let tick = ui
            .checkbox(&mut is_on, "ground")
            .on_hover_text("The scene stands on a disc or a square that receives its shadow");
        if tick.changed() && is_on {
            // Any setting of the table adds it.
            let first = &GROUND.settings[0];
            commands.edit(Edit::Setting(first, Value::Choice(0)));
        } else if tick.changed() {
            commands.row(RowCommand::ResetGroup(GROUND.name.into()));
        }
        ui.add_space(theme::GAP);
        parts_ui(ui, state, commands);
    });
}

/// The color at the bottom of a new gradient: darker than that of a light background, lighter than
/// that of a dark one.
fn first_bottom([r, g, b, alpha]: [f32; 4]) -> [f32; 4] {
    let is_light = 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.18;
    let [r, g, b] = [r, g, b].map(|c| {
        if is_light {
            0.3 * c
        } else {
            c + 0.25 * (1.0 - c)
        }
    });
    [r, g, b, alpha]
}

/// A menu of the scene's cameras. A camera of the preset takes precedence.
fn cameras_ui(ui: &mut Ui, scene: &Scene, preset: &Preset, commands: &Commands) {
    let id = |index: usize| {
        let name = &scene.cameras[index].name;
        // Of cameras with the same name, all but the first go by their index.
        if scene.camera(name) == Some(index) {
            name.clone()
        } else {
            format!("#{index}")
        }
    };
    let chosen = preset
        .camera
        .is_none()
        .then(|| scene.camera(&preset.scene_camera).unwrap_or(0));
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let shown = chosen.map_or_else(
            || "the preset's own camera".to_owned(),
            |index| format!("camera {}", id(index)),
        );
        let menu = ComboBox::from_id_salt("scene.camera")
            .selected_text(shown)
            .width(ui.available_width() - theme::GAP);
        let menu = menu.show_ui(ui, |ui| {
            for index in 0..scene.cameras.len() {
                if ui
                    .selectable_label(chosen == Some(index), id(index))
                    .clicked()
                {
                    // The first camera is the default, so it needs no name.
                    commands.edit(Edit::SceneCamera(if index == 0 {
                        String::new()
                    } else {
                        id(index)
                    }));
                }
            }
        });
        menu.response
            .on_hover_text(
                "Cameras of the scene. Moving the camera in the picture gives the preset its own.",
            )
            .accessible_name("scene.camera");
    });
}

/// A menu of the variants of the scene's materials.
fn variants_ui(ui: &mut Ui, scene: &Scene, shown: &ShownParts, commands: &Commands) {
    const NONE: &str = "no variant";
    let id = |index: usize| {
        let name = &scene.variants[index];
        // Of variants with the same name, all but the first go by their index.
        if scene.variant(name) == Some(index) {
            name.clone()
        } else {
            format!("#{index}")
        }
    };
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let chosen = match shown.variant.as_str() {
            "" => NONE.to_owned(),
            name => format!("variant {name}"),
        };
        let menu = ComboBox::from_id_salt("scene.variant")
            .selected_text(chosen)
            .width(ui.available_width() - theme::GAP);
        let menu = menu.show_ui(ui, |ui| {
            let all = (0..scene.variants.len()).map(|index| (id(index), id(index)));
            for (variant, label) in [(String::new(), NONE.to_owned())].into_iter().chain(all) {
                let is_chosen = shown.variant == variant;
                if ui.selectable_label(is_chosen, label).clicked() && !is_chosen {
                    commands.edit(Edit::Parts(ShownParts {
                        variant,
                        ..shown.clone()
                    }));
                }
            }
        });
        menu.response
            .on_hover_text("Variants of the scene's materials")
            .accessible_name("scene.variant");
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
