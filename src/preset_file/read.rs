//! Reading: TOML to [`Preset`]. Unknown keys warn; everything else that is wrong is an error with its line.

use toml_edit::{Document, Item, TableLike, Value as TomlValue};

use super::{
    error::{Place, PresetError},
    form::{ValueType, did_you_mean},
    keys::{KEYS, Key, SECTIONS, Section},
    migrate,
};
use crate::{
    effects::{Conflict, EFFECTS, Effect, EnabledEffect, Stack},
    preset::{Preset, Test},
};

/// Longest look that is read, bytes.
pub const MAX_BYTES: usize = 1 << 20;

/// A session with what the reader wants to say about its text.
pub struct Reading {
    pub preset: Preset,
    pub warnings: Vec<String>,
    /// Written by a newer program.
    pub is_newer: bool,
}

/// Parses TOML, with the line of a syntax error.
pub fn document(text: &str, file: &str) -> Result<Document<String>, PresetError> {
    let at = |line| Place { file: file.into(), line };
    if text.len() > MAX_BYTES {
        return Err(PresetError::Syntax { at: at(None), reason: format!("is longer than {MAX_BYTES} bytes") });
    }
    Document::parse(text.to_owned()).map_err(|error| {
        let line = error.span().map(|span| line_of(text, span.start));
        PresetError::Syntax { at: at(line), reason: error.message().trim().replace('\n', ", ") }
    })
}

/// Reads a whole preset.
pub fn read(document: &Document<String>, file: &str) -> Result<Reading, PresetError> {
    let mut reader = Reader { file, text: Some(document.raw()), warnings: Vec::new() };
    let schema = reader.schema(document.as_table())?;
    if schema < migrate::CURRENT {
        let migrated = migrate::migrate(document.clone().into_mut(), schema);
        reader.text = None;
        let preset = reader.preset(migrated.as_table())?;
        return Ok(Reading { preset, warnings: reader.warnings, is_newer: false });
    }
    let preset = reader.preset(document.as_table())?;
    Ok(Reading { preset, warnings: reader.warnings, is_newer: schema > migrate::CURRENT })
}

/// Reads one value that did not come from a file.
pub fn read_value(form: &ValueType, value: &TomlValue) -> Result<super::form::Value, String> {
    form.read(value, &|value| raw(value, None))
}

fn line_of(text: &str, byte: usize) -> usize {
    1 + text.as_bytes()[..byte.min(text.len())].iter().filter(|&&b| b == b'\n').count()
}

/// A number as it was written.
fn raw(value: &TomlValue, text: Option<&str>) -> String {
    let repr = match value {
        TomlValue::Float(float) => float.as_repr(),
        TomlValue::Integer(integer) => integer.as_repr(),
        _ => None,
    };
    let raw = repr.map(|repr| repr.as_raw());
    let written = raw.and_then(|raw| raw.as_str()).or_else(|| text?.get(raw?.span()?));
    written.map_or_else(|| value.to_string().trim().to_owned(), str::to_owned)
}

pub(super) struct Reader<'a> {
    file: &'a str,
    /// What spans point into; none after a migration.
    text: Option<&'a str>,
    pub(super) warnings: Vec<String>,
}

