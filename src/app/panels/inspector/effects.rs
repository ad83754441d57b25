//! The effects of the inspector: the stack in order, with the parameters of each. The others are
//! behind *Add effect*.

use std::sync::Arc;

use egui::{self, Rect, RichText, Sense, Ui, vec2};

use super::{
    effect_menu,
    precision::precision_ui,
    rows::{is_led_to, scroll_to_top},
    scope::scope_ui,
};
use crate::{
    app::{
        editing::stack_drag::{StackDrag, drop_ui},
        panels::effect_browser::groups::depends_on_order,
        picture::command::Picking,
        shell::{
            action::Action,
            command::{Commands, Edit, Parameter},
            state::State,
        },
        widgets::{
            fields::{Row, row_ui},
            icons::{Icon, icon_button, paint},
            panel::{at_right, describe, row},
            reveal, theme,
        },
    },
    effects::Effect,
    params::Measure,
    preset::LengthUnit,
};

pub fn effects_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let head = ui.horizontal(|ui| {
        ui.label(theme::heading("Effects"));
        at_right(ui, |ui| {
            if icon_button(ui, Icon::Dice, &Action::Randomize.hint()).clicked() {
                commands.perform(Action::Randomize);
            }
        });
    });
    if is_led_to(ui.ctx(), "Effects") {
        scroll_to_top(ui, head.response.rect);
    }
    let stack: Vec<&Arc<Effect>> = state
        .session
        .preset()
        .stack
        .0
        .iter()
        .map(|enabled| &enabled.effect)
        .collect();
    if stack.is_empty() {
        ui.label(theme::weak(
            "No effect is enabled, so the picture shows plain base colors.",
        ));
        ui.add_space(theme::HALF);
    }
    let top = ui.cursor().top();
    let rects: Vec<Rect> = (0..stack.len())
        .map(|index| enabled_ui(ui, state, commands, &stack, index))
        .collect();
    let area = Rect::from_x_y_ranges(
        ui.max_rect().x_range(),
        top..=rects.last().map_or(top, |last| last.bottom()),
    );
    let names: Vec<&str> = stack.iter().map(|effect| effect.name.as_str()).collect();
    drop_ui(ui, commands, &names, &rects, area);
    ui.add_space(theme::HALF);
    let size = vec2(ui.available_width(), theme::ROW + 4.0);
    let add = ui.add_sized(size, egui::Button::new("Add effect"));
    if add.on_hover_text(Action::AddEffect.hint()).clicked() {
        commands.perform(Action::AddEffect);
    }
    faults_ui(ui, state);
    ui.add_space(theme::GAP);
}

/// The files of effects that are faulty.
fn faults_ui(ui: &mut Ui, state: &State) {
    for (name, error) in state.files.live.effect_faults() {
        row(ui, |ui| {
            let label =
                ui.label(RichText::new(format!("{name}.wgsl is faulty")).color(theme::red()));
            label.on_hover_text(RichText::new(error).monospace());
        });
    }
}

/// Where the window remembers that the parameters of an effect are hidden.
fn fold_id(effect: &Effect) -> egui::Id {
    egui::Id::unique(("fold", &effect.name))
}

/// The effect of `stack` at `index`. Returns where it is.
fn enabled_ui(
    ui: &mut Ui,
    state: &State,
    commands: &Commands,
    stack: &[&Arc<Effect>],
    index: usize,
) -> Rect {
    let effect = stack[index];
    let frame = egui::Frame::new()
        .fill(theme::bar())
        .corner_radius(6.0)
        .inner_margin(egui::Margin {
            left: 8,
            right: 4,
            top: 3,
            bottom: 5,
        });
    let is_muted = state.session.muted.contains(&effect.name);
    if reveal::is_within(ui.ctx(), &effect.name) {
        ui.data_mut(|data| data.insert_temp(fold_id(effect), false));
    }
    let is_folded = ui
        .data(|data| data.get_temp(fold_id(effect)))
        .unwrap_or(false);
    let shown = frame.show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        header_ui(ui, state, commands, stack, index, (is_muted, is_folded));
        if is_folded {
            return;
        }
        ui.add_enabled_ui(!is_muted, |ui| {
            scope_ui(ui, state, commands, effect);
            let scene = state.session.scene();
            if let Some(why) = scene.and_then(|scene| effect.why_idle(scene)) {
                theme::notice(ui, theme::amber(), why);
            }
            parameters_ui(ui, state, commands, effect);
        });
        precision_ui(ui, state, commands, effect);
    });
    reveal::row(ui, &effect.name, shown.response.rect);
    ui.add_space(theme::HALF);
    shown.response.rect
}

