//! Over the picture: its state on the left, buttons of views on the right, and a hint while a file hovers.

use eframe::egui::{self, Align2, Color32, FontId, Rect, RichText, Ui, pos2};

use crate::{
    app::{
        action::Action,
        command::{Commands, Picking},
        golden_check::Outcome,
        icons::{Icon, icon_button},
        session::FileId,
        state::State,
        theme,
    },
    scene::camera::Projection,
};

pub fn chips_ui(ui: &mut Ui, state: &State, commands: &Commands, rect: Rect, is_comparing: bool) {
    let corner = Rect::from_min_max(rect.min + egui::vec2(12.0, 10.0), rect.max);
    let layout = egui::Layout::left_to_right(egui::Align::TOP);
    let mut left = ui.new_child(egui::UiBuilder::new().id_salt("state").max_rect(corner).layout(layout));
    for (color, text) in states(state) {
        theme::toast_frame(theme::line())
            .inner_margin(egui::Margin::symmetric(8, 4))
            .show(&mut left, |ui| ui.label(RichText::new(text).size(12.0).color(color)));
    }
    golden_ui(&mut left, state);
    let corner = Rect::from_min_max(pos2(rect.right() - 320.0, rect.top() + 8.0), pos2(rect.right() - 10.0, rect.top() + 36.0));
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    let mut right = ui.new_child(egui::UiBuilder::new().id_salt("views").max_rect(corner).layout(layout));
    right.spacing_mut().item_spacing.x = 2.0;
    views_ui(&mut right, state, commands, is_comparing);
    if ui.ctx().input(|i| !i.raw.hovered_files.is_empty()) {
        let (fill, stroke) = (theme::accent_ground().gamma_multiply(0.5), (2.0, theme::accent()));
        ui.painter().rect(rect.shrink(8.0), 8.0, fill, stroke, egui::StrokeKind::Inside);
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, "Drop to open", FontId::proportional(20.0), theme::text_strong());
    }
}

/// Whether the preset still gives its golden, after a file was reloaded.
fn golden_ui(ui: &mut Ui, state: &State) {
    let open = FileId::of(&state.session.preset_file);
    let Some(check) = state.live.golden.as_ref().filter(|check| check.file == open) else { return };
    let color = if check.outcome == Outcome::Same { theme::green() } else { theme::amber() };
    let frame = theme::toast_frame(theme::line()).inner_margin(egui::Margin::symmetric(8, 4));
    let badge = frame.show(ui, |ui| ui.label(RichText::new(check.text()).size(12.0).color(color)));
    badge.inner.on_hover_text(check.hint());
}

/// What is unusual about the picture, each with its color.
fn states(state: &State) -> Vec<(Color32, String)> {
    let (session, screen) = (&state.session, &state.screen);
    let mut states = Vec::new();
    if screen.picture().is_some() {
        if session.scenes.is_loading() {
            states.push((theme::text(), "loading the scene".into()));
        }
        if session.scenes.has_failed() {
            states.push((theme::red(), "last good picture: this scene cannot be shown".into()));
        } else if screen.is_refused() {
            states.push((theme::red(), "last good picture: this one cannot be drawn".into()));
        }
    }
    if screen.divisor() > 1 {
        states.push((theme::text_weak(), format!("1/{} resolution while moving", screen.divisor())));
    }
    if !session.muted.is_empty() {
        let names: Vec<_> = session.muted.iter().copied().collect();
        states.push((theme::amber(), format!("muted: {}", names.join(", "))));
    }
    let full = screen.report().map_or(0, |report| report.counters.full_pixels);
    if full > 0 {
        states.push((theme::red(), format!("x-ray overflow: {full} pixels have more layers than the sums hold")));
    }
    if let Some(order) = screen.report().and_then(|report| report.order) {
        let over = order.drawn.saturating_sub(order.limit);
        let percent = 100.0 * order.drawn as f64 / order.covered.max(1) as f64;
        if order.exceeds_sample_counter() {
            states.push((theme::red(), "more than 2^32 samples: the hardware order lost count. Use the submission order.".into()));
        }
        states.push((theme::text(), format!("drew {} of {} samples ({percent:.1} %), {over} too many", order.drawn, order.covered)));
    }
    if let Some(picking) = state.picking {
        let what = match picking {
            Picking::Point(_) => "a point".to_owned(),
            Picking::Part(_, kind) => format!("a {}", kind.name()),
        };
        states.push((theme::accent(), format!("click {what} of the model (Esc to cancel)")));
    }
    if !session.visible_stack().is_repeatable() {
        states.push((theme::amber(), "not reproducible: every frame may differ".into()));
    }
    if session.is_off_its_time() && !state.open.timeline {
        states.push((theme::text_weak(), format!("time {:.2} s", session.shown_time_s())));
    }
    states
}

fn views_ui(ui: &mut Ui, state: &State, commands: &Commands, is_comparing: bool) {
    let is_orthographic = state.session.camera().is_some_and(|camera| matches!(camera.projection, Projection::Orthographic { .. }));
    if icon_button(ui, Icon::Frame, "Frame the scene (Home)").clicked() {
        commands.perform(Action::Frame);
    }
    let text = if is_orthographic { "Ortho" } else { "Persp" };
    if ui.small_button(text).on_hover_text("Orthographic or perspective (5)").accessible_name("Orthographic").clicked() {
        commands.perform(Action::Orthographic);
    }
    for (text, action) in [("Top", Action::Top), ("Side", Action::Side), ("Front", Action::Front)] {
        let hint = format!("{} ({})", action.label(), action.shortcut_text());
        if ui.small_button(text).on_hover_text(hint).accessible_name(action.label()).clicked() {
            commands.perform(action);
        }
    }
    ui.add_space(theme::GAP);
    for (text, on, action) in [("Overlays", state.overlays.is_any(), Action::Overlays), ("Compare", is_comparing, Action::Compare)] {
        let button = egui::Button::new(text).small().selected(on);
        let hint = format!("{} ({})", action.label(), action.shortcut_text());
        if ui.add(button).on_hover_text(hint).accessible_name(action.label()).clicked() {
            commands.perform(action);
        }
    }
}
