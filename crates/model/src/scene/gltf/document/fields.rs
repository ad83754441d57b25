//! Fields of JSON objects: each is read as one type, or the reason why it cannot be is told.

use std::fmt::Display;

use serde_json::{Map, Value};

use super::super::{error::quoted, notes::Notes};
use crate::legible::legible_name;

/// The end of a sentence: what is wrong with a field.
pub type Field<T> = Result<Option<T>, String>;

/// A JSON object.
#[derive(Clone, Copy)]
pub struct Object<'a>(&'a Map<String, Value>);

/// What is neither there nor `null`: some writers give every absent property that value.
fn present<'a>(map: &'a Map<String, Value>, key: &str) -> Option<&'a Value> {
    map.get(key).filter(|value| !value.is_null())
}

/// A value as a sentence shows it.
fn shown(value: &Value) -> String {
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
        Value::String(text) => quoted(text),
        other => other.to_string(),
    }
}

fn wrong(key: &str, value: &Value, allowed: impl Display) -> String {
    format!("its {key} is {}; it must be {allowed}", shown(value))
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

/// A number that f32 can hold.
fn number(value: &Value) -> Option<f32> {
    let number = value.as_f64()? as f32;
    number.is_finite().then_some(number)
}

impl<'a> Object<'a> {
    /// The object that a value is.
    ///
    /// # Errors
    /// It is none.
    pub fn of(value: &'a Value) -> Result<Self, String> {
        let wrong = || format!("it is {}; it must be an object", shown(value));
        value.as_object().map(Self).ok_or_else(wrong)
    }

    fn read<T>(
        self,
        key: &str,
        allowed: impl Display,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> Field<T> {
        let Some(value) = present(self.0, key) else {
            return Ok(None);
        };
        read(value)
            .map(Some)
            .ok_or_else(|| wrong(key, value, allowed))
    }

    /// What stands there, of any type.
    pub fn value(self, key: &str) -> Option<&'a Value> {
        present(self.0, key)
    }

    pub fn integer(self, key: &str) -> Field<u64> {
        self.read(key, "an integer from 0 up", whole)
    }

    pub fn number(self, key: &str) -> Field<f32> {
        self.read(key, "a number below 3.4e38", number)
    }

    pub fn flag(self, key: &str) -> Field<bool> {
        self.read(key, "true or false", Value::as_bool)
    }

    pub fn text(self, key: &str) -> Field<&'a str> {
        self.read(key, "a text", Value::as_str)
    }

    pub fn object(self, key: &str) -> Field<Self> {
        self.read(key, "an object", |value| value.as_object().map(Self))
    }

    /// The values of a list; none where it is not there.
    pub fn list(self, key: &str) -> Result<&'a [Value], String> {
        let list = self.read(key, "a list", |value| value.as_array().map(Vec::as_slice));
        list.map(Option::unwrap_or_default)
    }

    pub fn numbers(self, key: &str) -> Field<Vec<f32>> {
        self.read(key, "a list of numbers below 3.4e38", |value| {
            value.as_array()?.iter().map(number).collect()
        })
    }

    /// Exactly `N` numbers.
    pub fn vector<const N: usize>(self, key: &str) -> Field<[f32; N]> {
        self.read(key, format_args!("{N} numbers below 3.4e38"), |value| {
            let numbers: Vec<f32> = value
                .as_array()?
                .iter()
                .map(number)
                .collect::<Option<_>>()?;
            numbers.try_into().ok()
        })
    }

    /// The place of a part in a list of `count` `parts`.
    pub fn index(self, key: &str, parts: &str, count: usize) -> Field<usize> {
        match self.integer(key)? {
            Some(index) if index >= count as u64 => Err(format!(
                "its {key} is {index}, but there are only {count} {parts}"
            )),
            index => Ok(index.map(|index| index as usize)),
        }
    }

    /// The places of parts in a list of `count` `parts`; those that are none are told to `lost`.
    pub fn indices(
        self,
        key: &str,
        (parts, count): (&str, usize),
        mut lost: impl FnMut(String),
    ) -> Result<Vec<usize>, String> {
        let mut indices = Vec::new();
        for value in self.list(key)? {
            match whole(value) {
                Some(index) if index < count as u64 => indices.push(index as usize),
                Some(index) => lost(format!(
                    "its {key} list {index}, but there are only {count} {parts}"
                )),
                None => lost(wrong(key, value, "a list of integers from 0 up")),
            }
        }
        Ok(indices)
    }

    /// One of the numbers of `known`.
    pub fn choice<T: Copy>(self, key: &str, known: &[(u64, T)]) -> Field<T> {
        self.one_of(key, known, |value, number| whole(value) == Some(*number))
    }

    /// One of the words of `known`.
    pub fn word<T: Copy>(self, key: &str, known: &[(&str, T)]) -> Field<T> {
        self.one_of(key, known, |value, word| value.as_str() == Some(word))
    }

    fn one_of<K: Display, T: Copy>(
        self,
        key: &str,
        known: &[(K, T)],
        is: impl Fn(&Value, &K) -> bool,
    ) -> Field<T> {
        let Some(value) = present(self.0, key) else {
            return Ok(None);
        };
        match known.iter().find(|(known, _)| is(value, known)) {
            Some((_, choice)) => Ok(Some(*choice)),
            None => {
                let names: Vec<String> = known.iter().map(|(known, _)| known.to_string()).collect();
                Err(wrong(
                    key,
                    value,
                    format_args!("one of {}", names.join(", ")),
                ))
            }
        }
    }

    /// An extension of the object.
    pub fn extension(self, name: &str) -> Field<Self> {
        match self.object("extensions")? {
            Some(extensions) => extensions.object(name),
            None => Ok(None),
        }
    }

    /// The object as a type that serde reads.
    pub fn parsed<T: serde::de::DeserializeOwned>(self) -> Result<T, serde_json::Error> {
        T::deserialize(self.0)
    }

    /// The keys of the object with their values, without `null`.
    pub fn entries(self) -> impl Iterator<Item = (&'a str, &'a Value)> {
        let entry = |(key, value): (&'a String, &'a Value)| {
            (!value.is_null()).then_some((key.as_str(), value))
        };
        self.0.iter().filter_map(entry)
    }
}

/// What a part cannot be without.
pub fn needed<T>(key: &str, field: Field<T>) -> Result<T, String> {
    field?.ok_or_else(|| format!("it has no {key}"))
}

/// Reads fields that a part keeps its meaning without: a wrong one is left out with a fault.
pub struct Lenient<'a> {
    pub notes: &'a Notes,
    /// What messages call the part.
    pub name: String,
}

impl Lenient<'_> {
    /// A message about the part.
    pub fn fault(&self, reason: impl Display) {
        self.notes
            .fault(|| format!("{}: {reason}; it is left out", self.name));
    }

    /// The field, or nothing where it is wrong.
    pub fn field<T>(&self, field: Field<T>) -> Option<T> {
        field.unwrap_or_else(|reason| {
            self.fault(reason);
            None
        })
    }

    /// The list, or an empty one where it is wrong.
    pub fn list<T: Default>(&self, list: Result<T, String>) -> T {
        list.unwrap_or_else(|reason| {
            self.fault(reason);
            T::default()
        })
    }
}
