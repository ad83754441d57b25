//! Carries out commands to the picture.

use std::sync::Arc;

use glam::DVec3;

use super::{
    command::{Marker, Measured},
    findings::Findings,
    measured::error_text,
    review::{self, Review},
    screen::Inputs,
    state::PictureState,
    tier_times,
    verification::Verdict,
};
use crate::{
    app::{
        App,
        files::scene_loader::SceneKey,
        shell::{action::Action, log::Level, state::State},
    },
    work::Work,
};

/// Measures from a point of the scene that is shown, or to it; a third point begins again.
pub fn measure(state: &mut State, point: Option<DVec3>) {
    let points = match state.measured_points() {
        [from] => vec![*from],
        _ => Vec::new(),
    };
    state.picture.measured = point.map(|point| Measured {
        of: SceneKey::of(&state.session.preset_file),
        points: [points, vec![point]].concat(),
    });
}

/// Marks a place in the picture; none removes the mark, and what was told of it.
pub fn mark(state: &mut State, marker: Option<Marker>) {
    (state.picture.marker, state.picture.probed) = (marker, None);
}

/// Marks a pixel of the judged picture, with `place` before what is known of it, and looks into it.
pub fn look_into(state: &mut State, pixel: [u32; 2], place: &str) {
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
pub fn step_pixel(state: &mut State, is_forward: bool) {
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

/// Begins the review with every preset of the gallery that has a golden.
pub fn begin_review(app: &mut App) {
    let presets = app.panels.browser.with_goldens();
    app.state.picture.review.begin(presets);
    draw_for_review(&mut app.state);
}

/// Changes the review, and draws what it needs next.
pub fn review(state: &mut State, change: impl FnOnce(&mut Review)) {
    change(&mut state.picture.review);
    draw_for_review(state);
}

/// Makes the shown picture the golden.
pub fn accept_golden(state: &mut State) {
    match state.picture.review.accept() {
        Some((name, drawn)) => {
            let folders = state.files.folders.clone();
            state.jobs.bless(name, folders, drawn);
        }
        None => {
            let text = "The review shows no picture that can be accepted";
            state.notify(Level::Info, text);
        }
    }
    draw_for_review(state);
}

/// Takes a preset of the review beside its golden; none if they are the same.
pub fn take_reviewed(
    state: &mut State,
    name: &str,
    drawn: Result<Option<Arc<review::Drawn>>, String>,
) {
    state.picture.review.drawn(name, drawn);
    draw_for_review(state);
}

/// Takes how a golden was accepted.
pub fn take_blessed(state: &mut State, name: &str, outcome: Result<(), String>) {
    state.picture.review.blessed(name, outcome.is_ok());
    match outcome {
        Ok(()) => state.notify(Level::Info, format!("Accepted the golden of {name}")),
        Err(error) => state.notify(Level::Error, error),
    }
    draw_for_review(state);
}

/// Takes the verdict of the oracle on `of`: for A, for B, or for both if they are the same picture.
/// None if the judgement was canceled; then overlays do not begin it again.
pub fn take_verdict(
    app: &mut App,
    of: Inputs,
    work: &Arc<Work>,
    findings: Result<Option<Box<Findings>>, String>,
) {
    let state = &mut app.state;
    if !state.picture.verification.ended(work) {
        return;
    }
    match findings {
        Ok(None) => state.picture.verification.fail(of),
        Ok(Some(findings)) => {
            let (title, text) = (state.session.title(), error_text(&findings));
            let text = format!("verified {title}: {text}");
            state.log.add(Level::Info, text);
            let verdict = Verdict {
                of,
                findings: findings.into(),
            };
            tier_times::judge(state, &verdict);
            if !app.panels.viewport.compare.take_verdict(&verdict)
                || state.picture.screen.requested() == Some(&verdict.of)
            {
                state.picture.verification.set(verdict);
            }
        }
        Err(error) => {
            state.notify(Level::Error, error);
            state.picture.verification.fail(of);
        }
    }
}

/// Starts the oracle on the next picture of the review, if it draws none.
pub fn draw_for_review(state: &mut State) {
    if let Some(name) = state.picture.review.next_to_draw() {
        state.jobs.draw_golden(name, state.files.folders.clone());
    }
}

/// Starts the oracle on the picture that is shown, and on the one it is compared with; if only that
/// has no verdict, on that alone. Nothing while it runs.
pub fn verify(app: &mut App) {
    let PictureState {
        verification,
        screen,
        ..
    } = &app.state.picture;
    if verification.is_running() {
        return;
    }
    let shown = screen.requested();
    let compared = app.panels.viewport.compare.unjudged();
    let compared = compared.filter(|inputs| Some(inputs) != shown);
    if compared.is_none() || verification.verdict_on(shown).is_none() {
        verify_shown(&mut app.state);
    }
    if let Some(inputs) = compared {
        judge(&mut app.state, inputs);
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
