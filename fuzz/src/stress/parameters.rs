//! Parameters at the ends of their hard ranges: one by one, all of an effect together, and with
//! every effect enabled.

use std::sync::Arc;

use pollster::FutureExt as _;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
};
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
        name: "parameters-at-range-ends",
        about: "every parameter of every effect at its smallest and its largest allowed value",
        expectation: Expectation::Bounded(
            "integers exact; colors within one step of 255 except at discontinuities",
        ),
        run: parameters_at_range_ends,
    },
    Case {
        number: 31,
        name: "all-effects-at-range-ends",
        about: "as many effects as can be combined, all parameters at one end of their ranges",
        expectation: Expectation::Bounded(
            "integers exact; colors within one step of 255 except at discontinuities",
        ),
        run: all_effects_at_range_ends,
    },
];

/// The most particles of a picture: more of them, each as large as the picture, would be a
/// benchmark.
const MOST_PARTICLES: f64 = 2000.0;

/// The ends of a field's range as its type can represent them.
fn ends(field: &Field) -> [f64; 2] {
    if particles::EFFECT
        .field("count")
        .is_some_and(|count| **count == *field)
    {
        return [field.hard[0], MOST_PARTICLES];
    }
    let [low, high] = field.hard;
    if field.value_type.is_continuous() {
        [low, high].map(|end| f64::from(end as f32).clamp(low, high))
    } else {
        [low, high]
    }
}

fn enable(stack: &mut Stack, effect: &Arc<Effect>) {
    let is_new = stack.get_mut(&effect.name).is_none();
    let words = &mut stack.enable(effect).words;
    if let Some(count) = effect
        .field("count")
        .filter(|_| is_new && *effect == *particles::EFFECT)
    {
        count
            .set(words, &[MOST_PARTICLES])
            .expect("so many particles may be");
    }
}

fn set(stack: &mut Stack, effect: &Arc<Effect>, field: &Field, end: usize) -> Result<(), EarlyEnd> {
    let values = vec![ends(field)[end]; field.value_type.components()];
    enable(stack, effect);
    field
        .set(&mut stack.enable(effect).words, &values)
        .map_err(|error| EarlyEnd::Failed(format!("{}.{}: {error}", effect.name, field.name)))
}

/// Draws and judges. Color discontinuities may be anywhere.
fn judge_stack(
    context: &mut CaseContext,
    stack: &Stack,
    turn: usize,
    what: &str,
) -> Result<(), EarlyEnd> {
    // Few triangles: at their largest, discs and boxes cover the picture once for each triangle.
    let query = [
        "sphere?triangles=200",
        "near",
        "cube-wall",
        "grid?cell=0.4&width=8&height=8",
    ][turn % 4];
    let scene = context.scene(query)?;
    let what = format!("{what}, {query}");
    // The depth range includes the particles.
    let view = match stack.particle_settings() {
        Some(_) => Preset {
            scene: SceneSource::Builtin(query.into()),
            stack: stack.clone(),
            ..Preset::default()
        }
        .view(&scene, [64, 48]),
        None => context.view(&scene, [64, 48]),
    };
    let accuracy = &accuracy(context);
    let stack = &drawable(context, &scene, &view, stack, accuracy, &what)?;
    let (capture, verdict) = context.judged(&scene, &view, stack, accuracy, &what)?;
    let sound = capture
        .geometry
        .vertices
        .iter()
        .all(|v| v.depth.is_finite() && v.inv_w.is_finite());
    check!(sound, "{what}: a vertex is not finite");
    verdict
        .report
        .within(&Budget {
            max_step_band_fraction: 1.0,
            ..Budget::default()
        })
        .map_err(|why| EarlyEnd::Failed(format!("{what}: {why}")))
}

/// The default request; small shadow maps for slow adapters.
fn accuracy(context: &CaseContext) -> AccuracyRequest {
    let pins = if context.is_slow() {
        PinnedOptions::of(ShadowMapSize::Side256)
    } else {
        PinnedOptions::default()
    };
    AccuracyRequest {
        pins,
        ..AccuracyRequest::default()
    }
}

