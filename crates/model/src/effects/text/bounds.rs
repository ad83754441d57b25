//! Bounds on the text of an effect file, checked on its tokens before anything parses it: a short
//! file can otherwise exhaust stack or memory of a parser, a validator or a driver.

use super::{
    error::{EffectError, Text},
    tokens::{Token, closing, open_comment},
};
use crate::params::is_hidden;

/// Most brackets, and branches of one `else if` chain, inside each other.
pub const MAX_DEPTH: usize = 64;
/// Most operators in one expression, those around its brackets included.
pub const MAX_OPERATORS: usize = 256;
/// Most elements of an array.
pub const MAX_ELEMENTS: u64 = 4096;

/// Refuses what is out of bounds, and brackets that do not match.
///
/// # Errors
/// The first fault, at its place.
pub fn check(text: &Text<'_>, tokens: &[Token<'_>]) -> Result<(), EffectError> {
    check_characters(text)?;
    if let Some(offset) = open_comment(text.text) {
        return Err(text.error(
            offset,
            2,
            "the comment that begins here has no end; close it with */",
        ));
    }
    check_brackets(text, tokens)?;
    check_arrays(text, tokens)
}

/// Other line breaks and control characters end a comment in WGSL but not in an editor, so they
/// could hide code.
fn check_characters(text: &Text<'_>) -> Result<(), EffectError> {
    let mut characters = text.text.char_indices().peekable();
    while let Some((offset, c)) = characters.next() {
        let is_allowed = match c {
            '\n' | '\t' => true,
            '\r' => characters.peek().is_some_and(|(_, next)| *next == '\n'),
            '\u{feff}' => offset == 0,
            other => !is_hidden(other),
        };
        if !is_allowed {
            let message = format!(
                "the character U+{:04X} cannot stand in an effect file; remove it",
                u32::from(c)
            );
            return Err(text.error(offset, c.len_utf8(), message));
        }
    }
    Ok(())
}

/// What one pair of brackets holds so far.
#[derive(Default)]
struct Level {
    /// Index of the opening bracket.
    open: usize,
    operators: usize,
    /// Branches of the `else if` chain at the end.
    branches: usize,
}

/// The last token in the line of the last head of a block behind which no block follows.
fn unopened<'a, 't>(text: &Text<'_>, tokens: &'a [Token<'t>]) -> Option<&'a Token<'t>> {
    let heads = [
        "fn", "struct", "if", "else", "for", "while", "loop", "switch",
    ];
    let is_head = |at: usize| heads.contains(&tokens[at].text);
    let ends_line = |at: &usize| match tokens.get(at + 1) {
        Some(next) => text.text[tokens[*at].end()..next.offset].contains('\n'),
        None => true,
    };
    let found = (0..tokens.len())
        .rev()
        .filter(|&head| is_head(head))
        .find(|&head| {
            let mut at = head + 1;
            while at < tokens.len() && !is_head(at) && !["{", "}", ";"].contains(&tokens[at].text) {
                at = match tokens[at].text {
                    "(" => closing(tokens, at) + 1,
                    _ => at + 1,
                };
            }
            let behind = tokens.get(at).map_or("", |token| token.text);
            behind != "{" && (tokens[head].text, behind) != ("else", "if")
        });
    (found?..tokens.len()).find(ends_line).map(|at| &tokens[at])
}

fn check_brackets(text: &Text<'_>, tokens: &[Token<'_>]) -> Result<(), EffectError> {
    let mut levels = vec![Level::default()];
    let mut before = "";
    for (index, token) in tokens.iter().enumerate() {
        let error = |message: String| Err(text.at(token, message));
        let level = levels.last_mut().expect("the file itself is a level");
        if before == "}" && token.text != "else" {
            level.branches = 0;
        }
        match token.text {
            "if" if before == "else" => level.branches += 1,
            "," | ";" => level.operators = 0,
            "(" | "[" | "{" => {
                level.operators += usize::from(token.text == "[");
                levels.push(Level {
                    open: index,
                    ..Level::default()
                });
                let depth: usize = levels.iter().map(|level| 1 + level.branches).sum();
                if depth > MAX_DEPTH + 1 {
                    return error(format!(
                        "more than {MAX_DEPTH} brackets or else-if branches stand inside each other; move some into a function"
                    ));
                }
            }
            ")" | "]" | "}" => {
                let opened = levels.pop().map_or("", |level| tokens[level.open].text);
                if levels.is_empty() {
                    return match unopened(text, &tokens[..index]).filter(|_| token.text == "}") {
                        Some(last) => Err(text.error(
                            last.end() - 1,
                            1,
                            "the block that begins here has no {; write it behind this",
                        )),
                        None => error(format!("{} closes nothing; remove it", token.text)),
                    };
                }
                let expected = match opened {
                    "(" => ")",
                    "[" => "]",
                    _ => "}",
                };
                if token.text != expected {
                    return error(format!(
                        "{} stands where {expected} must close the {opened} before it",
                        token.text
                    ));
                }
                if token.text == "}" {
                    levels.last_mut().expect("one is left").operators = 0;
                }
            }
            "+" | "-" | "*" | "/" | "%" | "&" | "|" | "^" | "<" | ">" | "=" | "!" | "~" | "." => {
                level.operators += 1
            }
            _ => {}
        }
        if levels.iter().map(|level| level.operators).sum::<usize>() > MAX_OPERATORS {
            return error(format!(
                "the expression has more than {MAX_OPERATORS} operators; split it with let"
            ));
        }
        before = token.text;
    }
    match levels.get(1).map(|level| tokens[level.open]) {
        Some(open) => Err(text.error(open.offset, 1, format!("{} is not closed", open.text))),
        None => Ok(()),
    }
}

