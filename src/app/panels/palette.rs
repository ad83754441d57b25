//! The command palette: a search over everything that the window can do, over the picture.

use egui::{
    self, Align, Align2, FontId, Key, Modifiers, Rect, RichText, ScrollArea, Sense, TextEdit, Ui,
    pos2, vec2,
};

use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::session::Session,
        palette::{Choice, Entry, MAX_LISTED, entries, perform, rank},
        shell::{action::Action, command::Commands, state::State},
        widgets::{
            panel::{at_right, describe_chosen},
            theme,
        },
    },
    preset_file::{self, GalleryEntry, PresetFile},
};

/// What the search field is called for assistive technology.
const NAME: &str = "Search commands";
const WIDTH: f32 = 640.0;
const ROW: f32 = 28.0;
/// Width of the column of kinds.
const KIND_WIDTH: f32 = 78.0;
/// Rows that are seen at once, if the window is high enough.
const ROWS: f32 = 12.0;
/// Longest search, characters.
const MAX_CHARS: usize = 120;
/// Entries that were used and are listed first while nothing is typed.
const MAX_RECENT: usize = 8;
/// Rows that Page Up and Page Down move by.
const PAGE: usize = 10;

/// The command palette.
#[derive(Default)]
pub struct Palette {
    open: Option<Open>,
    /// Texts of the entries that were used last, the newest first.
    recent: Vec<String>,
}

/// The palette while it is open.
struct Open {
    search: String,
    entries: Vec<Entry>,
    /// The open preset, to try values on.
    probe: PresetFile,
    /// The entries that answer the search, best first.
    listed: Vec<Entry>,
    selected: usize,
    /// The selection was moved by a key: the list scrolls to it.
    follows: bool,
}

impl Palette {
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Opens the palette, or closes it if it is open.
    pub fn toggle(&mut self, session: &Session, presets: &[GalleryEntry]) {
        if self.open.take().is_some() {
            return;
        }
        let mut open = Open {
            search: String::new(),
            entries: entries(session, presets),
            probe: session.preset_file.clone(),
            listed: Vec::new(),
            selected: 0,
            follows: true,
        };
        open.list(&self.recent);
        self.open = Some(open);
    }

    /// Carries out the entry at `index` and closes the palette.
    fn choose(&mut self, index: usize, to: &Commands) {
        let Some(entry) = self.open.take().and_then(|mut open| {
            (index < open.listed.len()).then(|| open.listed.swap_remove(index))
        }) else {
            return;
        };
        self.recent.retain(|text| *text != entry.text);
        self.recent.insert(0, entry.text);
        self.recent.truncate(MAX_RECENT);
        perform(entry.choice, to);
    }
}

impl Open {
    /// Lists what answers the search; what was used last while nothing is typed.
    fn list(&mut self, recent: &[String]) {
        let probe = |path: &str, value: &str| {
            let set = preset_file::set(&mut self.probe.clone(), path, value)
                .map_err(|error| error.to_string());
            set.map_err(|sentence| sentence.trim_start_matches("--set: ").to_owned())
        };
        self.listed = rank(&self.entries, &self.search, probe);
        if self.search.trim().is_empty() {
            let index = |entry: &Entry| {
                recent
                    .iter()
                    .position(|text| *text == entry.text)
                    .unwrap_or(recent.len())
            };
            self.listed.sort_by_key(index);
            self.listed.truncate(MAX_LISTED);
        }
        (self.selected, self.follows) = (0, true);
    }

    /// Takes the keys that move the selection. Returns true if the selected entry is chosen.
    fn take_keys(&mut self, ui: &Ui) -> bool {
        let pressed =
            |key: Key| ui.input_mut(|i| i.count_and_consume_key(Modifiers::NONE, key)) as isize;
        let page = PAGE as isize;
        let by = pressed(Key::ArrowDown) - pressed(Key::ArrowUp)
            + page * (pressed(Key::PageDown) - pressed(Key::PageUp));
        if by != 0 && !self.listed.is_empty() {
            let last = self.listed.len() as isize - 1;
            // One step beyond an end leads to the other one; a page stops there.
            let to = self.selected as isize + by;
            let to = if by.abs() == 1 {
                to.rem_euclid(last + 1)
            } else {
                to.clamp(0, last)
            };
            (self.selected, self.follows) = (to as usize, true);
        }
        pressed(Key::Enter) > 0
    }
}

