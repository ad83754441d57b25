//! `list`: presets, built-in scenes, effects with every parameter and its range, and the accuracy
//! axes.

use std::sync::Arc;

use serde_json::{Value, json};

use super::{
    args::{Common, List, ListKind},
    error::{CliError, Exit},
    streams::{Streams, table},
};
use crate::{
    accuracy::{AXES, Axis},
    effects::Effect,
    params::{Field, format_number},
    preset_file::{self, GalleryEntry, gallery, toml_value},
    scene::builtin::BUILTINS,
};

pub fn run(common: &Common, args: &List, streams: &mut Streams) -> Result<Exit, CliError> {
    let entries = if args.has(ListKind::Presets) {
        gallery(&common.folders())
    } else {
        Vec::new()
    };
    let folders = common.folders();
    let effects: Vec<&Arc<Effect>> = if args.has(ListKind::Effects) {
        folders.effects.effects().collect()
    } else {
        Vec::new()
    };
    let scenes = if args.has(ListKind::Scenes) {
        BUILTINS
    } else {
        &[]
    };
    let axes = if args.has(ListKind::Axes) { AXES } else { &[] };
    if streams.json {
        let preset_files = entries.iter().map(preset_json);
        let effects = effects.iter().map(|effect| effect_json(effect));
        let scenes = scenes
            .iter()
            .map(|scene| json!({ "kind": "scene", "id": scene.name, "about": scene.about, "parameters": scene_parameters(scene.params) }));
        streams.object(
            "list",
            Value::Null,
            preset_files
                .chain(effects)
                .chain(scenes)
                .chain(axes.iter().map(axis_json))
                .collect(),
        )?;
    } else {
        let parts = [
            presets_text(&entries, common),
            effects_text(&effects),
            scenes_text(scenes),
            axes_text(axes),
        ];
        streams.text(
            &parts
                .into_iter()
                .filter(|part| !part.is_empty())
                .collect::<Vec<_>>()
                .join("\n"),
        )?;
    }
    entries
        .iter()
        .filter_map(|entry| entry.preset_file.as_ref().err())
        .for_each(|error| streams.note(&format!("warning: {error}")));
    let faulty = folders
        .effects
        .custom()
        .filter(|_| args.has(ListKind::Effects))
        .filter_map(|(_, custom)| custom.read.as_ref().err());
    faulty.for_each(|error| streams.note(&format!("warning: {error}")));
    Ok(Exit::Done)
}

fn origin(entry: &GalleryEntry, common: &Common) -> String {
    let word = |origin: preset_file::Origin| match origin {
        preset_file::Origin::Chosen if common.presets_dir().is_none() => "the folder presets here",
        preset_file::Origin::Chosen => "--presets",
        preset_file::Origin::Beside => "beside the program",
        preset_file::Origin::User => "user",
        preset_file::Origin::Builtin => "built in",
    };
    let shadows: Vec<&str> = entry.shadows.iter().map(|origin| word(*origin)).collect();
    if shadows.is_empty() {
        word(entry.origin).into()
    } else {
        format!("{}, shadows {}", word(entry.origin), shadows.join(" and "))
    }
}

fn effect_names(preset_file: &preset_file::PresetFile) -> Vec<&str> {
    preset_file
        .preset
        .stack
        .0
        .iter()
        .map(|enabled| enabled.effect.name.as_str())
        .collect()
}

fn presets_text(entries: &[GalleryEntry], common: &Common) -> String {
    if entries.is_empty() {
        return String::new();
    }
    let mut rows = vec![
        ["PRESET", "NAME", "EFFECTS", "FROM"]
            .map(str::to_owned)
            .to_vec(),
    ];
    rows.extend(entries.iter().map(|entry| match &entry.preset_file {
        Ok(preset_file) => vec![
            entry.id.clone(),
            preset_file.title().to_owned(),
            effect_names(preset_file).join(" + "),
            origin(entry, common),
        ],
        Err(_) => vec![
            entry.id.clone(),
            "(cannot be read)".into(),
            String::new(),
            origin(entry, common),
        ],
    }));
    table(&rows)
}

fn default_text(field: &Field, words: &[u32]) -> String {
    toml_value::write_text(&field.value_type, &field.value(words))
}

