//! What a tier is expected to cost and to err by, before it is drawn: from the plan of the picture that is shown, and its time.

use super::state::State;
use crate::{
    effects::Stack,
    gpu::Gpu,
    plan::{Plan, Tier, predict::Prediction},
    preset::AccuracyRequest,
};

/// What a picture is expected to cost and to err by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expectation {
    /// None without a time of the picture that is shown.
    pub ms: Option<f64>,
    /// None if the picture cannot be drawn in this tier.
    pub error: Option<Prediction>,
}

/// What the picture that is shown would cost and err by in `tier`, with the options that the preset pins; none before the first picture.
pub fn expectation(state: &State, tier: Tier) -> Option<Expectation> {
    let (plan, drawn) = (state.screen.plan()?, state.screen.drawn()?);
    let ms = state.screen.timings().cost_ms();
    Some(of(plan, &drawn.stack, &state.screen.gpu, AccuracyRequest { tier, ..drawn.accuracy }, ms))
}

fn of(plan: &Plan, stack: &Stack, gpu: &Gpu, request: AccuracyRequest, ms: Option<f64>) -> Expectation {
    let Ok(other) = plan.under(stack, &gpu.caps.tuning(), &request) else { return Expectation { ms: None, error: None } };
    let ratio = other.expected_time() / plan.expected_time();
    Expectation { ms: ms.map(|ms| ms * ratio), error: Some(other.prediction) }
}
