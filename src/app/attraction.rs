//! Attraction: the hand that draws particles along, and the trail that its way leaves while time runs.
//!
//! A preset says where its attractor is at every moment, so its particles can be found from the first frame on. What a hand
//! does while they fly is no part of the preset: it is kept here, step by step, until time goes back.

use std::sync::Arc;

use eframe::egui::{self, PointerButton};
use glam::DVec3;

use super::App;
use crate::{
    effects::particles::{self, EFFECT},
    params::Stored as _,
    scene::{particle_discs::ParticleTimeline, view::View},
};

/// See the module's first line.
#[derive(Default)]
pub struct Trail {
    /// Parameter words of every step so far; empty while the particles fly as the preset alone has it.
    steps: Vec<Vec<u32>>,
    /// Frame and words that were shown last.
    last: Option<(u32, Vec<u32>)>,
    particle_timeline: Option<Arc<ParticleTimeline>>,
}

impl Trail {
    /// Takes in what is shown now.
    fn follow(&mut self, frame: u32, words: Vec<u32>, playing: bool) {
        let stands = frame as usize == self.steps.len() && self.steps.last() == Some(&words);
        if (frame as usize) < self.steps.len() || !playing && !stands {
            self.steps.clear(); // Time went back, or a hand chose another moment: the preset alone counts again.
        }
        let changed = |(before, old): &&(u32, Vec<u32>)| playing && frame > *before && *old != words;
        let begun = self.last.as_ref().filter(changed).filter(|_| self.steps.is_empty());
        if let Some((before, old)) = begun {
            self.steps = vec![old.clone(); *before as usize];
        }
        if begun.is_some() || !self.steps.is_empty() {
            self.steps.resize(frame as usize, words.clone());
        }
        self.particle_timeline = (!self.steps.is_empty()).then(|| Arc::new(particles::along(self.steps.iter().cloned(), frame)));
        self.last = Some((frame, words));
    }
}

impl App {
    /// Keeps the trail of the particles up to the moment that is shown.
    pub(super) fn follow_particles(&mut self) {
        let preset = self.shown_preset();
        // Where there are keys, they say how the particles fly.
        match preset.particle_timeline().filter(|particle_timeline| particle_timeline.len() == 1) {
            Some(particle_timeline) => {
                self.trail.follow(particle_timeline.frame, particle_timeline.words(1).to_vec(), self.playback.playing)
            }
            None => self.trail = Trail::default(),
        }
    }

    /// The view as the hand has left the particles.
    pub(super) fn with_trail(&self, mut view: View) -> View {
        if let (Some(particle_timeline), Some(trail)) = (&view.particle_timeline, &self.trail.particle_timeline)
            && particle_timeline.frame == trail.frame
        {
            view.particle_timeline = Some(trail.clone());
        }
        view
    }

    /// While Ctrl (Cmd on macOS) is held, a drag moves the attractor over the plane through it that faces the viewer; true while it does.
    pub(super) fn attract(&mut self, response: &egui::Response) -> bool {
        let command = response.ctx.input(|i| i.modifiers.command);
        let is_on = command && response.dragged_by(PointerButton::Primary) && self.visible_stack().particle_settings().is_some();
        let (Some(field), Some((_, scene)), true) = (EFFECT.field("attractor"), self.scene_loader.shown.clone(), is_on) else {
            return false;
        };
        let Some((at, value)) = response.interact_pointer_pos().zip(self.shown_value(&EFFECT, field)) else { return true };
        let size = response.rect.size().round();
        let view = self.view_at(&scene, [size.x.max(1.0) as u32, size.y.max(1.0) as u32]);
        let place = (at - response.rect.min) / response.rect.size();
        let ndc = [2.0 * f64::from(place.x) - 1.0, 1.0 - 2.0 * f64::from(place.y)];
        let point = facing_point(&view, DVec3::new(value[0], value[1], value[2]), ndc);
        if let Some(point) = point {
            let [low, high] = field.hard;
            self.put_value(&EFFECT, field, &point.clamp(DVec3::splat(low), DVec3::splat(high)).to_value());
        }
        true
    }
}

/// Where the ray of a point of the picture meets the plane through a point of the scene that faces the viewer; in the scene.
fn facing_point(view: &View, through: DVec3, ndc: [f64; 2]) -> Option<DVec3> {
    let through = view.world_from_scene.transform_point3(through);
    let depth = (through - view.eye).dot(view.forward);
    let aside = view.ndc_axes[0] * ndc[0] + view.ndc_axes[1] * ndc[1];
    let point = match view.linear_depth_m {
        None if depth <= 0.0 => return None,
        None => view.eye + (view.forward + aside) * depth,
        Some(_) => view.eye + aside + view.forward * depth,
    };
    Some(view.world_from_scene.inverse().transform_point3(point)).filter(|point| point.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        effects::read,
        scene::{
            Bounds,
            camera::{Camera, Projection},
        },
    };

    #[test]
    fn a_hand_changes_what_comes_and_not_what_was() {
        let [a, b] = [1.0, 2.0].map(|x| {
            let mut words = (EFFECT.defaults)();
            EFFECT.field("attractor").expect("a field").set(&mut words, &[x, 0.0, 0.0]).expect("in range");
            words
        });
        let mut trail = Trail::default();
        trail.follow(10, a.clone(), true);
        assert!(trail.particle_timeline.is_none(), "nothing has changed yet");
        trail.follow(13, b.clone(), true);
        let particle_timeline = trail.particle_timeline.clone().expect("a trail");
        let at = |step| read::<particles::Particles>(particle_timeline.words(step)).attractor[0];
        assert_eq!((particle_timeline.frame, particle_timeline.len(), at(10)), (13, 13, 1.0));
        assert!(at(11) > 1.0 && at(11) < at(12) && at(12) < at(13) && at(13) < 2.0, "the attraction follows behind");
        trail.follow(13, b.clone(), false);
        assert!(trail.particle_timeline.is_some(), "a pause keeps it");
        trail.follow(12, b, false);
        assert!(trail.particle_timeline.is_none(), "time went back");
    }

    #[test]
    fn a_point_of_the_picture_is_met_again_where_it_was_taken() {
        for projection in [Projection::Perspective { fov_y_deg: 50.0 }, Projection::Orthographic { height_m: 3.0 }] {
            let camera = Camera { eye: DVec3::new(1.0, 2.0, 5.0), target: DVec3::new(0.2, 0.0, 0.0), projection, ..Camera::default() };
            let bounds = Bounds { min: DVec3::NEG_ONE, max: DVec3::ONE };
            let view = View::new(&camera, 300, 200, &bounds, crate::math::rotation_y(0.7), [0.0; 4]);
            let through = DVec3::new(0.3, -0.4, 0.1);
            let clip = view.clip_from_world * view.world_from_scene * through.extend(1.0);
            let point = facing_point(&view, through, [clip.x / clip.w, clip.y / clip.w]).expect("in front of the eye");
            assert!(point.distance(through) < 1e-9, "{projection:?}: {point}");
        }
    }
}
