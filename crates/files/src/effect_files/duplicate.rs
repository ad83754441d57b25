//! Duplicates: a built-in effect as an effect file of one's own, under another name. Its struct
//! gets the attributes that say what the registry knows of each parameter.

use std::{fmt::Write, sync::Arc};

use super::{
    template::type_name,
    tokens::{closing, tokens},
    words::LIBRARY,
};
use crate::{
    effects::{Effect, hooks::ImagePass},
    params::{Field, ValueType, format_number},
    shader::{
        image_passes::pass_function,
        library::{Library, sections},
    },
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
    if hooks.vertex.is_some() {
        return Err(
            "moves vertices by more than the sum of its lengths, which an effect file cannot"
                .into(),
        );
    }
    if hooks.casts_shadows {
        return Err("draws the scene from its light, which an effect file cannot".into());
    }
    let file = format!("effects/{}", effect.file_stem());
    let Some(text) = Library::Embedded.text(&file) else {
        return Err("has no text of its own".into());
    };
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
    let group = effect.fields.iter().find_map(|field| field.group);
    let mut result = String::with_capacity(2 * text.len());
    let (mut copied, mut at) = (0, 0);
    while at < tokens.len() {
        let token = tokens[at];
        let next = |ahead: usize| tokens.get(at + ahead).map_or("", |token| token.text);
        let before = if at > 0 { tokens[at - 1].text } else { "" };
        let is_member = before == ".";
        let (replacement, behind) = if token.text == "struct" && next(1) == effect.wgsl_struct {
            let close = closing(&tokens, at + 2);
            (Some(declared(effect, &new_type)), close)
        } else if !is_member
            && token.is_name()
            && next(1) == "."
            && group.is_some_and(|group| group.member == next(2))
        {
            (Some(format!("{}_of({})", next(2), token.text)), at + 2)
        } else if is_member || !token.is_name() {
            (None, at)
        } else if token.text == effect.wgsl_struct {
            (Some(new_type.clone()), at)
        } else if let Some(rest) = token.text.strip_prefix(&old_constants) {
            (Some(format!("{new_constants}{rest}")), at)
        } else {
            let rest = token
                .text
                .strip_prefix(old)
                .filter(|rest| rest.is_empty() || rest.starts_with('_'));
            // A parameter of the effect's own name stays.
            let is_called = next(1) == "(" || before == "fn";
            (
                rest.filter(|_| is_called)
                    .map(|rest| format!("{name}{rest}")),
                at,
            )
        };
        let pass = hooks_pass(effect, token.text).filter(|_| before == "fn");
        if let Some(attributes) = pass {
            // The attribute stands before `fn`, which was not copied yet.
            result.push_str(&text[copied..tokens[at - 1].offset]);
            result.push_str(&attributes);
            copied = tokens[at - 1].offset;
        }
        if let Some(replacement) = replacement {
            result.push_str(&text[copied..token.offset]);
            result.push_str(&replacement);
            copied = tokens[behind].end();
        }
        at = behind + 1;
    }
    result.push_str(&text[copied..]);
    if let Some(group) = group {
        let mut fields: Vec<&Arc<Field>> = effect
            .fields
            .iter()
            .filter(|field| field.group.is_some())
            .collect();
        fields.sort_by_key(|field| field.offset);
        let members: Vec<String> = fields
            .iter()
            .map(|field| format!("p.{}", field.name))
            .collect();
        let (function, kind) = (format!("{}_of", group.member), group.wgsl_struct);
        writeln!(
            result,
            "\nfn {function}(p: {new_type}) -> {kind} {{\n    return {kind}({});\n}}",
            members.join(", ")
        )
        .expect("writing to a string");
    }
    result
}

/// The attributes of the pass that a function of a built-in effect is.
fn hooks_pass(effect: &Effect, function: &str) -> Option<String> {
    let hook = effect.hooks.passes.as_ref()?;
    let index = (0..hook.passes.len()).find(|&index| pass_function(effect, index) == function)?;
    let ImagePass { scale, kept, .. } = &hook.passes[index];
    let size = match scale {
        2 => "@pass(half)\n",
        4 => "@pass(quarter)\n",
        _ => "",
    };
    let kept = kept.map(|earlier| format!("@kept({}, {})\n", earlier.frames, earlier.step_s));
    Some(size.to_owned() + &kept.unwrap_or_default())
}

/// The struct with its documentation and attributes. Choices come first, since the other parameters
/// may depend on them.
fn declared(effect: &Effect, new_type: &str) -> String {
    let words = &effect.defaults;
    let mut fields: Vec<&Arc<Field>> = effect.fields.iter().collect();
    fields.sort_by_key(|field| {
        (
            !matches!(field.value_type, ValueType::Choice(_)),
            field.offset,
        )
    });
    let mut text = format!("struct {new_type} {{\n");
    for field in fields {
        writeln!(
            text,
            "    /// {}\n    {} {}: {},",
            field.doc.trim(),
            attributes(field, words),
            field.name,
            field.wgsl.name()
        )
        .expect("writing to a string");
    }
    text.push('}');
    text
}

/// The attributes of a parameter.
fn attributes(field: &Field, words: &[u32]) -> String {
    let numbers = |numbers: &[f64]| {
        numbers
            .iter()
            .map(|number| format_number(*number))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let default = field.get(words);
    let mut text = match &field.value_type {
        ValueType::Bool => format!("@toggle({})", default[0]),
        ValueType::Choice(choices) => {
            format!(
                "@choice({}) @default({})",
                choices.join(", "),
                choices.get(default[0] as usize).unwrap_or(&choices[0])
            )
        }
        ValueType::Color => format!("@color({})", numbers(&default)),
        ValueType::Point => format!(
            "@point({}) @hard({})",
            numbers(&default),
            numbers(&field.hard)
        ),
        _ => {
            let hard = if field.hard == field.soft {
                String::new()
            } else {
                format!(" @hard({})", numbers(&field.hard))
            };
            format!(
                "@range({}){hard}",
                numbers(&[field.soft[0], field.soft[1], default[0]])
            )
        }
    };
    if !field.unit.is_empty() {
        write!(text, " @unit({})", field.unit).expect("writing to a string");
    }
    if field.log && field.soft[0] > 0.0 {
        text.push_str(" @log");
    }
    if let Some((choice, allowed)) = &field.when {
        write!(text, " @when({choice}, {})", allowed.join(", ")).expect("writing to a string");
    }
    text
}
