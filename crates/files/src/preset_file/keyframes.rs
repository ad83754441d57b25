//! Keyframes: `[animation.facet]` with one list per parameter, each entry `{ time_s = 1.5, value =
//! 0.25, easing = "linear" }`. An easing that is the default of its parameter is left out.

use std::sync::Arc;

use toml_edit::{Array, InlineTable, Item, Table, TableLike, Value as Toml};

use super::{
    error::{Position, PresetError},
    reader::Reader,
    toml_value,
};
use crate::{
    effect_files::Catalog,
    effects::Effect,
    params::{Field, Param, Value, ValueType},
    preset::{
        Animation, Preset,
        animation::{
            Easing, Keyframe, KeyframeError, MAX_KEYFRAMES, MAX_TIME_S, Track, default_easing,
        },
    },
};

/// The parameters of an entry: time, value and easing.
pub fn entry_params(field: &Field) -> [Param; 3] {
    [
        Param::new("time_s", "Time of the clock", ValueType::F64)
            .hard(-MAX_TIME_S..=MAX_TIME_S)
            .unit("s"),
        Param {
            name: "value".into(),
            doc: "The parameter's value at that time".into(),
            ..field.param.clone()
        },
        Param::new(
            "easing",
            "How the value goes to the next keyframe; whole numbers, flags and words always hold",
            ValueType::choice(&Easing::ALL.map(Easing::name)),
        ),
    ]
}

/// Reads `[animation]`.
pub fn read(
    reader: &mut Reader<'_>,
    effects: &dyn TableLike,
    preset: &mut Preset,
) -> Result<(), PresetError> {
    for (name, _) in effects.iter() {
        let Some(table) = reader.table(effects, "animation.", name)? else {
            continue;
        };
        let Some(effect) = reader.effect(effects, "animation.", name)? else {
            reader.unknown_effect(effects, "animation.", name);
            continue;
        };
        if preset.stack.get(name).is_none() {
            let warning = |reader: &Reader<'_>| {
                format!(
                    "{}: animation.{name} moves nothing; add [effects.{name}]",
                    reader.position(effects, name)
                )
            };
            reader.warn(warning);
        }
        for (name, item) in table.iter() {
            match effect.field(name) {
                Some(field) => {
                    preset
                        .animation
                        .put(read_track(reader, Some(table), &effect, field, item)?)
                }
                None => {
                    let prefix = format!("animation.{}.", effect.name);
                    reader.unknown(
                        table,
                        &prefix,
                        name,
                        effect.fields.iter().map(|field| field.name.as_str()),
                    );
                }
            }
        }
    }
    Ok(())
}

/// Reads the keyframes of one parameter. `table` holds the list in a file.
pub fn read_track(
    reader: &mut Reader<'_>,
    table: Option<&dyn TableLike>,
    effect: &Arc<Effect>,
    field: &Arc<Field>,
    item: &Item,
) -> Result<Track, PresetError> {
    let path = format!("animation.{}.{}", effect.name, field.name);
    let here = |reader: &Reader<'_>| match table {
        Some(table) => reader.position(table, &field.name),
        None => Position {
            file: reader.file.into(),
            line: None,
        },
    };
    let wrong = |at: Position, reason: String| PresetError::value(at, path.clone(), reason);
    let entries = entries(item).filter(|entries| (1..=MAX_KEYFRAMES).contains(&entries.len())).ok_or_else(|| {
        let reason = format!("must be a list of 1 to {MAX_KEYFRAMES} keyframes such as {{ time_s = 0.0, value = … }}");
        wrong(here(reader), reason)
    })?;
    let mut track: Option<Track> = None;
    for (index, entry) in entries.into_iter().enumerate() {
        let number = index + 1;
        let keyframe = read_keyframe(reader, entry, field, &format!("{path} keyframe {number}: "))?;
        let time_s = keyframe.time_s;
        let added = match &mut track {
            None => Track::new(effect, field, vec![keyframe]).map(|first| track = Some(first)),
            Some(track) if track.at(time_s).is_some() => Err(KeyframeError::Taken(time_s)),
            Some(track) => track.set(keyframe),
        };
        added.map_err(|error| {
            wrong(
                entry_position(reader, entry),
                format!("keyframe {number}: {error}"),
            )
        })?;
    }
    Ok(track.expect("the list has an entry"))
}

fn read_keyframe(
    reader: &mut Reader<'_>,
    entry: &dyn TableLike,
    field: &Field,
    prefix: &str,
) -> Result<Keyframe, PresetError> {
    let params = entry_params(field);
    let mut values: [Option<Value>; 3] = [None, None, None];
    for (name, item) in entry.iter() {
        match params.iter().position(|param| param.name == name) {
            Some(index) => {
                values[index] = Some(reader.value(entry, prefix, &params[index], item)?)
            }
            None => reader.unknown(
                entry,
                prefix,
                name,
                params.iter().map(|param| param.name.as_str()),
            ),
        }
    }
    let [Some(time), Some(value), easing] = values else {
        return Err(PresetError::value(
            entry_position(reader, entry),
            prefix.trim_end_matches(": "),
            "must have time_s and value",
        ));
    };
    let easing = match easing {
        Some(Value::Choice(index)) => Easing::ALL[index],
        _ => default_easing(field),
    };
    Ok(Keyframe {
        time_s: time.components()[0],
        value: value.components(),
        easing,
    })
}

