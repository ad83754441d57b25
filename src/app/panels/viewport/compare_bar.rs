//! The bar of a comparison: how A and B are shown, how they differ, and which side is which.

use egui::{self, Align2, Rect, RichText, Ui, pos2, vec2};

use super::compare::{Compare, Difference, Mode};
use crate::{
    app::{
        picture::{screen::Inputs, verification::Verdict},
        shell::{action::Action, state::State},
        widgets::{
            form::{gain_ui, modes_ui},
            panel::plate,
            text::group_digits,
            theme,
        },
    },
    measure::compare::{pictures, triangle_ids},
};

/// The modes that show both at once.
const MODES: [(Option<Mode>, &str, &str); 3] = [
    (Some(Mode::Wipe), "Wipe", ""),
    (Some(Mode::SideBySide), "Side by side", ""),
    (Some(Mode::Difference), "Difference", ""),
];

/// Height of the bar, points.
const BAR: f32 = 30.0;

/// From the lower edge of the picture up to the bar and to the labels, points: above the plates of
/// both sides.
const UP_TO_BAR: f32 = 106.0;
const UP_TO_LABELS: f32 = 114.0;

/// Width of a picture below which the bar has a second line, and a plate only one, points.
const NARROW: f32 = 436.0;

pub fn is_narrow(rect: Rect) -> bool {
    rect.width() < NARROW
}

/// Height of the second line of the bar.
fn second_line(rect: Rect) -> f32 {
    if is_narrow(rect) { 20.0 } else { 0.0 }
}

pub fn up_to_labels(rect: Rect) -> f32 {
    UP_TO_LABELS + second_line(rect)
}

/// A label in the picture `rect` on each side, with the names of A and B.
pub fn labels_ui(
    ui: &Ui,
    rect: Rect,
    [name, name_b]: [&str; 2],
    sides: [Rect; 2],
    is_difference: bool,
) {
    // What both sides are is clear.
    let short = |name| match is_narrow(rect) {
        true => str::trim_start_matches(name, "this preset, "),
        false => name,
    };
    let [name, name_b] = [name, name_b].map(short);
    let first = if is_difference {
        "|A \u{2212} B|".to_owned()
    } else {
        format!("A \u{b7} {name}")
    };
    for (side, text, align) in [
        (sides[0], first, Align2::LEFT_BOTTOM),
        (sides[1], format!("B \u{b7} {name_b}"), Align2::RIGHT_BOTTOM),
    ] {
        // A side that is too narrow for its label has none.
        if side.width() < 100.0 || !side.is_positive() {
            continue;
        }
        let inner = side.shrink2(vec2(12.0, up_to_labels(rect) - 4.0));
        let corner = align.pos_in_rect(&inner);
        plate(&ui.painter_at(side), corner, align, inner, &text);
    }
}

/// The mode, and how much A and B differ.
pub fn bar_ui(ui: &mut Ui, compare: &mut Compare, state: &State, rect: Rect) {
    let known = difference_text(compare, state);
    if known.is_none() && compare.mode == Some(Mode::Difference) {
        let text = match state.picture.verification.is_running() {
            true => "A and B are being measured".to_owned(),
            false => format!(
                "Verify ({}) measures A and B",
                Action::Verify.shortcut_text()
            ),
        };
        let inner = rect.shrink(12.0);
        plate(
            ui.painter(),
            inner.center(),
            Align2::CENTER_CENTER,
            inner,
            &text,
        );
    }
    let text = known.unwrap_or_else(|| "A and B not compared yet".into());
    let width = 560.0f32.min(rect.width() - 24.0);
    let (is_narrow, more) = (is_narrow(rect), second_line(rect));
    let top = rect.bottom() - UP_TO_BAR - more;
    let corner = pos2(rect.center().x - width / 2.0, top);
    let rect = Rect::from_min_size(corner, vec2(width, BAR + more));
    let mut bar = ui.new_child(egui::UiBuilder::new().id_salt("compare bar").max_rect(rect));
    theme::toast_frame(theme::line())
        .inner_margin(egui::Margin::symmetric(8, 3))
        .show(&mut bar, |ui| {
            let rest_ui = |ui: &mut Ui, compare: &mut Compare| {
                if compare.kept.is_some() {
                    ui.spacing_mut().slider_width = 72.0;
                    let toward = egui::Slider::new(&mut compare.toward, 0.0..=1.0)
                        .show_value(false)
                        .text("A to B");
                    ui.add(toward)
                        .accessible_name("A toward B")
                        .on_hover_text("How far A is on the way to B: numbers and colors in between, effects and choices switch half way");
                }
                if !is_narrow {
                    ui.separator();
                }
                let label = egui::Label::new(RichText::new(&text).size(12.0).color(theme::text()))
                    .truncate();
                ui.add(label)
                    .on_hover_text("A against B, pixel by pixel. Verify (V) measures both.");
            };
            ui.spacing_mut().item_spacing = vec2(6.0, 0.0);
            ui.horizontal(|ui| {
                modes_ui(ui, "Compare", &mut compare.mode, MODES);
                if compare.mode == Some(Mode::Difference) {
                    let hint = "Factor of the difference";
                    gain_ui(ui, "Difference gain", &mut compare.gain, hint);
                }
                if !is_narrow {
                    rest_ui(ui, compare);
                }
            });
            if is_narrow {
                ui.horizontal(|ui| rest_ui(ui, compare));
            }
        });
}

/// `max \u{394} 12, RMS 0.31, 5 other triangles`, if both pictures have a verdict.
fn difference_text(compare: &mut Compare, state: &State) -> Option<String> {
    let on = |verdict: Option<&Verdict>, requested: Option<&Inputs>| {
        verdict
            .filter(|verdict| requested == Some(&verdict.of))
            .cloned()
    };
    let a = on(compare.verdict.as_ref(), compare.requested());
    let b = on(
        state.picture.verification.verdict(),
        state.picture.screen.requested(),
    );
    let (a, b) = a.zip(b)?;
    let is_known = |known: &&Difference| known.of[0].of == a.of && known.of[1].of == b.of;
    if let Some(known) = compare.difference.as_ref().filter(is_known) {
        return Some(known.text.clone());
    }
    let (found_a, found_b) = (&a.findings, &b.findings);
    let text = if found_a.size == found_b.size {
        let colors = pictures(&found_a.color, &found_b.color, 0);
        let others = triangle_ids(&found_a.triangle_ids, &found_b.triangle_ids).different;
        let word = if others == 1 { "triangle" } else { "triangles" };
        format!(
            "max \u{394} {}, RMS {:.3}, {} other {word}",
            colors.max_delta,
            colors.rms,
            group_digits(others)
        )
    } else {
        let ([w, h], [v, g]) = (found_a.size, found_b.size);
        format!("A has {w} x {h} pixels, B has {v} x {g}")
    };
    compare.difference = Some(Difference {
        of: [a, b],
        text: text.clone(),
    });
    Some(text)
}
