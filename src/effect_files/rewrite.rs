//! Rewriting: the text of an effect file as it is linked. Attributes are blanked, names that the file declares get a prefix of
//! their own, and every loop counts its turns.

use std::fmt::Write;

use super::declaration::Declaration;
use crate::{
    effects::HookFunctions,
    params::{Field, ValueType},
};

/// Turns that the loops of one effect may take together in one invocation; every loop ends then.
pub const MAX_TURNS: u32 = 4096;

/// The text with its attributes blanked, so that lines and columns stay, and with the files that its hooks' types come from.
pub fn plain(text: &str, declaration: &Declaration<'_>) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for range in &declaration.parameters.attributes {
        for byte in &mut bytes[range.clone()] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
    }
    let mut plain = String::from_utf8(bytes).expect("whole characters were replaced");
    // Directives at the end move no line.
    if !plain.ends_with('\n') {
        plain.push('\n');
    }
    for used in &declaration.uses {
        if !text
            .lines()
            .any(|line| line.trim().strip_prefix("//@").is_some_and(|rest| rest.trim().strip_prefix("use ").map(str::trim) == Some(used)))
        {
            writeln!(plain, "//@ use {used}").expect("writing to a string");
        }
    }
    plain
}

/// The name that `declared` of the file `stem` has in a linked module.
pub fn unique(stem: &str, declared: &str) -> String {
    format!("custom_{stem}_{declared}")
}

/// The text that is linked into kernels, and its functions on the hooks. `plain` is the file after [`plain`].
pub fn linked(stem: &str, plain: &str, declaration: &Declaration<'_>) -> (String, HookFunctions) {
    let tokens = &declaration.tokens;
    let counter = unique(stem, "turns");
    let mut text = String::with_capacity(2 * plain.len());
    let (mut copied, mut in_struct, mut has_loops) = (0, None, false);
    let mut loop_depth: Option<usize> = None;
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate() {
        let before = if index > 0 { tokens[index - 1].text } else { "" };
        let next = tokens.get(index + 1).map_or("", |token| token.text);
        match token.text {
            "(" | "[" => depth += 1,
            ")" | "]" => depth = depth.saturating_sub(1),
            "struct" if in_struct.is_none() => in_struct = Some(false),
            "}" => in_struct = None,
            "loop" | "for" | "while" if before != "." => loop_depth = Some(depth),
            _ => {}
        }
        if token.text == "{" {
            if let Some(opened) = &mut in_struct {
                *opened = true;
            }
            if loop_depth == Some(depth) {
                text.push_str(&plain[copied..token.end()]);
                write!(text, " {counter} += 1u; if {counter} > {MAX_TURNS}u {{ break; }}").expect("writing to a string");
                (copied, loop_depth, has_loops) = (token.end(), None, true);
            }
            continue;
        }
        let is_attribute = declaration.parameters.attributes.iter().any(|range| range.contains(&token.offset));
        let is_member_name = in_struct == Some(true) && next == ":";
        if token.is_name() && declaration.declared.contains(token.text) && before != "." && !is_member_name && !is_attribute {
            text.push_str(&plain[copied..token.offset]);
            text.push_str(&unique(stem, token.text));
            copied = token.end();
        }
    }
    text.push_str(&plain[copied..]);
    let reset = if has_loops { format!("    {counter} = 0u;\n") } else { String::new() };
    if has_loops {
        writeln!(text, "var<private> {counter}: u32 = 0u;").expect("writing to a string");
    }
    let parameters = unique(stem, declaration.struct_name);
    let mut wrapped = |name: &Option<String>, hook: &str, kind: &str, result: &str| {
        let (called, wrapper) = (unique(stem, name.as_ref()?), unique(stem, &format!("hook_{hook}")));
        let body = match hook {
            "vertex" => format!("    let moved = {called}(v, p);\n{}", limited(declaration)),
            _ => format!("    return {called}(v, p);\n"),
        };
        write!(text, "fn {wrapper}(v: {kind}, p: {parameters}) -> {result} {{\n{reset}{body}}}\n").expect("writing to a string");
        Some(wrapper)
    };
    let hooks = &declaration.hooks;
    let functions = HookFunctions {
        vertex: wrapped(&hooks.vertex, "vertex", "Vertex", "Vertex"),
        sample: wrapped(&hooks.sample, "sample", "Sample", "bool"),
        sample_setup: None,
        surface: wrapped(&hooks.surface, "surface", "Surface", "Surface"),
        image: wrapped(&hooks.image, "image", "Pixel", "Pixel"),
    };
    (text, functions)
}

/// Lengths among the parameters: a vertex effect moves a vertex by at most their sum.
pub fn lengths(fields: &[Field]) -> impl Iterator<Item = &Field> {
    fields.iter().filter(|field| field.unit == "m" && field.value_type == ValueType::F32)
}

/// The end of a vertex hook: it changes offset and normal alone, and the offset by at most the sum of the lengths.
fn limited(declaration: &Declaration<'_>) -> String {
    let lengths: Vec<String> = lengths(declaration.parameters.fields).map(|field| format!("abs(p.{})", field.name)).collect();
    format!(
        "    let change = clamp(moved.offset - v.offset, vec3f(-1e12), vec3f(1e12));
    let distance = length(change);
    let limit = {};
    var kept = v;
    kept.normal = moved.normal;
    kept.offset = select(moved.offset, v.offset + change * (limit / max(distance, 1e-30)), distance > limit);
    return kept;
",
        lengths.join(" + ")
    )
}
