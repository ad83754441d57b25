//! Places that the dialog for paths offers: the home folder and those of recent files.

use std::path::{Path, PathBuf};

use egui::Ui;

use crate::app::{settings::recents::Recents, widgets::text::cut_middle};

/// Folders that are offered, at most.
const PLACES: usize = 5;

/// The home folder and those of recent files, newest first, each with its name; the parent stands before
/// names that are the same.
fn places(recents: &Recents) -> Vec<(String, PathBuf)> {
    let mut places: Vec<(String, PathBuf)> = std::env::home_dir()
        .map(|home| ("Home".to_owned(), home))
        .into_iter()
        .collect();
    for folder in recents.iter().filter_map(Path::parent) {
        let name = folder.file_name().unwrap_or(folder.as_os_str());
        if places.len() < PLACES && places.iter().all(|(_, known)| known != folder) {
            places.push((name.to_string_lossy().into_owned(), folder.to_owned()));
        }
    }
    let names: Vec<String> = places.iter().map(|(name, _)| name.clone()).collect();
    for (name, folder) in &mut places {
        let parent = folder.parent().and_then(Path::file_name);
        if let Some(parent) = parent
            && names.iter().filter(|other| *other == name).count() > 1
        {
            *name = format!("{}/{name}", parent.to_string_lossy());
        }
    }
    places
}

/// A button for each place. Returns the folder that was clicked, with a separator at its end as a
/// folder that is typed.
pub fn places_ui(ui: &mut Ui, recents: &Recents) -> Option<PathBuf> {
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        for (name, folder) in places(recents) {
            let button = ui.small_button(cut_middle(&name, 24));
            let button = button.on_hover_text(folder.display().to_string());
            if button.accessible_name(format!("Folder {name}")).clicked() {
                chosen = Some(folder.join(""));
            }
        }
    });
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn home_and_the_folders_of_recent_files_are_offered_each_once() {
        let paths = ["/a/x.toml", "/b/y.glb", "/a/z.toml"];
        let recents: Recents = paths.iter().collect();
        let names: Vec<String> = places(&recents).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names[names.len() - 2..], ["a", "b"]);
        assert!(names.len() < 4, "{names:?}");
        let recents: Recents = ["/a/models/x.glb", "/b/models/y.glb"].iter().collect();
        let names: Vec<String> = places(&recents).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names[names.len() - 2..], ["a/models", "b/models"]);
    }
}
