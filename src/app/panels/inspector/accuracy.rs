//! The folder of accuracy: one slider from draft to strict, what each tier was measured to cost and
//! judged to err by on the open picture, and below it, folded, the axes that the picture can use,
//! each with the option that the planner took and why.

use egui::{self, Align2, Color32, RichText, Sense, Ui, pos2, vec2};

use super::rows::{folder, setting_ui};
use crate::{
    accuracy::{AXES, Axis},
    app::{
        picture::{
            anti_aliasing,
            measured::{self, color_text, counts_text, others_text, time_line},
            tier_times::{self, TierNumbers, TierTime},
        },
        shell::{
            command::{Commands, Edit},
            state::State,
        },
        widgets::{panel::describe_chosen, text::short, theme},
    },
    params::Value,
    preset::{Tier, settings::Setting},
};

const TIER: &str = "accuracy.tier";

pub fn accuracy_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    folder(ui, "Accuracy", true, |ui| {
        let accuracy = state.session.preset().accuracy;
        tier_ui(ui, commands, accuracy.tier);
        tiers_ui(ui, state, commands, accuracy.tier);
        numbers_ui(ui, state);
        for path in ["accuracy.max_wrong_ppm", "accuracy.max_channel"] {
            setting_ui(ui, state, commands, path); // Only where the preset has a tolerance of its own.
        }
        axes_ui(ui, state, commands);
    });
}

/// What a tier allows, in a sentence.
const fn about(tier: Tier) -> &'static str {
    match tier {
        Tier::Draft => "Up to 2 % of the pixels may show a wrong triangle.",
        Tier::Fast => "Up to 0.1 % of the pixels may show a wrong triangle.",
        Tier::Precise => "Exact, given the snapped corners.",
        Tier::Reference => "Exact, with depths compared as integers too.",
        Tier::Strict => "The same bits on every adapter and on the CPU.",
    }
}

/// The slider: five marks with their names.
fn tier_ui(ui: &mut Ui, commands: &Commands, tier: Tier) {
    let Some(setting) = Setting::find(TIER) else {
        return;
    };
    let mut index = tier as usize;
    ui.horizontal(|ui| {
        ui.add_space(theme::GAP);
        let width = ui.available_width() - theme::GAP;
        ui.spacing_mut().slider_width = width;
        let slider = egui::Slider::new(&mut index, 0..=Tier::ALL.len() - 1).show_value(false);
        let slider = ui.add(slider).accessible_name(TIER).on_hover_ui(|ui| {
            for tier in Tier::ALL {
                ui.label(format!("{}: {}", tier.name(), about(tier)));
            }
        });
        if slider.changed() && index != tier as usize {
            commands.edit(Edit::Setting(setting, Value::Choice(index)));
        }
    });
    names_ui(ui, setting, commands, tier);
    ui.horizontal(|ui| {
        ui.add_space(theme::GAP);
        ui.label(theme::weak(about(tier)).size(11.5));
    });
}

/// The names of the tiers under their marks; a click on one takes it.
fn names_ui(ui: &mut Ui, setting: &'static Setting, commands: &Commands, chosen: Tier) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    // The handle of a slider stays half its height inside the rail.
    let [left, right] = [
        rect.left() + theme::GAP + 9.0,
        rect.right() - theme::GAP - 9.0,
    ];
    let last = (Tier::ALL.len() - 1) as f32;
    for (index, tier) in Tier::ALL.into_iter().enumerate() {
        let t = index as f32 / last;
        let (align, x) = match index {
            0 => (Align2::LEFT_CENTER, left - 9.0),
            _ if t == 1.0 => (Align2::RIGHT_CENTER, right + 9.0),
            _ => (Align2::CENTER_CENTER, left + t * (right - left)),
        };
        let color = if tier == chosen {
            theme::text_strong()
        } else {
            theme::text_weak()
        };
        let at = ui.painter().text(
            pos2(x, rect.center().y),
            align,
            tier.name(),
            egui::FontId::proportional(11.5),
            color,
        );
        let response = ui.interact(
            at.expand(2.0),
            egui::Id::unique(("tier", index)),
            Sense::click(),
        );
        describe_chosen(
            &response,
            egui::Role::Button,
            tier == chosen,
            format!("Tier {}", tier.name()),
        );
        if response.on_hover_text(about(tier)).clicked() && tier != chosen {
            commands.edit(Edit::Setting(setting, Value::Choice(index)));
        }
    }
}

/// What each tier costs and errs by on the open picture. While this is looked at, tiers are
/// measured.
fn tiers_ui(ui: &mut Ui, state: &State, commands: &Commands, chosen: Tier) {
    let pixels = state.picture.screen.drawn().map_or(0.0, |drawn| {
        f64::from(drawn.view.width) * f64::from(drawn.view.height)
    });
    let mut last: Option<(Tier, TierNumbers)> = None;
    let shown = ui.vertical(|ui| {
        for tier in Tier::ALL {
            let numbers = tier_times::numbers(state, tier);
            let same = last
                .as_ref()
                .zip(numbers.as_ref())
                .filter(|((_, last), numbers)| last.kernel == numbers.kernel)
                .map(|((last, _), _)| *last);
            let text = match (&numbers, same) {
                (Some(_), Some(same)) => format!("the same options here as {}", same.name()),
                (Some(numbers), None) => format!(
                    "{}, {}",
                    time_text(numbers.time, state.picture.screen.gpu.caps.timestamps),
                    error_text(numbers, pixels)
                ),
                (None, _) if state.picture.screen.plan().is_none() => "no time yet".into(),
                (None, _) => "this picture cannot be drawn so".into(),
            };
            let color = match tier == chosen {
                true => theme::text_strong(),
                false => theme::text_weak(),
            };
            let line = line_ui(ui, tier.name(), text, color);
            if let Some(same) = same {
                line.on_hover_text(same_text(state, tier, same));
            } else {
                last = numbers.map(|numbers| (tier, numbers));
            }
        }
    });
    let hint = "Milliseconds of a frame, measured on this picture while the window is at rest. Pixels and the largest difference of a \
                color as Verify has judged this picture, or the most that the options of the tier may err by. Tiers that take the same options \
                here are the same picture.";
    if ui.is_rect_visible(shown.response.on_hover_text(hint).rect) {
        commands.run(|app| app.state.picture.tier_times.is_looked_at = true);
    }
}

