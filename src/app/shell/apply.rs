//! Carries out commands; those of a subject are carried out in its folder.

use eframe::egui::{self, ViewportCommand};

use super::{
    command::{Command, Commands, Toggle},
    log::Level,
    state::State,
};
use crate::{
    app::{
        editing::{
            apply::{keyframe, recall_seed, report, restore, row, set_text, set_values},
            command::KeyframeEdit,
        },
        files::{
            apply::{export_film, file, request_open},
            command::Manner,
            library, open,
            scene_loader::SceneKey,
        },
        panels::Panels,
        picture::apply::{draw_for_review, review, verify, view},
        widgets::reveal,
    },
    link, preset_file,
};

/// Carries out the commands that were sent, in order.
pub fn apply_all(ctx: &egui::Context, state: &mut State, panels: &mut Panels, commands: &Commands) {
    for command in commands.take() {
        apply(ctx, state, panels, command);
    }
}

/// Carries out `command`.
fn apply(ctx: &egui::Context, state: &mut State, panels: &mut Panels, command: Command) {
    if command.begins_step() {
        state.history.close();
    }
    match command {
        Command::Perform(action) => apply(ctx, state, panels, action.into()),
        Command::Undo => {
            state.observe(false);
            let before = state.history.undo();
            restore(state, before, "undo");
        }
        Command::Redo => {
            state.observe(false);
            let after = state.history.redo();
            restore(state, after, "redo");
        }
        Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
        Command::Edit(edit) => report(state, |state| state.session.edit(edit)),
        Command::Randomize => match state.session.randomize() {
            Some(seed) => state.notify(Level::Info, format!("Randomized with seed {seed}")),
            None => state.notify(
                Level::Info,
                "No effect is enabled, so there is nothing to randomize",
            ),
        },
        Command::VaryBy(percent) => {
            state.session.randomizer.vary_percent = percent.clamp(1.0, 100.0)
        }
        Command::Lock((effect, field), is_locked) => {
            state.session.randomizer.lock(&effect, &field, is_locked)
        }
        Command::RecallSeed(seed) => recall_seed(state, seed),
        Command::SetValues(values) => set_values(state, &values),
        Command::DrawCells(cells) => state
            .jobs
            .draw_cells(state.picture.screen.gpu.clone(), cells),
        Command::PinOptions(pins, axes) => {
            let mut accuracy = state.session.preset().accuracy;
            axes.iter()
                .for_each(|axis| accuracy.pins.set(axis, pins.get(axis)));
            state.session.preset_mut().accuracy = accuracy;
            state.observe(false);
            state.history.close();
            let words = pins.words();
            state.notify(
                Level::Info,
                if words.is_empty() {
                    "The planner chooses again".into()
                } else {
                    format!("Switched to {words}")
                },
            );
        }
        Command::Keyframe(edit) => keyframe(state, &mut panels.timeline, edit),
        Command::RemoveSelectedKey => match panels.timeline.selected.take() {
            Some(key) => keyframe(state, &mut panels.timeline, KeyframeEdit::Remove(key)),
            None => state.notify(
                Level::Info,
                "No key is selected. Click one on the timeline first.",
            ),
        },
        Command::Time(command) => {
            if let Some(hint) = state.session.change_time(command) {
                state.notify(Level::Info, hint);
            }
        }
        Command::Row(command) => row(ctx, state, command),
        Command::File(command) => file(ctx, state, panels, command),
        Command::View(command) => view(state, panels, command),
        Command::Review(command) => review(state, panels, command),
        Command::MeasureTrade(request, progress) => {
            if let Some(scene) = state.session.scene().cloned() {
                #[cfg(target_arch = "wasm32")]
                state.jobs.measure_in_worker(
                    request.preset_file(&state.session.preset_file),
                    scene,
                    *request,
                    progress,
                );
                #[cfg(not(target_arch = "wasm32"))]
                state.jobs.measure(
                    state.picture.screen.gpu.summary.name.clone(),
                    scene,
                    *request,
                    progress,
                );
            }
        }
        Command::MeasureTiers => state.picture.tier_times.is_looked_at = true,
        Command::ExportFilm(request, progress) => export_film(state, *request, progress),
        Command::Toggle(which) => toggle(state, panels, which),
        Command::Settings(command) => {
            if let Err(refused) = state.settings.change(ctx, command) {
                state.notify(Level::Warning, refused);
            }
        }
        Command::Library(command) => library::library(ctx, state, panels, command),
        Command::Verify => verify(state, panels),
        Command::CancelVerify => state.picture.verification.cancel(),
        Command::CancelLoading => open::cancel_loading(state, panels),
        Command::Mute(effect, true) => drop(state.session.muted.insert(effect.name.clone())),
        Command::Mute(effect, false) => drop(state.session.muted.remove(&effect.name)),
        Command::HoverRow { path, value } => state.clipboard.hovered_row = Some((path, value)),
        Command::CopyPreset => {
            ctx.copy_text(preset_file::to_line(&state.session.preset_file));
            state.notify(Level::Info, "Copied the preset as one line of text");
        }
        Command::CopyLink => copy_link(state),
        Command::Paste => ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
        Command::PasteText(text) => paste(state, panels, &text),
        Command::SetText(path, text) => set_text(state, &path, &text),
        Command::AddEffect(search) => panels.browser.effects.begin_adding(search),
        Command::Reveal(path) => {
            state.open.right = true;
            reveal::start(ctx, path);
        }
        Command::ClearLog => state.log.clear(),
        Command::Log(level, text) => state.log.add(level, text),
        Command::Notify(level, text) => state.notify(level, text),
    }
}

