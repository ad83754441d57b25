//! Edits of the look as a whole: opening, undo, resets, copy and paste. Each is a step of its own.

use std::path::PathBuf;

use eframe::egui;

use super::{App, FileId, Level, Moment, Playback, Timeline, fields::Ask};
use crate::{
    effects::Effect,
    preset::{self, Look},
};

impl App {
    /// Makes `look` the open one, as a step of its own.
    pub(super) fn open_look(&mut self, look: Look) {
        self.history.close();
        for warning in &look.warnings {
            self.log.add(Level::Warning, warning.clone());
        }
        self.files.insert(FileId::of(&look), look.clone());
        self.muted.clear();
        self.playback = Playback::default();
        self.timeline = Timeline::default();
        self.look = look;
        self.observe(false);
        self.history.close();
    }

    /// Opens whatever a person may name or drop.
    pub(super) fn open(&mut self, what: &str) {
        match preset::open(what, self.options.presets_dir.as_deref()) {
            Ok(look) => {
                let title = look.title().to_owned();
                self.open_look(look);
                self.tell(Level::Info, format!("Opened {title}"));
            }
            Err(error) => self.tell(Level::Error, error.to_string()),
        }
    }

    /// Files dropped on the window. One is opened: a look before a model before a picture, so that a model comes with
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
        let Look { id, path, session, .. } = &self.look;
        self.history.observe(&Moment { file: FileId { id: id.clone(), path: path.clone() }, session: session.clone() }, self.now_s, held);
    }

    pub(super) fn restore(&mut self, moment: Option<Moment>, what: &str) {
        let Some(Moment { file, session }) = moment else {
            return self.tell(Level::Info, format!("Nothing to {what}"));
        };
        if FileId::of(&self.look) != file {
            if let Some(look) = self.files.get(&file) {
                self.look = look.clone();
            }
            self.tell(Level::Info, format!("Back to {}", if session.name.is_empty() { &file.id } else { &session.name }));
        }
        self.look.session = session;
    }

    /// Carries out what a person asked of a row.
    pub(super) fn answer(&mut self, ctx: &egui::Context, ask: Ask) {
        self.history.close();
        let outcome = match ask {
            Ask::Reset(path) => preset::unset(&mut self.look, &path).map_err(|e| e.to_string()),
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
                self.look.session.animation.remove_effect(group);
                if let Some(enabled) = self.look.session.stack.get_mut(group) {
                    enabled.words = (effect.defaults)();
                }
                Ok(())
            }
            None => preset::unset(&mut self.look, group).map_err(|e| e.to_string()),
        }
    }

    /// Text from the clipboard: a value for a row, or a look.
    pub(super) fn paste(&mut self, text: &str) {
        self.history.close();
        let row = self.paste_into.take().or_else(|| self.hovered_row.as_ref().map(|(path, _)| path.clone()));
        let is_look = text.trim_start().starts_with("rasterlab1:");
        match row {
            Some(path) if !is_look => match self.put_text(&path, text.trim()) {
                Ok(()) => self.tell(Level::Info, format!("{path} = {}", text.trim())),
                Err(error) => self.tell(Level::Error, error.to_string()),
            },
            _ => match preset::from_line(text) {
                Ok(look) => {
                    self.open_look(look);
                    self.tell(Level::Info, "Pasted a look");
                }
                Err(error) => self.tell(Level::Error, error.to_string()),
            },
        }
    }
}
