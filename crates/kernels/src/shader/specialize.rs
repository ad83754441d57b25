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
/// Errors: an override is not written as `override NAME: TYPE = DEFAULT;` on a line of its own.
pub fn specialized(
    linked: &Linked,
    overrides: &[String],
    constants: &[(&str, f64)],
) -> Result<String, ShaderError> {
    let (text, replaced) = with_constants(&linked.text, constants);
    let Some(left) = overrides.iter().find(|name| !replaced.contains(name)) else {
        return Ok(text);
    };
    let line = linked
        .text
        .lines()
        .position(|line| line.contains("override") && line.contains(left));
    Err(ShaderError {
        origin: linked.origin(line.unwrap_or(0) as u32 + 1),
        message: format!(
            "write override {left}: TYPE = DEFAULT; on a line of its own, so that it can be given a value"
        ),
    })
}

/// The text with constants, and the names of the overrides that they replace.
pub(super) fn with_constants(text: &str, constants: &[(&str, f64)]) -> (String, Vec<String>) {
    let (mut result, mut replaced) = (String::with_capacity(text.len()), Vec::new());
    for line in text.split_inclusive('\n') {
        let Some(found) = line.strip_prefix("override ").and_then(declared) else {
            result.push_str(line);
            continue;
        };
        let Declared {
            name,
            kind,
            default,
            rest,
        } = found;
        let value = constants
            .iter()
            .find(|(constant, _)| *constant == name)
            .map_or_else(|| default.to_owned(), |(_, value)| literal(kind, *value));
        result.push_str(&format!("const {name}: {kind} = {value};{rest}"));
        replaced.push(name.to_owned());
    }
    (result, replaced)
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

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;
    use crate::shader::{backends::translate, reflect::reflect};

    /// Two lines that gfx-rs/wgpu#7793 is about, in a kernel with an override.
    const TEXT: &str = "override SIDE: u32 = 8u; // a comment
@group(0) @binding(0) var<storage, read_write> result: array<f32>;
@compute @workgroup_size(SIDE)
fn kernel(@builtin(global_invocation_id) id: vec3u) {
    let g = vec2f(0.2, 0.3);
    let shade = vec4f(abs(vec3f(result[id.x])), g.x + 1.0);
    let aspect = g.x / g.y;
    result[id.x + SIDE] = shade.w + aspect;
}
";

    fn linked(text: &str) -> Linked {
        Linked {
            text: text.into(),
            parts: Vec::new(),
        }
    }

    #[test]
    fn overrides_take_their_values_and_lines_keep_their_numbers() {
        let text = "override A: bool = false;\noverride B: i32 = 3; // why\noverride C: f32 = 8.0;\nconst D = 1;\n";
        let names = ["A", "B", "C"].map(str::to_owned);
        let constants = [("A", 1.0), ("C", 0.25), ("E", 7.0)];
        assert_eq!(
            specialized(&linked(text), &names, &constants).expect("specialized"),
            "const A: bool = true;\nconst B: i32 = 3; // why\nconst C: f32 = 0.25;\nconst D = 1;\n"
        );
        let text = "const D = 1;\noverride F = 3u;\n";
        let error = specialized(&linked(text), &["F".to_owned()], &[]).expect_err("refused");
        assert!(error.origin.ends_with(":2"), "{error}");
    }

    #[test]
    fn a_specialized_text_is_translated_where_naga_fails_at_its_overrides() {
        let reflected = reflect(&linked(TEXT), false).expect("valid");
        let folded = naga::back::pipeline_constants::process_overrides(
            &reflected.module,
            &reflected.info,
            None,
            &Default::default(),
        );
        // Where naga is mended, nothing here is needed any more.
        let is_translated = folded.is_ok_and(|(module, info)| translate(&module, &info).is_ok());
        assert!(!is_translated, "naga does not fail at what it has folded");

        let text = specialized(&linked(TEXT), &reflected.overrides(), &[("SIDE", 16.0)]);
        let module = naga::front::wgsl::parse_str(&text.expect("specialized")).expect("valid");
        assert_eq!(module.entry_points[0].workgroup_size, [16, 1, 1]);
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
        let info = validator.validate(&module).expect("valid");
        assert_eq!(translate(&module, &info), Ok(()));
    }
}
