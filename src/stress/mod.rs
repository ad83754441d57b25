//! Stress: the table of extreme cases, one list for tests, `rasterlab stress` and the window's button.
//!
//! Every case says what is expected, draws on a [`Renderer`] whatever tells whether that holds, and lets the oracle judge;
//! where an answer is published or can be counted on fingers, that answer judges as well. A case is its row in [`CASES`]
//! and a function in the file of its kind.

pub mod adversarial;
mod against;
mod clipping;
mod context;
mod coverage;
mod depth;
mod effects;
mod parameters;
mod published;
mod queues;
pub mod scenes;
mod skins;
mod strict;
mod targets;
mod time;
mod values;

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    time::Instant,
};

pub use context::{CaseContext, Counts, EarlyEnd, captured, exactness, judged, options, pinned, quick_option, stack, tunings};

use crate::gpu::Renderer;

/// What a case must come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// Every integer is the oracle's, colours within one step of 255; on every option and tuning the same.
    Exact,
    /// Right within this bound.
    Bounded(&'static str),
    /// Not drawn, with a sentence that names the limit.
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
    /// Its row in the table of extreme cases; several cases may share one.
    pub number: u32,
    /// Unique, lower case, joined by hyphens.
    pub name: &'static str,
    /// One line for people.
    pub about: &'static str,
    pub expectation: Expectation,
    run: fn(&mut CaseContext) -> Result<(), EarlyEnd>,
}

/// What became of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// As expected.
    Passed,
    /// Refused, as expected; the sentence.
    Refused(String),
    /// This adapter lacks what it takes; the sentence.
    Skipped(String),
    /// Not as expected; the sentences.
    Failed(String),
    /// Somebody stopped the run.
    Stopped,
}

impl Outcome {
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Refused(_) => "refused as stated",
            Self::Skipped(_) => "left out",
            Self::Failed(_) => "FAILED",
            Self::Stopped => "stopped",
        }
    }

    /// Why, where there is more to say.
    pub fn why(&self) -> Option<&str> {
        match self {
            Self::Refused(why) | Self::Skipped(why) | Self::Failed(why) => Some(why),
            Self::Passed | Self::Stopped => None,
        }
    }

    pub const fn is_failure(&self) -> bool {
        matches!(self, Self::Failed(_))
    }
}

/// A case with what became of it.
#[derive(Clone, Debug)]
pub struct Report {
    pub number: u32,
    pub name: &'static str,
    pub about: &'static str,
    pub expectation: Expectation,
    pub outcome: Outcome,
    /// The seed, where chance had a hand in it.
    pub seed: Option<u32>,
    /// What the case wants to be known: how large a mask was, which part this adapter cannot do.
    pub notes: Vec<String>,
    pub ms: f64,
    pub counts: Counts,
}

/// The table, by number.
pub const CASES: &[&[Case]] = &[
    published::CASES,
    coverage::CASES,
    clipping::CASES,
    values::CASES,
    depth::CASES,
    queues::CASES,
    targets::CASES,
    time::CASES,
    effects::CASES,
    parameters::CASES,
    skins::CASES,
    against::CASES,
    strict::CASES,
];

/// Every case, by its number and then in the order of the table.
pub fn cases() -> Vec<&'static Case> {
    let mut cases: Vec<&Case> = CASES.iter().copied().flatten().collect();
    cases.sort_by_key(|case| case.number);
    cases
}

/// Cases of the number that `filter` is, or else those whose name contains it; all without one.
pub fn chosen(filter: Option<&str>) -> Vec<&'static Case> {
    let filter = filter.unwrap_or_default().trim().to_lowercase();
    let is_meant = |case: &&Case| match filter.parse::<u32>() {
        Ok(number) => case.number == number,
        Err(_) => case.name.contains(&filter),
    };
    cases().into_iter().filter(is_meant).collect()
}

impl Case {
    /// Draws and judges. `keep_going` hears what is about to be drawn and may stop the run. Whatever happens, the renderer can
    /// be used for the next case.
    pub fn run(&self, renderer: &mut Renderer, seed: u32, keep_going: &dyn Fn(&str) -> bool) -> Report {
        let began = Instant::now();
        let mut context = CaseContext::new(renderer, seed, keep_going);
        let result = catch_unwind(AssertUnwindSafe(|| (self.run)(&mut context)))
            .unwrap_or_else(|panic| Err(EarlyEnd::Failed(format!("the program stumbled: {}", said(panic.as_ref())))));
        let left = context.leave();
        let outcome = match (result, self.expectation) {
            (Err(EarlyEnd::Failed(why)), _) => Outcome::Failed(why),
            (Err(EarlyEnd::Skipped(why)), _) => Outcome::Skipped(why),
            (Err(EarlyEnd::Stopped), _) => Outcome::Stopped,
            (Ok(()), Expectation::Refused(limit)) => match left.refusal {
                Some(sentence) => Outcome::Refused(sentence),
                None => Outcome::Failed(format!("it was drawn, where it should have been refused: {limit}")),
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

/// What a panic said.
fn said(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("without a word")
}

/// Ends a case with a sentence unless the condition holds.
macro_rules! hold {
    ($condition:expr, $($sentence:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err($crate::stress::EarlyEnd::Failed(format!($($sentence)+)));
        }
    };
}
use hold;

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_unique_and_every_row_of_the_table_has_a_case() {
        let cases = cases();
        let names: BTreeSet<_> = cases.iter().map(|case| case.name).collect();
        assert_eq!(names.len(), cases.len());
        let is_plain = |name: &str| name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-');
        assert!(names.iter().all(|name| is_plain(name)), "{names:?}");
        let rows: BTreeSet<_> = cases.iter().map(|case| case.number).collect();
        assert_eq!(rows, (1..=33).collect());
    }

    #[test]
    fn a_filter_is_a_number_or_a_part_of_a_name() {
        assert!(chosen(Some("3")).iter().all(|case| case.number == 3));
        assert!(!chosen(Some("3")).is_empty() && chosen(Some("99")).is_empty());
        assert!(chosen(Some(" Fan ")).iter().any(|case| case.name.contains("fan")));
        assert_eq!(chosen(None).len(), cases().len());
    }
}