fn header_ui(
    ui: &mut Ui,
    state: &State,
    commands: &Commands,
    stack: &[&Arc<Effect>],
    index: usize,
    (is_muted, is_folded): (bool, bool),
) {
    let (effect, count) = (stack[index], stack.len());
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        if count > 1 {
            grip_ui(ui, stack, index);
        }
        let mut on = true;
        if ui
            .checkbox(&mut on, "")
            .on_hover_text("Take it out of the stack")
            .accessible_name(&effect.name)
            .clicked()
        {
            commands.edit(Edit::Disable(effect.clone()));
        }
        let text = theme::strong(title(effect)).strong();
        let fold = ui
            .add(egui::Button::new(text).frame(false))
            .on_hover_text(&effect.about);
        let verb = if is_folded { "Unfold" } else { "Fold" };
        if fold
            .accessible_name(format!("{verb} {}", effect.name))
            .clicked()
        {
            ui.data_mut(|data| data.insert_temp(fold_id(effect), !is_folded));
        }
        at_right(ui, |ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            let more = icon_button(ui, Icon::More, &format!("More of {}", effect.name));
            egui::Popup::menu(&more).show(|ui| effect_menu::menu_ui(ui, state, commands, effect));
            let (icon, verb) = if is_muted {
                (Icon::EyeShut, "Show")
            } else {
                (Icon::Eye, "Mute")
            };
            if icon_button(ui, icon, &format!("{verb} {}", effect.name)).clicked() {
                let name = effect.name.clone();
                commands.run(move |app| app.state.session.mute(name, !is_muted));
            }
            for (icon, verb, to) in [
                (Icon::Down, "later", index + 1),
                (Icon::Up, "earlier", index.wrapping_sub(1)),
            ] {
                let button = ui.add_enabled_ui(to < count, |ui| {
                    icon_button(ui, icon, &format!("Apply {} {verb}", effect.name))
                });
                if button.inner.clicked() {
                    commands.edit(Edit::Swap(index, to));
                }
            }
        });
    });
}

/// What an effect is dragged by to another place of the stack.
fn grip_ui(ui: &mut Ui, stack: &[&Arc<Effect>], index: usize) {
    let effect = stack[index];
    let (rect, grip) = ui.allocate_exact_size(vec2(10.0, theme::ROW - 4.0), Sense::drag());
    describe(&grip, egui::Role::Button, format!("Drag {}", effect.name));
    let ink = if grip.hovered() || grip.dragged() {
        theme::text_strong()
    } else {
        theme::text_weak()
    };
    paint(
        ui.painter(),
        Icon::Grip,
        Rect::from_center_size(rect.center(), vec2(12.0, 12.0)),
        ink,
    );
    grip.dnd_set_drag_payload(StackDrag::Move(index));
    let others = depends_on_order(effect, stack);
    grip.on_hover_text(if others.is_empty() {
        "Drag to another place of the stack. No other effect depends on it.".into()
    } else {
        format!(
            "Drag to another place of the stack. It matters whether it comes before or after {}.",
            others.join(", ")
        )
    });
}

fn parameters_ui(ui: &mut Ui, state: &State, commands: &Commands, effect: &Arc<Effect>) {
    let Some(words) = state.session.shown_words(effect) else {
        return;
    };
    for field in effect
        .fields
        .iter()
        .filter(|field| field.is_shown(&effect.fields, &words))
    {
        let row = Row::of_parameter((effect.clone(), field.clone()), &words)
            .keyed(state.session.keying(effect, field));
        let row = if state.session.preset().unit == LengthUnit::Scene {
            row.in_radii()
        } else {
            row
        };
        row_ui(ui, commands, &row, &field.value(&words));
        if field.measure() == Measure::Point {
            pick_ui(
                ui,
                state.picture.picking.as_ref(),
                commands,
                (effect.clone(), field.clone()),
            );
        }
    }
}

/// A button that lets the next click on the model set a point.
fn pick_ui(ui: &mut Ui, picking: Option<&Picking>, commands: &Commands, parameter: Parameter) {
    let path = format!("{}.{}", parameter.0.name, parameter.1.name);
    let pick = Picking::Point(parameter);
    let is_picking = picking == Some(&pick);
    ui.horizontal(|ui| {
        ui.add_space(theme::GAP);
        let button = ui.selectable_label(
            is_picking,
            if is_picking {
                "Click on the model"
            } else {
                "Pick on the model"
            },
        );
        let button = button.on_hover_text("The next click in the picture sets this point");
        if button.accessible_name(format!("Pick {path}")).clicked() {
            let picking = (!is_picking).then_some(pick);
            commands.run(|app| app.state.picture.picking = picking);
        }
    });
}

/// `triangle_id` as `Triangle id`.
fn title(effect: &Effect) -> String {
    let mut name = effect.name.replace('_', " ");
    if let Some(first) = name.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    #[test]
    fn effects_read_as_words() {
        let names: Vec<_> = EFFECTS.iter().map(|effect| title(effect)).collect();
        assert!(names.contains(&"Triangle id".to_owned()), "{names:?}");
    }
}
