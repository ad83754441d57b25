//! The dialog for paths: a field that completes what is typed, a list of the files that match, and
//! recent files. It needs no service of the desktop; the system's dialog is one button of it.

use std::{
    collections::HashSet,
    path::{Path, PathBuf, is_separator},
};

use egui::{
    self, Align2, Key, Modifiers, RichText, Sense, Ui,
    text::{CCursor, CCursorRange},
    text_edit::TextEditState,
    vec2,
};

use super::{
    buttons::{Choice, buttons},
    places::places_ui,
};
use crate::{
    app::{
        files::apply::{export, save_sheet, save_to},
        files::{
            command::Purpose,
            completion::{self, Entry, Listing},
            system_dialog,
        },
        settings::recents::Recents,
        shell::command::Commands,
        widgets::{form::is_entered, size::size_ui, text::cut_middle, theme},
    },
    preset_file::MAX_NAME,
};

/// Longest side of an exported picture, pixels: its readback stays below 512 MiB.
const MAX_EXPORT_SIDE: u32 = 8192;

/// Height of a row of the list, points, and the rows that are shown without scrolling.
const ROW: f32 = 22.0;
const ROWS: f32 = 8.0;

/// A dialog that asks for a path.
#[derive(Clone)]
pub struct PathDialog {
    pub purpose: Purpose,
    pub text: String,
    /// Name of the preset that is saved, once it was typed; before that it is that of the file.
    name: Option<String>,
    /// The file of the open preset, with the name of that.
    own_name: Option<(PathBuf, String)>,
    /// Width and height of an export, pixels.
    size: [u32; 2],
    /// The existing file that the user has agreed to replace.
    pub replace: Option<PathBuf>,
    /// The system's dialog is open.
    pub is_browsing: bool,
    /// Why there is no system's dialog.
    pub no_system_dialog: Option<String>,
    pub error: Option<String>,
    /// The folder that was asked for, and the newest that was read.
    asked: Option<PathBuf>,
    listing: Option<Listing>,
    /// The row that the arrow keys have chosen.
    chosen: Option<usize>,
    /// The text is a proposal whose name is selected; nothing was typed yet.
    is_proposed: bool,
    /// The text was not typed: the cursor goes to its end, or the name is selected.
    places_cursor: bool,
}

impl PathDialog {
    pub fn new(purpose: Purpose, text: String, size: [u32; 2]) -> Self {
        let no_system_dialog = (!system_dialog::may_exist())
            .then(|| "no desktop service for dialogs runs, and zenity is not installed".to_owned());
        Self {
            purpose,
            text,
            name: None,
            own_name: None,
            size,
            replace: None,
            is_browsing: false,
            no_system_dialog,
            error: None,
            asked: None,
            listing: None,
            chosen: None,
            is_proposed: purpose != Purpose::Open,
            places_cursor: true,
        }
    }

    /// The same with the file of the open preset, which keeps its name there.
    #[must_use]
    pub fn with_own_name(mut self, own_name: Option<(PathBuf, String)>) -> Self {
        self.own_name = own_name;
        self
    }

    /// The name that the saved preset will have.
    fn preset_name(&self) -> String {
        if let Some(typed) = &self.name {
            return typed.clone();
        }
        let path = self.path();
        match &self.own_name {
            Some((own, name)) if *own == path => name.clone(),
            _ => path
                .file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
        }
    }

    /// The file that the dialog names.
    pub fn path(&self) -> PathBuf {
        let path = completion::with_extension(
            &completion::expand_home(self.text.trim()),
            self.purpose.extension(),
        );
        match (self.purpose, path.file_stem(), path.extension()) {
            (Purpose::Open, ..) | (_, None, _) | (_, _, None) => path,
            (_, Some(stem), Some(extension)) => {
                let [stem, extension] = [stem, extension].map(|part| part.to_string_lossy());
                path.with_file_name(format!("{}.{extension}", stem.trim()))
            }
        }
    }

