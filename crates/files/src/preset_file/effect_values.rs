//! The values of one effect as text: what is copied from one preset and pasted into another, and
//! what files of saved values hold.
//!
//! The text is a preset file with nothing but that effect: `effects.toon = { steps = 3 }`, and
//! `animation.toon = { … }` if it has keyframes. So it can be pasted into a preset file too, and
//! its values are read and checked as those of presets are.

use std::path::{Path, PathBuf};

use toml_edit::{DocumentMut, Item, Table, Value};

use super::{
    atomic::{Existing, write_atomically},
    error::PresetError,
    file::{PresetFile, stem, to_toml},
    load::{parse_with, read_text},
    manage::file_stem,
    migrate,
};
use crate::{
    effect_files::Catalog,
    effects::{Conflict, EnabledEffect},
    preset::{Animation, Preset, Track},
};

/// What a text of values begins with.
const BEGIN: &str = "effects.";

/// An effect with its values, scope and keyframes.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectValues {
    pub enabled: EnabledEffect,
    pub tracks: Vec<Track>,
}

impl EffectValues {
    /// Those of the effect called `name`; none if the preset does not enable it.
    pub fn of(preset: &Preset, name: &str) -> Option<Self> {
        let tracks = preset
            .animation
            .tracks()
            .iter()
            .filter(|track| track.effect().name == name);
        Some(Self {
            enabled: preset.stack.get(name)?.clone(),
            tracks: tracks.cloned().collect(),
        })
    }

    /// Enables the effect in `preset` with these values. If it is in the stack already, it keeps
    /// its place there.
    ///
    /// # Errors
    /// Effects that exclude each other; then nothing is changed.
    pub fn put_into(&self, preset: &mut Preset) -> Result<(), Conflict> {
        let effect = &self.enabled.effect;
        let mut stack = preset.stack.clone();
        if let Some(conflict) = stack.conflict_with(effect) {
            return Err(conflict);
        }
        stack.enable(effect).clone_from(&self.enabled);
        stack.check()?;
        preset.stack = stack;
        preset.animation.remove_effect(&effect.name);
        self.tracks
            .iter()
            .for_each(|track| preset.animation.put(track.clone()));
        Ok(())
    }

    /// The values as a preset file with nothing else.
    fn preset_file(&self, catalog: &Catalog) -> PresetFile {
        let mut preset = Preset::default();
        preset.stack.0.push(self.enabled.clone());
        preset.animation = Animation::default();
        self.tracks
            .iter()
            .for_each(|track| preset.animation.put(track.clone()));
        PresetFile {
            effects: catalog.clone(),
            ..PresetFile::new("values", preset)
        }
    }

    /// As text: one line, and a second one for keyframes. Only differences from defaults are in it.
    pub fn to_text(&self, catalog: &Catalog) -> String {
        let document: DocumentMut = to_toml(&self.preset_file(catalog))
            .parse()
            .unwrap_or_default();
        let name = self.enabled.effect.name.as_str();
        let line = |section: &str| -> Option<String> {
            let table = in_one_line(
                &document
                    .get(section)?
                    .get(name)?
                    .clone()
                    .into_value()
                    .ok()?,
            );
            Some(format!(
                "{section}.{} = {table}\n",
                toml_edit::Key::new(name)
            ))
        };
        ["effects", "animation"]
            .into_iter()
            .filter_map(line)
            .collect()
    }

    /// The values as the text of a file.
    fn to_file(&self, catalog: &Catalog) -> String {
        to_toml(&self.preset_file(catalog))
    }

    /// Reads what [`EffectValues::to_text`] or a file of values has. `file` is what errors call it.
    ///
    /// # Errors
    /// Text that is no preset, or has not exactly one effect that `catalog` knows, or values that a
    /// preset may not have either.
    pub fn parse(text: &str, file: &str, catalog: &Catalog) -> Result<Self, PresetError> {
        let not_ours = |reason: String| PresetError::NotOurs {
            what: file.into(),
            reason,
        };
        let has_schema = text
            .parse::<DocumentMut>()
            .is_ok_and(|document| document.contains_key("schema"));
        let text = if has_schema {
            text.to_owned()
        } else {
            format!("schema = {}\n{text}", migrate::CURRENT)
        };
        let read = parse_with(&text, "values", file, catalog)?;
        if !read.brought_effects.is_empty() {
            return Err(not_ours(
                "it brings the code of an effect; open it as a preset instead".into(),
            ));
        }
        let named: Vec<String> = match read.document.get("effects").and_then(Item::as_table_like) {
            Some(table) => table.iter().map(|(name, _)| name.to_owned()).collect(),
            None => Vec::new(),
        };
        match (&read.preset.stack.0[..], &named[..]) {
            ([enabled], [_]) => Self::of(&read.preset, &enabled.effect.name)
                .ok_or_else(|| not_ours("it has no effect".into())),
            ([], [name]) => Err(not_ours(format!(
                "there is no effect {name} here; its file may be missing"
            ))),
            ([], []) => Err(not_ours("it has no effect".into())),
            _ => Err(not_ours(format!(
                "it has {} effects; one is pasted at a time",
                named.len()
            ))),
        }
    }
}

