//! Rules: which covered samples are drawn, by the sample effects of the stack. Integers alone.

use super::coverage::OrientedTriangle;
use crate::{
    effects::{
        Stack,
        hooks::{Sample, SampleHook},
    },
    frame::Geometry,
};

/// The sample effects of a stack with what they settled per triangle.
#[derive(Default)]
pub struct Rules<'a> {
    effects: Vec<Link<'a>>,
    decisions: &'a [[u32; 4]],
    /// Effects that decide, and so decisions per entry.
    deciding: usize,
}

struct Link<'a> {
    hook: SampleHook,
    words: &'a [u32],
    /// Place among the effects that decide.
    place: Option<usize>,
}

impl<'a> Rules<'a> {
    /// The rules of `stack`, with the decisions that `geometry` carries.
    pub fn of(stack: &'a Stack, geometry: &'a Geometry) -> Self {
        let mut deciding = 0;
        let effects = stack
            .each(|hooks| hooks.sample)
            .map(|(hook, words)| {
                let place = hook.decides.then_some(deciding);
                deciding += usize::from(hook.decides);
                Link { hook, words, place }
            })
            .collect();
        Self { effects, decisions: &geometry.decisions, deciding }
    }

    /// Is a covered sample drawn? `weights` are the doubled areas opposite the corners of the oriented triangle.
    pub(super) fn is_drawn(&self, triangle: &OrientedTriangle, x: u32, y: u32, weights: [i64; 3]) -> bool {
        if self.effects.is_empty() {
            return true;
        }
        let area: i64 = weights.iter().sum();
        let shift = (64 - area.unsigned_abs().leading_zeros()).saturating_sub(31);
        let mut parts = weights.map(|weight| (weight.max(0) >> shift) as u32);
        if triangle.is_turned {
            parts.swap(1, 2);
        }
        self.effects.iter().all(|link| {
            let decided = link.place.map_or([0; 4], |place| self.decisions[triangle.entry * self.deciding + place]);
            (link.hook.is_drawn)(&Sample { x, y, triangle: triangle.id, parts, decided }, link.words)
        })
    }
}