    /// Sends the command of the dialog with its path. Returns false, with an error in the dialog,
    /// if the path cannot be used.
    pub fn accept(&mut self, own_path: Option<&Path>, commands: &Commands) -> bool {
        let typed = self.text.trim();
        if typed.is_empty() {
            self.error = Some("Type a path.".into());
            return false;
        }
        let path = self.path();
        if self.names_missing_file() {
            let text = "does not exist. Go on typing, or choose from the list.";
            self.error = Some(format!("{} {text}", path.display()));
            return false;
        }
        if self.purpose != Purpose::Open {
            let is_unnamed =
                completion::name_of(typed).is_empty() || completion::expand_home(typed).is_dir();
            if is_unnamed {
                self.error = Some(format!(
                    "{typed} is a folder. Type a name for the file behind it."
                ));
                return false;
            }
            if path.exists() && self.replace.as_deref() != Some(&path) && own_path != Some(&path) {
                self.error = Some(format!(
                    "{} exists. Press Replace to replace it.",
                    path.display()
                ));
                self.replace = Some(path);
                return false;
            }
        }
        match self.purpose {
            Purpose::Open if typed.starts_with('~') => {
                commands.open(path.to_string_lossy().into_owned());
            }
            Purpose::Open => commands.open(typed.to_owned()),
            Purpose::SaveAs => {
                let name = self.preset_name().trim().to_owned();
                commands.run(|app| save_to(app, path, Some(name)));
            }
            Purpose::Export => {
                let size = self.size;
                commands.run(move |app| export(app, path, size));
            }
            Purpose::Sheet => commands.run(|app| save_sheet(app, path)),
        }
        true
    }

    /// Is a file to be opened that is not there? What is no path may name a preset.
    fn names_missing_file(&self) -> bool {
        let path = self.path();
        let extension = path.extension().unwrap_or_default();
        let mut known = system_dialog::extensions(self.purpose).into_iter();
        self.purpose == Purpose::Open
            && (self.text.contains(is_separator)
                || known.any(|e| extension.eq_ignore_ascii_case(e)))
            && !self.text.trim_start().starts_with("builtin:")
            && !path.exists()
    }

    /// Takes the contents of a folder.
    pub fn folder_arrived(&mut self, listing: Listing) {
        if self.asked.as_ref() == Some(&listing.folder) {
            self.listing = Some(listing);
        }
    }

    /// Asks for the contents of the folder that is typed, once.
    pub fn request_folder(&mut self, commands: &Commands) {
        let folder = completion::folder_of(&self.text);
        if self.asked.as_ref() != Some(&folder) {
            let listed = folder.clone();
            commands.run(|app| app.state.jobs.list_folder(listed));
            (self.asked, self.listing, self.chosen) = (Some(folder), None, None);
        }
    }

    fn set_text(&mut self, text: String) {
        (self.text, self.places_cursor, self.chosen, self.error) = (text, true, None, None);
        self.is_proposed = false;
    }

    /// The rows of the list.
    fn rows(&self, recents: &Recents) -> Vec<Row> {
        let mut rows = Vec::new();
        if self.purpose == Purpose::Open && self.text.trim().is_empty() {
            rows.extend(recents.iter().map(|path| Row::Recent(path.to_owned())));
        }
        if let Some(listing) = &self.listing {
            // A name that came with the dialog is a proposal; it does not narrow the list.
            let typed = if self.purpose != Purpose::Open && self.names_a_file() {
                self.folder_text()
            } else {
                self.text.as_str()
            };
            let extensions = system_dialog::extensions(self.purpose);
            let mut matches = listing.matches(typed, &extensions);
            if matches.is_empty() && self.purpose == Purpose::Open {
                matches = listing.near(typed, &extensions);
            }
            rows.extend(matches.into_iter().cloned().map(Row::Entry));
        }
        rows
    }

    fn folder_text(&self) -> &str {
        &self.text[..self.text.len() - completion::name_of(&self.text).len()]
    }

    fn names_a_file(&self) -> bool {
        self.purpose.extension().is_some_and(|extension| {
            Path::new(&self.text)
                .extension()
                .is_some_and(|there| there.eq_ignore_ascii_case(extension))
        })
    }

    /// Goes to a folder; the name of a file to be written stays.
    fn go_to(&mut self, folder: &Path) {
        let name = match self.purpose {
            Purpose::Open => "",
            _ => completion::name_of(&self.text),
        };
        self.set_text(folder.join(name).to_string_lossy().into_owned());
    }

