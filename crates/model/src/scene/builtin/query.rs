//! Built-in scenes as table rows, and their queries: parses `name?parameter=value&parameter=value`
//! and checks it.

use std::ops::RangeInclusive;

use crate::scene::model::Scene;

/// A parameter of a built-in scene, as listings show it.
#[derive(Clone, Debug)]
pub struct BuiltinParam {
    pub name: &'static str,
    /// One line for listings.
    pub doc: &'static str,
    /// Value if the query does not give one.
    pub default: f64,
    /// Allowed values.
    pub range: RangeInclusive<f64>,
    /// Only whole numbers are allowed.
    pub whole: bool,
}

/// A built-in scene, as listings show it.
pub struct Builtin {
    pub name: &'static str,
    /// One line for listings.
    pub about: &'static str,
    pub params: &'static [BuiltinParam],
    pub(super) build: fn(&Values) -> Result<Scene, BuiltinError>,
}

/// An unknown built-in scene or parameter, or a value outside its range; one sentence.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BuiltinError(pub String);

/// The most triangles of a built-in scene: its indices and its vertices stay below 128 MiB each.
pub const MAX_TRIANGLES: u64 = 10_000_000;

/// The most triangles of a sphere, which measures how large scenes are drawn; the memory budget may
/// allow fewer.
pub const MAX_TRIANGLES_OF_SPHERE: u64 = 100_000_000;

/// A parameter of whole numbers.
pub(super) const fn whole(
    name: &'static str,
    doc: &'static str,
    default: f64,
    range: RangeInclusive<f64>,
) -> BuiltinParam {
    BuiltinParam {
        name,
        doc,
        default,
        range,
        whole: true,
    }
}

/// A parameter of real numbers.
pub(super) const fn real(
    name: &'static str,
    doc: &'static str,
    default: f64,
    range: RangeInclusive<f64>,
) -> BuiltinParam {
    BuiltinParam {
        name,
        doc,
        default,
        range,
        whole: false,
    }
}

/// The values of all parameters of a built-in scene, each within its range.
pub struct Values {
    builtin: &'static Builtin,
    values: Vec<f64>,
}

impl Values {
    /// The value of the parameter `name`.
    ///
    /// # Panics
    /// If the scene has no such parameter.
    pub fn get(&self, name: &str) -> f64 {
        let at = self
            .builtin
            .params
            .iter()
            .position(|param| param.name == name)
            .expect("a builtin asks for parameters of its own table");
        self.values[at]
    }

    /// The value of a whole-number parameter.
    pub fn whole(&self, name: &str) -> u32 {
        self.get(name) as u32
    }
}

/// Finds the built-in scene of a query and checks every value.
pub fn parse(
    builtins: &'static [Builtin],
    query: &str,
) -> Result<(&'static Builtin, Values), BuiltinError> {
    let (name, pairs) = query.trim().split_once('?').unwrap_or((query.trim(), ""));
    let builtin = builtins
        .iter()
        .find(|builtin| builtin.name == name)
        .ok_or_else(|| {
            BuiltinError(unknown(
                "there is no built-in scene",
                name,
                builtins.iter().map(|b| b.name).collect(),
            ))
        })?;
    let mut values: Vec<Option<f64>> = vec![None; builtin.params.len()];
    for pair in pairs.split('&').filter(|pair| !pair.is_empty()) {
        let (key, text) = pair.split_once('=').ok_or_else(|| {
            BuiltinError(format!(
                "{name}: {} must have the form parameter=value",
                quoted(pair)
            ))
        })?;
        let Some(at) = builtin.params.iter().position(|param| param.name == key) else {
            let known = builtin.params.iter().map(|param| param.name).collect();
            return Err(BuiltinError(unknown(
                &format!("{name} has no parameter"),
                key,
                known,
            )));
        };
        if values[at]
            .replace(check_value(name, &builtin.params[at], text)?)
            .is_some()
        {
            return Err(BuiltinError(format!(
                "{name}: {key} is given twice; remove one"
            )));
        }
    }
    let values = values
        .iter()
        .zip(builtin.params)
        .map(|(value, param)| value.unwrap_or(param.default))
        .collect();
    Ok((builtin, Values { builtin, values }))
}

fn check_value(builtin: &str, param: &BuiltinParam, text: &str) -> Result<f64, BuiltinError> {
    let kind = if param.whole {
        "a whole number"
    } else {
        "a number"
    };
    let shown = quoted(text);
    let shown = shown.trim_matches('"');
    let (low, high) = (param.range.start(), param.range.end());
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && !(param.whole && value.fract() != 0.0) => {
            if param.range.contains(&value) {
                return Ok(value);
            }
            Err(BuiltinError(format!(
                "{builtin}: {}={} must be {kind} from {low} to {high}",
                param.name, shown
            )))
        }
        _ => Err(BuiltinError(format!(
            "{builtin}: {}={} must be {kind} from {low} to {high}",
            param.name, shown
        ))),
    }
}

/// A sentence with the unknown name, the most similar known one, and all known names.
fn unknown(what: &str, requested: &str, known: Vec<&str>) -> String {
    let requested: String = requested.chars().take(60).collect();
    let requested = requested.as_str();
    let near = known
        .iter()
        .map(|name| (strsim::damerau_levenshtein(name, requested), name))
        .min();
    let hint = match near {
        Some((distance, name)) if distance <= 2.max(name.len() / 3) => {
            format!("; did you mean \"{name}\"?")
        }
        _ => String::new(),
    };
    let list = if known.is_empty() {
        "none".into()
    } else {
        known.join(", ")
    };
    format!("{what} {}{hint} (known: {list})", quoted(requested))
}

/// A piece of a query as a message shows it: in quotes, without control characters, at most 60
/// characters.
fn quoted(text: &str) -> String {
    format!("{:?}", text.chars().take(60).collect::<String>())
}
