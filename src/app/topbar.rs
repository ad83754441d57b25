//! The bar at the top: menus, which preset is open, which adapter draws it, what that costs and how wrong it is.

use eframe::egui::{self, Align, Color32, Layout, RichText, Sense, Ui, vec2};

use super::{
    App, Verdict,
    fields::dot,
    icons::{Icon, icon_button},
    screen::Inputs,
    shortcuts::Action,
    theme,
};
use crate::{gpu::Report, measure::ErrorReport};

impl App {
    pub(super) fn topbar_ui(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.set_min_height(28.0);
            self.menus_ui(ui);
            ui.add_space(theme::HALF);
            self.name_ui(ui);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                self.badge_ui(ui);
                ui.separator();
                self.cost_ui(ui);
            });
        });
    }

    fn menus_ui(&mut self, ui: &mut Ui) {
        use Action as A;
        let menus: [(&str, &[Option<A>]); 4] = [
            (
                "File",
                &[
                    Some(A::Open),
                    None,
                    Some(A::Save),
                    Some(A::SaveAs),
                    Some(A::Export),
                    None,
                    Some(A::CopyPreset),
                    Some(A::PastePreset),
                    None,
                    Some(A::Quit),
                ],
            ),
            ("Edit", &[Some(A::Undo), Some(A::Redo), None, Some(A::Randomize)]),
            ("Time", &[Some(A::Play), Some(A::StepBack), Some(A::StepForward), Some(A::Rewind), None, Some(A::RemoveKey)]),
            (
                "View",
                &[
                    Some(A::Frame),
                    Some(A::Front),
                    Some(A::Side),
                    Some(A::Top),
                    Some(A::Orthographic),
                    None,
                    Some(A::Verify),
                    Some(A::Overlays),
                    Some(A::Compare),
                    Some(A::FlipAb),
                    None,
                    Some(A::Panels),
                    Some(A::Timeline),
                    Some(A::Sweep),
                    Some(A::Log),
                    None,
                    Some(A::Extremes),
                    Some(A::CheatSheet),
                ],
            ),
        ];
        ui.spacing_mut().item_spacing.x = 2.0;
        for (title, actions) in menus {
            let chosen = ui.menu_button(title, |ui| menu_ui(ui, actions)).inner.flatten();
            if let Some(action) = chosen {
                self.perform(ui.ctx(), action);
            }
        }
        ui.add_space(theme::HALF);
        for (icon, action, able) in
            [(Icon::Left, A::PreviousPreset, true), (Icon::Right, A::NextPreset, true), (Icon::Reset, A::Undo, self.history.can_undo())]
        {
            let name = format!("{} ({})", action.about(), action.keys_text());
            if ui.add_enabled_ui(able, |ui| icon_button(ui, icon, &name)).inner.clicked() {
                self.perform(ui.ctx(), action);
            }
        }
    }

    /// Name of the preset, with a dot while it has changes that no file has.
    fn name_ui(&mut self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing.x = 6.0;
        let name = RichText::new(self.preset_file.title()).color(theme::TEXT_STRONG).strong();
        let place = match (&self.preset_file.path, self.preset_file.read_only) {
            (Some(path), _) => path.display().to_string(),
            (None, true) => "built in: Save asks for a name".into(),
            (None, false) => "not saved yet".into(),
        };
        ui.add(egui::Label::new(name).truncate().sense(Sense::hover())).on_hover_text(place);
        if self.is_modified() {
            dot(ui, theme::ACCENT);
            ui.label(theme::weak("unsaved"));
        }
    }

    /// Adapter, in amber with a plain sentence when it is software.
    fn badge_ui(&self, ui: &mut Ui) {
        let summary = &self.screen.gpu.summary;
        let color = if summary.software { theme::AMBER } else { theme::GREEN };
        let name = summary.name.split('(').next().unwrap_or_default().trim();
        let text = if summary.software { format!("{name} · software") } else { name.to_owned() };
        let response =
            ui.add(egui::Label::new(RichText::new(text).color(if summary.software { theme::AMBER } else { theme::TEXT })).truncate());
        response.on_hover_ui(|ui| {
            ui.label(RichText::new(&summary.name).color(theme::TEXT_STRONG));
            ui.label(format!("{} · {}", summary.backend, summary.driver));
            ui.label(theme::weak(format!("class {}", self.screen.gpu.caps.class())));
            if summary.software {
                ui.label(
                    RichText::new("A software adapter: the pictures are right, the times say nothing about a graphics card.")
                        .color(theme::AMBER),
                );
            }
        });
        dot(ui, color);
    }

    /// Cost and error, always side by side.
    fn cost_ui(&mut self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing.x = 6.0;
        let (color, error, hint) = error_line(self.verdict.as_ref(), self.motion.wanted.as_ref());
        let busy = self.verifying > 0;
        let verify = ui.add_enabled(!busy && self.motion.wanted.is_some(), egui::Button::new(if busy { "Verifying" } else { "Verify" }));
        if verify.on_hover_text("Let the exact CPU oracle judge this picture (V)").clicked() {
            self.verify();
        }
        if busy {
            ui.add(egui::Spinner::new().size(14.0));
        }
        ui.label(RichText::new(error).color(color)).on_hover_text(hint);
        ui.label(theme::weak("·"));
        ui.label(RichText::new(time_text(self.screen.report())).color(theme::TEXT_STRONG))
            .on_hover_text("Time of the newest frame on the device; passes are listed under Timing");
        self.pins_ui(ui);
    }

    /// AccuracyOptions that the preset pins, beside what they cost.
    fn pins_ui(&self, ui: &mut Ui) {
        let words = self.preset_file.preset.accuracy.pins.words();
        let text = match words.split(' ').count() {
            _ if words.is_empty() => return,
            1 => words.clone(),
            many => format!("{many} options pinned"),
        };
        ui.label(theme::weak("·"));
        ui.label(RichText::new(text).size(12.0).color(theme::ACCENT)).on_hover_text(words.replace(' ', "\n"));
    }
}

