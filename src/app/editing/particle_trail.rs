//! The trail of the particles: how the pointer led them while the preset played.
//!
//! A preset gives its attractor at every time, so its particles can be computed from the first
//! frame on. What the pointer does during playback is not part of the preset: it is recorded here,
//! step by step, until time goes back.

use std::sync::Arc;

use crate::{
    effects::particles,
    scene::{particle_discs::ParticleTimeline, view::View},
};

/// How the pointer led the particles while the preset played.
#[derive(Default)]
pub struct Trail {
    /// Parameter words of every step so far; empty while the particles move as the preset says.
    steps: Vec<Vec<u32>>,
    /// Frame and words that were shown last.
    last: Option<(u32, Vec<u32>)>,
    particle_timeline: Option<Arc<ParticleTimeline>>,
}

impl Trail {
    /// The recorded timeline, if it belongs to the frame that `view` shows.
    pub fn particle_timeline(&self, view: &View) -> Option<Arc<ParticleTimeline>> {
        let shown = view.scene_state.particles.as_ref()?;
        self.particle_timeline
            .clone()
            .filter(|trail| trail.frame == shown.frame)
    }

    /// Takes the frame that is shown now, with its parameter words.
    pub fn follow(&mut self, frame: u32, words: Vec<u32>, playing: bool) {
        let is_unchanged = frame as usize == self.steps.len() && self.steps.last() == Some(&words);
        if (frame as usize) < self.steps.len() || !playing && !is_unchanged {
            self.steps.clear(); // Time went back, or another time was chosen: the preset alone counts again.
        }
        let changed =
            |(before, old): &&(u32, Vec<u32>)| playing && frame > *before && *old != words;
        let begun = self
            .last
            .as_ref()
            .filter(changed)
            .filter(|_| self.steps.is_empty());
        if let Some((before, old)) = begun {
            self.steps = vec![old.clone(); *before as usize];
        }
        if begun.is_some() || !self.steps.is_empty() {
            self.steps.resize(frame as usize, words.clone());
        }
        self.particle_timeline = (!self.steps.is_empty())
            .then(|| Arc::new(particles::along(self.steps.iter().cloned(), frame)));
        self.last = Some((frame, words));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{particles::EFFECT, read};

    #[test]
    fn a_hand_changes_what_comes_and_not_what_was() {
        let [a, b] = [1.0, 2.0].map(|x| {
            let mut words = EFFECT.defaults.clone();
            EFFECT
                .field("attractor")
                .expect("a field")
                .set(&mut words, &[x, 0.0, 0.0])
                .expect("in range");
            words
        });
        let mut trail = Trail::default();
        trail.follow(10, a.clone(), true);
        assert!(trail.particle_timeline.is_none(), "nothing has changed yet");
        trail.follow(13, b.clone(), true);
        let particle_timeline = trail.particle_timeline.clone().expect("a trail");
        let at = |step| read::<particles::Particles>(particle_timeline.words(step)).attractor[0];
        assert_eq!(
            (particle_timeline.frame, particle_timeline.len(), at(10)),
            (13, 13, 1.0)
        );
        assert!(
            at(11) > 1.0 && at(11) < at(12) && at(12) < at(13) && at(13) < 2.0,
            "the attraction follows behind"
        );
        trail.follow(13, b.clone(), false);
        assert!(trail.particle_timeline.is_some(), "a pause keeps it");
        trail.follow(12, b, false);
        assert!(trail.particle_timeline.is_none(), "time went back");
    }
}