impl Panel for Palette {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let Some(open) = &mut self.open else { return };
        let area = ui.ctx().content_rect();
        let id = egui::Id::unique("command palette");
        let anchored = egui::Modal::default_area(id).anchor(
            Align2::CENTER_TOP,
            vec2(0.0, (area.height() * 0.1).min(72.0)),
        );
        let frame = egui::Frame::window(&ui.ctx().global_style()).inner_margin(10.0);
        let recent = &self.recent;
        let modal = egui::Modal::new(id)
            .area(anchored)
            .backdrop_color(egui::Color32::from_black_alpha(60))
            .frame(frame);
        let shown = modal.show(ui.ctx(), |ui| {
            ui.set_width(WIDTH.min(area.width() - 40.0));
            let is_entered = open.take_keys(ui);
            let hint =
                "Search actions, effects, parameters, presets; or set a value: facet.amount 0.5";
            let field = TextEdit::singleline(&mut open.search)
                .hint_text(hint)
                .char_limit(MAX_CHARS)
                .desired_width(f32::INFINITY);
            let field = ui.add(field.margin(vec2(8.0, 6.0))).accessible_name(NAME);
            if !field.has_focus() {
                field.request_focus();
            }
            if field.changed() {
                open.list(recent);
            }
            ui.add_space(theme::HALF);
            let clicked = list_ui(ui, open, area.height());
            footer_ui(ui, open);
            if is_entered {
                Some(open.selected)
            } else {
                clicked
            }
        });
        let keys = state.settings.keys.of(Action::Palette);
        let is_closed = shown.should_close()
            || ui.input_mut(|i| keys.iter().any(|shortcut| i.consume_shortcut(shortcut)));
        match shown.inner {
            Some(index) => self.choose(index, commands),
            None if is_closed => self.open = None,
            None => {}
        }
    }
}

/// The rows. Returns the index of the one that was clicked.
fn list_ui(ui: &mut Ui, open: &mut Open, height: f32) -> Option<usize> {
    if open.listed.is_empty() {
        ui.add_space(theme::HALF);
        ui.label(theme::weak("Nothing answers this search."));
        return None;
    }
    let mut clicked = None;
    let rows = ScrollArea::vertical()
        .max_height((ROWS * ROW).min(height * 0.6))
        .auto_shrink([false, true]);
    rows.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (index, entry) in open.listed.iter().enumerate() {
            let is_selected = index == open.selected;
            let response = row_ui(ui, entry, is_selected);
            if is_selected && open.follows {
                response.scroll_to_me(None);
            }
            if response.clicked() {
                clicked = Some(index);
            }
        }
    });
    open.follows = false;
    clicked
}

fn row_ui(ui: &mut Ui, entry: &Entry, is_selected: bool) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    describe_chosen(&response, egui::Role::Button, is_selected, &entry.text);
    if !entry.keys.is_empty() {
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_keyboard_shortcut(entry.keys.as_str())
        });
    }
    if !ui.is_rect_visible(rect) {
        return response;
    }
    if is_selected {
        ui.painter().rect_filled(rect, 4.0, theme::accent_ground());
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, theme::raised());
    }
    let (small, body) = (FontId::proportional(11.5), FontId::proportional(13.0));
    let middle = rect.center().y;
    let weak = if is_selected {
        theme::text()
    } else {
        theme::text_weak()
    };
    ui.painter().text(
        pos2(rect.left() + theme::GAP, middle),
        Align2::LEFT_CENTER,
        entry.kind.name(),
        small.clone(),
        weak,
    );
    let keys = ui
        .painter()
        .layout_no_wrap(entry.keys.clone(), small.clone(), theme::text());
    let keys_at = pos2(
        rect.right() - theme::GAP - keys.size().x,
        middle - keys.size().y / 2.0,
    );
    ui.painter().galley(keys_at, keys.clone(), theme::text());
    let is_refused = matches!(entry.choice, Choice::Refuse(_));
    let ink = if is_refused {
        theme::text()
    } else {
        theme::text_strong()
    };
    let text_rect = Rect::from_min_max(
        pos2(rect.left() + KIND_WIDTH, rect.top()),
        pos2(keys_at.x - theme::GAP, rect.bottom()),
    );
    let text = one_line(ui, &entry.text, body, ink, text_rect.width());
    let detail_left = text_rect.left() + text.size().x + 12.0;
    ui.painter().galley(
        pos2(text_rect.left(), middle - text.size().y / 2.0),
        text,
        ink,
    );
    if detail_left < text_rect.right() - 24.0 {
        let ink = if is_refused { theme::amber() } else { weak };
        let detail = one_line(
            ui,
            &entry.detail,
            small,
            ink,
            text_rect.right() - detail_left,
        );
        ui.painter().galley(
            pos2(detail_left, middle - detail.size().y / 2.0),
            detail,
            ink,
        );
    }
    response
}

/// Text that ends with … where it is longer than `width` points.
fn one_line(
    ui: &Ui,
    text: &str,
    font: FontId,
    color: egui::Color32,
    width: f32,
) -> std::sync::Arc<egui::Galley> {
    let mut job = egui::text::LayoutJob::single_section(
        text.replace('\n', " "),
        egui::TextFormat::simple(font, color),
    );
    job.wrap = egui::text::TextWrapping {
        max_width: width.max(8.0),
        max_rows: 1,
        break_anywhere: true,
        overflow_character: Some('…'),
    };
    ui.painter().layout_job(job)
}

/// What the selected entry is about, and the keys.
fn footer_ui(ui: &mut Ui, open: &Open) {
    ui.add_space(theme::HALF);
    let about = open
        .listed
        .get(open.selected)
        .map_or("", |entry| &entry.about);
    ui.horizontal(|ui| {
        ui.set_min_height(16.0);
        at_right(ui, |ui| {
            ui.label(theme::small("Arrow keys choose   Enter runs   Esc closes"));
            ui.with_layout(egui::Layout::left_to_right(Align::Center), |ui| {
                ui.add(
                    egui::Label::new(RichText::new(about).size(11.5).color(theme::text()))
                        .truncate(),
                );
            });
        });
    });
}
