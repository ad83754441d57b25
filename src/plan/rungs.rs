//! Rungs: which one is taken on every axis of the ladder, and what no kernel can draw.

use super::{
    Accuracy, Caps, Note, PlanError, Tolerance, costs,
    explain::note,
    predict::{Prediction, predict, predict_all},
};
use crate::{
    effects::{
        Effect, Enabled, Stack,
        dots::Strung,
        hooks::{Layers, Shape},
        points, read,
        xray::{Reach, Xray},
    },
    ladder::{
        AXES, Coverage, Culling, Curl, Depth, DotWay, Rung, Rungs, ShadowMap, Skinning, State, Sums, Taps, Vertex, Vertices, Visibility,
    },
    math::SUBPIXEL_BITS,
    scene::needs::Needs,
};

/// Largest side of a picture whose pixels all lie inside the guard band of 1/4096 px.
const FIXED12_SIDE: u32 = 2047;

/// Most triangles whose ids leave packed32 eight bits for depth.
const PACKED32_TRIANGLES: u64 = (1 << 24) - 1;

/// The rungs of a picture, why each is taken, and what they are predicted to err by.
pub(super) struct Choice {
    pub rungs: Rungs,
    pub reasons: Vec<Note>,
    pub prediction: Prediction,
}

/// Chooses a rung on every axis: pins first, then whatever saves time and still fits the tolerance.
pub(super) fn choose(
    needs: &Needs,
    f32_positions: bool,
    stack: &Stack,
    caps: &Caps,
    accuracy: &Accuracy,
    layers: Option<Layers>,
) -> Result<Choice, PlanError> {
    let visibility = if caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 };
    let mut rungs = Rungs { visibility, ..accuracy.tier.base() };
    accuracy.pins.apply(&mut rungs);
    // How joints hold a mesh was settled with its pose; without joints the rung is nobody's.
    rungs.skinning = needs.skinning.unwrap_or_default();
    // So it is with shadows, which are drawn as finely as the view says.
    let has_light = stack.light().is_some();
    (rungs.shadow_map, rungs.taps) = if has_light { needs.shadow.rungs() } else { Default::default() };
    let has_dots = stack.dots().is_some();
    if !has_dots {
        rungs.dots = DotWay::default();
    }
    if !needs.splats {
        (rungs.curl, rungs.state) = (Curl::default(), State::default());
    }
    if layers == Some(Layers::Race) {
        rungs.visibility = Visibility::Race;
    }
    let tolerance = accuracy.tolerance();
    let far = far_away(&rungs, needs, accuracy, &tolerance);
    if far.is_some() {
        rungs.vertices = Vertices::Relative;
    }
    let mut reasons = Vec::new();
    let mut prediction = predict_all(&rungs, needs);
    let is_idle = |i: usize| !has_dots && i == DotWay::AXIS || !has_light && [ShadowMap::AXIS, Taps::AXIS].contains(&i);
    for (i, axis) in AXES.iter().enumerate().filter(|(i, _)| !is_idle(*i)) {
        if accuracy.pins.get(axis).is_some() {
            reasons.push(note(axis.name, format!("{}: pinned by the look", axis.words[rungs.get(axis)])));
            continue;
        }
        if let Some(why) = far.as_ref().filter(|_| i == Vertices::AXIS) {
            reasons.push(note(axis.name, why));
            continue;
        }
        let mut cheaper: Vec<usize> =
            (0..axis.words.len()).filter(|&place| i != Skinning::AXIS && costs::saves(axis, place, rungs.get(axis), needs, caps)).collect();
        cheaper.sort_by(|a, b| costs::of(axis, *a, needs, caps).total_cmp(&costs::of(axis, *b, needs, caps)));
        let fits = |place: &usize| {
            let mut tried = rungs;
            tried.set(axis, *place);
            check(&tried, needs, f32_positions, stack, caps).is_ok() && tolerance.holds(&predict_all(&tried, needs))
        };
        if let Some(place) = cheaper.into_iter().find(fits) {
            rungs.set(axis, place);
            prediction = predict_all(&rungs, needs);
            let (word, share, own) = (axis.words[place], costs::of(axis, place, needs, caps), predict(i, place, needs));
            let why = format!(
                "{word}: {share:.2} of the usual time, predicted to err by {:.0} of {:.0} ppm, {:.1} of {} in colour",
                own.wrong_ppm, tolerance.wrong_ppm, own.channel, tolerance.channel
            );
            reasons.push(note(axis.name, why));
        } else {
            let usual = axis.abouts[rungs.get(axis)].trim().trim_end_matches('.');
            reasons.push(note(axis.name, format!("{}: {}", axis.words[rungs.get(axis)], lowered(usual))));
        }
    }
    if let Some((rung, why)) = unfit_for_culling(&rungs, stack, layers) {
        let said = reasons.iter_mut().find(|note| note.name == AXES[Culling::AXIS].name);
        if let Some(note) = said {
            note.why = format!("{} instead of {}: {why}", rung.name(), rungs.culling.name());
        }
        rungs.culling = rung;
        prediction = predict_all(&rungs, needs);
    }
    check(&rungs, needs, f32_positions, stack, caps)?;
    Ok(Choice { rungs, reasons, prediction })
}

