//! A built-in effect becomes a file of one's own that says the same.

use rasterlab::{
    effect_files::{duplicate, read},
    effects::{EFFECTS, Effect},
};
use rasterlab_fuzz::stress::scenes::Rng;

use super::super::effect_inputs::{parameters, surface};

/// Both sides' floats, all of them within 1e-9 of the largest component, or of 1.
fn same(
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
        let is_same =
            apart <= 1e-9 * scale || given.is_nan() && expected.is_nan() || given == expected;
        assert!(
            is_same,
            "{}: {what}: {given} for {expected}, {apart:e} apart\n{case:?}",
            effect.name
        );
    }
}

#[test]
fn a_duplicate_of_an_effect_is_read_and_says_the_same() {
    let (mut duplicates, mut refusals) = (0, Vec::new());
    for effect in EFFECTS.iter().cloned() {
        let text = match duplicate(&effect, "my_own") {
            Ok(text) => text,
            Err(reason) => {
                refusals.push(format!("{} {reason}", effect.name));
                continue;
            }
        };
        let mine = read("my_own.wgsl", "my_own", &text)
            .unwrap_or_else(|error| panic!("{}: {error}\n{text}", effect.name));
        duplicates += 1;
        assert_eq!(mine.fields.len(), effect.fields.len(), "{}", effect.name);
        let (Some(expected), Some(given)) = (&effect.hooks.surface, &mine.hooks.surface) else {
            continue;
        };
        let mut rng = Rng(7);
        for turn in 0..300 {
            let words = parameters(&mut rng, &effect, turn);
            let mut own_words = mine.defaults.clone();
            for field in &mine.fields {
                let place = format!("{}.{}", effect.name, field.name);
                let same = effect
                    .field(&field.name)
                    .unwrap_or_else(|| panic!("{place}"));
                let set = field.set(&mut own_words, &same.get(&words));
                set.unwrap_or_else(|error| panic!("{place}: {error}"));
            }
            if turn == 0 {
                assert_eq!(own_words, mine.defaults, "{}: the defaults", effect.name);
            }
            let input = surface(&mut rng);
            let [given, expected] =
                [(given, &own_words), (expected, &words)].map(|(shade, words)| {
                    let mut all = [input];
                    shade(&mut all, words);
                    all[0]
                });
            let [color, wanted] = [&given, &expected].map(|s| s.color.to_array());
            same(&effect, "color", color, wanted, &input);
            let [normal, wanted] = [&given, &expected].map(|s| s.normal.to_array());
            same(&effect, "normal", normal, wanted, &input);
        }
    }
    assert!(duplicates >= 12, "{duplicates} duplicates; {refusals:#?}");
}
