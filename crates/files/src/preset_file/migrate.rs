//! Migrations: one pure function from document to document per step of `schema`.
//!
//! A changed default changes what sparse files mean, so it raises the schema, and its migration writes the old value
//! down. A migration changes keys and words inside their lines, so that the lines of errors stay right. Loading never rewrites a
//! file; `rasterlab migrate --write` and saving do.

use toml_edit::{DocumentMut, Item, Key, Table, Value};

/// `MIGRATIONS[n]` takes schema `n + 1` to `n + 2`. Each comes with a before and an after fixture in `tests/house/presets/migrations.rs`.
pub const MIGRATIONS: &[fn(DocumentMut) -> DocumentMut] = &[to_schema_2];

/// The schema that this program writes.
pub const CURRENT: i64 = 1 + MIGRATIONS.len() as i64;

/// Does a document of this schema have keys or words of before?
pub fn is_outdated(document: &Table, schema: i64) -> bool {
    let has_word = |(section, key, old, _): &(&str, &str, &str, &str)| {
        document.get(section).and_then(Item::as_table_like).and_then(|table| table.get(key)).and_then(Item::as_str) == Some(old)
    };
    schema < CURRENT || schema == CURRENT && WITHDRAWN_WORDS.iter().any(has_word)
}

/// Brings a document of schema `from`, 1 to [`CURRENT`], up to date.
pub fn migrate(document: DocumentMut, from: i64) -> DocumentMut {
    let mut document = MIGRATIONS.iter().skip((from - 1).max(0) as usize).fold(document, |document, step| step(document));
    for (section, key, old, new) in WITHDRAWN_WORDS {
        if let Some(item) = document.get_mut(section).and_then(Item::as_table_like_mut).and_then(|table| table.get_mut(key)) {
            rename_word(item, old, new);
        }
    }
    if let Some(value) = document.get_mut("schema").and_then(|item| item.as_value_mut()) {
        let decor = value.decor().clone();
        *value = CURRENT.into();
        *value.decor_mut() = decor;
    }
    document
}

/// Keys that schema 2 renames: section or effect, old name, new name.
pub const RENAMED_KEYS: &[(&str, &str, &str)] = &[
    ("scene", "pose_s", "clip_time_s"),
    ("scene", "clip_b", "second_clip"),
    ("scene", "blend", "clip_blend"),
    ("clock", "loops", "loop"),
    ("accuracy", "wrong_ppm", "max_wrong_ppm"),
    ("accuracy", "channel", "max_channel"),
    ("accuracy", "vertices", "position_format"),
    ("accuracy", "vertex", "vertex_transform"),
    ("accuracy", "curl", "curl_noise"),
    ("accuracy", "state", "particle_storage"),
    ("accuracy", "counting", "sample_counter"),
    ("accuracy", "sums", "xray_sums"),
    ("accuracy", "scale", "render_scale"),
    ("accuracy", "dots", "dot_culling"),
    ("accuracy", "shadow_map", "shadow_map_size"),
    ("accuracy", "taps", "shadow_taps"),
    ("accuracy", "checks", "shader_checks"),
    ("test", "max_wrong_owner", "max_wrong_triangles"),
    ("draw_order", "share", "fraction"),
    ("particles", "origin", "center"),
    ("particles", "spread", "half_axes"),
    ("particles", "life_s", "lifetime_s"),
    ("particles", "life_spread", "lifetime_variation"),
    ("particles", "size_m", "radius_m"),
    ("particles", "size_spread", "radius_variation"),
    ("particles", "follow_s", "attractor_lag_s"),
    ("particles", "bright_mps", "fast_mps"),
    ("wobble", "toward", "direction"),
    ("stipple", "is_shifted", "shift_per_triangle"),
    ("lambert", "toward", "sun_direction"),
    ("hatch", "lie", "space"),
    ("xray", "reach", "layers"),
    ("overdraw", "full", "max_layers"),
    ("dots", "gap_px", "min_gap_px"),
    ("dots", "hidden", "hidden_opacity"),
    ("dots", "model", "show_model"),
    ("outline", "jump", "depth_threshold"),
];

