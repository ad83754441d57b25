//! Promise: dissolve has a side in Rust, which counts samples one by one, and its text in f64 decides
//! the same, over random triangles and parameters. Needs no adapter.

use rasterlab::{
    effect_files::evaluated,
    effects::{
        Effect,
        hooks::{Sample, TriangleSetup},
    },
    shader::library::Library,
};
use rasterlab_fuzz::stress::scenes::Rng;

use super::effect_inputs::{between, parameters, vector, whole};

/// Random triangles.
const TRIES: usize = 3000;

#[test]
fn its_samples_agree() {
    let effect = Effect::named("dissolve");
    let hooks = evaluated(&Library::Embedded, effect).unwrap_or_else(|error| panic!("{error}"));
    let mut rng = Rng(13);
    let mut drawn = [0, 0];
    let both =
        [&hooks, &effect.hooks].map(|hooks| hooks.sample.as_ref().expect("it is on the hook"));
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
}
