//! The text of an effect of one's own beside the picture. What is typed is compiled after a pause;
//! the file changes only when it is saved, so another editor may have it open, too.

mod highlight;

use std::path::{Path, PathBuf};

use egui::{
    self, Color32, Key, Modifiers, ScrollArea, TextEdit, TextStyle, Ui, pos2,
    text::{CCursor, CCursorRange},
    vec2,
};

use crate::app::panels::panel::Panel;
use crate::{
    app::{
        shell::{command::Commands, state::State},
        widgets::{
            icons::{Icon, icon_button},
            panel::at_right,
            theme,
        },
    },
    effect_files::{self, EffectError},
    effects::EnabledEffect,
};

/// Seconds without a key after which the text is compiled.
const PAUSE_S: f64 = 0.4;
/// Width of the column of line numbers, in characters.
const NUMBER_CHARS: f32 = 5.0;

/// The panel; closed without a file.
#[derive(Default)]
pub struct CodePanel {
    open: Option<Open>,
}

/// A file that is edited.
struct Open {
    path: PathBuf,
    /// Name of the effect: the stem of the file.
    name: String,
    text: String,
    /// The text of the file, as far as it is known.
    saved: String,
    /// The text that was compiled last, or is being compiled.
    tried: String,
    /// When the text last changed, seconds.
    changed_s: f64,
    /// What is wrong with the text that was tried last.
    error: Option<EffectError>,
    /// The user wants to close it with changes that are not saved.
    asks: bool,
}

impl CodePanel {
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// The file whose changes are not saved.
    pub fn unsaved(&self) -> Option<&Path> {
        self.open
            .as_ref()
            .filter(|open| open.text != open.saved)
            .map(|open| open.path.as_path())
    }

    /// The file that is edited.
    pub fn path(&self) -> Option<&Path> {
        self.open.as_ref().map(|open| open.path.as_path())
    }

    /// Shows a file. One whose changes are not saved stays, and asks about them.
    pub fn show(&mut self, path: PathBuf, text: String) {
        if self.unsaved().is_some() {
            return self.ask();
        }
        let name = effect_files::stem(&path);
        self.open = Some(Open {
            path,
            name,
            saved: text.clone(),
            tried: text.clone(),
            text,
            changed_s: 0.0,
            error: None,
            asks: false,
        });
    }

    /// Asks what becomes of changes that are not saved.
    pub fn ask(&mut self) {
        self.open.iter_mut().for_each(|open| open.asks = true);
    }

    /// Takes what reading a text has found.
    pub fn take_error(&mut self, text: &str, error: Option<&EffectError>) {
        if let Some(open) = self.open.as_mut().filter(|open| open.tried == text) {
            open.error = error.cloned();
        }
    }

    /// The file has this text now, written here or by another program.
    pub fn take_saved(&mut self, path: &Path, text: &str) {
        let Some(open) = self.open.as_mut().filter(|open| open.path == path) else {
            return;
        };
        if open.text == open.saved {
            open.text = text.into();
            open.tried = text.into();
            open.error = None;
        }
        // Unsaved text is compiled again, since the file's was.
        if open.saved != text && open.text != text {
            open.tried.clear();
        }
        open.saved = text.into();
    }
}

impl Panel for CodePanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let Some(open) = &mut self.open else { return };
        let mut closes = head_ui(ui, open, commands);
        if open.asks {
            closes |= question_ui(ui, open, commands);
        }
        if let Some(error) = &open.error {
            let line = error
                .place
                .as_ref()
                .map_or_else(String::new, |place| format!("line {}: ", place.line));
            theme::notice(ui, theme::red(), &format!("{line}{}", error.message));
        }
        text_ui(ui, open, state);
        let waits_s = open.changed_s + PAUSE_S - state.now_s;
        if open.text != open.tried && (waits_s <= 0.0 || closes) {
            open.tried.clone_from(&open.text);
            let (path, text) = (open.path.clone(), open.text.clone());
            commands.run(|app| app.state.jobs.try_code(path, text));
        } else if open.text != open.tried {
            ui.ctx().request_repaint_after_secs(waits_s as f32);
        }
        if closes && open.text != open.saved {
            open.asks = true;
        } else if closes {
            self.open = None;
        }
    }
}

