//! AccuracyOptions: which one is taken on every accuracy axis, and what no kernel can draw.

use super::{
    AccuracyRequest, Caps, Note, PlanError, Tolerance, costs,
    explain::note,
    predict::{Prediction, predict, predict_all},
};
use crate::{
    accuracy::{
        AXES, AccuracyOptions, AxisOption, Coverage, Culling, CurlNoise, DepthFormat, DotCulling, ParticleStorage, PositionFormat,
        ShadowMapSize, ShadowTaps, Skinning, VertexTransform, Visibility, XraySums,
    },
    effects::{
        Effect, EnabledEffect, Stack,
        dots::LineSource,
        hooks::{Layers, Shape},
        points, read,
        xray::{Reach, Xray},
    },
    math::SUBPIXEL_BITS,
    scene::needs::Needs,
};

/// Largest side of a picture whose pixels all lie inside the guard band of 1/4096 px.
const FIXED12_SIDE: u32 = 2047;

/// Most triangles whose ids leave packed32 eight bits for depth.
const PACKED32_TRIANGLES: u64 = (1 << 24) - 1;

/// The options of a picture, why each is taken, and what they are predicted to err by.
pub(super) struct Choice {
    pub options: AccuracyOptions,
    pub reasons: Vec<Note>,
    pub prediction: Prediction,
}

/// Chooses a option on every axis: pins first, then whatever saves time and still fits the tolerance.
pub(super) fn choose(
    needs: &Needs,
    f32_positions: bool,
    stack: &Stack,
    caps: &Caps,
    accuracy: &AccuracyRequest,
    layers: Option<Layers>,
) -> Result<Choice, PlanError> {
    let visibility = if caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 };
    let mut options = AccuracyOptions { visibility, ..accuracy.tier.base() };
    accuracy.pins.apply(&mut options);
    // How joints hold a mesh was settled with its pose; without joints the option is nobody's.
    options.skinning = needs.skinning.unwrap_or_default();
    // So it is with shadows, which are drawn as finely as the view says.
    let has_light = stack.light().is_some();
    (options.shadow_map_size, options.shadow_taps) = if has_light { needs.shadow.options() } else { Default::default() };
    let has_dots = stack.dots().is_some();
    if !has_dots {
        options.dot_culling = DotCulling::default();
    }
    if !needs.particle_discs {
        (options.curl_noise, options.particle_storage) = (CurlNoise::default(), ParticleStorage::default());
    }
    if layers == Some(Layers::Race) {
        options.visibility = Visibility::Race;
    }
    let tolerance = accuracy.tolerance();
    let far = far_away(&options, needs, accuracy, &tolerance);
    if far.is_some() {
        options.position_format = PositionFormat::Relative;
    }
    let mut reasons = Vec::new();
    let mut prediction = predict_all(&options, needs);
    let is_idle = |i: usize| !has_dots && i == DotCulling::AXIS || !has_light && [ShadowMapSize::AXIS, ShadowTaps::AXIS].contains(&i);
    for (i, axis) in AXES.iter().enumerate().filter(|(i, _)| !is_idle(*i)) {
        if accuracy.pins.get(axis).is_some() {
            reasons.push(note(axis.name, format!("{}: pinned by the preset", axis.words[options.get(axis)])));
            continue;
        }
        if let Some(why) = far.as_ref().filter(|_| i == PositionFormat::AXIS) {
            reasons.push(note(axis.name, why));
            continue;
        }
        let mut cheaper: Vec<usize> = (0..axis.words.len())
            .filter(|&place| i != Skinning::AXIS && costs::saves(axis, place, options.get(axis), needs, caps))
            .collect();
        cheaper.sort_by(|a, b| costs::of(axis, *a, needs, caps).total_cmp(&costs::of(axis, *b, needs, caps)));
        let fits = |place: &usize| {
            let mut tried = options;
            tried.set(axis, *place);
            check(&tried, needs, f32_positions, stack, caps).is_ok() && tolerance.holds(&predict_all(&tried, needs))
        };
        if let Some(place) = cheaper.into_iter().find(fits) {
            options.set(axis, place);
            prediction = predict_all(&options, needs);
            let (word, share, own) = (axis.words[place], costs::of(axis, place, needs, caps), predict(i, place, needs));
            let why = format!(
                "{word}: {share:.2} of the usual time, predicted to err by {:.0} of {:.0} ppm, {:.1} of {} in colour",
                own.wrong_ppm, tolerance.wrong_ppm, own.channel, tolerance.channel
            );
            reasons.push(note(axis.name, why));
        } else {
            let default = axis.option_abouts[options.get(axis)].trim().trim_end_matches('.');
            reasons.push(note(axis.name, format!("{}: {}", axis.words[options.get(axis)], lowered(default))));
        }
    }
    if let Some((option, why)) = unfit_for_culling(&options, stack, layers) {
        let said = reasons.iter_mut().find(|note| note.name == AXES[Culling::AXIS].name);
        if let Some(note) = said {
            note.why = format!("{} instead of {}: {why}", option.name(), options.culling.name());
        }
        options.culling = option;
        prediction = predict_all(&options, needs);
    }
    check(&options, needs, f32_positions, stack, caps)?;
    Ok(Choice { options, reasons, prediction })
}

/// Why places are taken relative to the eye, where nobody asked: what lies far from its origin keeps its places only so, and
/// that costs nothing. A strict picture follows from the preset alone.
fn far_away(options: &AccuracyOptions, needs: &Needs, accuracy: &AccuracyRequest, tolerance: &Tolerance) -> Option<String> {
    let own = predict(PositionFormat::AXIS, options.position_format.place(), needs);
    let is_settled = accuracy.pins.option::<PositionFormat>().is_some() || options.vertex_transform == VertexTransform::Strict;
    (!is_settled && !tolerance.holds(&own)).then(|| {
        format!(
            "relative: so far from the origin, rounding moves a stored corner by up to {:.2} px, predicted to cost {:.0} of {:.0} ppm",
            needs.rounding_px[0], own.wrong_ppm, tolerance.wrong_ppm
        )
    })
}

