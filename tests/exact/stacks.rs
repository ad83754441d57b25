//! Promise: any set of effects composes. Random stacks with random legal parameters draw the same integers on the adapter
//! and in the oracle, and two effects in one slot are refused with one sentence. Seeded: a failure prints the seed, and
//! `RASTERLAB_SEED=n` draws that stack again. Needs an adapter.

use pollster::FutureExt as _;

use crate::common::*;
use rasterlab::{
    effects::{EFFECTS, Stack, hooks::Slot},
    gpu::RenderError,
    measure::Budget,
    preset::Preset,
    preset_file,
    stress::random::{self, Values},
};

/// Stacks that every run draws.
const STACKS: u32 = 20;

/// As a preset, which a person can save and open.
fn as_preset(stack: &Stack) -> String {
    preset_file::to_toml(&preset_file::PresetFile::new("random", Preset { stack: stack.clone(), ..Preset::default() }))
}

#[test]
fn random_stacks_draw_the_same_integers_on_the_adapter_and_in_the_oracle() {
    let Some(mut renderer) = renderer() else { return };
    let seeds = match std::env::var("RASTERLAB_SEED") {
        Ok(seed) => vec![seed.parse().expect("RASTERLAB_SEED is a whole number")],
        Err(_) => (0..STACKS).collect::<Vec<u32>>(),
    };
    let options = options(&renderer);
    let scenes = ["teapot?tess=4", "sphere?triangles=200", "near", "sizes", "cube-wall", "grid?cell=0.4", "stack?layers=5"];
    let mut failures = Vec::new();
    for seed in seeds {
        let mut rng = Rng(seed.wrapping_mul(0x1234_5679));
        let stack = random::stack(&mut rng, Values::OfSlider);
        let scene = scene(scenes[rng.between(0, scenes.len() as i32) as usize]);
        let view = view(&scene, [64, 48]);
        renderer.set_tuning(tunings()[rng.between(0, 4) as usize]);
        let option = options[rng.between(0, options.len() as i32) as usize];
        let (_, verdict) = judged(&mut renderer, &scene, &view, &stack, &pinned(option));
        if let Err(faults) = verdict.report.within(&Budget::default()) {
            failures.push(format!("RASTERLAB_SEED={seed}: {} on {}: {faults}\n{}", scene.name, option.name(), as_preset(&stack)));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn two_effects_in_one_slot_are_refused_by_name() {
    let Some(mut renderer) = renderer() else { return };
    let scene = scene("fan?n=13");
    let view = view(&scene, [32, 24]);
    for slot in Slot::ALL {
        let takers: Vec<_> = EFFECTS.iter().filter(|effect| effect.hooks.slot == Some(slot)).collect();
        for (a, b) in takers.iter().zip(takers.iter().skip(1)) {
            let stack = stack(&[&a.name, &b.name]);
            renderer.set_scene(&scene).block_on().expect("it fits");
            let Err(error) = renderer.draw(&view, &stack, &Default::default()).block_on() else {
                panic!("{} and {} were drawn", a.name, b.name)
            };
            assert!(matches!(error, RenderError::Plan(_)));
            let text = error.to_string();
            assert!(text.contains(&a.name) && text.contains(&b.name) && text.contains(slot.name()), "{text}");
        }
    }
}

#[test]
fn a_stack_reads_back_in_its_own_order() {
    for seed in 0..50 {
        let stack = random::stack(&mut Rng(seed * 77), Values::OfSlider);
        let text = as_preset(&stack);
        let preset_file = preset_file::parse(&text, "random").unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(preset_file.preset.stack, stack, "{text}");
    }
}
