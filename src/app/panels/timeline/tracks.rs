//! Tracks: a row per animated parameter, with a mark per keyframe that can be dragged in time. An
//! open row shows its curve.

use std::collections::BTreeSet;

use egui::{
    self, Align, Align2, Color32, FontId, Layout, Pos2, Rect, Sense, Shape, Stroke, Ui, UiBuilder,
    pos2, vec2,
};

use super::span::Span;
use crate::{
    app::{
        editing::apply::keyframe,
        editing::{command::KeyframeEdit, key_id::KeyId, playback::STEP_S, session::Session},
        shell::command::Commands,
        widgets::{
            icons::{Icon, icon_button},
            panel::describe,
            theme,
        },
    },
    params::{ValueType, format_number},
    preset::animation::{Easing, Keyframe, Track, steps},
};

/// Height of a track, points.
pub const TRACK: f32 = 24.0;
/// Height of a track whose curve is shown.
const OPEN_TRACK: f32 = 84.0;

/// Half of a mark's width, points.
const MARK: f32 = 5.5;

/// Curves are drawn point by point this far apart.
const CURVE_POINTS: f32 = 2.0;

pub const fn height(is_open: bool) -> f32 {
    if is_open { OPEN_TRACK } else { TRACK }
}

/// The rows of a frame, and the timeline's state that they change.
pub struct Tracks<'a> {
    pub session: &'a Session,
    pub commands: &'a Commands,
    pub span: &'a Span,
    /// Paths of the tracks whose curve is shown.
    pub open: &'a mut BTreeSet<String>,
    pub selected: &'a mut Option<KeyId>,
    /// Time of the dragged keyframe when the drag began, seconds.
    pub grabbed_s: &'a mut Option<f64>,
}

