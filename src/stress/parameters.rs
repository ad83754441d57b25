//! Parameters at both hard ends: one by one, all of an effect together, and with every effect on.

use std::sync::Arc;

use super::{Case, CaseContext, EarlyEnd, Expectation, hold};
use crate::{
    accuracy::{PinnedOptions, ShadowMapSize},
    effects::{EFFECTS, Effect, Stack, hooks::Slot, particles},
    gpu::RenderError,
    measure::Budget,
    params::Field,
    plan::{AccuracyRequest, Tuning},
    preset::{Preset, SceneSource},
    scene::{Scene, draw::DrawError, view::View},
};

pub const CASES: &[Case] = &[
    Case {
        number: 31,
        name: "parameters-at-their-ends",
        about: "every parameter of every effect at the least and the greatest value that it takes",
        expectation: Expectation::Bounded("integers exact; colours within one step of 255 but for steps of colour"),
        run: parameters_at_their_ends,
    },
    Case {
        number: 31,
        name: "every-effect-at-once",
        about: "as many effects as the slots let stand together, all parameters at one end",
        expectation: Expectation::Bounded("integers exact; colours within one step of 255 but for steps of colour"),
        run: every_effect_at_once,
    },
];

/// Particles of a picture: more of them, each as large as the picture, are a bench.
const MOST_PARTICLES: f64 = 2000.0;

/// The ends of what a field takes, as its own type holds them.
fn ends(field: &Field) -> [f64; 2] {
    if particles::EFFECT.field("count") == Some(field) {
        return [field.hard[0], MOST_PARTICLES];
    }
    let [low, high] = field.hard;
    if field.value_type.is_continuous() { [low, high].map(|end| f64::from(end as f32).clamp(low, high)) } else { [low, high] }
}

fn enable(stack: &mut Stack, effect: &'static Effect) {
    let is_new = stack.get_mut(effect.name).is_none();
    let words = &mut stack.enable(effect).words;
    if let Some(count) = effect.field("count").filter(|_| is_new && *effect == particles::EFFECT) {
        count.set(words, &[MOST_PARTICLES]).expect("so many particles may be");
    }
}

fn set(stack: &mut Stack, effect: &'static Effect, field: &Field, end: usize) -> Result<(), EarlyEnd> {
    let values = vec![ends(field)[end]; field.value_type.components()];
    enable(stack, effect);
    field.set(&mut stack.enable(effect).words, &values).map_err(|error| EarlyEnd::Failed(format!("{}: {error}", effect.name)))
}

/// Draws and judges; steps of colour may lie anywhere.
fn judged(context: &mut CaseContext, stack: &Stack, turn: usize, what: &str) -> Result<(), EarlyEnd> {
    // Few triangles: discs and boxes at their largest cover the picture once for each of them.
    let query = ["sphere?triangles=200", "near", "cube-wall", "grid?cell=0.4&width=8&height=8"][turn % 4];
    let scene = context.scene(query)?;
    let what = format!("{what}, {query}");
    // Depths range as far as particles fly.
    let view = match stack.particle_settings() {
        Some(_) => Preset { scene: SceneSource::Builtin(query.into()), stack: stack.clone(), ..Preset::default() }.view(&scene, [64, 48]),
        None => context.view(&scene, [64, 48]),
    };
    let accuracy = &accuracy(context);
    let stack = &drawable(context, &scene, &view, stack, accuracy, &what)?;
    let (capture, verdict) = context.judged(&scene, &view, stack, accuracy, &what)?;
    let sound = capture.geometry.vertices.iter().all(|v| v.depth.is_finite() && v.inv_w.is_finite());
    hold!(sound, "{what}: a vertex is no number");
    verdict
        .accuracy
        .within(&Budget { max_step_band_fraction: 1.0, ..Budget::default() })
        .map_err(|why| EarlyEnd::Failed(format!("{what}: {why}")))
}

