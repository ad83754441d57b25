//! Reading: TOML of the current schema to a [`Preset`]. Unknown keys warn; everything else that is wrong is an error with its
//! line.

use toml_edit::{Document, TableLike};

use super::{error::PresetError, keyframes, order, reader::Reader};
use crate::{
    effect_files::Catalog,
    effects::{Conflict, EnabledEffect, Stack},
    preset::{
        GoldenTest, Preset,
        settings::{SECTIONS, Section},
    },
};

/// Keys at the top of a file that are no settings, with the tables that are no sections.
pub const OTHER_KEYS: [&str; 4] = ["schema", "stack", "effects", "animation"];

/// A preset with the warnings about its text.
pub struct ReadPreset {
    pub preset: Preset,
    pub warnings: Vec<String>,
}

/// Reads a whole preset that may use the effects of `catalog`; `file` is what errors and warnings call it.
pub fn read(document: &Document<String>, file: &str, catalog: &Catalog) -> Result<ReadPreset, PresetError> {
    let mut reader = Reader { file, text: Some(document.raw()), catalog, warnings: Vec::new() };
    let (root, mut preset) = (document.as_table(), Preset::default());
    for section in SECTIONS {
        let table = if section.name.is_empty() { Some(root as &dyn TableLike) } else { reader.table(root, "", section.name)? };
        if let Some(table) = table {
            section.add(&mut preset);
            read_section(&mut reader, table, section, &mut preset)?;
        }
    }
    if let Some(table) = reader.table(root, "", "effects")? {
        read_effects(&mut reader, table, &mut preset.stack)?;
        let error = |conflict: Conflict| PresetError::value(reader.position(table, conflict.second), "effects", conflict.to_string());
        preset.stack.check().map_err(error)?;
    }
    if let Some(table) = reader.table(root, "", "animation")? {
        keyframes::read(&mut reader, table, &mut preset)?;
    }
    if let Some(item) = root.get("stack") {
        let has_table = |name: &str| root.get("effects").and_then(|effects| effects.get(name)).is_some();
        preset.stack =
            order::read(item.as_value(), &preset.stack, catalog, &has_table).map_err(|reason| reader.error(root, "", "stack", reason))?;
    }
    check_budget(&reader, root, &preset)?;
    Ok(ReadPreset { preset, warnings: reader.warnings })
}

/// Reads every setting of one section; at the top of the file, tables are left out.
fn read_section(reader: &mut Reader<'_>, table: &dyn TableLike, section: &Section, preset: &mut Preset) -> Result<(), PresetError> {
    let (is_top, prefix) = (section.name.is_empty(), if section.name.is_empty() { String::new() } else { format!("{}.", section.name) });
    for (name, item) in table.iter() {
        let Some(setting) = section.setting(name) else {
            let tables = || SECTIONS.iter().map(|section| section.name).chain(OTHER_KEYS).filter(|_| is_top);
            if !tables().any(|known| known == name) {
                reader.unknown(table, &prefix, name, section.settings.iter().map(|setting| setting.name).chain(tables()));
            }
            continue;
        };
        if let Some(alternative) = setting.alternative.filter(|alternative| table.contains_key(alternative)) {
            return Err(reader.error(table, &prefix, name, format!("and {prefix}{alternative} exclude each other")));
        }
        let value = reader.value(table, &prefix, setting, item)?;
        setting.set(preset, &value).map_err(|error| reader.error(table, &prefix, name, error))?;
    }
    Ok(())
}

fn read_effects(reader: &mut Reader<'_>, effects: &dyn TableLike, stack: &mut Stack) -> Result<(), PresetError> {
    for (name, _) in effects.iter() {
        let Some(table) = reader.table(effects, "effects.", name)? else { continue };
        match reader.effect(effects, "effects.", name)? {
            Some(effect) => read_effect(reader, table, stack.enable(effect))?,
            None => reader.unknown(effects, "effects.", name, reader.catalog.names()),
        }
    }
    Ok(())
}

fn read_effect(reader: &mut Reader<'_>, table: &dyn TableLike, enabled: &mut EnabledEffect) -> Result<(), PresetError> {
    let prefix = format!("effects.{}.", enabled.effect.name);
    for (name, item) in table.iter() {
        let Some(field) = enabled.effect.field(name) else {
            reader.unknown(table, &prefix, name, enabled.effect.fields.iter().map(|field| field.name));
            continue;
        };
        let value = reader.value(table, &prefix, field, item)?;
        field.set_value(&mut enabled.words, &value).map_err(|error| reader.error(table, &prefix, name, error))?;
    }
    Ok(())
}

/// A budget above the default must be explained, and only a preset that may err can have wrong triangles.
fn check_budget(reader: &Reader<'_>, root: &dyn TableLike, preset: &Preset) -> Result<(), PresetError> {
    let (Some(test), default) = (&preset.test, GoldenTest::default()) else { return Ok(()) };
    let error = |key: &str, reason: &str| Err(PresetError::value(reader.position(root, "test"), key, reason));
    if test.max_wrong_triangles > 0 && !preset.accuracy.may_err() {
        let reason = "must be 0 here; it needs a pinned option that is not exact, or the tier draft or fast";
        return error("test.max_wrong_triangles", reason);
    }
    let is_wider = test.max_channel > default.max_channel || test.max_pixels > default.max_pixels || test.max_wrong_triangles > 0;
    if is_wider && test.why.trim().is_empty() {
        return error("test.why", "must say why the budget is above the default");
    }
    Ok(())
}
