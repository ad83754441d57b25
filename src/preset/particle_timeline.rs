//! The flow of a preset: how far its particles have come, and what their steps went by.

use std::sync::Arc;

use super::{Preset, animation::Track};
use crate::{
    effects::{
        particles::{self, EFFECT, Particles},
        read,
    },
    scene::particle_discs::ParticleTimeline,
};

/// Does a track change how particles fly?
pub(super) fn is_steering(track: &Track) -> bool {
    track.effect() == &EFFECT && track.keys().len() > 1 && !particles::is_for_presets(track.field())
}

impl Preset {
    /// The flow at the time of the clock; none without particles.
    pub fn particle_timeline(&self) -> Option<Arc<ParticleTimeline>> {
        let words = &self.stack.get(EFFECT.name)?.words;
        let words_at = |time_s: f64| self.animation.evaluate_words(EFFECT.name, words, time_s);
        let now = words_at(self.clock.time_s);
        let particles: Particles = read(&now);
        let frame = particles::frame_at(&particles, self.clock.time_s);
        Some(Arc::new(if self.animation.tracks().iter().any(is_steering) {
            particles::along((1..=frame.max(1)).map(|step| words_at(f64::from(step) / f64::from(particles.rate))), frame)
        } else {
            particles::constant_timeline(&now, frame)
        }))
    }
}