/// A whole number as WGSL writes it.
fn whole_number(text: &str) -> Option<u64> {
    let digits = text.strip_suffix(['u', 'i']).unwrap_or(text);
    match digits
        .strip_prefix("0x")
        .or_else(|| digits.strip_prefix("0X"))
    {
        Some(hexadecimal) => u64::from_str_radix(hexadecimal, 16).ok(),
        None => digits.parse().ok(),
    }
}

/// Values of the constants that are declared as one whole number.
fn constant(tokens: &[Token<'_>], name: &str) -> Option<u64> {
    let at = tokens
        .windows(2)
        .position(|pair| pair[0].text == "const" && pair[1].text == name)?;
    let end = at + tokens[at..].iter().position(|token| token.text == ";")?;
    let equals = at + tokens[at..end].iter().position(|token| token.text == "=")?;
    match &tokens[equals + 1..end] {
        [value] => whole_number(value.text),
        _ => None,
    }
}

/// Array lengths are known before the text is parsed: a parser that evaluates constants makes every
/// element.
fn check_arrays(text: &Text<'_>, tokens: &[Token<'_>]) -> Result<(), EffectError> {
    for (index, token) in tokens.iter().enumerate() {
        let next = |ahead: usize| tokens.get(index + ahead).map_or("", |token| token.text);
        if token.text != "array" || next(1) != "<" {
            continue;
        }
        let (mut depth, mut at, mut comma) = (0_usize, index + 1, None);
        while at < tokens.len() {
            match tokens[at].text {
                "<" if tokens[at - 1].is_name() => depth += 1,
                ">" => depth -= 1,
                "(" | "[" => at = closing(tokens, at),
                "," if depth == 1 => comma = comma.or(Some(at)),
                ";" | "{" | "}" => break,
                _ => {}
            }
            if depth == 0 {
                break;
            }
            at += 1;
        }
        let closes = tokens.get(at).is_some_and(|token| token.text == ">");
        if !closes {
            return Err(text.at(token, "the < of this array type is not closed"));
        }
        // WGSL allows a comma at the end.
        let length = comma.map(|comma| match &tokens[comma + 1..at] {
            [rest @ .., last] if last.text == "," => rest,
            all => all,
        });
        let elements = match length {
            Some([one]) => whole_number(one.text).or_else(|| constant(tokens, one.text)),
            _ => None,
        };
        if !elements.is_some_and(|elements| (1..=MAX_ELEMENTS).contains(&elements)) {
            let place = length.and_then(|length| length.first()).unwrap_or(token);
            let message = format!(
                "the length of an array is a whole number from 1 to {MAX_ELEMENTS}, or a const that is declared as one"
            );
            return Err(text.at(place, message));
        }
        // Nested arrays multiply, and naga reads their types one inside the other.
        if (0..MAX_ARRAYS).all(|level| next(2 * level) == "array" && next(2 * level + 1) == "<") {
            return Err(text.at(
                token,
                format!("fewer than {MAX_ARRAYS} arrays may stand inside each other"),
            ));
        }
    }
    Ok(())
}

/// Arrays of arrays of arrays … that are refused.
const MAX_ARRAYS: usize = 5;
