//! The bookmarks of the preset: cameras under names.

use egui::{self, Ui};

use crate::{
    app::{
        files::command::Naming,
        shell::{
            action::Action,
            command::{Commands, Edit},
            state::State,
        },
        widgets::{
            icons::{Icon, icon_button},
            theme,
        },
    },
    preset::Bookmark,
};

/// A row for each bookmark, and a button that adds one.
pub fn bookmarks_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let preset = state.session.preset();
    for bookmark in &preset.bookmarks {
        let is_here = preset.camera == Some(bookmark.camera);
        ui.horizontal(|ui| bookmark_ui(ui, bookmark, is_here, commands));
    }
    let add = ui.add_enabled(
        state.session.camera().is_some(),
        egui::Button::new("Add bookmark"),
    );
    if add.on_hover_text(Action::AddBookmark.hint()).clicked() {
        commands.perform(Action::AddBookmark);
    }
    ui.add_space(theme::GAP);
}

fn bookmark_ui(ui: &mut Ui, bookmark: &Bookmark, is_here: bool, commands: &Commands) {
    let name = &bookmark.name;
    if icon_button(ui, Icon::Cross, &format!("Remove {name}")).clicked() {
        commands.edit(Edit::RemoveBookmark(name.clone()));
    }
    let rename = ui.small_button("Rename");
    if rename.accessible_name(format!("Rename {name}")).clicked() {
        let naming = Naming::Bookmark(name.clone());
        let naming = naming;
        commands.run(|app| app.panels.naming.ask(naming));
    }
    let go = ui.add(egui::Button::selectable(is_here, name.as_str()).truncate());
    if go
        .on_hover_text("Look from here")
        .accessible_name(format!("Go to {name}"))
        .clicked()
    {
        commands.edit(Edit::Camera(Some(bookmark.camera)));
    }
}