impl Tracks<'_> {
    pub fn track_ui(&mut self, ui: &mut Ui, track: &Track) {
        let is_open = self.open.contains(&track.path());
        let (rect, _) =
            ui.allocate_exact_size(vec2(ui.available_width(), height(is_open)), Sense::hover());
        if !ui.is_rect_visible(rect) {
            return;
        }
        ui.painter()
            .hline(rect.x_range(), rect.top() + 0.5, (1.0, theme::line()));
        let left = self.span.rect().left() - 10.0;
        self.gutter_ui(
            ui,
            track,
            Rect::from_min_max(rect.min, pos2(left - theme::GAP, rect.bottom())),
            is_open,
        );
        let rail = Rect::from_min_max(pos2(left, rect.top()), rect.max);
        let curve = is_open.then(|| Curve::of(track, rail.shrink2(vec2(0.0, 12.0))));
        match &curve {
            Some(curve) => curve.paint(ui, track, self.span),
            None => bars(ui, track, self.span, rail),
        }
        for (index, key) in track.keys().iter().enumerate() {
            let y = curve
                .as_ref()
                .map_or(rail.center().y, |curve| curve.y(key.value[0]));
            self.mark_ui(ui, track, index, pos2(self.span.x(key.time_s), y));
        }
    }

    /// Name and value of a track, and the button that opens its curve.
    fn gutter_ui(&mut self, ui: &mut Ui, track: &Track, rect: Rect, is_open: bool) {
        let path = track.path();
        let top = Rect::from_min_size(rect.min, vec2(rect.width(), TRACK));
        let mut row = ui.new_child(
            UiBuilder::new()
                .id_salt((&path, "gutter"))
                .max_rect(top)
                .layout(Layout::left_to_right(Align::Center)),
        );
        row.spacing_mut().item_spacing.x = 2.0;
        let (icon, verb) = if is_open {
            (Icon::Down, "Close")
        } else {
            (Icon::Right, "Show")
        };
        if icon_button(&mut row, icon, &format!("{verb} the curve of {path}")).clicked()
            && !self.open.remove(&path)
        {
            self.open.insert(path.clone());
        }
        let value = value_text(track, self.session.shown_time_s());
        let painter = ui.painter_at(top);
        let (font, y) = (FontId::proportional(13.0), top.center().y);
        let shown = painter.text(
            pos2(top.right(), y),
            Align2::RIGHT_CENTER,
            value,
            FontId::monospace(11.5),
            theme::text_weak(),
        );
        let name = Rect::from_min_max(
            pos2(row.cursor().left() + theme::HALF, top.top()),
            pos2(shown.left() - 6.0, top.bottom()),
        );
        ui.painter_at(name).text(
            pos2(name.left(), y),
            Align2::LEFT_CENTER,
            &path,
            font,
            theme::text(),
        );
        if is_open && let Some([low, high]) = Curve::of(track, rect).shown_range() {
            let (at, text) = (
                pos2(name.left(), y + 18.0),
                format!("{} to {}", format_number(low), format_number(high)),
            );
            ui.painter_at(rect).text(
                at,
                Align2::LEFT_CENTER,
                text,
                FontId::proportional(11.5),
                theme::text_weak(),
            );
        }
    }

    /// One keyframe: a click selects it and shows its time, a drag moves it, the menu eases and
    /// removes it.
    fn mark_ui(&mut self, ui: &mut Ui, track: &Track, index: usize, at: Pos2) {
        let key = &track.keys()[index];
        let id = KeyId {
            effect: track.effect().clone(),
            field: track.field().name.clone(),
            time_s: key.time_s,
        };
        let hit = Rect::from_center_size(at, vec2(2.0 * MARK + 4.0, 2.0 * MARK + 8.0));
        let response = ui.interact(
            hit,
            egui::Id::unique((track.path(), "mark", index)),
            Sense::click_and_drag(),
        );
        describe(
            &response,
            egui::Role::Button,
            format!("Key {} {:.3} s", track.path(), key.time_s),
        );
        let is_selected = self.selected.as_ref() == Some(&id);
        paint_mark(
            ui,
            at,
            key.easing,
            is_selected,
            response.hovered() || response.dragged() || response.has_focus(),
        );
        if response.clicked() {
            *self.selected = Some(id.clone());
            self.commands.run(|app| app.state.session.playback.pause());
            let time_s = key.time_s;
            self.commands
                .run(move |app| app.state.session.playback.show(time_s));
        }
        if response.drag_started_by(egui::PointerButton::Primary) {
            (*self.selected, *self.grabbed_s) = (Some(id.clone()), Some(key.time_s));
        }
        if response.dragged_by(egui::PointerButton::Primary) {
            self.drag_mark(ui, track.keys(), index);
        }
        let mut edit = None;
        response.context_menu(|ui| edit = menu_ui(ui, track, key, &id));
        if let Some(edit) = edit {
            self.commands.step(move |app| keyframe(app, edit));
        }
        response.on_hover_ui(|ui| {
            ui.label(format!(
                "{} = {}",
                track.path(),
                value_text(track, key.time_s)
            ));
            ui.label(theme::weak(format!(
                "{:.3} s, then {}: {}",
                key.time_s,
                key.easing.name(),
                key.easing.about()
            )));
            ui.label(theme::weak(
                "Click to show this time, drag to move the key, right click for more",
            ));
        });
    }

    /// Moves the selected keyframe with the pointer, between its neighbors, on the grid of frames
    /// unless Shift is down.
    fn drag_mark(&self, ui: &Ui, keys: &[Keyframe], index: usize) {
        let (origin, now, is_free) = ui.input(|i| {
            (
                i.pointer.press_origin(),
                i.pointer.interact_pos(),
                i.modifiers.shift,
            )
        });
        let (Some(selected), Some(grabbed_s), Some(origin), Some(now)) =
            (&*self.selected, *self.grabbed_s, origin, now)
        else {
            return;
        };
        let pointed_s = grabbed_s + f64::from(now.x - origin.x) * self.span.seconds_per_point();
        let [from_s, _] = self.session.preset().clock.range_s;
        let snapped_s = if is_free {
            pointed_s
        } else {
            from_s + ((pointed_s - from_s) / STEP_S).round() * STEP_S
        };
        let limit = |neighbor: Option<&Keyframe>, gap_s: f64, edge_s: f64| {
            neighbor.map_or(edge_s, |key| key.time_s + gap_s)
        };
        let [first_s, last_s] = self.span.ends_s();
        let low = limit(index.checked_sub(1).map(|i| &keys[i]), 1e-3, first_s);
        let high = limit(keys.get(index + 1), -1e-3, last_s);
        if low <= high {
            let edit = KeyframeEdit::Move(selected.clone(), snapped_s.clamp(low, high));
            self.commands.run(|app| keyframe(app, edit));
        }
    }
}

/// The menu of a keyframe.
fn menu_ui(ui: &mut Ui, track: &Track, key: &Keyframe, id: &KeyId) -> Option<KeyframeEdit> {
    let mut edit = None;
    ui.set_min_width(140.0);
    ui.label(theme::weak("To the next key"));
    ui.add_enabled_ui(!steps(track.field()), |ui| {
        for easing in Easing::ALL {
            if ui
                .radio(easing == key.easing, easing.name())
                .on_hover_text(easing.about())
                .clicked()
            {
                edit = Some(KeyframeEdit::Ease(id.clone(), easing));
                ui.close();
            }
        }
    });
    ui.separator();
    if ui.button("Remove the key").clicked() {
        edit = Some(KeyframeEdit::Remove(id.clone()));
        ui.close();
    }
    edit
}

