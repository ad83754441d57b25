//! Promise: the WGSL of every built-in effect with a side in Rust, evaluated in f64, says what its function in Rust
//! says: integers and booleans exactly, floats within 1e-9, over random inputs and parameters.
//! Needs no adapter.

use std::{path::Path, sync::Arc};

use rasterlab::{
    effect_files::evaluated,
    effects::{
        EFFECTS, Effect,
        hooks::{Hooks, Sample, Surface, TriangleSetup},
    },
    shader::library::Library,
};
use rasterlab_fuzz::stress::scenes::Rng;

use super::effect_inputs::{between, parameters, surface, vector, whole};

/// Largest difference, relative to the largest component, or to 1.
const TOLERANCE: f64 = 1e-9;

/// Effects whose text and function are meant to differ by more: lib/angle has a polynomial for the
/// sine, within 3.4e-9 of it.
const LOOSER: &[(&str, f64)] = &[
    // Turns a lamp as narrow as a tenth of a radian.
    ("studio", 1e-6),
];

/// Random inputs of each effect.
const TRIES: usize = 3000;

fn tolerance(effect: &Effect) -> f64 {
    let looser = LOOSER.iter().find(|(name, _)| *name == effect.name);
    looser.map_or(TOLERANCE, |(_, bound)| *bound)
}

/// Both sides' floats, all of them within the effect's tolerance.
pub fn same(
    effect: &Effect,
    what: &str,
    given: impl AsRef<[f64]>,
    expected: impl AsRef<[f64]>,
    case: &dyn std::fmt::Debug,
) {
    let (given, expected) = (given.as_ref(), expected.as_ref());
    let scale = expected
        .iter()
        .fold(1.0, |scale: f64, value| scale.max(value.abs()));
    for (given, expected) in given.iter().zip(expected) {
        let apart = (given - expected).abs();
        let is_same = apart <= tolerance(effect) * scale
            || given.is_nan() && expected.is_nan()
            || given == expected;
        assert!(
            is_same,
            "{}: {what}: WGSL {given}, Rust {expected}, {apart:e} apart\n{case:?}",
            effect.name
        );
    }
}

/// Runs every effect that has the hook, and gathers what fails.
fn each_effect(
    has: impl Fn(&Hooks) -> bool,
    compare: impl Fn(&Arc<Effect>, &Hooks) + std::panic::RefUnwindSafe,
) {
    let mut faults = Vec::new();
    let mut compared = 0;
    let in_rust = |effect: &&Arc<Effect>| {
        let file = format!("crates/model/src/effects/{}.rs", effect.name);
        has(&effect.hooks) && Path::new(env!("CARGO_MANIFEST_DIR")).join(file).exists()
    };
    for effect in EFFECTS.iter().filter(in_rust).cloned() {
        let hooks = evaluated(&Library::Embedded, &effect)
            .unwrap_or_else(|error| panic!("{}: {error}", effect.name));
        let run = std::panic::AssertUnwindSafe(|| compare(&effect, &hooks));
        if let Err(panic) = std::panic::catch_unwind(run) {
            faults.push(panic.downcast_ref::<String>().cloned().unwrap_or_default());
        }
        compared += 1;
    }
    assert!(compared > 0);
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

/// Every number of a surface.
fn floats(s: &Surface) -> Vec<f64> {
    let vectors = [
        s.glow,
        s.position,
        s.normal,
        s.flat_normal,
        s.view,
        s.center,
        s.barycentrics,
        s.edge_distance_px,
    ];
    let pairs = [s.center_screen, s.screen, s.depth_range_m];
    let mut all = s.color.to_array().to_vec();
    all.extend(vectors.iter().flat_map(|v| v.to_array()));
    all.extend(pairs.iter().flat_map(|v| v.to_array()));
    all.extend([s.depth_m, s.pixel_size_m, s.flat_depth_m, s.rank, s.lit]);
    all.extend(s.finish.specular.to_array());
    all.extend([s.finish.metallic, s.finish.roughness, s.finish.occlusion]);
    all
}

#[test]
fn surface_functions_agree() {
    let has = |hooks: &Hooks| hooks.surface.is_some();
    each_effect(has, |effect, hooks| {
        let mut rng = Rng(11);
        for turn in 0..TRIES {
            let (words, s) = (parameters(&mut rng, effect, turn), surface(&mut rng));
            let [given, expected] = [hooks, &effect.hooks].map(|hooks| {
                let mut all = [s];
                hooks.surface.as_ref().expect("it is on the hook")(&mut all, &words);
                all[0]
            });
            same(
                effect,
                "surface",
                floats(&given),
                floats(&expected),
                &(words, s),
            );
            assert_eq!(given.triangle_id, expected.triangle_id, "{}", effect.name);
        }
    });
}

#[test]
fn sample_functions_agree() {
    let has = |hooks: &Hooks| hooks.sample.is_some();
    each_effect(has, |effect, hooks| {
        let mut rng = Rng(13);
        let mut drawn = [0, 0];
        let both =
            [hooks, &effect.hooks].map(|hooks| hooks.sample.as_ref().expect("it is on the hook"));
        for turn in 0..TRIES {
            let words = parameters(&mut rng, effect, turn);
            let reach = if turn % 5 == 0 { 40_000.0 } else { 6_000.0 };
            let corner = |rng: &mut Rng| [0, 1].map(|_| between(rng, -500.0, reach) as i32);
            let setup = TriangleSetup {
                triangle: whole(&mut rng, 1 << 20),
                corners: std::array::from_fn(|_| corner(&mut rng)),
                outline: whole(&mut rng, 8),
                size: [1 + whole(&mut rng, 200), 1 + whole(&mut rng, 200)],
                center: vector(&mut rng, -3.0, 3.0),
                center_error_m: 0.0,
                center_screen_error: 0.0,
                center_screen: vector(&mut rng, 0.0, 1.0).truncate(),
            };
            let [given, expected] = both.map(|hook| match hook.has_setup {
                true => (hook.sample_setup)(&setup, &words, None),
                false => [0; 4],
            });
            assert_eq!(
                given, expected,
                "{}: setup of {setup:?} with {words:?}",
                effect.name
            );
            for _ in 0..4 {
                let areas = std::array::from_fn(|_| whole(&mut rng, 1 << 29));
                let (x, y) = (whole(&mut rng, 200), whole(&mut rng, 200));
                let sample = Sample {
                    x,
                    y,
                    triangle: setup.triangle,
                    areas,
                    setup: expected,
                };
                let [given, expected] = both.map(|hook| {
                    let mut drawn = [true];
                    (hook.is_drawn)(&[sample], &words, &mut drawn);
                    drawn[0]
                });
                assert_eq!(
                    given, expected,
                    "{}: {sample:?} with {words:?}",
                    effect.name
                );
                drawn[usize::from(expected)] += 1;
            }
        }
        assert!(
            drawn[0] > 100 && drawn[1] > 100,
            "{}: {drawn:?}",
            effect.name
        );
    });
}