/// Words that schema 2 renames: section or effect, new name of the key, old word, new word.
pub const RENAMED_WORDS: &[(&str, &str, &str, &str)] =
    &[("accuracy", "render_scale", "whole", "full"), ("draw_order", "unit", "share", "fraction")];

/// Words that no schema has any more, since another draws the same picture faster: section, key, old word, new word.
pub const WITHDRAWN_WORDS: &[(&str, &str, &str, &str)] = &[("accuracy", "visibility", "tiled", "split32")];

/// Names in the vocabulary of computer graphics.
fn to_schema_2(mut document: DocumentMut) -> DocumentMut {
    let root = document.as_table_mut();
    for section in ["scene", "clock", "accuracy", "test"] {
        rename_in(root.get_mut(section), section);
    }
    for tables in ["effects", "animation"] {
        let Some(tables) = root.get_mut(tables).and_then(Item::as_table_like_mut) else { continue };
        for (name, table) in tables.iter_mut() {
            rename_in(Some(table), name.get());
        }
    }
    document
}

/// Renames the keys and words of one section or effect.
fn rename_in(item: Option<&mut Item>, owner: &str) {
    let renames: Vec<_> = RENAMED_KEYS.iter().filter(|(of, ..)| *of == owner).collect();
    let words: Vec<_> = RENAMED_WORDS.iter().filter(|(of, ..)| *of == owner).collect();
    let Some(item) = item.filter(|_| !(renames.is_empty() && words.is_empty())) else { return };
    for (_, old, new) in renames {
        match item {
            Item::Table(table) => rename_key(table, old, new),
            Item::Value(Value::InlineTable(table)) => {
                // A comment behind the table is part of its decor, which the way through a table drops.
                let decor = table.decor().clone();
                let mut entries = std::mem::take(table).into_table();
                rename_key(&mut entries, old, new);
                *table = entries.into_inline_table();
                *table.decor_mut() = decor;
            }
            _ => {}
        }
    }
    let Some(table) = item.as_table_like_mut() else { return };
    for (_, key, old, new) in words {
        if let Some(item) = table.get_mut(key) {
            rename_word(item, old, new);
        }
    }
}

/// Renames a key in its place. A table that has the new name already keeps both.
fn rename_key(table: &mut Table, old: &str, new: &str) {
    if !table.contains_key(old) || table.contains_key(new) {
        return;
    }
    let keys: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
    let entries: Vec<(Key, Item)> = keys.iter().filter_map(|key| table.remove_entry(key)).collect();
    for (key, item) in entries {
        let key = if key.get() == old {
            Key::new(new).with_leaf_decor(key.leaf_decor().clone()).with_dotted_decor(key.dotted_decor().clone())
        } else {
            key
        };
        table.insert_formatted(&key, item);
    }
}

/// Replaces a word as the value of a key, or as the value of its keyframes.
fn rename_word(item: &mut Item, old: &str, new: &str) {
    match item {
        Item::Value(value) => rename_word_value(value, old, new),
        Item::ArrayOfTables(tables) => {
            tables.iter_mut().filter_map(|table| table.get_mut("value")).for_each(|value| rename_word(value, old, new));
        }
        _ => {}
    }
}

fn rename_word_value(value: &mut Value, old: &str, new: &str) {
    match value {
        Value::String(word) if word.value() == old => {
            let decor = value.decor().clone();
            *value = new.into();
            *value.decor_mut() = decor;
        }
        Value::Array(keyframes) => {
            for keyframe in keyframes.iter_mut().filter_map(Value::as_inline_table_mut) {
                if let Some(value) = keyframe.get_mut("value") {
                    rename_word_value(value, old, new);
                }
            }
        }
        _ => {}
    }
}

