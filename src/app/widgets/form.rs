//! Forms: how every window asks for a value. Rows of the inspector, which come from the registry
//! of settings and parameters, are made of the same controls.

use std::ops::RangeInclusive;

use egui::{self, Button, ComboBox, DragValue, Grid, Response, TextEdit, Ui, emath::Numeric};

use super::{
    icons::{Icon, icon_button},
    numbers::parse_quotient,
    theme,
};

/// A value that a choice offers, with its word and what it means.
pub type Offer<T, W = &'static str> = (T, W, &'static str);

/// Rows of labels and controls.
pub fn form_ui(ui: &mut Ui, id: &str, rows: impl FnOnce(&mut Ui)) {
    Grid::new(id)
        .num_columns(2)
        .spacing([theme::GAP, theme::HALF])
        .show(ui, rows);
}

/// A row of a form.
pub fn field_ui<R>(ui: &mut Ui, label: &str, hint: &str, control: impl FnOnce(&mut Ui) -> R) -> R {
    let label = ui.label(label);
    if !hint.is_empty() {
        label.on_hover_text(hint);
    }
    let shown = ui.horizontal(control).inner;
    ui.end_row();
    shown
}

/// The words of a choice side by side, each called `prefix` and its word. Returns true if another
/// is chosen now.
pub fn words_ui<T: PartialEq, W: AsRef<str>>(
    ui: &mut Ui,
    prefix: &str,
    chosen: &mut T,
    offers: impl IntoIterator<Item = Offer<T, W>>,
) -> bool {
    let mut is_changed = false;
    for (value, word, hint) in offers {
        let word = word.as_ref();
        let mut button = ui.selectable_label(*chosen == value, word);
        if !hint.is_empty() {
            button = button.on_hover_text(hint);
        }
        let is_clicked = button.clicked() && *chosen != value;
        button.accessible_name(format!("{prefix}{word}"));
        if is_clicked {
            (*chosen, is_changed) = (value, true);
        }
    }
    is_changed
}

/// The same as small buttons: how `of` is shown.
pub fn modes_ui<T: PartialEq>(
    ui: &mut Ui,
    of: &str,
    chosen: &mut T,
    offers: impl IntoIterator<Item = Offer<T>>,
) {
    for (mode, word, hint) in offers {
        let mut button = ui.add(Button::new(word).small().selected(*chosen == mode));
        if !hint.is_empty() {
            button = button.on_hover_text(hint);
        }
        let name = format!("{of}: {}", word.to_lowercase());
        if button.accessible_name(name).clicked() {
            *chosen = mode;
        }
    }
}

/// A menu called `name` that shows `now`. Returns what is chosen in it, if that is another value,
/// and the menu.
pub fn menu_ui<T: PartialEq, W: Into<egui::WidgetText>, H: Into<String>>(
    ui: &mut Ui,
    name: &str,
    (now, width): (impl Into<egui::WidgetText>, f32),
    chosen: Option<&T>,
    offers: impl IntoIterator<Item = (T, W, H)>,
) -> (Option<T>, Response) {
    let mut taken = None;
    let menu = ComboBox::from_id_salt(name).selected_text(now).width(width);
    let shown = menu.show_ui(ui, |ui| {
        for (value, word, hint) in offers {
            let is_chosen = chosen == Some(&value);
            let mut entry = ui.selectable_label(is_chosen, word.into());
            let hint = hint.into();
            if !hint.is_empty() {
                entry = entry.on_hover_text(hint);
            }
            if entry.clicked() && !is_chosen {
                taken = Some(value);
            }
        }
    });
    (taken, shown.response.accessible_name(name))
}

/// A number called `name` with its unit: changed by a drag, or typed, also as `30000/1001`.
pub fn number_ui<N: Numeric>(
    ui: &mut Ui,
    name: &str,
    value: &mut N,
    range: RangeInclusive<N>,
    (speed, unit): (f64, &str),
) -> Response {
    let decimals = if N::INTEGRAL { 0 } else { 3 };
    let before = value.to_f64();
    let drag = DragValue::new(value)
        .range(range)
        .speed(speed)
        .max_decimals(decimals)
        .update_while_editing(false)
        .custom_parser(move |text| {
            // What is shown is rounded; to leave it alone changes nothing.
            let is_shown = |number: f64| (number - before).abs() < 0.0005;
            parse_quotient(text).map(|number| if is_shown(number) { before } else { number })
        })
        .suffix(unit);
    ui.add(drag).accessible_name(name)
}

/// A factor of what is too faint to be seen, called `name`.
pub fn gain_ui(ui: &mut Ui, name: &str, gain: &mut u8, hint: &str) -> Response {
    let drag = DragValue::new(gain).range(1..=255).prefix("× ").speed(0.3);
    ui.add(drag).accessible_name(name).on_hover_text(hint)
}

/// A text called `name`, in the whole width.
pub fn text_ui(ui: &mut Ui, name: &str, hint: &str, text: &mut String) -> Response {
    let field = TextEdit::singleline(text)
        .hint_text(hint)
        .desired_width(f32::INFINITY);
    ui.add(field).accessible_name(name)
}

/// A field for a search, with a button that clears it.
pub fn search_ui(ui: &mut Ui, search: &mut String, name: &str) -> Response {
    ui.horizontal(|ui| {
        let clear = if search.is_empty() {
            0.0
        } else {
            ui.spacing().interact_size.y + ui.spacing().item_spacing.x
        };
        let field = TextEdit::singleline(search)
            .hint_text(name)
            .char_limit(120)
            .desired_width(ui.available_width() - clear);
        let field = ui.add(field).accessible_name(name);
        if field.has_focus() {
            ui.data_mut(|data| data.insert_temp(focused_search(), field.id));
        }
        if field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Escape)) {
            search.clear();
        }
        if clear > 0.0 && icon_button(ui, Icon::Cross, &format!("Clear: {name}")).clicked() {
            search.clear();
        }
        field
    })
    .inner
}

fn focused_search() -> egui::Id {
    egui::Id::unique("the search that had the focus last")
}

/// Has a search the focus? It loses nothing when something else happens meanwhile.
pub fn is_searching(ctx: &egui::Context) -> bool {
    ctx.memory(|memory| memory.focused())
        .is_some_and(|id| ctx.data(|data| data.get_temp(focused_search())) == Some(id))
}

/// A name in a dialog: it takes the focus, with its text selected where `selects`. Returns true
/// if Enter was pressed in it.
pub fn name_ui(ui: &mut Ui, hint: &str, text: &mut String, selects: &mut bool) -> bool {
    use egui::text::{CCursor, CCursorRange};
    let mut shown = TextEdit::singleline(text)
        .hint_text(hint)
        .char_limit(crate::preset_file::MAX_NAME)
        .desired_width(f32::INFINITY)
        .show(ui);
    if std::mem::take(selects) {
        let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
        shown.state.cursor.set_char_range(Some(all));
        shown.state.store(ui.ctx(), shown.response.id);
    }
    let field = shown.response.response.accessible_name("Name");
    is_entered(ui, &field)
}

/// Was Enter pressed in the field of a dialog? Otherwise it has the keyboard whenever nothing else
/// has.
pub fn is_entered(ui: &Ui, field: &Response) -> bool {
    let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    if !is_entered && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    is_entered
}
