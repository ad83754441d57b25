//! Errors about effect files: one sentence with file, line and column, and the line of text with a caret below it.

use std::fmt;

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
    /// The line of text.
    pub text: String,
}

impl Place {
    /// The place of `length` bytes at byte `offset` of `text`; an offset behind the end is the end.
    pub fn of(text: &str, offset: usize, length: usize) -> Self {
        let mut offset = offset.min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let begin = text[..offset].rfind('\n').map_or(0, |at| at + 1);
        let end = text[offset..].find('\n').map_or(text.len(), |at| offset + at);
        let marked = text.get(offset..(offset + length).min(end)).map_or(1, |marked| marked.chars().count().max(1));
        Self {
            line: text[..offset].matches('\n').count() as u32 + 1,
            column: text[begin..offset].chars().count() as u32 + 1,
            length: marked as u32,
            text: text[begin..end].trim_end().chars().take(200).collect(),
        }
    }
}

impl fmt::Display for EffectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = &self.place else { return write!(f, "{}: {}", self.file, self.message) };
        let Place { line, column, length, text } = place;
        let number = line.to_string();
        let (indent, dent) = (" ".repeat(number.len()), " ".repeat(*column as usize - 1));
        writeln!(f, "{}:{line}:{column}: {}", self.file, self.message)?;
        writeln!(f, "  {number} | {text}")?;
        write!(f, "  {indent} | {dent}{}", "^".repeat((*length).min(200) as usize))
    }
}

impl std::error::Error for EffectError {}

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
        EffectError { file: self.file.into(), place: Some(Place::of(self.text, offset, length)), message: message.into() }
    }

    /// An error about the file as a whole.
    pub fn whole(&self, message: impl Into<String>) -> EffectError {
        EffectError { file: self.file.into(), place: None, message: message.into() }
    }
}
