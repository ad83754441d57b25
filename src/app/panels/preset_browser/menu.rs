//! The menu of a preset in the gallery: open it with its scene, rename, duplicate, delete.

use egui::{self, Ui};

use crate::{
    app::{
        files::apply::open_preset,
        files::command::{Manner, Naming},
        files::library,
        shell::{
            command::{Command, Commands},
            log::Level,
        },
        widgets::theme,
    },
    preset_file::GalleryEntry,
};

/// Shows the entries.
pub fn menu_ui(ui: &mut Ui, entry: &GalleryEntry, commands: &Commands) {
    let title = entry.title();
    let mut chosen: Option<Command> = None;
    let with_scene = ui.add_enabled(entry.preset_file.is_ok(), button("Open with its scene"));
    if with_scene
        .on_hover_text("Its own scene in place of the open one")
        .clicked()
    {
        open_entry(entry, Manner::WithScene, commands);
        ui.close();
    }
    ui.separator();
    let why = format!(
        "{title} is built in, so it cannot be renamed or deleted. Duplicate it, and change the copy."
    );
    let file_entry = |ui: &mut Ui, text: &str| {
        let button = ui.add_enabled(entry.path.is_some(), button(text));
        button.on_disabled_hover_text(&why).clicked()
    };
    if file_entry(ui, "Rename…")
        && let Some(path) = &entry.path
    {
        let naming = Naming::Preset {
            path: path.clone(),
            title: title.into(),
        };
        chosen = Some(Box::new(|app| app.panels.naming.ask(naming)));
    }
    let duplicate = ui.add_enabled(entry.preset_file.is_ok(), button("Duplicate"));
    let duplicate =
        duplicate.on_disabled_hover_text("A preset that cannot be read cannot be duplicated");
    if duplicate.clicked()
        && let Ok(found) = &entry.preset_file
    {
        let found = found.clone();
        chosen = Some(Box::new(move |app| {
            library::notify_outcome(app, |app| library::duplicate(app, &found));
        }));
    }
    if file_entry(ui, "Delete")
        && let Some(path) = &entry.path
    {
        let path = path.clone();
        chosen = Some(Box::new(move |app| {
            library::notify_outcome(app, |app| library::delete(app, &path));
        }));
    }
    if let Some(chosen) = chosen {
        commands.send(chosen);
        ui.close();
    }
}

/// Opens a preset of the gallery, or says why it cannot be opened.
pub fn open_entry(entry: &GalleryEntry, manner: Manner, commands: &Commands) {
    match &entry.preset_file {
        Ok(found) => {
            let found = found.clone();
            commands.run(move |app| open_preset(app, found, manner));
        }
        Err(error) => commands.notify(Level::Error, error.to_string()),
    }
}

fn button(text: &str) -> egui::Button<'_> {
    egui::Button::new(text).min_size(egui::vec2(148.0, theme::ROW))
}
