//! Writing: the difference between two sessions becomes a patch of the document, so that comments, unknown keys and
//! whatever a person arranged stay as they are.

use toml_edit::{DocumentMut, Item, Table, TableLike, Value as TomlValue};

use super::{
    form::ValueType,
    keys::{KEYS, SECTIONS, Section},
};
use crate::{
    effects::{EFFECTS, Effect, EnabledEffect, Stack},
    preset::Preset,
};

/// MeshletBuffers `document`, which says `saved`, so that it says `now`. Only differences from defaults are written.
pub fn patch(document: &mut DocumentMut, saved: &Preset, now: &Preset) {
    if document.get("schema").is_none() {
        document.insert("schema", super::migrate::CURRENT.into());
    }
    let root = document.as_table_mut();
    patch_keys(root, "", saved, now);
    patch_order(root, &saved.stack, &now.stack);
    for section in SECTIONS {
        if section.name == "accuracy" {
            patch_effects(root, &saved.stack, &now.stack);
            super::animation::patch(root, &saved.animation, &now.animation);
        }
        match section.is_there.map(|there| (there(saved), there(now))) {
            Some((_, false)) => drop(root.remove(section.name)),
            Some((false, true)) => drop(root.insert(section.name, Item::Table(Table::new()))),
            _ => {}
        }
        patch_section(root, section, saved, now);
    }
}

fn patch_section(root: &mut Table, section: &Section, saved: &Preset, now: &Preset) {
    let was_missing = root.get(section.name).is_none();
    if was_missing {
        root.insert(section.name, Item::Table(Table::new()));
    }
    let table = root.get_mut(section.name).and_then(Item::as_table_like_mut).expect("a section that was read is a table");
    patch_keys(table, section.name, saved, now);
    if was_missing && table.is_empty() {
        root.remove(section.name);
    }
}

fn patch_keys(table: &mut dyn TableLike, section: &str, saved: &Preset, now: &Preset) {
    let baseline = Section::baseline(now);
    for key in KEYS.iter().filter(|key| key.section == section) {
        let written = |preset: &Preset| (key.get)(preset).map(|plain| key.form.write(&plain));
        patch_value(table, key.name, written(saved), written(now), written(&baseline));
    }
}

fn patch_effects(root: &mut Table, saved: &Stack, now: &Stack) {
    if root.get("effects").is_none() {
        if now.0.is_empty() {
            return;
        }
        let mut effects = Table::new();
        effects.set_implicit(true);
        root.insert("effects", Item::Table(effects));
    }
    let tables = root.get_mut("effects").and_then(Item::as_table_like_mut).expect("effects were read as a table");
    for effect in EFFECTS {
        match now.get(effect.name) {
            None => drop(tables.remove(effect.name)),
            Some(enabled) => {
                if tables.get(effect.name).is_none() {
                    tables.insert(effect.name, Item::Table(Table::new()));
                }
                let table = tables.get_mut(effect.name).and_then(Item::as_table_like_mut).expect("an effect was read as a table");
                patch_effect(table, saved.get(effect.name), enabled);
            }
        }
    }
}

fn patch_effect(table: &mut dyn TableLike, saved: Option<&EnabledEffect>, now: &EnabledEffect) {
    let defaults = EnabledEffect::new(now.effect);
    let saved = saved.unwrap_or(&defaults);
    for field in now.effect.fields {
        let form = ValueType::of(field);
        let written = |enabled: &EnabledEffect| Some(form.write(&super::get(field, &enabled.words)));
        patch_value(table, field.name, written(saved), written(now), written(&defaults));
    }
}

/// Writes `stack` only where it says more than the usual order.
fn patch_order(root: &mut Table, saved: &Stack, now: &Stack) {
    let names = |stack: &Stack| -> Vec<&str> { stack.0.iter().map(|enabled| enabled.effect.name).collect() };
    if names(saved) == names(now) {
        return;
    }
    // Effects that only a newer program knows keep being named.
    let strangers: Vec<String> = root
        .get("stack")
        .and_then(Item::as_array)
        .into_iter()
        .flatten()
        .filter_map(TomlValue::as_str)
        .filter(|name| Effect::find(name).is_none())
        .map(str::to_owned)
        .collect();
    let order: TomlValue = names(now).into_iter().chain(strangers.iter().map(String::as_str)).collect();
    let default = (now.is_canonical() && strangers.is_empty()).then(|| order.clone());
    patch_value(root, "stack", None, Some(order), default);
}

/// Sets, keeps or removes one key. A line that carries a comment is kept even when it says the default.
fn patch_value(table: &mut dyn TableLike, name: &str, saved: Option<TomlValue>, now: Option<TomlValue>, default: Option<TomlValue>) {
    let text = |value: &Option<TomlValue>| value.as_ref().map(TomlValue::to_string);
    if text(&saved) == text(&now) {
        return;
    }
    let Some(mut value) = now.clone().filter(|_| text(&now) != text(&default) || has_comment(table, name)) else {
        table.remove(name);
        return;
    };
    match table.get_mut(name).and_then(Item::as_value_mut) {
        Some(there) => {
            *value.decor_mut() = there.decor().clone();
            *there = value;
        }
        None => drop(table.insert(name, Item::Value(value))),
    }
}

fn has_comment(table: &dyn TableLike, name: &str) -> bool {
    let Some((key, item)) = table.get_key_value(name) else { return false };
    let before = key.leaf_decor().prefix();
    let after = item.as_value().and_then(|value| value.decor().suffix());
    [before, after].into_iter().flatten().filter_map(|raw| raw.as_str()).any(|text| text.contains('#'))
}
