//! The bar at the top: menus, the open preset, the adapter, and the cost and error of the picture.

use std::path::Path;

use egui::{self, Align, Layout, RichText, Sense, Ui, vec2};

use super::anti_aliasing::anti_aliasing_ui;
use crate::app::panels::panel::Panel;
use crate::app::{
    picture::{
        measured::{error_line, time_line},
        verification::Progress,
    },
    shell::{action::Action, command::Commands, state::State},
    trade::pace::about,
    widgets::{
        fields::dot,
        form::words_ui,
        icons::{Icon, icon_button},
        panel::{at_right, entry, is_phone},
        text::with_own_paths,
        theme::{self, ThemeChoice},
    },
};
use crate::preset_file::PLAIN;

/// The bar at the top: menus, the open preset, the adapter, and the cost and error of the picture.
pub struct TopBar;

/// Below this width of the window the adapter is a dot and controls stand closer, points.
const NARROW: f32 = 1080.0;

/// Room for milliseconds and for a count of wrong pixels, points: a number that comes or changes
/// moves nothing beside it.
const TIME_WIDTH: f32 = 104.0;
const ERROR_WIDTH: f32 = 96.0;

/// Menus with the groups of their entries.
const MENUS: [(&str, &[&[Action]]); 6] = {
    use Action::*;
    [
        (
            "File",
            &[
                &[New, Open, OpenWithScene, Plain],
                &[Save, SaveAs, Export, Film],
                &[CopyPreset, PastePreset, CopyLink, ExportAll],
                &[Quit],
            ],
        ),
        (
            "Edit",
            &[
                &[Undo, Redo],
                &[AddEffect, NewEffect, Randomize, RandomizeWindow, Sweep],
                &[Palette, Settings],
            ],
        ),
        (
            "Time",
            &[&[Play, StepBack, StepForward, Rewind], &[RemoveKey]],
        ),
        (
            "View",
            &[
                &[
                    Frame,
                    Front,
                    Side,
                    Top,
                    Orthographic,
                    AddBookmark,
                    NextBookmark,
                ],
                &[Handles, BoundingBox, Axes, Grid],
                &[Panels, Timeline, Timing, Log],
            ],
        ),
        (
            "Judge",
            &[
                &[Verify, Overlays, NextPixel, PreviousPixel],
                &[Compare, FlipAb],
                &[Trade, Extremes, Review],
            ],
        ),
        ("Help", &[&[Guide, CheatSheet], &[Report, About]]),
    ]
};

impl Panel for TopBar {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let is_phone = is_phone(ui.ctx());
        ui.horizontal(|ui| {
            ui.set_min_height(28.0);
            if is_phone {
                ui.menu_button("Menu", |ui| menus_ui(ui, state, commands));
            } else {
                menus_ui(ui, state, commands);
                ui.add_space(theme::HALF);
                steps_ui(ui, state, commands);
            }
            ui.add_space(theme::HALF);
            at_right(ui, |ui| {
                let is_narrow = is_narrow(ui);
                // In a narrow window the name of the preset needs the room more.
                ui.spacing_mut().item_spacing.x = if is_narrow { 4.0 } else { 6.0 };
                adapter_ui(ui, state, is_narrow);
                if !is_phone {
                    ui.separator();
                    anti_aliasing_ui(ui, state, commands);
                    cost_ui(ui, state, commands);
                }
                // What is left belongs to the name, which is cut if it is too long.
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    name_ui(ui, state, commands)
                });
            });
        });
    }
}

fn is_narrow(ui: &Ui) -> bool {
    ui.ctx().content_rect().width() < NARROW
}

fn menus_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    ui.spacing_mut().item_spacing.x = 2.0;
    for (title, groups) in MENUS {
        ui.menu_button(title, |ui| {
            if !is_phone(ui.ctx()) {
                ui.set_min_width(220.0);
            }
            // In a low window, or with large texts, a menu scrolls.
            let height = ui.ctx().content_rect().height() - 64.0;
            egui::ScrollArea::vertical()
                .max_height(height)
                // A menu offers less height than the window has.
                .min_scrolled_height(height)
                .show(ui, |ui| {
                    for (index, actions) in groups.iter().enumerate() {
                        if index > 0 {
                            ui.separator();
                        }
                        let actions = actions.iter().filter(|action| action.is_here());
                        actions.for_each(|action| entry_ui(ui, *action, state, commands));
                    }
                    if title == "View" {
                        looks_ui(ui, state.settings.theme, commands);
                    }
                });
        });
    }
}

