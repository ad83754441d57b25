//! What ends a case early, and the comparisons of pictures that do.

use crate::{
    gpu::{Capture, RenderError},
    measure::compare,
    scene::draw::DrawError,
};

/// Why a case ends early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EarlyEnd {
    Failed(String),
    /// The adapter lacks what this sentence names.
    Skipped(String),
}

impl EarlyEnd {
    /// The same end, its failure preceded by what was drawn.
    pub(super) fn of(self, what: &str) -> Self {
        match self {
            Self::Failed(why) => Self::Failed(format!("{what}: {why}")),
            other => other,
        }
    }
}

impl From<String> for EarlyEnd {
    fn from(why: String) -> Self {
        Self::Failed(why)
    }
}

impl From<RenderError> for EarlyEnd {
    fn from(error: RenderError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<DrawError> for EarlyEnd {
    fn from(error: DrawError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Fails the case with a sentence unless the condition holds.
macro_rules! check {
    ($condition:expr, $($sentence:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err($crate::stress::EarlyEnd::Failed(format!($($sentence)+)));
        }
    };
}
pub(super) use check;

/// The number of triangles that cover each pixel.
pub(super) fn layers(capture: &Capture) -> &[u32] {
    capture.layers.as_deref().unwrap_or_default()
}

/// Fails unless every sample is covered exactly once.
pub(super) fn once(capture: &Capture, what: &str) -> Result<(), EarlyEnd> {
    match layers(capture)
        .iter()
        .enumerate()
        .find(|(_, hits)| **hits != 1)
    {
        None if !layers(capture).is_empty() => Ok(()),
        None => Err(EarlyEnd::Failed(format!("{what}: no hits were counted"))),
        Some((pixel, hits)) => {
            let width = capture.frame.width.max(1) as usize;
            Err(EarlyEnd::Failed(format!(
                "{what}: the sample of pixel {}, {} is covered {hits} times",
                pixel % width,
                pixel / width
            )))
        }
    }
}

/// Fails with both values if they differ.
pub(super) fn equal<T: PartialEq + std::fmt::Debug>(
    found: &T,
    expected: &T,
    what: &str,
) -> Result<(), EarlyEnd> {
    if found == expected {
        Ok(())
    } else {
        Err(EarlyEnd::Failed(format!(
            "{what}: found {found:?}, expected {expected:?}"
        )))
    }
}

/// Fails where two pictures differ in a triangle id, a depth key or a number of hits.
pub(super) fn same(found: &Capture, expected: &Capture, what: &str) -> Result<(), EarlyEnd> {
    same_nearest(found, expected, what)?;
    same_values("numbers of hits", layers(found), layers(expected), what)
}

/// Fails where two pictures differ in a triangle id or a depth key.
pub(super) fn same_nearest(
    found: &Capture,
    expected: &Capture,
    what: &str,
) -> Result<(), EarlyEnd> {
    same_values(
        "triangle ids",
        &found.frame.triangle_id,
        &expected.frame.triangle_id,
        what,
    )?;
    same_values(
        "depth keys",
        &found.frame.depth_key,
        &expected.frame.depth_key,
        what,
    )
}

fn same_values(which: &str, found: &[u32], expected: &[u32], what: &str) -> Result<(), EarlyEnd> {
    match compare::triangle_ids(found, expected) {
        delta if delta.different > 0 => Err(EarlyEnd::Failed(format!(
            "{what}: {} pixels have other {which}: {:?}",
            delta.different, delta.mismatches
        ))),
        _ => Ok(()),
    }
}
