//! How far one step of an f32 adapter may take a particle from the step in f64, for any rounding,
//! order and fusion that WGSL allows. All bounds are along any axis.

use glam::DVec3;

use super::super::render::particles::ReferenceParticle;
use crate::{
    effects::{
        hooks::ROUNDING,
        particles::{LATTICE_DRIFT, LATTICE_SHIFT, Particles},
    },
    frame::ParticleReadback,
};

/// Bounds of one step with these parameters.
pub struct StepBounds<'a> {
    p: &'a Particles,
    frame: u32,
    is_rough: bool,
    is_difference: bool,
}

/// Errors of position (meters) and velocity (meters per second).
#[derive(Clone, Copy)]
struct StepError {
    position: f64,
    velocity: f64,
}

impl<'a> StepBounds<'a> {
    pub fn new(p: &'a Particles, readback: &ParticleReadback, frame: u32) -> Self {
        Self {
            p,
            frame,
            is_rough: readback.has_half_precision,
            is_difference: readback.has_difference_curl,
        }
    }

    /// Returns true if an adapter's particle may be the one of frame 0.
    pub fn is_first(&self, reference: &ReferenceParticle, given: &ReferenceParticle) -> bool {
        is_near(reference, given, &self.born_error())
    }

    /// Returns true if a step may lead from `before` to `given`. In f64 it leads to `moved`, or to
    /// `born` where the life or the room ends.
    pub fn allows(
        &self,
        before: &ReferenceParticle,
        moved: Option<&ReferenceParticle>,
        born: &ReferenceParticle,
        given: &ReferenceParticle,
    ) -> bool {
        let Some(moved) = moved else {
            return is_near(born, given, &self.born_error());
        };
        let error = self.step_error(before, moved);
        let origin = DVec3::new(
            self.p.center[0].into(),
            self.p.center[1].into(),
            self.p.center[2].into(),
        );
        let beyond = (moved.position - origin).abs().max_element() - f64::from(self.p.room_m);
        let wall = error.position
            + 4.0 * ROUNDING * (f64::from(self.p.room_m) + origin.abs().max_element());
        beyond <= wall && is_near(moved, given, &error)
            || beyond >= -wall && is_near(born, given, &self.born_error())
    }

    /// Error of a position stored in 16 bits.
    fn storage_error(&self) -> f64 {
        if self.is_rough {
            f64::from(self.p.room_m) * 1.01 / 32767.0
        } else {
            0.0
        }
    }

    fn born_error(&self) -> StepError {
        let position = 8.0 * ROUNDING * (self.reach() + f64::from(self.p.room_m));
        StepError {
            position: position + self.storage_error(),
            velocity: 0.0,
        }
    }

    /// Largest coordinate in the room.
    fn reach(&self) -> f64 {
        let origin = self.p.center.map(|at| f64::from(at).abs());
        origin[0].max(origin[1]).max(origin[2]) + f64::from(self.p.room_m)
    }

