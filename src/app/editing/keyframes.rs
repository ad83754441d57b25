//! Edits of keyframes: values become keys at the time shown, and keys are moved, eased and removed.

use super::{
    command::KeyframeEdit,
    key_id::{KeyId, Keying},
    session::Session,
};
use crate::{
    app::shell::command::Parameter,
    effect_files::Catalog,
    effects::Effect,
    params::Field,
    preset::{
        Preset,
        animation::{Keyframe, KeyframeError, Track, default_easing},
    },
    preset_file::{self, PresetError},
};

/// Two times closer than this are the same, seconds: half of a thousandth, the last digit that is
/// shown.
const SAME_S: f64 = 5e-4;

/// `facet.front` as effect and field.
fn parameter(path: &str, catalog: &Catalog) -> Option<Parameter> {
    let (effect, field) = path.split_once('.')?;
    let effect = catalog.find(effect).ok()??;
    Some((effect.clone(), effect.field(field)?.clone()))
}

/// Index of the key at `now_s`.
fn key_at(track: &Track, now_s: f64) -> Option<usize> {
    track
        .keys()
        .iter()
        .position(|key| (key.time_s - now_s).abs() <= SAME_S)
}

/// Sets a key at `now_s`. It is eased as the key before it.
fn set_key(
    preset: &mut Preset,
    now_s: f64,
    (effect, field): Parameter,
    value: Vec<f64>,
) -> Result<(), KeyframeError> {
    let Some(track) = preset.animation.get_mut(&effect.name, &field.name) else {
        let first = Keyframe {
            time_s: now_s,
            value,
            easing: default_easing(&field),
        };
        preset
            .animation
            .put(Track::new(&effect, &field, vec![first])?);
        return Ok(());
    };
    let here = key_at(track, now_s);
    let before = here.or_else(|| {
        track
            .keys()
            .partition_point(|key| key.time_s <= now_s)
            .checked_sub(1)
    });
    let time_s = here.map_or(now_s, |index| track.keys()[index].time_s);
    let easing = before.map_or(default_easing(&field), |index| track.keys()[index].easing);
    track.set(Keyframe {
        time_s,
        value,
        easing,
    })
}

impl Session {
    pub fn keying(&self, effect: &Effect, field: &Field) -> Keying {
        match self.preset().animation.get(&effect.name, &field.name) {
            None => Keying::Still,
            Some(track) if key_at(track, self.shown_time_s()).is_some() => Keying::OnKey,
            Some(_) => Keying::Between,
        }
    }

    /// Sets a keyframe of a parameter at the time shown.
    ///
    /// # Errors
    /// In a sentence that names the parameter.
    pub fn set_keyframe(
        &mut self,
        (effect, field): Parameter,
        value: Vec<f64>,
    ) -> Result<(), String> {
        let now_s = self.shown_time_s();
        let path = format!("{}.{}", effect.name, field.name);
        set_key(self.preset_mut(), now_s, (effect, field), value)
            .map_err(|error| format!("{path}: {error}"))
    }

    /// Sets a key of the parameter at `path` at the time shown, or removes the one that is there.
    ///
    /// # Errors
    /// In a sentence that names the parameter.
    pub fn toggle_key(&mut self, path: &str) -> Result<(), String> {
        let Some((effect, field)) = parameter(path, &self.preset_file.effects) else {
            return Ok(());
        };
        let now_s = self.shown_time_s();
        let here = self
            .preset()
            .animation
            .get(&effect.name, &field.name)
            .and_then(|track| {
                let index = key_at(track, now_s)?;
                Some(KeyId {
                    effect: effect.clone(),
                    field: field.name.clone(),
                    time_s: track.keys()[index].time_s,
                })
            });
        if let Some(key) = here {
            return self.remove_key(key);
        }
        let Some(value) = self.shown_value(&effect, &field) else {
            return Ok(());
        };
        self.set_keyframe((effect, field), value)
    }

    /// [`Preset::key_from`] on the scene that is shown.
    fn key_from(&mut self, other: &Preset) -> usize {
        let scene = self.scene().cloned().unwrap_or_default();
        self.preset_mut().key_from(other, &scene)
    }

    /// Removes a key. The value of the last one stays.
    fn remove_key(&mut self, key: KeyId) -> Result<(), String> {
        let preset = self.preset_mut();
        let Some(track) = preset.animation.get(&key.effect.name, &key.field).cloned() else {
            return Ok(());
        };
        let Some(index) = track.at(key.time_s) else {
            return Ok(());
        };
        let (field, last) = (track.field().clone(), track.keys()[index].value.clone());
        match track.without(index) {
            Some(track) => preset.animation.put(track),
            None => {
                preset.animation.remove(&key.effect.name, &key.field);
                if let Some(last) = field.value_type.value(&last) {
                    return self.set_parameter((key.effect, field), &last);
                }
            }
        }
        Ok(())
    }

    /// Moves a key in time; it stays where it is if another key is there. Returns the key as it is
    /// then.
    fn move_keyframe(&mut self, key: KeyId, time_s: f64) -> KeyId {
        let track = self
            .preset_mut()
            .animation
            .get_mut(&key.effect.name, &key.field);
        let moved = track.and_then(|track| {
            let index = track.at(key.time_s)?;
            let index = track.move_keyframe(index, time_s);
            Some(track.keys()[index].time_s)
        });
        KeyId {
            time_s: moved.unwrap_or(key.time_s),
            ..key
        }
    }

    /// Carries out `edit`. Returns the key that becomes the selected one.
    ///
    /// # Errors
    /// In a sentence that names the parameter.
    pub fn edit_keyframe(&mut self, edit: KeyframeEdit) -> Result<Option<KeyId>, String> {
        match edit {
            KeyframeEdit::Move(key, time_s) => Ok(Some(self.move_keyframe(key, time_s))),
            KeyframeEdit::Ease(key, easing) => {
                if let Some(track) = self
                    .preset_mut()
                    .animation
                    .get_mut(&key.effect.name, &key.field)
                    && let Some(index) = track.at(key.time_s)
                {
                    track.set_easing(index, easing);
                }
                Ok(Some(key))
            }
            KeyframeEdit::Remove(key) => self.remove_key(key).map(|()| None),
            KeyframeEdit::From(other) => match self.key_from(&other) {
                0 => Err("A and B have no effect in common with numbers or colors that differ, so nothing is keyed".into()),
                _ => Ok(None),
            },
        }
    }

    /// Sets the value at `path` from text, by the rules of preset files; an animated parameter gets
    /// a key.
    ///
    /// # Errors
    /// If the path is unknown or the text is not a value of it.
    pub fn set_text(&mut self, path: &str, text: &str) -> Result<(), String> {
        let short = path.strip_prefix("effects.").unwrap_or(path);
        let animated = parameter(short, &self.preset_file.effects).filter(|(effect, field)| {
            self.preset()
                .animation
                .get(&effect.name, &field.name)
                .is_some()
        });
        let sentence = |error: PresetError| error.to_string();
        let Some((effect, field)) = animated else {
            return preset_file::set(&mut self.preset_file, path, text).map_err(sentence);
        };
        let mut probe = self.preset_file.clone();
        preset_file::set(&mut probe, path, text).map_err(sentence)?;
        let value = probe
            .preset
            .stack
            .get(&effect.name)
            .map(|enabled| field.value(&enabled.words));
        value.map_or(Ok(()), |value| self.set_parameter((effect, field), &value))
    }
}
