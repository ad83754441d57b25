//! Dialogs inside the window. A path can always be typed; the system's file dialog is optional, since some desktops have none.

use std::path::{Path, PathBuf};

use eframe::egui::{self, RichText, Ui};

use crate::{
    app::{
        command::{CodeUse, Command, Commands, FileCommand, Origin, Purpose, Side},
        panel::Panel,
        panels::{
            brought_code::code_ui,
            new_effect::{NewEffect, fields_ui},
        },
        session::Session,
        state::State,
        theme,
    },
    effect_files::Catalog,
    effects::Effect,
    preset_file::{self, PresetFile},
};

impl Purpose {
    const fn title(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::SaveAs => "Save preset as",
            Self::Export => "Export PNG",
        }
    }

    const fn hint(self) -> &'static str {
        match self {
            Self::Open => {
                "A preset (.toml), a model (.glb, .gltf), an exported picture (.png), an effect (.wgsl), a preset's id, or builtin:teapot"
            }
            Self::SaveAs => "Presets in the suggested folder appear in the list on the left",
            Self::Export => "The picture contains the preset: open the picture to get it back",
        }
    }

    const fn verb(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::SaveAs | Self::Export => "Save",
        }
    }

    /// What a name without an extension gets.
    const fn extension(self) -> Option<&'static str> {
        match self {
            Self::Open => None,
            Self::SaveAs => Some("toml"),
            Self::Export => Some("png"),
        }
    }
}

/// The dialog that is open.
enum Dialog {
    Path(PathDialog),
    /// Save with muted effects enabled, or without them?
    Muted {
        path: PathBuf,
    },
    /// Quit with unsaved changes?
    Unsaved,
    NewEffect(NewEffect),
    /// May the code that a preset brings run?
    Code(Box<PresetFile>, CodeUse),
    /// Keep unsaved changes, or take what the preset's file has now, or both? It is saved to the path afterwards.
    Changed(Box<PresetFile>, Option<PathBuf>),
}

/// A dialog that asks for a path.
struct PathDialog {
    purpose: Purpose,
    text: String,
    /// Width and height of an export, pixels.
    size: [u32; 2],
    /// The existing file that the user has agreed to replace.
    replace: Option<PathBuf>,
    /// The system's dialog is open.
    is_browsing: bool,
    error: Option<String>,
}

impl PathDialog {
    /// Sends the command of the dialog with its path. Returns false, with an error in the dialog, if the path cannot be used.
    fn accept(&mut self, own_path: Option<&Path>, commands: &Commands) -> bool {
        let typed = self.text.trim();
        if typed.is_empty() {
            self.error = Some("Type a path.".into());
            return false;
        }
        let path = with_extension(Path::new(typed), self.purpose.extension());
        let is_free = self.purpose == Purpose::Open || !path.exists();
        if !is_free && self.replace.as_deref() != Some(&path) && own_path != Some(&path) {
            self.error = Some(format!("{} exists. Press Replace to replace it.", path.display()));
            self.replace = Some(path);
            return false;
        }
        commands.send(Command::File(match self.purpose {
            Purpose::Open => FileCommand::Open(typed.to_owned()),
            Purpose::SaveAs => FileCommand::SaveTo(path),
            Purpose::Export => FileCommand::Export { path, size: self.size },
        }));
        true
    }
}

/// Longest side of an exported picture, pixels: its readback stays below 512 MiB.
const MAX_EXPORT_SIDE: u32 = 8192;

/// The open dialog, if any.
#[derive(Default)]
pub struct Dialogs(Option<Dialog>);

impl Dialogs {
    pub fn is_open(&self) -> bool {
        self.0.is_some()
    }

    /// Does the open dialog have a field for text?
    pub fn takes_text(&self) -> bool {
        matches!(self.0, Some(Dialog::Path(_) | Dialog::NewEffect(_)))
    }

