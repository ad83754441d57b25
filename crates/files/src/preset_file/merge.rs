//! Merging: a preset that was changed here and in its file, key by key.

use crate::{
    effects::EnabledEffect,
    params::{Param, Value},
    preset::{
        Preset,
        settings::{BOOKMARKS, settings},
    },
};

use super::toml_value;

/// A preset with the changes of both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    pub preset: Preset,
    /// Paths of the values that both sides have changed to different values; they have the value
    /// of `mine`.
    pub conflicts: Vec<String>,
}

/// What `theirs` becomes with the changes from `base` to `mine`, key by key: settings, effects,
/// parameters, keyframes and the order of the stack. Where both have changed a value, that of
/// `mine` stays.
pub fn merge(base: &Preset, mine: &Preset, theirs: &Preset) -> Merged {
    let mut merged = Merged {
        preset: theirs.clone(),
        conflicts: Vec::new(),
    };
    merged.settings(base, mine, theirs);
    merged.bookmarks(base, mine, theirs);
    merged.effects(base, mine, theirs);
    merged.order(base, mine);
    merged.animation(base, mine, theirs);
    merged
}

/// Compared as text, which tells -0.0 from 0.0.
fn text(param: &Param, value: Option<&Value>) -> Option<String> {
    value.map(|value| toml_value::write_text(&param.value_type, value))
}

impl Merged {
    fn settings(&mut self, base: &Preset, mine: &Preset, theirs: &Preset) {
        for setting in settings() {
            let [before, now, other] = [base, mine, theirs].map(|preset| setting.get(preset));
            let [before, now_text, other] =
                [&before, &now, &other].map(|value| text(setting, value.as_ref()));
            if before == now_text || other == now_text {
                continue;
            }
            if other != before {
                self.conflicts.push(setting.path());
            }
            if let Some(value) = now {
                // A value of a preset passes the check of its setting.
                drop(setting.set(&mut self.preset, &value));
            }
        }
        if mine.camera.is_none() && base.camera.is_some() {
            self.preset.camera = None;
        }
        if mine.ground.is_none() && base.ground.is_some() {
            self.preset.ground = None;
        }
        if mine.test.is_none() && base.test.is_some() {
            self.preset.test = None;
        }
    }

    fn bookmarks(&mut self, base: &Preset, mine: &Preset, theirs: &Preset) {
        let [before, now, other] = [base, mine, theirs].map(|preset| &preset.bookmarks);
        if before == now || other == now {
            return;
        }
        if other != before {
            self.conflicts.push(BOOKMARKS.to_owned());
        }
        self.preset.bookmarks.clone_from(now);
    }

    fn effects(&mut self, base: &Preset, mine: &Preset, theirs: &Preset) {
        for now in &mine.stack.0 {
            let name = &now.effect.name;
            let before = base.stack.get(name);
            if theirs.stack.get(name).is_none() {
                if before.is_none_or(|before| before != now) {
                    self.preset.stack.enable(&now.effect).clone_from(now);
                    if before.is_some() {
                        self.conflicts.push(format!("effects.{name}"));
                    }
                }
                continue;
            }
            let new = EnabledEffect::new(&now.effect);
            let EnabledEffect {
                words: before, on, ..
            } = before.unwrap_or(&new);
            if let Some(other) = self
                .preset
                .stack
                .get_mut(name)
                .filter(|other| now.on != *on && other.on != now.on)
            {
                if other.on != *on {
                    self.conflicts.push(format!("{name}.on"));
                }
                other.on.clone_from(&now.on);
            }
            for field in now
                .effect
                .fields
                .iter()
                .filter(|field| !field.same(&now.words, before))
            {
                let Some(other) = self.preset.stack.get_mut(name) else {
                    continue;
                };
                let Some(theirs) = other.effect.field(&field.name) else {
                    continue;
                };
                if !field.same(&other.words, before) && !field.same(&other.words, &now.words) {
                    self.conflicts.push(format!("{name}.{}", field.name));
                }
                // A value outside the range of another version of the effect is refused, and theirs
                // stays.
                drop(theirs.set_value(&mut other.words, &field.value(&now.words)));
            }
        }
        for gone in base
            .stack
            .0
            .iter()
            .filter(|before| mine.stack.get(&before.effect.name).is_none())
        {
            self.preset.disable(&gone.effect.name);
        }
    }

    /// The order of `mine`, if it is another than that of `base`.
    fn order(&mut self, base: &Preset, mine: &Preset) {
        let shared = |of: &Preset, other: &Preset| -> Vec<String> {
            of.stack
                .0
                .iter()
                .map(|enabled| enabled.effect.name.clone())
                .filter(|name| other.stack.get(name).is_some())
                .collect()
        };
        if shared(base, mine) != shared(mine, base) {
            let position = |name: &str| {
                mine.stack
                    .0
                    .iter()
                    .position(|enabled| enabled.effect.name == name)
                    .unwrap_or(usize::MAX)
            };
            self.preset
                .stack
                .0
                .sort_by_key(|enabled| position(&enabled.effect.name));
        }
    }

    fn animation(&mut self, base: &Preset, mine: &Preset, theirs: &Preset) {
        for track in mine
            .animation
            .tracks()
            .iter()
            .chain(base.animation.tracks())
        {
            let (effect, field) = (&track.effect().name, &track.field().name);
            let [before, now, other] =
                [base, mine, theirs].map(|preset| preset.animation.get(effect, field));
            if before == now || other == now || self.preset.stack.get(effect).is_none() {
                continue;
            }
            if other != before {
                self.conflicts.push(format!("animation.{effect}.{field}"));
            }
            match now {
                Some(track) => self.preset.animation.put(track.clone()),
                None => self.preset.animation.remove(effect, field),
            }
        }
        self.conflicts.sort();
        self.conflicts.dedup();
    }
}
