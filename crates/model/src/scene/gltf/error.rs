//! Load errors, and how they name the things in a file.

use std::{fmt::Display, path::Path};

use crate::{scene::parts::MAX_NAME_CHARS, work::Canceled};

/// Why a model cannot be loaded; one sentence.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct LoadError(pub String);

impl LoadError {
    pub fn new(reason: impl Display) -> Self {
        Self(reason.to_string())
    }

    /// Prepends the place of the error.
    pub fn within(self, context: impl Display) -> Self {
        Self(format!("{context}: {}", self.0))
    }
}

impl From<Canceled> for LoadError {
    fn from(canceled: Canceled) -> Self {
        Self::new(canceled)
    }
}

/// Reads a file beside the model, given its path and the largest size in bytes. The path is
/// relative and has no `..`, so that it stays in the model's folder unless a link there leads out.
pub type ReadFile<'a> = dyn FnMut(&Path, u64) -> Result<Vec<u8>, LoadError> + 'a;

/// A name from a file, made safe for messages: quoted, escaped and at most 60 characters.
pub(super) fn quoted(name: &str) -> String {
    let short: String = name.chars().take(60).collect();
    if short.len() < name.len() {
        format!("{:?}", short + "…")
    } else {
        format!("{short:?}")
    }
}

/// `kind "name"`, or `kind 3` if it has no name.
pub(super) fn called(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {}", quoted(name)),
        _ => format!("{kind} {index}"),
    }
}

/// The name by which patterns find a part: that of the file, at most [`MAX_NAME_CHARS`] long and
/// without control characters, or `kind 3`.
pub(super) fn part_name(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => name
            .chars()
            .take(MAX_NAME_CHARS)
            .map(|c| if c.is_control() { '?' } else { c })
            .collect(),
        _ => format!("{kind} {index}"),
    }
}
