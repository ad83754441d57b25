//! The folder of the scene: its settings, its cameras and its images.

use egui::Ui;

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
        widgets::{form::menu_ui, panel::row, text, theme},
    },
    params::{Stored as _, Value},
    preset::{
        NO_CAMERA, Preset,
        settings::{GROUND, Setting},
    },
    preset_file::surroundings,
    scene::{Scene, parts::ShownParts, texture::Image},
};

pub fn scene_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    folder(ui, "Scene", true, |ui| {
        let preset = state.session.preset();
        setting_ui(ui, state, commands, "scene.up");
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
            row(ui, |ui| {
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
    let now = match named.as_str() {
        "" => NONE.to_owned(),
        name => format!("in {}", surroundings::shown(name)),
    };
    let known = surroundings::known(file.path.as_deref()).into_iter();
    let known = known.map(|name| (name.clone(), name));
    let hint = "The .hdr files beside the preset, and those of the gallery. Studio and sky show the picture where their environment is picture.";
    let chosen = scene_menu(
        ui,
        "scene.surroundings",
        now,
        (Some(named), NONE),
        known,
        hint,
    );
    if let Some(name) = chosen {
        commands.edit(Edit::Setting(setting, name.to_value()));
    }
}

/// A menu in a row of the scene: nothing, called `none` if that can be chosen, and the names.
fn scene_menu(
    ui: &mut Ui,
    name: &str,
    now: String,
    (chosen, none): (Option<&String>, &str),
    offers: impl Iterator<Item = (String, String)>,
    hint: &str,
) -> Option<String> {
    let none = (!none.is_empty()).then(|| (String::new(), none.to_owned()));
    let offers = none.into_iter().chain(offers);
    let offers = offers.map(|(name, label)| (name, label, ""));
    row(ui, |ui| {
        let width = ui.available_width() - theme::GAP;
        let (taken, menu) = menu_ui(ui, name, (now, width), chosen, offers);
        menu.on_hover_text(hint);
        taken
    })
}

/// The name of the scene's camera or variant at `index`. Of those with the same name, all but the
/// first go by their index.
fn unique_name(name: &str, index: usize, found: Option<usize>) -> String {
    match found == Some(index) {
        true => name.to_owned(),
        false => format!("#{index}"),
    }
}

/// The setting that makes the background a gradient.
const BOTTOM: &str = "output.background_bottom";

/// The tick of the gradient, which adds the color at the bottom or removes it.
fn gradient_ui(ui: &mut Ui, preset: &Preset, commands: &Commands) {
    let Some(setting) = Setting::find(BOTTOM) else {
        return;
    };
    row(ui, |ui| {
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
    row(ui, |ui| {
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

/// What the automatic camera does.
const FRAMES_ALL: &str = "the whole scene";

/// A menu of the scene's cameras. A camera of the preset takes precedence.
fn cameras_ui(ui: &mut Ui, scene: &Scene, preset: &Preset, commands: &Commands) {
    let id = |index: usize| {
        let name = &scene.cameras[index].name;
        unique_name(name, index, scene.camera(name))
    };
    let is_automatic = preset.scene_camera == NO_CAMERA;
    let chosen = match preset.camera {
        None if is_automatic => Some(NO_CAMERA.to_owned()),
        None => Some(id(scene.camera(&preset.scene_camera).unwrap_or(0))),
        Some(_) => None,
    };
    let now = match &chosen {
        None => "the preset's own camera".to_owned(),
        Some(_) if is_automatic => FRAMES_ALL.to_owned(),
        Some(id) => format!("camera {id} of the file"),
    };
    let offers = (0..scene.cameras.len()).map(|index| (id(index), id(index)));
    let offers = offers.chain([(NO_CAMERA.to_owned(), FRAMES_ALL.to_owned())]);
    let hint = "Cameras of the scene. Moving the camera in the picture gives the preset its own.";
    let taken = scene_menu(ui, "scene.camera", now, (chosen.as_ref(), ""), offers, hint);
    if let Some(camera) = taken {
        // The first camera is the default, so it needs no name.
        let name = Some(camera).filter(|camera| *camera != id(0));
        commands.edit(Edit::SceneCamera(name.unwrap_or_default()));
    }
}

/// A menu of the variants of the scene's materials.
fn variants_ui(ui: &mut Ui, scene: &Scene, shown: &ShownParts, commands: &Commands) {
    const NONE: &str = "no variant";
    let id = |index: usize| {
        let name = &scene.variants[index];
        unique_name(name, index, scene.variant(name))
    };
    let now = match shown.variant.as_str() {
        "" => NONE.to_owned(),
        name => format!("variant {name}"),
    };
    let offers = (0..scene.variants.len()).map(|index| (id(index), id(index)));
    let hint = "Variants of the scene's materials, or what colors its points";
    let chosen = (Some(&shown.variant), NONE);
    if let Some(variant) = scene_menu(ui, "scene.variant", now, chosen, offers, hint) {
        commands.edit(Edit::Parts(ShownParts {
            variant,
            ..shown.clone()
        }));
    }
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
