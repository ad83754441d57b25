//! The bar at the top: menus, the open preset, the adapter, and the cost and error of the picture.

use eframe::egui::{self, Align, Layout, RichText, Sense, Ui, vec2};

use crate::app::{
    action::Action,
    command::Commands,
    fields::dot,
    icons::{Icon, icon_button},
    measured::{error_line, time_line},
    panel::Panel,
    state::State,
    theme,
};

/// The bar at the top: menus, the open preset, the adapter, and the cost and error of the picture.
pub struct TopBar;

/// Menus with their entries; none is a separator.
const MENUS: [(&str, &[Option<Action>]); 4] = [
    (
        "File",
        &[
            Some(Action::Open),
            None,
            Some(Action::Save),
            Some(Action::SaveAs),
            Some(Action::Export),
            None,
            Some(Action::CopyPreset),
            Some(Action::PastePreset),
            None,
            Some(Action::Quit),
        ],
    ),
    ("Edit", &[Some(Action::Undo), Some(Action::Redo), None, Some(Action::Randomize)]),
    ("Time", &[Some(Action::Play), Some(Action::StepBack), Some(Action::StepForward), Some(Action::Rewind), None, Some(Action::RemoveKey)]),
    (
        "View",
        &[
            Some(Action::Frame),
            Some(Action::Front),
            Some(Action::Side),
            Some(Action::Top),
            Some(Action::Orthographic),
            None,
            Some(Action::Verify),
            Some(Action::Overlays),
            Some(Action::Compare),
            Some(Action::FlipAb),
            None,
            Some(Action::Panels),
            Some(Action::Timeline),
            Some(Action::Sweep),
            Some(Action::Timing),
            Some(Action::Log),
            None,
            Some(Action::Extremes),
            Some(Action::CheatSheet),
        ],
    ),
];

impl Panel for TopBar {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        ui.horizontal(|ui| {
            ui.set_min_height(28.0);
            menus_ui(ui, state, commands);
            ui.add_space(theme::HALF);
            name_ui(ui, state);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                adapter_ui(ui, state);
                ui.separator();
                cost_ui(ui, state, commands);
            });
        });
    }
}

fn menus_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    ui.spacing_mut().item_spacing.x = 2.0;
    for (title, actions) in MENUS {
        let chosen = ui.menu_button(title, |ui| menu_ui(ui, actions)).inner.flatten();
        if let Some(action) = chosen {
            commands.perform(action);
        }
    }
    ui.add_space(theme::HALF);
    let can_undo = state.history.can_undo();
    for (icon, action, is_enabled) in
        [(Icon::Left, Action::PreviousPreset, true), (Icon::Right, Action::NextPreset, true), (Icon::Reset, Action::Undo, can_undo)]
    {
        let name = format!("{} ({})", action.label(), action.shortcut_text());
        if ui.add_enabled_ui(is_enabled, |ui| icon_button(ui, icon, &name)).inner.clicked() {
            commands.perform(action);
        }
    }
}

/// The entries of one menu.
fn menu_ui(ui: &mut Ui, actions: &[Option<Action>]) -> Option<Action> {
    let mut chosen = None;
    ui.set_min_width(220.0);
    for action in actions {
        let Some(action) = action else {
            ui.separator();
            continue;
        };
        let button = egui::Button::new(action.label()).shortcut_text(action.shortcut_text()).min_size(vec2(208.0, theme::ROW));
        if ui.add(button).accessible_name(action.label()).clicked() {
            chosen = Some(*action);
            ui.close();
        }
    }
    chosen
}

/// Name of the preset, and whether it has unsaved changes.
fn name_ui(ui: &mut Ui, state: &State) {
    ui.spacing_mut().item_spacing.x = 6.0;
    let open = &state.session.preset_file;
    let name = RichText::new(open.title()).color(theme::TEXT_STRONG).strong();
    let file = match (&open.path, open.read_only) {
        (Some(path), _) => path.display().to_string(),
        (None, true) => "Built in. Save asks for a file name.".into(),
        (None, false) => "Not saved yet".into(),
    };
    ui.add(egui::Label::new(name).truncate().sense(Sense::hover())).on_hover_text(file);
    if state.session.is_modified() {
        dot(ui, theme::ACCENT);
        ui.label(theme::weak("unsaved"));
    }
}

/// The adapter; in amber if it is software.
fn adapter_ui(ui: &mut Ui, state: &State) {
    let gpu = &state.screen.gpu;
    let summary = &gpu.summary;
    let name = summary.name.split('(').next().unwrap_or_default().trim();
    let text = if summary.software { format!("{name} · software") } else { name.to_owned() };
    let ink = if summary.software { theme::AMBER } else { theme::TEXT };
    ui.add(egui::Label::new(RichText::new(text).color(ink)).truncate()).on_hover_ui(|ui| {
        ui.label(RichText::new(&summary.name).color(theme::TEXT_STRONG));
        ui.label(format!("{} · {}", summary.backend, summary.driver));
        ui.label(theme::weak(format!("class {}", gpu.caps.class())));
        if summary.software {
            let text = "A software adapter: its pictures are right, but its times do not tell how fast a graphics card is.";
            ui.label(RichText::new(text).color(theme::AMBER));
        }
    });
    dot(ui, if summary.software { theme::AMBER } else { theme::GREEN });
}

/// Cost and error, always side by side.
fn cost_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    ui.spacing_mut().item_spacing.x = 6.0;
    let (color, error, hint) = error_line(state.verification.verdict(), state.screen.requested());
    let is_busy = state.verification.is_running();
    let button = egui::Button::new(if is_busy { "Verifying" } else { "Verify" });
    let verify = ui.add_enabled(!is_busy && state.screen.requested().is_some(), button);
    if verify.on_hover_text("Compare every pixel with the exact CPU oracle (V)").clicked() {
        commands.perform(Action::Verify);
    }
    if is_busy {
        ui.add(egui::Spinner::new().size(14.0));
    }
    ui.label(RichText::new(error).color(color)).on_hover_text(hint);
    ui.label(theme::weak("·"));
    let (time, hint) = time_line(Some(&state.screen));
    ui.label(RichText::new(time).color(theme::TEXT_STRONG)).on_hover_text(hint);
    pins_ui(ui, &state.session.preset().accuracy.pins.words());
}

/// Accuracy options that the preset pins, as `coverage=fixed8 depth=log16`.
fn pins_ui(ui: &mut Ui, words: &str) {
    let text = match words.split(' ').count() {
        _ if words.is_empty() => return,
        1 => words.to_owned(),
        count => format!("{count} options pinned"),
    };
    ui.label(theme::weak("·"));
    ui.label(RichText::new(text).size(12.0).color(theme::ACCENT)).on_hover_text(words.replace(' ', "\n"));
}
