//! What the window does in every frame, and when it closes, to be the same at the next start.

use std::path::Path;

use super::app::App;
use crate::app::{
    settings::OpenPanels,
    shell::{log::Level, state::State},
};

impl App {
    /// Keeps settings and session, and looks for recent files that are gone.
    pub(super) fn keep(&mut self, ctx: &egui::Context) {
        let State {
            settings,
            open,
            session,
            jobs,
            picture,
            now_s,
            ..
        } = &mut self.state;
        settings.open = OpenPanels {
            settings: false,
            ..self.fold.kept(*open)
        };
        settings
            .up_axes
            .follow(&session.preset_file, session.as_filed());
        settings.browsing = self.panels.browser.browsing();
        if settings.film != *self.panels.film.last() {
            settings.film = self.panels.film.last().clone();
        }
        ctx.input(|i| settings.window.follow(i.viewport(), settings.scale));
        let is_focused = ctx.input(|i| i.focused);
        if settings.recents != self.looked_for.0 || is_focused && !self.looked_for.1 {
            jobs.find_missing(settings.recents.iter().map(Path::to_owned).collect());
        }
        if settings.recents != self.looked_for.0 || is_focused != self.looked_for.1 {
            self.looked_for = (settings.recents.clone(), is_focused);
        }
        if !self.panels.dialogs.asks_restore() {
            self.keeper.begin_session();
        }
        let (error, wait_s) =
            self.keeper
                .follow(settings, (session, picture.review.kept()), *now_s);
        if let Some(error) = error {
            let text = format!("settings or session could not be kept: {error}");
            // The storage of a browser is full for everything that follows: it is said once.
            let is_known = self.state.log.entries().any(|entry| entry.text == text);
            match cfg!(target_arch = "wasm32") && !is_known {
                true => self.state.notify(Level::Warning, text),
                false => self.state.log.add(Level::Warning, text),
            }
        }
        if let Some(wait_s) = wait_s {
            ctx.request_repaint_after_secs(wait_s as f32 + 0.01);
        }
    }
}

impl Drop for App {
    /// Keeps settings and session. Not after a crash: then the session is marked as running, and
    /// the next start asks.
    fn drop(&mut self) {
        if !std::thread::panicking() && !self.loss.is_set() {
            let State {
                settings,
                session,
                picture,
                closing,
                ..
            } = &self.state;
            self.keeper.close(
                settings,
                (session, picture.review.kept()),
                closing.keeps_edits || !closing.may_quit,
            );
        }
    }
}
