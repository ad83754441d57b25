//! Timeline: the clock at hand. Play, step, scrub, loop and speed; below it the keys of every animated parameter.

mod ruler;
mod tracks;

use eframe::egui::{self, Align, DragValue, Layout, Rect, RichText, Ui, pos2, vec2};

use super::{
    App,
    icons::{Icon, icon_button, paint_diamond, toggle_button},
    keying::KeyId,
    shortcuts::Action,
    theme,
};
use crate::{
    params::Value,
    preset::{
        animation::{Easing, Track, steps},
        settings::Setting,
    },
};
use ruler::Span;

/// Width of the column with names and values.
const GUTTER: f32 = 236.0;
const RULER: f32 = 22.0;
const TRACK: f32 = 24.0;
/// Height of a track whose curve is shown.
const OPEN_TRACK: f32 = 84.0;
/// Most of the window's height that tracks take before they scroll.
const MOST_TRACKS: f32 = 172.0;
const TRANSPORT: f32 = 28.0;

/// What the panel remembers; no part of the preset.
#[derive(Default)]
pub struct Timeline {
    pub selected: Option<KeyId>,
    /// Tracks whose curve is shown, by path.
    open: std::collections::BTreeSet<String>,
    /// What is shown from left to right, seconds. Stands still while a button is down, or a drag would move its own ground.
    span_s: Option<[f64; 2]>,
    /// Where the key that is being dragged stood at first.
    grabbed_s: Option<f64>,
}

impl App {
    /// Height of the whole panel.
    pub(super) fn timeline_height(&self) -> f32 {
        let heights = self.animated().iter().map(|track| self.track_height(track)).sum::<f32>();
        let tracks = if heights == 0.0 { TRACK } else { heights.min(MOST_TRACKS) };
        // Margins, the line above, and the gaps between the three.
        12.0 + 1.0 + TRANSPORT + RULER + tracks + 2.0 * theme::HALF
    }

    /// Tracks of the enabled effects.
    fn animated(&self) -> Vec<Track> {
        let preset = &self.preset_file.preset;
        preset.animation.tracks().iter().filter(|track| preset.stack.get(track.effect().name).is_some()).cloned().collect()
    }

    fn track_height(&self, track: &Track) -> f32 {
        if self.timeline.open.contains(&track.path()) { OPEN_TRACK } else { TRACK }
    }

