//! Verification: judging pictures with the oracle, and the newest verdict on the picture that is
//! shown.

use std::sync::Arc;

use web_time::Instant;

use super::{findings::Findings, screen::Inputs};
use crate::{oracle::JUDGE_STAGES, work::Work};

/// The oracle's verdict on a picture.
#[derive(Clone)]
pub struct Verdict {
    pub of: Inputs,
    pub findings: Arc<Findings>,
}

/// A judgement under way.
struct Judgement {
    work: Arc<Work>,
    pixels: f64,
    began: Instant,
    /// It is of a preset that is not shown any more.
    is_outdated: bool,
}

/// Stages of a judgement: the oracle's, and before and after them the drawing and the reference
/// picture.
const STAGES: u32 = JUDGE_STAGES + 2;

/// How far a judgement is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// 0 to 1.
    pub fraction: f64,
    /// Seconds.
    pub left_s: f64,
    pub stage: &'static str,
}

impl Progress {
    /// A judgement that has taken `spent_s` and has begun so many stages, where one of this size is
    /// known to take `whole_s`.
    fn new((stage, begun): (&'static str, u32), spent_s: f64, whole_s: Option<f64>) -> Self {
        let by_stages = f64::from(begun.saturating_sub(1)) / f64::from(STAGES);
        // A judgement that takes longer than the one before is nearly done until it is.
        let whole_s = whole_s
            .unwrap_or(spent_s / by_stages.max(0.1))
            .max(1.02 * spent_s);
        Self {
            fraction: if whole_s > 0.0 {
                spent_s / whole_s
            } else {
                0.0
            },
            left_s: whole_s - spent_s,
            stage,
        }
    }
}

/// Judges pictures with the oracle, and keeps the newest verdict on the picture that is shown.
#[derive(Default)]
pub struct Verification {
    verdict: Option<Verdict>,
    /// Judgements under way, the oldest first.
    running: Vec<Judgement>,
    /// Seconds that the newest finished judgement took for each pixel.
    s_per_pixel: Option<f64>,
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
        self.verdict
            .as_ref()
            .filter(|verdict| inputs == Some(&verdict.of))
    }

    pub fn is_running(&self) -> bool {
        !self.running.is_empty()
    }

    /// True if the judgement of `inputs` failed.
    pub fn has_failed(&self, inputs: Option<&Inputs>) -> bool {
        self.failed.as_ref() == inputs
    }

    /// A judgement of a picture of so many pixels begins. Returns what cancels it.
    pub fn start(&mut self, pixels: f64) -> Arc<Work> {
        let work = Arc::new(Work::default());
        self.running.push(Judgement {
            work: work.clone(),
            pixels,
            began: Instant::now(),
            is_outdated: false,
        });
        work
    }

    /// A judgement ended. Returns false if it is of a preset that is not shown any more.
    pub fn ended(&mut self, work: &Arc<Work>) -> bool {
        let Some(at) = self
            .running
            .iter()
            .position(|judgement| Arc::ptr_eq(&judgement.work, work))
        else {
            return false;
        };
        let Judgement {
            pixels,
            began,
            is_outdated,
            ..
        } = self.running.remove(at);
        if !work.is_canceled() && pixels > 0.0 {
            self.s_per_pixel = Some(began.elapsed().as_secs_f64() / pixels);
        }
        !is_outdated
    }

    /// Ends every judgement at its next row.
    pub fn cancel(&self) {
        self.running
            .iter()
            .for_each(|judgement| judgement.work.cancel());
    }

    /// Forgets the verdict, because another preset is shown, and ends the judgements under way.
    pub fn reset(&mut self) {
        self.verdict = None;
        self.cancel();
        self.running
            .iter_mut()
            .for_each(|judgement| judgement.is_outdated = true);
    }

    /// How far the oldest judgement is; none while there is none.
    pub fn progress(&self) -> Option<Progress> {
        let Judgement {
            work,
            pixels,
            began,
            ..
        } = self.running.first()?;
        Some(Progress::new(
            work.stage(),
            began.elapsed().as_secs_f64(),
            self.s_per_pixel.map(|each_s| each_s * pixels),
        ))
    }

    pub fn set(&mut self, verdict: Verdict) {
        self.verdict = Some(verdict);
    }

    pub fn fail(&mut self, inputs: Inputs) {
        self.failed = Some(inputs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_follows_the_last_judgement_or_the_stages() {
        let known = Progress::new(("colors", 4), 1.0, Some(4.0));
        assert_eq!(
            (known.fraction, known.left_s, known.stage),
            (0.25, 3.0, "colors")
        );
        let slower = Progress::new(("colors", 4), 9.0, Some(4.0));
        assert!(slower.fraction < 1.0 && slower.left_s > 0.0, "{slower:?}");
        let first = Progress::new(("coverage", 2), 1.0, None);
        assert!(
            (first.fraction - 1.0 / f64::from(STAGES)).abs() < 1e-9 && first.left_s > 1.0,
            "{first:?}"
        );
        assert_eq!(Progress::new(("", 0), 0.0, None).fraction, 0.0);
    }

    #[test]
    fn a_canceled_judgement_teaches_nothing_about_the_pace() {
        let mut verification = Verification::default();
        let [first, second] = [verification.start(100.0), verification.start(100.0)];
        verification.cancel();
        assert!(first.is_canceled() && second.is_canceled());
        verification.ended(&first);
        assert!(verification.is_running() && verification.s_per_pixel.is_none());
        verification.ended(&second);
        assert!(!verification.is_running() && verification.progress().is_none());
    }

    #[test]
    fn a_judgement_of_what_is_not_shown_any_more_is_canceled_and_does_not_count() {
        let mut verification = Verification::default();
        let before = verification.start(100.0);
        verification.reset();
        assert!(before.is_canceled());
        let after = verification.start(100.0);
        assert!(
            !verification.ended(&before),
            "it may have ended before it saw that it was canceled"
        );
        assert!(verification.ended(&after));
    }
}