    /// Carries out the row that was clicked or entered. A file of *Open* is opened at once; returns
    /// true then.
    fn take(&mut self, row: &Row) -> bool {
        match row {
            Row::Recent(path) => self.set_text(path.to_string_lossy().into_owned()),
            Row::Entry(entry) => self.set_text(completion::with_entry(&self.text, entry)),
        }
        self.purpose == Purpose::Open
            && !matches!(
                row,
                Row::Entry(Entry {
                    is_folder: true,
                    ..
                })
            )
    }
}

/// A row of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Row {
    Recent(PathBuf),
    Entry(Entry),
}

/// Shows the dialog. Returns the button that was pressed.
pub fn path_ui(
    ui: &mut Ui,
    dialog: &mut PathDialog,
    recents: &Recents,
    missing: &HashSet<PathBuf>,
) -> Option<Choice> {
    ui.label(
        RichText::new(dialog.purpose.title())
            .size(15.0)
            .color(theme::text_strong())
            .strong(),
    );
    ui.label(theme::weak(dialog.purpose.hint()));
    ui.add_space(theme::HALF);
    let rows = dialog.rows(recents);
    let mut is_accepted = field_ui(ui, dialog, &rows);
    if cfg!(not(target_arch = "wasm32"))
        && let Some(folder) = places_ui(ui, recents)
    {
        dialog.go_to(&folder);
    }
    is_accepted |= list_ui(ui, dialog, &rows, missing);
    if dialog.purpose == Purpose::SaveAs {
        let mut name = dialog.preset_name();
        ui.horizontal(|ui| {
            ui.label("Name");
            let edit = egui::TextEdit::singleline(&mut name)
                .char_limit(MAX_NAME)
                .desired_width(f32::INFINITY);
            let field = ui.add(edit).accessible_name("Name");
            if field.changed() {
                dialog.name = Some(name);
            }
            is_accepted |= field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        });
    }
    if dialog.purpose == Purpose::Export {
        ui.horizontal(|ui| {
            ui.label("Size");
            drop(size_ui(
                ui,
                "the picture",
                &mut dialog.size,
                1,
                MAX_EXPORT_SIDE,
            ));
        });
    }
    if let Some(error) = &dialog.error {
        theme::notice(ui, theme::amber(), error);
    }
    if let Some(reason) = &dialog.no_system_dialog {
        let text = match cfg!(target_arch = "wasm32") {
            true => "The browser puts the file among its downloads.".to_owned(),
            false => format!(
                "The system's file dialog is not available: {reason}. Type a path or choose from the list; Tab completes."
            ),
        };
        ui.label(theme::weak(text).size(12.0));
    }
    let verb = if dialog.replace.is_some() && dialog.error.is_some() {
        "Replace"
    } else {
        dialog.purpose.verb()
    };
    let choice = buttons(
        ui,
        &[
            (verb, Choice::Accept, true),
            ("Cancel", Choice::Cancel, false),
        ],
        |ui| {
            if dialog.no_system_dialog.is_some() {
                return None;
            }
            let text = if dialog.is_browsing {
                "Waiting for the system's dialog"
            } else {
                "Browse…"
            };
            ui.add_enabled(!dialog.is_browsing, egui::Button::new(text))
                .clicked()
                .then_some(Choice::Browse)
        },
    );
    is_accepted.then_some(Choice::Accept).or(choice)
}

/// The field for the path. Returns true if what is entered in it is the answer.
fn field_ui(ui: &mut Ui, dialog: &mut PathDialog, rows: &[Row]) -> bool {
    let id = ui.scope_id().with("path");
    if ui.memory(|memory| memory.has_focus(id)) {
        keys(ui, dialog, rows);
    }
    let before = dialog.text.clone();
    // The field keeps Tab for completion.
    let edit = egui::TextEdit::singleline(&mut dialog.text)
        .id(id)
        .hint_text("Path")
        .desired_width(f32::INFINITY)
        .lock_focus(true);
    let field = ui.add(edit).accessible_name("Path");
    if dialog.text != before {
        (dialog.error, dialog.chosen) = (None, None);
        begin_anew(ui.ctx(), id, dialog, &before);
    }
    let entered = is_entered(ui, &field);
    if std::mem::take(&mut dialog.places_cursor) {
        place_cursor(ui.ctx(), id, dialog);
    }
    entered
        && match (dialog.chosen.and_then(|at| rows.get(at)), rows) {
            (Some(row), _) => dialog.take(row),
            // The only one that can be meant.
            (None, [row]) if dialog.names_missing_file() => dialog.take(row),
            _ => !enter_folder(dialog),
        }
}