/// Has the link made that goes to the clipboard.
fn copy_link(state: &mut State) {
    let open = &state.session.preset_file;
    let scene = state.session.scenes.shown_for(&SceneKey::of(open));
    match (link::line(open), scene) {
        (Ok(line), Some(scene)) => {
            let page = state.settings.page.clone();
            state.jobs.link(page, line, open.clone(), scene.clone());
        }
        (Err(why), _) => state.notify(Level::Error, why),
        (_, None) => state.notify(Level::Info, "The scene of the preset is not loaded yet"),
    }
}

/// Text from the clipboard: a preset, or a value for a row.
fn paste(state: &mut State, panels: &mut Panels, text: &str) {
    state.history.close();
    let hovered = state
        .clipboard
        .hovered_row
        .as_ref()
        .map(|(path, _)| path.clone());
    let row = state.clipboard.paste_into.take().or(hovered);
    let is_preset = text.trim_start().starts_with("rasterlab1:");
    if preset_file::is_effect_text(text) {
        return library::paste_effect(state, text);
    }
    match row {
        Some(path) if !is_preset => set_text(state, &path, text.trim()),
        _ => match preset_file::from_line(text) {
            Ok(pasted) => request_open(
                state,
                panels,
                pasted,
                Manner::WithScene,
                "Pasted a preset".into(),
            ),
            Err(error) => state.notify(Level::Error, error.to_string()),
        },
    }
}

fn toggle(state: &mut State, panels: &mut Panels, which: Toggle) {
    let open = &mut state.open;
    match which {
        Toggle::Panels => {
            let is_any = open.left || open.right || open.timeline;
            (open.left, open.right, open.timeline) = (!is_any, !is_any, !is_any);
        }
        Toggle::Timeline => open.timeline = !open.timeline,
        Toggle::Trade => open.trade = !open.trade,
        Toggle::Timing => open.timing = !open.timing,
        Toggle::Log => open.log = !open.log,
        Toggle::Handles => open.handles = !open.handles,
        Toggle::BoundingBox => open.bounding_box = !open.bounding_box,
        Toggle::Axes => open.axes = !open.axes,
        Toggle::Grid => open.grid = !open.grid,
        Toggle::Settings => open.settings = !open.settings,
        Toggle::Palette => panels
            .palette
            .toggle(&state.session, panels.browser.entries()),
        Toggle::Extremes => panels.extremes.toggle(),
        Toggle::Review => {
            panels.review.toggle();
            if panels.review.is_open() {
                draw_for_review(state);
            }
        }
        Toggle::Randomize => panels.randomize.toggle(),
        Toggle::Sweep => panels.sweep.toggle(),
        Toggle::Film => {
            panels
                .film
                .toggle(state, panels.viewport.compare.kept.as_deref());
        }
    }
}
