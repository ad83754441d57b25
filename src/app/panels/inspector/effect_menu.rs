//! The menu of an effect: what can be done with it besides changing its parameters.

use eframe::egui::{self, Ui};

use crate::{
    app::{
        command::{Command, Commands, Edit, FileCommand, RowCommand},
        state::State,
        theme,
    },
    effect_files::duplicate,
    effects::Effect,
};

/// Shows the entries of the menu.
pub fn menu_ui(ui: &mut Ui, state: &State, commands: &Commands, effect: &'static Effect) {
    let mut chosen = None;
    // Whether an effect can be duplicated does not depend on the name.
    let duplicated = duplicate(effect, "duplicate");
    let button = ui.add_enabled(duplicated.is_ok(), entry("Duplicate as my own…"));
    let button = match &duplicated {
        Ok(_) => button.on_hover_text("Write its text as a WGSL file of yours, and use that in its place"),
        Err(reason) => button.on_disabled_hover_text(format!("{} {reason}.", effect.name)),
    };
    if button.clicked() {
        chosen = Some(Command::File(FileCommand::AskNewEffect(Some(effect))));
    }
    let file = effect.source.and_then(|source| {
        let mut custom = state.session.preset_file.effects.custom();
        custom.find(|(name, _)| *name == source.stem).and_then(|(_, found)| found.path.clone())
    });
    if let Some(path) = file
        && ui.add(entry("Open in my editor")).on_hover_text(path.display().to_string()).clicked()
    {
        chosen = Some(Command::File(FileCommand::Edit(path)));
    }
    if state.session.preset().stack.get(effect.name).is_some() && ui.add(entry("Reset all parameters")).clicked() {
        chosen = Some(Command::Row(RowCommand::ResetGroup(effect.name.into())));
    }
    if state.session.preset().stack.get(effect.name).is_some() && ui.add(entry("Remove")).clicked() {
        chosen = Some(Command::Edit(Edit::Disable(effect)));
    }
    if let Some(command) = chosen {
        commands.send(command);
        ui.close();
    }
}

fn entry(text: &str) -> egui::Button<'_> {
    egui::Button::new(text).min_size(egui::vec2(176.0, theme::ROW))
}
