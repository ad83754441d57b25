//! Elements of the document: each is read as a type of the crate `gltf`. A field that does not fit is
//! named, and costs the element or only itself.

use std::fmt::Display;

use ::gltf::json::validation::Checked;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use serde_path_to_error::Segment;

use super::super::{error::quoted, notes::Notes};
use crate::legible::legible_name;

/// A JSON object.
pub type Object = Map<String, Value>;

/// A value as a sentence shows it.
pub fn legible_value(value: &Value) -> String {
    match value {
        Value::Array(list) if list.len() <= 16 => {
            let text = value.to_string();
            if text.len() <= 60 {
                legible_name(&text, 60)
            } else {
                "a list".into()
            }
        }
        Value::Array(_) => "a list".into(),
        Value::Object(_) => "an object".into(),
        Value::String(text) if text.starts_with(UNREADABLE) => legible_name(&text[1..], 60),
        Value::String(text) => quoted(text),
        other => other.to_string(),
    }
}

pub fn wrong(key: &str, value: &Value, allowed: impl Display) -> String {
    format!(
        "its {key} is {}; it must be {allowed}",
        legible_value(value)
    )
}

/// An integer from 0 up; writers also give it as 2.0.
pub fn whole(value: &Value) -> Option<u64> {
    let from_float = |float: f64| {
        // Doubles hold whole numbers exactly up to here.
        let is_whole = (0.0..=9_007_199_254_740_992.0).contains(&float) && float.fract() == 0.0;
        is_whole.then_some(float as u64)
    };
    value.as_u64().or_else(|| from_float(value.as_f64()?))
}

/// Fields of text, and those of objects: serde reads a list as an object, too.
const TEXTS: [&str; 7] = [
    "name",
    "uri",
    "mimeType",
    "type",
    "path",
    "interpolation",
    "alphaMode",
];
const OBJECTS: [&str; 9] = [
    "extensions",
    "pbrMetallicRoughness",
    "sparse",
    "values",
    "target",
    "perspective",
    "orthographic",
    "spot",
    "attributes",
];

/// Begins the text that stands for a value that serde must not read.
const UNREADABLE: char = '\0';

/// What a value is read as under `key`: without `null`, which some writers give every absent
/// property, and without extras, with integers as such. What serde would take for something else
/// becomes a text, which it refuses.
fn repaired(key: &str, value: &Value) -> Value {
    let is_object = OBJECTS.contains(&key)
        || key.ends_with("Texture")
        || key.starts_with("KHR_")
        || key.starts_with("EXT_");
    match value {
        Value::Object(map) => {
            let fields = map
                .iter()
                .filter(|(key, value)| !value.is_null() && *key != "extras");
            let field = |(key, value): (&String, &Value)| (key.clone(), repaired(key, value));
            Value::Object(fields.map(field).collect())
        }
        Value::Array(_) if is_object => unreadable(value),
        Value::Array(list) => list.iter().map(|value| repaired("", value)).collect(),
        Value::Number(number) if !TEXTS.contains(&key) => {
            let float = number.as_f64().unwrap_or(f64::INFINITY);
            match whole(value) {
                Some(whole) if !float.is_sign_negative() => whole.into(),
                _ if (float as f32).is_finite() => value.clone(),
                _ => unreadable(value),
            }
        }
        other => other.clone(),
    }
}

fn unreadable(value: &Value) -> Value {
    Value::String(format!("{UNREADABLE}{}", legible_value(value)))
}

/// An object of the document.
pub struct Element<'a> {
    notes: &'a Notes,
    /// What messages call it.
    pub name: String,
    given: &'a Object,
    /// Its fields, repaired; some are taken out.
    pub json: Object,
    /// A wrong field is no fault: the standard leaves the choice to us.
    pub is_free: bool,
}

impl<'a> Element<'a> {
    /// The object that a value is.
    ///
    /// # Errors
    /// It is none.
    pub fn of(notes: &'a Notes, name: String, value: &'a Value) -> Result<Self, String> {
        let (Value::Object(given), Value::Object(json)) = (value, repaired("", value)) else {
            let value = legible_value(value);
            return Err(format!("it is {value}; it must be an object"));
        };
        Ok(Self {
            notes,
            name,
            given,
            json,
            is_free: false,
        })
    }

    /// Says that something is left out.
    pub fn fault(&self, reason: impl Display) {
        match self.is_free {
            true => self
                .notes
                .add(|| format!("{}: {reason}; the default is used", self.name)),
            false => self
                .notes
                .fault(|| format!("{}: {reason}; it is left out", self.name)),
        }
    }

    /// What is given, or nothing with a fault.
    pub fn lenient<T>(&self, field: Result<T, String>) -> Option<T> {
        field.map_err(|reason| self.fault(reason)).ok()
    }

    /// A field of the object, or of an extension of it.
    pub fn object(&self, path: &[&str]) -> Option<&Object> {
        let mut object = &self.json;
        for key in path {
            object = object.get(*key)?.as_object()?;
        }
        Some(object)
    }

    /// Fails if the field of `of` is an index beyond a list of `count` `parts`.
    pub fn check_index(
        of: &Object,
        key: &str,
        (parts, count): (&str, usize),
    ) -> Result<(), String> {
        match of.get(key).and_then(Value::as_u64) {
            Some(index) if index >= count as u64 => Err(format!(
                "its {key} is {index}, but there are only {count} {parts}"
            )),
            _ => Ok(()),
        }
    }

    /// Leaves out an index beyond a list.
    pub fn drop_index(&mut self, key: &str, parts: (&str, usize)) {
        if let Err(reason) = Self::check_index(&self.json, key, parts) {
            self.fault(reason);
            self.json.remove(key);
        }
    }