/// The first edit of a proposed path: an absolute path, or one of the home folder, in place of the
/// selected name begins anew.
fn begin_anew(ctx: &egui::Context, id: egui::Id, dialog: &mut PathDialog, before: &str) {
    if !std::mem::take(&mut dialog.is_proposed) {
        return;
    }
    let folder = &before[..before.len() - completion::name_of(before).len()];
    let is_path = |behind: &&str| {
        behind.starts_with(is_separator)
            || behind.starts_with('~')
            || Path::new(behind).is_absolute()
    };
    let Some(behind) = dialog
        .text
        .strip_prefix(folder)
        .filter(is_path)
        .map(str::to_owned)
    else {
        return;
    };
    dialog.text = behind;
    let mut state = TextEditState::load(ctx, id).unwrap_or_default();
    if let Some(range) = state.cursor.char_range() {
        let at = range.primary.index.0.saturating_sub(folder.chars().count());
        state
            .cursor
            .set_char_range(Some(CCursorRange::one(CCursor::new(at))));
        state.store(ctx, id);
    }
}

/// Tab completes, the arrows choose a row.
fn keys(ui: &Ui, dialog: &mut PathDialog, rows: &[Row]) {
    if ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Tab)) {
        let entries: Vec<&Entry> = dialog
            .listing
            .iter()
            .flat_map(|listing| {
                listing.matches(&dialog.text, &system_dialog::extensions(dialog.purpose))
            })
            .collect();
        match completion::complete_name(&dialog.text, &entries) {
            Some(completed) => dialog.set_text(completed),
            // Nothing to add: Tab goes on to the buttons.
            None if entries.len() < 2 => {
                ui.memory_mut(|memory| memory.move_focus(egui::FocusDirection::Next))
            }
            None => {}
        }
    }
    let down = ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::ArrowDown));
    let up = ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::ArrowUp));
    if down && !rows.is_empty() {
        dialog.chosen = Some(dialog.chosen.map_or(0, |at| (at + 1).min(rows.len() - 1)));
    } else if up {
        dialog.chosen = dialog.chosen.and_then(|at| at.checked_sub(1));
    }
}

/// Goes into the folder that is typed. False if none is.
fn enter_folder(dialog: &mut PathDialog) -> bool {
    let typed = dialog.text.trim();
    let is_folder = !typed.is_empty()
        && !completion::name_of(typed).is_empty()
        && completion::expand_home(typed).is_dir();
    if is_folder {
        let text = format!("{typed}{}", std::path::MAIN_SEPARATOR);
        dialog.set_text(text);
    }
    is_folder
}

/// Puts the cursor at the end of the text; the name of a file to be written is selected, so that
/// typing replaces it.
fn place_cursor(ctx: &egui::Context, id: egui::Id, dialog: &PathDialog) {
    let end = dialog.text.chars().count();
    let mut range = CCursorRange::one(CCursor::new(end));
    if dialog.names_a_file() {
        let folder = dialog.folder_text().chars().count();
        let stem = Path::new(completion::name_of(&dialog.text))
            .file_stem()
            .map_or(0, |stem| stem.to_string_lossy().chars().count());
        range = CCursorRange::two(CCursor::new(folder), CCursor::new(folder + stem));
    }
    let mut state = TextEditState::load(ctx, id).unwrap_or_default();
    state.cursor.set_char_range(Some(range));
    state.store(ctx, id);
}