/// Buttons for the presets beside the open one, and to undo.
fn steps_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let can_undo = state.history.can_undo();
    for (icon, action, is_enabled) in [
        (Icon::Left, Action::PreviousPreset, true),
        (Icon::Right, Action::NextPreset, true),
        (Icon::Reset, Action::Undo, can_undo),
    ] {
        let button = ui.add_enabled_ui(is_enabled, |ui| icon_button(ui, icon, &action.hint()));
        if button.inner.clicked() {
            commands.perform(action);
        }
    }
}

/// An action with its shortcut; a phone has no keys. What `is_on` is marked.
fn action_ui(ui: &mut Ui, action: Action, width: f32, is_on: bool, commands: &Commands) {
    let button = match is_phone(ui.ctx()) {
        true => entry(action.label(), theme::ROW),
        false => entry(action.label(), width).shortcut_text(action.shortcut_text()),
    };
    let button = ui.add(button.selected(is_on));
    if button.accessible_name(action.label()).clicked() {
        commands.perform(action);
        ui.close();
    }
}

/// The entry of an action in a menu.
fn entry_ui(ui: &mut Ui, action: Action, state: &State, commands: &Commands) {
    let open = &state.open;
    let is_on = match action {
        Action::Overlays => state.picture.overlays.is_any(),
        Action::Handles => open.handles,
        Action::BoundingBox => open.bounding_box,
        Action::Axes => open.axes,
        Action::Grid => open.grid,
        Action::Trade => open.trade,
        Action::Timing => open.timing,
        Action::Timeline => open.timeline,
        Action::Log => open.log,
        _ => false,
    };
    let is_enabled = match action {
        Action::Undo => state.history.can_undo(),
        Action::Redo => state.history.can_redo(),
        _ => true,
    };
    ui.add_enabled_ui(is_enabled, |ui| {
        action_ui(ui, action, 208.0, is_on, commands)
    });
    if action == Action::Open {
        ui.menu_button("Open recent", |ui| recents_ui(ui, state, commands));
    }
}

/// Recent files, newest first. Those that are gone are greyed.
fn recents_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    ui.set_max_width(420.0);
    let recents = &state.settings.recents;
    if recents.is_empty() {
        ui.label(theme::weak("No file was opened yet."));
        return;
    }
    for path in recents.iter() {
        let is_missing = state.files.missing_files.contains(path);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let folder = path
            .parent()
            .and_then(Path::file_name)
            .unwrap_or_default()
            .to_string_lossy();
        let detail = if is_missing { "missing" } else { &folder };
        let button = egui::Button::new(&*name)
            .shortcut_text(detail)
            .truncate()
            .min_size(vec2(280.0, theme::ROW));
        let button = ui
            .add_enabled(!is_missing, button)
            .on_hover_text(with_own_paths(path.display().to_string()));
        if button
            .on_disabled_hover_text(format!("{} is gone", path.display()))
            .accessible_name(format!("Recent {name}"))
            .clicked()
        {
            commands.open(path.to_string_lossy().into_owned());
            ui.close();
        }
    }
    ui.separator();
    if ui.button(Action::ForgetRecents.label()).clicked() {
        commands.perform(Action::ForgetRecents);
        ui.close();
    }
}

/// Theme, and size of texts and controls. A menu of its own, so that its parent fits into a small
/// window.
fn looks_ui(ui: &mut Ui, chosen: ThemeChoice, commands: &Commands) {
    ui.menu_button("Theme and size", |ui| {
        let themes = ThemeChoice::ALL.map(|choice| (choice, choice.label(), ""));
        let mut theme = chosen;
        if words_ui(ui, "", &mut theme, themes) {
            commands.run(move |app| app.change_settings(|settings| settings.theme = theme));
            ui.close();
        }
        ui.separator();
        for action in [Action::ScaleUp, Action::ScaleDown, Action::ScaleReset] {
            action_ui(ui, action, 240.0, false, commands);
        }
    });
}

