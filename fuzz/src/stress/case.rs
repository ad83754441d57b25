//! A stress case: what it expects, how it runs, and what it reports.

use std::panic::{AssertUnwindSafe, catch_unwind};

use web_time::Instant;

use super::checks::EarlyEnd;
use super::context::{CaseContext, Counts};
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

impl std::fmt::Display for Expectation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::Bounded(bound) => write!(f, "within: {bound}"),
            Self::Refused(limit) => write!(f, "refused: {limit}"),
        }
    }
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
    /// The user stopped the run.
    Stopped,
}

impl Outcome {
    /// The outcome as shown in tables.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Refused(_) => "refused as expected",
            Self::Skipped(_) => "skipped",
            Self::Failed(_) => "FAILED",
            Self::Stopped => "stopped",
        }
    }

    /// The reason of a refusal, a skip or a failure.
    pub fn why(&self) -> Option<&str> {
        match self {
            Self::Refused(why) | Self::Skipped(why) | Self::Failed(why) => Some(why),
            Self::Passed | Self::Stopped => None,
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
    pub number: u32,
    pub name: &'static str,
    pub about: &'static str,
    pub expectation: Expectation,
    pub outcome: Outcome,
    /// The seed, if the case uses random numbers.
    pub seed: Option<u32>,
    /// Remarks of the case, for instance what was skipped on this adapter.
    pub notes: Vec<String>,
    /// Duration of the case, milliseconds.
    pub ms: f64,
    pub counts: Counts,
}

impl Case {
    /// Runs the case. `keep_going` receives what is drawn next and may stop the run by returning
    /// false. The renderer can be used for the next case after every outcome. Within
    /// [`Work`](rasterlab::work::Work) that is canceled, the case ends as stopped.
    pub fn run(
        &self,
        renderer: &mut Renderer,
        seed: u32,
        keep_going: &dyn Fn(&str) -> bool,
    ) -> Report {
        let began = Instant::now();
        let mut context = CaseContext::new(renderer, seed, keep_going);
        let result =
            catch_unwind(AssertUnwindSafe(|| (self.run)(&mut context))).unwrap_or_else(|panic| {
                Err(EarlyEnd::Failed(format!(
                    "the program panicked: {}",
                    said(panic.as_ref())
                )))
            });
        let left = context.leave();
        let outcome = match (result, self.expectation) {
            (Err(EarlyEnd::Failed(why)), _) => Outcome::Failed(why),
            (Err(EarlyEnd::Skipped(why)), _) => Outcome::Skipped(why),
            (Err(EarlyEnd::Stopped), _) => Outcome::Stopped,
            (Ok(()), Expectation::Refused(limit)) => match left.refusal {
                Some(sentence) => Outcome::Refused(sentence),
                None => Outcome::Failed(format!("it was drawn but must be refused: {limit}")),
            },
            (Ok(()), _) => Outcome::Passed,
        };
        Report {
            number: self.number,
            name: self.name,
            about: self.about,
            expectation: self.expectation,
            outcome,
            seed: left.seed,
            notes: left.notes,
            ms: began.elapsed().as_secs_f64() * 1e3,
            counts: left.counts,
        }
    }
}

/// The message of a panic.
fn said(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("no message")
}
