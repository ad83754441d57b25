//! The menu of an effect: what can be done with it besides changing its parameters.

use std::sync::Arc;

use egui::{self, Ui};

use crate::{
    app::{
        files::command::Naming,
        files::library,
        shell::apply::ask_new_effect,
        shell::{
            action::Action,
            command::{Command, Commands, Edit, RowCommand},
            state::State,
        },
        widgets::{
            icons::{Icon, icon_button},
            theme,
        },
    },
    effect_files::duplicate,
    effects::Effect,
};

/// Shows the entries of the menu.
pub fn menu_ui(ui: &mut Ui, state: &State, commands: &Commands, effect: &Arc<Effect>) {
    let mut chosen = values_ui(ui, state, effect);
    ui.separator();
    // Whether an effect can be duplicated does not depend on the name.
    let duplicated = duplicate(effect, "duplicate");
    let button = ui.add_enabled(duplicated.is_ok(), entry("Duplicate as my own…"));
    let button = match &duplicated {
        Ok(_) => button
            .on_hover_text("Write its text as a WGSL file of yours, and use that in its place"),
        Err(reason) => button.on_disabled_hover_text(format!("{} {reason}.", effect.name)),
    };
    if button.clicked() {
        let effect = Some(effect.clone());
        chosen = Some(Box::new(|app| ask_new_effect(app, effect)));
    }
    let file = effect.source.as_ref().and_then(|source| {
        let mut custom = state.session.preset_file.effects.custom();
        custom
            .find(|(name, _)| *name == source.stem)
            .and_then(|(_, found)| found.path.clone())
    });
    if let Some(path) = file {
        let shown = path.display().to_string();
        let edit = ui.add(entry("Edit the text"));
        if edit.on_hover_text(&shown).clicked() {
            let path = path.clone();
            chosen = Some(Box::new(|app| app.state.jobs.read_code(path)));
        }
        let open = ui.add(entry("Open in my editor"));
        if open.on_hover_text(&shown).clicked() {
            chosen = Some(Box::new(|app| app.state.jobs.open_editor(path)));
        }
    }
    if state.session.preset().stack.get(&effect.name).is_some()
        && ui.add(entry("Reset all parameters")).clicked()
    {
        commands.row(RowCommand::ResetGroup(effect.name.clone()));
        ui.close();
    }
    if state.session.preset().stack.get(&effect.name).is_some() && ui.add(entry("Remove")).clicked()
    {
        commands.edit(Edit::Disable(effect.clone()));
        ui.close();
    }
    if let Some(command) = chosen {
        commands.send(command);
        ui.close();
    }
}

/// What can be done with the effect's values as a whole: copied, pasted, saved and recalled.
fn values_ui(ui: &mut Ui, state: &State, effect: &Arc<Effect>) -> Option<Command> {
    let mut chosen: Option<Command> = None;
    let is_enabled = state.session.preset().stack.get(&effect.name).is_some();
    let copy = ui.add_enabled(is_enabled, entry("Copy effect"));
    if copy
        .on_hover_text(
            "Put the effect with its values and keyframes on the clipboard, for another preset",
        )
        .clicked()
    {
        let effect = effect.clone();
        chosen = Some(Box::new(move |app| library::copy_effect(app, &effect)));
    }
    if ui
        .add(entry("Paste effect"))
        .on_hover_text("Enable the effect that is on the clipboard, with its values")
        .clicked()
    {
        chosen = Some(Box::new(|app| Action::PastePreset.perform(app)));
    }
    let mut saved = state
        .files
        .values
        .iter()
        .filter(|saved| saved.effect == effect.name)
        .peekable();
    if is_enabled || saved.peek().is_some() {
        let menu = ui.menu_button("Saved values", |ui| {
            for saved in saved {
                ui.horizontal(|ui| {
                    if ui
                        .add(entry(&saved.name))
                        .accessible_name(format!("Use {} for {}", saved.name, effect.name))
                        .clicked()
                    {
                        let path = saved.path.clone();
                        chosen = Some(Box::new(move |app| library::use_values(app, &path)));
                    }
                    if icon_button(
                        ui,
                        Icon::Cross,
                        &format!("Delete {} of {}", saved.name, effect.name),
                    )
                    .clicked()
                    {
                        let path = saved.path.clone();
                        chosen = Some(Box::new(move |app| library::delete_values(app, &path)));
                    }
                });
            }
            let save = ui.add_enabled(is_enabled, entry("Save these values…"));
            if save
                .on_hover_text("Keep the effect's values under a name, for every preset")
                .clicked()
            {
                let naming = Naming::Values(effect.clone());
                chosen = Some(Box::new(|app| app.panels.naming.ask(naming)));
            }
        });
        menu.response.accessible_name("Saved values");
    }
    chosen
}

fn entry(text: &str) -> egui::Button<'_> {
    egui::Button::new(text).min_size(egui::vec2(176.0, theme::ROW))
}