/// The name of the file and its buttons; returns whether it is to be closed.
fn head_ui(ui: &mut Ui, open: &mut Open, commands: &Commands) -> bool {
    let is_unsaved = open.text != open.saved;
    let has_focus = ui.memory(|memory| memory.has_focus(text_id()));
    let mut closes = false;
    let mut saves =
        has_focus && ui.input_mut(|i| i.consume_key(Modifiers::COMMAND, Key::S)) && is_unsaved;
    ui.horizontal(|ui| {
        let dot = if is_unsaved { "• " } else { "" };
        ui.label(theme::heading(&format!("{dot}{}.wgsl", open.name)))
            .on_hover_text(open.path.display().to_string());
        at_right(ui, |ui| {
            closes = icon_button(ui, Icon::Cross, "Close the text").clicked();
            saves |= ui
                .add_enabled(is_unsaved, egui::Button::new("Save"))
                .on_hover_text("Write the file (Ctrl+S in the text)")
                .accessible_name("Save the text")
                .clicked();
        });
    });
    if saves {
        save(open, commands);
    }
    closes
}

fn save(open: &mut Open, commands: &Commands) {
    open.asks = false;
    let (path, text) = (open.path.clone(), open.text.clone());
    commands.run(|app| app.state.jobs.save_code(path, text));
}

/// What becomes of changes that are not saved. Discarded, the file's text is compiled again. Returns
/// whether they were: then the text is closed.
fn question_ui(ui: &mut Ui, open: &mut Open, commands: &Commands) -> bool {
    theme::notice(
        ui,
        theme::amber(),
        &format!("{}.wgsl has changes that are not saved.", open.name),
    );
    ui.horizontal(|ui| {
        if ui.button("Save them").clicked() {
            save(open, commands);
        }
        let discards = ui.button("Discard them").clicked();
        if discards {
            open.text.clone_from(&open.saved);
        }
        if discards || ui.button("Go on").clicked() {
            open.asks = false;
        }
        discards
    })
    .inner
}

fn text_id() -> egui::Id {
    egui::Id::unique("text of an effect")
}

/// The text with its line numbers; the line of an error is marked, and where a parameter is
/// declared its value stands behind.
fn text_ui(ui: &mut Ui, open: &mut Open, state: &State) {
    let font = TextStyle::Monospace.resolve(ui.style());
    let char_width = ui.fonts_mut(|fonts| fonts.glyph_width(&font, '0'));
    let margin = (NUMBER_CHARS * char_width).ceil();
    let mut layouter = |ui: &Ui, text: &dyn egui::TextBuffer, _: f32| {
        let job = highlight::layout(text.as_str(), &font);
        ui.fonts_mut(|fonts| fonts.layout_job(job))
    };
    // The text of each file has a scroll position of its own, at first its top left.
    let scroll = ScrollArea::both().id_salt(&open.path).auto_shrink(false);
    scroll.show(ui, |ui| {
        let edit = TextEdit::multiline(&mut open.text)
            .id(text_id())
            .font(TextStyle::Monospace)
            .code_editor()
            .desired_width(f32::INFINITY)
            .desired_rows(24)
            .margin(egui::Margin {
                left: margin as i8,
                right: 8,
                top: 4,
                bottom: 4,
            })
            .layouter(&mut layouter);
        let mut shown = edit.show(ui);
        shown
            .response
            .response
            .clone()
            .accessible_name(format!("Text of {}", open.name));
        if shown.response.response.changed() {
            open.changed_s = state.now_s;
            if let (true, Some(range)) =
                (ui.input(|i| i.key_pressed(Key::Enter)), shown.cursor_range)
            {
                let at = indent(&mut open.text, range.primary.index.0);
                let range = CCursorRange::one(CCursor::new(at));
                shown.state.cursor.set_char_range(Some(range));
                shown.state.store(ui.ctx(), text_id());
            }
        }
        // The column of numbers stays in view when the text is scrolled sideways.
        let numbers = shown.galley_pos.x.max(ui.clip_rect().min.x + margin);
        if numbers > shown.galley_pos.x {
            let column = ui.clip_rect().with_max_x(numbers);
            ui.painter()
                .rect_filled(column, 0.0, ui.visuals().text_edit_bg_color());
        }
        let enabled = state.session.preset().stack.get(&open.name);
        let error_line = open
            .error
            .as_ref()
            .and_then(|error| error.place.as_ref())
            .map(|place| place.line as usize);
        let lines: Vec<&str> = open.text.split('\n').collect();
        for (index, row) in shown.galley.rows.iter().enumerate() {
            let rect = row.rect().translate(shown.galley_pos.to_vec2());
            let is_wrong = error_line == Some(index + 1);
            let color = if is_wrong {
                theme::red()
            } else {
                theme::text_weak()
            };
            if is_wrong {
                let line = rect.with_max_x(ui.clip_rect().max.x);
                ui.painter()
                    .rect_filled(line, 0.0, color.gamma_multiply(0.15));
            }
            ui.painter().text(
                pos2(numbers - char_width, rect.min.y),
                egui::Align2::RIGHT_TOP,
                index + 1,
                font.clone(),
                color,
            );
            let value = enabled
                .zip(lines.get(index))
                .and_then(|(enabled, line)| value_on(line, enabled));
            if let Some(value) = value {
                ui.painter().text(
                    rect.right_top() + vec2(2.0 * char_width, 0.0),
                    egui::Align2::LEFT_TOP,
                    value,
                    font.clone(),
                    value_color(),
                );
            }
        }
    });
}

