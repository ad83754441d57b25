//! Promise: an effect file is read, or refused with one sentence at its place in the file; and what
//! is read links and validates in every pass, alone, beside effects that declare the same names,
//! and beside all built-in effects. Needs no adapter.

mod accepted;
mod duplicates;
mod given;
mod mutated;
mod numerics;
mod pictures;
mod refused;
mod saved;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use rasterlab::{
    effect_files::{EffectError, read},
    effects::Effect,
    params::is_hidden,
};

/// Longest time that reading one file may take.
const MOST_TIME: Duration = Duration::from_secs(1);

/// Reads a file called `ink.wgsl` and checks how a refusal is told.
fn read_ink(text: &str) -> Result<Arc<Effect>, EffectError> {
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let start = Instant::now();
    let result = read("ink.wgsl", "ink", text);
    assert!(
        start.elapsed() < MOST_TIME,
        "took {:?}:\n{}",
        start.elapsed(),
        beginning(text)
    );
    if let Err(error) = &result {
        check_telling(error, text);
    }
    result
}

fn beginning(text: &str) -> String {
    text.chars().take(3000).collect()
}

/// A refusal is one sentence in the author's words, and its caret stands below something of the
/// file.
fn check_telling(error: &EffectError, text: &str) {
    let shown = error.to_string();
    let fail = |reason: &str| panic!("{reason}:\n{shown}\n---\n{}", beginning(text));
    for word in [
        "custom_",
        "effect_",
        "glue",
        "Effects",
        "generated",
        "shaders/",
        "\u{1b}",
    ] {
        if error.message.contains(word) && !text.contains(word) {
            fail(&format!("the message says {word:?}"));
        }
    }
    if error.message.contains(['\n', '\r'])
        || error.message.ends_with('.')
        || error.message.trim() != error.message
    {
        fail("the message is not one sentence");
    }
    if error.message.len() < 10 {
        fail("the message says too little");
    }
    if shown.chars().any(|c| c != '\n' && is_hidden(c)) {
        fail("the message has characters that steer a terminal or reorder text");
    }
    let lines: Vec<&str> = shown.split('\n').collect();
    let Some(place) = &error.place else {
        assert_eq!(lines.len(), 1, "{shown}");
        return;
    };
    let [head, line, carets] = lines[..] else {
        return fail("a place takes three lines");
    };
    if !head.starts_with(&format!("ink.wgsl:{}:{}: ", place.line, place.column)) {
        fail("the first line begins with file, line and column");
    }
    let of_file = text
        .split('\n')
        .nth(place.line as usize - 1)
        .unwrap_or_else(|| panic!("no such line:\n{shown}"));
    let at = of_file.chars().nth(place.column as usize - 1);
    if at.is_none_or(|c| c == ' ') && !of_file.trim().is_empty() {
        fail("the column is not on a character of the line");
    }
    let caret = carets
        .find('^')
        .unwrap_or_else(|| panic!("no caret:\n{shown}"));
    // A tab takes one column, and what steers a terminal or reorders text is not shown.
    let shown_as = |c: char| {
        if c == '\t' {
            ' '
        } else if is_hidden(c) {
            char::REPLACEMENT_CHARACTER
        } else {
            c
        }
    };
    if line.chars().nth(caret) != at.map(shown_as) {
        fail("the caret is not below its place");
    }
    if line.chars().count() > 200 || carets.len() > 200 {
        fail("a line is too long to read");
    }
}

/// A surface effect whose function has these statements.
fn with_statements(statements: &str) -> String {
    let head = "// Ink: an example.\n//@ use lib/surface\n\nstruct Ink {\n    /// Strength.\n    @range(0.0, 1.0, 0.5) amount: f32,\n}\n\n";
    let helper = "fn helper(x: f32) -> f32 {\n    return 2.0 * x;\n}\n\n";
    format!(
        "{head}{helper}fn ink(surface: Surface, p: Ink) -> Surface {{\n    var s = surface;\n    {statements}\n    return s;\n}}\n"
    )
}

/// A surface effect with these further declarations.
fn with_declarations(declarations: &str) -> String {
    with_statements("s.color *= p.amount;") + declarations
}

/// A surface effect whose parameters are these members.
fn with_members(members: &str) -> String {
    format!(
        "struct Ink {{\n{members}\n}}\n\nfn ink(surface: Surface, p: Ink) -> Surface {{\n    return surface;\n}}\n"
    )
}