    /// Asks for a path. `presets_dir` is the folder of presets from the command line; a picture is exported at `size` pixels
    /// unless another size is typed.
    pub fn ask_path(&mut self, purpose: Purpose, session: &Session, presets_dir: Option<&Path>, size: [u32; 2]) {
        let id = &session.preset_file.id;
        let text = match purpose {
            Purpose::Open => presets_dir.map_or_else(String::new, |folder| format!("{}/", folder.display())),
            Purpose::SaveAs => {
                let id = if id.is_empty() { "preset" } else { id };
                let is_builtin = session.preset_file.path.is_none() && session.preset_file.read_only;
                let name = if is_builtin { format!("my-{id}") } else { id.to_owned() };
                save_folder(session, presets_dir).join(format!("{name}.toml")).display().to_string()
            }
            Purpose::Export => std::env::current_dir().unwrap_or_default().join(format!("{id}.png")).display().to_string(),
        };
        self.0 = Some(Dialog::Path(PathDialog { purpose, text, size, replace: None, is_browsing: false, error: None }));
    }

    /// Asks whether muted effects are saved to `path` too.
    pub fn ask_muted(&mut self, path: PathBuf) {
        self.0 = Some(Dialog::Muted { path });
    }

    /// Asks whether to save before the window closes.
    pub fn ask_unsaved(&mut self) {
        self.0 = Some(Dialog::Unsaved);
    }

    /// Asks for the name of a new effect, and for its hook unless it is a duplicate of `duplicated`.
    pub fn ask_new_effect(&mut self, duplicated: Option<&'static Effect>, catalog: &Catalog) {
        self.0 = Some(Dialog::NewEffect(NewEffect::new(duplicated, catalog)));
    }

    /// Asks what becomes of unsaved changes and of `theirs`, the open preset as its file has it now. The outcome is saved to `saving`.
    pub fn ask_changed(&mut self, theirs: Box<PresetFile>, saving: Option<PathBuf>) {
        self.0 = Some(Dialog::Changed(theirs, saving));
    }

    /// Asks whether the effects that `preset_file` brings may run.
    pub fn ask_code(&mut self, preset_file: Box<PresetFile>, then: CodeUse) {
        self.0 = Some(Dialog::Code(preset_file, then));
    }

    /// Takes the answer of the system's dialog; none if it was canceled.
    pub fn path_arrived(&mut self, purpose: Purpose, path: Option<PathBuf>, own_path: Option<&Path>, commands: &Commands) {
        let Some(Dialog::Path(dialog)) = &mut self.0 else { return };
        if dialog.purpose != purpose {
            return;
        }
        dialog.is_browsing = false;
        if let Some(path) = path {
            dialog.text = path.display().to_string();
            dialog.replace = Some(path); // The system's dialog has asked whether to replace it.
            if dialog.accept(own_path, commands) {
                self.0 = None;
            }
        }
    }

    /// Carries out the choice of a button. The dialog stays open if the choice leads to another question in it.
    fn choose(&mut self, choice: Choice, open: &PresetFile, commands: &Commands) {
        let file = |command| commands.send(Command::File(command));
        match (choice, self.0.take()) {
            (Choice::Cancel, _) | (_, None) => {}
            (Choice::Browse, Some(Dialog::Path(mut dialog))) => {
                file(FileCommand::Browse(dialog.purpose, PathBuf::from(&dialog.text)));
                dialog.is_browsing = true;
                self.0 = Some(Dialog::Path(dialog));
            }
            (Choice::Accept, Some(Dialog::Path(mut dialog))) => {
                if !dialog.accept(open.path.as_deref(), commands) {
                    self.0 = Some(Dialog::Path(dialog));
                }
            }
            (Choice::KeepMuted, Some(Dialog::Muted { path })) => file(FileCommand::Write { path, drops_muted: false }),
            (Choice::DropMuted, Some(Dialog::Muted { path })) => file(FileCommand::Write { path, drops_muted: true }),
            (Choice::Save, Some(Dialog::Unsaved)) => file(FileCommand::Save),
            (Choice::Discard, Some(Dialog::Unsaved)) => file(FileCommand::DiscardAndQuit),
            (Choice::Accept, Some(Dialog::NewEffect(mut dialog))) => {
                if dialog.check(&open.effects) {
                    file(FileCommand::NewEffect { name: dialog.name, origin: dialog.origin });
                } else {
                    self.0 = Some(Dialog::NewEffect(dialog));
                }
            }
            (Choice::Run | Choice::OpenWithout, Some(Dialog::Code(preset_file, then))) => {
                file(FileCommand::UseCode { preset_file, then, runs: choice == Choice::Run });
            }
            (Choice::Side(side), Some(Dialog::Changed(theirs, saving))) => file(FileCommand::Resolve { theirs, side, saving }),
            (_, dialog) => self.0 = dialog,
        }
    }
}

