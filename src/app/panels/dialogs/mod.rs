//! Dialogs inside the window, one at a time.

pub(super) mod buttons;
mod path;
pub mod places;
mod purpose;
mod questions;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use egui::Ui;

use self::{
    buttons::{Choice, buttons},
    path::{PathDialog, path_ui},
    questions::{brought_ui, changed_ui, muted_ui, outside_ui, restore_ui, unsaved_ui},
};
use super::new_effect::{NewEffect, fields_ui};
use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::new_effect::create,
        editing::session::Session,
        files::apply::quit,
        files::apply::resolve,
        files::apply::save,
        files::apply::use_code,
        files::apply::use_outside,
        files::apply::write,
        files::open::restore,
        files::{
            command::{CodeUse, Manner, Origin, Purpose},
            completion::Listing,
            system_dialog::Answer,
        },
        settings::last_session::Restored,
        shell::{command::Commands, state::State},
        widgets::panel::modal,
    },
    effect_files::Catalog,
    effects::Effect,
    preset_file::{self, PresetFile},
};

/// The dialog that is open.
enum Dialog {
    Path(Box<PathDialog>),
    /// Save with muted effects enabled, or without them?
    Muted {
        path: PathBuf,
        name: Option<String>,
    },
    /// Quit with unsaved changes?
    Unsaved,
    NewEffect(NewEffect),
    /// May the code that a preset brings run?
    Code(Box<PresetFile>, CodeUse),
    /// May the model be read that a picture or a pasted line names outside of its folder? What is
    /// said of it afterwards.
    Outside(Box<PresetFile>, Manner, String),
    /// Keep unsaved changes, or take what the preset's file has now, or both? It is saved to the
    /// path afterwards.
    Changed(Box<PresetFile>, Option<PathBuf>),
    /// Go on with the session that a crash ended?
    Restore(Box<Restored>),
}

/// The open dialog, if any.
#[derive(Default)]
pub struct Dialogs {
    open: Option<Dialog>,
    /// The dialog that a save was asked for with. It comes back if the save fails.
    saving: Option<PathDialog>,
}

impl Dialogs {
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Does the open dialog have a field for text?
    pub fn takes_text(&self) -> bool {
        matches!(self.open, Some(Dialog::Path(_) | Dialog::NewEffect(_)))
    }

    /// Asks for a path. `presets_dir` is the folder of presets from the command line; a picture is
    /// exported at `size` pixels unless another size is typed.
    pub fn ask_path(
        &mut self,
        purpose: Purpose,
        session: &Session,
        presets_dir: Option<&Path>,
        size: [u32; 2],
    ) {
        let id = &session.preset_file.id;
        let text = match purpose {
            Purpose::Open => {
                presets_dir.map_or_else(String::new, |folder| format!("{}/", folder.display()))
            }
            Purpose::SaveAs => {
                let id = if id.is_empty() { "preset" } else { id };
                let is_builtin =
                    session.preset_file.path.is_none() && session.preset_file.read_only;
                let name = if is_builtin {
                    format!("my-{id}")
                } else {
                    id.to_owned()
                };
                save_folder(session, presets_dir)
                    .join(format!("{name}.toml"))
                    .display()
                    .to_string()
            }
            Purpose::Export | Purpose::Sheet => {
                let end = if purpose == Purpose::Sheet {
                    "-sweep"
                } else {
                    ""
                };
                std::env::current_dir()
                    .unwrap_or_default()
                    .join(format!("{id}{end}.png"))
                    .display()
                    .to_string()
            }
        };
        // Its own file keeps its name, and so does a look on a model that has none yet.
        let own_name = (!session.preset_file.read_only).then(|| {
            let path = session.preset_file.path.clone();
            (
                path.unwrap_or_else(|| PathBuf::from(&text)),
                session.title().to_owned(),
            )
        });
        let dialog = PathDialog::new(purpose, text, size).with_own_name(own_name);
        self.open = Some(Dialog::Path(dialog.into()));
    }

    /// Asks whether muted effects are saved to `path` too.
    pub fn ask_muted(&mut self, path: PathBuf, name: Option<String>) {
        self.open = Some(Dialog::Muted { path, name });
    }

    /// Asks whether to save before the window closes.
    pub fn ask_unsaved(&mut self) {
        self.open = Some(Dialog::Unsaved);
    }

    /// Asks for the name of a new effect, and for its hook unless it is a duplicate of
    /// `duplicated`. Its file is written into `folder`.
    pub fn ask_new_effect(
        &mut self,
        duplicated: Option<Arc<Effect>>,
        catalog: &Catalog,
        folder: PathBuf,
    ) {
        self.open = Some(Dialog::NewEffect(NewEffect::new(
            duplicated, catalog, folder,
        )));
    }

