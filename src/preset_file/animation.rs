//! Keys over time, as presets say them: `[animation.facet]` with one list per parameter, each entry
//! `{ time_s = 1.5, value = 0.25, easing = "linear" }`. An easing that is usual for its parameter is left out.

use toml_edit::{Array, InlineTable, Item, Table, TableLike, Value as TomlValue};

use super::{
    error::{Place, PresetError},
    form::{Value, ValueType},
    read::Reader,
};
use crate::{
    effects::{EFFECTS, Effect},
    params::Field,
    preset::{
        Animation, Preset,
        animation::{Easing, Keyframe, MAX_KEYFRAMES, MAX_TIME_S, Track, default_easing},
    },
};

const EASINGS: &[&str] =
    &[Easing::ALL[0].name(), Easing::ALL[1].name(), Easing::ALL[2].name(), Easing::ALL[3].name(), Easing::ALL[4].name()];
const TIME: ValueType = ValueType::number(-MAX_TIME_S, MAX_TIME_S);

/// The keys of an entry with their forms and words for editors.
pub fn entry_forms(field: &Field) -> [(&'static str, ValueType, &'static str); 3] {
    [
        ("time_s", TIME, "When, in seconds of the clock"),
        ("value", ValueType::of(field), "The parameter's value at that time"),
        ("easing", ValueType::Word(EASINGS), "The way to the next key; whole numbers, flags and words always hold"),
    ]
}

impl Reader<'_> {
    /// Reads `[animation]`.
    pub(super) fn animation(&mut self, effects: &dyn TableLike, preset: &mut Preset) -> Result<(), PresetError> {
        for (name, _) in effects.iter() {
            let table = self.table(effects, "animation.", name)?.expect("iterating shows keys that are there");
            let Some(effect) = Effect::find(name) else {
                self.unknown(effects, "animation.", name, EFFECTS.iter().map(|effect| effect.name));
                continue;
            };
            if preset.stack.get(name).is_none() {
                let at = self.at(effects, name);
                self.warnings.push(format!("{at}: animation.{name} moves nothing; add [effects.{name}]"));
            }
            for (name, item) in table.iter() {
                match effect.field(name) {
                    Some(field) => preset.animation.put(self.track(table, effect, field, item)?),
                    None => {
                        let prefix = format!("animation.{}.", effect.name);
                        self.unknown(table, &prefix, name, effect.fields.iter().map(|field| field.name));
                    }
                }
            }
        }
        Ok(())
    }

    fn track(&mut self, table: &dyn TableLike, effect: &'static Effect, field: &'static Field, item: &Item) -> Result<Track, PresetError> {
        let path = format!("animation.{}.{}", effect.name, field.name);
        let wrong = |at: Place, reason: String| PresetError::value(at, path.clone(), reason);
        let entries = entries(item).filter(|entries| (1..=MAX_KEYFRAMES).contains(&entries.len())).ok_or_else(|| {
            let reason = format!("must be a list of 1 to {MAX_KEYFRAMES} keys such as {{ time_s = 0.0, value = … }}");
            wrong(self.at(table, field.name), reason)
        })?;
        let mut track: Option<Track> = None;
        for (index, entry) in entries.into_iter().enumerate() {
            let key = self.keyframe(entry, field, &format!("{path} key {}: ", index + 1))?;
            let time_s = key.time_s;
            let added = match &mut track {
                None => Track::new(effect, field, vec![key]).map(|first| track = Some(first)),
                Some(track) if track.at(time_s).is_some() => Err(crate::preset::animation::KeyframeError::Taken(time_s)),
                Some(track) => track.set(key),
            };
            added.map_err(|error| wrong(self.entry_place(entry), format!("key {}: {error}", index + 1)))?;
        }
        Ok(track.expect("a list of at least one key was read"))
    }

    fn keyframe(&mut self, entry: &dyn TableLike, field: &Field, prefix: &str) -> Result<Keyframe, PresetError> {
        let forms = entry_forms(field);
        let mut read: [Option<Value>; 3] = [None, None, None];
        for (name, item) in entry.iter() {
            match forms.iter().position(|(known, ..)| *known == name) {
                Some(place) => read[place] = Some(self.value(entry, prefix, name, item, &forms[place].1)?),
                None => self.unknown(entry, prefix, name, forms.iter().map(|(name, ..)| *name)),
            }
        }
        let [time, value, easing] = read;
        let (Some(time), Some(Value::Numbers(value))) = (time, value) else {
            return Err(PresetError::value(self.entry_place(entry), prefix.trim_end_matches(": "), "must have time_s and value"));
        };
        let easing = easing.map_or(default_easing(field), |word| Easing::ALL[word.first() as usize]);
        Ok(Keyframe { time_s: time.first(), value, easing })
    }

    /// Where an entry begins: at its first key that has a place.
    fn entry_place(&self, entry: &dyn TableLike) -> Place {
        let places = entry.iter().map(|(name, _)| self.at(entry, name));
        places.into_iter().find(|place| place.line.is_some()).unwrap_or_else(|| self.at(entry, ""))
    }
}

