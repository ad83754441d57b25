//! Sky: what surrounds the scene is seen where nothing is drawn.
//!
//! The environments are those that the effect studio reflects.

use glam::DVec4;

use super::{
    BuiltIn, Effect,
    hooks::{
        ImageAt, PassEffect,
        environment::{Environment, Surroundings, turned_by},
        tone::turned,
    },
};
use crate::params;

params! {
    pub struct Sky {
        /// What surrounds the scene.
        environment: Environment = Environment::Studio as u32;
        /// Turns it about the vertical axis.
        turn_deg: f32 = 0.0, hard -36000.0..=36000.0, soft -180.0..=180.0, unit "°";
        /// Strength of its light.
        strength: f32 = 1.0, hard 0.0..=1000.0, soft 0.0..=4.0;
        /// How blurred it is: 0 not at all, 1 as a matt mirror shows it.
        blur: f32 = 0.3, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Sky>(
        "sky",
        "Sky",
        "what surrounds the scene is seen where nothing is drawn",
    )
    .on_passes::<Sky>()
    .into()
});

impl PassEffect for Sky {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let (triangle_id, ..) = at.input.picture.at(at.x, at.y);
        if triangle_id.is_some() {
            return at.color(at.x, at.y);
        }
        let toward = turned_by(at.direction(at.middle()), turned(p.turn_deg.into()));
        let surroundings = Surroundings::of(Environment::of(p.environment));
        let blur = f64::from(p.blur);
        let light = surroundings.radiance(toward, blur * blur);
        (light * f64::from(p.strength)).extend(1.0)
    }
}
