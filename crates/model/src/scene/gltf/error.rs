//! Load errors, and how they name the things in a file.

use std::{fmt::Display, path::Path};

use crate::{legible::legible_name, scene::parts::MAX_NAME_CHARS, work::Canceled};

/// Why a model, or a part of one, cannot be loaded; one sentence.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct LoadError {
    reason: String,
    /// Loading ends: a part that is left out does not help.
    ends: bool,
}

impl LoadError {
    /// What is wrong with a file, or with a part that may be left out.
    pub fn new(reason: impl Display) -> Self {
        Self {
            reason: reason.to_string(),
            ends: false,
        }
    }

    /// Why loading ends: a limit, or because nobody waits for it any more.
    pub(in crate::scene) fn end(reason: impl Display) -> Self {
        Self {
            ends: true,
            ..Self::new(reason)
        }
    }

    /// Prepends the place of the error.
    pub fn within(self, context: impl Display) -> Self {
        self.after(format_args!("{context}: "))
    }

    /// Prepends the beginning of the sentence.
    pub(in crate::scene) fn after(self, beginning: impl Display) -> Self {
        Self {
            reason: format!("{beginning}{}", self.reason),
            ..self
        }
    }

    /// The reason why a part is left out.
    ///
    /// # Errors
    /// Loading ends.
    pub(in crate::scene) fn of_part(self) -> Result<String, Self> {
        match self.ends {
            true => Err(self),
            false => Ok(self.reason),
        }
    }
}

impl From<Canceled> for LoadError {
    fn from(canceled: Canceled) -> Self {
        Self::end(canceled)
    }
}

/// Reads a file beside the model, given its path and the largest size in bytes. The path is
/// relative and has no `..`, so that it stays in the model's folder unless a link there leads out.
pub type ReadFile<'a> = dyn FnMut(&Path, u64) -> Result<Vec<u8>, LoadError> + 'a;

/// A name from a file, made safe for messages: quoted, escaped and at most 60 characters.
pub(in crate::scene) fn quoted(name: &str) -> String {
    let most = 60;
    let end = if name.chars().nth(most).is_some() {
        "…"
    } else {
        ""
    };
    format!(
        "\"{}{end}\"",
        legible_name(&name.replace('"', "\\\""), most)
    )
}

/// `kind "name"`, or `kind 3` if it has no name.
pub(in crate::scene) fn called(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {}", quoted(name)),
        _ => format!("{kind} {index}"),
    }
}

/// The name by which patterns find a part: that of the file, at most [`MAX_NAME_CHARS`] long and
/// with hidden characters written out, or `kind 3`.
pub(in crate::scene) fn part_name(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => legible_name(name, MAX_NAME_CHARS),
        _ => format!("{kind} {index}"),
    }
}

/// The name of a clip or camera in menus and presets, or `kind 3`.
pub(in crate::scene) fn menu_name(kind: &str, index: usize, name: Option<&str>) -> String {
    let name = legible_name(name.unwrap_or_default(), 60);
    match name.trim() {
        "" => format!("{kind} {index}"),
        _ => name,
    }
}