impl Reader<'_> {
    /// Where the key `name` stands, or the table itself when it has no such key.
    pub(super) fn at(&self, table: &dyn TableLike, name: &str) -> Place {
        let span = table.get_key_value(name).and_then(|(key, item)| key.span().or_else(|| item.span()));
        let line = self.text.zip(span).map(|(text, span)| line_of(text, span.start));
        Place { file: self.file.into(), line }
    }

    fn schema(&mut self, root: &dyn TableLike) -> Result<i64, PresetError> {
        let Some(item) = root.get("schema") else {
            self.warnings.push(format!("{}: schema is missing; write schema = {} on the first line", self.file, migrate::CURRENT));
            return Ok(migrate::CURRENT);
        };
        match item.as_integer() {
            Some(schema) if schema >= 1 => {
                if schema > migrate::CURRENT {
                    let at = self.at(root, "schema");
                    let newest = migrate::CURRENT;
                    self.warnings
                        .push(format!("{at}: schema {schema} is newer than {newest}, the newest this program knows; opened read-only"));
                }
                Ok(schema)
            }
            _ => Err(PresetError::value(self.at(root, "schema"), "schema", "must be a whole number from 1 up")),
        }
    }

    fn preset(&mut self, root: &dyn TableLike) -> Result<Preset, PresetError> {
        let mut preset = Preset::default();
        self.keys(root, "", &mut preset)?;
        for section in SECTIONS {
            if let Some(table) = self.table(root, "", section.name)? {
                section.enter(&mut preset);
                self.keys(table, section.name, &mut preset)?;
            }
        }
        if let Some(effects) = self.table(root, "", "effects")? {
            self.effects(effects, &mut preset.stack)?;
            let conflict = |conflict: Conflict| PresetError::value(self.at(effects, conflict.second), "effects", conflict.to_string());
            preset.stack.check().map_err(conflict)?;
        }
        if let Some(effects) = self.table(root, "", "animation")? {
            self.animation(effects, &mut preset)?;
        }
        self.order(root, &mut preset.stack)?;
        self.budget(root, &preset)?;
        Ok(preset)
    }

    /// The table called `name`, if it is there.
    pub(super) fn table<'t>(&self, parent: &'t dyn TableLike, prefix: &str, name: &str) -> Result<Option<&'t dyn TableLike>, PresetError> {
        let Some(item) = parent.get(name) else { return Ok(None) };
        let path = format!("{prefix}{name}");
        let reason = format!("must be a table, written [{path}]");
        item.as_table_like().map(Some).ok_or_else(|| PresetError::value(self.at(parent, name), path, reason))
    }

    /// Reads every key of one section; at the top, tables are left to others.
    fn keys(&mut self, table: &dyn TableLike, section: &str, preset: &mut Preset) -> Result<(), PresetError> {
        let prefix = if section.is_empty() { String::new() } else { format!("{section}.") };
        for (name, item) in table.iter() {
            let Some(key) = Key::within(section, name) else {
                if !(section.is_empty() && (matches!(name, "schema" | "stack" | "effects" | "animation") || Section::find(name).is_some()))
                {
                    let known = KEYS.iter().filter(|key| key.section == section).map(|key| key.name);
                    let tables = SECTIONS.iter().map(|s| s.name).chain(["stack", "effects", "animation"]).filter(|_| section.is_empty());
                    self.unknown(table, &prefix, name, known.chain(tables));
                }
                continue;
            };
            if let Some(rival) = key.rival.filter(|rival| table.contains_key(rival)) {
                let reason = format!("and {prefix}{rival} exclude each other");
                return Err(PresetError::value(self.at(table, name), key.path(), reason));
            }
            let plain = self.value(table, &prefix, name, item, &key.form)?;
            key.check(&plain).map_err(|reason| PresetError::value(self.at(table, name), key.path(), reason))?;
            if key.name == "path" && plain.clone().into_text().contains("://") {
                return Err(PresetError::value(self.at(table, name), key.path(), "must be a file, not an address"));
            }
            (key.set)(preset, plain);
        }
        Ok(())
    }

    pub(super) fn value(
        &self,
        table: &dyn TableLike,
        prefix: &str,
        name: &str,
        item: &Item,
        form: &ValueType,
    ) -> Result<super::form::Value, PresetError> {
        let read = match item.as_value() {
            Some(value) => form.read(value, &|value| raw(value, self.text)),
            None => Err("must be a value, not a table".into()),
        };
        read.map_err(|reason| PresetError::value(self.at(table, name), format!("{prefix}{name}"), reason))
    }

    pub(super) fn unknown<'k>(&mut self, table: &dyn TableLike, prefix: &str, name: &str, known: impl Iterator<Item = &'k str>) {
        let hint = did_you_mean(name, known);
        self.warnings.push(format!("{}: unknown key {prefix}{name}{hint}", self.at(table, name)));
    }

    fn effects(&mut self, effects: &dyn TableLike, stack: &mut Stack) -> Result<(), PresetError> {
        for (name, _) in effects.iter() {
            let table = self.table(effects, "effects.", name)?.expect("iterating shows keys that are there");
            match Effect::find(name) {
                Some(effect) => self.effect(table, stack.enable(effect))?,
                None => self.unknown(effects, "effects.", name, EFFECTS.iter().map(|effect| effect.name)),
            }
        }
        Ok(())
    }

    fn effect(&mut self, table: &dyn TableLike, enabled: &mut EnabledEffect) -> Result<(), PresetError> {
        let prefix = format!("effects.{}.", enabled.effect.name);
        for (name, item) in table.iter() {
            let Some(field) = enabled.effect.field(name) else {
                self.unknown(table, &prefix, name, enabled.effect.fields.iter().map(|field| field.name));
                continue;
            };
            let plain = self.value(table, &prefix, name, item, &ValueType::of(field))?;
            super::put(field, &mut enabled.words, &plain)
                .map_err(|reason| PresetError::value(self.at(table, name), format!("{prefix}{name}"), reason))?;
        }
        Ok(())
    }

    /// Puts the stack into the order of the `stack` key, which names every enabled effect exactly once.
    fn order(&self, root: &dyn TableLike, stack: &mut Stack) -> Result<(), PresetError> {
        let Some(item) = root.get("stack") else { return Ok(()) };
        let wrong = |reason: String| Err(PresetError::value(self.at(root, "stack"), "stack", reason));
        let names: Option<Vec<&str>> = item.as_array().and_then(|list| list.iter().map(TomlValue::as_str).collect());
        let Some(names) = names else { return wrong("must be a list of effect names".into()) };
        let has_table = |name: &str| root.get("effects").and_then(|effects| effects.get(name)).is_some();
        let mut ordered = Vec::new();
        for (place, name) in names.iter().enumerate() {
            if names[..place].contains(name) {
                return wrong(format!("names {name} twice"));
            }
            match stack.get(name) {
                Some(enabled) => ordered.push(enabled.clone()),
                // An effect of a newer program: already warned about, and its place is kept in the file.
                None if Effect::find(name).is_none() && has_table(name) => {}
                None if Effect::find(name).is_some() => return wrong(format!("names {name}, which is not enabled; add [effects.{name}]")),
                None => {
                    let hint = did_you_mean(name, EFFECTS.iter().map(|effect| effect.name));
                    return wrong(format!("names {name:?}, which is no effect{hint}"));
                }
            }
        }
        if let Some(missing) = stack.0.iter().find(|enabled| !names.contains(&enabled.effect.name)) {
            return wrong(format!("leaves out {}, which is enabled", missing.effect.name));
        }
        stack.0 = ordered;
        Ok(())
    }

    /// A budget above the default says why, and wrong triangle ids are for presets that ask for less than exactness.
    fn budget(&self, root: &dyn TableLike, preset: &Preset) -> Result<(), PresetError> {
        let (Some(test), default) = (&preset.test, Test::default()) else { return Ok(()) };
        if test.max_wrong_triangles > 0 && !preset.accuracy.may_err() {
            let why = "is for presets that pin a cheaper option or take the tier draft or fast; this one must be exact";
            return Err(PresetError::value(self.at(root, "test"), "test.max_wrong_triangles", why));
        }
        let is_wider = test.max_channel > default.max_channel || test.max_pixels > default.max_pixels || test.max_wrong_triangles > 0;
        if is_wider && test.why.trim().is_empty() {
            return Err(PresetError::value(self.at(root, "test"), "test.why", "must say why the budget is above the default"));
        }
        Ok(())
    }
}