/// As planned; a slow adapter would spend most of its time on texels of shadow maps.
fn accuracy(context: &CaseContext) -> AccuracyRequest {
    let pins = if context.is_slow() { PinnedOptions::of(ShadowMapSize::Side256) } else { PinnedOptions::default() };
    AccuracyRequest { pins, ..AccuracyRequest::default() }
}

/// The stack, without dots where more of them are asked for than one picture takes, which a sentence says.
fn drawable(
    context: &mut CaseContext,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
    what: &str,
) -> Result<Stack, EarlyEnd> {
    let mut stack = stack.clone();
    if stack.dots().is_some() {
        context.renderer.set_scene(scene)?;
        match context.renderer.draw(view, &stack, accuracy) {
            Err(RenderError::Draw(error @ DrawError::TooMany { what: "dots", .. })) => {
                context.note(format!("{what}: without dots, since {error}"));
                stack.disable("dots");
            }
            drawn => drawn?,
        }
    }
    Ok(stack)
}

fn parameters_at_their_ends(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let default = context.renderer.gpu().caps.tuning();
    // One scene for each effect, and a key that leaves nothing out: kernels are made once for all its pictures. Where vertices
    // move, the values decide what the planner may leave out, and that is put to the test where kernels compile in time.
    if context.is_slow() {
        context.note("no kernel is specialised, and shadow maps have 256 texels a side, since this adapter is slow".into());
    }
    for (turn, effect) in EFFECTS.iter().enumerate() {
        context.renderer.set_tuning(Tuning { specialized: effect.hooks.vertex.is_some() && !context.is_slow(), ..default });
        for (end, word) in [(0, "least"), (1, "greatest")] {
            for field in effect.fields {
                let mut stack = Stack::default();
                set(&mut stack, effect, field, end)?;
                let what = format!("{}.{} at its {word}, {}", effect.name, field.name, ends(field)[end]);
                judged(context, &stack, turn, &what)?;
            }
            let mut stack = Stack::default();
            enable(&mut stack, effect);
            effect.fields.iter().try_for_each(|field| set(&mut stack, effect, field, end))?;
            judged(context, &stack, turn, &format!("all of {} at its {word}", effect.name))?;
        }
    }
    Ok(())
}

fn every_effect_at_once(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    if context.is_slow() {
        context.note("one end for each choice of slots, and shadow maps of 256 texels a side, since this adapter is slow".into());
    }
    if context.is_software() {
        context.note("dots no closer than a millimetre, since this is a software adapter".into());
    }
    // Those of one slot take turns.
    let most = Slot::ALL.iter().map(|slot| EFFECTS.iter().filter(|effect| effect.hooks.slot == Some(*slot)).count()).max().unwrap_or(1);
    for choice in 0..most {
        let ends = [None, Some(0), Some(1)];
        let chosen = if context.is_slow() { &ends[choice % 3..=choice % 3] } else { &ends[..] };
        for &end in chosen {
            let mut stack = Stack::default();
            for effect in EFFECTS {
                let rivals: Vec<_> = EFFECTS.iter().filter(|e| e.hooks.slot.is_some() && e.hooks.slot == effect.hooks.slot).collect();
                if !rivals.is_empty() && rivals[choice % rivals.len()] != effect {
                    continue;
                }
                enable(&mut stack, effect);
                if let Some(end) = end {
                    effect.fields.iter().try_for_each(|field| set(&mut stack, effect, field, end))?;
                }
            }
            if let Some(dots) = stack.get_mut("dots").filter(|_| context.is_software() && end == Some(0)) {
                // Millions of dots are a bench on a CPU adapter.
                let spacing = dots.effect.field("spacing_m").expect("dots have a spacing");
                spacing.set(&mut dots.words, &[1e-3]).expect("a millimetre may be");
            }
            let names: Vec<_> = stack.0.iter().filter(|e| e.effect.hooks.slot.is_some()).map(|e| e.effect.name).collect();
            let at = ["as they come", "at their least", "at their greatest"][end.map_or(0, |end| end + 1)];
            judged(context, &stack, choice, &format!("all effects {at}, in the slots {}", names.join(" and ")))?;
        }
    }
    Ok(())
}