impl Panel for Dialogs {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let Some(dialog) = &mut self.0 else { return };
        let mut chosen = None;
        let frame = egui::Frame::window(&ui.ctx().global_style()).inner_margin(16.0);
        let modal = egui::Modal::new(egui::Id::unique("dialog")).frame(frame).show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            chosen = match dialog {
                Dialog::Path(dialog) => path_ui(ui, dialog),
                Dialog::Muted { .. } => muted_ui(ui, &state.session.muted.iter().copied().collect::<Vec<_>>()),
                Dialog::Unsaved => unsaved_ui(ui, state.session.title()),
                Dialog::NewEffect(dialog) => new_effect_ui(ui, dialog),
                Dialog::Changed(theirs, saving) => changed_ui(ui, theirs.title(), saving.is_some()),
                Dialog::Code(preset_file, _) => brought_ui(ui, preset_file),
            };
        });
        if chosen.is_none() && modal.should_close() {
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
    let own = open.path.as_deref().and_then(Path::parent).filter(|_| !open.read_only).map(Path::to_owned);
    own.or_else(|| presets_dir.map(Path::to_owned)).or_else(preset_file::user_folder).unwrap_or_default()
}

/// The buttons of all dialogs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    Cancel,
    Accept,
    Browse,
    KeepMuted,
    DropMuted,
    Save,
    Discard,
    Side(Side),
    Run,
    OpenWithout,
}

