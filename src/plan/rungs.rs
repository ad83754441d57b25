//! Rungs: which one is taken on every axis of the ladder, and what no kernel can draw.

use super::{Accuracy, Caps, PlanError};
use crate::{
    effects::{
        Effect, Stack,
        hooks::Layers,
        points, read,
        xray::{Reach, Xray},
    },
    ladder::{Coverage, Depth, Rungs, Visibility},
    math::SUBPIXEL_BITS,
    scene::needs::Needs,
};

/// Largest side of a picture whose pixels all lie inside the guard band of 1/4096 px.
const FIXED12_SIDE: u32 = 2047;

/// Most triangles whose ids leave packed32 eight bits for depth.
const PACKED32_TRIANGLES: u64 = (1 << 24) - 1;

/// The rungs of a picture: pins first, then what the tier asks.
pub(super) fn choose(needs: &Needs, stack: &Stack, caps: &Caps, accuracy: &Accuracy, layers: Option<Layers>) -> Result<Rungs, PlanError> {
    let visibility = if caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 };
    let mut rungs = Rungs { visibility, ..Rungs::default() };
    accuracy.pins.apply(&mut rungs);
    if layers == Some(Layers::Race) {
        rungs.visibility = Visibility::Race;
    } else if !rungs.visibility.is_there(caps.int64_atomics) {
        return Err(PlanError::Lacking);
    } else if rungs.visibility == Visibility::Packed32 && needs.triangles > PACKED32_TRIANGLES {
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
    if rungs.depth != Depth::Reversed && has_window(stack) {
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