    pub(super) fn timeline_ui(&mut self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing.y = theme::HALF;
        self.timeline.selected = self.timeline.selected.filter(|key| self.find_keyframe(*key).is_some());
        ui.horizontal(|ui| {
            ui.set_height(TRANSPORT);
            self.transport_ui(ui);
            self.time_ui(ui);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                self.range_ui(ui);
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| self.selection_ui(ui));
            });
        });
        let tracks = self.animated();
        if self.timeline.span_s.is_none() || !ui.input(|i| i.pointer.any_down()) {
            self.timeline.span_s = Some(ruler::extent(self.preset_file.preset.clock.range_s, &tracks));
        }
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), RULER), egui::Sense::hover());
        let left = rect.left() + GUTTER.min(rect.width() * 0.4);
        let rail = Rect::from_min_max(pos2(left, rect.top()), rect.max);
        let span = Span::new(self.timeline.span_s.unwrap_or([0.0, 1.0]), rail.shrink2(vec2(10.0, 0.0)));
        self.ruler_ui(ui, rail, &span);
        let below = ui.available_rect_before_wrap();
        if tracks.is_empty() {
            self.hint_ui(ui);
        } else {
            ui.spacing_mut().item_spacing.y = 0.0;
            let scroll = egui::ScrollArea::vertical()
                .id_salt("tracks")
                .auto_shrink([false, true])
                .min_scrolled_height(TRACK)
                .max_height(MOST_TRACKS);
            scroll.show(ui, |ui| tracks.iter().for_each(|track| self.track_ui(ui, track, &span)));
        }
        let under = if tracks.is_empty() { rail } else { Rect::from_min_max(pos2(left, below.top()), below.max) };
        self.hand_ui(ui, rail.union(under), &span);
    }

    /// What to do where nothing is animated.
    fn hint_ui(&mut self, ui: &mut Ui) {
        if self.clips_hint_ui(ui) {
            return;
        }
        let (before, after) = if self.preset_file.preset.stack.0.is_empty() {
            ("Nothing is animated. Switch an effect on at the right; the", "beside each of its values sets a key at this time.")
        } else {
            ("Nothing is animated. The", "beside a value sets a key at this time. Go to another time, change the value, and it moves.")
        };
        ui.horizontal(|ui| {
            ui.set_height(TRACK);
            ui.spacing_mut().item_spacing.x = 6.0;
            ui.label(theme::weak(before));
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, TRACK), egui::Sense::hover());
            paint_diamond(ui.painter(), rect.center(), 4.5, egui::Color32::TRANSPARENT, theme::TEXT);
            ui.add(egui::Label::new(theme::weak(after)).truncate());
        });
    }

    /// Back, step, play, step, loop, speed.
    fn transport_ui(&mut self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing.x = 2.0;
        let play = if self.playback.playing { Icon::Pause } else { Icon::Play };
        for (icon, action) in [
            (Icon::ToStart, Action::Rewind),
            (Icon::StepBack, Action::StepBack),
            (play, Action::Play),
            (Icon::StepForward, Action::StepForward),
        ] {
            let keys = action.keys_text();
            let keys = if keys.is_empty() { keys } else { format!(" ({keys})") };
            if icon_button(ui, icon, &format!("{}{keys}", action.about())).clicked() {
                self.perform(ui.ctx(), action);
            }
        }
        let loops = self.preset_file.preset.clock.is_looping;
        let hint = if loops { "Loop: on; after the end comes the beginning" } else { "Loop: off; play stops at the end" };
        if toggle_button(ui, Icon::Loop, loops, "Loop").on_hover_text(hint).clicked() {
            self.preset_file.preset.clock.is_looping = !loops;
        }
        ui.add_space(theme::HALF);
        self.clock_value(ui, "clock.speed", 0, |drag| drag.speed(0.01).max_decimals(2).suffix(" ×"));
        ui.add_space(theme::GAP);
    }

    /// The time that is shown, to be typed or dragged; and what leads back to the preset's own.
    fn time_ui(&mut self, ui: &mut Ui) {
        let mut now_s = self.shown_time_s();
        let drag = DragValue::new(&mut now_s).speed(0.01).fixed_decimals(3).suffix(" s").update_while_editing(false);
        let response = ui.add_sized([96.0, theme::ROW], drag).accessible_name("Time").on_hover_text("The time that is shown");
        if response.changed() {
            self.show_time(now_s);
        }
        if self.is_off_its_time() {
            ui.spacing_mut().item_spacing.x = 2.0;
            let own = format!("{:.3} s", self.preset_file.preset.clock.time_s);
            if ui.small_button("Keep").on_hover_text("Make this the preset's own time, which pictures and goldens show").clicked() {
                self.keep_time();
            }
            if ui.small_button("Back").on_hover_text(format!("Show the preset's own time, {own}")).clicked() {
                self.playback.playing = false;
                self.show_own_time();
            }
        }
    }

    /// From and to, at the right end.
    fn range_ui(&mut self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing.x = 6.0;
        for (lane, word) in [(1, "to"), (0, "from")] {
            self.clock_value(ui, "clock.range_s", lane, |drag| drag.speed(0.02).max_decimals(3).suffix(" s"));
            ui.label(theme::weak(word));
        }
    }

    /// One number of a key of the clock; what its rule refuses is not taken.
    fn clock_value(&mut self, ui: &mut Ui, path: &str, index: usize, style: impl FnOnce(DragValue<'_>) -> DragValue<'_>) {
        let Some(setting) = Setting::find(path) else { return };
        let Some(Value::Numbers(mut components)) = setting.get(&self.preset_file.preset) else { return };
        let name = match setting.value_type.component_names().get(index) {
            Some(component) => format!("{path} {component}"),
            None => path.to_owned(),
        };
        let [low, high] = setting.hard;
        let drag = style(DragValue::new(&mut components[index]).range(low..=high).update_while_editing(false));
        let response = ui.add_sized([72.0, theme::ROW - 2.0], drag).accessible_name(name).on_hover_text(setting.doc);
        if response.changed() {
            // A begin after the end is refused, and the preset keeps its range.
            drop(setting.set(&mut self.preset_file.preset, &Value::Numbers(components)));
        }
    }

    fn find_keyframe(&self, key: KeyId) -> Option<(&Track, usize)> {
        let track = self.preset_file.preset.animation.get(key.effect.name, key.field)?;
        Some((track, track.at(key.time_s)?))
    }

    /// Time and easing of the selected key.
    fn selection_ui(&mut self, ui: &mut Ui) {
        let Some(key) = self.timeline.selected else { return };
        let Some((easing, is_stepped)) = self.find_keyframe(key).map(|(track, index)| (track.keys()[index].easing, steps(track.field())))
        else {
            return;
        };
        ui.spacing_mut().item_spacing.x = 6.0;
        ui.separator();
        ui.add(egui::Label::new(RichText::new(key.path()).color(theme::TEXT_STRONG)).truncate());
        let mut time_s = key.time_s;
        let drag = DragValue::new(&mut time_s).speed(0.01).max_decimals(3).suffix(" s").update_while_editing(false);
        let response = ui.add_sized([72.0, theme::ROW - 2.0], drag).accessible_name("Key time").on_hover_text("When this key is");
        if response.changed() {
            self.move_selected(time_s);
        }
        let mut chosen = easing;
        ui.add_enabled_ui(!is_stepped, |ui| {
            egui::ComboBox::from_id_salt("easing")
                .selected_text(easing.name())
                .width(74.0)
                .show_ui(ui, |ui| {
                    for easing in Easing::ALL {
                        ui.selectable_value(&mut chosen, easing, easing.name()).on_hover_text(easing.about());
                    }
                })
                .response
                .accessible_name("Key easing")
                .on_hover_text("The way to the next key")
                .on_disabled_hover_text("A value without fractions holds until its next key");
        });
        if chosen != easing {
            self.ease_key(key, chosen);
        }
        if icon_button(ui, Icon::Cross, "Remove the key (Delete)").clicked() {
            self.perform(ui.ctx(), Action::RemoveKey);
        }
    }

    /// Moves the selected key and stays on it.
    fn move_selected(&mut self, time_s: f64) {
        if let Some(key) = self.timeline.selected {
            let time_s = self.move_keyframe(key, time_s);
            self.timeline.selected = Some(KeyId { time_s, ..key });
        }
    }

    pub(super) fn remove_selected_key(&mut self) {
        match self.timeline.selected.take() {
            Some(key) => self.remove_key(key),
            None => self.tell(super::Level::Info, "No key is selected: click one on the timeline first"),
        }
    }
}
