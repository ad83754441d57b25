//! Writing: the difference between two presets becomes a patch of the document, so that comments,
//! unknown keys and the arrangement of the file stay.

use toml_edit::{DocumentMut, Item, Table, TableLike, Value as Toml};

use super::{
    bookmarks, keyframes, migrate,
    reader::INSTANCE_KEY,
    scope::{self, SCOPE_KEY},
    toml_value,
};
use crate::{
    effect_files::Catalog,
    effects::{EnabledEffect, Stack},
    params::{Param, Value},
    preset::{
        Preset,
        settings::{ACCURACY, CAMERA, CLOCK, GROUND, OUTPUT, SCENE, Section, TEST, TOP, baseline},
    },
};

/// A part of a preset file.
enum Part {
    Section(&'static Section),
    Bookmarks,
    Stack,
    Effects,
    Animation,
}

/// The order in which a new file has its parts.
static PARTS: [Part; 12] = [
    Part::Section(&TOP),
    Part::Stack,
    Part::Section(&SCENE),
    Part::Section(&GROUND),
    Part::Section(&CAMERA),
    Part::Bookmarks,
    Part::Section(&CLOCK),
    Part::Effects,
    Part::Animation,
    Part::Section(&ACCURACY),
    Part::Section(&OUTPUT),
    Part::Section(&TEST),
];

/// Patches `document`, which describes `saved`, so that it describes `now`. Only differences from
/// defaults are written.
pub fn patch(document: &mut DocumentMut, catalog: &Catalog, saved: &Preset, now: &Preset) {
    if document.get("schema").is_none() {
        document.insert("schema", migrate::CURRENT.into());
    }
    let root = document.as_table_mut();
    for part in &PARTS {
        match part {
            Part::Section(section) if section.name.is_empty() => {
                patch_settings(root, section, saved, now)
            }
            Part::Section(section) => patch_section(root, section, saved, now),
            Part::Bookmarks => bookmarks::patch(root, &saved.bookmarks, &now.bookmarks),
            Part::Stack => patch_order(root, catalog, &saved.stack, &now.stack),
            Part::Effects => patch_effects(root, catalog, &saved.stack, &now.stack),
            Part::Animation => keyframes::patch(root, catalog, &saved.animation, &now.animation),
        }
    }
}

fn patch_section(root: &mut Table, section: &Section, saved: &Preset, now: &Preset) {
    match section
        .presence
        .as_ref()
        .map(|presence| ((presence.is_present)(saved), (presence.is_present)(now)))
    {
        Some((_, false)) => drop(root.remove(section.name)),
        Some((false, true)) => drop(root.insert(section.name, Item::Table(Table::new()))),
        _ => {}
    }
    let was_missing = root.get(section.name).is_none();
    if was_missing {
        root.insert(section.name, Item::Table(Table::new()));
    }
    let table = root
        .get_mut(section.name)
        .and_then(Item::as_table_like_mut)
        .expect("a section that was read is a table");
    patch_settings(table, section, saved, now);
    if was_missing && table.is_empty() {
        root.remove(section.name);
    }
}

/// Writes the settings of one section that differ between the presets.
pub fn patch_settings(table: &mut dyn TableLike, section: &Section, saved: &Preset, now: &Preset) {
    let baseline = baseline(now);
    for setting in section.settings.iter() {
        patch_value(
            table,
            setting,
            setting.get(saved),
            setting.get(now),
            setting.get(&baseline),
        );
    }
}

fn patch_effects(root: &mut Table, catalog: &Catalog, saved: &Stack, now: &Stack) {
    if root.get("effects").is_none() {
        if now.0.is_empty() {
            return;
        }
        let mut effects = Table::new();
        effects.set_implicit(true);
        root.insert("effects", Item::Table(effects));
    }
    let tables = root
        .get_mut("effects")
        .and_then(Item::as_table_like_mut)
        .expect("effects were read as a table");
    for effect in catalog.effects_with(
        [saved, now]
            .into_iter()
            .flat_map(|stack| stack.0.iter().map(|enabled| &enabled.effect)),
    ) {
        match now.get(&effect.name) {
            None => drop(tables.remove(&effect.name)),
            Some(enabled) => {
                if tables.get(&effect.name).is_none() {
                    tables.insert(&effect.name, Item::Table(Table::new()));
                }
                let table = tables
                    .get_mut(&effect.name)
                    .and_then(Item::as_table_like_mut)
                    .expect("an effect was read as a table");
                if let Some(base) = &effect.base {
                    table.insert(INSTANCE_KEY, toml_edit::value(&base.name));
                }
                patch_effect(table, saved.get(&effect.name), enabled);
            }
        }
    }
}

fn patch_effect(table: &mut dyn TableLike, saved: Option<&EnabledEffect>, now: &EnabledEffect) {
    let defaults = EnabledEffect::new(&now.effect);
    let saved = saved.unwrap_or(&defaults);
    if saved.on != now.on {
        write_key(table, SCOPE_KEY, scope::write(&now.on));
    }
    for field in &now.effect.fields {
        let value = |enabled: &EnabledEffect| Some(field.value(&enabled.words));
        patch_value(table, field, value(saved), value(now), value(&defaults));
    }
}

/// Writes `stack` only where the order is not the default one.
fn patch_order(root: &mut Table, catalog: &Catalog, saved: &Stack, now: &Stack) {
    let names = |stack: &Stack| -> Vec<String> {
        stack
            .0
            .iter()
            .map(|enabled| enabled.effect.name.clone())
            .collect()
    };
    if names(saved) == names(now) {
        return;
    }
    // Effects that only a newer program knows keep being named.
    let unknown: Vec<String> = root
        .get("stack")
        .and_then(Item::as_array)
        .into_iter()
        .flatten()
        .filter_map(Toml::as_str)
        .filter(|name| !catalog.names().any(|known| known == *name))
        .map(str::to_owned)
        .collect();
    let order: Toml = names(now)
        .into_iter()
        .chain(unknown.iter().cloned())
        .collect();
    let is_default = now.is_canonical() && unknown.is_empty();
    let is_written = !is_default || has_comment(root, "stack");
    write_key(root, "stack", Some(order).filter(|_| is_written));
}

/// Sets, keeps or removes one value. A line that carries a comment is kept even when it has the
/// default.
fn patch_value(
    table: &mut dyn TableLike,
    param: &Param,
    saved: Option<Value>,
    now: Option<Value>,
    default: Option<Value>,
) {
    // Compared as text, which tells -0.0 from 0.0.
    let text = |value: &Option<Value>| {
        value
            .as_ref()
            .map(|value| toml_value::write_text(&param.value_type, value))
    };
    if text(&saved) == text(&now) {
        return;
    }
    let is_written = text(&now) != text(&default) || has_comment(table, &param.name);
    write_key(
        table,
        &param.name,
        now.filter(|_| is_written)
            .map(|value| toml_value::write(&param.value_type, &value)),
    );
}

/// Sets one value with the decoration of the one before, or removes it.
fn write_key(table: &mut dyn TableLike, name: &str, value: Option<Toml>) {
    let Some(mut value) = value else {
        table.remove(name);
        return;
    };
    match table.get_mut(name).and_then(Item::as_value_mut) {
        Some(before) => {
            *value.decor_mut() = before.decor().clone();
            *before = value;
        }
        None => drop(table.insert(name, Item::Value(value))),
    }
}

fn has_comment(table: &dyn TableLike, name: &str) -> bool {
    let Some((key, item)) = table.get_key_value(name) else {
        return false;
    };
    let before = key.leaf_decor().prefix();
    let after = item.as_value().and_then(|value| value.decor().suffix());
    [before, after]
        .into_iter()
        .flatten()
        .filter_map(|raw| raw.as_str())
        .any(|text| text.contains('#'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::settings::SECTIONS;

    #[test]
    fn every_section_is_written() {
        let written: Vec<&str> = PARTS
            .iter()
            .filter_map(|part| {
                if let Part::Section(section) = part {
                    Some(section.name)
                } else {
                    None
                }
            })
            .collect();
        assert_eq!(
            written,
            SECTIONS
                .iter()
                .map(|section| section.name)
                .collect::<Vec<_>>()
        );
    }
}
