//! Particles: discs that a divergence-free flow carries through the scene.
//!
//! This is the definition for both sides, the kernels in f32 and the oracle in f64.
//!
//! **Random numbers.** Number k of particle i in its life b (counted from 0) is `hash(base + k)`
//! with `base = hash(hash(hash(seed) + i) ^ b)`, all in u32.
//!
//! **Life.** At most `L = max(1, round(lifetime_s rate))` steps, of which `round(L
//! lifetime_variation)`, at most L - 1, are left to chance: L - n steps, where n is the upper word
//! of random number 12 times (that many + 1). In frame 0 a particle is as old as the upper word of
//! random number 13 times its life says. With every step it ages by one; a particle at the end
//! of its life, or would leave the bounds, is born again instead.
//!
//! **Birth.** Numbers 2t and 2t + 1 give attempt t three coordinates: the lower and upper half of
//! the first word and the lower half of the second, less 32768. The first of six attempts inside
//! the ball of radius 32768 counts, else the last one halved. Coordinates over 32768, times
//! `half_axes`, clamped to the bounds, are the position relative to `center`. Velocity is 0.
//!
//! **Step.** dt = 1 / rate. With position p and velocity v of the previous frame,
//! away = attractor - p and pull = attraction 2 r away / (away² + r²), r = `attractor_m`:
//! v' = (v + dt (drag u + pull)) / (1 + dt drag), p' = p + dt v'.
//!
//! **Flow.** u = `speed_mps` [`SPEED_NORMALIZER`] Σ persistence^o curl ψ_o(q) / Σ persistence^o
//! over the octaves o, where q = p 2^o / swirl_m + (o + 1) [`LATTICE_SHIFT`] + (step dt evolve)
//! [`LATTICE_DRIFT`], and ψ_o is value noise: three numbers at every point (x, y, z) of the integer
//! lattice, from the bits 0 to 9, 10 to 19 and 20 to 29 of `hash(hash(hash(x + salt) + y) + z)`, b
//! as (2 b + 1) / 1024 - 1, with `salt = hash(seed ^ 0x9e3779b9) + o`; between them blended by
//! t³(6t² - 15t + 10) along each axis. A curl has no divergence, so nothing piles up.
//!
//! **Disc.** With x the fraction of its life that has passed, a disc has the radius
//! `radius_m` (1 - `radius_variation` n) s(x / fade) s((1 - x) / fade), s the smoothstep and n
//! random number 14 as a fraction of 24 bits. Its color goes from `slow` to `fast` as the speed
//! goes from 0 to `fast_mps`. Its triangle faces the picture plane, its lower side level; normals
//! lean outwards by 0.7 `roundness` at the rim.

use glam::DVec3;

use super::{BuiltIn, Effect, read};
use crate::{
    params::Field,
    words,
    scene::{
        Bounds,
        particle_discs::{ParticleSettings, ParticleTimeline},
    },
};

words! {
    pub struct Particles of "particles" {
        slow: [f32; 4],
        fast: [f32; 4],
        center: [f32; 4],
        half_axes: [f32; 4],
        attractor: [f32; 4],
        count: u32,
        seed: u32,
        rate: u32,
        room_m: f32,
        lifetime_s: f32,
        lifetime_variation: f32,
        speed_mps: f32,
        swirl_m: f32,
        octaves: u32,
        persistence: f32,
        evolve: f32,
        drag: f32,
        attraction: f32,
        attractor_m: f32,
        attractor_lag_s: f32,
        radius_m: f32,
        radius_variation: f32,
        fade: f32,
        roundness: f32,
        fast_mps: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Particles>()
        .with_particles(|words| particle_settings(&read(words)))
        .into()
});

/// Offset between the lattices of one octave and the next.
pub const LATTICE_SHIFT: [f64; 3] = [0.3125, 0.4375, 0.71875];

/// Factor that makes one octave's mean speed about 1.
pub const SPEED_NORMALIZER: f64 = 0.625;

/// Direction in which lattices drift.
pub const LATTICE_DRIFT: [f64; 3] = [0.25, -0.5, 0.375];

/// Frames of a simulation, which then begins again.
pub const FRAMES: u32 = 36_000;

/// How much a normal leans outwards at the rim of a disc, at most.
pub const LEAN: f64 = 0.7;

/// The frame that a preset shows at a time.
pub fn frame_at(particles: &Particles, time_s: f64) -> u32 {
    let frame = (time_s * f64::from(particles.rate)).round_ties_even();
    if frame > 0.0 {
        (frame % f64::from(FRAMES)) as u32
    } else {
        0
    }
}

fn particle_settings(p: &Particles) -> ParticleSettings {
    let origin = DVec3::new(p.center[0].into(), p.center[1].into(), p.center[2].into());
    let room = DVec3::splat(p.room_m.into());
    let bounds = Bounds {
        min: origin - room,
        max: origin + room,
    };
    ParticleSettings {
        count: p.count,
        bounds,
        radius_m: p.radius_m.into(),
    }
}

/// Longest life in steps, and how many of them are left to chance.
pub fn life_steps(p: &Particles) -> [u32; 2] {
    let steps = (f64::from(p.lifetime_s) * f64::from(p.rate))
        .round_ties_even()
        .max(1.0);
    [
        steps as u32,
        ((steps * f64::from(p.lifetime_variation)).round_ties_even() as u32).min(steps as u32 - 1),
    ]
}

/// Does a parameter change only how particles look, not how they move?
pub fn affects_only_appearance(field: &Field) -> bool {
    matches!(
        field.name.as_str(),
        "slow"
            | "fast"
            | "count"
            | "radius_m"
            | "radius_variation"
            | "fade"
            | "roundness"
            | "fast_mps"
    )
}

/// The parameter words of a step; parameters that affect only the appearance have their defaults.
fn step_words(words: &[u32]) -> Vec<u32> {
    let mut step = words.to_vec();
    let default = &EFFECT.defaults;
    EFFECT
        .fields
        .iter()
        .filter(|field| affects_only_appearance(field))
        .for_each(|field| field.copy(default, &mut step));
    step
}

/// The timeline up to a frame, with parameters that do not change.
pub fn constant_timeline(words: &[u32], frame: u32) -> ParticleTimeline {
    ParticleTimeline {
        frame,
        step_params: step_words(words).into(),
        stride: words.len(),
    }
}

/// The timeline with these parameter words for each step. The attraction follows its point with a
/// lag.
pub fn along(steps: impl Iterator<Item = Vec<u32>>, frame: u32) -> ParticleTimeline {
    let (mut step_params, mut stride) = (Vec::new(), 0);
    let mut followed: Option<[f64; 3]> = None;
    for words in steps {
        let mut words = step_words(&words);
        let Particles {
            attractor,
            rate,
            attractor_lag_s,
            ..
        } = read(&words);
        let goal = [0, 1, 2].map(|axis: usize| f64::from(attractor[axis]));
        let approach = 1.0 / (1.0 + f64::from(attractor_lag_s) * f64::from(rate));
        let from = followed.unwrap_or(goal);
        let at = [0, 1, 2].map(|axis: usize| from[axis] + (goal[axis] - from[axis]) * approach);
        followed = Some(at);
        let field = EFFECT.field("attractor").expect("an attractor");
        // The range of the field is convex, so it holds every point between two of its points.
        let _ = field.set(&mut words, &at);
        stride = words.len();
        step_params.extend(words);
    }
    ParticleTimeline {
        frame,
        step_params: step_params.into(),
        stride,
    }
}
