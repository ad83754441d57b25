//! Parameters: one registry entry for everything that a person can set.
//!
//! A [`Param`] says what a value is called, what it means, its type, its ranges and its unit.
//! Effects declare theirs in their files; settings of a preset and accuracy axes wrap the same type. Sliders, preset files,
//! `--set`, listings, the JSON schema and uniform bytes all read these entries.

mod measure;
mod suggest;
mod value;

use std::{
    ops::{Deref, RangeInclusive},
    sync::Arc,
};

pub use crate::legible::{group_digits, is_hidden, legible, legible_line, text_of};
pub use measure::Measure;
pub use suggest::{did_you_mean, likeness, suggestion};
pub use value::{Stored, Value, ValueError, ValueType, format_number};

/// One parameter: what every surface of the program needs to know about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Stable name: key in preset files, end of a `--set` path, WGSL member. A new name needs a
    /// new schema.
    pub name: String,
    /// Tooltip and help text.
    pub doc: String,
    pub value_type: ValueType,
    /// What the kernel survives; every number outside it is an error.
    pub hard: [f64; 2],
    /// What the slider spans.
    pub soft: [f64; 2],
    /// Shown with a slider; otherwise as a number field alone.
    pub has_slider: bool,
    /// Unit shown after the value; empty for a plain number.
    pub unit: String,
    /// The slider moves in decades.
    pub log: bool,
    /// A height in world space: a length that counts from the origin, along y.
    pub height: bool,
    /// A depth: it counts from the eye, along the viewing direction.
    pub depth: bool,
    /// Shown only while the choice of this name has one of these words.
    pub when: Option<(String, Vec<String>)>,
}

impl Param {
    pub fn new(name: impl Into<String>, doc: impl Into<String>, value_type: ValueType) -> Self {
        let (hard, soft) = value_type.default_ranges();
        let (name, doc, unit) = (name.into(), doc.into(), String::new());
        Self {
            name,
            doc,
            value_type,
            hard,
            soft,
            has_slider: false,
            unit,
            log: false,
            height: false,
            depth: false,
            when: None,
        }
    }

    pub fn hard(mut self, range: RangeInclusive<f64>) -> Self {
        self.hard = [*range.start(), *range.end()];
        self.soft = self.hard;
        self
    }

    pub fn soft(mut self, range: RangeInclusive<f64>) -> Self {
        self.soft = [*range.start(), *range.end()];
        self.has_slider = true;
        self
    }

    pub fn unit(mut self, unit: &str) -> Self {
        self.unit = unit.into();
        self
    }

    pub fn log(mut self, log: bool) -> Self {
        self.log = log;
        self
    }

    pub fn height(mut self, height: bool) -> Self {
        self.height = height;
        self
    }

    pub fn depth(mut self, depth: bool) -> Self {
        self.depth = depth;
        self
    }

    /// Shown only while the choice of this name has one of these words.
    pub fn when(mut self, (choice, words): (&str, &[&str])) -> Self {
        self.when = Some((
            choice.into(),
            words.iter().map(|&word| word.into()).collect(),
        ));
        self
    }

    /// Does `value` have the parameter's type, and lie inside its hard range?
    /// Errors: completes a sentence that begins with the parameter's name.
    pub fn check(&self, value: &Value) -> Result<(), ValueError> {
        self.value_type.check(value, self.hard)
    }

    /// What the value measures in space.
    pub fn measure(&self) -> Measure {
        match Measure::of(&self.value_type, &self.unit, self.hard[0], self.height) {
            Measure::Length if self.depth => Measure::Depth,
            Measure::PerLength if self.depth => Measure::PerDepth,
            measure => measure,
        }
    }

    /// What is allowed, for listings: `0..=1`, `smooth | flat`, `4 numbers, each 0..=1`.
    pub fn allowed(&self) -> String {
        let [low, high] = self.hard.map(format_number);
        match &self.value_type {
            ValueType::Bool => "true | false".into(),
            ValueType::Choice(words) => words.join(" | "),
            ValueType::Text { max_chars } => format!("text, at most {max_chars} characters"),
            ValueType::TextList {
                max_entries,
                max_chars,
            } => format!("at most {max_entries} texts of {max_chars} characters"),
            numbers if numbers.components() == 1 => format!("{low}..={high}"),
            numbers => format!("{} numbers, each {low}..={high}", numbers.components()),
        }
    }
}

