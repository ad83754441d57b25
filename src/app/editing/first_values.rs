//! First values: what an effect that is added in the window begins with, so that it shows.

use std::sync::Arc;

use crate::{
    effects::Effect,
    preset::{Fit, LengthUnit, Preset},
    scene::Bounds,
};

/// Parameters whose default changes next to nothing, with a number that shows. The defaults of
/// files stay, since another one would change what they mean.
const SHOWN: &[(&str, &str, f64)] = &[("dither", "levels", 4.0)];

/// Scenes so many times smaller or larger than 1 m get lengths that fit them.
const FITTED_FROM: f64 = 8.0;

/// The words of the parameters of `effect` in a preset of `unit`, on a scene with this box.
pub fn first_words(effect: &Arc<Effect>, unit: LengthUnit, bounds: Option<Bounds>) -> Vec<u32> {
    let mut first = Preset::default();
    first.stack.enable(effect);
    let meter = Bounds {
        min: glam::DVec3::splat(-1.0 / 3.0_f64.sqrt()),
        max: glam::DVec3::splat(1.0 / 3.0_f64.sqrt()),
    };
    let fit = bounds
        .filter(|_| unit == LengthUnit::Meter)
        .filter(|bounds| !(1.0 / FITTED_FROM..=FITTED_FROM).contains(&bounds.radius()))
        .and_then(|bounds| Fit::between(&meter, &bounds));
    if let Some(fit) = fit {
        first = first.fitted(&fit).0;
    }
    let mut words = first
        .stack
        .get(&effect.name)
        .map_or_else(|| effect.defaults.clone(), |enabled| enabled.words.clone());
    let base = effect.base.as_ref().unwrap_or(effect);
    for (_, name, value) in SHOWN.iter().filter(|(shown, ..)| *shown == base.name) {
        if let Some(field) = effect.field(name) {
            // A number of the table lies in its range.
            drop(field.set(&mut words, &[*value]));
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    #[test]
    fn the_numbers_of_the_table_are_allowed_and_differ_from_the_defaults() {
        for (effect, name, value) in SHOWN {
            let effect = Effect::find(effect).expect("a built-in effect");
            let words = first_words(effect, LengthUnit::Meter, None);
            let field = effect.field(name).expect("a parameter");
            assert_eq!(field.get(&words), [*value]);
            assert_ne!(words, effect.defaults);
        }
        for effect in EFFECTS.iter().filter(|effect| effect.name != "dither") {
            assert_eq!(
                first_words(effect, LengthUnit::Meter, None),
                effect.defaults
            );
        }
    }

    #[test]
    fn lengths_fit_a_scene_that_is_far_from_a_meter() {
        let inflate = Effect::find("inflate").expect("a built-in effect");
        let amount = |side: f64| {
            let bounds = Bounds {
                min: glam::DVec3::splat(-side),
                max: glam::DVec3::splat(side),
            };
            let words = first_words(inflate, LengthUnit::Meter, Some(bounds));
            inflate.field("amount_m").expect("a parameter").get(&words)[0]
        };
        let default = f64::from(0.05_f32);
        assert_eq!(amount(1.0), default);
        for side in [100.0, 0.01] {
            assert!((amount(side) / (default * side * 3.0_f64.sqrt()) - 1.0).abs() < 1e-3);
        }
    }
}
