//! Rewriting: the text of an effect file as it is linked. Attributes are blanked, names that the
//! file declares get a prefix of their own, and every loop counts its turns.

use std::fmt::Write;

use super::{
    declaration::Declaration,
    twin::{MOST_REACH_M, lengths},
};
use crate::effects::{EffectSource, HookFunctions};

/// Turns that the loops of one effect may take together in one invocation; every loop ends then.
pub const MAX_TURNS: u32 = 4096;

/// The text that is linked into kernels, and the way back from its bytes to those of the file.
pub struct Rewritten {
    pub text: String,
    /// The functions on the hooks.
    pub functions: HookFunctions,
    pub has_loops: bool,
    pieces: Vec<Piece>,
}

/// A piece of the rewritten text that begins at byte `begin`.
struct Piece {
    begin: usize,
    origin: Origin,
}

enum Origin {
    /// Copied from the byte of the file.
    Copied(usize),
    /// Inserted at the byte of the file.
    Inserted(usize),
    /// Behind the end of the file.
    Generated,
}

impl Rewritten {
    /// The byte of the file that byte `offset` of the text comes from; none for generated text.
    pub fn origin(&self, offset: usize) -> Option<usize> {
        let piece = &self.pieces[self
            .pieces
            .partition_point(|piece| piece.begin <= offset)
            .checked_sub(1)?];
        match piece.origin {
            Origin::Copied(from) => Some(from + offset - piece.begin),
            Origin::Inserted(at) => Some(at),
            Origin::Generated => None,
        }
    }

    fn copy(&mut self, file: &str, from: usize, to: usize) {
        self.pieces.push(Piece {
            begin: self.text.len(),
            origin: Origin::Copied(from),
        });
        self.text.push_str(&file[from..to]);
    }

    fn insert(&mut self, text: &str, at: usize) {
        self.pieces.push(Piece {
            begin: self.text.len(),
            origin: Origin::Inserted(at),
        });
        self.text.push_str(text);
    }
}

/// The text with spaces for comments and attributes: every token keeps its place.
fn plain(text: &str, declaration: &Declaration<'_>) -> String {
    let blank = |byte: u8| if byte == b'\n' { b'\n' } else { b' ' };
    let mut bytes: Vec<u8> = text.bytes().map(blank).collect();
    for token in &declaration.tokens {
        bytes[token.offset..token.end()].copy_from_slice(token.text.as_bytes());
    }
    for range in &declaration.parameters.attributes {
        bytes[range.clone()]
            .iter_mut()
            .for_each(|byte| *byte = blank(*byte));
    }
    String::from_utf8(bytes).expect("whole characters were replaced")
}

/// The name of what the rewriting itself declares; no name of [`EffectSource::unique`] has this
/// form.
fn generated(stem: &str, what: &str) -> String {
    format!("effect_{what}__{stem}")
}

/// The text of the file `stem` as it is linked into kernels.
pub fn rewritten(stem: &str, file: &str, declaration: &Declaration<'_>) -> Rewritten {
    let plain = plain(file, declaration);
    let tokens = &declaration.tokens;
    let counter = generated(stem, "turns");
    let text = String::with_capacity(2 * plain.len());
    let mut result = Rewritten {
        text,
        functions: HookFunctions::default(),
        has_loops: false,
        pieces: Vec::new(),
    };
    let (mut copied, mut in_struct, mut has_loops) = (0, None, false);
    let mut loop_depth: Option<usize> = None;
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate() {
        let before = if index > 0 {
            tokens[index - 1].text
        } else {
            ""
        };
        let next = tokens.get(index + 1).map_or("", |token| token.text);
        match token.text {
            "(" | "[" => depth += 1,
            ")" | "]" => depth = depth.saturating_sub(1),
            "struct" if in_struct.is_none() => in_struct = Some(false),
            "}" => in_struct = None,
            ";" if loop_depth == Some(depth) => loop_depth = None,
            "loop" | "for" | "while" if before != "." && in_struct.is_none() => {
                loop_depth = Some(depth)
            }
            _ => {}
        }
        if token.text == "{" {
            if let Some(opened) = &mut in_struct {
                *opened = true;
            }
            if loop_depth == Some(depth) {
                result.copy(&plain, copied, token.end());
                result.insert(
                    &format!(" {counter} += 1u; if {counter} > {MAX_TURNS}u {{ break; }}"),
                    token.end(),
                );
                (copied, loop_depth, has_loops) = (token.end(), None, true);
            }
            continue;
        }
        let is_attribute = before == "@"
            || declaration
                .parameters
                .attributes
                .iter()
                .any(|range| range.contains(&token.offset));
        // A picture inside the text would be a long line of spaces.
        if is_attribute && token.text.starts_with('"') {
            result.copy(&plain, copied, token.offset);
            copied = token.end();
        }
        let is_member_name = in_struct == Some(true) && next == ":";
        if token.is_name()
            && declaration.declared.contains(token.text)
            && before != "."
            && !is_member_name
            && !is_attribute
        {
            result.copy(&plain, copied, token.offset);
            let prefix = EffectSource::unique(stem, "");
            result.insert(&prefix, token.offset);
            copied = token.offset;
        }
    }
    result.copy(&plain, copied, plain.len());
    result.pieces.push(Piece {
        begin: result.text.len(),
        origin: Origin::Generated,
    });
    result.has_loops = has_loops;
    result.functions = append_hooks(
        stem,
        &mut result.text,
        declaration,
        has_loops.then_some(&counter),
    );
    result
}

