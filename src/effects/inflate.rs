//! Inflate: every vertex moves along its own normal, so that a smooth surface swells or shrinks without a tear.
//!
//! A surface at a constant distance from another has the same normals, so normals stay as they are.

use super::{
    Effect,
    hooks::{ROUNDING, Slack, Vertex, VertexEffect},
};
use crate::params;

params! {
    pub struct Inflate {
        /// How far every vertex moves along its normal; negative: inwards.
        amount_m: f32 = 0.05, hard -1e3..=1e3, soft -0.5..=0.5, unit "m";
    }
}

pub const EFFECT: Effect =
    Effect::new::<Inflate>("inflate", "Inflate", "moves every vertex along its own normal: the model swells or shrinks")
        .on_vertex::<Inflate>();

impl VertexEffect for Inflate {
    const NEEDS_TRIANGLE: bool = false;

    fn moved(mut v: Vertex, p: &Self) -> Vertex {
        v.offset += v.normal * f64::from(p.amount_m);
        v
    }

    fn slack(v: &Vertex, mut slack: Slack, p: &Self) -> Slack {
        let amount = f64::from(p.amount_m).abs();
        if amount > 0.0 {
            slack.offset_m += amount * (slack.normal + 2.0 * ROUNDING) + ROUNDING * v.offset.abs().max_element();
        }
        slack
    }

    fn reach_m(_: f64, p: &Self) -> f64 {
        f64::from(p.amount_m).abs()
    }
}
