//! Carries out commands to the picture.

use glam::DVec3;

use super::{
    command::{Marker, Measured, ViewCommand},
    review::ReviewCommand,
    screen::Inputs,
};
use crate::app::{
    files::scene_loader::SceneKey,
    panels::Panels,
    shell::{action::Action, log::Level, state::State},
};

pub fn view(state: &mut State, panels: &mut Panels, command: ViewCommand) {
    match command {
        ViewCommand::ToggleOverlays => state.picture.overlays.toggle(),
        ViewCommand::ShowOverlay(overlay, on) => state.picture.overlays.set(overlay, on),
        ViewCommand::NextPixel => step_pixel(state, true),
        ViewCommand::PreviousPixel => step_pixel(state, false),
        ViewCommand::OverlayGain(gain) => state.picture.overlays.gain = gain,
        ViewCommand::CycleCompare => panels.viewport.compare.cycle(),
        ViewCommand::FlipCompare => panels.viewport.compare.flip(),
        ViewCommand::Mark(marker) => {
            state.picture.marker = marker.map(|marker| *marker);
            state.picture.probed = None;
        }
        ViewCommand::Probe(pixel) => look_into(state, pixel, ""),
        ViewCommand::EndProbe => (state.picture.marker, state.picture.probed) = (None, None),
        ViewCommand::Measure(point) => measure(state, point),
        ViewCommand::Pick(picking) => state.picture.picking = picking,
    }
}

/// Measures from a point of the scene that is shown, or to it; a third point begins again.
fn measure(state: &mut State, point: Option<DVec3>) {
    let points = match state.measured_points() {
        [from] => vec![*from],
        _ => Vec::new(),
    };
    state.picture.measured = point.map(|point| Measured {
        of: SceneKey::of(&state.session.preset_file),
        points: [points, vec![point]].concat(),
    });
}

/// Marks a pixel of the judged picture, with `place` before what is known of it, and looks into it.
fn look_into(state: &mut State, pixel: [u32; 2], place: &str) {
    let (Some(findings), Some(of)) = (state.picture.findings(), state.picture.screen.requested())
    else {
        return;
    };
    let [[x, y], [width, height]] = [pixel, findings.size];
    if x >= width || y >= height {
        return;
    }
    if let Some(geometry) = findings.geometry.clone() {
        state.jobs.probe(of.clone(), geometry, pixel);
    }
    let i = (y * width + x) as usize;
    state.picture.marker = Some(Marker {
        of: of.clone(),
        uv: [
            (x as f32 + 0.5) / width as f32,
            (y as f32 + 0.5) / height as f32,
        ],
        text: format!("{place}{}", findings.pixel_text(i)),
    });
}

/// Goes to the next pixel that an overlay of errors or ties paints, in reading order, or to the
/// previous one; behind the last comes the first.
fn step_pixel(state: &mut State, is_forward: bool) {
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
    let marked = marked.map(|marker| {
        let [x, y] = [(marker.uv[0], width), (marker.uv[1], height)]
            .map(|(t, side)| (t * side as f32) as usize);
        y * width + x
    });
    let step = match is_forward {
        true => pixels
            .iter()
            .position(|i| marked.is_none_or(|marked| *i > marked))
            .unwrap_or(0),
        false => pixels
            .iter()
            .rposition(|i| marked.is_none_or(|marked| *i < marked))
            .unwrap_or(pixels.len().saturating_sub(1)),
    };
    let Some(i) = pixels.get(step).copied() else {
        return state.notify(Level::Info, "The overlays paint no error");
    };
    let place = format!("{} of {}: ", step + 1, pixels.len());
    look_into(state, [i % width, i / width].map(|at| at as u32), &place);
}

/// Carries out a command to the review, and draws what it needs next.
pub fn review(state: &mut State, panels: &Panels, command: ReviewCommand) {
    let review = &mut state.picture.review;
    match command {
        ReviewCommand::Begin => review.begin(panels.browser.with_goldens()),
        ReviewCommand::Stop => review.stop(),
        ReviewCommand::Show(index) => review.show(index),
        ReviewCommand::Next => review.next(),
        ReviewCommand::Reject => review.reject(),
        ReviewCommand::Accept => accept(state),
    }
    draw_for_review(state);
}

/// Writes the shown picture as a golden.
fn accept(state: &mut State) {
    let Some((name, drawn)) = state.picture.review.accept() else {
        let text = "The review shows no picture that can be accepted";
        return state.notify(Level::Info, text);
    };
    state.jobs.bless(name, state.files.folders.clone(), drawn);
}

/// Starts the oracle on the next picture of the review, if it draws none.
pub fn draw_for_review(state: &mut State) {
    if let Some(name) = state.picture.review.next_to_draw() {
        state.jobs.draw_golden(name, state.files.folders.clone());
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
    #[cfg(target_arch = "wasm32")]
    if let Some(preset_file) = inputs.preset(&state.session) {
        return state.jobs.verify_in_worker(preset_file, inputs, work);
    }
    state
        .jobs
        .verify(state.picture.screen.gpu.clone(), inputs, work);
}