/// Name of the preset, and whether it has unsaved changes.
fn name_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    ui.spacing_mut().item_spacing.x = 6.0;
    let open = &state.session.preset_file;
    let name = theme::strong(open.title()).strong();
    let file = match (&open.path, open.read_only) {
        (Some(path), _) => with_own_paths(path.display().to_string()),
        (None, true) => format!("{}, built in. Save asks for a file name.", open.id),
        (None, false) => "Not saved yet".into(),
    };
    let width = ui.available_width();
    let is_modified = state.session.is_modified();
    let rest = match is_modified {
        false => 0.0,
        true if width > 150.0 => 70.0,
        true => 16.0,
    };
    let is_on = open.look_id() == PLAIN;
    let look = match is_on {
        _ if width - rest <= 120.0 => 0.0,
        true => 46.0,
        false => 72.0,
    };
    ui.scope(|ui| {
        ui.set_max_width((width - rest - look).max(0.0));
        ui.add(egui::Label::new(name).truncate().sense(Sense::hover()))
            .on_hover_text(file);
    });
    if look > 0.0 {
        plain_ui(ui, [is_on, is_modified], commands);
    }
    if is_modified {
        dot(ui, theme::accent());
        if rest > 16.0 {
            ui.label(theme::weak("unsaved"));
        }
    }
}

/// A button of the plain look, which is pressed and says so while that is on, also where its values
/// were changed. Of another look the name tells, so that the button offers the plain one.
fn plain_ui(ui: &mut Ui, [is_on, is_modified]: [bool; 2], commands: &Commands) {
    let hint = match (is_on, is_modified) {
        (true, false) => {
            "The plain look is on: the scene's own materials under a sun with soft shadows"
        }
        (true, true) => "The plain look is on, with values changed: a click takes it as it was",
        _ => "Show this scene in the plain look",
    };
    let text = if is_on { "Plain" } else { "Show plain" };
    let button = egui::Button::new(text).small().selected(is_on);
    let button = ui.add(button).on_hover_text(hint);
    let is_clicked = button.accessible_name(Action::Plain.label()).clicked();
    if is_clicked && (!is_on || is_modified) {
        commands.perform(Action::Plain);
    }
}

/// The adapter; in amber if it is software. A dot alone where there is little room.
fn adapter_ui(ui: &mut Ui, state: &State, is_narrow: bool) {
    let gpu = &state.picture.screen.gpu;
    let summary = &gpu.summary;
    let name = summary.name.split('(').next().unwrap_or_default().trim();
    let (text, ink, light) = match summary.software {
        true => (format!("{name} · software"), theme::amber(), theme::amber()),
        false => (name.to_owned(), theme::text(), theme::green()),
    };
    let hint = |ui: &mut Ui| {
        ui.label(theme::strong(&summary.name));
        let driver = match summary.driver.as_str() {
            "" => "driver unknown",
            driver => driver,
        };
        ui.label(format!("{} · {driver}", summary.backend));
        ui.label(theme::weak(format!("class {}", gpu.caps.class())));
        if summary.software {
            let text = "A software adapter: its pictures are right, but its times do not tell how fast a graphics card is.";
            ui.label(RichText::new(text).color(theme::amber()));
        }
    };
    if !is_narrow {
        ui.add(egui::Label::new(RichText::new(text).color(ink)).truncate())
            .on_hover_ui(hint);
    }
    let place = ui.scope(|ui| dot(ui, light)).response;
    place.on_hover_ui(hint);
}

