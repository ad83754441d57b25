//! The JSON schema of preset files, for editors: generated from the registry that reads them.

use std::sync::Arc;

use serde_json::{Map, Value as Json, json};

use super::{file::EFFECT_FILES, keyframes::entry_params, migrate, scope::SCOPE_KEY};
use crate::{
    effects::{EFFECTS, Effect},
    params::{Param, Value, ValueType},
    preset::{
        MAX_BOOKMARK_CHARS, MAX_BOOKMARKS, Preset,
        animation::MAX_KEYFRAMES,
        settings::{BOOKMARKS, CAMERA, SECTIONS, Section, Setting, TOP},
    },
    scene::parts::{MAX_NAME_CHARS, MAX_PATTERNS},
};

/// The whole schema. `presets/schema.json` is this, and a test fails when it is stale.
pub fn schema() -> Json {
    let mut properties = Map::new();
    properties.insert(
        "schema".into(),
        json!({ "const": migrate::CURRENT, "description": "Version of the format" }),
    );
    properties.extend(section_schema(&TOP));
    let names: Vec<_> = EFFECTS.iter().map(|effect| effect.name.as_str()).collect();
    properties.insert(
        "stack".into(),
        json!({
            "description": "Order of the enabled effects, each named once; only where it differs from the default order",
            "type": "array", "uniqueItems": true, "items": { "anyOf": [{ "enum": names }, { "type": "string", "pattern": "^[a-z][a-z0-9_]*$" }] },
        }),
    );
    for section in SECTIONS.iter().filter(|section| !section.name.is_empty()) {
        properties
            .insert(section.name.into(), json!({ "type": "object", "description": section.doc, "properties": section_schema(section) }));
    }
    let doc = "Cameras under names, which the picture may be seen from";
    properties.insert(
        BOOKMARKS.into(),
        json!({
            "type": "object", "description": doc, "maxProperties": MAX_BOOKMARKS,
            "propertyNames": { "minLength": 1, "maxLength": MAX_BOOKMARK_CHARS },
            "additionalProperties": { "type": "object", "properties": section_schema(&CAMERA) },
        }),
    );
    let effects: Map<String, Json> = EFFECTS
        .iter()
        .map(|effect| (effect.name.to_owned(), effect_schema(effect)))
        .collect();
    let doc = "Presence of a table enables the effect";
    properties.insert(
        "effects".into(),
        json!({ "type": "object", "description": doc, "properties": effects }),
    );
    let doc = "Texts of effect files that a shared preset brings, by name";
    properties.insert(EFFECT_FILES.into(), json!({ "type": "object", "description": doc, "additionalProperties": { "type": "string" } }));
    let animation: Map<String, Json> = EFFECTS
        .iter()
        .map(|effect| (effect.name.to_owned(), animation_schema(effect)))
        .collect();
    let doc = "Parameters that follow the clock, as lists of keyframes";
    properties.insert(
        "animation".into(),
        json!({ "type": "object", "description": doc, "properties": animation }),
    );
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "rasterlab preset",
        "type": "object",
        "required": ["schema"],
        "properties": properties,
    })
}

/// The schema as the file holds it.
pub fn text() -> String {
    format!("{:#}\n", schema())
}

fn section_schema(section: &Section) -> Map<String, Json> {
    let defaults = Preset::default();
    let schema = |setting: &Setting| {
        let mut schema = param_schema(setting, setting.get(&defaults));
        if let Some(refused) = refusal_of(&setting.path()) {
            schema["not"] = refused;
        }
        (setting.name.to_owned(), schema)
    };
    section.settings.iter().map(schema).collect()
}

/// What the rule of a setting refuses, where a schema can say it.
fn refusal_of(path: &str) -> Option<Json> {
    match path {
        "scene.room" => Some(json!({ "exclusiveMinimum": 0, "exclusiveMaximum": 1 })),
        "scene.path" | "scene.surroundings" => Some(json!({ "pattern": "://" })),
        _ => None,
    }
}

