//! What can be wrong with a preset, each as one sentence that says where.

use std::fmt;

/// Where in which file; files have names that a person knows, also `stdin` or `--set facet.amount=2`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    pub file: String,
    /// Counted from 1.
    pub line: Option<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file),
            None => f.write_str(&self.file),
        }
    }
}

/// Why a preset cannot be had, changed or kept.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PresetError {
    #[error("{file}: cannot be read: {reason}")]
    Read { file: String, reason: String },
    #[error("{at}: {reason}")]
    Syntax { at: Place, reason: String },
    /// A value outside its form or range, or keys that contradict each other.
    #[error("{at}: {key} {reason}")]
    Value { at: Place, key: String, reason: String },
    /// Warnings, when strictness makes them errors.
    #[error("{}", .0.join("\n"))]
    Strict(Vec<String>),
    #[error("there is no preset {what:?}{hint}")]
    NoPreset { what: String, hint: String },
    #[error("{what} holds no preset of ours: {reason}")]
    NotOurs { what: String, reason: String },
    #[error("{id} cannot be changed: {reason}")]
    ReadOnly { id: String, reason: String },
    #[error("{file}: cannot be written: {reason}")]
    Write { file: String, reason: String },
}

impl PresetError {
    /// Where the fault lies, as far as it lies in a file.
    pub fn place(&self) -> Option<Place> {
        match self {
            Self::Syntax { at, .. } | Self::Value { at, .. } => Some(at.clone()),
            Self::Read { file, .. } | Self::Write { file, .. } => Some(Place { file: file.clone(), line: None }),
            _ => None,
        }
    }

    pub(super) fn value(at: Place, key: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Value { at, key: key.into(), reason: reason.into() }
    }
}
