//! Reading one table of a preset file: its values, and the lines of its errors.

use std::sync::Arc;

use toml_edit::{Item, TableLike, Value as Toml};

use super::{
    error::{Position, PresetError},
    toml_value,
};
use crate::{
    effect_files::Catalog,
    effects::Effect,
    params::{Param, Value, did_you_mean, legible_line},
};

/// In an effect's table: the effect that it is an instance of.
pub const INSTANCE_KEY: &str = "effect";

/// Most warnings about a file that are built; each looks for its line and for a similar name.
const MAX_WARNINGS: usize = 32;

/// What every part of the reader shares.
pub struct Reader<'a> {
    /// What errors call the file.
    pub file: &'a str,
    /// The text that spans point into; none for a value that did not come from a file.
    pub text: Option<&'a str>,
    /// The effects that may be named.
    pub catalog: Catalog,
    pub warnings: Vec<String>,
    /// Warnings beyond the first [`MAX_WARNINGS`].
    unnamed: usize,
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a str, text: Option<&'a str>, catalog: Catalog) -> Self {
        Self {
            file,
            text,
            catalog,
            warnings: Vec::new(),
            unnamed: 0,
        }
    }

    /// Adds a warning while there is room for it.
    pub fn warn(&mut self, warning: impl FnOnce(&Self) -> String) {
        if self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(legible_line(&warning(self)));
        } else {
            self.unnamed += 1;
        }
    }

    /// The warnings, and how many more there would be.
    pub fn all_warnings(self) -> Vec<String> {
        let more = (self.unnamed > 0)
            .then(|| format!("{}: {} more warnings of this kind", self.file, self.unnamed));
        self.warnings.into_iter().chain(more).collect()
    }

    /// Where the key `name` stands, or the table itself when it has no such key.
    pub fn position(&self, table: &dyn TableLike, name: &str) -> Position {
        match self.text {
            Some(text) => position(table, name, self.file, text),
            None => Position {
                file: self.file.into(),
                line: None,
            },
        }
    }

    /// The table called `name`, if it is there.
    pub fn table<'t>(
        &self,
        parent: &'t dyn TableLike,
        prefix: &str,
        name: &str,
    ) -> Result<Option<&'t dyn TableLike>, PresetError> {
        let Some(item) = parent.get(name) else {
            return Ok(None);
        };
        let path = format!("{prefix}{name}");
        let reason = format!("must be a table, written [{path}]");
        item.as_table_like()
            .map(Some)
            .ok_or_else(|| PresetError::value(self.position(parent, name), path, reason))
    }

    /// The effect called `name`, which is a key of `table`; none if it is unknown. Its own table
    /// may say which effect it is an instance of.
    pub fn effect(
        &mut self,
        table: &dyn TableLike,
        prefix: &str,
        name: &str,
    ) -> Result<Option<Arc<Effect>>, PresetError> {
        let base = table
            .get(name)
            .and_then(Item::as_table_like)
            .and_then(|own| own.get(INSTANCE_KEY));
        if let Some(base) = base {
            let Some(base) = base.as_str() else {
                return Err(self.error(
                    table,
                    prefix,
                    name,
                    "must name an effect as text in the key effect",
                ));
            };
            let added = self.catalog.add_instance(name, base);
            return added
                .map(Some)
                .map_err(|reason| self.error(table, prefix, name, reason));
        }
        self.catalog
            .find(name)
            .map(Option::<&_>::cloned)
            .map_err(|error| self.error(table, prefix, name, format!("cannot be used: {error}")))
    }

    /// The value of `param`, which stands in `table` as `item`; its type is right, its range is not
    /// checked.
    pub fn value(
        &self,
        table: &dyn TableLike,
        prefix: &str,
        param: &Param,
        item: &Item,
    ) -> Result<Value, PresetError> {
        let read = match item.as_value() {
            Some(toml) => toml_value::read(param, toml, &|toml| number_text(toml, self.text)),
            None => Err("must be a value, not a table".into()),
        };
        read.map_err(|reason| self.error(table, prefix, &param.name, reason))
    }

    /// The error of the key `name` in `table`.
    pub fn error(
        &self,
        table: &dyn TableLike,
        prefix: &str,
        name: &str,
        reason: impl ToString,
    ) -> PresetError {
        PresetError::value(
            self.position(table, name),
            format!("{prefix}{name}"),
            reason.to_string(),
        )
    }

    /// Warns of an effect that is not in the catalog.
    pub fn unknown_effect(&mut self, table: &dyn TableLike, prefix: &str, name: &str) {
        self.warn(|reader| unknown(reader, table, prefix, name, reader.catalog.names()));
    }

    /// Warns of a key that is not one of `known`.
    pub fn unknown<'k>(
        &mut self,
        table: &dyn TableLike,
        prefix: &str,
        name: &str,
        known: impl Iterator<Item = &'k str>,
    ) {
        self.warn(|reader| unknown(reader, table, prefix, name, known));
    }
}

fn unknown<'k>(
    reader: &Reader<'_>,
    table: &dyn TableLike,
    prefix: &str,
    name: &str,
    known: impl Iterator<Item = &'k str>,
) -> String {
    let (at, hint) = (reader.position(table, name), did_you_mean(name, known));
    format!("{at}: unknown key {prefix}{}{hint}", shortened(name))
}

/// A name from a file, at most 60 characters of it.
fn shortened(name: &str) -> String {
    match name.char_indices().nth(60) {
        Some((at, _)) => format!("{}…", &name[..at]),
        None => name.to_owned(),
    }
}

/// Where the key `name` of `table` stands in `text`, or the table itself when it has no such key.
pub fn position(table: &dyn TableLike, name: &str, file: &str, text: &str) -> Position {
    let span = table
        .get_key_value(name)
        .and_then(|(key, item)| key.span().or_else(|| item.span()));
    Position {
        file: file.into(),
        line: span.map(|span| line_of(text, span.start)),
    }
}

/// The line of a byte, counted from 1.
pub fn line_of(text: &str, byte: usize) -> usize {
    1 + text.as_bytes()[..byte.min(text.len())]
        .iter()
        .filter(|&&b| b == b'\n')
        .count()
}

/// A number as it stands in the file.
pub fn number_text(toml: &Toml, text: Option<&str>) -> String {
    let repr = match toml {
        Toml::Float(float) => float.as_repr(),
        Toml::Integer(integer) => integer.as_repr(),
        _ => None,
    };
    let raw = repr.map(|repr| repr.as_raw());
    let written = raw
        .and_then(|raw| raw.as_str())
        .or_else(|| text?.get(raw?.span()?));
    written.map_or_else(|| toml.to_string().trim().to_owned(), str::to_owned)
}
