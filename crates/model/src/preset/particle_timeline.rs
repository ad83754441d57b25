//! The particle timeline of a preset: the number of simulation steps, and the parameters of each.

use std::sync::Arc;

use super::{Preset, animation::Track};
use crate::{
    effects::{
        particles::{self, EFFECT, Particles},
        read,
    },
    scene::particle_discs::ParticleTimeline,
};

impl Preset {
    /// The timeline at the time of the clock; none without particles.
    pub fn particle_timeline(&self) -> Option<Arc<ParticleTimeline>> {
        let words = &self.stack.get(&EFFECT.name)?.words;
        let words_at = |time_s: f64| self.animation.evaluate_words(&EFFECT.name, words, time_s);
        let now = words_at(self.clock.time_s);
        let particles: Particles = read(&now);
        let frame = particles::frame_at(&particles, self.clock.time_s);
        Some(Arc::new(
            if self
                .animation
                .tracks()
                .iter()
                .any(Track::changes_simulation)
            {
                particles::along(
                    (1..=frame.max(1))
                        .map(|step| words_at(f64::from(step) / f64::from(particles.rate))),
                    frame,
                )
            } else {
                particles::constant_timeline(&now, frame)
            },
        ))
    }
}