/// Appends the files that are used, the counter of turns, and the functions that the kernels call.
fn append_hooks(
    stem: &str,
    text: &mut String,
    declaration: &Declaration<'_>,
    counter: Option<&String>,
) -> HookFunctions {
    text.push('\n');
    for used in &declaration.uses {
        writeln!(text, "//@ use {used}").expect("writing to a string");
    }
    if let Some(counter) = counter {
        writeln!(text, "var<private> {counter}: u32 = 0u;").expect("writing to a string");
    }
    let reset = counter.map_or(String::new(), |counter| format!("    {counter} = 0u;\n"));
    let parameters = EffectSource::unique(stem, declaration.struct_name);
    let mut wrapped = |name: &Option<String>, hook: &str, kind: &str, result: &str| {
        let (called, wrapper) = (
            EffectSource::unique(stem, name.as_ref()?),
            generated(stem, hook),
        );
        let body = match hook {
            "vertex" => format!(
                "    let moved = {called}(v, p);\n{}",
                limited(stem, declaration)
            ),
            _ => format!("    return {called}(v, p);\n"),
        };
        write!(
            text,
            "fn {wrapper}(v: {kind}, p: {parameters}) -> {result} {{\n{reset}{body}}}\n"
        )
        .expect("writing to a string");
        Some(wrapper)
    };
    let hooks = &declaration.hooks;
    let passes = declaration
        .passes
        .iter()
        .enumerate()
        .filter_map(|(i, pass)| {
            let name = Some(pass.name.clone());
            wrapped(&name, &format!("pass_{i}"), "ImageAt", "vec4f")
        });
    let passes = passes.collect();
    HookFunctions {
        passes,
        vertex: wrapped(&hooks.vertex, "vertex", "Vertex", "Vertex"),
        sample: wrapped(&hooks.sample, "sample", "Sample", "bool"),
        sample_setup: None,
        surface: wrapped(&hooks.surface, "surface", "Surface", "Surface"),
        image: wrapped(&hooks.image, "image", "Pixel", "Pixel"),
    }
}

/// A message about the linked text, with the names that the author wrote.
pub fn in_names_of_author(stem: &str, declaration: &Declaration<'_>, message: &str) -> String {
    let hooks = &declaration.hooks;
    let named = [
        ("vertex", &hooks.vertex),
        ("sample", &hooks.sample),
        ("surface", &hooks.surface),
        ("image", &hooks.image),
    ];
    let mut message = message.replace(&EffectSource::unique(stem, ""), "");
    for (i, pass) in declaration.passes.iter().enumerate().rev() {
        message = message.replace(&generated(stem, &format!("pass_{i}")), &pass.name);
    }
    for (hook, name) in named {
        message = message.replace(&generated(stem, hook), name.as_deref().unwrap_or(hook));
    }
    message.replace(&generated(stem, "turns"), "the counter of turns")
}

/// The end of a vertex hook: it changes offset and normal alone, and the offset by at most what the
/// function behind `@reach` says, else the sum of the lengths.
fn limited(stem: &str, declaration: &Declaration<'_>) -> String {
    let limit = match &declaration.reach {
        Some(reach) => {
            let reach = format!("{}(p)", EffectSource::unique(stem, &reach.name));
            format!("select(0.0, {reach}, {reach} >= 0.0 && {reach} <= {MOST_REACH_M:e})")
        }
        None => lengths(&declaration.parameters.fields)
            .map(|field| format!("abs(p.{})", field.name))
            .collect::<Vec<_>>()
            .join(" + "),
    };
    format!(
        "    let change = clamp(moved.offset - v.offset, vec3f(-1e12), vec3f(1e12));
    let distance = length(change);
    let limit = {limit};
    var kept = v;
    kept.normal = moved.normal;
    kept.offset = select(moved.offset, v.offset + change * (limit / max(distance, 1e-30)), distance > limit);
    return kept;
"
    )
}
