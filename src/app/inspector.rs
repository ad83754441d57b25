//! Inspector: every value of the preset in folders, straight from the tables that presets and the command line use.

use eframe::egui::{self, RichText, Ui};

use super::{
    App,
    fields::{Row, row_ui},
    icons::{Icon, icon_button},
    theme, topbar,
};
use crate::{
    accuracy::AXES,
    effects::{EFFECTS, Effect},
    gpu::Explanation,
    params::{Field, ValueType},
    preset::{
        Tier,
        settings::{CAMERA, Setting},
    },
};

impl App {
    pub(super) fn inspector_ui(&mut self, ui: &mut Ui) {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            self.effects_ui(ui);
            self.scene_ui(ui);
            self.clips_ui(ui);
            self.camera_ui(ui);
            self.clock_ui(ui);
            self.accuracy_ui(ui);
            folder(ui, "Overlays", false, |ui| self.overlays_ui(ui));
            folder(ui, "Timing", true, |ui| self.timing_ui(ui));
            folder(ui, "Kernel", false, |ui| self.kernel_ui(ui));
            self.keys_folder(ui, "Preset", false, &["name", "about", "output.size"]);
            ui.add_space(16.0);
        });
    }

    /// The stack in order, then every effect that is not in it.
    fn effects_ui(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label(theme::heading("Effects"));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if icon_button(ui, Icon::Dice, "Randomize effects (R)").clicked() {
                    self.perform(ui.ctx(), super::shortcuts::Action::Randomize);
                }
            });
        });
        let stack: Vec<&'static Effect> = self.preset_file.preset.stack.0.iter().map(|enabled| enabled.effect).collect();
        if stack.is_empty() {
            ui.label(theme::weak("No effect is on, so the picture shows plain base colours. Switch one on below."));
            ui.add_space(theme::HALF);
        }
        for (place, effect) in stack.iter().enumerate() {
            self.enabled_effect_ui(ui, effect, place, stack.len());
        }
        ui.add_space(theme::HALF);
        for effect in EFFECTS.iter().copied().filter(|effect| !stack.contains(effect)) {
            ui.horizontal(|ui| {
                ui.set_min_height(theme::ROW);
                ui.add_space(theme::GAP);
                let mut on = false;
                let clicked = ui.checkbox(&mut on, shown_name(effect)).on_hover_text(effect.about).accessible_name(effect.name).clicked();
                let Some(conflict) = self.preset_file.preset.stack.rival(effect) else {
                    if clicked {
                        self.preset_file.preset.stack.enable(effect);
                    }
                    return;
                };
                if clicked {
                    self.log.tell(super::Level::Warning, conflict.to_string(), self.now_s);
                }
                let (name, other) = (effect.name, conflict.first);
                let instead = ui.small_button(format!("instead of {other}")).accessible_name(format!("{name} instead of {other}"));
                if instead.on_hover_text(format!("Switch {other} off and {name} on")).clicked() {
                    self.preset_file.preset.disable(other);
                    self.muted.remove(other);
                    self.preset_file.preset.stack.enable(effect);
                }
            });
        }
        ui.add_space(theme::GAP);
    }

    fn enabled_effect_ui(&mut self, ui: &mut Ui, effect: &'static Effect, place: usize, count: usize) {
        let frame =
            egui::Frame::new().fill(theme::BAR).corner_radius(6.0).inner_margin(egui::Margin { left: 8, right: 4, top: 3, bottom: 5 });
        frame.show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            self.effect_header_ui(ui, effect, place, count);
            ui.add_enabled_ui(!self.muted.contains(effect.name), |ui| self.effect_rows_ui(ui, effect));
        });
        ui.add_space(theme::HALF);
    }

    fn effect_header_ui(&mut self, ui: &mut Ui, effect: &'static Effect, place: usize, count: usize) {
        ui.horizontal(|ui| {
            ui.set_min_height(theme::ROW);
            let mut on = true;
            let title = RichText::new(shown_name(effect)).strong().color(theme::TEXT_STRONG);
            if ui.checkbox(&mut on, title).on_hover_text(effect.about).accessible_name(effect.name).clicked() {
                self.preset_file.preset.disable(effect.name);
                self.muted.remove(effect.name);
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 0.0;
                let muted = self.muted.contains(effect.name);
                let (icon, verb) = if muted { (Icon::EyeShut, "Show") } else { (Icon::Eye, "Mute") };
                if icon_button(ui, icon, &format!("{verb} {}", effect.name)).clicked() && !self.muted.remove(effect.name) {
                    self.muted.insert(effect.name);
                }
                for (icon, verb, to) in [(Icon::Down, "later", place + 1), (Icon::Up, "earlier", place.wrapping_sub(1))] {
                    let button = ui.add_enabled_ui(to < count, |ui| icon_button(ui, icon, &format!("Apply {} {verb}", effect.name)));
                    if button.inner.clicked() {
                        self.preset_file.preset.stack.0.swap(place, to);
                    }
                }
            });
        });
    }

    fn effect_rows_ui(&mut self, ui: &mut Ui, effect: &'static Effect) {
        for field in effect.fields {
            // Read anew for every row: a reset changes more than its own.
            let Some(words) = self.shown_words(effect) else { return };
            if !field.is_shown(effect.fields, &words) {
                continue;
            }
            let row = Row::of_field(effect, field, &words).keyed(self.keying(effect, field));
            let value = field.value(&words);
            let outcome = row_ui(ui, &row, &value);
            if outcome.hovered {
                self.hovered_row = Some((row.path.clone(), row.written(&value)));
            }
            if let Some(value) = outcome.value {
                self.put_value(effect, field, &value);
            }
            if let Some(ask) = outcome.ask {
                self.answer(ui.ctx(), ask);
            }
            // Directions are points without a unit, and extents are never negative.
            if field.value_type == ValueType::Point && field.unit == "m" && field.hard[0] < 0.0 {
                self.pick_ui(ui, effect, field);
            }
        }
    }

    /// Lets the next click on the model give a point.
    fn pick_ui(&mut self, ui: &mut Ui, effect: &'static Effect, field: &'static Field) {
        let is_picking = self.picking == Some((effect, field));
        ui.horizontal(|ui| {
            ui.add_space(theme::GAP);
            let button = ui.selectable_label(is_picking, if is_picking { "Click on the model" } else { "Pick on the model" });
            let button = button.on_hover_text("The next click in the picture sets this point");
            if button.accessible_name(format!("Pick {}.{}", effect.name, field.name)).clicked() {
                self.picking = if is_picking { None } else { Some((effect, field)) };
            }
        });
    }

    /// A folder with rows for keys of the preset.
    fn keys_folder(&mut self, ui: &mut Ui, title: &str, open: bool, paths: &[&str]) {
        folder(ui, title, open, |ui| paths.iter().for_each(|path| self.key_ui(ui, path)));
    }

    pub(super) fn key_ui(&mut self, ui: &mut Ui, path: &str) {
        let Some(setting) = Setting::find(path) else { return };
        let preset = &self.preset_file.preset;
        let Some(value) = setting.get(preset) else { return };
        let row = Row::of_setting(setting, preset);
        let outcome = row_ui(ui, &row, &value);
        if outcome.hovered {
            self.hovered_row = Some((row.path.clone(), row.written(&value)));
        }
        if let Some(value) = outcome.value {
            // While a person types, a value may break a rule; the preset keeps the last one that does not.
            drop(setting.set(&mut self.preset_file.preset, &value));
        }
        if let Some(ask) = outcome.ask {
            self.answer(ui.ctx(), ask);
        }
    }

    fn camera_ui(&mut self, ui: &mut Ui) {
        folder(ui, "Camera", false, |ui| {
            if self.preset_file.preset.camera.is_none() {
                ui.label(theme::weak("Frames the whole scene by itself. Move the picture, or pin the pose to type numbers."));
                if ui.button("Pin the pose").clicked() {
                    self.move_camera(|_| {});
                }
                return;
            }
            CAMERA.settings.iter().filter(|setting| setting.name != "up").for_each(|setting| self.key_ui(ui, &setting.path()));
            ui.horizontal(|ui| {
                if ui.button("Frame scene").clicked() {
                    self.frame_scene();
                }
                if ui.button("Back to automatic").on_hover_text("Forget the pose: the preset frames its scene by itself").clicked() {
                    self.preset_file.preset.camera = None;
                }
            });
        });
    }

    fn clock_ui(&mut self, ui: &mut Ui) {
        let before_s = self.preset_file.preset.clock.time_s;
        self.keys_folder(ui, "Clock", false, &["clock.time_s", "clock.range_s", "clock.loop", "clock.speed"]);
        if self.preset_file.preset.clock.time_s != before_s {
            self.show_own_time();
        }
    }

    fn accuracy_ui(&mut self, ui: &mut Ui) {
        folder(ui, "AccuracyRequest", true, |ui| {
            self.key_ui(ui, "accuracy.tier");
            AXES.iter().for_each(|axis| self.key_ui(ui, &format!("accuracy.{}", axis.name)));
            if self.preset_file.preset.accuracy.tier == Tier::Reference {
                ui.label(theme::weak("Reference asks for the most exact option on every axis."));
            }
        });
    }

    /// What the newest frame cost, pass by pass, beside its error.
    fn timing_ui(&self, ui: &mut Ui) {
        let Some(report) = self.screen.report() else {
            ui.label(theme::weak("Figures appear with the first frame."));
            return;
        };
        let frame = report.gpu_ms.map_or_else(|| "no timer on this adapter".into(), |ms| format!("{ms:.3} ms"));
        let error = self.accuracy().map_or_else(|| "not measured".into(), topbar::error_text);
        egui::Grid::new("timing").num_columns(2).spacing([16.0, 4.0]).min_col_width(96.0).show(ui, |ui| {
            let mut line = |name: &str, value: &str, strong: bool| {
                ui.label(if strong { RichText::new(name).color(theme::TEXT_STRONG) } else { RichText::new(name).color(theme::TEXT_WEAK) });
                ui.label(RichText::new(value).monospace().color(if strong { theme::TEXT_STRONG } else { theme::TEXT }));
                ui.end_row();
            };
            line("frame", &frame, true);
            line("error", &error, true);
            for (name, ms) in &report.passes {
                line(name, &format!("{ms:.3} ms"), false);
            }
            if let Some(culled) = report.culled {
                line("meshlets drawn", &culled.drawn.to_string(), false);
                line("left out", &culled.reasons(), false);
            }
            let c = &report.counters;
            for (name, count) in [
                ("non-finite", c.rejected_nonfinite),
                ("out of range", c.rejected_range),
                ("no area", c.degenerate),
                ("clipped", c.clipped),
                ("fan folds", c.flipped_clips),
                ("overflow", c.overflow),
                ("depth_without_id", c.depth_without_id),
            ] {
                if count != 0 {
                    line(name, &count.to_string(), false);
                }
            }
        });
        if self.screen.gpu.summary.software {
            ui.label(RichText::new("Times of a software adapter rank nothing but themselves.").color(theme::AMBER));
        }
    }

    fn kernel_ui(&self, ui: &mut Ui) {
        let Some(Explanation { key, passes, buffers, reasons, omitted, .. }) = self.screen.explanation() else {
            ui.label(theme::weak("The kernel is known with the first frame."));
            return;
        };
        ui.label(RichText::new(key).monospace().color(theme::TEXT_STRONG));
        let bytes: u64 = buffers.iter().map(|buffer| buffer.bytes).sum();
        ui.add_space(theme::HALF);
        ui.label(theme::weak(format!("{} passes, {} buffers of {} in all", passes.len(), buffers.len(), bytes_text(bytes))));
        for pass in passes {
            ui.label(RichText::new(&pass.name).monospace()).on_hover_text(&pass.why);
        }
        ui.add_space(theme::HALF);
        for buffer in buffers {
            ui.horizontal(|ui| {
                ui.label(RichText::new(&buffer.name).monospace()).on_hover_text(&buffer.why);
                ui.label(theme::weak(bytes_text(buffer.bytes)));
            });
        }
        for (title, notes) in [("chosen because", reasons), ("left out because", omitted)] {
            if !notes.is_empty() {
                ui.add_space(theme::HALF);
                ui.label(theme::heading(title));
            }
            for note in notes {
                ui.label(RichText::new(&note.name).monospace());
                ui.label(theme::weak(&note.why));
            }
        }
    }
}

/// `triangle_id` as people read it.
fn shown_name(effect: &Effect) -> String {
    let mut name = effect.name.replace('_', " ");
    if let Some(first) = name.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    name
}

pub(super) fn folder(ui: &mut Ui, title: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(theme::heading(title)).default_open(open).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        contents(ui);
        ui.add_space(theme::GAP);
    });
}

/// `1.5 MiB`.
pub fn bytes_text(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_read_as_words() {
        let names: Vec<_> = EFFECTS.iter().map(|effect| shown_name(effect)).collect();
        assert!(names.contains(&"Triangle id".to_owned()), "{names:?}");
    }
}