/// A name and what there is to say of it.
fn line_ui(ui: &mut Ui, name: &str, text: String, color: Color32) -> egui::Response {
    ui.horizontal(|ui| {
        ui.add_space(theme::GAP);
        ui.add_sized([64.0, 16.0], egui::Label::new(theme::weak(name).size(11.5)));
        ui.add(egui::Label::new(RichText::new(text).size(11.5).color(color)).wrap())
    })
    .inner
}

/// Why two tiers are the same here, and what would have to change for them to differ.
fn same_text(state: &State, tier: Tier, same: Tier) -> String {
    let pins = state.session.preset().accuracy.pins.words();
    let unpin = match pins.as_str() {
        "" => String::new(),
        pins => format!(" Options that are pinned stay in every tier; unpin them: {pins}."),
    };
    format!(
        "{} and {} would differ where an option saves time on this adapter and its error lies between what they allow: in another size, \
         on another model, or with other effects.{unpin}",
        same.name(),
        tier.name()
    )
}

fn time_text(time: TierTime, has_timer: bool) -> String {
    match time {
        _ if !has_timer => "no GPU timer".into(),
        TierTime::NotYet => "no time yet".into(),
        TierTime::Failed => "not measured, see the log".into(),
        TierTime::Ms(ms) => format!("{} ms", short(ms)),
    }
}

/// `no wrong pixel, 17 differ by rounding`, or what the options may err by.
fn error_text(numbers: &TierNumbers, pixels: f64) -> String {
    if let Some(judged) = numbers.judged {
        let counts = counts_text(judged.wrong, judged.by_rounding);
        return format!("{counts}{}", color_text(judged.channel));
    }
    let ppm = numbers.bound.wrong_ppm.min(1e6);
    let wrong = match (ppm * pixels * 1e-6).floor() as u64 {
        0 => "no wrong pixel expected".into(),
        most => format!("at most {}", counts_text(most, None)),
    };
    format!(
        "{wrong}{}",
        color_text(numbers.bound.channel.min(255.0) as u8)
    )
}

/// Milliseconds and error of the picture that is shown.
fn numbers_ui(ui: &mut Ui, state: &State) {
    let time = time_line(Some(&state.picture.screen)).0;
    let verdict = state.picture.verification.verdict();
    let (color, mut error, hint) = measured::error_line(verdict, state.picture.screen.requested());
    if verdict.is_none() {
        error += " (V)";
    }
    line_ui(ui, "this picture", time, theme::text_strong());
    line_ui(ui, "", error, color).on_hover_text(hint);
}

/// The axes that decide about something in the picture, and those that the preset pins.
fn axes_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let pins = &state.session.preset().accuracy.pins;
    let reason = |axis: &Axis| {
        state
            .picture
            .screen
            .plan()
            .and_then(|plan| plan.reason(axis))
    };
    let shown: Vec<(&Axis, Option<String>)> =
        AXES.iter().map(|axis| (axis, reason(axis))).collect();
    let shown: Vec<_> = shown
        .into_iter()
        .filter(|(axis, reason)| reason.is_some() || pins.get(axis).is_some())
        .collect();
    let pinned = AXES.iter().filter(|axis| pins.get(axis).is_some()).count();
    let title = match pinned {
        0 => format!("Axes ({})", shown.len()),
        _ => format!("Axes ({}, {pinned} pinned)", shown.len()),
    };
    ui.add_space(theme::HALF);
    egui::CollapsingHeader::new(theme::weak(title))
        .id_salt("accuracy axes")
        .show_unindented(ui, |ui| {
            for (axis, reason) in shown {
                setting_ui(ui, state, commands, &format!("accuracy.{}", axis.name));
                let why = reason.unwrap_or_else(|| {
                    "pinned, and this picture has nothing that it decides about".into()
                });
                ui.horizontal(|ui| {
                    ui.add_space(2.0 * theme::GAP);
                    let text = if anti_aliasing::is_automatic(
                        axis,
                        state.session.preset(),
                        state.picture.screen.requested(),
                    ) {
                        "2×2 anti-aliasing, a viewing aid that is not saved".to_owned()
                    } else {
                        why
                    };
                    ui.add(egui::Label::new(theme::small(text)).wrap());
                });
            }
            let others = AXES.len()
                - AXES
                    .iter()
                    .filter(|axis| reason(axis).is_some() || pins.get(axis).is_some())
                    .count();
            if others > 0 {
                ui.label(theme::small(others_text(others)));
            }
        });
}
