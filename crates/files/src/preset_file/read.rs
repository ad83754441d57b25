//! Reading: TOML of the current schema to a [`Preset`]. Unknown keys warn; everything else that is
//! wrong is an error with its line.

use toml_edit::{Document, TableLike};

use super::{
    bookmarks,
    error::PresetError,
    file::EFFECT_FILES,
    keyframes, order,
    reader::{INSTANCE_KEY, Reader},
    scope::{self, SCOPE_KEY},
};
use crate::{
    effect_files::Catalog,
    effects::{Conflict, EnabledEffect, Stack},
    preset::{
        Preset,
        settings::{BOOKMARKS, OUTPUT, SECTIONS, Section},
    },
};

/// Keys at the top of a file that are no settings, with the tables that are no sections.
pub const OTHER_KEYS: [&str; 6] = [
    "schema",
    "stack",
    BOOKMARKS,
    "effects",
    EFFECT_FILES,
    "animation",
];
/// Most effects that a preset may bring.
const MAX_BROUGHT: usize = 16;

/// A preset with the warnings about its text.
pub struct ReadPreset {
    pub preset: Preset,
    pub warnings: Vec<String>,
    /// Names of the effects whose text it holds.
    pub brought_effects: Vec<String>,
    /// The effects that it may use, with the instances that it declares.
    pub catalog: Catalog,
}

/// Reads a whole preset that may use the effects of `catalog`; `file` is what errors and warnings
/// call it.
pub fn read(
    document: &Document<String>,
    file: &str,
    catalog: &Catalog,
) -> Result<ReadPreset, PresetError> {
    let mut reader = Reader::new(file, Some(document.raw()), catalog.clone());
    let (root, mut preset) = (document.as_table(), Preset::default());
    for section in SECTIONS {
        let table = if section.name.is_empty() {
            Some(root as &dyn TableLike)
        } else {
            reader.table(root, "", section.name)?
        };
        if let Some(table) = table {
            section.add(&mut preset);
            let prefix = match section.name {
                "" => String::new(),
                name => format!("{name}."),
            };
            read_section(&mut reader, table, section, &prefix, &mut preset)?;
            if std::ptr::eq(*section, &OUTPUT) && table.get("reference_height_px").is_none() {
                preset.output.reference_height_px = None;
            }
        }
    }
    if let Some(table) = reader.table(root, "", BOOKMARKS)? {
        bookmarks::read(&mut reader, table, &mut preset)?;
    }
    let brought_effects = match reader.table(root, "", EFFECT_FILES)? {
        Some(table) => read_effect_files(&mut reader, table)?,
        None => Vec::new(),
    };
    if let Some(table) = reader.table(root, "", "effects")? {
        read_effects(&mut reader, table, &mut preset.stack)?;
    }
    if let Some(table) = reader.table(root, "", "animation")? {
        keyframes::read(&mut reader, table, &mut preset)?;
    }
    if let Some(item) = root.get("stack") {
        let has_table = |name: &str| {
            root.get("effects")
                .and_then(|effects| effects.get(name))
                .is_some()
        };
        preset.stack = order::read(item.as_value(), &preset.stack, &reader.catalog, &has_table)
            .map_err(|reason| reader.error(root, "", "stack", reason))?;
    }
    preset
        .check_budget()
        .map_err(|[key, reason]| PresetError::value(reader.position(root, "test"), key, reason))?;
    let catalog = reader.catalog.clone();
    Ok(ReadPreset {
        preset,
        warnings: reader.all_warnings(),
        brought_effects,
        catalog,
    })
}

