//! Explode: triangles fly out along their own normals, turning about them and shrinking as they go.
//!
//! A triangle that neither turns nor shrinks is carried along as a whole; one that only turns keeps
//! its area.

use glam::DVec3;

use super::{
    BuiltIn, Effect,
    hooks::{ErrorBound, Front, ROUNDING, Vertex, VertexEffect},
};
use crate::{
    math::{SINE_ERROR, hash_unit, sin_turns},
    words,
};

words! {
    pub struct Explode of "explode" {
        amount_m: f32,
        scatter: f32,
        spin_turns: f32,
        shrink: f32,
        spread: Front,
    }
}

/// What the seed is multiplied by, so that triangles scatter by other hashes than those of the
/// front.
const SCATTER_SEED: u32 = 0x85eb_ca6b;

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Explode>()
    .on_vertex::<Explode>()
    .into()
});

impl VertexEffect for Explode {
    const NEEDS_TRIANGLE: bool = true;

    fn moved(mut v: Vertex, p: &Self) -> Vertex {
        let progress = p.progress(&v);
        let spin = Spin::of(f64::from(p.spin_turns) * progress);
        let arm = v.arm + v.offset;
        let turn = spin.added(v.flat_normal, arm);
        v.offset += v.flat_normal * (f64::from(p.amount_m) * progress) + turn
            - (arm + turn) * (f64::from(p.shrink) * progress);
        v.normal += spin.added(v.flat_normal, v.normal);
        v
    }

    fn error_bound(v: &Vertex, mut error_bound: ErrorBound, p: &Self) -> ErrorBound {
        let [amount, turns, shrink] =
            [p.amount_m, p.spin_turns, p.shrink].map(|f| f64::from(f).abs());
        if amount == 0.0 && turns == 0.0 && shrink == 0.0 {
            return error_bound;
        }
        let progress = p.progress(v);
        let progress_error =
            p.spread
                .error_bound(v.center, v.center_screen, v.triangle, &error_bound)
                + 4.0 * ROUNDING * progress;
        let spin = Spin::of(turns * progress);
        let (sine, versine) = spin.error_bound(turns * (progress_error + ROUNDING * progress));
        // Per axis; lengths of three such are less than twice as long.
        let arm_error = error_bound.arm_m
            + error_bound.offset_m
            + ROUNDING * (v.arm.abs() + v.offset.abs()).max_element();
        let arm = (v.arm + v.offset).length();
        let turn_error = |r: f64, r_error: f64| {
            let most = spin.sine.abs() + sine + spin.versine + versine;
            r * (sine + versine)
                + most * (2.0 * r_error + r * (4.0 * error_bound.flat_normal + 10.0 * ROUNDING))
        };
        let (turn, turn_error_m) = (
            arm * (spin.sine.abs() + spin.versine),
            turn_error(arm, arm_error),
        );
        let flight_error =
            amount * (progress * (error_bound.flat_normal + 4.0 * ROUNDING) + progress_error);
        let shrink_error = shrink
            * (progress * (arm_error + turn_error_m + 4.0 * ROUNDING * (arm + turn))
                + progress_error * (arm + turn));
        let sums = 3.0
            * ROUNDING
            * (v.offset.abs().max_element()
                + amount * progress
                + turn
                + shrink * progress * (arm + turn));
        error_bound.offset_m += flight_error + turn_error_m + shrink_error + sums;
        if turns > 0.0 {
            error_bound.normal += turn_error(1.0, error_bound.normal) + ROUNDING;
        }
        error_bound
    }

    fn max_displacement_m(radius_m: f64, p: &Self) -> f64 {
        let turned = if p.spin_turns == 0.0 { 0.0 } else { 2.0 };
        // No corner is farther from its triangle's center than the model is wide.
        f64::from(p.amount_m).abs() + (turned + f64::from(p.shrink)) * 2.0 * radius_m
    }
}

/// A turn about an axis, as Rodrigues' formula needs it.
struct Spin {
    turns: f64,
    sine: f64,
    /// 1 - cosine, from the sine of half the angle.
    versine: f64,
}

impl Spin {
    fn of(turns: f64) -> Self {
        let half = sin_turns(turns * 0.5);
        Self {
            turns,
            sine: sin_turns(turns),
            versine: 2.0 * half * half,
        }
    }

    /// What the turn about the unit axis `n` adds to `r`.
    fn added(&self, n: DVec3, r: DVec3) -> DVec3 {
        let across = n.cross(r);
        across * self.sine + n.cross(across) * self.versine
    }

    /// Bounds of the errors of sine and versine in f32, given that of the angle in turns; none
    /// without a turn.
    fn error_bound(&self, turns: f64) -> (f64, f64) {
        if self.turns == 0.0 && turns == 0.0 {
            return (0.0, 0.0);
        }
        let sine = std::f64::consts::TAU * turns + SINE_ERROR;
        let half = 0.5 * std::f64::consts::TAU * turns + SINE_ERROR;
        let versine = 4.0 * (0.5 * self.versine).sqrt() * half
            + 2.0 * half * half
            + 3.0 * ROUNDING * self.versine;
        (sine.min(2.0), versine.min(2.0))
    }
}

impl Explode {
    /// How far a triangle has moved along its path, 0 to 1.
    fn progress(&self, v: &Vertex) -> f64 {
        let reached = self.spread.reached(v.center, v.center_screen, v.triangle);
        reached
            * (1.0
                - f64::from(self.scatter)
                    * hash_unit(v.triangle ^ self.spread.seed.wrapping_mul(SCATTER_SEED)))
    }
}
