//! The menu of a preset in the gallery: open it with its scene, rename, duplicate, delete.

use eframe::egui::{self, Ui};

use crate::{
    app::{
        files::command::{FileCommand, LibraryCommand, Manner, Naming},
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
    let mut chosen = None;
    let with_scene = ui.add_enabled(entry.preset_file.is_ok(), button("Open with its scene"));
    if with_scene
        .on_hover_text("Its own scene in place of the open one")
        .clicked()
    {
        commands.send(opening(entry, Manner::WithScene));
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
        chosen = Some(LibraryCommand::AskName(Naming::Preset {
            path: path.clone(),
            title: title.into(),
        }));
    }
    let duplicate = ui.add_enabled(entry.preset_file.is_ok(), button("Duplicate"));
    let duplicate =
        duplicate.on_disabled_hover_text("A preset that cannot be read cannot be duplicated");
    if duplicate.clicked()
        && let Ok(found) = &entry.preset_file
    {
        chosen = Some(LibraryCommand::Duplicate(found.clone().into()));
    }
    if file_entry(ui, "Delete")
        && let Some(path) = &entry.path
    {
        chosen = Some(LibraryCommand::Delete(path.clone()));
    }
    if let Some(chosen) = chosen {
        commands.send(Command::Library(chosen));
        ui.close();
    }
}

/// Opens a preset of the gallery, or says why it cannot be opened.
pub fn opening(entry: &GalleryEntry, manner: Manner) -> Command {
    match &entry.preset_file {
        Ok(found) => Command::File(FileCommand::OpenPreset(Box::new(found.clone()), manner)),
        Err(error) => Command::Notify(Level::Error, error.to_string()),
    }
}

fn button(text: &str) -> egui::Button<'_> {
    egui::Button::new(text).min_size(egui::vec2(148.0, theme::ROW))
}