    /// Errors of a step from `before`, which an adapter has exactly, to `moved`.
    fn step_error(&self, before: &ReferenceParticle, moved: &ReferenceParticle) -> StepError {
        let (p, wide) = (self.p, |value: f32| f64::from(value));
        let (dt, drag) = (1.0 / f64::from(p.rate), wide(p.drag));
        // A position in 16 bits is unpacked twice, by the adapter and by the oracle.
        let given = if self.is_rough {
            8.0 * ROUNDING * self.reach()
        } else {
            0.0
        };
        let attractor = p
            .attractor
            .map(wide)
            .iter()
            .fold(0.0, |most: f64, at| most.max(at.abs()));
        let away = 3.0 * ROUNDING * (attractor + before.position.abs().max_element()) + given;
        // The slope of the pull is at most two over its radius; the pull is largest at that
        // distance.
        let pull =
            wide(p.attraction).abs() * (2.0 * 3.0 * away / wide(p.attractor_m) + 32.0 * ROUNDING);
        let damped = dt / (1.0 + dt * drag);
        let terms = before.velocity.abs().max_element()
            + dt * drag * 4.0 * wide(p.speed_mps)
            + dt * wide(p.attraction).abs();
        let mut velocity = damped * (drag * self.flow_error(before.position, given) + pull)
            + 16.0 * ROUNDING * terms;
        let mut position = dt * velocity
            + given
            + 8.0 * ROUNDING * (before.position.abs().max_element() + dt * terms);
        // WGSL allows an adapter to replace every subnormal number by 0, whether it is a parameter,
        // a product or a sum.
        let reach = attractor + before.position.abs().max_element();
        let flushed = 8.0 * f64::from(f32::MIN_POSITIVE) * (1.0 + 4.0 * wide(p.speed_mps) + reach);
        velocity += flushed;
        position += flushed;
        if self.is_rough {
            // f16 has eleven significant bits; below 2^-14 it may be flushed to 0.
            velocity += moved.velocity.abs().max_element() / 1024.0 + 6.2e-5;
            position += self.storage_error() + given;
        }
        StepError { position, velocity }
    }

    /// Error of the flow at a position.
    fn flow_error(&self, position: DVec3, given: f64) -> f64 {
        let p = self.p;
        let drift = f64::from(self.frame) / f64::from(p.rate)
            * f64::from(p.evolve)
            * LATTICE_DRIFT.map(f64::abs)[1];
        let (mut sum, mut amplitude, mut amplitudes) = (0.0, 1.0, 0.0);
        for octave in 0..p.octaves {
            let scale = f64::from(1u32 << octave) / f64::from(p.swirl_m);
            let terms = position.abs().max_element() * scale
                + f64::from(octave + 1) * LATTICE_SHIFT[2]
                + drift;
            let q = 6.0 * ROUNDING * terms + given * scale;
            // Second derivatives of a blend are below 5.8, products of two first ones below 3.6,
            // values below 1: this bounds the slope of a curl. Its evaluation takes a
            // few hundred roundings of numbers about 1.
            let error = if self.is_difference {
                // Third derivatives are below 60 for each blend, times a sixth of the squared step
                // of 1/128; rounding is divided by the step.
                0.003 + 256.0 * (100.0 * ROUNDING + 12.0 * q)
            } else {
                80.0 * q + 400.0 * ROUNDING
            };
            sum += amplitude * error;
            amplitudes += amplitude;
            amplitude *= f64::from(p.persistence);
        }
        f64::from(p.speed_mps) * (sum / amplitudes + 32.0 * ROUNDING)
    }
}

fn is_near(reference: &ReferenceParticle, given: &ReferenceParticle, error: &StepError) -> bool {
    let within = |a: DVec3, b: DVec3, most: f64| (a - b).abs().max_element() <= most;
    (reference.age, reference.births) == (given.age, given.births)
        && within(reference.position, given.position, error.position)
        && within(reference.velocity, given.velocity, error.velocity)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::particles::{born, first, moved};

    #[test]
    fn a_velocity_that_is_subnormal_may_be_0_and_nothing_else() {
        let p = Particles {
            drag: 1e-38,
            attraction: 0.0,
            ..Particles::default()
        };
        let bounds = StepBounds::new(&p, &ParticleReadback::default(), 1);
        let before = first(&p, 3);
        let [moved, born] = [moved(&p, 3, &before, 1).expect("it lives"), born(&p, 3, 1)];
        assert!(
            moved.velocity.length() > 0.0 && moved.velocity.length() < f64::from(f32::MIN_POSITIVE),
            "{moved:?}"
        );
        let with = |velocity: DVec3| ReferenceParticle { velocity, ..moved };
        assert!(bounds.allows(&before, Some(&moved), &born, &with(moved.velocity)));
        assert!(bounds.allows(&before, Some(&moved), &born, &with(DVec3::ZERO)));
        assert!(!bounds.allows(&before, Some(&moved), &born, &with(DVec3::X * 1e-30)));
    }
}
