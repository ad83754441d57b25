//! Sky: what surrounds the scene is seen where nothing is drawn.
//!
//! The environments are those that the effect studio reflects: a formula, or a picture of light.

use glam::{DVec2, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{
        ImageAt, PassEffect,
        environment::{Environment, Seen, turned_by},
        tone::turned,
    },
};
use crate::words;

words! {
    pub struct Sky of "sky" {
        environment: u32,
        turn_deg: f32,
        strength: f32,
        blur: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Sky>()
    .on_passes::<Sky>()
    .in_surroundings()
    .into()
});

/// How far a direction in f32 may be off its place in a picture, whose side is 1.
const PLACE_ERROR: f64 = 1.0 / (1 << 20) as f64;

impl PassEffect for Sky {
    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let (triangle_id, ..) = at.input.picture.at(at.x, at.y);
        if triangle_id.is_some() {
            return at.color(at.x, at.y);
        }
        let toward = turned_by(at.direction(at.middle()), turned(p.turn_deg.into()));
        let surroundings = Seen::of(Environment::of(p.environment), at.input.panorama);
        let blur = f64::from(p.blur);
        // What a direction of f32 may be off in a picture: along both diagonals.
        let (along, across) = (at.step_offset.signum() * f64::from(at.step_offset != 0.0), at.input.signs.at(at.x, at.y));
        let moved = DVec2::new(along + across, along - across) * PLACE_ERROR;
        let light = surroundings.radiance(toward, blur * blur, moved);
        (light * f64::from(p.strength)).extend(1.0)
    }
}
