//! Dialogs inside the window. A path can always be typed; the system's own dialog is an extra, since a bare desktop
//! may have none.

use std::path::{Path, PathBuf};

use eframe::egui::{self, RichText, Ui};

use super::{App, Level, theme};
use crate::preset_file;

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    SaveAs,
    Export,
}

impl Purpose {
    const fn title(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::SaveAs => "Save look as",
            Self::Export => "Export PNG",
        }
    }

    const fn hint(self) -> &'static str {
        match self {
            Self::Open => "A preset (.toml), a model (.glb, .gltf), one of our pictures (.png), a preset's id, or builtin:teapot",
            Self::SaveAs => "Presets in the suggested folder appear in the gallery",
            Self::Export => "The picture carries its preset: drop it here later to get it back",
        }
    }

    const fn verb(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::SaveAs | Self::Export => "Save",
        }
    }

    /// For the system's dialog: names and extensions.
    pub const fn filters(self) -> &'static [(&'static str, &'static [&'static str])] {
        match self {
            Self::Open => &[("Presets, models, pictures", &["toml", "glb", "gltf", "png"])],
            Self::SaveAs => &[("Presets", &["toml"])],
            Self::Export => &[("Pictures", &["png"])],
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
pub enum Dialog {
    Path {
        purpose: Purpose,
        text: String,
        /// Width and height of an export, pixels.
        size: [u32; 2],
        /// The path whose existing file may be replaced, once the user agreed.
        replace: Option<PathBuf>,
        /// The system's dialog is open.
        browsing: bool,
        error: Option<String>,
    },
    /// Save with muted effects on, or without them?
    Muted { path: PathBuf },
    /// Quit with unsaved changes?
    Unsaved,
}

/// Longest side of an exported picture, pixels: the readback of one stays below 512 MiB.
const MAX_EXPORT_SIDE: u32 = 8192;

impl Dialog {
    pub fn open(folder: Option<&Path>) -> Self {
        let text = folder.map_or_else(String::new, |folder| format!("{}/", folder.display()));
        Self::of(Purpose::Open, text, [0; 2])
    }

    fn of(purpose: Purpose, text: String, size: [u32; 2]) -> Self {
        Self::Path { purpose, text, size, replace: None, browsing: false, error: None }
    }
}

impl App {
    /// Saves to the preset's own file; a built-in or new preset asks for one.
    pub(super) fn save(&mut self) {
        match self.preset_file.path.clone().filter(|_| !self.preset_file.read_only) {
            Some(path) => self.save_to(path),
            None => self.ask_save_as(),
        }
    }

    pub(super) fn ask_save_as(&mut self) {
        let folder = self.folder();
        let id = if self.preset_file.id.is_empty() { "preset" } else { &self.preset_file.id };
        let name = if self.preset_file.path.is_none() && self.preset_file.read_only { format!("my-{id}") } else { id.to_owned() };
        self.dialog = Some(Dialog::of(Purpose::SaveAs, folder.join(format!("{name}.toml")).display().to_string(), [0; 2]));
    }

    pub(super) fn ask_export(&mut self) {
        let folder = std::env::current_dir().unwrap_or_default();
        let size =
            self.motion.wanted.as_ref().map_or(self.preset_file.preset.output.size, |inputs| [inputs.view.width, inputs.view.height]);
        self.dialog = Some(Dialog::of(Purpose::Export, folder.join(format!("{}.png", self.preset_file.id)).display().to_string(), size));
    }

    /// Where looks go by default.
    fn folder(&self) -> PathBuf {
        let own = self.preset_file.path.as_deref().and_then(Path::parent).filter(|_| !self.preset_file.read_only).map(Path::to_owned);
        own.or_else(|| self.options.presets_dir.clone()).or_else(preset_file::user_folder).unwrap_or_default()
    }

    fn save_to(&mut self, path: PathBuf) {
        if self.muted.is_empty() {
            self.write_preset(&path);
        } else {
            self.dialog = Some(Dialog::Muted { path });
        }
    }

    fn write_preset(&mut self, path: &Path) {
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty())
            && let Err(error) = std::fs::create_dir_all(folder)
        {
            return self.tell(Level::Error, format!("{}: cannot be made: {error}", folder.display()));
        }
        match preset_file::save(&mut self.preset_file, path) {
            Ok(()) => {
                self.files.insert(super::FileId::of(&self.preset_file), self.preset_file.clone());
                let id = self.preset_file.id.clone();
                self.preset_browser.refresh(self.options.presets_dir.as_deref(), &id);
                self.tell(Level::Info, format!("Saved {}", path.display()));
            }
            Err(error) => self.tell(Level::Error, error.to_string()),
        }
    }

    /// The system's dialog has answered.
    pub(super) fn path_arrived(&mut self, purpose: Purpose, path: Option<PathBuf>) {
        if let Some(Dialog::Path { purpose: asked, text, browsing, replace, .. }) = &mut self.dialog
            && *asked == purpose
        {
            *browsing = false;
            if let Some(path) = path {
                *text = path.display().to_string();
                *replace = Some(path); // That dialog has asked already.
                self.accept(purpose);
            }
        }
    }

    pub(super) fn dialog_ui(&mut self, ctx: &egui::Context) {
        let Some(dialog) = &mut self.dialog else { return };
        let mut chosen = None;
        let frame = egui::Frame::window(&ctx.global_style()).inner_margin(16.0);
        let modal = egui::Modal::new(egui::Id::unique("dialog")).frame(frame).show(ctx, |ui| {
            ui.set_width(460.0);
            chosen = match dialog {
                Dialog::Path { purpose, text, size, replace, browsing, error } => {
                    path_ui(ui, *purpose, text, size, replace, *browsing, error.as_deref())
                }
                Dialog::Muted { .. } => muted_ui(ui, &self.muted.iter().copied().collect::<Vec<_>>()),
                Dialog::Unsaved => unsaved_ui(ui, self.preset_file.title()),
            };
        });
        if chosen.is_none() && modal.should_close() {
            chosen = Some(Choice::Cancel);
        }
        if let Some(choice) = chosen {
            self.choose(ctx, choice);
        }
    }

    fn choose(&mut self, ctx: &egui::Context, choice: Choice) {
        match (choice, self.dialog.take()) {
            (Choice::Cancel, _) | (_, None) => {}
            (Choice::Browse, Some(Dialog::Path { purpose, text, size, replace, error, .. })) => {
                self.jobs.ask_path(purpose, PathBuf::from(&text));
                self.dialog = Some(Dialog::Path { purpose, text, size, replace, browsing: true, error });
            }
            (Choice::Accept, Some(dialog @ Dialog::Path { purpose, .. })) => {
                self.dialog = Some(dialog);
                self.accept(purpose);
            }
            (choice @ (Choice::KeepMuted | Choice::DropMuted), Some(Dialog::Muted { path })) => {
                if choice == Choice::DropMuted {
                    let muted = std::mem::take(&mut self.muted);
                    muted.into_iter().for_each(|name| self.preset_file.preset.disable(name));
                }
                self.write_preset(&path);
            }
            (Choice::Save, Some(Dialog::Unsaved)) => self.save(),
            (Choice::Discard, Some(Dialog::Unsaved)) => {
                self.may_quit = true;
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
            (_, dialog) => self.dialog = dialog,
        }
    }

    /// Does what the path was asked for; the dialog stays open with a sentence when it cannot be done.
    fn accept(&mut self, purpose: Purpose) {
        let Some(Dialog::Path { text, size, replace, error, .. }) = &mut self.dialog else { return };
        let typed = text.trim().to_owned();
        if typed.is_empty() {
            *error = Some("Type a path first.".into());
            return;
        }
        if purpose == Purpose::Open {
            self.dialog = None;
            return self.open(&typed);
        }
        let path = with_extension(Path::new(&typed), purpose.extension());
        if path.exists() && replace.as_deref() != Some(&path) && self.preset_file.path.as_deref() != Some(&path) {
            *error = Some(format!("{} exists. Save once more to replace it.", path.display()));
            *replace = Some(path);
            return;
        }
        let size = *size;
        self.dialog = None;
        match purpose {
            Purpose::SaveAs => self.save_to(path),
            Purpose::Export => self.export(path, size),
            Purpose::Open => unreachable!("opened above"),
        }
    }

    fn export(&mut self, path: PathBuf, size: [u32; 2]) {
        let (Some((_, scene)), Some(wanted)) = (&self.scene_loader.shown, &self.motion.wanted) else {
            return self.tell(Level::Error, "There is no picture to export yet");
        };
        let inputs = super::Inputs { view: self.view_at(scene, size), ..wanted.clone() };
        let mut preset_file = self.preset_file.clone();
        preset_file.preset = self.shown_preset();
        self.jobs.shot(self.screen.gpu.clone(), inputs, preset_file, path);
    }
}

/// What a dialog was answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    Cancel,
    Accept,
    Browse,
    KeepMuted,
    DropMuted,
    Save,
    Discard,
}

fn path_ui(
    ui: &mut Ui,
    purpose: Purpose,
    text: &mut String,
    size: &mut [u32; 2],
    replace: &Option<PathBuf>,
    browsing: bool,
    error: Option<&str>,
) -> Option<Choice> {
    ui.label(RichText::new(purpose.title()).size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(theme::weak(purpose.hint()));
    ui.add_space(theme::HALF);
    let field = ui.add(egui::TextEdit::singleline(text).hint_text("Path").desired_width(f32::INFINITY)).accessible_name("Path");
    let entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    if !entered && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    if purpose == Purpose::Export {
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
        let text = if browsing { "Waiting for the system's dialog" } else { "Browse…" };
        ui.add_enabled(!browsing, egui::Button::new(text)).clicked().then_some(Choice::Browse)
    });
    if entered {
        choice = Some(Choice::Accept);
    }
    choice
}

fn muted_ui(ui: &mut Ui, muted: &[&str]) -> Option<Choice> {
    ui.label(RichText::new("Some effects are muted").size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(format!("{} cannot be seen now. Muting is a viewing aid and is not saved.", muted.join(", ")));
    ui.add_space(theme::HALF);
    let options = [
        ("Save with them on", Choice::KeepMuted, true),
        ("Remove them and save", Choice::DropMuted, false),
        ("Cancel", Choice::Cancel, false),
    ];
    buttons(ui, &options, |_| None)
}

fn unsaved_ui(ui: &mut Ui, title: &str) -> Option<Choice> {
    ui.label(RichText::new("Save your changes?").size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(format!("{title} has changes that are in no file."));
    ui.add_space(theme::HALF);
    let options = [("Save", Choice::Save, true), ("Quit without saving", Choice::Discard, false), ("Cancel", Choice::Cancel, false)];
    buttons(ui, &options, |_| None)
}

/// Buttons from right to left, the first one emphasized; `left` stands at the other end.
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
            // Appended, so that "look.v2" keeps its dot.
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
        assert_eq!(with_extension(Path::new("a/look"), Some("toml")), Path::new("a/look.toml"));
        assert_eq!(with_extension(Path::new("look.v2"), Some("toml")), Path::new("look.v2.toml"));
        assert_eq!(with_extension(Path::new("look.TOML"), Some("toml")), Path::new("look.TOML"));
    }
}