fn effect_schema(effect: &Effect) -> Json {
    let defaults = &effect.defaults;
    let mut properties: Map<String, Json> = effect
        .fields
        .iter()
        .map(|field| {
            (
                field.name.clone(),
                param_schema(field, Some(field.value(defaults))),
            )
        })
        .collect();
    if effect.has_scope() {
        properties.insert(SCOPE_KEY.into(), scope_schema());
    }
    json!({ "type": "object", "description": effect.about, "properties": properties })
}

fn scope_schema() -> Json {
    let pattern = format!("^(material|node|mesh):[^\\u0000-\\u001f]{{1,{MAX_NAME_CHARS}}}$");
    let pattern = json!({ "type": "string", "pattern": pattern });
    let doc = "Parts of the scene that the effect changes, by patterns such as material:Lens*; * is any text, ? any character";
    json!({ "description": doc, "default": [], "anyOf": [pattern, { "type": "array", "maxItems": MAX_PATTERNS, "items": pattern }] })
}

fn animation_schema(effect: &Effect) -> Json {
    let track = |field: &Arc<crate::params::Field>| {
        let entry =
            entry_params(field).map(|param| (param.name.clone(), param_schema(&param, None)));
        let keyframe = json!({ "type": "object", "required": ["time_s", "value"], "properties": Map::from_iter(entry) });
        (
            field.name.clone(),
            json!({ "type": "array", "minItems": 1, "maxItems": MAX_KEYFRAMES, "items": keyframe }),
        )
    };
    json!({ "type": "object", "properties": effect.fields.iter().map(track).collect::<Map<String, Json>>() })
}

fn param_schema(param: &Param, default: Option<Value>) -> Json {
    let mut schema = match &param.value_type {
        ValueType::Text { max_chars } => json!({ "type": "string", "maxLength": max_chars }),
        ValueType::TextList {
            max_entries,
            max_chars,
        } => {
            json!({ "type": "array", "maxItems": max_entries, "items": { "type": "string", "maxLength": max_chars } })
        }
        ValueType::Bool => json!({ "type": "boolean" }),
        ValueType::Choice(words) => json!({ "enum": words }),
        numbers => {
            let kind = if numbers.is_continuous() {
                "number"
            } else {
                "integer"
            };
            let number = json!({ "type": kind, "minimum": exact(param.hard[0]), "maximum": exact(param.hard[1]) });
            match numbers.components() {
                1 => number,
                count => {
                    let list = json!({ "type": "array", "minItems": count, "maxItems": count, "items": number });
                    match numbers {
                        ValueType::Color => json!({ "anyOf": [list, {
                            "type": "string", "pattern": "^#([0-9a-fA-F]{2}){3,4}$"
                        }] }),
                        _ => list,
                    }
                }
            }
        }
    };
    let doc = param.doc.trim();
    schema["description"] = if param.unit.is_empty() {
        doc.into()
    } else {
        format!("{doc} ({})", param.unit).into()
    };
    if let Some(default) = default {
        schema["default"] = default_json(&param.value_type, &default);
    }
    schema
}

/// A default as the file would have it.
fn default_json(value_type: &ValueType, default: &Value) -> Json {
    let shortest = |number: &f64| match value_type.is_single() {
        true => format!("{:?}", *number as f32)
            .parse()
            .map_or(json!(number), exact),
        false => exact(*number),
    };
    match default {
        Value::Text(text) => json!(text),
        Value::TextList(texts) => json!(texts),
        Value::Bool(on) => json!(on),
        Value::Choice(index) => match value_type {
            ValueType::Choice(words) => json!(words.get(*index)),
            _ => json!(index),
        },
        Value::Numbers(numbers) => match numbers.as_slice() {
            [number] => shortest(number),
            numbers => numbers.iter().map(shortest).collect(),
        },
    }
}

/// Whole numbers without a point.
fn exact(number: f64) -> Json {
    if number.fract() == 0.0 && number.abs() < 1e15 {
        json!(number as i64)
    } else {
        json!(number)
    }
}
