//! A stress case: what it expects, how it runs, and what it reports.

use super::{checks::EarlyEnd, context::CaseContext};
use crate::gpu::Renderer;

/// The expected outcome of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// Every integer equals the oracle's, with every exact option and work distribution; colors are
    /// within one step of 255.
    Exact,
    /// Correct within this bound.
    Bounded(&'static str),
    /// Refused with a sentence that names this limit.
    Refused(&'static str),
}

/// One extreme case.
pub struct Case {
    /// Number of its row in the table; several cases may share one.
    pub number: u32,
    /// Unique; lower-case words joined by hyphens.
    pub name: &'static str,
    /// What it draws and checks, in one line.
    pub about: &'static str,
    pub expectation: Expectation,
    /// Draws and checks.
    pub(super) run: fn(&mut CaseContext) -> Result<(), EarlyEnd>,
}

/// The outcome of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The expectation holds.
    Passed,
    /// Refused as expected, with this sentence.
    Refused(String),
    /// Not run, because the adapter lacks what this sentence names.
    Skipped(String),
    /// The expectation does not hold, for these reasons.
    Failed(String),
}

impl Outcome {
    /// The outcome as shown in tables.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Refused(_) => "refused as expected",
            Self::Skipped(_) => "skipped",
            Self::Failed(_) => "FAILED",
        }
    }

    /// The reason of a refusal, a skip or a failure.
    pub fn why(&self) -> Option<&str> {
        match self {
            Self::Refused(why) | Self::Skipped(why) | Self::Failed(why) => Some(why),
            Self::Passed => None,
        }
    }

    /// Returns true if the expectation does not hold.
    pub const fn is_failure(&self) -> bool {
        matches!(self, Self::Failed(_))
    }
}

/// The result of running a case.
#[derive(Clone, Debug)]
pub struct Report {
    pub outcome: Outcome,
    /// The seed, if the case uses random numbers.
    pub seed: Option<u32>,
    /// Remarks of the case, for instance what was skipped on this adapter.
    pub notes: Vec<String>,
    pub pictures: u64,
}

impl Case {
    /// Runs the case. The renderer can be used for the next case after every outcome.
    pub fn run(&self, renderer: &mut Renderer, seed: u32) -> Report {
        let mut context = CaseContext::new(renderer, seed);
        let result = (self.run)(&mut context);
        let refusal = context.refusal.take();
        let outcome = match (result, self.expectation) {
            (Err(EarlyEnd::Failed(why)), _) => Outcome::Failed(why),
            (Err(EarlyEnd::Skipped(why)), _) => Outcome::Skipped(why),
            (Ok(()), Expectation::Refused(limit)) => match refusal {
                Some(sentence) => Outcome::Refused(sentence),
                None => Outcome::Failed(format!("it was drawn but must be refused: {limit}")),
            },
            (Ok(()), _) => Outcome::Passed,
        };
        context.leave(outcome)
    }
}