/// The value without line breaks and comments.
fn in_one_line(value: &Value) -> Value {
    let mut flat = match value {
        Value::Array(list) => Value::Array(list.iter().map(in_one_line).collect()),
        Value::InlineTable(table) => Value::InlineTable(
            table
                .iter()
                .map(|(key, value)| (key, in_one_line(value)))
                .collect(),
        ),
        other => other.clone(),
    };
    match &mut flat {
        Value::Array(list) => list.fmt(),
        Value::InlineTable(table) => table.fmt(),
        other => other.decor_mut().clear(),
    }
    flat
}

/// Is `text` what [`EffectValues::to_text`] writes?
pub fn is_effect_text(text: &str) -> bool {
    text.trim_start().starts_with(BEGIN) && text.contains('=')
}

/// Writes the values to `folder/EFFECT/NAME.toml`, under the file name of `name`. Returns the path.
pub fn save_values(
    values: &EffectValues,
    catalog: &Catalog,
    name: &str,
    folder: &Path,
) -> Result<PathBuf, PresetError> {
    let (name, own) = (name.trim(), folder.join(&values.enabled.effect.name));
    let path = own.join(format!("{}.toml", file_stem(name)?));
    std::fs::create_dir_all(&own).map_err(|error| PresetError::Write {
        file: own.display().to_string(),
        reason: error.to_string(),
    })?;
    let mut document: DocumentMut = values.to_file(catalog).parse().unwrap_or_default();
    let mut root = Table::new();
    root.insert("schema", toml_edit::value(migrate::CURRENT));
    root.insert("name", toml_edit::value(name));
    for (key, item) in document.as_table_mut().iter_mut() {
        if !root.contains_key(key.get()) {
            root.insert(key.get(), std::mem::take(item));
        }
    }
    write_atomically(
        &path,
        DocumentMut::from(root).to_string().as_bytes(),
        Existing::Keep,
    )?;
    Ok(path)
}

/// A file of saved values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SavedValues {
    /// The name of the effect.
    pub effect: String,
    /// What people call the values.
    pub name: String,
    pub path: PathBuf,
}

/// Every file of values in `folder`, by effect and name.
pub fn saved_values(folder: &Path) -> Vec<SavedValues> {
    let inside = |folder: &Path| {
        std::fs::read_dir(folder)
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
    };
    let mut found: Vec<SavedValues> = inside(folder)
        .flat_map(|own| {
            inside(&own)
                .map(move |path| (own.clone(), path))
                .collect::<Vec<_>>()
        })
        .filter(|(_, path)| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
                && path.is_file()
        })
        .map(|(own, path)| {
            let named = read_text(&path)
                .ok()
                .and_then(|text| text.parse::<DocumentMut>().ok());
            let named = named
                .and_then(|document| document.get("name")?.as_str().map(str::to_owned))
                .filter(|name| !name.is_empty());
            SavedValues {
                effect: own.file_name().unwrap_or_default().to_string_lossy().into(),
                name: named.unwrap_or_else(|| stem(&path)),
                path,
            }
        })
        .collect();
    found.sort_by(|a, b| {
        (&a.effect, a.name.to_lowercase()).cmp(&(&b.effect, b.name.to_lowercase()))
    });
    found
}

