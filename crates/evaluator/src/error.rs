//! Why a function cannot be lowered, or an evaluation ended without a result.

use std::ops::Range;

/// Why a function cannot be evaluated on the CPU.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LowerError {
    #[error("there is no function `{0}`")]
    NoFunction(String),
    #[error("`{function}` uses {what}, which cannot be evaluated on the CPU")]
    Unsupported {
        what: String,
        function: String,
        span: Option<Range<usize>>,
    },
    #[error("`{function}` uses the variable `{name}`, which is not available to it")]
    Global {
        name: String,
        function: String,
        span: Option<Range<usize>>,
    },
    #[error("the override constant `{name}` has neither a value nor a default")]
    Override { name: String },
    #[error("`{function}` needs more than {limit} words of memory")]
    Slots {
        limit: usize,
        function: String,
        span: Option<Range<usize>>,
    },
    #[error("`{function}`, with the functions that it calls, is longer than {limit} instructions")]
    Instructions {
        limit: usize,
        function: String,
        span: Option<Range<usize>>,
    },
    #[error("`{function}` calls functions more than {limit} deep")]
    Depth {
        limit: usize,
        function: String,
        span: Option<Range<usize>>,
    },
    /// Not the evaluator's limit but a module that naga's validator rejects.
    #[error("`{function}` is not valid: {what}")]
    Invalid {
        what: String,
        function: String,
        span: Option<Range<usize>>,
    },
}

impl LowerError {
    /// Where in the source, in bytes, if known.
    pub fn span(&self) -> Option<Range<usize>> {
        match self {
            LowerError::NoFunction(_) | LowerError::Override { .. } => None,
            LowerError::Unsupported { span, .. }
            | LowerError::Global { span, .. }
            | LowerError::Slots { span, .. }
            | LowerError::Instructions { span, .. }
            | LowerError::Depth { span, .. }
            | LowerError::Invalid { span, .. } => span.clone(),
        }
    }

    /// Line of `source` that the error is about, from 1, if known.
    pub fn line(&self, source: &str) -> Option<usize> {
        let start = self.span()?.start;
        Some(
            1 + source
                .bytes()
                .take(start)
                .filter(|&byte| byte == b'\n')
                .count(),
        )
    }
}

/// Why a call gave no result.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EvalError {
    #[error("`{function}` did not end within {steps} steps")]
    Steps { steps: u64, function: String },
    #[error("the function takes {expected} words of arguments, not {given}")]
    Arguments { expected: usize, given: usize },
    #[error("global variable {index} has {expected} words, not {given}")]
    Global {
        index: usize,
        expected: usize,
        given: usize,
    },
}
