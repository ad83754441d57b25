//! Verdicts: asking the oracle for one, and what is known of the picture that is shown.

use std::sync::Arc;

use super::{App, Level, overlays::Findings, screen::Inputs, topbar::error_text};
use crate::measure::ErrorReport;

/// How wrong a picture was found to be.
#[derive(Clone)]
pub struct Verdict {
    pub of: Inputs,
    pub findings: Arc<Findings>,
}

impl App {
    /// The measured error of the picture as it stands.
    pub fn accuracy(&self) -> Option<&ErrorReport> {
        self.verdict.as_ref().filter(|verdict| self.screen.drawn() == Some(&verdict.of)).map(|verdict| &verdict.findings.accuracy)
    }

    /// What is known of the picture that is shown.
    pub(super) fn findings(&self) -> Option<&Arc<Findings>> {
        let verdict = self.verdict.as_ref()?;
        (self.motion.wanted.as_ref() == Some(&verdict.of)).then_some(&verdict.findings)
    }

    /// Lets the oracle judge the picture that is shown, and what it is compared with.
    pub(super) fn verify(&mut self) {
        if self.verifying > 0 {
            return;
        }
        self.judge_shown();
        if let Some(inputs) = self.compare.unjudged().filter(|inputs| Some(inputs) != self.motion.wanted.as_ref()) {
            self.judge(inputs);
        }
    }

    /// Lets the oracle judge the picture that is shown.
    pub(super) fn judge_shown(&mut self) {
        if let Some(inputs) = self.motion.wanted.clone() {
            self.judge(inputs);
        }
    }

    fn judge(&mut self, inputs: Inputs) {
        self.verifying += 1;
        self.jobs.verify(self.screen.gpu.clone(), inputs);
    }

    pub(super) fn verdict_arrived(&mut self, of: Inputs, findings: Result<Box<Findings>, String>) {
        self.verifying = self.verifying.saturating_sub(1);
        match findings {
            Ok(findings) => {
                self.log.add(Level::Info, format!("verified {}: {}", self.preset_file.title(), error_text(&findings.accuracy)));
                let verdict = Verdict { of, findings: findings.into() };
                if !self.compare.take_verdict(&verdict) || self.motion.wanted.as_ref() == Some(&verdict.of) {
                    self.verdict = Some(verdict);
                }
            }
            Err(error) => {
                self.tell(Level::Error, error);
                self.judgement_failed(of);
            }
        }
    }
}