/// Reads every setting of one section, whose paths begin with `prefix`; at the top of the file,
/// tables are left out.
pub fn read_section(
    reader: &mut Reader<'_>,
    table: &dyn TableLike,
    section: &'static Section,
    prefix: &str,
    preset: &mut Preset,
) -> Result<(), PresetError> {
    let is_top = section.name.is_empty();
    for (name, item) in table.iter() {
        let Some(setting) = section.setting(name) else {
            let tables = || {
                SECTIONS
                    .iter()
                    .map(|section| section.name)
                    .chain(OTHER_KEYS)
                    .filter(|_| is_top)
            };
            if !tables().any(|known| known == name) {
                reader.unknown(
                    table,
                    prefix,
                    name,
                    section
                        .settings
                        .iter()
                        .map(|setting| setting.name.as_str())
                        .chain(tables()),
                );
            }
            continue;
        };
        if let Some(alternative) = setting
            .alternative
            .filter(|alternative| table.contains_key(alternative))
        {
            return Err(reader.error(
                table,
                prefix,
                name,
                format!("and {prefix}{alternative} exclude each other"),
            ));
        }
        let value = reader.value(table, prefix, setting, item)?;
        setting
            .set(preset, &value)
            .map_err(|error| reader.error(table, prefix, name, error))?;
    }
    Ok(())
}

/// Adds the effects whose text the preset holds; returns the names of those that were not known
/// with this text.
fn read_effect_files(
    reader: &mut Reader<'_>,
    table: &dyn TableLike,
) -> Result<Vec<String>, PresetError> {
    let mut brought = Vec::new();
    let prefix = format!("{EFFECT_FILES}.");
    for (name, item) in table.iter() {
        let Some(text) = item.as_str() else {
            return Err(reader.error(table, &prefix, name, "must be the text of an effect file"));
        };
        if brought.len() == MAX_BROUGHT {
            return Err(reader.error(
                table,
                &prefix,
                name,
                format!("is one effect too many; a preset brings at most {MAX_BROUGHT}"),
            ));
        }
        let known = reader.catalog.find(name).ok().flatten();
        if known.is_some_and(|known| {
            known
                .source
                .as_ref()
                .is_some_and(|source| source.shared() == text)
        }) {
            continue;
        }
        reader.catalog.add_text(name, text).map_err(|error| {
            reader.error(table, &prefix, name, format!("cannot be used: {error}"))
        })?;
        brought.push(name.to_owned());
    }
    Ok(brought)
}

fn read_effects(
    reader: &mut Reader<'_>,
    effects: &dyn TableLike,
    stack: &mut Stack,
) -> Result<(), PresetError> {
    for (name, _) in effects.iter() {
        let Some(table) = reader.table(effects, "effects.", name)? else {
            continue;
        };
        match reader.effect(effects, "effects.", name)? {
            Some(effect) => read_effect(reader, table, stack.enable(&effect))?,
            None => reader.unknown_effect(effects, "effects.", name),
        }
    }
    let error = |conflict: Conflict| {
        PresetError::value(
            reader.position(effects, conflict.effect()),
            "effects",
            conflict.to_string(),
        )
    };
    stack.check().map_err(error)
}

fn read_effect(
    reader: &mut Reader<'_>,
    table: &dyn TableLike,
    enabled: &mut EnabledEffect,
) -> Result<(), PresetError> {
    let prefix = format!("effects.{}.", enabled.effect.name);
    for (name, item) in table.iter() {
        if name == INSTANCE_KEY && enabled.effect.base.is_some() {
            continue;
        }
        if name == SCOPE_KEY {
            let toml = item
                .as_value()
                .ok_or_else(|| reader.error(table, &prefix, name, "must be a list, not a table"))?;
            enabled.on = scope::read(toml, &enabled.effect)
                .map_err(|reason| reader.error(table, &prefix, name, reason))?;
            continue;
        }
        let Some(field) = enabled.effect.field(name) else {
            reader.unknown(
                table,
                &prefix,
                name,
                enabled
                    .effect
                    .fields
                    .iter()
                    .map(|field| field.name.as_str())
                    .chain([SCOPE_KEY]),
            );
            continue;
        };
        let value = reader.value(table, &prefix, field, item)?;
        field
            .set_value(&mut enabled.words, &value)
            .map_err(|error| reader.error(table, &prefix, name, error))?;
    }
    Ok(())
}
