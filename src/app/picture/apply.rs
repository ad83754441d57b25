//! Carries out commands to the picture.

use super::{command::ViewCommand, screen::Inputs};
use crate::app::{panels::Panels, shell::state::State};

pub fn view(state: &mut State, panels: &mut Panels, command: ViewCommand) {
    match command {
        ViewCommand::ToggleOverlays => state.picture.overlays.toggle(),
        ViewCommand::ShowOverlay(overlay, on) => state.picture.overlays.set(overlay, on),
        ViewCommand::OverlayGain(gain) => state.picture.overlays.gain = gain,
        ViewCommand::CycleCompare => panels.viewport.compare.cycle(),
        ViewCommand::FlipCompare => panels.viewport.compare.flip(),
        ViewCommand::Mark(marker) => state.picture.marker = marker.map(|marker| *marker),
        ViewCommand::Pick(picking) => state.picture.picking = picking,
    }
}

/// Starts the oracle on the picture that is shown, and on the one it is compared with. Nothing
/// while it runs.
pub fn verify(state: &mut State, panels: &Panels) {
    if state.picture.verification.is_running() {
        return;
    }
    verify_shown(state);
    let compared = panels.viewport.compare.unjudged();
    if let Some(inputs) = compared.filter(|inputs| Some(inputs) != state.picture.screen.requested())
    {
        judge(state, inputs);
    }
}

/// Starts the oracle on the picture that is shown.
pub fn verify_shown(state: &mut State) {
    if let Some(inputs) = state.picture.screen.requested().cloned() {
        judge(state, inputs);
    }
}

fn judge(state: &mut State, inputs: Inputs) {
    let work = state
        .picture
        .verification
        .start(inputs.view.pixels() as f64);
    state
        .jobs
        .verify(state.picture.screen.gpu.clone(), inputs, work);
}
