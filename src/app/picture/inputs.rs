//! Inputs: everything a picture in the window depends on.

use std::sync::Arc;

#[cfg(target_arch = "wasm32")]
use crate::{
    app::editing::session::Session,
    preset_file::{self, PresetFile},
};
use crate::{
    effects::{
        Stack,
        given::{Given, words_of_pointer, words_of_view},
    },
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
    /// What a picture of `preset_file` depends on, of `size` pixels and at the preset's own time.
    #[cfg(target_arch = "wasm32")]
    pub fn of(preset_file: PresetFile, scene: Arc<Scene>, size: [u32; 2]) -> Self {
        let session = Session::new(preset_file);
        let preset = session.preset();
        let length_scale = session.length_scale(preset, size);
        Self {
            view: session.view_at(&scene, size),
            stack: preset
                .in_meters(&scene)
                .stack_at(preset.clock.time_s)
                .drawn(length_scale),
            accuracy: preset.accuracy,
            scene,
        }
        .given(None)
    }

    /// The preset that says all of this, as its text does; none where no text does: particles that
    /// the pointer has led, a preset that was kept for a comparison.
    #[cfg(target_arch = "wasm32")]
    pub fn preset(&self, session: &Session) -> Option<PresetFile> {
        let mut said = session.preset_file.clone();
        said.preset.scene = said.scene_source();
        said.preset.clock.time_s = session.next_time_s();
        session
            .muted
            .iter()
            .for_each(|effect| said.preset.disable(effect));
        said.preset.accuracy = self.accuracy;
        let text = preset_file::to_shared_toml(&said);
        let said = preset_file::parse(&text, &said.id).ok()?;
        let size = [self.view.width, self.view.height];
        (Self::of(said.clone(), self.scene.clone(), size) == *self).then_some(said)
    }

    /// The same with what effects are given of the view, and of the pointer where it is over the
    /// picture, in pixels.
    #[must_use]
    pub fn given(mut self, pointer: Option<[f32; 2]>) -> Self {
        let View {
            width,
            height,
            eye,
            forward,
            ..
        } = self.view;
        self.stack = self.stack.with_given(|given| match (given, pointer) {
            (Given::Pointer, Some(at)) => Some(words_of_pointer(at, true)),
            _ => words_of_view(given, [width, height], eye, forward),
        });
        self
    }

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
