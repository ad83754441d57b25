//! Edits of one value by its path, as `--set`, `--unset`, pasted values and resets do them.

use std::sync::Arc;

use toml_edit::{Item, Value as Toml};

use super::{
    error::{Position, PresetError},
    file::PresetFile,
    keyframes, order,
    reader::{INSTANCE_KEY, Reader, number_text},
    scope::{self, SCOPE_KEY},
    toml_value,
};
use crate::{
    effect_files::Catalog,
    effects::Effect,
    params::{Field, Param, Value, ValueType, did_you_mean},
    preset::{
        Animation,
        settings::{Section, Setting, settings},
    },
    scene::parts::Scope,
};

/// What errors call the place of a value that is set by hand; the key and the value follow.
const ARGUMENT: &str = "--set";

/// What a `--set` or `--unset` path names.
enum Target {
    Effect(Arc<Effect>),
    Field(Arc<Effect>, Arc<Field>),
    /// The parts of the scene that an effect changes.
    Scope(Arc<Effect>),
    Setting(&'static Setting),
    Section(&'static Section),
    Stack,
    /// Every track, those of an effect, or one.
    Animation(Option<Arc<Effect>>, Option<Arc<Field>>),
}

fn target(path: &str, catalog: &Catalog) -> Result<Target, String> {
    match path {
        "stack" => return Ok(Target::Stack),
        "animation" => return Ok(Target::Animation(None, None)),
        _ => {}
    }
    if let Some(rest) = path.strip_prefix("animation.") {
        return match target(rest, catalog)? {
            Target::Effect(effect) => Ok(Target::Animation(Some(effect), None)),
            Target::Field(effect, field) => Ok(Target::Animation(Some(effect), Some(field))),
            _ => Err("is unknown; only parameters of effects can be animated".into()),
        };
    }
    if let Some(setting) = Setting::find(path) {
        return Ok(Target::Setting(setting));
    }
    if let Some(section) = Section::find(path).filter(|_| !path.is_empty()) {
        return Ok(Target::Section(section));
    }
    let short = path.strip_prefix("effects.").unwrap_or(path);
    let (name, field) = short
        .split_once('.')
        .map_or((short, None), |(name, field)| (name, Some(field)));
    let found = catalog
        .find(name)
        .map_err(|error| format!("cannot be used: {error}"))?;
    let Some(effect) = found else {
        return Err(format!("is unknown{}", suggestion_for_path(short, catalog)));
    };
    let Some(field) = field else {
        return Ok(Target::Effect(effect.clone()));
    };
    if field == SCOPE_KEY {
        return Ok(Target::Scope(effect.clone()));
    }
    let unknown = || {
        format!(
            "is unknown{}",
            did_you_mean(
                field,
                effect
                    .fields
                    .iter()
                    .map(|field| field.name.as_str())
                    .chain([SCOPE_KEY])
            )
        )
    };
    effect
        .field(field)
        .map(|field| Target::Field(effect.clone(), field.clone()))
        .ok_or_else(unknown)
}

/// The closest of all paths.
fn suggestion_for_path(path: &str, catalog: &Catalog) -> String {
    let fields = catalog.effects().flat_map(|e| {
        e.fields
            .iter()
            .map(move |f| format!("{}.{}", e.name, f.name))
    });
    let known: Vec<String> = settings()
        .map(Setting::path)
        .chain(fields)
        .chain(catalog.names().map(str::to_owned))
        .collect();
    did_you_mean(path, known.iter().map(String::as_str))
}

/// A value from the command line: TOML, or a number such as `.4`, or a bare word.
fn command_line_value(text: &str) -> Toml {
    let text = text.trim();
    text.parse().unwrap_or_else(|_| match text.parse::<f64>() {
        Ok(number) if number.is_finite() => number.into(),
        _ => text.into(),
    })
}

/// Reads a value from the command line. A text that looks like a number is still a text.
fn read_text(param: &Param, text: &str) -> Result<Value, String> {
    let mut toml = command_line_value(text);
    if matches!(param.value_type, ValueType::Text { .. }) && !toml.is_str() {
        toml = text.into();
    }
    toml_value::read(param, &toml, &|toml| number_text(toml, None))
}

/// Changes one value, as `--set path=value` does: `effects.` is optional, setting a parameter
/// enables its effect, and an effect or section with an empty value is enabled with defaults. A
/// parameter that was animated has this value at all times.
///
/// # Errors
/// An unknown path, or a value that a file could not have either; then nothing is changed.
pub fn set(preset_file: &mut PresetFile, path: &str, value: &str) -> Result<(), PresetError> {
    let at = Position {
        file: ARGUMENT.into(),
        line: None,
    };
    let wrong = |reason: String| PresetError::value(at.clone(), path, reason);
    if let Some((name, INSTANCE_KEY)) = path
        .strip_prefix("effects.")
        .unwrap_or(path)
        .split_once('.')
    {
        let effect = preset_file
            .effects
            .add_instance(name, value.trim().trim_matches('"'))
            .map_err(wrong)?;
        preset_file.preset.stack.enable(&effect);
        return Ok(());
    }
    let catalog = preset_file.effects.clone();
    let target = target(path, &catalog).map_err(wrong)?;
    let has_unknown_effect = |name: &str| preset_file.has_effect_table(name);
    let preset = &preset_file.preset;
    if let Target::Effect(effect)
    | Target::Field(effect, _)
    | Target::Scope(effect)
    | Target::Animation(Some(effect), _) = &target
        && let Some(conflict) = preset.stack.conflict_with(effect)
    {
        return Err(PresetError::value(at, "effects", conflict.to_string()));
    }
    // An empty text is a value.
    let is_missing = value.is_empty()
        && !matches!(&target, Target::Setting(setting) if matches!(setting.value_type, ValueType::Text { .. }));
    match target {
        Target::Effect(effect) if value.is_empty() => {
            preset_file.preset.stack.enable(&effect);
        }
        Target::Section(section) if value.is_empty() => section.add(&mut preset_file.preset),
        Target::Field(..) | Target::Setting(_) | Target::Stack | Target::Animation(_, Some(_))
            if is_missing =>
        {
            return Err(wrong(format!("needs a value, as in {path}=VALUE")));
        }
        Target::Effect(_) | Target::Section(_) => {
            return Err(wrong("takes no value; name one of its keys".into()));
        }
        Target::Field(effect, field) => {
            let value = read_text(&field, value).map_err(wrong)?;
            let preset = &mut preset_file.preset;
            let mut stack = preset.stack.clone();
            field
                .set_value(&mut stack.enable(&effect).words, &value)
                .map_err(|error| wrong(error.to_string()))?;
            preset.stack = stack;
            preset.animation.remove(&effect.name, &field.name);
        }
        Target::Scope(effect) => {
            let on = scope::read(&command_line_value(value), &effect).map_err(wrong)?;
            let limited = preset_file.preset.stack.limit(&effect, on);
            limited.map_err(|conflict| wrong(format!("cannot be set: {conflict}")))?;
        }
        Target::Animation(Some(effect), Some(field)) => {
            let mut reader = Reader::new(ARGUMENT, None, catalog.clone());
            let track = keyframes::read_track(
                &mut reader,
                None,
                &effect,
                &field,
                &Item::Value(command_line_value(value)),
            )?;
            preset_file.preset.stack.enable(&effect);
            preset_file.preset.animation.put(track);
        }
        Target::Animation(..) => {
            return Err(wrong(
                "takes no value; name a parameter, for instance animation.facet.amount".into(),
            ));
        }
        Target::Setting(setting) => {
            let value = read_text(setting, value).map_err(wrong)?;
            setting
                .set(&mut preset_file.preset, &value)
                .map_err(|error| wrong(error.to_string()))?;
        }
        Target::Stack => {
            let order = order::read(
                Some(&command_line_value(value)),
                &preset.stack,
                &catalog,
                &has_unknown_effect,
            )
            .map_err(wrong)?;
            preset_file.preset.stack = order;
        }
    }
    Ok(())
}

/// Puts one value back to its default, as `--unset path` does; an effect or optional section is
/// taken out, with its keyframes.
pub fn unset(preset_file: &mut PresetFile, path: &str) -> Result<(), PresetError> {
    let at = Position {
        file: "--unset".into(),
        line: None,
    };
    let preset = &mut preset_file.preset;
    match target(path, &preset_file.effects)
        .map_err(|reason| PresetError::value(at, path, reason))?
    {
        Target::Effect(effect) => preset.disable(&effect.name),
        Target::Animation(None, _) => preset.animation = Animation::default(),
        Target::Animation(Some(effect), None) => preset.animation.remove_effect(&effect.name),
        Target::Animation(Some(effect), Some(field)) => {
            preset.animation.remove(&effect.name, &field.name)
        }
        Target::Scope(effect) => {
            if let Some(enabled) = preset.stack.get_mut(&effect.name) {
                enabled.on = Scope::default();
            }
        }
        Target::Field(effect, field) => {
            preset.animation.remove(&effect.name, &field.name);
            if let Some(enabled) = preset.stack.get_mut(&effect.name) {
                field.copy(&effect.defaults, &mut enabled.words);
            }
        }
        Target::Setting(setting) => setting.reset(preset),
        Target::Section(section) => section.reset(preset),
        Target::Stack => preset.stack.0.sort_by_key(|enabled| enabled.effect.rank()),
    }
    Ok(())
}