/// What culling must come down to in a picture, and why, where it cannot be as it was asked for. Since it never shows, a preset
/// that pins it goes on without it.
fn unfit_for_culling(options: &AccuracyOptions, stack: &Stack, layers: Option<Layers>) -> Option<(Culling, &'static str)> {
    let (most, why) = match (layers, options.visibility) {
        _ if options.position_format.packed_bits().is_some() => (Culling::None, "packed places lie off the bounds of their meshlets"),
        _ if stack.moves() => (Culling::None, "effects move meshes out of their bounds"),
        _ if stack.particle_settings().is_some() => (Culling::None, "particles stay in no bounds that a meshlet could have"),
        _ if stack.shape() == Shape::Points => (Culling::None, "discs reach out of the bounds of their meshes"),
        _ if stack.draw_order().is_some() => (Culling::None, "a draw order counts the samples of every triangle"),
        (Some(Layers::Race), _) | (_, Visibility::Race) => (Culling::None, "a race shows what happens to every triangle"),
        (Some(Layers::Xray { .. } | Layers::Overdraw), _) => (Culling::Frustum, "layers that are hidden count too"),
        (_, Visibility::Packed32) => (Culling::Frustum, "packed32 keeps too little of a depth to hide anything behind it"),
        (_, Visibility::Tiled) => (Culling::Frustum, "tiles are drawn once, whole"),
        _ => return None,
    };
    (options.culling > most).then_some((most, why))
}

/// A sentence as it goes on behind a colon.
fn lowered(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// What no kernel can draw.
fn check(options: &AccuracyOptions, needs: &Needs, f32_positions: bool, stack: &Stack, caps: &Caps) -> Result<(), PlanError> {
    if !options.visibility.is_there(caps.int64_atomics) {
        return Err(PlanError::Lacking);
    }
    if options.visibility == Visibility::Packed32 && needs.triangles > PACKED32_TRIANGLES {
        return Err(PlanError::Crowded { triangles: needs.triangles });
    }
    if options.coverage.subpixel_bits() != SUBPIXEL_BITS
        && let Some(effect) = measures(stack)
    {
        return Err(PlanError::Grid { option: options.coverage.name(), effect });
    }
    if options.coverage == Coverage::Fixed12 && needs.size.iter().any(|side| *side > FIXED12_SIDE) {
        return Err(PlanError::Wide { size: needs.size });
    }
    if options.depth == DepthFormat::Integer && options.coverage.is_float() {
        return Err(PlanError::Inexact { option: options.coverage.name() });
    }
    if options.position_format.packed_bits().is_some() && (needs.skinning.is_some() || needs.morph_targets || needs.particle_discs) {
        let what = if needs.particle_discs { "particles fly" } else { "joints or shapes bend one" };
        return Err(PlanError::Deformed { option: options.position_format.name(), what });
    }
    if options.dot_culling == DotCulling::Cpu
        && let Some(what) = carried(stack, needs)
    {
        return Err(PlanError::Carried { what });
    }
    if options.vertex_transform == VertexTransform::Strict
        && let Some(what) = floats(options, stack, needs, f32_positions)
    {
        return Err(PlanError::Floats { what });
    }
    if options.xray_sums != XraySums::Four32 && xray(stack).is_some_and(|xray| xray.unit() != 1) {
        return Err(PlanError::Weights { option: options.xray_sums.name() });
    }
    if !matches!(options.depth, DepthFormat::Reversed | DepthFormat::Integer) && has_window(stack) {
        return Err(PlanError::Window { option: options.depth.name() });
    }
    Ok(())
}

/// An effect whose integers are in units of 1/256 px.
fn measures(stack: &Stack) -> Option<&'static str> {
    let measures = |effect: &Effect| effect.hooks.sample.is_some_and(|hook| hook.has_setup) || effect == &points::EFFECT;
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
    if stack.dots().is_some_and(|dots| LineSource::of(dots.lines) == LineSource::Polyline) {
        return None;
    }
    let vertex_evaluator = stack.0.iter().find(|enabled| enabled.effect.hooks.vertex.is_some());
    let moved = vertex_evaluator.map(|enabled| format!("the effect {} moves them", enabled.effect.name));
    moved.or_else(|| needs.moves.then(|| "the scene's own clips may move them".to_owned()))
}

/// What in a picture hangs on floats even behind a strict vertex stage, if anything.
fn floats(options: &AccuracyOptions, stack: &Stack, needs: &Needs, f32_positions: bool) -> Option<String> {
    let reason = |EnabledEffect { effect, words }: &EnabledEffect| {
        let is_from_floats = effect.hooks.sample.is_some_and(|hook| hook.has_setup && (hook.is_from_floats)(words));
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
    let deforms = || (needs.skinning.is_some() || needs.morph_targets).then(|| "joints or shapes bend a mesh in floats".to_owned());
    let packed =
        || options.position_format.packed_bits().map(|_| format!("vertices {} unpacks places in floats", options.position_format.name()));
    let masks = || (needs.masked && needs.clipping).then(|| "the mask of a triangle that is cut is placed in floats".to_owned());
    let flies = || needs.particle_discs.then(|| "particles fly in floats".to_owned());
    stack.0.iter().find_map(reason).or_else(packed).or_else(deforms).or_else(flies).or_else(positions).or_else(masks)
}
