//! Glue: the only generated WGSL. The `Effects` uniform, constants for choices, and one call chain per hook.

use std::fmt::Write;

use crate::{
    effects::{Effect, Enabled},
    params::Kind,
    shader::library::Library,
};

/// Bytes from the start of one effect's parameters to the next are a multiple of this (WGSL, uniform address space).
const MEMBER_ALIGN: usize = 16;

/// The generated text for the enabled effects, in order. With none there is no struct and no binding.
pub fn glue(effects: &[&'static Effect]) -> String {
    let mut text = String::new();
    for effect in effects {
        for field in effect.fields {
            if let Kind::Choice(words) = field.kind {
                for (index, word) in words.iter().enumerate() {
                    let name = format!("{}_{}_{word}", effect.name, field.name).to_uppercase().replace('-', "_");
                    writeln!(text, "const {name} = {index}u;").expect("writing to a string");
                }
            }
        }
    }
    if !effects.is_empty() {
        text.push_str("struct Effects {\n");
        for effect in effects {
            writeln!(text, "    @align({MEMBER_ALIGN}) {}: {},", effect.name, effect.wgsl_struct).expect("writing to a string");
        }
        text.push_str("}\n@group(0) @binding(12) var<uniform> effects: Effects;\n");
    }
    text.push_str("fn glue_surface(surface: Surface) -> Surface {\n    var s = surface;\n");
    for effect in effects {
        writeln!(text, "    s = {0}(s, effects.{0});", effect.name).expect("writing to a string");
    }
    text.push_str("    return s;\n}\n");
    text
}

/// Does the effect's WGSL read this member of the surface?
pub fn reads(library: &Library, effect: &Effect, member: &str) -> bool {
    // Without its text the effect cannot be linked; then it hardly matters.
    library.text(&format!("effects/{}", effect.name)).is_none_or(|text| text.contains(&format!(".{member}")))
}

/// Bytes of the `Effects` uniform for this stack; empty when there is none.
pub fn uniform_bytes(stack: &[Enabled]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for enabled in stack {
        bytes.extend_from_slice(bytemuck::cast_slice(&enabled.words));
        bytes.resize(bytes.len().next_multiple_of(MEMBER_ALIGN), 0);
    }
    bytes
}
