//! The inspector: every value of the preset in folders, from the registry that preset files and the
//! command line use too.

mod accuracy;
mod bookmarks;
mod clips;
pub mod effect_menu;
mod effects;
mod overlays;
mod parts;
mod precision;
mod report;
pub mod rows;
mod scene;
mod scope;

use egui::{self, Ui};

use self::rows::{folder, lead_to, setting_ui, settings_folder};
use crate::app::panels::panel::Panel;
use crate::{
    app::{
        shell::{
            action::Action,
            command::{Commands, Edit},
            state::State,
        },
        widgets::theme,
    },
    preset::settings::CAMERA,
};

/// See the module's first line.
pub struct Inspector;

/// Folders that the buttons at the top lead to.
const LEADS: [&str; 6] = [
    "Effects", "Scene", "Camera", "Accuracy", "Overlays", "Timing",
];

impl Panel for Inspector {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        leads_ui(ui);
        egui::ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 2.0;
                effects::effects_ui(ui, state, commands);
                scene::scene_ui(ui, state, commands);
                camera_ui(ui, state, commands);
                accuracy::accuracy_ui(ui, state, commands);
                clips::clips_ui(ui, state, commands);
                let clock = ["clock.time_s", "clock.range_s", "clock.loop", "clock.speed"];
                settings_folder(ui, state, commands, ("Clock", false), &clock);
                folder(ui, "Overlays", false, |ui| {
                    overlays::overlays_ui(ui, state, commands)
                });
                folder(ui, "Timing", true, |ui| report::timing_ui(ui, state));
                folder(ui, "Kernel", false, |ui| report::kernel_ui(ui, state));
                settings_folder(
                    ui,
                    state,
                    commands,
                    ("Preset", false),
                    &["name", "about", "output.size"],
                );
                ui.add_space(16.0);
            });
    }
}

/// Buttons that lead to the folders, however long the stack is.
fn leads_ui(ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        ui.spacing_mut().button_padding = egui::vec2(0.0, 1.0);
        for title in LEADS {
            let text = theme::weak(title).size(11.5);
            let button = ui.add(egui::Button::new(text).frame(false));
            if button.accessible_name(format!("Go to {title}")).clicked() {
                lead_to(ui.ctx(), title);
            }
        }
    });
    ui.add_space(2.0);
}

fn camera_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    folder(ui, "Camera", false, |ui| {
        bookmarks::bookmarks_ui(ui, state, commands);
        if state.session.preset().camera.is_none() {
            ui.label(theme::weak("The whole scene is framed automatically. Move the camera in the picture, or set it to type numbers."));
            if ui.button("Set the camera").clicked()
                && let Some(camera) = state.session.camera()
            {
                commands.edit(Edit::Camera(Some(camera)));
            }
            return;
        }
        let settings = CAMERA
            .settings
            .iter()
            .filter(|setting| setting.name != "up");
        settings.for_each(|setting| setting_ui(ui, state, commands, &setting.path()));
        ui.horizontal(|ui| {
            if ui.button("Frame scene").clicked() {
                commands.perform(Action::Frame);
            }
            if ui
                .button("Automatic")
                .on_hover_text(
                    "Remove the camera from the preset, so that the scene is framed automatically",
                )
                .clicked()
            {
                commands.edit(Edit::Camera(None));
            }
        });
    });
}
