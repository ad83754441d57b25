//! Names of keyframes, and what a row shows of them.

use std::sync::Arc;

use crate::{
    effects::Effect,
    preset::{Preset, animation::Track},
};

/// What the keyframe button of a row shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keying {
    /// Not animated.
    Still,
    /// Animated, with no keyframe at the time shown.
    Between,
    /// Animated, with a keyframe at the time shown.
    OnKey,
}

/// One keyframe of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyId {
    pub effect: Arc<Effect>,
    /// Name of the parameter.
    pub field: String,
    pub time_s: f64,
}

impl KeyId {
    /// `facet.front`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.effect.name, self.field)
    }

    /// Its track and its index there.
    pub fn find<'a>(&self, preset: &'a Preset) -> Option<(&'a Track, usize)> {
        let track = preset.animation.get(&self.effect.name, &self.field)?;
        Some((track, track.at(self.time_s)?))
    }
}
