//! Rows of settings and parameters, and the folders that hold them.

use egui::{self, Ui};

use crate::{
    app::{
        shell::{command::Commands, state::State},
        widgets::{
            fields::{Row, row_ui},
            reveal, theme,
        },
    },
    preset::settings::Setting,
};

/// Folders, and the settings that each always has a row of, where they apply to the preset.
const FOLDERS: &[(&str, &[&str])] = &[
    (
        "Scene",
        &[
            "scene.only",
            "scene.hidden",
            "scene.room",
            "scene.surroundings",
            "scene.spin_deg_per_s",
            "output.background",
            "output.background_bottom",
            "ground.shape",
            "ground.size",
            "ground.color",
            "ground.cells",
        ],
    ),
    (
        "Camera",
        &[
            "camera.eye",
            "camera.target",
            "camera.fov_y_deg",
            "camera.orthographic_height_m",
            "camera.near_m",
        ],
    ),
    (
        "Clock",
        &["clock.time_s", "clock.range_s", "clock.loop", "clock.speed"],
    ),
    ("Preset", &["name", "about", "output.size"]),
];

/// Does a folder have a row of the setting at `path`?
pub fn has_row(path: &str) -> bool {
    FOLDERS.iter().any(|(_, paths)| paths.contains(&path))
}

fn lead_id() -> egui::Id {
    egui::Id::unique("folder to go to")
}

/// Opens the folder called `title` in the next frame, and scrolls to it.
pub fn lead_to(ctx: &egui::Context, title: &'static str) {
    ctx.data_mut(|data| data.insert_temp(lead_id(), title));
    ctx.request_repaint();
}

/// Is the folder called `title` the one to go to? True once.
pub fn is_led_to(ctx: &egui::Context, title: &str) -> bool {
    ctx.data_mut(|data| {
        let is_this = data
            .get_temp::<&'static str>(lead_id())
            .is_some_and(|to| to == title);
        if is_this {
            data.remove::<&'static str>(lead_id());
        }
        is_this
    })
}

/// A folder of the inspector; `open` at the start.
pub fn folder(ui: &mut Ui, title: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    let mut paths = FOLDERS
        .iter()
        .filter(|(folder, _)| *folder == title)
        .flat_map(|(_, paths)| *paths);
    let is_revealed = paths.any(|path| reveal::is_within(ui.ctx(), path));
    let is_led_to = is_led_to(ui.ctx(), title);
    let header = egui::CollapsingHeader::new(theme::heading(title))
        .default_open(open)
        .open((is_revealed || is_led_to).then_some(true));
    let shown = header.show_unindented(ui, |ui| {
        ui.add_space(2.0);
        contents(ui);
        ui.add_space(theme::GAP);
    });
    if is_led_to {
        scroll_to_top(ui, shown.header_response.rect);
    }
}

/// Scrolls so that `rect` is at the top.
pub fn scroll_to_top(ui: &Ui, rect: egui::Rect) {
    ui.scroll_to_rect_animation(
        rect,
        Some(egui::Align::TOP),
        egui::style::ScrollAnimation::none(),
    );
}

/// A folder of settings, by their paths.
pub fn settings_folder(
    ui: &mut Ui,
    state: &State,
    commands: &Commands,
    (title, open): (&str, bool),
    paths: &[&str],
) {
    folder(ui, title, open, |ui| {
        paths
            .iter()
            .for_each(|path| setting_ui(ui, state, commands, path))
    });
}

/// The row of a setting; nothing if it does not apply to the preset.
pub fn setting_ui(ui: &mut Ui, state: &State, commands: &Commands, path: &str) {
    let Some(setting) = Setting::find(path) else {
        return;
    };
    let preset = state.session.preset();
    let Some(value) = setting.get(preset) else {
        return;
    };
    row_ui(ui, commands, &Row::of_setting(setting, preset), &value);
}
