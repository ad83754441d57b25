//! Dialogs that ask one question and answer it with buttons.

use std::collections::BTreeSet;

use egui::{RichText, Ui};

use super::buttons::{Choice, buttons};
use crate::{
    app::{
        files::command::Side, panels::brought_code::code_ui, settings::last_session::Restored,
        widgets::theme,
    },
    params::legible_line,
    preset_file::PresetFile,
};

pub fn muted_ui(ui: &mut Ui, muted: &BTreeSet<String>) -> Option<Choice> {
    ui.label(theme::title("Some effects are muted"));
    ui.label(format!(
        "{} cannot be seen now. Muting is not saved.",
        muted
            .iter()
            .map(String::as_str)
            .collect::<Vec<_>>()
            .join(", ")
    ));
    let options = [
        ("Save with them", Choice::KeepMuted, true),
        ("Remove them and save", Choice::DropMuted, false),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options, |_| None)
}

/// `keeps_session`: the edits can wait for the next start.
pub fn unsaved_ui(ui: &mut Ui, title: &str, keeps_session: bool) -> Option<Choice> {
    ui.label(theme::title("Save your changes?"));
    ui.label(format!("{title} has unsaved changes."));
    let options = [
        ("Save", Choice::Save, true),
        ("Keep for the next start", Choice::Keep, false),
        ("Discard", Choice::Discard, false),
        ("Cancel", Choice::Cancel, false),
    ];
    let options: Vec<_> = options
        .into_iter()
        .filter(|(_, choice, _)| keeps_session || *choice != Choice::Keep)
        .collect();
    buttons(ui, &options, |_| None)
}

/// What is to happen with the session that a crash ended?
pub fn restore_ui(ui: &mut Ui, restored: &Restored) -> Option<Choice> {
    ui.label(theme::title("Go on where you were?"));
    let title = restored.preset_file.title();
    let edits = if restored.has_edits() {
        " with its unsaved changes"
    } else {
        ""
    };
    ui.label(format!("The last session ended without closing the window, perhaps by a crash. {title} can be opened again{edits}."));
    if restored.has_edits() {
        ui.label(theme::weak(
            "If you start anew, the unsaved changes are lost.",
        ));
    }
    let options = [
        ("Open it again", Choice::Restore, true),
        ("Start anew", Choice::Discard, false),
    ];
    buttons(ui, &options, |_| None)
}

pub fn changed_ui(ui: &mut Ui, title: &str, is_saving: bool) -> Option<Choice> {
    ui.label(theme::title("The preset's file has changed"));
    ui.label(format!(
        "{title} has unsaved changes, and another program has changed its file."
    ));
    ui.add_space(theme::HALF);
    let about =
        "Merge takes both key by key, and yours where both have changed the same.".to_owned();
    ui.label(theme::weak(match is_saving {
        true => about,
        false => about + " Nothing is written to the file unless you save.",
    }));
    let (mine, merge) = match is_saving {
        true => ("Overwrite with mine", "Merge and save"),
        false => ("Keep mine", "Merge"),
    };
    let options = [
        (merge, Choice::Side(Side::Both), true),
        (mine, Choice::Side(Side::Mine), false),
        ("Take theirs", Choice::Side(Side::Theirs), false),
        ("Cancel", Choice::Cancel, false),
    ];
    // Without a save nothing happens to the file yet, so keeping mine is what cancelling does.
    buttons(ui, &options[..3 + usize::from(is_saving)], |_| None)
}

pub fn brought_ui(ui: &mut Ui, preset_file: &PresetFile) -> Option<Choice> {
    code_ui(ui, preset_file);
    let options = [
        ("Run this code", Choice::Run, false),
        ("Open without these effects", Choice::OpenWithout, true),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options, |_| None)
}

/// May the model be read that the picture or the pasted line names?
pub fn outside_ui(ui: &mut Ui, preset_file: &PresetFile) -> Option<Choice> {
    let Some(model) = &preset_file.outside_model else {
        return Some(Choice::Cancel);
    };
    ui.label(theme::title("Open its model too?"));
    let what = match preset_file.path {
        Some(_) => "The picture",
        None => "The pasted line",
    };
    // To ask for a file of another machine would already reach it.
    let text = model.to_string_lossy();
    let is_there = text.starts_with("\\\\") || text.starts_with("//") || model.is_file();
    ui.label(format!(
        "{what} shows a model {}:",
        match (is_there, &preset_file.path) {
            (false, _) => "that is not on this machine",
            (true, Some(_)) => "outside of its folder",
            (true, None) => "on this machine",
        }
    ));
    ui.label(RichText::new(legible_line(&text)).monospace());
    if is_there {
        ui.label(theme::weak(
            "Open it if you know the file: it is read, and the files in its folder that it names.",
        ));
    }
    let options = [
        ("Open", Choice::OpenModel, true),
        ("Look only", Choice::LookOnly, !is_there),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options[usize::from(!is_there)..], |_| None)
}