/// Why places are taken relative to the eye, where nobody asked: what lies far from its origin keeps its places only so, and
/// that costs nothing. A strict picture follows from the look alone.
fn far_away(rungs: &Rungs, needs: &Needs, accuracy: &Accuracy, tolerance: &Tolerance) -> Option<String> {
    let own = predict(Vertices::AXIS, rungs.vertices.place(), needs);
    let is_settled = accuracy.pins.rung::<Vertices>().is_some() || rungs.vertex == Vertex::Strict;
    (!is_settled && !tolerance.holds(&own)).then(|| {
        format!(
            "relative: so far from the origin, rounding moves a stored corner by up to {:.2} px, predicted to cost {:.0} of {:.0} ppm",
            needs.rounding_px[0], own.wrong_ppm, tolerance.wrong_ppm
        )
    })
}

/// What culling must come down to in a picture, and why, where it cannot be as it was asked for. Since it never shows, a look
/// that pins it goes on without it.
fn unfit_for_culling(rungs: &Rungs, stack: &Stack, layers: Option<Layers>) -> Option<(Culling, &'static str)> {
    let (most, why) = match (layers, rungs.visibility) {
        _ if rungs.vertices.packed_bits().is_some() => (Culling::None, "packed places lie off the bounds of their meshlets"),
        _ if stack.moves() => (Culling::None, "effects move meshes out of their bounds"),
        _ if stack.cloud().is_some() => (Culling::None, "particles stay in no bounds that a meshlet could have"),
        _ if stack.shape() == Shape::Points => (Culling::None, "discs reach out of the bounds of their meshes"),
        _ if stack.draw_order().is_some() => (Culling::None, "a draw order counts the samples of every triangle"),
        (Some(Layers::Race), _) | (_, Visibility::Race) => (Culling::None, "a race shows what happens to every triangle"),
        (Some(Layers::Xray { .. } | Layers::Overdraw), _) => (Culling::Frustum, "layers that are hidden count too"),
        (_, Visibility::Packed32) => (Culling::Frustum, "packed32 keeps too little of a depth to hide anything behind it"),
        (_, Visibility::Tiled) => (Culling::Frustum, "tiles are drawn once, whole"),
        _ => return None,
    };
    (rungs.culling > most).then_some((most, why))
}

