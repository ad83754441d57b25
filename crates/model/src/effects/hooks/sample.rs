//! The sample hook: is this sample drawn? Integers alone decide, so that every pass, option and
//! adapter gives the same answer.
//!
//! What a decision takes from floats (a front in the world, for instance) is rounded once per
//! triangle, stored, and read by all passes: [`SampleEffect::sample_setup`].

use std::{cmp::Ordering, sync::Arc};

use glam::{DVec2, DVec3};

use super::{ErrorBound, ROUNDING};
use crate::effects::Words;

/// What is known of a triangle, or of a clipped triangle, when the setup of its samples is
/// computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleSetup {
    /// Global triangle id; a clipped triangle has its parent's.
    pub triangle: u32,
    /// Snapped corners, units of 1/256 px, in the order of the file, or of the clip fan; at most
    /// [`GUARD_BAND`](crate::math::GUARD_BAND) from 0 along both axes.
    pub corners: [[i32; 2]; 3],
    /// Bit k: the edge opposite corner k is an edge of the parent triangle, not of the clipping.
    pub outline: u32,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Mean of the parent triangle's corners, world space.
    pub center: DVec3,
    /// Bound of its error in f32 along any axis, meters.
    pub center_error_m: f64,
    /// Position of that mean in the picture, 0 to 1; the middle where it lies behind the eye.
    pub center_screen: DVec2,
    /// Bound of its error beside that of whole triangles, whose corners lie near the picture.
    pub center_screen_error: f64,
}

impl TriangleSetup {
    /// How far the center of the f32 side may be from the f64 one, in the world and in the picture.
    pub fn error_bound(&self) -> ErrorBound {
        // A few operations on numbers up to the largest corner's position, as fractions of the
        // picture.
        let reach = self
            .corners
            .as_flattened()
            .iter()
            .map(|at| f64::from(*at).abs())
            .fold(0.0, f64::max);
        let shortest = f64::from(self.size[0].min(self.size[1]).max(1));
        let center_screen =
            self.center_screen_error + 24.0 * ROUNDING * (1.0 + reach / (256.0 * shortest));
        ErrorBound {
            center_m: self.center_error_m,
            center_screen,
            ..ErrorBound::default()
        }
    }

    /// Samples that the triangle covers in the picture, row by row, each tested on its own.
    pub fn samples(&self) -> impl Iterator<Item = [u32; 2]> {
        let axis = |k: usize| self.corners.map(|corner| i64::from(corner[k]));
        let range = |k: usize| {
            let [low, high] = [axis(k).into_iter().min(), axis(k).into_iter().max()]
                .map(|end| end.expect("three corners"));
            (low - 128).div_euclid(256).max(0)
                ..((high - 128).div_euclid(256) + 1).min(self.size[k].into())
        };
        let columns = range(0);
        range(1)
            .flat_map(move |y| columns.clone().map(move |x| [x, y]))
            .filter(|&[x, y]| self.covers(x, y))
            .map(|at| at.map(|k| k as u32))
    }

    /// Top-left rule at the sample of a pixel: each edge function with the sample moved right by
    /// less than a unit, and down by less than that.
    fn covers(&self, x: i64, y: i64) -> bool {
        let [a, b, c] = self.corners.map(|corner| corner.map(i64::from));
        let (px, py) = (256 * x + 128, 256 * y + 128);
        let side = |[ax, ay]: [i64; 2], [bx, by]: [i64; 2]| {
            let (dx, dy) = (bx - ax, by - ay);
            (dx * (py - ay) - dy * (px - ax))
                .cmp(&0)
                .then(0.cmp(&dy))
                .then(dx.cmp(&0))
        };
        // Clockwise all are positive, counterclockwise all negative: a tie is broken alike for both
        // sides of an edge.
        let sides = [side(b, c), side(c, a), side(a, b)];
        sides == [Ordering::Greater; 3] || sides == [Ordering::Less; 3]
    }
}

/// A covered sample before any depth test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    pub x: u32,
    pub y: u32,
    /// Global triangle id; a clipped triangle has its parent's.
    pub triangle: u32,
    /// Doubled area between the sample and the edge opposite each corner, all shifted down until
    /// that of the triangle fits 31 bits.
    pub areas: [u32; 3],
    /// What the effect computed for the triangle: [`SampleEffect::sample_setup`].
    pub setup: [u32; 4],
}

impl Sample {
    /// Sum of the areas, at least 1.
    pub fn total_area(&self) -> u32 {
        self.areas.iter().sum::<u32>().max(1)
    }
}

/// The setup of a triangle, given its first word where that is known.
pub type SetupFunction = dyn Fn(&TriangleSetup, &[u32], Option<u32>) -> [u32; 4] + Send + Sync;

/// The bound of the error of the f32 side in the first word of a setup.
pub type SetupBoundFunction = dyn Fn(&TriangleSetup, &[u32]) -> f64 + Send + Sync;
/// What is true of a sample effect with these parameter words.
pub type WordsTest = dyn Fn(&[u32]) -> bool + Send + Sync;
/// Clears the flag of each sample that is not drawn.
pub type SampleTest = dyn Fn(&[Sample], &[u32], &mut [bool]) + Send + Sync;

/// A sample effect's functions over its parameter words.
#[derive(Clone)]
pub struct SampleHook {
    /// It needs a setup per triangle.
    pub has_setup: bool,
    /// Bound of the error of the f32 side in the first word of a setup.
    pub error_bound: Arc<SetupBoundFunction>,
    /// Its setup is rounded from floats, which differ from adapter to adapter.
    pub is_from_floats: Arc<WordsTest>,
    pub sample_setup: Arc<SetupFunction>,
    pub is_drawn: Arc<SampleTest>,
}

/// The integer side of an effect on the sample hook.
pub trait SampleEffect: Words {
    /// Samples read [`Sample::setup`].
    const HAS_SETUP: bool;

    /// Bound of the error of the f32 side in the first word of a setup; the other words are exact,
    /// given the first.
    fn error_bound(_: &TriangleSetup, _: &Self) -> f64 {
        0.0
    }

    /// Is its setup rounded from floats, which differ from adapter to adapter?
    fn is_from_floats(_: &Self) -> bool {
        false
    }

    /// What the samples of a triangle are compared with. Only the first word may come from floats;
    /// where `first` is given, it is that word, and the others follow from it.
    fn sample_setup(setup: &TriangleSetup, params: &Self, first: Option<u32>) -> [u32; 4];

    fn is_drawn(sample: &Sample, params: &Self) -> bool;
}
