//! Matcap: paints a surface by the way it faces in the view, as a ball of some material looks under
//! lamps that move with the eye.
//!
//! The color holds its own light: it counts as glow, so that lights after it leave it alone.

use glam::DVec3;

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput, hooks::tone::smooth};
use crate::{choice, params};

choice! {
    /// What the ball is made of.
    pub enum Ball {
        /// Warm and matt, as a sculptor's.
        Clay = "clay",
        /// Light enters it and leaves it around the rim.
        Wax = "wax",
        /// Dark green stone with a sharp highlight.
        Jade = "jade",
        /// A mirror of a sky and a ground.
        Chrome = "chrome",
    }
}

params! {
    pub struct Matcap {
        /// What the ball is made of.
        ball: Ball = Ball::Clay as u32;
        /// How much the surface's own color tints the ball.
        tint: f32 = 1.0, hard 0.0..=1.0;
        /// How much of the ball is seen.
        amount: f32 = 1.0, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Matcap>(
        "matcap",
        "Matcap",
        "paints by the way a surface faces: a ball of clay, wax, jade or chrome",
    )
    .into()
});

/// Least length of the direction to the right. Where the eye looks nearly straight up or down, the
/// direction has no use, and fades out.
const SHORTEST: f64 = 0.4;
/// Direction to the main lamp, and half way between it and the eye: right, up, towards the eye.
const LAMP: DVec3 = DVec3::new(-0.45, 0.6, 0.6614);
const HALF_WAY: DVec3 = DVec3::new(-0.2469, 0.3292, 0.9114);

/// A ball that no surroundings are seen in; colors are linear.
struct Paint {
    /// Where the lamp does not reach, and where it meets the surface straight on.
    dark: DVec3,
    bright: DVec3,
    /// Added where the surface turns away from the eye.
    rim: DVec3,
    /// Strength of the highlight, and how sharp it is: 0 to 1.
    gloss: f64,
    sharp: f64,
}

const CLAY: Paint = Paint {
    dark: DVec3::new(0.075, 0.03, 0.028),
    bright: DVec3::new(0.78, 0.4, 0.26),
    rim: DVec3::new(0.07, 0.08, 0.12),
    gloss: 0.05,
    sharp: 0.0,
};
const WAX: Paint = Paint {
    dark: DVec3::new(0.3, 0.085, 0.025),
    bright: DVec3::new(0.92, 0.74, 0.46),
    rim: DVec3::new(0.4, 0.13, 0.03),
    gloss: 0.3,
    sharp: 0.25,
};
const JADE: Paint = Paint {
    dark: DVec3::new(0.004, 0.04, 0.026),
    bright: DVec3::new(0.05, 0.29, 0.16),
    rim: DVec3::new(0.16, 0.34, 0.22),
    gloss: 0.75,
    sharp: 0.9,
};

impl SurfaceEffect for Matcap {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Color,
        SurfaceInput::Glow,
        SurfaceInput::Normal,
        SurfaceInput::View,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let right = DVec3::new(s.view.z, 0.0, -s.view.x);
        let right = right / right.length().max(SHORTEST);
        let up = s.view.cross(right);
        let facing = DVec3::new(s.normal.dot(right), s.normal.dot(up), s.normal.dot(s.view));
        let ball = match Ball::of(p.ball) {
            Ball::Clay => painted(facing, &CLAY),
            Ball::Wax => painted(facing, &WAX),
            Ball::Jade => painted(facing, &JADE),
            Ball::Chrome => mirrored(facing),
        };
        let base = s.color.truncate();
        let (tint, amount) = (f64::from(p.tint), f64::from(p.amount));
        let shown = ball * (DVec3::ONE + (base - DVec3::ONE) * tint);
        s.color = (base + (shown - base) * amount).extend(s.color.w);
        s.glow += (shown - s.glow) * amount;
        s
    }
}

/// The color of a painted ball where it faces this way: right, up, towards the eye.
fn painted(facing: DVec3, paint: &Paint) -> DVec3 {
    let light = (0.6 * facing.dot(LAMP) + 0.4).clamp(0.0, 1.0);
    let away = 1.0 - facing.z.clamp(0.0, 1.0);
    let power_16 = facing.dot(HALF_WAY).clamp(0.0, 1.0).powi(16);
    let power_64 = power_16.powi(4);
    let highlight = power_16 + (power_64 - power_16) * paint.sharp;
    paint.dark
        + (paint.bright - paint.dark) * (light * light)
        + paint.rim * (away * away)
        + DVec3::splat(paint.gloss * highlight)
}

/// What a mirror ball shows where it faces this way: a sky above a ground, and the lamp.
fn mirrored(facing: DVec3) -> DVec3 {
    let seen = facing * (2.0 * facing.z) - DVec3::Z;
    let mix = |from: [f64; 3], to: [f64; 3], by: f64| {
        let (from, to) = (DVec3::from_array(from), DVec3::from_array(to));
        from + (to - from) * by
    };
    let sky = mix(
        [0.86, 0.92, 1.0],
        [0.13, 0.24, 0.46],
        smooth(0.0, 0.9, seen.y),
    );
    let ground = mix(
        [0.035, 0.028, 0.03],
        [0.42, 0.34, 0.27],
        smooth(0.0, 0.9, -seen.y),
    );
    let horizon = smooth(-0.08, 0.08, seen.y);
    let lamp = smooth(0.86, 0.96, seen.dot(LAMP));
    ground + (sky - ground) * horizon + DVec3::splat(0.9 * lamp)
}