/// Begins the line at character `at` of `text` as the line before it, and deeper behind a `{`.
/// Returns the place behind that.
fn indent(text: &mut String, at: usize) -> usize {
    let offset = text
        .char_indices()
        .nth(at)
        .map_or(text.len(), |(offset, _)| offset);
    let Some(before) = text[..offset].strip_suffix('\n') else {
        return at;
    };
    let line = before.rsplit('\n').next().unwrap_or_default();
    let mut added: String = line
        .chars()
        .take_while(|c| *c == ' ' || *c == '\t')
        .collect();
    if line.trim_end().ends_with('{') {
        added += "    ";
    }
    text.insert_str(offset, &added);
    at + added.chars().count()
}

fn value_color() -> Color32 {
    theme::accent().gamma_multiply(0.8)
}

/// `= 0.5` for a line that declares a parameter of the effect.
fn value_on(line: &str, enabled: &EnabledEffect) -> Option<String> {
    let code = line.split("//").next()?;
    let name = code.split_once(':')?.0.split_whitespace().next_back()?;
    let field = enabled.effect.field(name)?;
    let values: Vec<String> = field
        .get(&enabled.words)
        .into_iter()
        .map(|value| (value as f32).to_string())
        .collect();
    Some(format!("= {}", values.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_line_begins_as_the_one_before_it_and_deeper_in_a_block() {
        for (before, expected, at) in [
            ("fn f() {\n}", "fn f() {\n    }", 13),
            ("    let é = 1;\n", "    let é = 1;\n    ", 19),
            ("a", "a", 1),
        ] {
            let mut text = before.to_owned();
            let place = before
                .find('\n')
                .map_or(1, |byte| before[..=byte].chars().count());
            assert_eq!(indent(&mut text, place), at, "{before}");
            assert_eq!(text, expected);
        }
    }

    #[test]
    fn unsaved_text_stays_when_the_file_changes_and_saved_text_follows_it() {
        let mut panel = CodePanel::default();
        let path = PathBuf::from("effects/ink.wgsl");
        panel.show(path.clone(), "one".into());
        panel.take_saved(&path, "two");
        assert_eq!(
            panel.open.as_ref().map(|open| open.text.as_str()),
            Some("two")
        );
        assert_eq!(panel.unsaved(), None);
        if let Some(open) = &mut panel.open {
            open.text = "mine".into();
        }
        panel.take_saved(&path, "three");
        assert_eq!(panel.unsaved(), Some(path.as_path()));
        panel.show("other.wgsl".into(), "other".into());
        let open = panel.open.as_ref().expect("it stays");
        assert!(open.asks && open.text == "mine" && open.saved == "three");
    }
}
