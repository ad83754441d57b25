//! Shrinking: the smallest preset that still fails.

use crate::{
    accuracy::AXES,
    preset::{Preset, SceneSource, animation::Animation, settings::settings},
    scene::parts::Scope,
};

/// The smallest preset, made by taking things away from `preset` one by one, that `fails`. `fails`
/// is called at most `max_calls` times.
pub fn shrink(preset: Preset, max_calls: usize, mut fails: impl FnMut(&Preset) -> bool) -> Preset {
    let (mut smallest, mut calls) = (preset, 0);
    loop {
        let mut is_smaller = false;
        // A candidate is made from the smallest preset so far, which may have fewer steps than when
        // the loop began.
        let mut step = 0;
        while let Some(candidate) = candidates(&smallest).into_iter().nth(step) {
            if calls == max_calls {
                return smallest;
            }
            calls += 1;
            if fails(&candidate) {
                smallest = candidate;
                is_smaller = true;
            } else {
                step += 1;
            }
        }
        if !is_smaller {
            return smallest;
        }
    }
}

/// Every preset that says one thing less; those that say much less come first.
fn candidates(preset: &Preset) -> Vec<Preset> {
    let changed = |change: &dyn Fn(&mut Preset)| {
        let mut candidate = preset.clone();
        change(&mut candidate);
        candidate
    };
    let mut candidates = Vec::new();
    for enabled in &preset.stack.0 {
        candidates.push(changed(&|preset| preset.disable(&enabled.effect.name)));
    }
    candidates.push(changed(&|preset| preset.animation = Animation::default()));
    for axis in AXES
        .iter()
        .filter(|axis| preset.accuracy.pins.get(axis).is_some())
    {
        candidates.push(changed(&|preset| preset.accuracy.pins.set(axis, None)));
    }
    candidates.push(changed(&|preset| preset.camera = None));
    for setting in
        settings().filter(|setting| !setting.section.is_empty() && setting.is_modified(preset))
    {
        // The size and the scene are made smaller, not given their defaults.
        if !matches!(
            (setting.section, setting.name.as_str()),
            ("output", "size") | ("scene", "builtin" | "path")
        ) {
            candidates.push(changed(&|preset| setting.reset(preset)));
        }
    }
    for side in 0..2 {
        candidates.push(changed(&|preset| {
            preset.output.size[side] = (preset.output.size[side] / 2).max(1)
        }));
    }
    candidates.extend(smaller_scenes(preset));
    for (at, enabled) in preset.stack.0.iter().enumerate() {
        let effect = &enabled.effect;
        candidates.push(changed(&|preset| preset.stack.0[at].on = Scope::default()));
        let defaults = &effect.defaults;
        for field in &effect.fields {
            candidates.push(changed(&|preset| {
                field.copy(defaults, &mut preset.stack.0[at].words)
            }));
        }
    }
    candidates.retain(|candidate| candidate != preset);
    candidates
}

/// The preset with its built-in scene without one of the scene's values.
fn smaller_scenes(preset: &Preset) -> Vec<Preset> {
    let SceneSource::Builtin(query) = &preset.scene else {
        return Vec::new();
    };
    let Some((name, pairs)) = query.split_once('?') else {
        return Vec::new();
    };
    let pairs: Vec<&str> = pairs.split('&').collect();
    let without = |left_out: usize| {
        let kept: Vec<&str> = pairs
            .iter()
            .enumerate()
            .filter(|(at, _)| *at != left_out)
            .map(|(_, pair)| *pair)
            .collect();
        let query = if kept.is_empty() {
            name.to_owned()
        } else {
            format!("{name}?{}", kept.join("&"))
        };
        Preset {
            scene: SceneSource::Builtin(query),
            ..preset.clone()
        }
    };
    (0..pairs.len()).map(without).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::random;

    #[test]
    fn what_does_not_matter_is_taken_away() {
        let with_fog = (0..1_000)
            .map(random::preset)
            .find(|preset| preset.stack.get("fog").is_some() && preset.stack.0.len() > 2);
        let preset = with_fog.expect("one of a thousand presets has fog");
        let smallest = shrink(preset, 10_000, |preset| preset.stack.get("fog").is_some());
        assert_eq!(smallest.stack.0.len(), 1);
        assert_eq!(
            (smallest.output.size, smallest.camera, smallest.accuracy),
            ([1, 1], None, Preset::default().accuracy)
        );
        let fog = &smallest.stack.0[0];
        assert_eq!(fog.words, fog.effect.defaults);
    }

    #[test]
    fn a_number_of_calls_bounds_the_work() {
        let mut calls = 0;
        shrink(random::preset(3), 5, |_| {
            calls += 1;
            true
        });
        assert!(calls <= 5);
    }
}
