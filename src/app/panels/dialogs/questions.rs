//! Dialogs that ask one question and answer it with buttons.

use eframe::egui::{RichText, Ui};

use super::buttons::{Choice, buttons};
use crate::{
    app::{
        files::command::Side, panels::brought_code::code_ui, settings::last_session::Restored,
        widgets::theme,
    },
    params::legible_line,
    preset_file::PresetFile,
};

pub fn muted_ui(ui: &mut Ui, muted: &[&str]) -> Option<Choice> {
    ui.label(
        RichText::new("Some effects are muted")
            .size(15.0)
            .color(theme::text_strong())
            .strong(),
    );
    ui.label(format!(
        "{} cannot be seen now. Muting is not saved.",
        muted.join(", ")
    ));
    ui.add_space(theme::HALF);
    let options = [
        ("Save with them", Choice::KeepMuted, true),
        ("Remove them and save", Choice::DropMuted, false),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options, |_| None)
}

/// `keeps_session`: the edits can wait for the next start.
pub fn unsaved_ui(ui: &mut Ui, title: &str, keeps_session: bool) -> Option<Choice> {
    ui.label(
        RichText::new("Save your changes?")
            .size(15.0)
            .color(theme::text_strong())
            .strong(),
    );
    ui.label(format!("{title} has unsaved changes."));
    ui.add_space(theme::HALF);
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
    ui.label(
        RichText::new("Go on where you were?")
            .size(15.0)
            .color(theme::text_strong())
            .strong(),
    );
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
    ui.add_space(theme::HALF);
    buttons(
        ui,
        &[
            ("Open it again", Choice::Restore, true),
            ("Start anew", Choice::Discard, false),
        ],
        |_| None,
    )
}

pub fn changed_ui(ui: &mut Ui, title: &str, is_saving: bool) -> Option<Choice> {
    ui.label(
        RichText::new("The preset's file has changed")
            .size(15.0)
            .color(theme::text_strong())
            .strong(),
    );
    ui.label(format!(
        "{title} has unsaved changes, and another program has changed its file."
    ));
    ui.add_space(theme::HALF);
    let weak = "Merge takes both key by key, and yours where both have changed the same. Nothing is written to the file unless you save.";
    ui.label(theme::weak(if is_saving {
        "Merge takes both key by key, and yours where both have changed the same."
    } else {
        weak
    }));
    ui.add_space(theme::HALF);
    let mine = if is_saving {
        "Overwrite with mine"
    } else {
        "Keep mine"
    };
    let merge = if is_saving { "Merge and save" } else { "Merge" };
    let options = [
        (merge, Choice::Side(Side::Both), true),
        (mine, Choice::Side(Side::Mine), false),
        ("Take theirs", Choice::Side(Side::Theirs), false),
        ("Cancel", Choice::Cancel, false),
    ];
    // Without a save nothing happens to the file yet, so keeping mine is what cancelling does.
    buttons(ui, if is_saving { &options } else { &options[..3] }, |_| {
        None
    })
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
    ui.label(
        RichText::new("Open its model too?")
            .size(15.0)
            .color(theme::text_strong())
            .strong(),
    );
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
    ui.add_space(theme::HALF);
    let options = [
        ("Open", Choice::OpenModel, true),
        ("Look only", Choice::LookOnly, !is_there),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options[usize::from(!is_there)..], |_| None)
}
