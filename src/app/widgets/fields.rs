//! Rows: a label and the control for its type of value. One function serves every setting of a
//! preset and every parameter of every effect.

use std::sync::Arc;

use egui::{
    self, Align, Color32, Rect, Response, Sense, Slider, SliderClamping, Ui, UiBuilder, pos2, vec2,
};

use super::{
    form::menu_ui,
    icons::{Icon, icon_button, key_button},
    numbers::NumberField,
    reveal, theme,
};
use crate::{
    app::{
        editing::key_id::Keying,
        shell::{
            command::{Commands, Edit, Parameter, RowCommand},
            log::Level,
        },
    },
    params::{Param, Value, ValueType},
    preset::{Preset, settings::Setting},
    preset_file::toml_value::{self, color_of_hex, hex_of_color},
};

/// What a row shows and what it edits.
pub struct Row {
    /// `facet.amount`: path for copy, paste and reset, and the accessible name of its control.
    pub path: String,
    pub label: String,
    pub param: Param,
    /// Differs from its default.
    pub modified: bool,
    /// Whether it has keyframes; none for what cannot be animated.
    pub keying: Option<Keying>,
    edited: Edited,
}

/// What a row edits.
#[derive(Clone)]
enum Edited {
    Setting(&'static Setting),
    Parameter(Parameter),
}

impl Row {
    /// The row of an effect's parameter.
    pub fn of_parameter((effect, field): Parameter, words: &[u32]) -> Self {
        let (path, modified) = (
            format!("{}.{}", effect.name, field.name),
            !field.same(words, &effect.defaults),
        );
        Self::new(
            path,
            field.param.clone(),
            modified,
            Edited::Parameter((effect, field)),
        )
    }

    /// The row of a parameter whose lengths are radii of the scene's box.
    pub fn in_radii(mut self) -> Self {
        self.param.unit = match self.param.unit.as_str() {
            "m" => "r".into(),
            "m/s" => "r/s".into(),
            "m/s²" => "r/s²".into(),
            "per m" => "per r".into(),
            _ => self.param.unit,
        };
        self
    }

    /// The row of a parameter that can be animated. Keyframes are a difference from the default,
    /// whatever their values.
    pub fn keyed(self, keying: Keying) -> Self {
        Self {
            modified: self.modified || keying != Keying::Still,
            keying: Some(keying),
            ..self
        }
    }

    /// The row of a setting of the preset.
    pub fn of_setting(setting: &'static Setting, preset: &Preset) -> Self {
        let row = Self::new(
            setting.path(),
            setting.param.clone(),
            setting.is_modified(preset),
            Edited::Setting(setting),
        );
        match row.path == "accuracy.render_scale" {
            true => Self {
                label: "AA".into(),
                ..row
            },
            false => row,
        }
    }

    fn new(path: String, param: Param, modified: bool, edited: Edited) -> Self {
        Self {
            path,
            label: label(&param.name, &param.unit),
            param,
            modified,
            keying: None,
            edited,
        }
    }

    /// The edit after which the row shows `value`.
    fn edit(&self, value: Value) -> Edit {
        match &self.edited {
            Edited::Setting(setting) => Edit::Setting(setting, value),
            Edited::Parameter(parameter) => Edit::Parameter(parameter.clone(), value),
        }
    }

    /// The value as TOML, as copied and pasted.
    pub fn written(&self, value: &Value) -> String {
        toml_value::write_text(&self.param.value_type, value)
    }

    /// What the slider spans; none where there is a number field alone.
    fn slider(&self) -> Option<[f64; 2]> {
        self.param.has_slider.then_some(self.param.soft)
    }