fn effects_text(effects: &[&Arc<Effect>]) -> String {
    if effects.is_empty() {
        return String::new();
    }
    let mut rows = vec![
        ["EFFECT", "DEFAULT", "ALLOWED", "UNIT", "WHAT"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for effect in effects {
        rows.push(vec![
            effect.name.clone(),
            String::new(),
            String::new(),
            String::new(),
            format!("{} ({} hook)", effect.about, effect.hooks.names()),
        ]);
        let defaults = &effect.defaults;
        rows.extend(effect.fields.iter().map(|field| {
            let name = format!("  {}.{}", effect.name, field.name);
            vec![
                name,
                default_text(field, defaults),
                field.allowed(),
                field.unit.clone(),
                field.doc.trim().into(),
            ]
        }));
    }
    table(&rows)
}

fn scene_parameters(params: &[crate::scene::builtin::BuiltinParam]) -> Vec<Value> {
    let parameter = |p: &crate::scene::builtin::BuiltinParam| json!({ "name": p.name, "about": p.doc, "default": p.default, "hard": [p.range.start(), p.range.end()], "whole": p.whole });
    params.iter().map(parameter).collect()
}

fn scenes_text(scenes: &[crate::scene::builtin::Builtin]) -> String {
    if scenes.is_empty() {
        return String::new();
    }
    let mut rows = vec![
        ["SCENE", "DEFAULT", "ALLOWED", "WHAT"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for scene in scenes {
        rows.push(vec![
            scene.name.into(),
            String::new(),
            String::new(),
            scene.about.into(),
        ]);
        rows.extend(scene.params.iter().map(|p| {
            let allowed = format!(
                "{}..={}",
                format_number(*p.range.start()),
                format_number(*p.range.end())
            );
            vec![
                format!("  ?{}", p.name),
                format_number(p.default),
                allowed,
                p.doc.into(),
            ]
        }));
    }
    table(&rows)
}

fn axes_text(axes: &[Axis]) -> String {
    if axes.is_empty() {
        return String::new();
    }
    let mut rows = vec![["AXIS", "DEFAULT", "WHAT"].map(str::to_owned).to_vec()];
    for axis in axes {
        rows.push(vec![
            format!("accuracy.{}", axis.name),
            axis.words[axis.default].into(),
            axis.about.trim().into(),
        ]);
        rows.extend(
            axis.words
                .iter()
                .zip(axis.option_abouts)
                .map(|(word, about)| vec![format!("  {word}"), String::new(), about.trim().into()]),
        );
    }
    table(&rows)
}

fn axis_json(axis: &Axis) -> Value {
    let options: Vec<Value> = axis
        .words
        .iter()
        .zip(axis.option_abouts)
        .map(|(word, about)| json!({ "name": word, "about": about.trim() }))
        .collect();
    json!({ "kind": "axis", "id": axis.name, "about": axis.about.trim(), "default": axis.words[axis.default], "options": options })
}

fn preset_json(entry: &GalleryEntry) -> Value {
    let mut object = json!({
        "kind": "preset", "id": entry.id, "origin": entry.origin, "shadows": entry.shadows,
        "file": entry.path.as_ref().map(|path| path.to_string_lossy()),
    });
    match &entry.preset_file {
        Ok(preset_file) => {
            let preset = &preset_file.preset;
            object["name"] = json!(preset.name);
            object["about"] = json!(preset.about);
            object["tags"] = json!(preset.tags);
            object["effects"] = json!(effect_names(preset_file));
            object["warnings"] = json!(preset_file.warnings);
        }
        Err(error) => object["error"] = json!(error.to_string()),
    }
    object
}

fn effect_json(effect: &Effect) -> Value {
    let defaults = &effect.defaults;
    let parameter = |field: &Arc<Field>| {
        json!({
            "name": field.name, "about": field.doc.trim(), "type": field.wgsl.name(), "unit": field.unit,
            "default": default_text(field, defaults), "allowed": field.allowed(),
            "hard": field.hard, "soft": field.soft, "log": field.log,
        })
    };
    let parameters: Vec<Value> = effect.fields.iter().map(parameter).collect();
    json!({ "kind": "effect", "id": effect.name, "about": effect.about, "hook": effect.hooks.names(), "parameters": parameters })
}
