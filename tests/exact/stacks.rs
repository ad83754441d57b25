//! Promise: two effects in one slot are refused with one sentence, and a stack is read back in its
//! own order. Needs an adapter.

use pollster::FutureExt as _;
use rasterlab::{
    effects::{EFFECTS, Stack, hooks::Slot},
    gpu::RenderError,
    preset::Preset,
    preset_file,
};
use rasterlab_fuzz::stress::random::{self, Values};

use crate::common::*;

/// As a preset, which a person can save and open.
fn as_preset(stack: &Stack) -> String {
    preset_file::to_toml(&preset_file::PresetFile::new(
        "random",
        Preset {
            stack: stack.clone(),
            ..Preset::default()
        },
    ))
}

#[test]
fn two_effects_in_one_slot_are_refused_by_name() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("fan?n=13");
    let view = view(&scene, [32, 24]);
    for slot in Slot::ALL {
        let takers: Vec<_> = EFFECTS
            .iter()
            .filter(|effect| effect.hooks.slot == Some(slot))
            .collect();
        for (a, b) in takers.iter().zip(takers.iter().skip(1)) {
            let stack = stack(&[&a.name, &b.name]);
            renderer.set_scene(&scene).block_on().expect("it fits");
            let Err(error) = renderer.draw(&view, &stack, &Default::default()).block_on() else {
                panic!("{} and {} were drawn", a.name, b.name)
            };
            assert!(matches!(error, RenderError::Plan(_)));
            let text = error.to_string();
            assert!(
                text.contains(&a.name) && text.contains(&b.name) && text.contains(slot.name()),
                "{text}"
            );
        }
    }
}

#[test]
fn a_stack_reads_back_in_its_own_order() {
    for seed in 0..50 {
        let stack = random::stack(&mut Rng(seed * 77), seed, Values::OfSlider);
        let text = as_preset(&stack);
        let preset_file =
            preset_file::parse(&text, "random").unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(preset_file.preset.stack, stack, "{text}");
    }
}