/// The value at a time, as short as it can be read.
fn value_text(track: &Track, time_s: f64) -> String {
    let value = track.value_at(time_s);
    match &track.field().value_type {
        ValueType::Color => {
            let [r, g, b, a] = std::array::from_fn(|i| value.get(i).map_or(0.0, |v| *v as f32));
            let [r, g, b, _] =
                egui::Rgba::from_rgba_unmultiplied(r, g, b, a).to_srgba_unmultiplied();
            format!("#{r:02x}{g:02x}{b:02x}")
        }
        ValueType::Bool => if value[0] == 0.0 { "false" } else { "true" }.into(),
        ValueType::Choice(words) => words.get(value[0] as usize).cloned().unwrap_or_default(),
        ValueType::U32 | ValueType::I32 => format!("{:.0}", value[0]),
        _ => value
            .iter()
            .map(|component| format!("{component:.3}"))
            .collect::<Vec<_>>()
            .join(" "),
    }
}

/// A diamond; a square where the value jumps.
fn paint_mark(ui: &Ui, at: Pos2, easing: Easing, is_selected: bool, is_near: bool) {
    let fill = if is_selected {
        theme::text_strong()
    } else {
        theme::accent()
    };
    let r = if is_near { MARK + 1.0 } else { MARK };
    let edge = Stroke::new(1.5, theme::bar());
    let shape = match easing {
        Easing::Hold => Shape::convex_polygon(
            [(-r, -r), (r, -r), (r, r), (-r, r)]
                .map(|(x, y)| at + vec2(x, y) * 0.75)
                .to_vec(),
            fill,
            edge,
        ),
        _ => Shape::convex_polygon(
            [(0.0, -r), (r, 0.0), (0.0, r), (-r, 0.0)]
                .map(|(x, y)| at + vec2(x, y))
                .to_vec(),
            fill,
            edge,
        ),
    };
    ui.painter().add(shape);
}

/// A line from the first keyframe to the last, brighter where the value moves.
fn bars(ui: &Ui, track: &Track, span: &Span, rail: Rect) {
    let painter = ui.painter_at(rail);
    for pair in track.keys().windows(2) {
        let moves = pair[0].value != pair[1].value && pair[0].easing != Easing::Hold;
        let color = if moves {
            theme::accent().gamma_multiply(0.6)
        } else {
            theme::raised_hover()
        };
        painter.hline(
            span.x(pair[0].time_s)..=span.x(pair[1].time_s),
            rail.center().y,
            (if moves { 2.0 } else { 1.0 }, color),
        );
    }
}

/// Maps values to heights.
struct Curve {
    low: f64,
    high: f64,
    rect: Rect,
}

impl Curve {
    /// The range is that of the keyframes' values: no easing leaves it.
    fn of(track: &Track, rect: Rect) -> Self {
        let values = track.keys().iter().flat_map(|key| &key.value);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        });
        Self { low, high, rect }
    }

    fn shown_range(&self) -> Option<[f64; 2]> {
        (self.low < self.high).then_some([self.low, self.high].map(|v| (v * 1e4).round() / 1e4))
    }

    fn y(&self, value: f64) -> f32 {
        let t = if self.low < self.high {
            (value - self.low) / (self.high - self.low)
        } else {
            0.5
        };
        self.rect.bottom() - (t as f32) * self.rect.height()
    }

    fn paint(&self, ui: &Ui, track: &Track, span: &Span) {
        let painter = ui.painter_at(self.rect.expand2(vec2(0.0, 12.0)));
        let rail = span.rect();
        let count = (rail.width() / CURVE_POINTS).ceil() as usize;
        let xs: Vec<f32> = (0..=count)
            .map(|i| (rail.left() + i as f32 * CURVE_POINTS).min(rail.right()))
            .collect();
        let values: Vec<Vec<f64>> = xs.iter().map(|x| track.value_at(span.time_s(*x))).collect();
        let value_type = &track.field().value_type;
        let components = if *value_type == ValueType::Color {
            3
        } else {
            value_type.components()
        };
        for component in 0..components {
            let points = xs
                .iter()
                .zip(&values)
                .map(|(x, value)| pos2(*x, self.y(value[component])))
                .collect();
            painter.add(Shape::line(
                points,
                Stroke::new(1.5, component_color(component, components)),
            ));
        }
    }
}

/// Red, green and blue for x, y, z and for r, g, b; the accent for a single number.
fn component_color(component: usize, components: usize) -> Color32 {
    if components == 1 {
        theme::accent().gamma_multiply(0.7)
    } else {
        [theme::red(), theme::green(), theme::accent()][component.min(2)].gamma_multiply(0.8)
    }
}
