//! Edits of the preset as a whole: opening, undo, resets, copy and paste. Each is a step of its own.

use std::path::PathBuf;

use eframe::egui;

use super::{App, FileId, Level, Playback, Timeline, UndoState, fields::Ask};
use crate::{
    effects::Effect,
    preset_file::{self, PresetFile},
};

impl App {
    /// Makes `look` the open one, as a step of its own.
    pub(super) fn open_preset(&mut self, preset_file: PresetFile) {
        self.history.close();
        for warning in &preset_file.warnings {
            self.log.add(Level::Warning, warning.clone());
        }
        self.files.insert(FileId::of(&preset_file), preset_file.clone());
        self.muted.clear();
        self.playback = Playback::default();
        self.timeline = Timeline::default();
        self.preset_file = preset_file;
        self.observe(false);
        self.history.close();
    }

    /// Opens whatever a person may name or drop.
    pub(super) fn open(&mut self, what: &str) {
        match preset_file::open(what, self.options.presets_dir.as_deref()) {
            Ok(preset_file) => {
                let title = preset_file.title().to_owned();
                self.open_preset(preset_file);
                self.tell(Level::Info, format!("Opened {title}"));
            }
            Err(error) => self.tell(Level::Error, error.to_string()),
        }
    }

    /// Files dropped on the window. One is opened: a preset before a model before a picture, so that a model comes with
    /// whatever lies beside it.
    pub(super) fn take_drops(&mut self, ctx: &egui::Context) {
        let mut dropped = ctx.input(|i| i.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect::<Vec<_>>());
        let rank = |path: &PathBuf| {
            let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
            ["toml", "glb", "gltf", "png"].iter().position(|known| extension.as_ref().is_some_and(|e| e == known)).unwrap_or(usize::MAX)
        };
        dropped.sort_by_key(rank);
        let Some(first) = dropped.first() else { return };
        self.open(&first.to_string_lossy());
        if dropped.len() > 1 {
            let name = first.file_name().unwrap_or_default().to_string_lossy().into_owned();
            self.tell(Level::Info, format!("{} files were dropped and one is opened at a time: {name}", dropped.len()));
        }
    }

    pub(super) fn observe(&mut self, held: bool) {
        let PresetFile { id, path, preset, .. } = &self.preset_file;
        self.history.observe(&UndoState { file: FileId { id: id.clone(), path: path.clone() }, preset: preset.clone() }, self.now_s, held);
    }

    pub(super) fn restore(&mut self, moment: Option<UndoState>, what: &str) {
        let Some(UndoState { file, preset }) = moment else {
            return self.tell(Level::Info, format!("Nothing to {what}"));
        };
        if FileId::of(&self.preset_file) != file {
            if let Some(preset_file) = self.files.get(&file) {
                self.preset_file = preset_file.clone();
            }
            self.tell(Level::Info, format!("Back to {}", if preset.name.is_empty() { &file.id } else { &preset.name }));
        }
        self.preset_file.preset = preset;
    }

    /// Carries out what a person asked of a row.
    pub(super) fn answer(&mut self, ctx: &egui::Context, ask: Ask) {
        self.history.close();
        let outcome = match ask {
            Ask::Reset(path) => preset_file::unset(&mut self.preset_file, &path).map_err(|e| e.to_string()),
            Ask::ResetGroup(group) => self.reset_group(&group),
            Ask::Key(path) => {
                self.toggle_key(&path);
                Ok(())
            }
            Ask::Copy(text) => {
                ctx.copy_text(text.clone());
                self.tell(Level::Info, format!("Copied {text}"));
                Ok(())
            }
            Ask::Paste(path) => {
                self.paste_into = Some(path);
                ctx.send_viewport_cmd(egui::ViewportCommand::RequestPaste);
                Ok(())
            }
        };
        if let Err(error) = outcome {
            self.tell(Level::Error, error);
        }
    }

    pub(super) fn reset_group(&mut self, group: &str) -> Result<(), String> {
        match Effect::find(group) {
            Some(effect) => {
                self.preset_file.preset.animation.remove_effect(group);
                if let Some(enabled) = self.preset_file.preset.stack.get_mut(group) {
                    enabled.words = (effect.defaults)();
                }
                Ok(())
            }
            None => preset_file::unset(&mut self.preset_file, group).map_err(|e| e.to_string()),
        }
    }

    /// Text from the clipboard: a value for a row, or a preset.
    pub(super) fn paste(&mut self, text: &str) {
        self.history.close();
        let row = self.paste_into.take().or_else(|| self.hovered_row.as_ref().map(|(path, _)| path.clone()));
        let is_preset = text.trim_start().starts_with("rasterlab1:");
        match row {
            Some(path) if !is_preset => match self.put_text(&path, text.trim()) {
                Ok(()) => self.tell(Level::Info, format!("{path} = {}", text.trim())),
                Err(error) => self.tell(Level::Error, error.to_string()),
            },
            _ => match preset_file::from_line(text) {
                Ok(preset_file) => {
                    self.open_preset(preset_file);
                    self.tell(Level::Info, "Pasted a preset");
                }
                Err(error) => self.tell(Level::Error, error.to_string()),
            },
        }
    }
}