    /// Takes a list out; what is none is left out with a fault.
    pub fn take_list(&mut self, key: &str) -> Vec<Value> {
        match self.json.remove(key) {
            Some(Value::Array(list)) => list,
            Some(_) => {
                self.fault(wrong(key, &self.given[key], "a list"));
                Vec::new()
            }
            None => Vec::new(),
        }
    }

    /// Takes a list of numbers out.
    pub fn take_numbers(&mut self, key: &str) -> Option<Vec<f32>> {
        let numbers = serde_json::from_value(self.json.remove(key)?);
        let wrong = |_| wrong(key, &self.given[key], "a list of numbers below 3.4e38");
        self.lenient(numbers.map_err(wrong))
    }

    /// Takes out the places of parts in a list of `count` `parts`; those that are none are told to
    /// `lost`.
    pub fn take_indices(
        &mut self,
        key: &str,
        (parts, count): (&str, usize),
        mut lost: impl FnMut(&Self, String),
    ) -> Vec<usize> {
        let list = self.take_list(key);
        let mut indices = Vec::with_capacity(list.len());
        for value in list {
            match value.as_u64() {
                Some(index) if index < count as u64 => indices.push(index as usize),
                Some(index) => {
                    let reason =
                        format!("its {key} list {index}, but there are only {count} {parts}");
                    lost(self, reason);
                }
                None => lost(self, wrong(key, &value, "a list of integers from 0 up")),
            }
        }
        indices
    }

    /// Reads it. Without a field of `needed` it is lost; any other that does not fit is left out
    /// with a fault.
    pub fn read<T: DeserializeOwned>(&mut self, needed: &[&str]) -> Result<T, String> {
        loop {
            let error = match serde_path_to_error::deserialize(&self.json) {
                Ok(read) => return Ok(read),
                Err(error) => error,
            };
            let (mut keys, mut is_in_list) = (Vec::new(), false);
            for segment in error.path() {
                match segment {
                    Segment::Map { key } if !is_in_list => keys.push(key.clone()),
                    Segment::Seq { .. } => is_in_list = true,
                    _ => {}
                }
            }
            let reason = self.reason(&keys, is_in_list, &error.inner().to_string());
            if keys
                .first()
                .is_none_or(|key| needed.contains(&key.as_str()))
            {
                return Err(reason);
            }
            self.fault(reason);
            // A texture is nothing without its index.
            if keys.len() > 1 && keys.last().is_some_and(|key| key == "index") {
                keys.pop();
            }
            self.remove(&keys);
        }
    }

    fn reason(&self, keys: &[String], is_in_list: bool, error: &str) -> String {
        let (last, above) = match keys {
            [above @ .., last] => (last.as_str(), above),
            [] => ("", &[][..]),
        };
        let missing = error.strip_prefix("missing field `");
        if let Some(field) = missing.and_then(|rest| rest.split('`').next()) {
            return match last {
                "" => format!("it has no {field}"),
                _ => format!("{last}: it has no {field}"),
            };
        }
        let place = above
            .iter()
            .rev()
            .find(|key| key.ends_with("Texture") || *key == "sparse");
        let place = place.map_or(String::new(), |key| format!("{key}: "));
        let mut given = self.given.get(keys.first().map_or("", String::as_str));
        for key in keys.iter().skip(1) {
            given = given.and_then(|value| value.get(key));
        }
        let allowed = allowed_values(error, is_in_list);
        let reason = wrong(last, given.unwrap_or(&Value::Null), allowed);
        format!("{place}{reason}")
    }

    pub fn remove(&mut self, keys: &[impl AsRef<str>]) {
        let [above @ .., last] = keys else { return };
        let mut object = &mut self.json;
        for key in above {
            match object.get_mut(key.as_ref()).and_then(Value::as_object_mut) {
                Some(below) => object = below,
                None => return,
            }
        }
        object.remove(last.as_ref());
    }

    /// What is wrong with a field.
    pub fn wrong(&self, key: &str, allowed: impl Display) -> String {
        wrong(key, self.given.get(key).unwrap_or(&Value::Null), allowed)
    }

    /// A word or number of a list that the standard knows.
    ///
    /// # Errors
    /// It is another.
    pub fn known<T>(
        &self,
        key: &str,
        value: Checked<T>,
        known: &[impl Display],
    ) -> Result<T, String> {
        match value {
            Checked::Valid(value) => Ok(value),
            Checked::Invalid => {
                let names: Vec<String> = known.iter().map(|known| known.to_string()).collect();
                Err(self.wrong(key, format_args!("one of {}", names.join(", "))))
            }
        }
    }
}

/// What serde expected, in words.
fn allowed_values(error: &str, is_in_list: bool) -> String {
    let expected = error.rsplit_once("expected ").map_or("", |(_, rest)| rest);
    match (expected, is_in_list) {
        ("f32", true) => "numbers below 3.4e38".into(),
        ("f32", false) => "a number below 3.4e38".into(),
        ("a boolean", _) => "true or false".into(),
        ("a string", _) => "a text".into(),
        ("a sequence", _) => "a list".into(),
        ("a map", _) => "an object".into(),
        (text, _) if text.starts_with("struct") => "an object".into(),
        (text, _) if text.starts_with("any of: [") => {
            let list = text["any of: [".len()..].trim_end_matches(']');
            format!("one of {}", list.replace('"', ""))
        }
        (text, _) if text.contains("array") => match text.strip_prefix("an array of length ") {
            Some(count) => format!("{count} numbers below 3.4e38"),
            None => "a list of fewer numbers".into(),
        },
        _ => "an integer from 0 up".into(),
    }
}
