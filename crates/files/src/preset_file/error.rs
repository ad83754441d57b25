//! Errors of preset files, each one sentence that begins with the file and line.

use std::fmt;

use crate::params::{legible, legible_line};

/// A line of a file; `file` may also be `stdin` or an argument such as `--set facet.amount=2`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Position {
    pub file: String,
    /// Counted from 1.
    pub line: Option<usize>,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file),
            None => f.write_str(&self.file),
        }
    }
}

/// Why a preset cannot be read, changed or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PresetError {
    #[error("{file}: cannot be read: {reason}")]
    Read { file: String, reason: String },
    #[error("{at}: {reason}")]
    Syntax { at: Position, reason: String },
    /// A value of another type or outside its range, or keys that contradict each other.
    #[error("{at}: {key} {reason}")]
    Value {
        at: Position,
        key: String,
        reason: String,
    },
    /// Warnings, when strictness makes them errors.
    #[error("{}", .0.join("\n"))]
    Strict(Vec<String>),
    #[error("there is no preset {what:?}{hint}")]
    NoPreset { what: String, hint: String },
    #[error("several presets are called {name:?}: {ids}; give the id of one")]
    Ambiguous { name: String, ids: String },
    #[error("{what} holds no rasterlab preset: {reason}")]
    NotOurs { what: String, reason: String },
    #[error("{id} cannot be changed: {reason}")]
    ReadOnly { id: String, reason: String },
    /// A file of this name exists and is not to be replaced.
    #[error("{file} exists already")]
    Exists { file: String },
    #[error("{file}: cannot be written: {reason}")]
    Write { file: String, reason: String },
}

impl PresetError {
    /// The file and line of the error, if it is in a file.
    pub fn position(&self) -> Option<Position> {
        match self {
            Self::Syntax { at, .. } | Self::Value { at, .. } => Some(at.clone()),
            Self::Read { file, .. } | Self::Write { file, .. } | Self::Exists { file } => {
                Some(Position {
                    file: file.clone(),
                    line: None,
                })
            }
            _ => None,
        }
    }

    pub(super) fn value(at: Position, key: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Value {
            at,
            key: legible_line(&key.into()),
            reason: legible(&reason.into()),
        }
    }
}
