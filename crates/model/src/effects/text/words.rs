//! Words: names that an effect may not declare, and words of WGSL that only kernels may use.

use std::collections::BTreeMap;

use naga::keywords::wgsl::{BUILTIN_IDENTIFIERS, RESERVED};

use super::{
    error::{EffectError, Text},
    tokens::Token,
};

/// Files of `shaders/lib` that an effect file may use: pure functions and the types of hooks.
pub const LIBRARY: [&str; 15] = [
    "angle",
    "bayer",
    "color",
    "environment",
    "front",
    "hash",
    "image",
    "image_direction",
    "image_file",
    "image_pass",
    "lattice",
    "noise",
    "sample",
    "surface",
    "vertex",
];

/// Is it a word of the language: a keyword, or reserved for one?
pub fn is_reserved(name: &str) -> bool {
    RESERVED.contains(&name) || name == "_" || name.starts_with("__")
}

/// Is it the name of a function or type that WGSL itself declares?
pub fn is_predeclared(name: &str) -> bool {
    // vec3f, mat4x4f and the like are short names of types.
    let is_short = name
        .strip_suffix(['f', 'h', 'i', 'u'])
        .is_some_and(|name| BUILTIN_IDENTIFIERS.contains(&name));
    BUILTIN_IDENTIFIERS.contains(&name) || is_short
}

/// Refuses names at module scope that mean something else, or stand there twice.
pub fn check_declared(text: &Text<'_>, declared: &[Token<'_>]) -> Result<(), EffectError> {
    let mut known = BTreeMap::new();
    for name in declared {
        let reason = if is_reserved(name.text) {
            "is a reserved word of WGSL; choose another name".to_owned()
        } else if is_predeclared(name.text) {
            "is a function or type of WGSL itself; choose another name".to_owned()
        } else if let Some(line) = known.insert(name.text, text.line(name.offset)) {
            format!("is already declared in line {line}; choose another name")
        } else {
            continue;
        };
        return Err(text.at(name, format!("{} {reason}", name.text)));
    }
    Ok(())
}

/// Refuses what only kernels may do. Names that the file declares are its own.
pub fn refuse(
    text: &Text<'_>,
    tokens: &[Token<'_>],
    declared: &[Token<'_>],
) -> Result<(), EffectError> {
    const WORDS: [(&str, &str); 9] = [
        ("workgroupBarrier", "barriers"),
        ("storageBarrier", "barriers"),
        ("textureBarrier", "barriers"),
        ("workgroupUniformLoad", "workgroup memory"),
        ("workgroup", "workgroup memory"),
        ("storage", "bindings"),
        ("uniform", "bindings"),
        ("arrayLength", "bindings"),
        ("private", "variables outside functions"),
    ];
    const BEGINNINGS: [(&str, &str); 8] = [
        ("atomic", "atomics"),
        ("texture", "textures"),
        ("sampler", "textures"),
        ("dpdx", "derivatives"),
        ("dpdy", "derivatives"),
        ("fwidth", "derivatives"),
        ("subgroup", "subgroup operations"),
        ("quad", "subgroup operations"),
    ];
    for (index, token) in tokens.iter().enumerate() {
        let is_member = index > 0 && tokens[index - 1].text == ".";
        // A word of the language stands before a parenthesis or inside angle brackets; anything
        // else is a name of the author's.
        let next = tokens.get(index + 1).map_or("", |token| token.text);
        let before = if index > 0 {
            tokens[index - 1].text
        } else {
            ""
        };
        if token.text == "discard" && !is_member {
            let message = "discard: an effect removes no invocation; a function on the hook Sample returns false to leave a sample out";
            return Err(text.at(token, message));
        }
        let is_used = next == "(" || next == "<" || before == "<" || before == ":";
        if is_member || !is_used || declared.iter().any(|name| name.text == token.text) {
            continue;
        }
        let word = WORDS.iter().find(|(word, _)| *word == token.text);
        let begun = BEGINNINGS.iter().find(|(begin, _)| {
            token.text.strip_prefix(begin).is_some_and(|rest| {
                rest.is_empty()
                    || rest.starts_with(|c: char| {
                        c.is_ascii_uppercase() || c == '_' || c.is_ascii_digit()
                    })
            })
        });
        if let Some((_, what)) = word.or(begun) {
            return Err(text.at(
                token,
                format!(
                    "{}: an effect has no {what}; it is a pure function of its arguments",
                    token.text
                ),
            ));
        }
    }
    Ok(())
}
