//! Commands that concern several subjects of the window.

use std::sync::Arc;

use super::{command::Edit, log::Level, state::State};
use crate::{
    app::{
        App,
        editing::{
            apply::{report, set_text},
            new_effect,
        },
        files::{apply::request_open, command::Manner, library, scene_loader::SceneKey},
        picture::apply::draw_for_review,
        settings::Settings,
        trade::request::{Progress, Request},
        widgets::reveal,
    },
    effects::Effect,
    link, preset_file,
};

impl App {
    /// Logs a message and shows it as a toast.
    pub fn notify(&mut self, level: Level, text: impl Into<String>) {
        self.state.notify(level, text);
    }

    /// Runs the commands that were sent, in order.
    pub fn apply(&mut self) {
        for command in self.commands.take() {
            command(self);
        }
    }

    /// Changes the preset.
    pub fn edit(&mut self, edit: Edit) {
        report(&mut self.state, |state| state.session.edit(edit));
    }

    /// Changes settings, and shows that at once.
    pub fn change_settings<T>(&mut self, change: impl FnOnce(&mut Settings) -> T) -> T {
        let settings = &mut self.state.settings;
        let changed = change(settings);
        settings.theme.choose(&self.ctx);
        self.ctx.set_zoom_factor(settings.scale);
        changed
    }

    /// Shows the row of this path, or the effect of this name, in the inspector.
    pub fn reveal(&mut self, path: String) {
        self.state.open.right = true;
        reveal::start(&self.ctx, path);
    }
}

/// Shows or hides the side panels and the timeline.
pub fn toggle_panels(app: &mut App) {
    let open = &mut app.state.open;
    let is_any = open.left || open.right || open.timeline;
    (open.left, open.right, open.timeline) = (!is_any, !is_any, !is_any);
}

pub fn toggle_palette(app: &mut App) {
    let entries = app.panels.browser.entries();
    app.panels.palette.toggle(&app.state.session, entries);
}

pub fn toggle_review(app: &mut App) {
    app.panels.review.toggle();
    if app.panels.review.is_open() {
        draw_for_review(&mut app.state);
    }
}

pub fn toggle_film(app: &mut App) {
    let kept = app.panels.viewport.compare.kept.as_deref();
    app.panels.film.toggle(&app.state, kept);
}

/// Asks for the name of a new effect, and for its hook unless it duplicates another effect.
pub fn ask_new_effect(app: &mut App, duplicated: Option<Arc<Effect>>) {
    let effects = &app.state.session.preset_file.effects;
    let folder = new_effect::folder(&app.state);
    app.panels
        .dialogs
        .ask_new_effect(duplicated, effects, folder);
}

/// Downloads every file that a page has as one archive.
pub fn export_all(app: &mut App) {
    #[cfg(target_arch = "wasm32")]
    crate::app::files::take_along::export(&mut app.state);
    let _ = app; // A desktop has its files.
}

/// Puts the preset on the clipboard.
pub fn copy_preset(app: &mut App) {
    let text = preset_file::to_line(&app.state.session.preset_file);
    app.ctx.copy_text(text);
    app.notify(Level::Info, "Copied the preset as one line of text");
}

/// Measures every combination of the options of the request's axes.
pub fn measure_trade(app: &mut App, request: Request, progress: Arc<Progress>) {
    let state = &app.state;
    let Some(scene) = state.session.scene().cloned() else {
        return;
    };
    #[cfg(target_arch = "wasm32")]
    state.jobs.measure_in_worker(
        request.preset_file(&state.session.preset_file),
        scene,
        request,
        progress,
    );
    #[cfg(not(target_arch = "wasm32"))]
    state.jobs.measure(
        state.picture.screen.gpu.summary.name.clone(),
        scene,
        request,
        progress,
    );
}

/// Has the link made that goes to the clipboard.
pub fn copy_link(state: &mut State) {
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
pub fn paste(app: &mut App, text: &str) {
    let state = &mut app.state;
    state.history.close();
    let hovered = state
        .clipboard
        .hovered_row
        .as_ref()
        .map(|(path, _)| path.clone());
    let row = state.clipboard.paste_into.take().or(hovered);
    let is_preset = preset_file::is_preset_text(text);
    if preset_file::is_effect_text(text) {
        return library::paste_effect(app, text);
    }
    match row {
        Some(path) if !is_preset => set_text(state, &path, text.trim()),
        _ => match preset_file::from_line(text) {
            Ok(pasted) => {
                let manner = match preset_file::is_look_text(text, &pasted) {
                    true => Manner::Look,
                    false => Manner::WithScene,
                };
                request_open(app, pasted, manner, "Pasted a preset".into());
            }
            Err(error) => state.notify(Level::Error, error.to_string()),
        },
    }
}
