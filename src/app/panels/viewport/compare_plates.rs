//! The plates of a comparison: below each side what it shows, its time and its error.

use egui::{self, Align, Color32, Layout, Rect, RichText, Ui, pos2, vec2};

use super::{
    compare::{Compare, Mode},
    compare_bar::{is_narrow, up_to_labels},
};
use crate::{
    app::{
        editing::apply::keyframe,
        editing::command::KeyframeEdit,
        picture::{
            measured::{error_line, time_line},
            screen::Screen,
        },
        shell::{command::Commands, state::State},
        widgets::{
            icons::{Icon, icon_button},
            panel::at_right,
            theme,
        },
    },
    preset::{Animation, Preset},
};

/// Size of a plate, points; in a narrow picture both have this height together.
const PLATE: egui::Vec2 = vec2(312.0, 54.0);
/// Height of a plate of one line.
const LINE: f32 = 25.0;
/// Height of a label with a gap, points.
const LABEL: f32 = 26.0;

/// Shows the plates in `rect`. Returns what neither they nor the bar and the labels above them cover
/// of B's side.
pub fn plates_ui(
    ui: &mut Ui,
    compare: &mut Compare,
    (state, commands): (&State, &Commands),
    rect: Rect,
    mode: Mode,
) -> Rect {
    let half = ((rect.width() - 36.0) / 2.0).min(PLATE.x);
    let corner = rect.left_bottom() + vec2(12.0, -12.0 - PLATE.y);
    let mut left = rect.right() - 12.0 - half;
    let (size, second) = match is_narrow(rect) {
        true => (
            vec2(rect.width() - 24.0, LINE),
            pos2(corner.x, corner.y + PLATE.y - LINE),
        ),
        false => (vec2(half, PLATE.y), pos2(left, corner.y)),
    };
    let builder = |at| egui::UiBuilder::new().max_rect(Rect::from_min_size(at, size));
    if mode != Mode::B {
        plate_a_ui(
            &mut ui.new_child(builder(corner).id_salt("A")),
            compare,
            (state, commands),
        );
    }
    if mode == Mode::A {
        left = rect.left();
    } else {
        plate_b_ui(
            &mut ui.new_child(builder(second).id_salt("B")),
            compare,
            state,
        );
    }
    Rect::from_min_max(
        pos2(left - 12.0, rect.top()),
        pos2(rect.right(), rect.bottom() - up_to_labels(rect) - LABEL),
    )
}

fn plate_a_ui(ui: &mut Ui, compare: &mut Compare, (state, commands): (&State, &Commands)) {
    let (color, error, hint) = match compare.screen.as_ref().is_some_and(Screen::is_refused) {
        true => (
            theme::red(),
            "cannot be drawn".into(),
            "See the log.".into(),
        ),
        false => error_line(compare.verdict.as_ref(), compare.requested()),
    };
    let time = time_line(compare.screen.as_ref());
    let is_kept = compare.kept.is_some();
    let doc = if is_kept {
        "The preset as it was kept"
    } else {
        "This preset with the most exact option on every axis"
    };
    plate(
        ui,
        &format!("A · {}", compare.name()),
        doc,
        ((&time.0, &time.1), (&error, color, &hint)),
        |ui| {
            if ui
                .small_button("Keep B")
                .on_hover_text("Keep the preset as it is now, and show it as A")
                .clicked()
            {
                let session = &state.session;
                // Without muted effects the preset keeps its movement too.
                let kept = match session.muted.is_empty() {
                    true => session.preset().clone(),
                    false => Preset {
                        animation: Animation::default(),
                        ..session.visible_preset()
                    },
                };
                (compare.kept, compare.toward) = (Some(Box::new(kept)), 0.0);
            }
            let keys = if is_line(ui) { "Key" } else { "Key A to B" };
            if let Some(kept) = &compare.kept
                && ui
                    .small_button(keys)
                    .accessible_name("Key A to B")
                    .on_hover_text(
                        "Numbers and colors that differ get keyframes: A's at the begin of the clock, B's at its end",
                    )
                    .clicked()
            {
                let edit = KeyframeEdit::From(kept.clone());
                commands.step(move |app| keyframe(app, edit));
            }
            if is_kept
                && ui
                    .small_button("Reference")
                    .on_hover_text("Show the most exact options as A again")
                    .clicked()
            {
                (compare.kept, compare.toward) = (None, 0.0);
            }
        },
    );
}

fn plate_b_ui(ui: &mut Ui, compare: &mut Compare, state: &State) {
    let (color, error, hint) = error_line(
        state.picture.verification.verdict(),
        state.picture.screen.requested(),
    );
    let time = time_line(Some(&state.picture.screen));
    let key = state
        .picture
        .screen
        .explanation()
        .map_or(String::new(), |explanation| explanation.key.clone());
    plate(
        ui,
        &format!("B · {}", Compare::name_b(state)),
        &key,
        ((&time.0, &time.1), (&error, color, &hint)),
        |ui| {
            if icon_button(ui, Icon::Cross, "Close the comparison").clicked() {
                compare.close();
            }
        },
    );
}

/// Width that an error takes at least, points.
const LEAST_ERROR: f32 = 60.0;

/// Has a plate only one line?
fn is_line(ui: &Ui) -> bool {
    ui.max_rect().height() < PLATE.y
}

/// Title and buttons of a side, and below them its time and its error. On one line the time stands in
/// place of the name, which the picture has, too.
fn plate(
    ui: &mut Ui,
    title: &str,
    doc: &str,
    ((time, time_hint), (error, color, hint)): ((&str, &str), (&str, Color32, &str)),
    buttons: impl FnOnce(&mut Ui),
) {
    let is_narrow = is_line(ui);
    let title = match title.split_once(" · ") {
        Some((side, _)) if is_narrow => format!("{side} · {time}"),
        _ => title.to_owned(),
    };
    let error_ui = |ui: &mut Ui| {
        ui.add(egui::Label::new(RichText::new(error).size(12.0).color(color)).truncate())
            .on_hover_text(hint);
    };
    theme::toast_frame(theme::line())
        .inner_margin(egui::Margin::symmetric(10, if is_narrow { 1 } else { 6 }))
        .show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.horizontal(|ui| {
                at_right(ui, |ui| {
                    buttons(ui);
                    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                        ui.add(egui::Label::new(theme::strong(title).strong()).truncate())
                            .on_hover_text(if is_narrow { time_hint } else { doc });
                        if is_narrow && ui.available_width() > LEAST_ERROR {
                            error_ui(ui);
                        }
                    });
                });
            });
            if !is_narrow {
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = 6.0;
                    ui.label(RichText::new(time).size(12.0).color(theme::text()))
                        .on_hover_text(time_hint);
                    ui.label(theme::weak("·"));
                    error_ui(ui);
                });
            }
        });
}
