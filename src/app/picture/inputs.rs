//! Inputs: everything a picture in the window depends on.

use std::sync::Arc;

use crate::{
    effects::Stack,
    preset::AccuracyRequest,
    scene::{Scene, view::View},
};

/// Everything a picture depends on.
#[derive(Clone, Debug)]
pub struct Inputs {
    pub scene: Arc<Scene>,
    pub view: View,
    pub stack: Stack,
    pub accuracy: AccuracyRequest,
}

impl PartialEq for Inputs {
    fn eq(&self, other: &Self) -> bool {
        let Self {
            scene,
            view,
            stack,
            accuracy,
        } = self;
        Arc::ptr_eq(scene, &other.scene)
            && *view == other.view
            && *stack == other.stack
            && *accuracy == other.accuracy
    }
}

impl Inputs {
    /// The same frustum on fewer pixels, with lengths in pixels as much smaller, so that nothing
    /// jumps when a motion ends.
    pub fn reduced(&self, divisor: u32) -> Self {
        let mut inputs = self.clone();
        inputs.stack = inputs.stack.scaled(1.0 / f64::from(divisor));
        inputs.view.width = inputs.view.width.div_ceil(divisor);
        inputs.view.height = inputs.view.height.div_ceil(divisor);
        inputs
    }

    /// True if both show the same, perhaps in different tiers.
    pub fn is_same_but_for_tier(&self, other: &Self) -> bool {
        let accuracy = AccuracyRequest {
            tier: other.accuracy.tier,
            measured: other.accuracy.measured,
            ..self.accuracy
        };
        let Self {
            scene, view, stack, ..
        } = self;
        Arc::ptr_eq(scene, &other.scene)
            && *view == other.view
            && *stack == other.stack
            && accuracy == other.accuracy
    }

    /// True if both are drawn by the same kernels, unless the camera requires others.
    pub fn shares_kernels(&self, other: &Self) -> bool {
        let has_same_effects = || {
            self.stack.0.iter().map(|enabled| &enabled.effect).eq(other
                .stack
                .0
                .iter()
                .map(|enabled| &enabled.effect))
        };
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.accuracy == other.accuracy
            && has_same_effects()
    }

    /// Names of the effects that `shown` does not have.
    pub fn new_effects(&self, shown: Option<&Self>) -> Vec<String> {
        let is_new = |name: &&String| shown.is_none_or(|shown| shown.stack.get(name).is_none());
        self.stack
            .0
            .iter()
            .map(|enabled| &enabled.effect.name)
            .filter(is_new)
            .cloned()
            .collect()
    }
}