    /// Asks what becomes of unsaved changes and of `theirs`, the open preset as its file has it
    /// now. The outcome is saved to `saving`. A file that changes once more while that is asked
    /// leaves the question as it is, with the newer file.
    pub fn ask_changed(&mut self, theirs: Box<PresetFile>, saving: Option<PathBuf>) {
        let asked = match self.open.take() {
            Some(Dialog::Changed(_, asked)) => asked,
            _ => None,
        };
        self.open = Some(Dialog::Changed(theirs, saving.or(asked)));
    }

    /// Asks whether the effects that `preset_file` brings may run.
    pub fn ask_code(&mut self, preset_file: Box<PresetFile>, then: CodeUse) {
        self.open = Some(Dialog::Code(preset_file, then));
    }

    /// Asks whether the model of `preset_file`, which lies outside of its folder, is opened.
    pub fn ask_outside(&mut self, preset_file: Box<PresetFile>, manner: Manner, said: String) {
        self.open = Some(Dialog::Outside(preset_file, manner, said));
    }

    /// Asks whether to go on with the session that a crash ended.
    pub fn ask_restore(&mut self, restored: Box<Restored>) {
        self.open = Some(Dialog::Restore(restored));
    }

    /// Is the question open what is to happen with the session that a crash ended?
    pub fn asks_restore(&self) -> bool {
        matches!(self.open, Some(Dialog::Restore(_)))
    }

    /// A save to `path` failed: shows its dialog again, with the path and the reason. Returns false
    /// if another dialog is open.
    pub fn save_failed(&mut self, purpose: Purpose, path: &Path, reason: &str) -> bool {
        if self.is_open() {
            return false;
        }
        let kept = self
            .saving
            .take()
            .filter(|saving| saving.purpose == purpose && saving.path() == path);
        let mut dialog =
            kept.unwrap_or_else(|| PathDialog::new(purpose, path.display().to_string(), [1, 1]));
        (dialog.error, dialog.replace) = (Some(reason.to_owned()), None);
        self.open = Some(Dialog::Path(dialog.into()));
        true
    }

    /// Takes the contents of a folder.
    pub fn folder_arrived(&mut self, listing: Listing) {
        if let Some(Dialog::Path(dialog)) = &mut self.open {
            dialog.folder_arrived(listing);
        }
    }

    /// Takes the answer of the system's dialog.
    pub fn path_arrived(
        &mut self,
        purpose: Purpose,
        answer: Answer,
        open: &PresetFile,
        commands: &Commands,
    ) {
        let Some(Dialog::Path(dialog)) = &mut self.open else {
            return;
        };
        if dialog.purpose != purpose {
            return;
        }
        dialog.is_browsing = false;
        match answer {
            Answer::Chosen(path) => {
                dialog.text = path.display().to_string();
                dialog.replace = Some(path); // The system's dialog has asked whether to replace it.
                self.choose(Choice::Accept, open, commands);
            }
            Answer::Canceled => {}
            Answer::Unavailable(reason) => dialog.no_system_dialog = Some(reason),
        }
    }

    /// Carries out the choice of a button. The dialog stays open if the choice leads to another
    /// question in it.
    fn choose(&mut self, choice: Choice, open: &PresetFile, commands: &Commands) {
        match (choice, self.open.take()) {
            (Choice::Cancel, _) | (_, None) => {}
            (Choice::Browse, Some(Dialog::Path(mut dialog))) => {
                let (purpose, path) = (dialog.purpose, PathBuf::from(&dialog.text));
                commands.run(move |app| app.state.jobs.ask_path(purpose, &path));
                dialog.is_browsing = true;
                self.open = Some(Dialog::Path(dialog));
            }
            (Choice::Accept, Some(Dialog::Path(mut dialog))) => {
                if dialog.accept(open.path.as_deref(), commands) {
                    self.saving = Some(*dialog).filter(|dialog| dialog.purpose != Purpose::Open);
                } else {
                    self.open = Some(Dialog::Path(dialog));
                }
            }
            (Choice::KeepMuted, Some(Dialog::Muted { path, name })) => {
                commands.run(move |app| write(app, &path, name));
            }
            (Choice::DropMuted, Some(Dialog::Muted { path, name })) => {
                commands.run(move |app| {
                    app.state.session.drop_muted();
                    write(app, &path, name);
                });
            }
            (Choice::Save, Some(Dialog::Unsaved)) => commands.run(save),
            (Choice::Keep, Some(Dialog::Unsaved)) => commands.run(|app| quit(app, true)),
            (Choice::Discard, Some(Dialog::Unsaved)) => commands.run(|app| quit(app, false)),
            (Choice::Restore, Some(Dialog::Restore(restored))) => {
                commands.run(|app| restore(app, *restored));
            }
            (Choice::Discard, Some(Dialog::Restore(_))) => {}
            (Choice::Accept, Some(Dialog::NewEffect(mut dialog))) => {
                if dialog.check(&open.effects) {
                    commands.run(move |app| create(&mut app.state, &dialog.name, dialog.origin));
                } else {
                    self.open = Some(Dialog::NewEffect(dialog));
                }
            }
            (Choice::Run | Choice::OpenWithout, Some(Dialog::Code(preset_file, then))) => {
                let runs = choice == Choice::Run;
                commands.run(move |app| use_code(app, *preset_file, then, runs));
            }
            (
                Choice::OpenModel | Choice::LookOnly,
                Some(Dialog::Outside(preset_file, manner, said)),
            ) => {
                let opens_model = choice == Choice::OpenModel;
                commands.run(move |app| use_outside(app, *preset_file, manner, said, opens_model));
            }
            (Choice::Side(side), Some(Dialog::Changed(theirs, saving))) => {
                commands.run(move |app| resolve(app, theirs, side, saving));
            }
            (_, dialog) => self.open = dialog,
        }
    }
}

