//! Explode: triangles fly out along their own normals, turning about them and shrinking as they go.
//!
//! A triangle that neither turns nor shrinks is carried along as a whole; one that only turns keeps its area.

use glam::DVec3;

use super::{
    Effect,
    hooks::{Front, Pattern, ROUNDING, front_of, ErrorBound, Vertex, VertexEffect},
};
use crate::{
    math::{SINE_ERROR, hash_unit, sin_turns},
    params,
    params::Point,
};

params! {
    pub struct Explode {
        /// Centre of the radial front, world space.
        center: Point = [0.0, 0.0, 0.0, 0.0], soft -3.0..=3.0, unit "m", when ("pattern", &["radial"]);
        /// How far a triangle flies along its normal; negative: inwards.
        amount_m: f32 = 0.3, hard -1e3..=1e3, soft -1.0..=2.0, unit "m";
        /// How unlike the triangles fly: at 0 all alike, at 1 some not at all.
        scatter: f32 = 0.0, hard 0.0..=1.0;
        /// Turns that a triangle makes about its normal on its way.
        spin_turns: f32 = 0.0, hard -100.0..=100.0, soft -1.0..=1.0, unit "turns";
        /// Share of its size that a triangle loses on its way.
        shrink: f32 = 0.0, hard 0.0..=1.0;
        /// How the blast is spread over the triangles.
        pattern: Pattern = Pattern::Uniform as u32;
        /// Progress of the front: 0 before the first triangle, 1 past the last.
        front: f32 = 0.5, hard 0.0..=1.0, when ("pattern", &["sweep", "random"]);
        /// Softness of the front, as a fraction of its path.
        width: f32 = 0.5, hard 0.001..=100.0, soft 0.001..=2.0, log true, when ("pattern", &["sweep", "random"]);
        /// Direction of the sweep in the picture: part to the right.
        along_x: f32 = 1.0, hard -1.0..=1.0, when ("pattern", &["sweep"]);
        /// Direction of the sweep in the picture: part downwards.
        along_y: f32 = 0.0, hard -1.0..=1.0, when ("pattern", &["sweep"]);
        /// Distance of the front from the centre.
        radius_m: f32 = 1.0, hard 0.0..=1e6, soft 0.0..=5.0, unit "m", when ("pattern", &["radial"]);
        /// Thickness of the front.
        width_m: f32 = 0.5, hard 0.001..=1e6, soft 0.01..=5.0, unit "m", log true, when ("pattern", &["radial"]);
        /// Seed of scatter and random times.
        seed: u32 = 1, soft 0.0..=999.0;
    }
}

pub const EFFECT: Effect =
    Effect::new::<Explode>("explode", "Explode", "triangles fly out along their own normals, turn and shrink").on_vertex::<Explode>();

impl VertexEffect for Explode {
    const NEEDS_TRIANGLE: bool = true;

    fn moved(mut v: Vertex, p: &Self) -> Vertex {
        let share = p.share(&v);
        let spin = Spin::of(f64::from(p.spin_turns) * share);
        let arm = v.arm + v.offset;
        let turn = spin.added(v.flat_normal, arm);
        v.offset += v.flat_normal * (f64::from(p.amount_m) * share) + turn - (arm + turn) * (f64::from(p.shrink) * share);
        v.normal += spin.added(v.flat_normal, v.normal);
        v
    }

    fn error_bound(v: &Vertex, mut error_bound: ErrorBound, p: &Self) -> ErrorBound {
        let [amount, turns, shrink] = [p.amount_m, p.spin_turns, p.shrink].map(|f| f64::from(f).abs());
        if amount == 0.0 && turns == 0.0 && shrink == 0.0 {
            return error_bound;
        }
        let share = p.share(v);
        let share_slack = p.front().error_bound(v.center, v.center_screen, v.triangle, &error_bound) + 4.0 * ROUNDING * share;
        let spin = Spin::of(turns * share);
        let (sine, versine) = spin.error_bound(turns * (share_slack + ROUNDING * share));
        // Per axis; lengths of three such are less than twice as long.
        let arm_slack = error_bound.arm_m + error_bound.offset_m + ROUNDING * (v.arm.abs() + v.offset.abs()).max_element();
        let arm = (v.arm + v.offset).length();
        let turn_slack = |r: f64, r_slack: f64| {
            let most = spin.sine.abs() + sine + spin.versine + versine;
            r * (sine + versine) + most * (2.0 * r_slack + r * (4.0 * error_bound.flat_normal + 10.0 * ROUNDING))
        };
        let (turn, turn_slack_m) = (arm * (spin.sine.abs() + spin.versine), turn_slack(arm, arm_slack));
        let flight = amount * (share * (error_bound.flat_normal + 4.0 * ROUNDING) + share_slack);
        let loss = shrink * (share * (arm_slack + turn_slack_m + 4.0 * ROUNDING * (arm + turn)) + share_slack * (arm + turn));
        let sums = 3.0 * ROUNDING * (v.offset.abs().max_element() + amount * share + turn + shrink * share * (arm + turn));
        error_bound.offset_m += flight + turn_slack_m + loss + sums;
        if turns > 0.0 {
            error_bound.normal += turn_slack(1.0, error_bound.normal) + ROUNDING;
        }
        error_bound
    }

    fn max_displacement_m(radius_m: f64, p: &Self) -> f64 {
        let turned = if p.spin_turns == 0.0 { 0.0 } else { 2.0 };
        // No corner is farther from its triangle's centre than the model is wide.
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
        Self { turns, sine: sin_turns(turns), versine: 2.0 * half * half }
    }

    /// What the turn about the unit axis `n` adds to `r`.
    fn added(&self, n: DVec3, r: DVec3) -> DVec3 {
        let across = n.cross(r);
        across * self.sine + n.cross(across) * self.versine
    }

    /// Bounds of the errors of sine and versine in f32, given that of the angle in turns; none without a turn.
    fn error_bound(&self, turns: f64) -> (f64, f64) {
        if self.turns == 0.0 && turns == 0.0 {
            return (0.0, 0.0);
        }
        let sine = std::f64::consts::TAU * turns + SINE_ERROR;
        let half = 0.5 * std::f64::consts::TAU * turns + SINE_ERROR;
        let versine = 4.0 * (0.5 * self.versine).sqrt() * half + 2.0 * half * half + 3.0 * ROUNDING * self.versine;
        (sine.min(2.0), versine.min(2.0))
    }
}

impl Explode {
    /// How much of its way a triangle has gone.
    fn share(&self, v: &Vertex) -> f64 {
        let reached = self.front().reached(v.center, v.center_screen, v.triangle);
        reached * (1.0 - f64::from(self.scatter) * hash_unit(v.triangle ^ self.seed.wrapping_mul(0x85eb_ca6b)))
    }

    fn front(&self) -> Front {
        front_of!(self)
    }
}
