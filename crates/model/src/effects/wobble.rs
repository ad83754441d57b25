//! Wobble: a wave runs through the model and sways it, normals and all.
//!
//! The displacement is u(x) = sway A sin(2π (direction·x / λ - phase)), its Jacobian I + slope sway
//! directionᵀ, and a normal goes with the cofactors of that: n (1 + slope sway·direction) -
//! direction slope (sway·n). The phase is given in turns within one turn, so a wave that has run
//! for a day is as exact as a new one.

use glam::DVec3;

use super::{
    BuiltIn, Effect,
    hooks::{ErrorBound, ROUNDING, Vertex, VertexEffect},
};
use crate::{
    math::{SINE_ERROR, cos_turns, sin_turns},
    words,
};

words! {
    pub struct Wobble of "wobble" {
        direction: [f32; 4],
        sway: [f32; 4],
        amplitude_m: f32,
        wavelength_m: f32,
        phase_turns: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Wobble>()
    .on_vertex::<Wobble>()
    .into()
});

/// Below this squared length a turned normal has no direction and is not changed.
const DEGENERATE: f64 = 1e-12;

/// The wave at one vertex.
struct Wave {
    direction: DVec3,
    sway: DVec3,
    amplitude: f64,
    /// Distance along `direction`, wavelengths.
    distance: f64,
    turns: f64,
    /// Change of the displacement along `direction`.
    slope: f64,
    /// The normal after the turn, of any length.
    turned: DVec3,
}

impl Wave {
    fn at(v: &Vertex, p: &Wobble) -> Self {
        let (direction, sway) = (unit(p.direction, DVec3::Y), unit(p.sway, DVec3::X));
        let (amplitude, wavelength) = (f64::from(p.amplitude_m), f64::from(p.wavelength_m));
        let distance = (v.position + v.offset).dot(direction) / wavelength;
        let turns = distance - f64::from(p.phase_turns);
        let slope = std::f64::consts::TAU * amplitude / wavelength * cos_turns(turns);
        let turned = v.normal * (1.0 + slope * sway.dot(direction))
            - direction * (slope * sway.dot(v.normal));
        Self {
            direction,
            sway,
            amplitude,
            distance,
            turns,
            slope,
            turned,
        }
    }
}

impl VertexEffect for Wobble {
    const NEEDS_TRIANGLE: bool = false;

    fn moved(mut v: Vertex, p: &Self) -> Vertex {
        let wave = Wave::at(&v, p);
        v.offset += wave.sway * (wave.amplitude * sin_turns(wave.turns));
        if wave.slope != 0.0 && wave.turned.length_squared() > DEGENERATE {
            v.normal = wave.turned.normalize();
        }
        v
    }

    fn error_bound(v: &Vertex, mut error_bound: ErrorBound, p: &Self) -> ErrorBound {
        let wave = Wave::at(v, p);
        if wave.amplitude == 0.0 {
            return error_bound;
        }
        let (position, direction) = (v.position + v.offset, wave.direction.abs());
        let wavelength = f64::from(p.wavelength_m);
        let given =
            error_bound.position_m + error_bound.offset_m + ROUNDING * position.abs().max_element();
        // A unit vector errs by ten roundings, the sum of products by four.
        let along =
            given * direction.element_sum() + 14.0 * ROUNDING * direction.dot(position.abs());
        let turns =
            along / wavelength + ROUNDING * (4.0 * wave.distance.abs() + f64::from(p.phase_turns));
        let sine = (std::f64::consts::TAU * turns + SINE_ERROR).min(2.0);
        error_bound.offset_m +=
            wave.amplitude * (sine + 14.0 * ROUNDING) + ROUNDING * v.offset.abs().max_element();
        // An error of the sine sways too. That of an earlier wave counts as one in any direction.
        error_bound.along_m = wave.sway * (wave.amplitude * sine);

        let steepest = std::f64::consts::TAU * wave.amplitude / wavelength;
        let slope = steepest * (sine + 2.0 * ROUNDING + 6.0 * ROUNDING);
        let turned = 2.0 * error_bound.normal * (1.0 + 2.0 * wave.slope.abs())
            + 2.0 * slope
            + ROUNDING * (4.0 + 40.0 * wave.slope.abs());
        let length = wave.turned.length();
        error_bound.normal = if turned < 0.5 * length {
            turned / (length - turned) + 10.0 * ROUNDING
        } else {
            2.0
        };
        error_bound
    }

    fn max_displacement_m(_: f64, p: &Self) -> f64 {
        p.amplitude_m.into()
    }
}

/// Direction of a parameter; `otherwise` where it has none. Components below the normal floats are
/// 0, as on a GPU.
fn unit(point: [f32; 4], otherwise: DVec3) -> DVec3 {
    let component = |k: usize| {
        if point[k].is_normal() {
            f64::from(point[k])
        } else {
            0.0
        }
    };
    DVec3::new(component(0), component(1), component(2))
        .try_normalize()
        .unwrap_or(otherwise)
}
