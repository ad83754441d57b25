//! Carries out commands to the picture.

use super::{
    command::{Marker, ViewCommand},
    screen::Inputs,
};
use crate::app::{
    panels::Panels,
    shell::{action::Action, log::Level, state::State},
};

pub fn view(state: &mut State, panels: &mut Panels, command: ViewCommand) {
    match command {
        ViewCommand::ToggleOverlays => state.picture.overlays.toggle(),
        ViewCommand::ShowOverlay(overlay, on) => state.picture.overlays.set(overlay, on),
        ViewCommand::NextPixel => next_pixel(state),
        ViewCommand::OverlayGain(gain) => state.picture.overlays.gain = gain,
        ViewCommand::CycleCompare => panels.viewport.compare.cycle(),
        ViewCommand::FlipCompare => panels.viewport.compare.flip(),
        ViewCommand::Mark(marker) => state.picture.marker = marker.map(|marker| *marker),
        ViewCommand::Probe(pixel) => probe(state, pixel),
        ViewCommand::EndProbe => state.picture.probed = None,
        ViewCommand::Pick(picking) => state.picture.picking = picking,
    }
}

/// Looks into a pixel of the judged picture.
fn probe(state: &State, pixel: [u32; 2]) {
    if let (Some(findings), Some(of)) = (state.picture.findings(), state.picture.screen.requested())
        && let Some(geometry) = findings.geometry.clone()
    {
        state.jobs.probe(of.clone(), geometry, pixel);
    }
}

/// Marks the next pixel that an overlay of errors paints, in reading order; behind the last comes
/// the first.
fn next_pixel(state: &mut State) {
    if !state.picture.overlays.is_any() {
        state.picture.overlays.toggle();
    }
    let overlays = &state.picture.overlays;
    let (Some(findings), Some(of)) = (state.picture.findings(), state.picture.screen.requested())
    else {
        let text = format!("{} first", Action::Verify.hint());
        return state.notify(Level::Info, text);
    };
    let [width, height] = findings.size.map(|side| side.max(1) as usize);
    let pixels = findings.painted(overlays.shown());
    let marked = state
        .picture
        .marker
        .as_ref()
        .filter(|marker| marker.of == *of);
    let last = marked.map(|marker| {
        let [x, y] = [(marker.uv[0], width), (marker.uv[1], height)]
            .map(|(t, side)| (t * side as f32) as usize);
        y * width + x
    });
    let next = pixels
        .iter()
        .position(|i| last.is_none_or(|last| *i > last))
        .unwrap_or(0);
    let Some(i) = pixels.get(next).copied() else {
        return state.notify(Level::Info, "The overlays paint no error");
    };
    let marker = Marker {
        of: of.clone(),
        uv: [
            ((i % width) as f32 + 0.5) / width as f32,
            ((i / width) as f32 + 0.5) / height as f32,
        ],
        text: format!(
            "{} of {}: {}",
            next + 1,
            pixels.len(),
            findings.pixel_text(i)
        ),
    };
    state.picture.marker = Some(marker);
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
    #[cfg(target_arch = "wasm32")]
    if let Some(preset_file) = inputs.preset(&state.session) {
        return state.jobs.verify_in_worker(preset_file, inputs, work);
    }
    state
        .jobs
        .verify(state.picture.screen.gpu.clone(), inputs, work);
}
