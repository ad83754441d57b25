//! Errors about effect files: one sentence with file, line and column, and the line of text with a
//! caret below it.

use std::{borrow::Borrow, fmt};

use super::tokens::Token;
use crate::params::{is_hidden, legible_line};

/// A fault in an effect file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EffectError {
    /// The file as messages call it.
    pub file: String,
    /// Where the fault is; none for the file as a whole.
    pub place: Option<Place>,
    /// What is wrong and what to do, without a final period.
    pub message: String,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// From 1.
    pub line: u32,
    /// In characters, from 1.
    pub column: u32,
    /// Characters that are marked, at least 1.
    pub length: u32,
    /// The line of text, or the part of a long line around the place.
    pub text: String,
    /// Characters of the line before `text`.
    pub skipped: u32,
}

/// Characters of a line that messages show.
const MAX_SHOWN: usize = 160;
/// Characters of a message.
const MAX_MESSAGE: usize = 600;

impl Place {
    /// The place of `length` bytes at byte `offset` of `text`; an offset behind the end is the end.
    pub fn of(text: &str, offset: usize, length: usize) -> Self {
        let mut offset = offset.min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let begin = text[..offset].rfind('\n').map_or(0, |at| at + 1);
        let end = text[offset..]
            .find('\n')
            .map_or(text.len(), |at| offset + at);
        let marked = text
            .get(offset..(offset + length).min(end))
            .map_or(1, |marked| marked.trim_end().chars().count().max(1));
        let before = text[begin..offset].chars().count();
        let skipped = if before + marked.min(MAX_SHOWN / 2) > MAX_SHOWN {
            before - MAX_SHOWN / 2
        } else {
            0
        };
        // One character takes one column, so that the caret stands below its place.
        let shown = text[begin..end]
            .trim_end()
            .chars()
            .skip(skipped)
            .take(MAX_SHOWN);
        Self {
            line: text[..offset].matches('\n').count() as u32 + 1,
            column: before as u32 + 1,
            length: marked as u32,
            text: shown.map(shown_character).collect(),
            skipped: skipped as u32,
        }
    }
}

/// As a message shows a character of a file: in one column, and without effect on the others.
fn shown_character(c: char) -> char {
    match c {
        '\t' => ' ',
        c if is_hidden(c) => char::REPLACEMENT_CHARACTER,
        c => c,
    }
}

impl fmt::Display for EffectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = &self.place else {
            return write!(f, "{}: {}", self.file, self.message);
        };
        let Place {
            line,
            column,
            length,
            text,
            skipped,
        } = place;
        let number = line.to_string();
        let (indent, before) = (" ".repeat(number.len()), (*column - 1 - *skipped) as usize);
        let dent = " ".repeat(before);
        let marked = (*length as usize)
            .min(MAX_SHOWN.saturating_sub(before))
            .max(1);
        writeln!(f, "{}:{line}:{column}: {}", self.file, self.message)?;
        writeln!(f, "  {number} | {text}")?;
        write!(f, "  {indent} | {dent}{}", "^".repeat(marked))
    }
}

impl std::error::Error for EffectError {}

/// A message in one line, without characters that steer a terminal or reorder text, and without a
/// period at its end.
fn sentence(message: &str) -> String {
    let words = message
        .split(|c: char| c.is_whitespace() || is_hidden(c))
        .filter(|word| !word.is_empty());
    let joined = words.collect::<Vec<_>>().join(" ");
    let kept: String = joined.chars().take(MAX_MESSAGE).collect();
    kept.trim_end_matches('.').to_owned()
}

/// A text that errors are about.
#[derive(Clone, Copy, Debug)]
pub struct Text<'a> {
    /// The file as messages call it.
    pub file: &'a str,
    pub text: &'a str,
}

impl Text<'_> {
    /// An error about `length` bytes at byte `offset`.
    pub fn error(&self, offset: usize, length: usize, message: impl Into<String>) -> EffectError {
        EffectError {
            file: legible_line(self.file),
            place: Some(Place::of(self.text, offset, length)),
            message: sentence(&message.into()),
        }
    }

    /// An error about a token.
    pub fn at<'t>(&self, token: impl Borrow<Token<'t>>, message: impl Into<String>) -> EffectError {
        let token = token.borrow();
        self.error(token.offset, token.text.len(), message)
    }

    /// An error about a token, or about the file where there is none.
    pub fn at_any<'t>(
        &self,
        token: Option<impl Borrow<Token<'t>>>,
        message: impl Into<String>,
    ) -> EffectError {
        match token {
            Some(token) => self.at(token, message),
            None => self.whole(message),
        }
    }

    /// The line, from 1, of byte `offset`.
    pub fn line(&self, offset: usize) -> usize {
        1 + self
            .text
            .bytes()
            .take(offset)
            .filter(|byte| *byte == b'\n')
            .count()
    }

    /// An error about the file as a whole.
    pub fn whole(&self, message: impl Into<String>) -> EffectError {
        EffectError {
            file: legible_line(self.file),
            place: None,
            message: sentence(&message.into()),
        }
    }
}
