//! Effect files. What is read is kept as long as the process runs, so processes of many inputs
//! grow.

use rasterlab::{
    effect_files::{self, EffectError, evaluated},
    shader::library::Library,
};

use super::{Outcome, Target};
use crate::guard::Limit;

pub const TARGET: Target = Target {
    name: "effect",
    about: "effect files",
    views: &[],
    words: WORDS,
    limit: Limit::new(5, 512),
    check,
};

const WORDS: &[&str] = &[
    "fn",
    "struct",
    "let",
    "var",
    "return",
    "loop",
    "for",
    "while",
    "if",
    "else",
    "switch",
    "break",
    "continue",
    "continuing",
    "discard",
    "const",
    "override",
    "alias",
    "@range(0.0, 1.0, 0.5)",
    "@unit(m)",
    "@kept(2, 0.1)",
    "@doc",
    "@group(0) @binding(0)",
    "var<private>",
    "var<workgroup>",
    "var<storage>",
    "ptr<function, f32>",
    "array<f32, 4096>",
    "vec3<f32>",
    "mat4x4<f32>",
    "atomic<u32>",
    "f16",
    "u32",
    "i32",
    "bool",
    "Surface",
    "Vertex",
    "Sample",
    "surface",
    "position",
    "color",
    "normal",
    "image_previous",
    "image_kept",
    "dpdx",
    "textureLoad",
    "bitcast<u32>",
    "select",
    "pow",
    "0x1p-149",
    "1e38f",
    "0u",
    "/*",
    "*/",
    "//@ use lib/surface",
    "//@ use lib/noise",
    "enable f16;",
    "diagnostic(off, derivative_uniformity);",
    "_",
    "__x",
    "ink",
    "Ink",
];

fn check(bytes: &[u8]) -> Outcome {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return Err("it is no UTF-8".into());
    };
    let effect = effect_files::read("ink.wgsl", "ink", text).map_err(
        |EffectError { message, place, .. }| {
            let shown = place.map(|place| place.text).unwrap_or_default();
            assert!(
                shown.chars().count() <= 200 && !shown.chars().any(char::is_control),
                "the line is shown as {shown:?}"
            );
            message
        },
    )?;
    // A file that needs what the evaluator lacks is refused when it is read.
    evaluated(&Library::of_process(), &effect)
        .unwrap_or_else(|error| panic!("it was read and cannot be evaluated: {error}"));
    Ok(())
}
