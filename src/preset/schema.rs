//! The JSON schema of looks, for editors: generated from the same tables that read them.

use serde_json::{Map, Value, json};

use super::{
    animation::entry_forms,
    form::{Form, Plain, Precision},
    keys::{KEYS, SECTIONS},
    migrate,
};
use crate::{
    effects::{EFFECTS, Effect},
    session::{Session, animation::MAX_KEYS},
};

/// The whole schema. `presets/schema.json` is this, and a test fails when it is stale.
pub fn schema() -> Value {
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
    let effects: Map<String, Value> = EFFECTS.iter().map(|effect| (effect.name.to_owned(), effect_schema(effect))).collect();
    let doc = "Presence of a table enables the effect";
    properties.insert("effects".into(), json!({ "type": "object", "description": doc, "properties": effects }));
    let animation: Map<String, Value> = EFFECTS.iter().map(|effect| (effect.name.to_owned(), animation_schema(effect))).collect();
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

fn section(name: &str) -> Map<String, Value> {
    let defaults = Session::default();
    let keys = KEYS.iter().filter(|key| key.section == name);
    keys.map(|key| (key.name.to_owned(), form_schema(&key.form, key.doc, (key.get)(&defaults)))).collect()
}

fn effect_schema(effect: &Effect) -> Value {
    let defaults = (effect.defaults)();
    let field = |field: &crate::params::Field| {
        let doc = if field.unit.is_empty() { field.doc.trim().to_owned() } else { format!("{} ({})", field.doc.trim(), field.unit) };
        (field.name.to_owned(), form_schema(&Form::of(field), &doc, Some(super::get(field, &defaults))))
    };
    let properties: Map<String, Value> = effect.fields.iter().map(field).collect();
    json!({ "type": "object", "description": effect.about, "properties": properties })
}

fn animation_schema(effect: &Effect) -> Value {
    let track = |field: &crate::params::Field| {
        let entry = entry_forms(field).map(|(name, form, doc)| (name.to_owned(), form_schema(&form, doc, None)));
        let keys = json!({ "type": "object", "required": ["time_s", "value"], "properties": Map::from_iter(entry) });
        (field.name.to_owned(), json!({ "type": "array", "minItems": 1, "maxItems": MAX_KEYS, "items": keys }))
    };
    json!({ "type": "object", "properties": effect.fields.iter().map(track).collect::<Map<String, Value>>() })
}

fn form_schema(form: &Form, doc: &str, default: Option<Plain>) -> Value {
    let mut schema = match *form {
        Form::Text { longest } => json!({ "type": "string", "maxLength": longest }),
        Form::Texts { most, longest } => json!({ "type": "array", "maxItems": most, "items": { "type": "string", "maxLength": longest } }),
        Form::Flag => json!({ "type": "boolean" }),
        Form::Word(words) => json!({ "enum": words }),
        Form::Numbers { lanes, low, high, precision } => {
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
fn default_json(form: &Form, default: &Plain) -> Value {
    let shortest = |lane: &f64, precision: Precision| match precision {
        Precision::Single => format!("{:?}", *lane as f32).parse().map_or(json!(lane), exact),
        _ => exact(*lane),
    };
    match (form, default) {
        (_, Plain::Text(text)) => json!(text),
        (_, Plain::Texts(texts)) => json!(texts),
        (Form::Flag, plain) => json!(plain.first() != 0.0),
        (Form::Word(words), plain) => json!(words[plain.first() as usize]),
        (Form::Numbers { lanes: 1, precision, .. }, Plain::Numbers(lanes)) => shortest(&lanes[0], *precision),
        (Form::Numbers { precision, .. }, Plain::Numbers(lanes)) => lanes.iter().map(|lane| shortest(lane, *precision)).collect(),
        (form, plain) => unreachable!("{plain:?} is not of the form {form:?}"),
    }
}

/// Whole numbers without a point.
fn exact(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 1e15 { json!(value as i64) } else { json!(value) }
}
