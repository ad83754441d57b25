//! Repetition: the same picture many times, the same triangles in another order, and a clock that
//! has run for a day.

use std::sync::Arc;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal, same},
    context::CaseContext,
    drawing::{WorkDistribution, pinned, stack},
};
use crate::{
    accuracy::{ParticleStorage, PinnedOptions},
    effects::{Effect, EnabledEffect, Stack},
    frame::NO_TRIANGLE,
    gpu::Capture,
    measure::compare,
    plan::AccuracyRequest,
    preset::{
        Animation, Clock, Preset,
        animation::{Easing, Keyframe, Track},
    },
    scene::Scene,
};

pub const CASES: &[Case] = &[
    Case {
        number: 22,
        name: "hundred-equal-frames",
        about: "the same picture 100 times: every buffer is equal bit by bit",
        expectation: Expectation::Exact,
        run: hundred_equal_frames,
    },
    Case {
        number: 22,
        name: "shuffled-triangles",
        about: "triangles in another order, with ids mapped back: the same picture bit by bit",
        expectation: Expectation::Exact,
        run: shuffled_triangles,
    },
    Case {
        number: 29,
        name: "after-a-day",
        about: "spin, keyframes and a looping clock after 24 hours",
        expectation: Expectation::Bounded("the phase differs by at most a millionth of a period"),
        run: after_a_day,
    },
    Case {
        number: 35,
        name: "played-particles",
        about: "particles of one frame after another, and after jumps to and fro, from the states that the frame before left",
        expectation: Expectation::Exact,
        run: played_particles,
    },
];

fn hundred_equal_frames(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let hall = context.scene("near")?;
    let view = context.view(&hall, [80, 60]);
    context.renderer.set_tuning(WorkDistribution::Card.tuning());
    if context.is_slow() {
        context.note("one stack of effects for each option, since this adapter is slow".into());
    }
    for (i, option) in context.options().into_iter().enumerate() {
        let stacks = [stack(&["facet", "lambert"]), stack(&["lambert", "xray"])];
        let chosen = if context.is_slow() {
            &stacks[i % 2..=i % 2]
        } else {
            &stacks
        };
        for stack in chosen {
            let mut first: Option<Capture> = None;
            for frame in 1..=100 {
                let what = format!("frame {frame} on {}", option.name());
                let capture = context.captured(&hall, &view, stack, &pinned(option), &what)?;
                let Some(first) = &first else {
                    check!(
                        !capture.geometry.clipped_triangles.is_empty(),
                        "nothing was clipped"
                    );
                    first = Some(capture);
                    continue;
                };
                same(&capture, first, &what)?;
                check!(
                    capture.frame == first.frame && capture.geometry == first.geometry,
                    "{what} differs from the first"
                );
            }
        }
    }
    Ok(())
}

/// The same triangles in another order; `order` gives the previous index of each.
fn shuffled(scene: &Scene, order: &[u32]) -> Arc<Scene> {
    let mut scene = scene.clone();
    let triangles: Vec<[u8; 12]> = scene.index_bytes.as_chunks().0.to_vec();
    scene.index_bytes = order.iter().flat_map(|&t| triangles[t as usize]).collect();
    Arc::new(scene)
}

fn shuffled_triangles(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    context.renderer.set_tuning(WorkDistribution::Card.tuning());
    for query in [
        "sphere?triangles=5000",
        "knot?tess=6",
        "grid?cell=1",
        "sizes",
    ] {
        let still = context.scene(query)?;
        let is_one_list = still.instances.len() == 1
            && still.primitives[0]
                .indices
                .is_some_and(|i| i.stride == 4 && i.offset == 0);
        check!(is_one_list, "{query}: it is not one list of 32-bit indices");
        let view = context.view(&still, [192, 144]);
        for option in context.options() {
            let what = format!("{query} on {}", option.name());
            let (before, _) = context.exact(&still, &view, &stack(&[]), &pinned(option), &what)?;
            for round in 1..=3 {
                let what = format!("{what}, shuffle {round}");
                let mut order: Vec<u32> = (0..still.triangle_count() as u32).collect();
                context.rng(round).shuffle(&mut order);
                let mut after = context.captured(
                    &shuffled(&still, &order),
                    &view,
                    &stack(&[]),
                    &pinned(option),
                    &what,
                )?;
                for triangle_id in after
                    .frame
                    .triangle_id
                    .iter_mut()
                    .filter(|triangle_id| **triangle_id != NO_TRIANGLE)
                {
                    *triangle_id = order[*triangle_id as usize];
                }
                same(&after, &before, &what)?;
                check!(
                    after.frame.color == before.frame.color,
                    "{what}: colors differ"
                );
            }
        }
    }
    Ok(())
}

