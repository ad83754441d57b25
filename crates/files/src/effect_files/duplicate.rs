//! Duplicates: a built-in effect as an effect file of one's own, under another name. It is the text of
//! the effect with other names.

use super::{
    declaration::{self, Author, type_name},
    error::Text,
    tokens::tokens,
    twin::lengths,
    words::LIBRARY,
};
use crate::{
    effects::Effect,
    shader::library::{Library, sections},
};

/// The text of an effect file `name` that does what `effect` does.
///
/// # Errors
/// Completes a sentence that begins with the name of `effect`: it does something that an effect
/// file cannot.
pub fn duplicate(effect: &Effect, name: &str) -> Result<String, String> {
    if let Some(source) = &effect.source {
        return Ok(with_constants(&source.stem, name, &source.shared()));
    }
    let hooks = &effect.hooks;
    if hooks.slot.is_some() || hooks.has_lines || hooks.particle_settings.is_some() {
        return Err("replaces a part of the rasterizer, which an effect file cannot".into());
    }
    if hooks.sample.as_ref().is_some_and(|hook| hook.has_setup) {
        return Err("computes a setup for every triangle, which an effect file cannot".into());
    }
    if hooks.casts_shadows {
        return Err("draws the scene from its light, which an effect file cannot".into());
    }
    let file = format!("effects/{}", effect.file_stem());
    let Some(text) = Library::Embedded.text(&file) else {
        return Err("has no text of its own".into());
    };
    if hooks.vertex.is_some() {
        let whole = Text {
            file: &file,
            text: &text[sections(&text)[0].1.clone()],
        };
        let read = declaration::read(&whole, effect.file_stem(), Author::Lab);
        let reach = read.ok().and_then(|read| read.reach);
        if reach.as_ref().is_some_and(|reach| reach.takes_radius) {
            return Err(
                "moves vertices as far as a model is wide, which an effect file cannot".into(),
            );
        }
        if reach.is_none() && lengths(&effect.fields).next().is_none() {
            return Err("rounds the places of vertices, which an effect file cannot".into());
        }
    }
    // The light that comes with a scene does not shine on an effect file: neither its lights nor the
    // picture of its surroundings.
    let text = &text[sections(&text)[0].1.clone()]
        .replace("//@ use variants/surroundings\n", "")
        .replace(
            "surroundings_irradiance(p.environment, ",
            "environment_irradiance(",
        )
        .replace(
            "surroundings_radiance(p.environment, ",
            "environment_radiance(",
        );
    let used = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("//@ use lib/"));
    if let Some(closed) = used
        .into_iter()
        .find(|used| !LIBRARY.contains(&used.trim()))
    {
        return Err(format!("uses lib/{closed}, which an effect file cannot"));
    }
    Ok(renamed(effect, name, text))
}

/// The text of an effect file with the constants of its choices, which begin with its name,
/// renamed.
fn with_constants(old: &str, name: &str, text: &str) -> String {
    let (old, new) = (
        format!("{}_", old.to_uppercase()),
        format!("{}_", name.to_uppercase()),
    );
    let (mut result, mut copied) = (String::with_capacity(text.len()), 0);
    for token in tokens(text) {
        if let Some(rest) = token.text.strip_prefix(&old) {
            result.push_str(&text[copied..token.offset]);
            result.push_str(&new);
            result.push_str(rest);
            copied = token.end();
        }
    }
    result.push_str(&text[copied..]);
    result
}

/// The text with the names of `effect` replaced by those that follow from `name`.
fn renamed(effect: &Effect, name: &str, text: &str) -> String {
    let (old, old_constants, new_constants) = (
        effect.file_stem(),
        format!("{}_", effect.file_stem().to_uppercase()),
        format!("{}_", name.to_uppercase()),
    );
    let new_type = type_name(name);
    let tokens = tokens(text);
    let mut result = String::with_capacity(2 * text.len());
    let mut copied = 0;
    for (at, token) in tokens.iter().enumerate() {
        let next = tokens.get(at + 1).map_or("", |token| token.text);
        let before = if at > 0 { tokens[at - 1].text } else { "" };
        let replacement = if before == "." || !token.is_name() {
            None
        } else if token.text == effect.wgsl_struct {
            Some(new_type.clone())
        } else if let Some(rest) = token.text.strip_prefix(&old_constants) {
            Some(format!("{new_constants}{rest}"))
        } else {
            let rest = token
                .text
                .strip_prefix(old)
                .filter(|rest| rest.is_empty() || rest.starts_with('_'));
            // A parameter of the effect's own name stays.
            let is_called = next == "(" || before == "fn";
            rest.filter(|_| is_called)
                .map(|rest| format!("{name}{rest}"))
        };
        if let Some(replacement) = replacement {
            result.push_str(&text[copied..token.offset]);
            result.push_str(&replacement);
            copied = token.end();
        }
    }
    result.push_str(&text[copied..]);
    result
}
