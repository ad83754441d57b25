//! Promise: effects that move vertices are exact within the bound they state, on every rung, and change nothing at all
//! when they move nothing. Needs an adapter for all but what the oracle says of itself.

mod common;

use common::*;
use rasterlab::{
    effects::{Effect, Stack},
    scene::Scene,
};

const MOVING: [&str; 3] = ["explode", "inflate", "wobble"];

fn set(stack: &mut Stack, effect: &str, field: &str, values: &[f64]) {
    let enabled = stack.get_mut(effect).unwrap_or_else(|| panic!("{effect} is on"));
    let field = enabled.effect.field(field).unwrap_or_else(|| panic!("{effect} has {field}"));
    field.set(&mut enabled.words, values).unwrap_or_else(|error| panic!("{effect}: {error}"));
}

/// An effect with lengths that suit a scene of this size, and everything it can do switched on.
fn suited(effect: &str, scene: &Scene) -> Stack {
    let size = scene.bounds().radius();
    let mut stack = stack(&[effect]);
    match effect {
        "explode" => {
            set(&mut stack, effect, "amount_m", &[0.15 * size]);
            set(&mut stack, effect, "scatter", &[0.5]);
            set(&mut stack, effect, "spin_turns", &[0.3]);
            set(&mut stack, effect, "shrink", &[0.25]);
        }
        "inflate" => set(&mut stack, effect, "amount_m", &[0.05 * size]),
        _ => {
            set(&mut stack, effect, "toward", &[0.3, 1.0, 0.2]);
            set(&mut stack, effect, "sway", &[1.0, 0.2, 0.4]);
            set(&mut stack, effect, "amplitude_m", &[0.05 * size]);
            set(&mut stack, effect, "wavelength_m", &[0.7 * size]);
            set(&mut stack, effect, "phase_turns", &[0.3]);
        }
    }
    stack
}

#[test]
fn every_builtin_scene_is_exact_under_every_moving_effect() {
    let Some(mut renderer) = renderer() else { return };
    let mut failures = Vec::new();
    for query in SCENES {
        let scene = scene(query);
        let view = view(&scene, [320, 240]);
        for effect in MOVING {
            let mut stack = suited(effect, &scene);
            stack.enable(Effect::find("lambert").expect("there is light"));
            for rung in rungs(&renderer) {
                for tuning in tunings() {
                    renderer.set_tuning(tuning);
                    let (_, verdict) = judged(&mut renderer, &scene, &view, &stack, &pinned(rung));
                    let a = &verdict.accuracy;
                    eprintln!(
                        "{query} {effect} {} {}: snap {} of bound, ill {} of {}, explained {}, colour {}",
                        rung.name(),
                        tuning.small_samples,
                        a.max_snap_delta,
                        a.ill_conditioned,
                        a.vertices,
                        a.explained_by_snap,
                        a.max_colour_delta
                    );
                    failures.extend(exactness(a).err().map(|faults| format!("{query} {effect} {} {tuning:?}: {faults}", rung.name())));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