fn played_particles(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let chamber = context.scene("chamber")?;
    // Short lives, so that some end in every frame.
    let mut preset = Preset {
        stack: stack(&["particles"]),
        ..Preset::default()
    };
    let particles =
        Effect::find("particles").ok_or_else(|| EarlyEnd::Failed("no effect particles".into()))?;
    for (name, value) in [("count", 300.0), ("lifetime_s", 0.25)] {
        let field = particles
            .field(name)
            .ok_or_else(|| EarlyEnd::Failed(format!("no field particles.{name}")))?;
        field
            .set(&mut preset.stack.enable(particles).words, &[value])
            .map_err(|error| EarlyEnd::Failed(error.to_string()))?;
    }
    let option = context.quick_option();
    for storage in [ParticleStorage::Float32, ParticleStorage::Half16] {
        let pins = PinnedOptions::of(option).with(storage);
        let accuracy = AccuracyRequest {
            pins,
            ..AccuracyRequest::default()
        };
        let frames = [0, 1, 2, 3, 8, 9, 4, 5, 30, 31, 32, 0, 1];
        for frame in frames {
            preset.clock.time_s = f64::from(frame) / 60.0 + 1e-3;
            let view = preset.view(&chamber, [64, 48]);
            context.exact_next(
                &chamber,
                &view,
                &preset.evaluated_stack(),
                &accuracy,
                &format!("frame {frame}, {}", pins.words()),
            )?;
        }
    }
    Ok(())
}

/// Seconds in a day.
const DAY_S: f64 = 86_400.0;

/// Largest error of a phase, in periods.
const PHASE: f64 = 1e-6;

fn after_a_day(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let knot = context.scene("knot?tess=4")?;
    let facet = Effect::find("facet").ok_or_else(|| EarlyEnd::Failed("no effect facet".into()))?;
    let amount = facet
        .field("amount")
        .ok_or_else(|| EarlyEnd::Failed("no field facet.amount".into()))?;
    let key = |time_s: f64, value: f64| Keyframe {
        time_s,
        value: vec![value],
        easing: Easing::Linear,
    };
    let sentence =
        |error: crate::preset::animation::KeyframeError| EarlyEnd::Failed(error.to_string());
    // A ramp of a second that begins a day after the start, and spin of a quarter turn a second.
    let preset_at = |late_s: f64| -> Result<Preset, EarlyEnd> {
        let mut animation = Animation::default();
        animation.put(
            Track::new(
                facet,
                amount,
                vec![key(late_s, 0.0), key(late_s + 1.0, 1.0)],
            )
            .map_err(sentence)?,
        );
        Ok(Preset {
            spin_deg_per_s: 90.0,
            stack: Stack(vec![EnabledEffect::new(facet)]),
            animation,
            clock: Clock {
                time_s: late_s + 0.37,
                ..Clock::default()
            },
            ..Preset::default()
        })
    };
    let (fresh, late) = (preset_at(0.0)?, preset_at(DAY_S)?);
    let angle = |preset: &Preset| {
        let x = preset
            .view(&knot, [8, 8])
            .scene_state
            .world_from_scene
            .x_axis;
        libm::atan2(-x.z, x.x) / std::f64::consts::TAU
    };
    let off = (angle(&late) - angle(&fresh)).abs();
    check!(off <= PHASE, "the spin is {off:e} of a turn off");
    let value = |preset: &Preset| amount.get(&preset.evaluated_stack().0[0].words)[0];
    let ramp = (value(&late) - value(&fresh)).abs();
    check!(
        ramp <= PHASE && (value(&fresh) - 0.37).abs() <= PHASE,
        "the keyed value is {ramp:e} of its way off"
    );

    // A looping clock, frame by frame for a day at 60 frames a second.
    let clock = Clock {
        range_s: [0.0, 4.0],
        ..Clock::default()
    };
    let (mut time_s, frames) = (0.0, 60 * DAY_S as u32);
    for _ in 0..frames {
        time_s = clock.after(time_s, 1.0 / 60.0).0;
    }
    // A day is a whole number of loops.
    let phase = (time_s / 4.0).min(1.0 - time_s / 4.0).abs();
    check!(
        phase <= PHASE,
        "after {frames} frames the clock is {phase:e} of a round off"
    );

    let mut drawn = Vec::new();
    for (what, preset) in [("at the start", &fresh), ("a day later", &late)] {
        let view = preset.view(&knot, [96, 72]);
        drawn.push(context.exact_on_all_with(&knot, &view, &preset.evaluated_stack(), what)?);
    }
    let changed =
        compare::triangle_ids(&drawn[1].frame.triangle_id, &drawn[0].frame.triangle_id).different;
    let vertices = drawn[0]
        .geometry
        .vertices
        .iter()
        .zip(&drawn[1].geometry.vertices);
    let moved = vertices
        .map(|(a, b)| a.x.abs_diff(b.x).max(a.y.abs_diff(b.y)))
        .max()
        .unwrap_or(0);
    check!(moved <= 1, "a vertex is {moved} units of 1/256 px off");
    context.note(format!("spin off by {off:.1e} of a turn, clock by {phase:.1e} of a round, {changed} pixels of another triangle id"));
    equal(
        &drawn[0].frame.counters,
        &drawn[1].frame.counters,
        "counters a day later",
    )
}
