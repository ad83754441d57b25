//! Steps of colour: a value that lies on one in f64 may lie on its other side in f32, and then either answer is right.
//!
//! An effect decides a step on a value plus a nudge, so shading with a small nudge to either side finds out which pixels
//! lie so near. They are the band: derived without a look at the result, counted, and capped by whoever has a budget.
//! Textures are looked up a little aside in the same way; there what lies between the answers is right as well.

use super::{
    finish::{Seen, finish_all, shade_nudged},
    layers::Layered,
    texels::{ASIDES, Aside},
};
use crate::{
    effects::{Stack, hooks::Slot},
    frame::Geometry,
    scene::{Scene, draw::Draw, view::View},
};

/// How far from a step a value may lie for both sides to be right; values are about 1 at most. 2^-15: a shade is some
/// 2^7 operations that err by 2^-23 each, if all err alike, and the rest is room for `pow` and cancelled weights.
pub const NUDGE: f64 = 1.0 / (1 << 15) as f64;

/// By how much a judge's answer differs from the straight one: in what decides a step, and in where textures are looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Nudge {
    pub step: f64,
    pub aside: Aside,
}

/// The right pictures: one, or with steps three, and of each as many as there are ways to preset aside.
pub struct Answers {
    pictures: Vec<Vec<[u8; 4]>>,
    /// Whatever lies between them is right too.
    is_span: bool,
    /// Every so many pictures one differs by a step.
    stride: usize,
}

impl Answers {
    pub fn of(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack, seen: &Seen, geometry: &Geometry) -> Self {
        let shaded = |&nudge: &Nudge| shade_nudged(scene, draws, view, stack, seen, geometry, nudge);
        // Taps of a shadow map fall one by one, so anything between all and none of the doubtful ones is right.
        let is_span = has_texels(scene) || stack.light().is_some();
        Self { pictures: ways(scene, stack).iter().map(shaded).collect(), is_span, stride: 1 }
    }

    /// What lies between the least and the most that a picture of layers may show.
    pub fn between(draws: &[Draw], view: &View, stack: &Stack, seen: &Seen, layered: &Layered) -> Self {
        let ends = [0, 1].map(|end| layered.bounds.iter().map(|bounds| bounds[end]).collect::<Vec<_>>());
        let finished =
            |&nudge: &f64| [&layered.colors, &ends[0], &ends[1]].map(|colors| finish_all(draws, view, stack, seen, colors, nudge));
        Self { pictures: nudges(stack).iter().flat_map(finished).collect(), is_span: true, stride: 3 }
    }

    /// The picture as f64 has it.
    pub fn middle(&self) -> Vec<[u8; 4]> {
        self.pictures[0].clone()
    }

    /// Of every channel, the right answer that is nearest to the adapter's.
    pub fn nearest(&self, adapter: &[[u8; 4]]) -> Vec<[u8; 4]> {
        let channel = |i: usize, c: usize| {
            let answers = self.pictures.iter().map(|answer| answer[i][c]);
            if self.is_span {
                let (least, most) = answers.fold((u8::MAX, u8::MIN), |(least, most), answer| (least.min(answer), most.max(answer)));
                return adapter[i][c].clamp(least, most);
            }
            answers.min_by_key(|answer| answer.abs_diff(adapter[i][c])).expect("there is an answer")
        };
        (0..adapter.len()).map(|i| [0, 1, 2, 3].map(|c| channel(i, c))).collect()
    }

    /// Which pixels have answers more than a step of 255 apart because of a step of colour; empty where none can.
    pub fn band(&self) -> Vec<bool> {
        // Of a span, the middles of what it goes through.
        let answers: Vec<_> = self.pictures.iter().step_by(self.stride).collect();
        let [middle, others @ ..] = answers.as_slice() else { return Vec::new() };
        if others.is_empty() {
            return Vec::new();
        }
        let differs = |i: usize| others.iter().any(|other| (0..4).any(|c| other[i][c].abs_diff(middle[i][c]) > 1));
        (0..middle.len()).map(differs).collect()
    }
}

/// How far steps are moved, nothing first.
pub(super) fn nudges(stack: &Stack) -> &'static [f64] {
    // A picture of layers is summed in linear light, and gamma is 13 times as steep where it is dark, before it meets a step.
    const FAR: f64 = 4.0 * NUDGE;
    match (stack.has_steps(), stack.in_slot(Slot::Visibility)) {
        (false, _) => &[0.0],
        (true, None) => &[0.0, -NUDGE, NUDGE],
        (true, Some(_)) => &[0.0, -FAR, FAR],
    }
}

/// Every nudge of a look at `scene`, nothing first.
pub(super) fn ways(scene: &Scene, stack: &Stack) -> Vec<Nudge> {
    let asides = if has_texels(scene) { &ASIDES[..] } else { &ASIDES[..1] };
    nudges(stack).iter().flat_map(|&step| asides.iter().map(move |&aside| Nudge { step, aside })).collect()
}

fn has_texels(scene: &Scene) -> bool {
    !scene.images.is_empty()
}
