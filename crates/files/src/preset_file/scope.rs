//! The key `on` in the table of an effect: the parts of the scene to which the effect is limited.

use toml_edit::Value as Toml;

use crate::{
    effects::Effect,
    scene::parts::{MAX_PATTERNS, Scope},
};

/// In an effect's table: patterns of the parts that it changes.
pub const SCOPE_KEY: &str = "on";

/// The scope that `toml` gives `effect`: a list of patterns, or one pattern. An empty list is the
/// whole scene.
///
/// # Errors
/// Completes a sentence that begins with the name of the key: a value of another type, a faulty
/// pattern, too many patterns, or an effect that cannot be limited.
pub fn read(toml: &Toml, effect: &Effect) -> Result<Scope, String> {
    let malformed = || {
        r#"must be a list of patterns such as ["material:Lens*", "node:Body", "mesh:Helmet"]"#
            .to_owned()
    };
    let texts: Vec<String> = match toml {
        Toml::String(text) => vec![text.value().clone()],
        Toml::Array(list) => list
            .iter()
            .map(|text| text.as_str().map(str::to_owned))
            .collect::<Option<_>>()
            .ok_or_else(malformed)?,
        _ => return Err(malformed()),
    };
    if texts.len() > MAX_PATTERNS {
        return Err(format!(
            "has {} patterns; at most {MAX_PATTERNS} are allowed",
            texts.len()
        ));
    }
    let scope = Scope::of_texts(&texts)?;
    if !scope.is_whole_scene() {
        check(effect)?;
    }
    Ok(scope)
}

/// Can the effect be limited to parts?
pub fn check(effect: &Effect) -> Result<(), String> {
    if effect.has_scope() {
        return Ok(());
    }
    Err(format!(
        "cannot be set, because {} acts on {}; only effects on the hooks vertex, sample and surface alone can be limited to parts of the scene",
        effect.name,
        effect.hooks.names()
    ))
}

/// The value that [`read`] takes back to the same scope; none for the whole scene.
pub fn write(scope: &Scope) -> Option<Toml> {
    (!scope.is_whole_scene()).then(|| scope.texts().into_iter().collect())
}