/// The stack, without dots where they exceed the limit of a picture, which is noted.
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
        context.renderer.set_scene(scene).block_on()?;
        match context.renderer.draw(view, &stack, accuracy).block_on() {
            Err(RenderError::Draw(error @ DrawError::TooMany { what: "dots", .. })) => {
                context.note(format!("{what}: without dots, since {error}"));
                stack.disable("dots");
            }
            drawn => drawn?,
        }
    }
    Ok(stack)
}

fn parameters_at_range_ends(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let default = context.renderer.gpu().caps.tuning();
    // One scene per effect and an unspecialized kernel key, so kernels are compiled once for all
    // its pictures. Where vertices move, specialization depends on the values and is tested on
    // adapters that compile fast.
    if context.is_slow() {
        context.note("kernels are not specialized, and shadow maps have 256 x 256 texels, since this adapter is slow".into());
    }
    for (turn, effect) in EFFECTS.iter().enumerate() {
        context.renderer.set_tuning(Tuning {
            specialized: effect.hooks.vertex.is_some() && !context.is_slow(),
            ..default
        });
        for (end, word) in [(0, "minimum"), (1, "maximum")] {
            for field in &effect.fields {
                let mut stack = Stack::default();
                set(&mut stack, effect, field, end)?;
                let what = format!(
                    "{}.{} at its {word}, {}",
                    effect.name,
                    field.name,
                    ends(field)[end]
                );
                judge_stack(context, &stack, turn, &what)?;
            }
            let mut stack = Stack::default();
            enable(&mut stack, effect);
            effect
                .fields
                .iter()
                .try_for_each(|field| set(&mut stack, effect, field, end))?;
            judge_stack(
                context,
                &stack,
                turn,
                &format!("all of {} at its {word}", effect.name),
            )?;
        }
    }
    Ok(())
}

fn all_effects_at_range_ends(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    if context.is_slow() {
        context.note("one end for each choice of slots, and shadow maps of 256 x 256 texels, since this adapter is slow".into());
    }
    if context.is_software() {
        context.note("dots no closer than a millimeter, since this is a software adapter".into());
    }
    // Effects of the same slot take turns.
    let most = Slot::ALL
        .iter()
        .map(|slot| {
            EFFECTS
                .iter()
                .filter(|effect| effect.hooks.slot == Some(*slot))
                .count()
        })
        .max()
        .unwrap_or(1);
    for choice in 0..most {
        let ends = [None, Some(0), Some(1)];
        let chosen = if context.is_slow() {
            &ends[choice % 3..=choice % 3]
        } else {
            &ends[..]
        };
        for &end in chosen {
            let mut stack = Stack::default();
            for effect in EFFECTS.iter() {
                let rivals: Vec<_> = EFFECTS
                    .iter()
                    .filter(|e| e.hooks.slot.is_some() && e.hooks.slot == effect.hooks.slot)
                    .collect();
                if !rivals.is_empty() && rivals[choice % rivals.len()] != effect {
                    continue;
                }
                enable(&mut stack, effect);
                if let Some(end) = end {
                    effect
                        .fields
                        .iter()
                        .try_for_each(|field| set(&mut stack, effect, field, end))?;
                }
            }
            // Samples of glass have no place in the order of drawing.
            if stack.get("glass").is_some() {
                stack
                    .0
                    .retain(|enabled| enabled.effect.name != "draw_order");
            }
            if let Some(dots) = stack
                .get_mut("dots")
                .filter(|_| context.is_software() && end == Some(0))
            {
                // Millions of dots take too long on a software adapter.
                let spacing = dots.effect.field("spacing_m").expect("dots have a spacing");
                spacing
                    .set(&mut dots.words, &[1e-3])
                    .expect("a millimeter may be");
            }
            let names: Vec<_> = stack
                .0
                .iter()
                .filter(|e| e.effect.hooks.slot.is_some())
                .map(|e| e.effect.name.as_str())
                .collect();
            let at = ["at their defaults", "at their minimum", "at their maximum"]
                [end.map_or(0, |end| end + 1)];
            judge_stack(
                context,
                &stack,
                choice,
                &format!("all effects {at}, in the slots {}", names.join(" and ")),
            )?;
        }
    }
    Ok(())
}