    fn is_whole(&self) -> bool {
        !self.param.value_type.is_continuous()
    }
}

/// The name without its unit, as the unit is shown after the number: `radius_m` in meters is
/// `radius`.
/// The name of a parameter in words, without the unit, which its value has.
pub fn label(name: &str, unit: &str) -> String {
    let stem = [
        ("m", "_m"),
        ("°", "_deg"),
        ("°/s", "_deg_per_s"),
        ("s", "_s"),
    ]
    .iter()
    .find(|(u, _)| *u == unit);
    stem.and_then(|(_, suffix)| name.strip_suffix(suffix))
        .unwrap_or(name)
        .replace('_', " ")
}

const BAR_WIDTH: f32 = 3.0;
const RESET_WIDTH: f32 = 22.0;
const KEY_WIDTH: f32 = 18.0;
const NUMBER_WIDTH: f32 = 66.0;

/// Shows `row` with `value`, and sends what the user does with it.
pub fn row_ui(ui: &mut Ui, commands: &Commands, row: &Row, value: &Value) {
    let width = ui.available_width();
    let (rect, _) = ui.allocate_exact_size(vec2(width, theme::ROW), Sense::hover());
    let (label_rect, rest) =
        rect.split_left_right_at_x(rect.left() + (width * 0.34).clamp(72.0, 140.0));
    let label_rect = label_rect.with_min_x(rect.left() + BAR_WIDTH + theme::HALF);
    let (rest, reset_rect) = rest.split_left_right_at_x(rect.right() - RESET_WIDTH);
    let key_width = row.keying.map_or(0.0, |_| KEY_WIDTH);
    let (control_rect, key_rect) = rest.split_left_right_at_x(rest.right() - key_width);
    let control_rect = control_rect.with_min_x(control_rect.left() + theme::HALF);
    if row.modified {
        let bar = Rect::from_min_size(
            rect.min + vec2(0.0, 4.0),
            vec2(BAR_WIDTH, rect.height() - 8.0),
        );
        ui.painter().rect_filled(bar, 1.5, theme::accent());
    }
    let mut command = label_ui(ui, row, value, label_rect);
    let layout = egui::Layout::left_to_right(Align::Center);
    let mut control = ui.new_child(
        UiBuilder::new()
            .id_salt(&row.path)
            .max_rect(control_rect)
            .layout(layout),
    );
    control.spacing_mut().item_spacing.x = 6.0;
    let shown = control_ui(&mut control, commands, row, value);
    let changed = shown.and_then(|(response, changed)| {
        reveal::focus(&row.path, &response);
        changed
    });
    if row.modified {
        let mut reset = ui.new_child(
            UiBuilder::new()
                .id_salt((&row.path, "reset"))
                .max_rect(reset_rect)
                .layout(layout),
        );
        if icon_button(&mut reset, Icon::Reset, &format!("Reset {}", row.path)).clicked() {
            command = Some(RowCommand::Reset(row.path.clone()));
        }
    }
    if let Some(keying) = row.keying
        && key_button(ui, key_rect, keying, &row.path).clicked()
    {
        command = Some(RowCommand::ToggleKey(row.path.clone()));
    }
    reveal::row(ui, &row.path, rect);
    if ui.rect_contains_pointer(rect) {
        let hovered = Some((row.path.clone(), row.written(value)));
        commands.run(|app| app.state.clipboard.hovered_row = hovered);
    }
    if let Some(command) = command {
        commands.row(command);
    }
    // A row command ends the step of undo that an edit continues, so the edit comes last.
    if let Some(value) = changed {
        commands.edit(row.edit(value));
    }
}

/// The text of a label: in one line, or in two small ones where that is too long.
fn label_galley(ui: &Ui, text: &str, color: Color32, width: f32) -> Arc<egui::Galley> {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let line = ui.painter().layout_no_wrap(text.to_owned(), font, color);
    if line.size().x <= width {
        return line;
    }
    let small = egui::FontId::proportional(10.5);
    let mut job = egui::text::LayoutJob::single_section(
        text.to_owned(),
        egui::TextFormat::simple(small, color),
    );
    job.wrap = egui::text::TextWrapping {
        max_width: width,
        max_rows: 2,
        ..Default::default()
    };
    ui.painter().layout_job(job)
}

/// The label: tooltip, double click to reset, menu.
fn label_ui(ui: &mut Ui, row: &Row, value: &Value, rect: Rect) -> Option<RowCommand> {
    let response = ui.interact(rect, egui::Id::unique((&row.path, "label")), Sense::click());
    let color = if row.modified || response.hovered() {
        theme::text_strong()
    } else {
        theme::text()
    };
    // The bundled fonts have no bold cut, so bold is the same text twice, half a pixel apart.
    let clipped = ui.painter_at(rect.expand(1.0));
    let label = label_galley(ui, &row.label, color, rect.width());
    let at = pos2(rect.left(), rect.center().y - 0.5 * label.size().y);
    clipped.galley(at, label.clone(), color);
    if row.modified {
        clipped.galley(at + vec2(0.5, 0.0), label, color);
    }
    let mut command = response
        .double_clicked()
        .then(|| RowCommand::Reset(row.path.clone()));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &row.label));
    response.context_menu(|ui| {
        let group = row.path.split('.').next().unwrap_or_default();
        let path = || row.path.clone();
        let all = format!("Reset all of {group}");
        for (text, chosen) in [
            ("Reset", RowCommand::Reset(path())),
            (all.as_str(), RowCommand::ResetGroup(group.into())),
            ("Copy value", RowCommand::Copy(row.written(value))),
            ("Paste value", RowCommand::Paste(path())),
        ] {
            if ui.button(text).clicked() {
                command = Some(chosen);
                ui.close();
            }
        }
    });
    response.on_hover_ui(|ui| {
        ui.label(theme::strong(&row.param.doc));
        ui.label(theme::weak(format!(
            "{}   {}{}",
            row.path,
            allowed_text(&row.param),
            spaced_unit(&row.param.unit)
        )));
    });
    command
}

