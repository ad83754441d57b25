//! Paths: one key of a preset by its name, as `--set`, `--unset`, copied values and resets mean it.

use toml_edit::{DocumentMut, Item, Value as TomlValue};

use super::{
    Place, PresetError, PresetFile,
    form::{ValueType, did_you_mean},
    keys::{KEYS, Key, Section},
    migrate, parse_file, put, read, to_toml,
};
use crate::{
    effects::{EFFECTS, Effect},
    params::Field,
    preset::{Animation, Preset, animation::Track},
};

/// Where a `--set` or `--unset` path leads.
enum Target {
    Effect(&'static Effect),
    Field(&'static Effect, &'static Field),
    Key(&'static Key),
    Section(&'static Section),
    Stack,
    /// Every track, those of an effect, or one.
    Animation(Option<&'static Effect>, Option<&'static Field>),
}

fn target(path: &str) -> Result<Target, String> {
    if path == "stack" {
        return Ok(Target::Stack);
    }
    if let Some(key) = Key::find(path) {
        return Ok(Target::Key(key));
    }
    if let Some(section) = Section::find(path) {
        return Ok(Target::Section(section));
    }
    if path == "animation" {
        return Ok(Target::Animation(None, None));
    }
    if let Some(rest) = path.strip_prefix("animation.") {
        return match target(rest)? {
            Target::Effect(effect) => Ok(Target::Animation(Some(effect), None)),
            Target::Field(effect, field) => Ok(Target::Animation(Some(effect), Some(field))),
            _ => Err("is unknown; parameters of effects can be animated".into()),
        };
    }
    let short = path.strip_prefix("effects.").unwrap_or(path);
    let (name, field) = short.split_once('.').map_or((short, None), |(name, field)| (name, Some(field)));
    match (Effect::find(name), field) {
        (Some(effect), None) => Ok(Target::Effect(effect)),
        (Some(effect), Some(field)) => match effect.field(field) {
            Some(field) => Ok(Target::Field(effect, field)),
            None => Err(format!("is unknown{}", did_you_mean(field, effect.fields.iter().map(|field| field.name)))),
        },
        (None, _) => {
            let keys = KEYS.iter().map(Key::path);
            let fields = EFFECTS.iter().flat_map(|e| e.fields.iter().map(move |f| format!("{}.{}", e.name, f.name)));
            let known: Vec<String> = keys.chain(fields).chain(EFFECTS.iter().map(|e| e.name.to_owned())).collect();
            Err(format!("is unknown{}", did_you_mean(short, known.iter().map(String::as_str))))
        }
    }
}

/// A value as typed on a command line: TOML, or a number such as `.4`, or a bare word.
fn typed(value: &str) -> TomlValue {
    let value = value.trim();
    value.parse().unwrap_or_else(|_| match value.parse::<f64>() {
        Ok(number) if number.is_finite() => number.into(),
        _ => value.into(),
    })
}

/// Changes one key, as `--set path=value` does: `effects.` is optional, setting a parameter enables its effect, and an
/// effect or section with an empty value is enabled with defaults. A parameter that was animated holds still from then
/// on. Same ranges and errors as in a file.
pub fn set(preset_file: &mut PresetFile, path: &str, value: &str) -> Result<(), PresetError> {
    let written = if value.is_empty() { format!("--set {path}") } else { format!("--set {path}={value}") };
    let wrong = |reason: String| PresetError::value(Place { file: written.clone(), line: None }, path, reason);
    let preset = &mut preset_file.preset;
    let target = target(path).map_err(wrong)?;
    if let Target::Effect(effect) | Target::Field(effect, _) | Target::Animation(Some(effect), _) = target
        && let Some(conflict) = preset.stack.rival(effect)
    {
        return Err(PresetError::value(Place { file: written, line: None }, "effects", conflict.to_string()));
    }
    match target {
        Target::Effect(effect) if value.is_empty() => drop(preset.stack.enable(effect)),
        Target::Section(section) if value.is_empty() => section.enter(preset),
        Target::Effect(_) | Target::Section(_) => return Err(wrong("takes no value; name one of its keys".into())),
        Target::Field(effect, field) => {
            let plain = read::read_value(&ValueType::of(field), &typed(value)).map_err(wrong)?;
            put(field, &mut preset.stack.enable(effect).words, &plain).map_err(wrong)?;
            preset.animation.remove(effect.name, field.name);
        }
        Target::Animation(Some(effect), Some(field)) => {
            let track = track(effect, field, value, &written)?;
            preset.stack.enable(effect);
            preset.animation.put(track);
        }
        Target::Animation(..) => return Err(wrong("takes no value; name a parameter, for instance animation.facet.amount".into())),
        Target::Key(key) => {
            // A name that looks like a number is still a name.
            let value = Some(typed(value))
                .filter(|typed| typed.is_str() || !matches!(key.form, ValueType::Text { .. }))
                .unwrap_or_else(|| value.into());
            let plain = read::read_value(&key.form, &value).map_err(wrong)?;
            key.check(&plain).map_err(wrong)?;
            (key.set)(preset, plain);
        }
        Target::Stack => {
            // The reader knows the rules of this key, so it goes the way of a file.
            let mut text: DocumentMut = to_toml(preset_file).parse().map_err(|e: toml_edit::TomlError| wrong(e.message().into()))?;
            text.insert("stack", Item::Value(typed(value)));
            let reread = parse_file(&text.to_string(), &preset_file.id, &written).map_err(|error| typed_at(error, &written))?;
            preset_file.preset.stack = reread.preset.stack;
        }
    }
    Ok(())
}

/// Reads a list of keys the way of a file, which knows its rules.
fn track(effect: &'static Effect, field: &'static Field, value: &str, written: &str) -> Result<Track, PresetError> {
    let text = format!("schema = {}\n[animation.{}]\n{} = {value}\n", migrate::CURRENT, effect.name, field.name);
    let preset_file = parse_file(&text, "set", written).map_err(|error| typed_at(error, written))?;
    let path = format!("animation.{}.{}", effect.name, field.name);
    let found = preset_file.preset.animation.get(effect.name, field.name).cloned();
    found.ok_or_else(|| PresetError::value(Place { file: written.into(), line: None }, path, "must be a list of keys"))
}

/// The error without the line of a text that nobody wrote.
fn typed_at(error: PresetError, written: &str) -> PresetError {
    let at = Place { file: written.into(), line: None };
    match error {
        PresetError::Value { key, reason, .. } => PresetError::Value { at, key, reason },
        PresetError::Syntax { reason, .. } => PresetError::Syntax { at, reason },
        other => other,
    }
}

/// Puts one key back to its default, as `--unset path` does; an effect or section is taken out, with what moves it.
pub fn unset(preset_file: &mut PresetFile, path: &str) -> Result<(), PresetError> {
    let place = Place { file: format!("--unset {path}"), line: None };
    let preset = &mut preset_file.preset;
    match target(path).map_err(|reason| PresetError::value(place, path, reason))? {
        Target::Effect(effect) => preset.disable(effect.name),
        Target::Animation(None, _) => preset.animation = Animation::default(),
        Target::Animation(Some(effect), None) => preset.animation.remove_effect(effect.name),
        Target::Animation(Some(effect), Some(field)) => preset.animation.remove(effect.name, field.name),
        Target::Field(effect, field) => {
            preset.animation.remove(effect.name, field.name);
            if let Some(enabled) = preset.stack.get_mut(effect.name) {
                field.copy(&(effect.defaults)(), &mut enabled.words);
            }
        }
        Target::Key(key) => reset(preset, key),
        Target::Section(section) => match section.name {
            "camera" => preset.camera = None,
            "test" => preset.test = None,
            name => KEYS.iter().filter(|key| key.section == name).for_each(|key| reset(preset, key)),
        },
        Target::Stack => preset.stack.0.sort_by_key(|enabled| enabled.effect.rank()),
    }
    Ok(())
}

/// Gives `key` its default; one that has none hands over to its rival.
fn reset(preset: &mut Preset, key: &Key) {
    if (key.get)(preset).is_none() {
        return;
    }
    match (key.section, key.name) {
        // Without a tolerance of its own a preset has its tier's.
        ("accuracy", "wrong_ppm") => return preset.accuracy.wrong_ppm = None,
        ("accuracy", "channel") => return preset.accuracy.channel = None,
        _ => {}
    }
    let baseline = Section::baseline(preset);
    let rival = key.rival.and_then(|name| Key::within(key.section, name));
    for key in [Some(key), rival].into_iter().flatten() {
        if let Some(default) = (key.get)(&baseline) {
            (key.set)(preset, default);
            return;
        }
    }
}
