//! Escape closes what is open, the innermost first: a menu or dialog, a scene that is loading, the
//! field that is typed into, a choice in the picture, a window, a panel.

use egui::{self, Key, Modifiers};

use super::app::App;
use crate::app::{
    files::open::cancel_loading,
    picture::apply::{mark, measure},
    shell::apply::{toggle_film, toggle_review},
};

/// Closes the innermost thing if Escape was pressed. `was_typing`: a text field had the focus in the
/// frame before, and Escape has just taken it away.
pub fn escape(app: &mut App, was_typing: bool) {
    // Dialogs and menus close themselves.
    if app.panels.has_dialog()
        || egui::Popup::is_any_open(&app.ctx)
        || !app.ctx.input(|i| i.key_pressed(Key::Escape))
    {
        return;
    }
    let Some((is_window, close)) = innermost(app) else {
        return;
    };
    // The search of a window is a part of it.
    if was_typing && !is_window {
        return;
    }
    app.ctx
        .input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape));
    close(app);
}

type Close = fn(&mut App);

/// What is open innermost: whether it is a window, and how it is closed.
fn innermost(app: &App) -> Option<(bool, Close)> {
    let App { state, panels, .. } = app;
    let all: [(bool, bool, Close); 15] = [
        (state.session.scenes.is_loading(), false, cancel_loading),
        (state.picture.picking.is_some(), false, |app| {
            app.state.picture.picking = None
        }),
        (panels.help.is_open(), true, |app| app.panels.help.close()),
        (panels.film.is_open(), true, toggle_film),
        (panels.sweep.is_open(), true, |app| {
            app.panels.sweep.toggle()
        }),
        (panels.randomize.is_open(), true, |app| {
            app.panels.randomize.toggle()
        }),
        (panels.extremes.is_open(), true, |app| {
            app.panels.extremes.toggle()
        }),
        (panels.review.is_open(), true, toggle_review),
        (state.open.settings, true, |app| {
            app.state.open.settings = false
        }),
        (state.picture.marker.is_some(), false, |app| {
            mark(&mut app.state, None)
        }),
        (!state.measured_points().is_empty(), false, |app| {
            measure(&mut app.state, None)
        }),
        (panels.viewport.compare.is_open(), false, |app| {
            app.panels.viewport.compare.close()
        }),
        (state.open.trade, false, |app| app.state.open.trade = false),
        (state.open.timing, false, |app| {
            app.state.open.timing = false
        }),
        (state.open.log, false, |app| app.state.open.log = false),
    ];
    all.into_iter()
        .find(|(is_open, ..)| *is_open)
        .map(|(_, is_window, close)| (is_window, close))
}