/// The values that a parameter takes, for a person: `0.0001 to 1`.
pub fn allowed_text(param: &Param) -> String {
    param.allowed().replace("..=", " to ")
}

fn spaced_unit(unit: &str) -> String {
    match unit {
        "" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// What a control shows, and the value that it was given.
type Shown = (Response, Option<Value>);

fn control_ui(ui: &mut Ui, commands: &Commands, row: &Row, value: &Value) -> Option<Shown> {
    Some(match (&row.param.value_type, value) {
        (_, Value::Bool(on)) => {
            let mut on = *on;
            let shown = ui.checkbox(&mut on, "").accessible_name(&row.path);
            let changed = shown.changed().then_some(Value::Bool(on));
            (shown, changed)
        }
        (ValueType::Choice(words), Value::Choice(index)) => {
            let now = words.get(*index).map_or("", String::as_str);
            let offers = words.iter().enumerate();
            let offers = offers.map(|(index, word)| (index, word.as_str(), ""));
            let now = (now, ui.available_width());
            let (taken, menu) = menu_ui(ui, &row.path, now, Some(index), offers);
            (menu, taken.map(Value::Choice))
        }
        (ValueType::Color, Value::Numbers(components)) => color_ui(ui, commands, row, components),
        (_, Value::Numbers(components)) => match components[..] {
            [number] => number_ui(ui, commands, row, number),
            _ => components_ui(ui, commands, row, components)?,
        },
        (ValueType::Text { max_chars }, Value::Text(text)) => {
            let mut text = text.clone();
            let edit = egui::TextEdit::singleline(&mut text)
                .char_limit(*max_chars)
                .desired_width(ui.available_width());
            let shown = ui.add(edit).accessible_name(&row.path);
            let changed = shown.changed().then_some(Value::Text(text));
            (shown, changed)
        }
        _ => return None, // Lists of texts are edited in the file.
    })
}

fn color_ui(ui: &mut Ui, commands: &Commands, row: &Row, components: &[f64]) -> Shown {
    let mut color: [f32; 4] = std::array::from_fn(|i| components[i] as f32);
    ui.spacing_mut().interact_size.x = 44.0;
    let response = ui
        .color_edit_button_rgba_unmultiplied(&mut color)
        .accessible_name(&row.path)
        .on_hover_text("Choose the color");
    let typed = hex_ui(ui, commands, row, components);
    // The picker's arithmetic may leave the unit range by a bit.
    let picked = |c: f32| {
        f64::from(if c.is_finite() {
            c.clamp(0.0, 1.0)
        } else {
            0.0
        })
    };
    let picked = color.map(picked);
    // To open and close the picker rounds the color, which changes nothing that is seen.
    let is_other = hex_of_color(picked) != hex_of_color(std::array::from_fn(|i| components[i]));
    let picked = || Value::Numbers(picked.to_vec());
    let changed = typed.or_else(|| (response.changed() && is_other).then(picked));
    (response, changed)
}

/// The color as it is written for screens, which can be typed.
fn hex_ui(ui: &mut Ui, commands: &Commands, row: &Row, components: &[f64]) -> Option<Value> {
    let shown = hex_of_color(std::array::from_fn(|i| components[i]));
    let id = ui.scope_id().with("hex");
    let kept = ui.data(|data| data.get_temp::<String>(id));
    let mut text = kept.unwrap_or_else(|| shown.clone());
    let edit = egui::TextEdit::singleline(&mut text)
        .id(id)
        .char_limit(9)
        .font(egui::TextStyle::Monospace)
        .desired_width(84.0f32.min(ui.available_width()));
    let field = ui
        .add(edit)
        .accessible_name(format!("{} value", row.path))
        .on_hover_text("As on the screen (sRGB). The preset keeps the same color as four numbers of linear light, in which light adds up.");
    if field.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(id));
    if !field.lost_focus() || text == shown {
        return None;
    }
    let typed = color_of_hex(&text);
    if typed.is_none() {
        let said = format!("{text:?} is no color, so it stays {shown}; write #rrggbb");
        say(commands, row, Some(said));
    }
    typed.map(|color| Value::Numbers(color.into()))
}

/// One number: a slider over the soft range, and a field that takes the hard one.
fn number_ui(ui: &mut Ui, commands: &Commands, row: &Row, value: f64) -> Shown {
    let ([low, high], whole, soft) = (row.param.hard, row.is_whole(), row.slider());
    let mut now = value;
    if let Some([from, to]) = soft {
        ui.spacing_mut().slider_width = (ui.available_width() - NUMBER_WIDTH - 6.0).max(24.0);
        now = slider_ui(ui, row, value, [from, to], whole);
    }
    let speed = speed_of(soft, value.abs().max(1.0));
    let width = match soft {
        Some(_) => NUMBER_WIDTH,
        None => ui.available_width().min(120.0),
    };
    let unit = spaced_unit(&row.param.unit);
    let speed = if whole { speed.max(0.05) } else { speed };
    let field = NumberField {
        range: [low, high],
        speed,
        is_whole: whole,
        decimals: decimals(soft),
        unit: &unit,
    };
    let (response, said) = field.show(ui, width, &mut now);
    let response = response.accessible_name(format!("{} value", row.path));
    say(commands, row, said);
    let now = if whole { now.round() } else { now };
    let changed = now != value && now.is_finite();
    (
        response,
        changed.then(|| Value::number(now.clamp(low, high))),
    )
}

/// Change for each point of a drag: a part of the soft range, or of the value.
fn speed_of(soft: Option<[f64; 2]>, value: f64) -> f64 {
    soft.map_or(value * 0.01, |[from, to]| (to - from) / 300.0)
}

/// Says that a typed number was not taken as it was.
fn say(commands: &Commands, row: &Row, said: Option<String>) {
    if let Some(said) = said {
        let text = format!(
            "{} takes {}{}: {said}.",
            row.path,
            allowed_text(&row.param),
            spaced_unit(&row.param.unit)
        );
        commands.notify(Level::Warning, text);
    }
}

/// Decimals worth showing for a soft range.
fn decimals(soft: Option<[f64; 2]>) -> usize {
    let span = soft.map_or(1.0, |[from, to]| (to - from).abs());
    if span >= 100.0 {
        1
    } else if span >= 10.0 {
        2
    } else {
        3
    }
}

/// The slider; Shift moves it a tenth as far.
fn slider_ui(ui: &mut Ui, row: &Row, value: f64, [from, to]: [f64; 2], whole: bool) -> f64 {
    let (mut now, fine) = (value, ui.input(|i| i.modifiers.shift));
    let rail = ui.spacing().slider_width;
    let set = |value: Option<f64>| {
        now = value.unwrap_or(now);
        now
    };
    let mut slider = Slider::from_get_set(from..=to, set)
        .show_value(false)
        .logarithmic(row.param.log)
        .clamping(SliderClamping::Edits);
    if whole {
        slider = slider.step_by(1.0);
    }
    if row.param.log {
        slider = slider.smallest_positive(from.abs().max(1e-6));
    }
    let response = ui.add(slider).accessible_name(&row.path);
    if !(fine && response.dragged()) {
        return now;
    }
    let part = f64::from(response.drag_delta().x / rail.max(1.0)) * 0.1;
    let moved = match row.param.log && value > 0.0 && from > 0.0 {
        true => value * (to / from).powf(part),
        false => value + (to - from) * part,
    };
    match whole {
        true => value,
        false => moved.clamp(from.min(value), to.max(value)),
    }
}

/// Two or three numbers side by side.
fn components_ui(ui: &mut Ui, commands: &Commands, row: &Row, components: &[f64]) -> Option<Shown> {
    let ([low, high], whole, soft) = (row.param.hard, row.is_whole(), row.slider());
    let (mut now, mut first) = (components.to_vec(), None);
    ui.spacing_mut().item_spacing.x = 4.0;
    let width =
        (ui.available_width() - 4.0 * (components.len() - 1) as f32) / components.len() as f32;
    for (component, name) in now.iter_mut().zip(row.param.value_type.component_names()) {
        let speed = match whole {
            true => 1.0,
            false => speed_of(soft, component.abs().max(0.5)),
        };
        let field = NumberField {
            range: [low, high],
            speed,
            is_whole: whole,
            decimals: if whole { 0 } else { 3 },
            unit: "",
        };
        let (response, said) = field.show(ui, width, component);
        let response = response
            .accessible_name(format!("{}.{name}", row.path))
            .on_hover_text(*name);
        first.get_or_insert(response);
        say(commands, row, said);
    }
    let changed = now != components && now.iter().all(|component| component.is_finite());
    if whole {
        now.iter_mut()
            .for_each(|component| *component = component.round());
    }
    Some((first?, changed.then_some(Value::Numbers(now))))
}

/// A dot of `color` in front of a line, for states.
pub fn dot(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(8.0, theme::ROW - 8.0), Sense::hover());
    ui.painter().circle_filled(rect.center(), 3.5, color);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    #[test]
    fn a_unit_is_not_said_twice() {
        assert_eq!(label("radius_m", "m"), "radius");
        assert_eq!(label("spin_deg_per_s", "°/s"), "spin");
        assert_eq!(label("along_x", ""), "along x");
    }

    #[test]
    fn no_row_of_an_effect_with_defaults_is_marked_as_modified() {
        for effect in EFFECTS.iter() {
            let words = &effect.defaults;
            assert!(
                effect.fields.iter().all(|field| !Row::of_parameter(
                    (effect.clone(), field.clone()),
                    words
                )
                .modified),
                "{}",
                effect.name
            );
        }
    }
}
