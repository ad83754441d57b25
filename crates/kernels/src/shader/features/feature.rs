//! One row of the table of features.

use crate::{
    scene::needs::Needs,
    shader::{key::KernelKey, pass::Pass},
};

/// Takes no step.
pub(super) const NO_STEP: &str = "";

/// The variant if the condition holds, else the default.
pub(super) const fn variant_if(condition: bool, variant: &'static str) -> &'static str {
    if condition { variant } else { "default" }
}

/// The step if the condition holds.
pub(super) const fn step_if(condition: bool, step: &'static str) -> &'static str {
    if condition { step } else { NO_STEP }
}

/// A file of `shaders/variants`, or a function of steps, and the section that a pass takes.
pub(super) type VariantChoice = (&'static str, fn(&KernelKey, Pass) -> &'static str);

/// An override, and its value in a pass.
pub(super) type ConstantChoice = (&'static str, fn(&KernelKey, Pass) -> f64);

/// What one part of the kernel key means.
pub(super) struct Feature {
    /// What it adds to the key's label; empty where it adds nothing.
    pub label: fn(&KernelKey) -> String,
    /// A part of the frame that exists only with this feature.
    pub part: Option<Part>,
    /// Files of variants and functions of steps, and the section that a pass takes of each;
    /// [`NO_STEP`] where it takes none.
    pub variants: &'static [VariantChoice],
    /// Overrides, and their values in a pass.
    pub constants: &'static [ConstantChoice],
}

impl Feature {
    pub const NONE: Self = Self {
        label: |_| String::new(),
        part: None,
        variants: &[],
        constants: &[],
    };
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
