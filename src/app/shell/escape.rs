//! Escape closes what is open, the innermost first: a menu or dialog, a scene that is loading, the
//! field that is typed into, a choice in the picture, a window, a panel.

use eframe::egui::{self, Key, Modifiers};

use super::{
    command::{Command, Commands, Toggle},
    state::State,
};
use crate::app::{panels::Panels, picture::command::ViewCommand};

/// What Escape closes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Closing {
    Loading,
    Picking,
    Marker,
    Measuring,
    Film,
    Sweep,
    Randomize,
    Extremes,
    Review,
    Settings,
    Compare,
    Trade,
    Timing,
    Log,
}

/// Closes the innermost thing if Escape was pressed. `was_typing`: a text field had the focus in
/// the frame before, and Escape has just taken it away.
pub fn escape(
    ctx: &egui::Context,
    state: &State,
    panels: &mut Panels,
    was_typing: bool,
    commands: &Commands,
) {
    // Dialogs and menus close themselves.
    if panels.has_dialog()
        || egui::Popup::is_any_open(ctx)
        || !ctx.input(|i| i.key_pressed(Key::Escape))
    {
        return;
    }
    let Some(closing) = innermost(state, panels) else {
        return;
    };
    // The search of a window is a part of it.
    let is_window = matches!(
        closing,
        Closing::Film
            | Closing::Sweep
            | Closing::Randomize
            | Closing::Extremes
            | Closing::Review
            | Closing::Settings
    );
    if was_typing && !is_window {
        return;
    }
    ctx.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape));
    match closing {
        Closing::Loading => commands.send(Command::CancelLoading),
        Closing::Picking => commands.send(Command::View(ViewCommand::Pick(None))),
        Closing::Marker => commands.send(Command::View(ViewCommand::Mark(None))),
        Closing::Measuring => commands.send(Command::View(ViewCommand::Measure(None))),
        Closing::Film => commands.send(Command::Toggle(Toggle::Film)),
        Closing::Sweep => commands.send(Command::Toggle(Toggle::Sweep)),
        Closing::Randomize => commands.send(Command::Toggle(Toggle::Randomize)),
        Closing::Extremes => commands.send(Command::Toggle(Toggle::Extremes)),
        Closing::Review => commands.send(Command::Toggle(Toggle::Review)),
        Closing::Settings => commands.send(Command::Toggle(Toggle::Settings)),
        Closing::Compare => panels.viewport.compare.close(),
        Closing::Trade => commands.send(Command::Toggle(Toggle::Trade)),
        Closing::Timing => commands.send(Command::Toggle(Toggle::Timing)),
        Closing::Log => commands.send(Command::Toggle(Toggle::Log)),
    }
}

fn innermost(state: &State, panels: &Panels) -> Option<Closing> {
    [
        (state.session.scenes.is_loading(), Closing::Loading),
        (state.picture.picking.is_some(), Closing::Picking),
        (panels.film.is_open(), Closing::Film),
        (panels.sweep.is_open(), Closing::Sweep),
        (panels.randomize.is_open(), Closing::Randomize),
        (panels.extremes.is_open(), Closing::Extremes),
        (panels.review.is_open(), Closing::Review),
        (state.open.settings, Closing::Settings),
        (state.picture.marker.is_some(), Closing::Marker),
        (!state.measured_points().is_empty(), Closing::Measuring),
        (panels.viewport.compare.is_open(), Closing::Compare),
        (state.open.trade, Closing::Trade),
        (state.open.timing, Closing::Timing),
        (state.open.log, Closing::Log),
    ]
    .into_iter()
    .find_map(|(is_open, closing)| is_open.then_some(closing))
}
