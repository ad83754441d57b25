//! One row of the table of features.

use crate::{
    scene::needs::Needs,
    shader::{key::KernelKey, pass::Pass},
};

/// What one part of the kernel key means.
pub(super) struct Feature {
    /// What it adds to the key's label; empty where it adds nothing.
    pub label: fn(&KernelKey) -> String,
    /// A part of the frame that exists only with this feature.
    pub part: Option<Part>,
    /// Parts that stages leave open, and the stem of the file that a pass takes for each.
    pub variants: &'static [(&'static str, fn(&KernelKey, Pass) -> &'static str)],
    /// Overrides, and their values in a pass.
    pub constants: &'static [(&'static str, fn(&KernelKey, Pass) -> f64)],
}

impl Feature {
    pub const NONE: Self = Self { label: |_| String::new(), part: None, variants: &[], constants: &[] };
}

/// A part of the frame that can be omitted.
pub(super) struct Part {
    pub name: &'static str,
    pub is_used: fn(&KernelKey) -> bool,
    /// Why it is omitted, where it is.
    pub why_omitted: fn(&Needs) -> String,
}

/// The word if the condition holds, else nothing.
pub(super) fn word_if(is_there: bool, word: &str) -> String {
    if is_there { word.into() } else { String::new() }
}

/// The value of a boolean override.
pub(super) fn flag(value: bool) -> f64 {
    f64::from(u8::from(value))
}
