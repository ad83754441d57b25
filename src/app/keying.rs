//! Keying: values become keys at the time that is shown, and keys are moved, eased and removed.

use super::{App, Level};
use crate::{
    effects::Effect,
    params::{Field, Value},
    preset::animation::{Easing, Keyframe, Track, default_easing},
    preset_file::{self, PresetError},
};

/// Two moments that no hand can tell apart, seconds: half of a thousandth, the last digit that is shown.
const SAME_S: f64 = 5e-4;

/// What the key button of a row shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keying {
    /// No key at any time.
    Still,
    /// Animated, with no key at the time that is shown.
    Between,
    /// There is a key at the time that is shown.
    OnKey,
}

/// One key of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyId {
    pub effect: &'static Effect,
    pub field: &'static str,
    pub time_s: f64,
}

impl KeyId {
    /// `facet.front`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.effect.name, self.field)
    }
}

/// `facet.front` as effect and field.
fn parameter(path: &str) -> Option<(&'static Effect, &'static Field)> {
    let (effect, field) = path.split_once('.')?;
    let effect = Effect::find(effect)?;
    Some((effect, effect.field(field)?))
}

impl App {
    pub(super) fn keying(&self, effect: &Effect, field: &Field) -> Keying {
        match self.preset_file.preset.animation.get(effect.name, field.name) {
            None => Keying::Still,
            Some(track) if self.key_here(track).is_some() => Keying::OnKey,
            Some(_) => Keying::Between,
        }
    }

    /// The key at the time that is shown.
    fn key_here(&self, track: &Track) -> Option<usize> {
        let now_s = self.shown_time_s();
        track.keys().iter().position(|key| (key.time_s - now_s).abs() <= SAME_S)
    }

    /// Gives a parameter a value: an animated one at the time that is shown, any other at all times.
    pub(super) fn put_value(&mut self, effect: &'static Effect, field: &'static Field, value: &Value) {
        let outcome = if self.preset_file.preset.animation.get(effect.name, field.name).is_some() {
            self.playback.playing = false; // Or every frame would leave a key.
            self.set_key(effect, field, value.components()).map_err(|error| error.to_string())
        } else {
            let enabled = self.preset_file.preset.stack.get_mut(effect.name);
            enabled.map_or(Ok(()), |enabled| field.set_value(&mut enabled.words, value).map_err(|error| error.to_string()))
        };
        if let Err(error) = outcome {
            self.tell(Level::Error, format!("{}.{}: {error}", effect.name, field.name));
        }
    }

    /// Sets a key at the time that is shown. It goes on to the next as the key before it does.
    fn set_key(
        &mut self,
        effect: &'static Effect,
        field: &'static Field,
        value: Vec<f64>,
    ) -> Result<(), crate::preset::animation::KeyframeError> {
        let now_s = self.shown_time_s();
        let Some(track) = self.preset_file.preset.animation.get(effect.name, field.name) else {
            let first = Keyframe { time_s: now_s, value, easing: default_easing(field) };
            self.preset_file.preset.animation.put(Track::new(effect, field, vec![first])?);
            return Ok(());
        };
        let here = self.key_here(track);
        let before = here.or_else(|| track.keys().partition_point(|key| key.time_s <= now_s).checked_sub(1));
        let time_s = here.map_or(now_s, |index| track.keys()[index].time_s);
        let easing = before.map_or(default_easing(field), |index| track.keys()[index].easing);
        match self.preset_file.preset.animation.get_mut(effect.name, field.name) {
            Some(track) => track.set(Keyframe { time_s, value, easing }),
            None => Ok(()),
        }
    }

    /// What the key button does: sets a key at the time that is shown, or removes the one that is there.
    pub(super) fn toggle_key(&mut self, path: &str) {
        let Some((effect, field)) = parameter(path) else { return };
        let here = self.preset_file.preset.animation.get(effect.name, field.name).and_then(|track| {
            let index = self.key_here(track)?;
            Some(KeyId { effect, field: field.name, time_s: track.keys()[index].time_s })
        });
        if let Some(key) = here {
            return self.remove_key(key);
        }
        let Some(value) = self.shown_value(effect, field) else { return };
        if let Err(error) = self.set_key(effect, field, value) {
            self.tell(Level::Error, format!("{path}: {error}"));
        }
    }

    /// Removes a key. The value of the last one stays.
    pub(super) fn remove_key(&mut self, key: KeyId) {
        let preset = &mut self.preset_file.preset;
        let Some(track) = preset.animation.get(key.effect.name, key.field).cloned() else { return };
        let Some(index) = track.at(key.time_s) else { return };
        let (field, last) = (track.field(), track.keys()[index].value.clone());
        match track.without(index) {
            Some(track) => preset.animation.put(track),
            None => {
                preset.animation.remove(key.effect.name, key.field);
                if let Some(last) = field.value_type.value(&last) {
                    self.put_value(key.effect, field, &last);
                }
            }
        }
    }

    /// Moves a key in time; it stays where it is when the place is taken. Gives its time.
    pub(super) fn move_keyframe(&mut self, key: KeyId, time_s: f64) -> f64 {
        let track = self.preset_file.preset.animation.get_mut(key.effect.name, key.field);
        let moved = track.and_then(|track| {
            let index = track.at(key.time_s)?;
            let index = track.move_keyframe(index, time_s);
            Some(track.keys()[index].time_s)
        });
        moved.unwrap_or(key.time_s)
    }

    pub(super) fn ease_key(&mut self, key: KeyId, easing: Easing) {
        if let Some(track) = self.preset_file.preset.animation.get_mut(key.effect.name, key.field)
            && let Some(index) = track.at(key.time_s)
        {
            track.set_easing(index, easing);
        }
    }

    /// Sets a row's value from text, by the rules of files; a key where the row is animated.
    pub(super) fn put_text(&mut self, path: &str, text: &str) -> Result<(), PresetError> {
        let short = path.strip_prefix("effects.").unwrap_or(path);
        let animated = parameter(short).filter(|(effect, field)| self.preset_file.preset.animation.get(effect.name, field.name).is_some());
        let Some((effect, field)) = animated else { return preset_file::set(&mut self.preset_file, path, text) };
        let mut probe = self.preset_file.clone();
        preset_file::set(&mut probe, path, text)?;
        if let Some(enabled) = probe.preset.stack.get(effect.name) {
            self.put_value(effect, field, &field.value(&enabled.words));
        }
        Ok(())
    }
}