fn path_ui(ui: &mut Ui, dialog: &mut PathDialog) -> Option<Choice> {
    let PathDialog { purpose, text, size, replace, is_browsing, error } = dialog;
    ui.label(RichText::new(purpose.title()).size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(theme::weak(purpose.hint()));
    ui.add_space(theme::HALF);
    let field = ui.add(egui::TextEdit::singleline(text).hint_text("Path").desired_width(f32::INFINITY)).accessible_name("Path");
    let entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    if !entered && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    if *purpose == Purpose::Export {
        ui.horizontal(|ui| {
            ui.label("Size");
            for (side, name) in size.iter_mut().zip(["Width", "Height"]) {
                ui.add(egui::DragValue::new(side).range(1..=MAX_EXPORT_SIDE).suffix(" px")).accessible_name(name);
            }
        });
    }
    if let Some(error) = error {
        theme::notice(ui, theme::AMBER, error);
    }
    ui.add_space(theme::HALF);
    let verb = if replace.is_some() && error.is_some() { "Replace" } else { purpose.verb() };
    let mut choice = buttons(ui, &[(verb, Choice::Accept, true), ("Cancel", Choice::Cancel, false)], |ui| {
        let text = if *is_browsing { "Waiting for the system's dialog" } else { "Browse…" };
        ui.add_enabled(!*is_browsing, egui::Button::new(text)).clicked().then_some(Choice::Browse)
    });
    if entered {
        choice = Some(Choice::Accept);
    }
    choice
}

fn muted_ui(ui: &mut Ui, muted: &[&str]) -> Option<Choice> {
    ui.label(RichText::new("Some effects are muted").size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(format!("{} cannot be seen now. Muting is not saved.", muted.join(", ")));
    ui.add_space(theme::HALF);
    let options = [
        ("Save with them", Choice::KeepMuted, true),
        ("Remove them and save", Choice::DropMuted, false),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options, |_| None)
}

fn unsaved_ui(ui: &mut Ui, title: &str) -> Option<Choice> {
    ui.label(RichText::new("Save your changes?").size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(format!("{title} has unsaved changes."));
    ui.add_space(theme::HALF);
    let options = [("Save", Choice::Save, true), ("Quit without saving", Choice::Discard, false), ("Cancel", Choice::Cancel, false)];
    buttons(ui, &options, |_| None)
}

fn changed_ui(ui: &mut Ui, title: &str, is_saving: bool) -> Option<Choice> {
    ui.label(RichText::new("The preset's file has changed").size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(format!("{title} has unsaved changes, and another program has changed its file."));
    ui.add_space(theme::HALF);
    let weak = "Merge takes both key by key, and yours where both have changed the same. Nothing is written to the file unless you save.";
    ui.label(theme::weak(if is_saving { "Merge takes both key by key, and yours where both have changed the same." } else { weak }));
    ui.add_space(theme::HALF);
    let mine = if is_saving { "Overwrite with mine" } else { "Keep mine" };
    let merge = if is_saving { "Merge and save" } else { "Merge" };
    let options = [
        (merge, Choice::Side(Side::Both), true),
        (mine, Choice::Side(Side::Mine), false),
        ("Take theirs", Choice::Side(Side::Theirs), false),
        ("Cancel", Choice::Cancel, false),
    ];
    // Without a save nothing happens to the file yet, so keeping mine is what cancelling does.
    buttons(ui, if is_saving { &options } else { &options[..3] }, |_| None)
}

fn brought_ui(ui: &mut Ui, preset_file: &PresetFile) -> Option<Choice> {
    code_ui(ui, preset_file);
    let options = [
        ("Run this code", Choice::Run, false),
        ("Open without these effects", Choice::OpenWithout, true),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options, |_| None)
}

fn new_effect_ui(ui: &mut Ui, dialog: &mut NewEffect) -> Option<Choice> {
    let is_entered = fields_ui(ui, dialog);
    let verb = if matches!(dialog.origin, Origin::Duplicate(_)) { "Duplicate" } else { "Create" };
    let choice = buttons(ui, &[(verb, Choice::Accept, true), ("Cancel", Choice::Cancel, false)], |_| None);
    if is_entered { Some(Choice::Accept) } else { choice }
}

/// Buttons from right to left, the main one emphasized; `left` adds one at the other end.
fn buttons(ui: &mut Ui, options: &[(&str, Choice, bool)], left: impl FnOnce(&mut Ui) -> Option<Choice>) -> Option<Choice> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        chosen = left(ui);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for (text, choice, is_main) in options {
                let button = if *is_main { egui::Button::new(*text).fill(theme::ACCENT_GROUND) } else { egui::Button::new(*text) };
                if ui.add(button.min_size(egui::vec2(72.0, theme::ROW))).clicked() {
                    chosen = Some(*choice);
                }
            }
        });
    });
    chosen
}

fn with_extension(path: &Path, extension: Option<&str>) -> PathBuf {
    match extension {
        Some(extension) if path.extension().is_none_or(|there| !there.eq_ignore_ascii_case(extension)) => {
            // Appended, so that `preset.v2` keeps its dot.
            let mut name = path.as_os_str().to_owned();
            name.push(format!(".{extension}"));
            name.into()
        }
        _ => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typed_name_gets_its_extension_once() {
        assert_eq!(with_extension(Path::new("a/preset"), Some("toml")), Path::new("a/preset.toml"));
        assert_eq!(with_extension(Path::new("preset.v2"), Some("toml")), Path::new("preset.v2.toml"));
        assert_eq!(with_extension(Path::new("preset.TOML"), Some("toml")), Path::new("preset.TOML"));
    }
}