/// The list of recent files and matches. Returns true if a file was taken.
fn list_ui(ui: &mut Ui, dialog: &mut PathDialog, rows: &[Row], missing: &HashSet<PathBuf>) -> bool {
    let mut taken = None;
    match dialog.listing.as_ref() {
        Some(listing) if dialog.purpose != Purpose::Open && !listing.folder.exists() => {
            ui.label(theme::weak("This folder is made when you save."));
        }
        Some(Listing {
            entries: Err(error),
            ..
        }) => drop(ui.label(theme::weak(error.clone()))),
        _ => {}
    }
    let frame = egui::Frame::new()
        .fill(theme::well())
        .corner_radius(4.0)
        .inner_margin(4.0);
    frame.show(ui, |ui| {
        let height = ROW * ROWS;
        egui::ScrollArea::vertical()
            .id_salt("matches")
            .auto_shrink(false)
            .max_height(height)
            .min_scrolled_height(height)
            .show_rows(ui, ROW, rows.len().max(1), |ui, range| {
                ui.spacing_mut().item_spacing.y = 0.0;
                if rows.is_empty() {
                    let text = if dialog.listing.is_some() {
                        "Nothing here matches."
                    } else {
                        "Reading the folder"
                    };
                    ui.label(theme::weak(text));
                }
                for at in range {
                    let Some(row) = rows.get(at) else { continue };
                    let is_missing = matches!(row, Row::Recent(path) if missing.contains(path));
                    if row_ui(ui, row, dialog.chosen == Some(at), is_missing).clicked() {
                        taken = Some(row.clone());
                    }
                }
            });
    });
    let Some(row) = taken else { return false };
    // The next letter goes on with the path.
    ui.memory_mut(|memory| {
        if let Some(focused) = memory.focused() {
            memory.surrender_focus(focused);
        }
    });
    dialog.take(&row)
}

fn row_ui(ui: &mut Ui, row: &Row, is_chosen: bool, is_missing: bool) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let (name, detail) = match row {
        Row::Recent(path) => {
            let folder = path
                .parent()
                .map_or_else(String::new, |folder| folder.display().to_string());
            (
                path.file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned(),
                format!("recent · {folder}"),
            )
        }
        Row::Entry(Entry {
            name,
            is_folder: true,
        }) => (
            format!("{name}{}", std::path::MAIN_SEPARATOR),
            "folder".into(),
        ),
        Row::Entry(Entry { name, .. }) => (name.clone(), String::new()),
    };
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_chosen, &name));
    if is_chosen {
        ui.painter().rect_filled(rect, 3.0, theme::accent_ground());
        response.scroll_to_me(None);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 3.0, theme::raised());
    }
    let font = egui::TextStyle::Body.resolve(ui.style());
    let color = if is_missing {
        theme::text_weak().gamma_multiply(0.6)
    } else {
        theme::text_strong()
    };
    let painter = ui.painter_at(rect);
    let drawn = painter.text(
        rect.left_center() + vec2(6.0, 0.0),
        Align2::LEFT_CENTER,
        &name,
        font.clone(),
        color,
    );
    let rest = egui::Rect::from_min_max(egui::pos2(drawn.right() + 12.0, rect.top()), rect.max);
    let weak = if is_missing { "missing".into() } else { detail };
    // A letter is some 7 points wide.
    let weak = cut_middle(&weak, ((rest.width() - 12.0) / 7.0).max(4.0) as usize);
    ui.painter_at(rest).text(
        rest.right_center() - vec2(6.0, 0.0),
        Align2::RIGHT_CENTER,
        weak,
        font,
        theme::text_weak(),
    );
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_there_is_told_beside_the_field() {
        for (text, is_taken) in [("/nowhere/fo", false), ("fo.glb", false), ("fo", true)] {
            let mut dialog = PathDialog::new(Purpose::Open, text.into(), [1, 1]);
            assert_eq!(
                dialog.accept(None, &Commands::default()),
                is_taken,
                "{text}"
            );
            let error = dialog.error.unwrap_or_default();
            assert_eq!(error.contains("does not exist"), !is_taken, "{text}");
        }
    }

    #[test]
    fn a_folder_is_no_name_to_save_under() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for text in [
            format!("{}/", folder.path().display()),
            folder.path().display().to_string(),
        ] {
            let mut dialog = PathDialog::new(Purpose::SaveAs, text, [1, 1]);
            assert!(!dialog.accept(None, &Commands::default()));
            assert!(
                dialog
                    .error
                    .is_some_and(|error| error.contains("is a folder"))
            );
        }
    }
}
