//! The JSON schema of presets, for editors: generated from the same tables that read them.

use serde_json::{Map, Value as Json, json};

use super::{
    animation::entry_forms,
    form::{Precision, Value, ValueType},
    keys::{KEYS, SECTIONS},
    migrate,
};
use crate::{
    effects::{EFFECTS, Effect},
    preset::{Preset, animation::MAX_KEYFRAMES},
};

/// The whole schema. `presets/schema.json` is this, and a test fails when it is stale.
pub fn schema() -> Json {
    let mut properties = Map::new();
    properties.insert("schema".into(), json!({ "const": migrate::CURRENT, "description": "Version of the format" }));
    properties.extend(section(""));
    let names: Vec<_> = EFFECTS.iter().map(|effect| effect.name).collect();
    properties.insert(
        "stack".into(),
        json!({
            "description": "Order of the enabled effects, each named once; only where it differs from the usual one",
            "type": "array", "uniqueItems": true, "items": { "enum": names },
        }),
    );
    for table in SECTIONS {
        properties.insert(table.name.into(), json!({ "type": "object", "description": table.doc, "properties": section(table.name) }));
    }
    let effects: Map<String, Json> = EFFECTS.iter().map(|effect| (effect.name.to_owned(), effect_schema(effect))).collect();
    let doc = "Presence of a table enables the effect";
    properties.insert("effects".into(), json!({ "type": "object", "description": doc, "properties": effects }));
    let animation: Map<String, Json> = EFFECTS.iter().map(|effect| (effect.name.to_owned(), animation_schema(effect))).collect();
    let doc = "Parameters that follow the clock, as lists of keys";
    properties.insert("animation".into(), json!({ "type": "object", "description": doc, "properties": animation }));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "rasterlab look",
        "type": "object",
        "required": ["schema"],
        "properties": properties,
    })
}

/// The schema as the file holds it.
pub fn text() -> String {
    format!("{:#}\n", schema())
}

fn section(name: &str) -> Map<String, Json> {
    let defaults = Preset::default();
    let keys = KEYS.iter().filter(|key| key.section == name);
    keys.map(|key| (key.name.to_owned(), form_schema(&key.form, key.doc, (key.get)(&defaults)))).collect()
}

fn effect_schema(effect: &Effect) -> Json {
    let defaults = (effect.defaults)();
    let field = |field: &crate::params::Field| {
        let doc = if field.unit.is_empty() { field.doc.trim().to_owned() } else { format!("{} ({})", field.doc.trim(), field.unit) };
        (field.name.to_owned(), form_schema(&ValueType::of(field), &doc, Some(super::get(field, &defaults))))
    };
    let properties: Map<String, Json> = effect.fields.iter().map(field).collect();
    json!({ "type": "object", "description": effect.about, "properties": properties })
}

fn animation_schema(effect: &Effect) -> Json {
    let track = |field: &crate::params::Field| {
        let entry = entry_forms(field).map(|(name, form, doc)| (name.to_owned(), form_schema(&form, doc, None)));
        let keys = json!({ "type": "object", "required": ["time_s", "value"], "properties": Map::from_iter(entry) });
        (field.name.to_owned(), json!({ "type": "array", "minItems": 1, "maxItems": MAX_KEYFRAMES, "items": keys }))
    };
    json!({ "type": "object", "properties": effect.fields.iter().map(track).collect::<Map<String, Json>>() })
}

fn form_schema(form: &ValueType, doc: &str, default: Option<Value>) -> Json {
    let mut schema = match *form {
        ValueType::Text { longest } => json!({ "type": "string", "maxLength": longest }),
        ValueType::Texts { most, longest } => {
            json!({ "type": "array", "maxItems": most, "items": { "type": "string", "maxLength": longest } })
        }
        ValueType::Flag => json!({ "type": "boolean" }),
        ValueType::Word(words) => json!({ "enum": words }),
        ValueType::Numbers { lanes, low, high, precision } => {
            let kind = if precision == Precision::Whole { "integer" } else { "number" };
            let lane = json!({ "type": kind, "minimum": exact(low), "maximum": exact(high) });
            if lanes == 1 { lane } else { json!({ "type": "array", "minItems": lanes, "maxItems": lanes, "items": lane }) }
        }
    };
    schema["description"] = doc.into();
    if let Some(default) = default {
        schema["default"] = default_json(form, &default);
    }
    schema
}

/// A default as the file would say it.
fn default_json(form: &ValueType, default: &Value) -> Json {
    let shortest = |lane: &f64, precision: Precision| match precision {
        Precision::Single => format!("{:?}", *lane as f32).parse().map_or(json!(lane), exact),
        _ => exact(*lane),
    };
    match (form, default) {
        (_, Value::Text(text)) => json!(text),
        (_, Value::Texts(texts)) => json!(texts),
        (ValueType::Flag, plain) => json!(plain.first() != 0.0),
        (ValueType::Word(words), plain) => json!(words[plain.first() as usize]),
        (ValueType::Numbers { lanes: 1, precision, .. }, Value::Numbers(lanes)) => shortest(&lanes[0], *precision),
        (ValueType::Numbers { precision, .. }, Value::Numbers(lanes)) => lanes.iter().map(|lane| shortest(lane, *precision)).collect(),
        (form, plain) => unreachable!("{plain:?} is not of the form {form:?}"),
    }
}

/// Whole numbers without a point.
fn exact(value: f64) -> Json {
    if value.fract() == 0.0 && value.abs() < 1e15 { json!(value as i64) } else { json!(value) }
}
