//! The sample hook: is this sample drawn? Integers alone decide, so that every pass, option and adapter says the same.
//!
//! What a decision takes from floats (a front in the world, say) is settled once per triangle, stored, and read by all:
//! [`SampleEffect::decide`].

use glam::{DVec2, DVec3};

use super::{ErrorBound, ROUNDING};
use crate::params::Params;

/// What is known of a triangle, or of a piece that clipping left of one, when an effect decides about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleSetup {
    /// Global triangle id; a piece has its parent's.
    pub triangle: u32,
    /// Snapped corners, units of 1/256 px, in the order of the file or of the fan.
    pub corners: [[i32; 2]; 3],
    /// Bit k: the edge opposite corner k is an edge of the whole triangle, not a cut.
    pub outline: u32,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Mean of the whole triangle's corners, world space.
    pub center: DVec3,
    /// Bound of its error in f32 along any axis, metres.
    pub center_slack_m: f64,
    /// Where that mean stands in the picture, 0 to 1; the middle where it lies behind the eye.
    pub center_screen: DVec2,
}

impl TriangleSetup {
    /// Twice the area, units of 1/256 px squared.
    pub fn doubled_area(&self) -> u64 {
        let [[ax, ay], [bx, by], [cx, cy]] = self.corners.map(|corner| corner.map(i64::from));
        ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)).unsigned_abs()
    }

    /// How far an f32 twin's centre may be from the reference, in the world and in the picture.
    pub fn error_bound(&self) -> ErrorBound {
        // A few operations on numbers up to the largest corner's place, as shares of the picture.
        let reach = self.corners.as_flattened().iter().map(|at| f64::from(*at).abs()).fold(0.0, f64::max);
        let shortest = f64::from(self.size[0].min(self.size[1]).max(1));
        let center_screen = 24.0 * ROUNDING * (1.0 + reach / (256.0 * shortest));
        ErrorBound { center_m: self.center_slack_m, center_screen, ..ErrorBound::default() }
    }

    /// Samples that the triangle owns in the picture, row by row, each afresh.
    pub fn samples(&self) -> impl Iterator<Item = [u32; 2]> {
        let axis = |k: usize| self.corners.map(|corner| i64::from(corner[k]));
        let range = |k: usize| {
            let [low, high] = [axis(k).into_iter().min(), axis(k).into_iter().max()].map(|end| end.expect("three corners"));
            (low - 128).div_euclid(256).max(0)..((high - 128).div_euclid(256) + 1).min(self.size[k].into())
        };
        let columns = range(0);
        range(1).flat_map(move |y| columns.clone().map(move |x| [x, y])).filter(|&[x, y]| self.owns(x, y)).map(|at| at.map(|k| k as u32))
    }

    /// Top-left rule at the sample of a pixel: each edge function with the sample moved a hair right and less down.
    fn owns(&self, x: i64, y: i64) -> bool {
        let [a, b, c] = self.corners.map(|corner| corner.map(i128::from));
        let (px, py) = (i128::from(256 * x + 128), i128::from(256 * y + 128));
        let nudged = |[ax, ay]: [i128; 2], [bx, by]: [i128; 2]| {
            let (dx, dy) = (bx - ax, by - ay);
            ((dx * (py - ay) - dy * (px - ax)) << 60) - (dy << 30) + dx
        };
        let signs = [nudged(b, c), nudged(c, a), nudged(a, b)].map(i128::signum);
        // Clockwise all are positive, counterclockwise all negative: a tie is broken alike for both sides of an edge.
        signs == [1; 3] || signs == [-1; 3]
    }

    /// Bits that every doubled area of this triangle is shifted by, so that it fits 31 bits.
    pub fn shift(&self) -> u32 {
        (64 - self.doubled_area().leading_zeros()).saturating_sub(31)
    }

    /// Squared length of the edge opposite corner `k`.
    pub fn squared_length(&self, k: usize) -> u64 {
        let ([ax, ay], [bx, by]) = (self.corners[(k + 1) % 3], self.corners[(k + 2) % 3]);
        let (dx, dy) = (u64::from(ax.abs_diff(bx)), u64::from(ay.abs_diff(by)));
        dx * dx + dy * dy
    }
}

/// A covered sample before any depth test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    pub x: u32,
    pub y: u32,
    /// Global triangle id; a piece has its parent's.
    pub triangle: u32,
    /// Doubled area of the part opposite each corner, shifted down by [`TriangleSetup::shift`].
    pub parts: [u32; 3],
    /// What the effect decided about the triangle.
    pub decided: [u32; 4],
}

impl Sample {
    /// Sum of the parts, at least 1.
    pub fn whole(&self) -> u32 {
        self.parts.iter().sum::<u32>().max(1)
    }
}

/// A sample effect's functions over its parameter words.
#[derive(Clone, Copy)]
pub struct SampleHook {
    /// It settles something per triangle.
    pub has_setup: bool,
    /// Bound of the error of an f32 twin in the first word of a decision.
    pub error_bound: fn(&TriangleSetup, &[u32]) -> f64,
    /// What is settled is rounded from floats that differ from one adapter to the next.
    pub is_from_floats: fn(&[u32]) -> bool,
    pub decide: fn(&TriangleSetup, &[u32], Option<u32>) -> [u32; 4],
    pub is_drawn: fn(&Sample, &[u32]) -> bool,
}

/// The integer side of an effect on the sample hook.
pub trait SampleEffect: Params {
    /// Samples read `decided`.
    const HAS_SETUP: bool;

    /// Bound of the error of an f32 twin in the first word of a decision; the other words are exact, given the first.
    fn error_bound(_: &TriangleSetup, _: &Self) -> f64 {
        0.0
    }

    /// Is anything of it rounded from floats that differ from one adapter to the next?
    fn is_from_floats(_: &Self) -> bool {
        false
    }

    /// Settles what the samples of a triangle are held against. Only the first word may come from floats; where `first`
    /// is given it is that word, and the others follow from it.
    fn decide(setup: &TriangleSetup, params: &Self, first: Option<u32>) -> [u32; 4];

    fn is_drawn(sample: &Sample, params: &Self) -> bool;
}