/// How an effect's parameter is stored in its WGSL struct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WgslType {
    F32,
    U32,
    I32,
    Vec4F32,
}

impl WgslType {
    /// The name in WGSL.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::U32 => "u32",
            Self::I32 => "i32",
            Self::Vec4F32 => "vec4<f32>",
        }
    }

    /// Number of 4-byte words.
    pub const fn words(self) -> usize {
        if matches!(self, Self::Vec4F32) { 4 } else { 1 }
    }
}

/// A parameter of an effect: a [`Param`] and where the effect's words hold its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub param: Param,
    pub wgsl: WgslType,
    /// Byte offset in the struct, in Rust and in WGSL.
    pub offset: usize,
}

impl Deref for Field {
    type Target = Param;

    fn deref(&self) -> &Param {
        &self.param
    }
}

impl Field {
    /// The parameter at `offset`. Every parameter of an effect has a slider.
    pub fn new(param: Param, wgsl: WgslType, offset: usize) -> Self {
        Self {
            param: Param {
                has_slider: true,
                ..param
            },
            wgsl,
            offset,
        }
    }

    fn words_range(&self) -> std::ops::Range<usize> {
        self.offset / 4..self.offset / 4 + self.wgsl.words()
    }

    /// The value in an effect's words.
    pub fn value(&self, words: &[u32]) -> Value {
        self.value_type
            .value(&self.get(words))
            .expect("effects have no texts")
    }

    /// The components of the value: a choice is its index, a flag 0 or 1.
    pub fn get(&self, words: &[u32]) -> Vec<f64> {
        let words = &words[self.words_range()][..self.value_type.components()];
        let number = |word: u32| match self.wgsl {
            WgslType::F32 | WgslType::Vec4F32 => f64::from(f32::from_bits(word)),
            WgslType::I32 => f64::from(word as i32),
            WgslType::U32 => f64::from(word),
        };
        words.iter().map(|word| number(*word)).collect()
    }

    /// Writes a value.
    /// Errors: the value has another type or lies outside the hard range; then nothing is changed.
    pub fn set_value(&self, words: &mut [u32], value: &Value) -> Result<(), ValueError> {
        self.check(value)?;
        let range = self.words_range();
        for (word, number) in words[range].iter_mut().zip(value.components()) {
            *word = match self.wgsl {
                WgslType::F32 | WgslType::Vec4F32 => (number as f32).to_bits(),
                WgslType::I32 => number as i32 as u32,
                WgslType::U32 => number as u32,
            };
        }
        Ok(())
    }

    /// Writes a value by its components.
    pub fn set(&self, words: &mut [u32], components: &[f64]) -> Result<(), ValueError> {
        // A flag or choice takes one whole number inside its range, before it becomes a value of
        // its type.
        let numbers = Value::Numbers(components.to_vec());
        let value = match self.value_type {
            ValueType::Bool | ValueType::Choice(_) => {
                ValueType::U32.check(&numbers, self.hard)?;
                self.value_type
                    .value(components)
                    .expect("one number is a flag or choice")
            }
            _ => numbers,
        };
        self.set_value(words, &value)
    }

    /// Do both hold the same bits in this field?
    pub fn same(&self, a: &[u32], b: &[u32]) -> bool {
        a[self.words_range()] == b[self.words_range()]
    }

    /// Copies this field's bits.
    pub fn copy(&self, from: &[u32], to: &mut [u32]) {
        to[self.words_range()].copy_from_slice(&from[self.words_range()]);
    }

    /// Is the field shown for these values?
    pub fn is_shown(&self, fields: &[Arc<Self>], words: &[u32]) -> bool {
        self.when.as_ref().is_none_or(|(name, allowed)| {
            fields
                .iter()
                .find(|field| field.name == *name)
                .is_some_and(|field| match (&field.value_type, field.value(words)) {
                    (ValueType::Choice(names), Value::Choice(index)) => {
                        names.get(index).is_some_and(|name| allowed.contains(name))
                    }
                    _ => true,
                })
        })
    }
}
