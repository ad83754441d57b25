//! A function in the form in which it is executed.

use std::collections::HashMap;
use std::ops::Range;

use crate::instruction::Instruction;
use crate::word::Word;

/// How floats are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// In f64 without any rounding to f32; a literal is the decimal number that was written.
    #[default]
    Double,
    /// Rounded to f32 after every operation, to compare with GPUs and other evaluators.
    Single,
    /// The same, and a sample stops where WGSL leaves the value of an operation open: what it makes
    /// or reads is not finite, a power has no positive base, or a smooth step no width.
    Strict,
}

/// Bounds on what a function may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Instructions executed by one call, counted at the end of every turn of a loop by the length
    /// of its body.
    pub steps: u64,
    /// Scratch memory in words of 8 bytes.
    pub slots: usize,
    /// Length of the lowered code, all calls inlined.
    pub instructions: usize,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            steps: 1_000_000,
            slots: 1 << 16,
            instructions: 1 << 17,
        }
    }
}

/// How a function is lowered. Names that the module does not have are ignored.
#[derive(Clone, Debug, Default)]
pub struct Options<'a> {
    pub precision: Precision,
    pub limits: Limits,
    /// Values of override constants by name, or by number for those with an `@id`; true is any
    /// value but 0. Others keep their defaults.
    pub overrides: HashMap<String, f64>,
    /// Functions that the host implements. Their bodies are not looked at.
    pub externals: Vec<String>,
    /// Module-scope variables that the host supplies by `Machine::set_global`. Private variables
    /// need not be supplied.
    pub globals: Vec<String>,
    /// Text from which the module was parsed: with it a literal has all its digits. Without it,
    /// and for constants that are used by name or that naga computed from others, a literal is
    /// the shortest decimal number that names its f32.
    pub source: Option<&'a str>,
    /// Words at the end of the arguments that are alike in all samples of a run.
    pub alike: usize,
}

/// A function of a shader, lowered to flat code over scalars, with all calls inlined. Immutable:
/// threads share it, each with registers of its own.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) precision: Precision,
    pub(crate) steps: u64,
    /// Words before the first call: constants in place, all others zero. Registers of what is alike
    /// in all samples are places among them, all others are rows.
    pub(crate) image: Vec<Word>,
    /// What is computed of words that are alike, once for all samples.
    pub(crate) first: Vec<Instruction>,
    /// Words that are alike, and the rows in which the code reads them.
    pub(crate) spread: Vec<(u32, u32)>,
    /// The same for rows that the code changes.
    pub(crate) spread_again: Vec<(u32, u32)>,
    pub(crate) code: Vec<Instruction>,
    /// Number of rows.
    pub(crate) rows: usize,
    /// The row of each word of the arguments that the code reads.
    pub(crate) arguments: Vec<Option<u32>>,
    /// The words of the arguments that are alike.
    pub(crate) alike: Range<usize>,
    /// The row of each word of the result; none of one that is the argument word of that index.
    pub(crate) result: Vec<Option<u32>>,
    /// Words of each of `Options::globals` that the function reaches.
    pub(crate) globals: Vec<Option<Range<usize>>>,
    /// First instruction of each stretch of code, and the function it is from.
    pub(crate) marks: Vec<(u32, u32)>,
    pub(crate) names: Vec<String>,
}

impl Program {
    /// Scalars of all arguments, flattened in the order in which members, components, columns and
    /// elements are declared.
    pub fn argument_words(&self) -> usize {
        self.arguments.len() + self.alike.len()
    }

    /// Those of them that samples have of their own.
    pub fn own_argument_words(&self) -> usize {
        self.arguments.len()
    }

    /// Scalars of the result; 0 for a function without one.
    pub fn result_words(&self) -> usize {
        self.result.len()
    }

    /// Scalars of a variable of `Options::globals`; none if the function does not reach it.
    pub fn global_words(&self, index: usize) -> Option<usize> {
        Some(self.globals.get(index)?.as_ref()?.len())
    }

    /// Length of the code.
    pub fn instructions(&self) -> usize {
        self.first.len() + self.code.len()
    }

    pub(crate) fn function_at(&self, instruction: usize) -> &str {
        let after = self
            .marks
            .partition_point(|&(first, _)| first as usize <= instruction);
        let name = after
            .checked_sub(1)
            .and_then(|mark| self.names.get(self.marks[mark].1 as usize));
        name.map_or("", String::as_str)
    }
}