impl Panel for Dialogs {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let Some(dialog) = &mut self.open else { return };
        if let Dialog::Path(dialog) = dialog {
            dialog.request_folder(commands);
        }
        let mut chosen = None;
        let modal = modal(ui.ctx(), "dialog", 16.0).show(ui.ctx(), |ui| {
            ui.set_width(460.0f32.min(ui.ctx().content_rect().width() - 64.0));
            chosen = match dialog {
                Dialog::Path(dialog) => path_ui(
                    ui,
                    dialog,
                    &state.settings.recents,
                    &state.files.missing_files,
                ),
                Dialog::Muted { .. } => muted_ui(ui, &state.session.muted),
                Dialog::Unsaved => {
                    unsaved_ui(ui, state.session.title(), state.closing.keeps_session)
                }
                Dialog::NewEffect(dialog) => new_effect_ui(ui, dialog),
                Dialog::Changed(theirs, saving) => changed_ui(ui, theirs.title(), saving.is_some()),
                Dialog::Code(preset_file, _) => brought_ui(ui, preset_file),
                Dialog::Outside(preset_file, ..) => outside_ui(ui, preset_file),
                Dialog::Restore(restored) => restore_ui(ui, restored),
            };
        });
        // What a crash left is not thrown away by a click beside the question.
        if chosen.is_none() && modal.should_close() && !matches!(dialog, Dialog::Restore(_)) {
            chosen = Some(Choice::Cancel);
        }
        if let Some(choice) = chosen {
            self.choose(choice, &state.session.preset_file, commands);
        }
    }
}

/// The folder that presets are saved to by default.
fn save_folder(session: &Session, presets_dir: Option<&Path>) -> PathBuf {
    let open = &session.preset_file;
    let own = open
        .path
        .as_deref()
        .and_then(Path::parent)
        .filter(|_| !open.read_only)
        .map(Path::to_owned);
    own.or_else(|| presets_dir.map(Path::to_owned))
        .or_else(preset_file::user_folder)
        .unwrap_or_default()
}

fn new_effect_ui(ui: &mut Ui, dialog: &mut NewEffect) -> Option<Choice> {
    let is_entered = fields_ui(ui, dialog);
    let verb = if matches!(dialog.origin, Origin::Duplicate(_)) {
        "Duplicate"
    } else {
        "Create"
    };
    let choice = buttons(
        ui,
        &[
            (verb, Choice::Accept, true),
            ("Cancel", Choice::Cancel, false),
        ],
        |_| None,
    );
    is_entered.then_some(Choice::Accept).or(choice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_changes_while_a_save_asks_does_not_turn_the_question_into_one_that_saves_nothing()
     {
        let mut dialogs = Dialogs::default();
        let theirs = |name: &str| {
            Box::new(
                preset_file::open(name, &preset_file::Folders::default())
                    .expect("a built-in preset"),
            )
        };
        dialogs.ask_changed(theirs("facet"), Some("mine.toml".into()));
        dialogs.ask_changed(theirs("fog"), None);
        let Some(Dialog::Changed(theirs, Some(path))) = dialogs.open else {
            panic!("nothing is saved any more")
        };
        assert_eq!((theirs.id.as_str(), path), ("fog", "mine.toml".into()));
    }
}