/// A sentence as it goes on behind a colon.
fn lowered(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// What no kernel can draw.
fn check(rungs: &Rungs, needs: &Needs, f32_positions: bool, stack: &Stack, caps: &Caps) -> Result<(), PlanError> {
    if !rungs.visibility.is_there(caps.int64_atomics) {
        return Err(PlanError::Lacking);
    }
    if rungs.visibility == Visibility::Packed32 && needs.triangles > PACKED32_TRIANGLES {
        return Err(PlanError::Crowded { triangles: needs.triangles });
    }
    if rungs.coverage.subpixel_bits() != SUBPIXEL_BITS
        && let Some(effect) = measures(stack)
    {
        return Err(PlanError::Grid { rung: rungs.coverage.name(), effect });
    }
    if rungs.coverage == Coverage::Fixed12 && needs.size.iter().any(|side| *side > FIXED12_SIDE) {
        return Err(PlanError::Wide { size: needs.size });
    }
    if rungs.depth == Depth::Integer && rungs.coverage.is_float() {
        return Err(PlanError::Inexact { rung: rungs.coverage.name() });
    }
    if rungs.vertices.packed_bits().is_some() && (needs.skinning.is_some() || needs.shapes || needs.splats) {
        let what = if needs.splats { "particles fly" } else { "joints or shapes bend one" };
        return Err(PlanError::Bent { rung: rungs.vertices.name(), what });
    }
    if rungs.dots == DotWay::Cpu
        && let Some(what) = carried(stack, needs)
    {
        return Err(PlanError::Carried { what });
    }
    if rungs.vertex == Vertex::Strict
        && let Some(what) = floats(rungs, stack, needs, f32_positions)
    {
        return Err(PlanError::Floats { what });
    }
    if rungs.sums != Sums::Four32 && xray(stack).is_some_and(|xray| xray.unit() != 1) {
        return Err(PlanError::Weights { rung: rungs.sums.name() });
    }
    if !matches!(rungs.depth, Depth::Reversed | Depth::Integer) && has_window(stack) {
        return Err(PlanError::Window { rung: rungs.depth.name() });
    }
    Ok(())
}

/// An effect whose integers are in units of 1/256 px.
fn measures(stack: &Stack) -> Option<&'static str> {
    let measures = |effect: &Effect| effect.hooks.sample.is_some_and(|hook| hook.decides) || effect == &points::EFFECT;
    stack.0.iter().map(|enabled| enabled.effect).find(|effect| measures(effect)).map(|effect| effect.name)
}

/// Does an x-ray hold depths against a window?
fn has_window(stack: &Stack) -> bool {
    xray(stack).is_some_and(|xray| Reach::of(xray.reach) == Reach::Window)
}

fn xray(stack: &Stack) -> Option<Xray> {
    stack.get("xray").map(|enabled| read::<Xray>(&enabled.words))
}

/// What carries the lines away from where a tree has them, if anything.
fn carried(stack: &Stack, needs: &Needs) -> Option<String> {
    if stack.dots().is_some_and(|dots| Strung::of(dots.lines) == Strung::Polyline) {
        return None;
    }
    let mover = stack.0.iter().find(|enabled| enabled.effect.hooks.vertex.is_some());
    let moved = mover.map(|enabled| format!("the effect {} moves them", enabled.effect.name));
    moved.or_else(|| needs.moves.then(|| "the scene's own clips may move them".to_owned()))
}

/// What in a picture hangs on floats even behind a strict vertex stage, if anything.
fn floats(rungs: &Rungs, stack: &Stack, needs: &Needs, f32_positions: bool) -> Option<String> {
    let reason = |Enabled { effect, words }: &Enabled| {
        let is_from_floats = effect.hooks.sample.is_some_and(|hook| hook.decides && (hook.is_from_floats)(words));
        let why = match () {
            () if effect.hooks.vertex.is_some() => "moves vertices in floats",
            () if is_from_floats => "lets a front travel in floats",
            () if effect.hooks.has_lines => "places its dots in floats",
            () if !(effect.is_repeatable)(words) => "leaves its picture to chance",
            () => return None,
        };
        Some(format!("the effect {} {why}", effect.name))
    };
    let positions = || (!f32_positions).then(|| "a mesh of the scene has positions that are not f32".to_owned());
    let bends = || (needs.skinning.is_some() || needs.shapes).then(|| "joints or shapes bend a mesh in floats".to_owned());
    let packed = || rungs.vertices.packed_bits().map(|_| format!("vertices {} unpacks places in floats", rungs.vertices.name()));
    let masks = || (needs.masked && needs.clipping).then(|| "the mask of a triangle that is cut is placed in floats".to_owned());
    let flies = || needs.splats.then(|| "particles fly in floats".to_owned());
    stack.0.iter().find_map(reason).or_else(packed).or_else(bends).or_else(flies).or_else(positions).or_else(masks)
}