/// Reads a file of values.
pub fn load_values(path: &Path, catalog: &Catalog) -> Result<EffectValues, PresetError> {
    EffectValues::parse(&read_text(path)?, &path.display().to_string(), catalog)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset_file::{Folders, open, parse, set};

    const DRAWN: &str = "schema = 2\n[effects.lambert]\n[effects.toon]\nsoftness = 0.05\nshadow = 0.42\nlight = 0.98\n[effects.outline]\n";
    const CUT: &str = "schema = 2\n[effects.facet]\namount = 0.75\n[effects.lambert]\n";
    const MOVING: &str = "schema = 2\nstack = [\"lambert\", \"facet\"]\n[effects.facet]\nwidth = 0.3\n[effects.lambert]\n[animation.facet]\n\
        amount = [{ time_s = 0.0, value = 0.0 }, { time_s = 1.0, value = 1.0 }]\n";

    fn preset(name: &str) -> PresetFile {
        match name {
            "drawn" => parse(DRAWN, "drawn").expect("a preset"),
            "cut" => parse(CUT, "cut").expect("a preset"),
            "moving" => parse(MOVING, "moving").expect("a preset"),
            id => open(id, &Folders::default()).expect("a built-in preset"),
        }
    }

    fn of(id: &str, effect: &str) -> EffectValues {
        EffectValues::of(&preset(id).preset, effect).expect("an effect of the preset")
    }

    #[test]
    fn the_text_of_every_effect_of_every_preset_reads_back_to_the_bit() {
        for entry in crate::preset_file::gallery(&Folders::default()) {
            let found = entry.preset_file.expect("a built-in preset");
            for enabled in &found.preset.stack.0 {
                let values =
                    EffectValues::of(&found.preset, &enabled.effect.name).expect("it is enabled");
                let text = values.to_text(&found.effects);
                assert!(
                    text.lines().count() == 1 + usize::from(!values.tracks.is_empty())
                        && is_effect_text(&text),
                    "{text}"
                );
                let back = EffectValues::parse(&text, "the clipboard", &found.effects)
                    .unwrap_or_else(|error| panic!("{error}\n{text}"));
                assert_eq!(back, values, "{}: {text}", entry.id);
            }
        }
    }

    #[test]
    fn a_line_is_short_and_may_stand_in_a_preset_file() {
        let text = of("drawn", "toon").to_text(&Catalog::default());
        assert_eq!(
            text,
            "effects.toon = { softness = 0.05, shadow = 0.42, light = 0.98 }\n"
        );
        let pasted = parse(
            &format!("schema = 2\n{text}[scene]\nbuiltin = \"knot\"\n"),
            "p",
        )
        .expect("a preset");
        assert_eq!(pasted.preset.stack.0, [of("drawn", "toon").enabled]);
    }

    #[test]
    fn pasting_replaces_values_and_keyframes_and_keeps_the_place_in_the_stack() {
        let mut target = preset("moving").preset;
        let before: Vec<String> = target
            .stack
            .0
            .iter()
            .map(|enabled| enabled.effect.name.clone())
            .collect();
        assert!(!target.animation.tracks().is_empty());
        of("cut", "facet")
            .put_into(&mut target)
            .expect("no conflict");
        assert_eq!(
            target
                .stack
                .0
                .iter()
                .map(|enabled| enabled.effect.name.clone())
                .collect::<Vec<_>>(),
            before
        );
        assert_eq!(EffectValues::of(&target, "facet"), Some(of("cut", "facet")));
        of("moving", "facet")
            .put_into(&mut target)
            .expect("no conflict");
        assert_eq!(target.animation, preset("moving").preset.animation);
    }

    #[test]
    fn an_effect_that_the_stack_excludes_is_refused_and_nothing_changes() {
        let mut target = preset("xray").preset;
        let before = target.clone();
        let conflict = of("overdraw", "overdraw")
            .put_into(&mut target)
            .expect_err("both take a slot")
            .to_string();
        assert!(
            conflict.contains("both take the visibility slot"),
            "{conflict}"
        );
        assert_eq!(target, before);
    }

    #[test]
    fn text_that_is_no_effect_says_why() {
        let why = |text: &str| {
            EffectValues::parse(text, "the pasted text", &Catalog::default())
                .expect_err(text)
                .to_string()
        };
        assert!(why("effects.nope = { a = 1 }").contains("there is no effect nope here"));
        assert!(why("effects.toon = {}\neffects.fog = {}").contains("2 effects"));
        assert!(why("effects.toon = { steps = 300 }").contains("effects.toon.steps takes"));
        assert!(why("effects.toon = {").contains("the pasted text"));
        assert!(why("effects.ink = {}\n[effect_files]\nink = \"fn surface() {}\"").contains("ink"));
        assert!(why("").contains("no effect"));
    }

    #[test]
    fn saved_values_are_listed_by_effect_and_read_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let catalog = Catalog::default();
        let mut edited = preset("drawn");
        for (name, steps) in [("Three tones", "3"), ("Soft", "5")] {
            set(&mut edited, "toon.steps", steps).expect("a value");
            let values = EffectValues::of(&edited.preset, "toon").expect("it is enabled");
            let path = save_values(&values, &catalog, name, folder.path()).expect("a free name");
            assert_eq!(load_values(&path, &catalog).expect("values"), values);
            assert!(
                save_values(&values, &catalog, name, folder.path())
                    .expect_err("taken")
                    .to_string()
                    .contains("exists already")
            );
        }
        let keyed = of("moving", "facet");
        let path =
            save_values(&keyed, &catalog, "up and down", folder.path()).expect("a free name");
        assert_eq!(load_values(&path, &catalog).expect("values"), keyed);
        let listed: Vec<(String, String)> = saved_values(folder.path())
            .into_iter()
            .map(|saved| (saved.effect, saved.name))
            .collect();
        let expected = [
            ("facet", "up and down"),
            ("toon", "Soft"),
            ("toon", "Three tones"),
        ];
        assert_eq!(
            listed,
            expected.map(|(effect, name)| (effect.to_owned(), name.to_owned()))
        );
        assert!(saved_values(Path::new("/no/such/folder")).is_empty());
    }
}
