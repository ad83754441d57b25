//! One row of the table of features.

use crate::{
    scene::needs::Needs,
    shader::{key::KernelKey, pass::Pass},
};

/// Takes no file of a folder of steps.
pub(super) const NO_STEP: &str = "";

/// The stem if the condition holds, else the interface of the folder, which defines its default.
pub(super) const fn stem_if(condition: bool, stem: &'static str) -> &'static str {
    if condition { stem } else { "interface" }
}

/// The step if the condition holds.
pub(super) const fn step_if(condition: bool, stem: &'static str) -> &'static str {
    if condition { stem } else { NO_STEP }
}

/// A folder of variants, and the stem of the file that a pass takes from it.
pub(super) type VariantChoice = (&'static str, fn(&KernelKey, Pass) -> &'static str);

/// An override, and its value in a pass.
pub(super) type ConstantChoice = (&'static str, fn(&KernelKey, Pass) -> f64);

/// What one part of the kernel key means.
pub(super) struct Feature {
    /// What it adds to the key's label; empty where it adds nothing.
    pub label: fn(&KernelKey) -> String,
    /// A part of the frame that exists only with this feature.
    pub part: Option<Part>,
    /// Folders of `shaders/variants`, and the stem of the file that a pass takes from each; [`NO_STEP`] where it takes none.
    pub variants: &'static [VariantChoice],
    /// Overrides, and their values in a pass.
    pub constants: &'static [ConstantChoice],
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
