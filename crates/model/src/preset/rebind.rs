//! Rebinding: what a preset becomes when the text of an effect has changed while the program runs.
//! Values are kept by the name of their parameter.

use std::sync::Arc;

use super::{
    Preset,
    animation::{Animation, Easing, Keyframe, Track, steps},
};
use crate::{
    effects::{Effect, EnabledEffect, Stack},
    params::{Field, Value, ValueType},
};

/// An effect as it was, and as it is now.
pub type Replaced = (Arc<Effect>, Arc<Effect>);

impl Preset {
    /// Uses the new effect in place of each old one, on the same parts of the scene. A parameter
    /// keeps its value if the new effect has one of the same name and type whose range contains
    /// it. Every other parameter has its new default, and so has one that had its old default,
    /// since files do not state defaults. Keyframes that do not fit are dropped.
    pub fn rebind(&mut self, replaced: &[Replaced]) {
        rebind_stack(&mut self.stack, replaced);
        if self
            .animation
            .tracks()
            .iter()
            .all(|track| find(track.effect(), replaced).is_none())
        {
            return;
        }
        let mut animation = Animation::default();
        for track in self.animation.tracks() {
            match find(track.effect(), replaced) {
                None => animation.put(track.clone()),
                Some(effect) => rebound_track(track, effect)
                    .into_iter()
                    .for_each(|track| animation.put(track)),
            }
        }
        self.animation = animation;
    }
}

/// [`Preset::rebind`] of the stack alone.
pub fn rebind_stack(stack: &mut Stack, replaced: &[Replaced]) {
    for enabled in &mut stack.0 {
        if let Some(effect) = find(&enabled.effect, replaced) {
            *enabled = rebound_effect(enabled, effect);
        }
    }
}

fn find<'a>(old: &Effect, replaced: &'a [Replaced]) -> Option<&'a Arc<Effect>> {
    replaced
        .iter()
        .find(|(before, _)| **before == *old)
        .map(|(_, after)| after)
}

fn rebound_effect(old: &EnabledEffect, effect: &Arc<Effect>) -> EnabledEffect {
    let defaults = &old.effect.defaults;
    let mut new = EnabledEffect::new(effect);
    if effect.has_scope() {
        new.on = old.on.clone();
    }
    for field in &effect.fields {
        if let Some(before) = old
            .effect
            .field(&field.name)
            .filter(|before| !before.same(&old.words, defaults))
            && let Some(value) = converted(before, field, before.value(&old.words))
        {
            // A value outside the new range is refused, and the default stays.
            let _ = field.set_value(&mut new.words, &value);
        }
    }
    new
}

/// A value of `before` as one of `field`; none if the type is another. Words of a choice keep their
/// meaning in another order.
fn converted(before: &Field, field: &Field, value: Value) -> Option<Value> {
    match (&before.value_type, &field.value_type, &value) {
        (ValueType::Choice(old), ValueType::Choice(new), Value::Choice(index)) => {
            let word = old.get(*index)?;
            new.iter().position(|name| name == word).map(Value::Choice)
        }
        (old, new, _) => (old == new).then_some(value),
    }
}

/// The track with the keyframes that fit the parameter of its name; none if no keyframe does.
fn rebound_track(track: &Track, effect: &Arc<Effect>) -> Option<Track> {
    let field = effect.field(&track.field().name)?;
    let rebound_key = |key: &Keyframe| {
        let value = converted(
            track.field(),
            field,
            track.field().value_type.value(&key.value)?,
        )?;
        let easing = if steps(field) {
            Easing::Hold
        } else {
            key.easing
        };
        let key = Keyframe {
            value: value.components(),
            easing,
            ..*key
        };
        Track::new(effect, field, vec![key.clone()])
            .is_ok()
            .then_some(key)
    };
    Track::new(
        effect,
        field,
        track.keys().iter().filter_map(rebound_key).collect(),
    )
    .ok()
}