/// Where an entry begins: at its first key that has a line.
fn entry_position(reader: &Reader<'_>, entry: &dyn TableLike) -> Position {
    let positions = entry.iter().map(|(name, _)| reader.position(entry, name));
    positions
        .into_iter()
        .find(|position| position.line.is_some())
        .unwrap_or_else(|| reader.position(entry, ""))
}

/// The entries of a list of tables, in either form that TOML has for it.
fn entries(item: &Item) -> Option<Vec<&dyn TableLike>> {
    if let Some(tables) = item.as_array_of_tables() {
        return Some(tables.iter().map(|table| table as &dyn TableLike).collect());
    }
    item.as_array()?
        .iter()
        .map(|value| value.as_inline_table().map(|table| table as &dyn TableLike))
        .collect()
}

/// Patches `root`, whose animation describes `saved`, so that it describes `now`. An unchanged
/// track keeps its text.
pub fn patch(root: &mut Table, catalog: &Catalog, saved: &Animation, now: &Animation) {
    if saved == now {
        return;
    }
    if root.get("animation").is_none() {
        root.insert("animation", Item::Table(implicit()));
    }
    let tables = root
        .get_mut("animation")
        .and_then(Item::as_table_like_mut)
        .expect("the animation was read as a table");
    for effect in catalog.effects_with(
        [saved, now]
            .into_iter()
            .flat_map(|animation| animation.tracks().iter().map(Track::effect)),
    ) {
        for field in &effect.fields {
            let [before, after] =
                [saved, now].map(|animation| animation.get(&effect.name, &field.name));
            match after {
                _ if before == after => {}
                Some(track) => patch_track(tables, track),
                None => {
                    if let Some(table) = tables
                        .get_mut(&effect.name)
                        .and_then(Item::as_table_like_mut)
                    {
                        table.remove(&field.name);
                        if table.is_empty() {
                            tables.remove(&effect.name);
                        }
                    }
                }
            }
        }
    }
    if tables.is_empty() {
        root.remove("animation");
    }
}

fn implicit() -> Table {
    let mut table = Table::new();
    table.set_implicit(true);
    table
}

fn patch_track(tables: &mut dyn TableLike, track: &Track) {
    let (effect, field) = (&track.effect().name, &track.field().name);
    if tables.get(effect).is_none() {
        tables.insert(effect, Item::Table(Table::new()));
    }
    let table = tables
        .get_mut(effect)
        .and_then(Item::as_table_like_mut)
        .expect("an effect's animation was read as a table");
    let list = to_toml(track, table.get(field));
    match table.get_mut(field).and_then(Item::as_value_mut) {
        Some(there) => {
            let decor = there.decor().clone();
            *there = Toml::Array(list);
            *there.decor_mut() = decor;
        }
        None => drop(table.insert(field, Item::Value(Toml::Array(list)))),
    }
}

/// The list, one keyframe per line. An entry of `before` at the same time keeps its comments and
/// unknown keys.
fn to_toml(track: &Track, before: Option<&Item>) -> Array {
    let mut list = Array::new();
    for key in track.keys() {
        let [time, value, easing] = entry_params(track.field());
        let old = before
            .and_then(Item::as_array)
            .into_iter()
            .flatten()
            .find(|entry| time_of(entry) == Some(key.time_s));
        let mut entry = old
            .and_then(Toml::as_inline_table)
            .cloned()
            .unwrap_or_default();
        write_value(&mut entry, &time, &Value::number(key.time_s));
        write_value(
            &mut entry,
            &value,
            &track
                .field()
                .value_type
                .value(&key.value)
                .expect("keyframes hold no texts"),
        );
        if key.easing == default_easing(track.field()) {
            entry.remove(&easing.name);
        } else {
            write_value(&mut entry, &easing, &Value::Choice(key.easing as usize));
        }
        if old.is_none() {
            entry.decor_mut().set_prefix("\n    ");
        }
        list.push_formatted(Toml::InlineTable(entry));
    }
    let old = before.and_then(Item::as_array);
    match old {
        Some(old) => {
            list.set_trailing(old.trailing().clone());
            list.set_trailing_comma(old.trailing_comma());
        }
        None => {
            list.set_trailing("\n");
            list.set_trailing_comma(true);
        }
    }
    list
}

fn time_of(entry: &Toml) -> Option<f64> {
    number(entry.as_inline_table()?.get("time_s")?)
}

fn number(value: &Toml) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Sets a value; one that is already there keeps its spelling.
fn write_value(entry: &mut InlineTable, param: &Param, value: &Value) {
    let (name, mut value) = (&param.name, toml_value::write(&param.value_type, value));
    match entry.get_mut(name) {
        Some(there) if same(there, &value) => {}
        Some(there) => {
            *value.decor_mut() = there.decor().clone();
            *there = value;
        }
        None => drop(entry.insert(name, value)),
    }
}

/// Do both have the same value, to the bit, in any spelling?
fn same(a: &Toml, b: &Toml) -> bool {
    match (number(a), number(b)) {
        (Some(a), Some(b)) => a.to_bits() == b.to_bits(),
        _ => match (a.as_array(), b.as_array()) {
            (Some(a), Some(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
            _ => a.to_string().trim() == b.to_string().trim(),
        },
    }
}