/// What a frame took on the device.
pub fn time_text(report: Option<&Report>) -> String {
    match report.map(|report| report.gpu_ms) {
        Some(Some(ms)) => format!("{ms:.2} ms GPU"),
        Some(None) => "no GPU timer".into(),
        None => "not timed".into(),
    }
}

/// The error of the picture `shown`, as far as it was measured, with its colour and its details.
pub fn error_line(verdict: Option<&Verdict>, shown: Option<&Inputs>) -> (Color32, String, String) {
    let Some(Verdict { of, findings }) = verdict else {
        return (theme::TEXT_WEAK, "error not measured".into(), "Verify compares every pixel with the oracle".into());
    };
    let a = &findings.accuracy;
    let (text, detail) = (error_text(a), details(a));
    if shown != Some(of) {
        return (theme::AMBER, format!("{text} · stale"), format!("Measured on an earlier picture. {detail}"));
    }
    let wrong = a.wrong_triangles + a.holes + a.double_hits + a.depth_without_id + a.overflow;
    (if wrong == 0 { theme::GREEN } else { theme::RED }, text, detail)
}

/// One menu's rows; none is a separator.
fn menu_ui(ui: &mut Ui, actions: &[Option<Action>]) -> Option<Action> {
    let mut chosen = None;
    ui.set_min_width(220.0);
    for action in actions {
        let Some(action) = action else {
            ui.separator();
            continue;
        };
        let button = egui::Button::new(action.about()).shortcut_text(action.keys_text()).min_size(vec2(208.0, theme::ROW));
        if ui.add(button).accessible_name(action.about()).clicked() {
            chosen = Some(*action);
            ui.close();
        }
    }
    chosen
}

/// The error in a few words: `0 wrong triangle ids, max Δ 1`.
pub fn error_text(accuracy: &ErrorReport) -> String {
    let triangle_ids = accuracy.wrong_triangles;
    let race = if accuracy.race_pixels > 0 { format!(", {} lost to the race", accuracy.race_pixels) } else { String::new() };
    format!(
        "{triangle_ids} wrong {}{race}, max Δ {}",
        if triangle_ids == 1 { "triangle id" } else { "triangle ids" },
        accuracy.max_color_delta
    )
}

fn details(a: &ErrorReport) -> String {
    format!(
        "{} pixels against the oracle: {} wrong triangle ids, {} explained by a snap of one unit, {} in a depth tie, {} holes, {} drawn twice; colour max Δ {} and RMS {:.3} of 255",
        a.pixels, a.wrong_triangles, a.explained_by_snap, a.depth_band_pixels, a.holes, a.double_hits, a.max_color_delta, a.rms_color_delta
    )
}
