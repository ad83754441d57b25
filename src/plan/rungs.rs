//! Rungs: which one is taken on every axis of the ladder, and what no kernel can draw.

use super::{Accuracy, Caps, PlanError};
use crate::{
    effects::{
        Effect, Enabled, Stack,
        hooks::Layers,
        points, read,
        xray::{Reach, Xray},
    },
    ladder::{Coverage, Depth, Rungs, Vertex, Visibility},
    math::SUBPIXEL_BITS,
    scene::needs::Needs,
};

/// Largest side of a picture whose pixels all lie inside the guard band of 1/4096 px.
const FIXED12_SIDE: u32 = 2047;

/// The rungs of a picture: pins first, then what the tier asks.
pub(super) fn choose(
    needs: &Needs,
    f32_positions: bool,
    stack: &Stack,
    caps: &Caps,
    accuracy: &Accuracy,
    layers: Option<Layers>,
) -> Result<Rungs, PlanError> {
    let visibility = if caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 };
    let mut rungs = Rungs { visibility, ..Rungs::default() };
    accuracy.pins.apply(&mut rungs);
    if layers == Some(Layers::Race) {
        // Plain stores need no 64-bit atomics; key and owner stand side by side, as packed64 has them.
        rungs.visibility = Visibility::Packed64;
    } else if rungs.visibility == Visibility::Packed64 && !caps.int64_atomics {
        return Err(PlanError::Lacking);
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
    if rungs.vertex == Vertex::Strict
        && let Some(what) = floats(stack, f32_positions)
    {
        return Err(PlanError::Floats { what });
    }
    if !matches!(rungs.depth, Depth::Reversed | Depth::Integer) && has_window(stack) {
        return Err(PlanError::Window { rung: rungs.depth.name() });
    }
    Ok(rungs)
}

/// An effect whose integers are in units of 1/256 px.
fn measures(stack: &Stack) -> Option<&'static str> {
    let measures = |effect: &Effect| effect.hooks.sample.is_some_and(|hook| hook.decides) || effect == &points::EFFECT;
    stack.0.iter().map(|enabled| enabled.effect).find(|effect| measures(effect)).map(|effect| effect.name)
}

/// Does an x-ray hold depths against a window?
fn has_window(stack: &Stack) -> bool {
    stack.get("xray").is_some_and(|enabled| Reach::of(read::<Xray>(&enabled.words).reach) == Reach::Window)
}

/// What in a picture hangs on floats even behind a strict vertex stage, if anything.
fn floats(stack: &Stack, f32_positions: bool) -> Option<String> {
    let reason = |Enabled { effect, words }: &Enabled| {
        let is_from_floats = effect.hooks.sample.is_some_and(|hook| hook.decides && (hook.is_from_floats)(words));
        let why = match () {
            () if effect.hooks.vertex.is_some() => "moves vertices in floats",
            () if is_from_floats => "lets a front travel in floats",
            () if !(effect.is_repeatable)(words) => "leaves its picture to chance",
            () => return None,
        };
        Some(format!("the effect {} {why}", effect.name))
    };
    let positions = || (!f32_positions).then(|| "a mesh of the scene has positions that are not f32".to_owned());
    stack.0.iter().find_map(reason).or_else(positions)
}