/// Cost and error, always side by side.
fn cost_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let (color, error, hint) = error_line(
        state.picture.verification.verdict(),
        state.picture.screen.requested(),
    );
    match state.picture.verification.progress() {
        // How far it is stands where the error will.
        Some(progress) => verifying_ui(ui, &progress, commands),
        None => {
            let is_drawn = state.picture.screen.requested().is_some();
            let keys = Action::Verify.shortcut_text();
            let about = format!("Compare every pixel with the exact CPU oracle ({keys})");
            let verify = ui.add_enabled(is_drawn, egui::Button::new("Verify"));
            if verify.on_hover_text(about).clicked() {
                commands.perform(Action::Verify);
            }
            let error = RichText::new(error).color(color);
            number_ui(ui, ERROR_WIDTH, Align::Min, error, hint);
        }
    }
    ui.label(theme::weak("·"));
    let (time, hint) = time_line(Some(&state.picture.screen));
    let time = theme::strong(time);
    number_ui(ui, TIME_WIDTH, Align::Max, time, hint);
    pins_ui(ui, state);
}

/// A text at the left (`Min`) or right (`Max`) of a room of at least `width` points, in a narrow window
/// of its own width.
fn number_ui(ui: &mut Ui, width: f32, side: Align, text: RichText, hint: String) {
    let layout = if side == Align::Max {
        Layout::right_to_left(Align::Center)
    } else {
        Layout::left_to_right(Align::Center)
    };
    let font = egui::TextStyle::Body;
    let galley = egui::WidgetText::from(text).into_galley(
        ui,
        Some(egui::TextWrapMode::Extend),
        f32::INFINITY,
        font,
    );
    let reserved = if is_narrow(ui) { 0.0 } else { width };
    let width = reserved.max(galley.size().x);
    ui.allocate_ui_with_layout(vec2(width, theme::ROW), layout, |ui| {
        ui.set_min_width(width);
        ui.label(galley).on_hover_text(hint);
    });
}

/// How far the oracle is, and a button that ends it.
fn verifying_ui(ui: &mut Ui, progress: &Progress, commands: &Commands) {
    let cancel = ui
        .button("Cancel")
        .on_hover_text("Stop verifying")
        .accessible_name("Cancel verifying");
    if cancel.clicked() {
        commands.run(|app| app.state.picture.verification.cancel());
    }
    let text = RichText::new(format!("{} left", about(progress.left_s))).size(11.0);
    let bar = egui::ProgressBar::new(progress.fraction as f32)
        .desired_width(ERROR_WIDTH)
        .text(text)
        .fill(theme::accent_ground());
    ui.add(bar)
        .on_hover_text(format!("Verifying: {}", progress.stage));
    ui.request_repaint_after_secs(0.1);
}

/// Accuracy options that the preset pins, as `coverage=fixed8` or `2 options pinned by you`: the
/// file has some of them, and the person has chosen the others since.
fn pins_ui(ui: &mut Ui, state: &State) {
    let pins = state.session.preset().accuracy.pins;
    let words = pins.words();
    let filed = state.session.as_filed().preset.accuracy.pins.words();
    let is_filed = |word: &&str| filed.split(' ').any(|known| known == *word);
    let (of_file, own): (Vec<&str>, Vec<&str>) = words.split(' ').partition(is_filed);
    let text = match (of_file.len(), own.len()) {
        _ if words.is_empty() => return,
        // In a narrow window the name needs the room more; the section Accuracy has them too.
        _ if ui.available_width() < 150.0 => return,
        (0, 1) | (1, 0) => words.clone(),
        // Where the name needs the room, the hint says by whom.
        (file, own) if ui.available_width() < 420.0 => format!("{} pinned", file + own),
        (count, 0) => format!("{count} options pinned by the preset"),
        (0, count) => format!("{count} options pinned by you"),
        (file, own) => format!("{} options pinned, {own} by you", file + own),
    };
    let by = |who: &str, words: &[&str]| match words {
        [] => String::new(),
        words => format!("Pinned by {who}:\n{}\n", words.join("\n")),
    };
    let hint = by("the preset", &of_file) + &by("you, not saved yet", &own);
    ui.add_space(theme::GAP);
    ui.label(RichText::new(text).size(12.0).color(theme::accent()))
        .on_hover_text(hint.trim_end());
}
