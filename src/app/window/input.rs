//! Keyboard shortcuts, the clipboard and dropped files, as commands.

use std::path::PathBuf;

use egui::{self, Event, Key, KeyboardShortcut};

use super::typing::HeldTyping;
use crate::app::{
    files::{command::Purpose, system_dialog},
    settings::keymap::Keymap,
    shell::{
        action::Action,
        apply::paste,
        command::{Commands, RowCommand},
        log::Level,
        state::State,
    },
    widgets::form::is_searching,
};

/// Sends the actions whose shortcuts were pressed, in the order of the keys. Shortcuts without Ctrl
/// do nothing while a widget has the focus, the camera flies or a form `is_filled_in`; those with Ctrl,
/// but for the palette's, do nothing while text is typed. A search keeps only what it can use itself. What is
/// typed after a key that opens a text field is held for it.
pub fn shortcuts(
    ctx: &egui::Context,
    (state, is_filled_in): (&State, bool),
    held: &mut HeldTyping,
    commands: &Commands,
) {
    let is_typing = ctx.text_edit_focused();
    let is_focused = ctx.egui_wants_keyboard_input();
    let is_searching = is_searching(ctx);
    let is_flying = ctx.input(|i| i.pointer.secondary_down());
    let is_allowed = |k: &KeyboardShortcut| match k.modifiers.command {
        _ if is_searching => !edits_text(k),
        true => !is_typing,
        false => !(is_focused || is_flying || is_filled_in),
    };
    let mut index = 0;
    while let Some(event) = ctx.input(|i| i.events.get(index).cloned()) {
        // The palette opens from anywhere, so that its key does not depend on what was typed
        // before.
        let opens_palette = || {
            action_of(&event, &state.settings.keys, |k| k.modifiers.command)
                .filter(|a| *a == Action::Palette)
        };
        let Some(action) =
            action_of(&event, &state.settings.keys, is_allowed).or_else(opens_palette)
        else {
            index += 1;
            continue;
        };
        commands.perform(action);
        if action.takes_text() {
            // What is typed from here on is for the field that opens.
            ctx.memory_mut(|memory| memory.focused().map(|id| memory.surrender_focus(id)));
            held.hold_after(ctx, index, state.now_s);
            // The character of an earlier shortcut in this frame is not for that field.
            ctx.input_mut(|i| {
                for event in &mut i.events[..index] {
                    if let Event::Text(text) = event
                        && !is_typing
                    {
                        text.clear();
                    }
                }
            });
        }
        ctx.input_mut(|i| drop(i.events.remove(index)));
    }
    if !is_typing {
        clipboard(ctx, state, commands);
    }
}

/// Is it a key of a field for text: a letter, one that moves in the text, or with Ctrl one that
/// selects, cuts, pastes or takes back?
fn edits_text(
    KeyboardShortcut {
        modifiers,
        logical_key: key,
    }: &KeyboardShortcut,
) -> bool {
    use Key::*;
    match key {
        ArrowLeft | ArrowRight | ArrowUp | ArrowDown | Home | End | Backspace | Delete => true,
        A | C | V | X | Y | Z if modifiers.command => true,
        key => !(modifiers.command || modifiers.alt || (F1..=F35).contains(key)),
    }
}

/// The action of a pressed key, if its shortcut is allowed.
fn action_of(
    event: &Event,
    keys: &Keymap,
    is_allowed: impl Fn(&KeyboardShortcut) -> bool,
) -> Option<Action> {
    let Event::Key {
        key,
        modifiers,
        pressed: true,
        ..
    } = event
    else {
        return None;
    };
    keys.action_of(*key, *modifiers, is_allowed)
}

/// Copies the value of the row under the pointer, or the preset, and pastes.
fn clipboard(ctx: &egui::Context, state: &State, commands: &Commands) {
    for event in ctx.input(|i| i.events.clone()) {
        match event {
            Event::Copy => match &state.clipboard.hovered_row {
                Some((_, value)) => commands.row(RowCommand::Copy(value.clone())),
                None => commands.perform(Action::CopyPreset),
            },
            Event::Paste(text) => commands.run(move |app| paste(app, &text)),
            _ => {}
        }
    }
}

/// Opens one of the files that were dropped on the window. A page reads them first.
pub fn dropped_files(ctx: &egui::Context, state: &State, commands: &Commands) {
    let dropped = ctx.input(|i| i.raw.dropped_files.clone());
    if dropped.is_empty() {
        return;
    }
    #[cfg(target_arch = "wasm32")]
    state.jobs.take_dropped(dropped);
    #[cfg(not(target_arch = "wasm32"))]
    {
        let paths = dropped.iter().map(|file| file.path().to_owned());
        open_given(paths.collect(), commands);
    }
    let _ = (state, commands); // Each target needs one of them.
}

/// Opens one of the files that were given to the window at once: a preset before a model before a
/// picture before an effect, since a model may be given with the files that it needs.
pub fn open_given(mut dropped: Vec<PathBuf>, commands: &Commands) {
    let rank = |path: &PathBuf| {
        let extension = path
            .extension()
            .map(|extension| extension.to_ascii_lowercase());
        let order = system_dialog::extensions(Purpose::Open);
        order
            .iter()
            .position(|known| extension.as_ref().is_some_and(|e| e == known))
            .unwrap_or(usize::MAX)
    };
    dropped.sort_by_key(rank);
    let Some(first) = dropped.first() else { return };
    commands.open(first.to_string_lossy().into_owned());
    if dropped.len() > 1 {
        let name = first.file_name().unwrap_or_default().to_string_lossy();
        let text = format!(
            "{} files were dropped. One is opened at a time: {name}",
            dropped.len()
        );
        commands.notify(Level::Info, text);
    }
}

/// Takes files that a page was given, which lie in its memory now.
#[cfg(target_arch = "wasm32")]
pub fn take_given(
    app: &mut crate::app::App,
    given: Result<crate::app::shell::page::Given, String>,
) {
    match given {
        Ok(given) if given.is_export => crate::app::files::take_along::import(app),
        Ok(given) => open_given(given.paths, &app.commands),
        Err(error) => app.notify(Level::Error, error),
    }
}
