//! Specializing: the overrides of a linked text become constants, before any compiler reads it.
//!
//! naga can give overrides their values when a pipeline is made, but then it folds every expression
//! of constants in functions, also what `let` keeps from being one, and its writer of SPIR-V panics
//! at what is left (<https://github.com/gfx-rs/wgpu/issues/7793>). A text without overrides takes
//! another way.

use super::{
    link::Linked,
    reflect::{Reflected, ShaderError},
};

/// The text with a constant in place of every override: with the value that `constants` gives, else
/// with the default. Lines keep their numbers. `overrides` are the names that the text declares, as
/// [`Reflected::overrides`] has them.
///
/// # Errors
/// An override is not written as `override NAME: TYPE = DEFAULT;` on a line of its own.
pub fn specialized(
    linked: &Linked,
    overrides: &[String],
    constants: &[(&str, f64)],
) -> Result<String, ShaderError> {
    let mut text = String::with_capacity(linked.text.len());
    let mut left: Vec<&str> = overrides.iter().map(String::as_str).collect();
    for line in linked.text.split_inclusive('\n') {
        let declared = line.strip_prefix("override ").and_then(declared);
        let Some(Declared {
            name,
            kind,
            default,
            rest,
        }) = declared
        else {
            text.push_str(line);
            continue;
        };
        left.retain(|one| *one != name);
        let value = constants
            .iter()
            .find(|(constant, _)| *constant == name)
            .map_or_else(|| default.to_owned(), |(_, value)| literal(kind, *value));
        text.push_str(&format!("const {name}: {kind} = {value};{rest}"));
    }
    match left.first() {
        None => Ok(text),
        Some(name) => {
            let line = linked
                .text
                .lines()
                .position(|line| line.contains("override") && line.contains(name));
            Err(ShaderError {
                origin: linked.origin(line.unwrap_or(0) as u32 + 1),
                message: format!(
                    "write override {name}: TYPE = DEFAULT; on a line of its own, so that it can be given a value"
                ),
            })
        }
    }
}

/// An override's declaration.
struct Declared<'a> {
    name: &'a str,
    kind: &'a str,
    default: &'a str,
    /// What follows the semicolon.
    rest: &'a str,
}

fn declared(line: &str) -> Option<Declared<'_>> {
    let (declaration, rest) = line.split_once(';')?;
    let (head, default) = declaration.split_once('=')?;
    let (name, kind) = head.split_once(':')?;
    Some(Declared {
        name: name.trim(),
        kind: kind.trim(),
        default: default.trim(),
        rest,
    })
}

/// A number as WGSL writes it for a type.
fn literal(kind: &str, value: f64) -> String {
    match kind {
        "bool" => (value != 0.0).to_string(),
        "u32" | "i32" => format!("{}", value as i64),
        _ => format!("{:?}", value as f32),
    }
}

impl Reflected {
    /// Names of the overrides that the text declares.
    pub fn overrides(&self) -> Vec<String> {
        self.module
            .overrides
            .iter()
            .filter_map(|(_, one)| one.name.clone())
            .collect()
    }
}