/// The entries of a list of tables, whichever way TOML says it.
fn entries(item: &Item) -> Option<Vec<&dyn TableLike>> {
    if let Some(tables) = item.as_array_of_tables() {
        return Some(tables.iter().map(|table| table as &dyn TableLike).collect());
    }
    item.as_array()?.iter().map(|value| value.as_inline_table().map(|table| table as &dyn TableLike)).collect()
}

/// MeshletBuffers `root`, whose animation says `saved`, so that it says `now`. A track that is the same keeps its text.
pub fn patch(root: &mut Table, saved: &Animation, now: &Animation) {
    if saved == now {
        return;
    }
    if root.get("animation").is_none() {
        root.insert("animation", Item::Table(implicit()));
    }
    let tables = root.get_mut("animation").and_then(Item::as_table_like_mut).expect("the animation was read as a table");
    for effect in EFFECTS {
        for field in effect.fields {
            let [before, after] = [saved, now].map(|animation| animation.get(effect.name, field.name));
            match after {
                _ if before == after => {}
                Some(track) => patch_track(tables, track),
                None => {
                    if let Some(table) = tables.get_mut(effect.name).and_then(Item::as_table_like_mut) {
                        table.remove(field.name);
                        if table.is_empty() {
                            tables.remove(effect.name);
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
    let (effect, field) = (track.effect().name, track.field().name);
    if tables.get(effect).is_none() {
        tables.insert(effect, Item::Table(Table::new()));
    }
    let table = tables.get_mut(effect).and_then(Item::as_table_like_mut).expect("an effect's animation was read as a table");
    let list = written(track, table.get(field));
    match table.get_mut(field).and_then(Item::as_value_mut) {
        Some(there) => {
            let decor = there.decor().clone();
            *there = TomlValue::Array(list);
            *there.decor_mut() = decor;
        }
        None => drop(table.insert(field, Item::Value(TomlValue::Array(list)))),
    }
}

/// The list, one key a line. An entry of `before` at the same time keeps its comments and whatever we do not know.
fn written(track: &Track, before: Option<&Item>) -> Array {
    let mut list = Array::new();
    for key in track.keys() {
        let [(time, time_form, _), (value, value_form, _), (easing, easing_form, _)] = entry_forms(track.field());
        let old = before.and_then(Item::as_array).into_iter().flatten().find(|entry| time_of(entry) == Some(key.time_s));
        let mut entry = old.and_then(TomlValue::as_inline_table).cloned().unwrap_or_default();
        put(&mut entry, time, time_form.write(&Value::number(key.time_s)));
        put(&mut entry, value, value_form.write(&Value::Numbers(key.value.clone())));
        if key.easing == default_easing(track.field()) {
            entry.remove(easing);
        } else {
            put(&mut entry, easing, easing_form.write(&Value::number(key.easing as u32)));
        }
        if old.is_none() {
            entry.decor_mut().set_prefix("\n    ");
        }
        list.push_formatted(TomlValue::InlineTable(entry));
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

fn time_of(entry: &TomlValue) -> Option<f64> {
    number(entry.as_inline_table()?.get("time_s")?)
}

fn number(value: &TomlValue) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Sets a value unless it is written so already, and so keeps how a person wrote it.
fn put(entry: &mut InlineTable, name: &str, mut value: TomlValue) {
    match entry.get_mut(name) {
        Some(there) if same(there, &value) => {}
        Some(there) => {
            *value.decor_mut() = there.decor().clone();
            *there = value;
        }
        None => drop(entry.insert(name, value)),
    }
}

/// Do both mean the same, to the bit, however it is written?
fn same(a: &TomlValue, b: &TomlValue) -> bool {
    match (number(a), number(b)) {
        (Some(a), Some(b)) => a.to_bits() == b.to_bits(),
        _ => match (a.as_array(), b.as_array()) {
            (Some(a), Some(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
            _ => a.to_string().trim() == b.to_string().trim(),
        },
    }
}
