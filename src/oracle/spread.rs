//! Spread: how far one step of an f32 adapter may take a particle from the step in f64, whatever rounding, order and fusion
//! WGSL allows. All bounds are along any axis.

use glam::DVec3;

use super::particles::ReferenceParticle;
use crate::{
    effects::{
        hooks::ROUNDING,
        particles::{LATTICE_DRIFT, LATTICE_SHIFT, Particles},
    },
    frame::ParticleReadback,
};

/// See the module's first line.
pub(super) struct Spread<'a> {
    p: &'a Particles,
    frame: u32,
    is_rough: bool,
    is_difference: bool,
}

/// Errors of place and velocity.
#[derive(Clone, Copy)]
struct ErrorBound {
    place: f64,
    velocity: f64,
}

impl<'a> Spread<'a> {
    pub fn new(p: &'a Particles, particle_readback: &ParticleReadback, frame: u32) -> Self {
        Self { p, frame, is_rough: particle_readback.is_rough, is_difference: particle_readback.is_difference }
    }

    /// Is this where and what a particle is in frame 0?
    pub fn is_first(&self, reference: &ReferenceParticle, given: &ReferenceParticle) -> bool {
        is_near(reference, given, &self.born_slack())
    }

    /// May a step lead from `before` to `given`? In reference it leads to `moved`, or to `born` where the life or the room ends.
    pub fn allows(
        &self,
        before: &ReferenceParticle,
        moved: Option<&ReferenceParticle>,
        born: &ReferenceParticle,
        given: &ReferenceParticle,
    ) -> bool {
        let Some(moved) = moved else { return is_near(born, given, &self.born_slack()) };
        let error_bound = self.error_bound(before, moved);
        let origin = DVec3::new(self.p.origin[0].into(), self.p.origin[1].into(), self.p.origin[2].into());
        let beyond = (moved.place - origin).abs().max_element() - f64::from(self.p.room_m);
        let wall = error_bound.place + 4.0 * ROUNDING * (f64::from(self.p.room_m) + origin.abs().max_element());
        beyond <= wall && is_near(moved, given, &error_bound) || beyond >= -wall && is_near(born, given, &self.born_slack())
    }

    /// What keeping a place in 16 bits does to it.
    fn grain(&self) -> f64 {
        if self.is_rough { f64::from(self.p.room_m) * 1.01 / 32767.0 } else { 0.0 }
    }

    fn born_slack(&self) -> ErrorBound {
        let place = 8.0 * ROUNDING * (self.reach() + f64::from(self.p.room_m));
        ErrorBound { place: place + self.grain(), velocity: 0.0 }
    }

    /// Largest coordinate in the room.
    fn reach(&self) -> f64 {
        let origin = self.p.origin.map(|at| f64::from(at).abs());
        origin[0].max(origin[1]).max(origin[2]) + f64::from(self.p.room_m)
    }

    fn error_bound(&self, before: &ReferenceParticle, moved: &ReferenceParticle) -> ErrorBound {
        let (p, wide) = (self.p, |value: f32| f64::from(value));
        let (dt, drag) = (1.0 / f64::from(p.rate), wide(p.drag));
        // A rough place is unpacked twice, here and there.
        let given = if self.is_rough { 8.0 * ROUNDING * self.reach() } else { 0.0 };
        let attractor = p.attractor.map(wide).iter().fold(0.0, |most: f64, at| most.max(at.abs()));
        let away = 3.0 * ROUNDING * (attractor + before.place.abs().max_element()) + given;
        // No slope of the pull is steeper than two over its radius, and it is largest at that distance.
        let pull = wide(p.attraction).abs() * (2.0 * 3.0 * away / wide(p.attractor_m) + 32.0 * ROUNDING);
        let share = dt / (1.0 + dt * drag);
        let terms = before.velocity.abs().max_element() + dt * drag * 4.0 * wide(p.speed_mps) + dt * wide(p.attraction).abs();
        let mut velocity = share * (drag * self.particle_timeline(before.place, given) + pull) + 16.0 * ROUNDING * terms;
        let mut place = dt * velocity + given + 8.0 * ROUNDING * (before.place.abs().max_element() + dt * terms);
        if self.is_rough {
            // Halves have eleven bits; below 2^-14 they are 0.
            velocity += moved.velocity.abs().max_element() / 1024.0 + 6.2e-5;
            place += self.grain() + given;
        }
        ErrorBound { place, velocity }
    }

    /// Error of the flow at a place.
    fn particle_timeline(&self, place: DVec3, given: f64) -> f64 {
        let p = self.p;
        let drift = f64::from(self.frame) / f64::from(p.rate) * f64::from(p.evolve) * LATTICE_DRIFT.map(f64::abs)[1];
        let (mut sum, mut share, mut shares) = (0.0, 1.0, 0.0);
        for octave in 0..p.octaves {
            let scale = f64::from(1u32 << octave) / f64::from(p.swirl_m);
            let terms = place.abs().max_element() * scale + f64::from(octave + 1) * LATTICE_SHIFT[2] + drift;
            let q = 6.0 * ROUNDING * terms + given * scale;
            // Second derivatives of a blend stay below 5.8, products of two first ones below 3.6, values below 1: that bounds
            // how fast a curl changes, and its evaluation takes a few hundred roundings of numbers about 1.
            let error = if self.is_difference {
                // Third derivatives below 60 a blend, over a sixth of a squared step of 1/128; rounding is divided by the step.
                0.003 + 256.0 * (100.0 * ROUNDING + 12.0 * q)
            } else {
                80.0 * q + 400.0 * ROUNDING
            };
            sum += share * error;
            shares += share;
            share *= f64::from(p.persistence);
        }
        f64::from(p.speed_mps) * (sum / shares + 32.0 * ROUNDING)
    }
}

fn is_near(reference: &ReferenceParticle, given: &ReferenceParticle, error_bound: &ErrorBound) -> bool {
    let within = |a: DVec3, b: DVec3, most: f64| (a - b).abs().max_element() <= most;
    (reference.age, reference.births) == (given.age, given.births)
        && within(reference.place, given.place, error_bound.place)
        && within(reference.velocity, given.velocity, error_bound.velocity)
}