/// The current path of a key that an older schema had under `path`, without `effects.`.
pub fn renamed_key(path: &str) -> Option<String> {
    let (owner, name) = path.split_once('.')?;
    let (.., new) = RENAMED_KEYS.iter().find(|(of, old, _)| (*of, *old) == (owner, name))?;
    Some(format!("{owner}.{new}"))
}

/// The current word for `written`, where an older schema had that and `words` are allowed now.
pub fn renamed_word(written: &str, words: &[&'static str]) -> Option<&'static str> {
    let mut renamed = RENAMED_WORDS.iter().chain(WITHDRAWN_WORDS).filter(|(.., old, _)| *old == written);
    renamed.find_map(|(.., new)| words.iter().copied().find(|word| word == new))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        effects::Effect,
        params::ValueType,
        preset::settings::{Section, Setting},
    };

    #[test]
    fn every_older_schema_has_a_way_to_the_current_one() {
        for from in 1..=CURRENT {
            let document: DocumentMut = format!("schema = {from} # kept\n").parse().unwrap();
            assert_eq!(migrate(document, from).to_string(), format!("schema = {CURRENT} # kept\n"));
        }
    }

    /// The words of a key, none where it has no choice; panics where there is no such key.
    fn words_of(owner: &str, name: &str) -> Option<&'static [&'static str]> {
        let value_type = match Effect::find(owner) {
            Some(effect) => effect.field(name).map(|field| field.value_type),
            None => Setting::find(&format!("{owner}.{name}")).map(|setting| setting.value_type),
        };
        match value_type.unwrap_or_else(|| panic!("{owner}.{name} does not exist")) {
            ValueType::Choice(words) => Some(words),
            _ => None,
        }
    }

    #[test]
    fn renames_lead_from_names_that_are_gone_to_names_that_exist() {
        for (owner, old, new) in RENAMED_KEYS {
            words_of(owner, new);
            let is_gone = match Effect::find(owner) {
                Some(effect) => effect.field(old).is_none(),
                None => Section::find(owner).expect("a section").setting(old).is_none(),
            };
            assert!(is_gone, "{owner}.{old} still exists");
            assert_eq!(renamed_key(&format!("{owner}.{old}")), Some(format!("{owner}.{new}")));
        }
        for (owner, name, old, new) in RENAMED_WORDS {
            let words = words_of(owner, name).unwrap_or_else(|| panic!("{owner}.{name} has no words"));
            assert!(words.contains(new) && !words.contains(old), "{owner}.{name}: {old} -> {new}");
            assert_eq!(renamed_word(old, words), Some(*new));
        }
    }

    #[test]
    fn a_key_keeps_its_line_its_comments_and_its_neighbours() {
        let before = "schema = 1\n\n# why\n[accuracy] # table\n# above\nscale = \"whole\" # beside\ndepth = \"log16\"\n\n[clock]\nspeed = 2.0\n\
                      loops = false\nrange_s = [0, 1]\n";
        let after =
            before.replace("scale = \"whole\"", "render_scale = \"full\"").replace("loops", "loop").replace("schema = 1", "schema = 2");
        assert_eq!(migrate(before.parse().unwrap(), 1).to_string(), after);
    }

    #[test]
    fn inline_and_dotted_tables_are_renamed_too() {
        for (before, after) in [
            ("accuracy = { taps = \"9\", depth = \"log16\" } # x\n", "accuracy = { shadow_taps = \"9\", depth = \"log16\" } # x\n"),
            ("accuracy.taps = \"9\"\naccuracy.depth = \"log16\"\n", "accuracy.shadow_taps = \"9\"\naccuracy.depth = \"log16\"\n"),
            ("[accuracy]\ntaps = \"1\"\nshadow_taps = \"9\"\n", "[accuracy]\ntaps = \"1\"\nshadow_taps = \"9\"\n"),
        ] {
            assert_eq!(migrate(before.parse().unwrap(), 1).to_string(), after);
        }
    }
}
