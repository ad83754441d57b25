//! Verification: judging pictures with the oracle, and the newest verdict on the picture that is shown.

use std::sync::Arc;

use super::{findings::Findings, screen::Inputs};

/// The oracle's verdict on a picture.
#[derive(Clone)]
pub struct Verdict {
    pub of: Inputs,
    pub findings: Arc<Findings>,
}

/// Judges pictures with the oracle, and keeps the newest verdict on the picture that is shown.
#[derive(Default)]
pub struct Verification {
    verdict: Option<Verdict>,
    /// Judgements under way.
    running: u32,
    /// Of those, judgements of a preset or a size that is not shown any more.
    outdated: u32,
    /// The picture that could not be judged; it is not tried again.
    failed: Option<Inputs>,
}

impl Verification {
    /// The newest verdict, even if another picture is shown now.
    pub fn verdict(&self) -> Option<&Verdict> {
        self.verdict.as_ref()
    }

    /// The verdict on `inputs`, if that is the newest.
    pub fn verdict_on(&self, inputs: Option<&Inputs>) -> Option<&Verdict> {
        self.verdict.as_ref().filter(|verdict| inputs == Some(&verdict.of))
    }

    pub fn is_running(&self) -> bool {
        self.running > 0
    }

    /// True if the judgement of `inputs` failed.
    pub fn has_failed(&self, inputs: Option<&Inputs>) -> bool {
        self.failed.as_ref() == inputs
    }

    /// A judgement was started.
    pub fn started(&mut self) {
        self.running += 1;
    }

    /// A judgement ended. Returns false if it is of a preset or a size that is not shown any more.
    pub fn ended(&mut self) -> bool {
        self.running = self.running.saturating_sub(1);
        let is_outdated = self.outdated > 0;
        self.outdated -= u32::from(is_outdated);
        !is_outdated
    }

    /// Forgets the verdict, because another preset or another size is shown; and those that are still to come.
    pub fn reset(&mut self) {
        self.verdict = None;
        self.outdated = self.running;
    }

    pub fn set(&mut self, verdict: Verdict) {
        self.verdict = Some(verdict);
    }

    pub fn fail(&mut self, inputs: Inputs) {
        self.failed = Some(inputs);
    }
}
