//! Coverage with the depth interval of every float renderer: where two triangles may both be
//! nearest (`docs/exactness.md` §6 and §9).
//!
//! A float depth key may lie anywhere in the interval [low, high] round the f64 depth: its relative
//! bound ([`depth_bound`]), clamped to the depths of the triangle's corners, to which every
//! renderer clamps.

use super::super::{
    arithmetic::depth_key::depth_bound,
    render::{
        coverage::{Hit, Sample, scatter},
        sample_rules::SampleTests,
        triangles::OrientedTriangle,
    },
};
use crate::{frame::NO_TRIANGLE, scene::view::View, work::Canceled};

/// What is visible at the sample of one pixel, and what a float renderer may find instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedSample {
    /// What f64 finds.
    pub nearest: Sample,
    /// Depth interval of the nearest triangle.
    pub interval: [f64; 2],
    /// Largest high end among the other triangles.
    pub rival: f64,
    /// Largest low end of all: a triangle that does not reach this depth is certainly hidden.
    pub floor: f64,
    /// Smallest id of those with this low end: of equal keys the smaller id wins.
    pub floor_id: u32,
    /// Depth interval of the triangle that is claimed for this pixel, if it covers the sample.
    pub claimed: Option<[f64; 2]>,
}

impl BoundedSample {
    const EMPTY: Self = Self {
        nearest: Sample::EMPTY,
        interval: [f64::NEG_INFINITY; 2],
        rival: f64::NEG_INFINITY,
        floor: f64::NEG_INFINITY,
        floor_id: NO_TRIANGLE,
        claimed: None,
    };

    /// Returns true in the depth band: two triangles lie so close that a float key may prefer
    /// either.
    pub fn is_band(&self) -> bool {
        self.nearest.layers > 1 && self.rival > self.interval[0]
    }

    /// Returns true if a triangle id, which is the claimed one, is right: that of the nearest
    /// triangle, or of one that covers the sample and may be in front of all others, beyond the
    /// [`Self::floor`] or at it with the smallest id.
    pub fn allows(&self, triangle_id: u32) -> bool {
        let may_win = |[_, high]: [f64; 2]| {
            high > self.floor || high == self.floor && triangle_id <= self.floor_id
        };
        triangle_id == self.nearest.triangle_id || self.claimed.is_some_and(may_win)
    }

    fn add(&mut self, id: u32, depth: f64, interval: [f64; 2], claim: u32) {
        if interval[0] > self.floor || interval[0] == self.floor && id < self.floor_id {
            (self.floor, self.floor_id) = (interval[0], id);
        }
        if id == claim {
            // Boxes of the clipped triangles of one triangle overlap: the nearest decides.
            self.claimed = Some(self.claimed.map_or(interval, |other| {
                [other[0].max(interval[0]), other[1].max(interval[1])]
            }));
        }
        let before = self.nearest.triangle_id;
        let is_nearest = self.nearest.add(id, depth);
        if id != before {
            self.rival = self.rival.max(if is_nearest {
                self.interval[1]
            } else {
                interval[1]
            });
        }
        if is_nearest {
            self.interval = interval;
        }
    }
}

/// One [`BoundedSample`] per pixel, row-major, top row first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoundedCoverage {
    pub samples: Vec<BoundedSample>,
}

impl BoundedCoverage {
    pub fn triangle_ids(&self) -> Vec<u32> {
        self.samples
            .iter()
            .map(|sample| sample.nearest.triangle_id)
            .collect()
    }

    pub fn depth_keys(&self) -> Vec<u32> {
        self.samples
            .iter()
            .map(|sample| sample.nearest.depth_key)
            .collect()
    }
}

/// Finds what covers every sample of `view`, with bounds; `claims` has the triangle id that a
/// renderer found at each pixel.
pub fn cover_claims(
    tests: &SampleTests,
    triangles: &[OrientedTriangle],
    view: &View,
    claims: &[u32],
) -> Result<BoundedCoverage, Canceled> {
    let mut samples = vec![BoundedSample::EMPTY; view.pixels()];
    scatter(tests, triangles, view, &mut samples, |triangle| {
        move |sample: &mut BoundedSample, x: usize, y: usize, hit: Hit| {
            sample.add(
                triangle.id,
                hit.depth,
                depth_interval(triangle, &hit),
                claims[y * view.width as usize + x],
            );
        }
    })?;
    Ok(BoundedCoverage { samples })
}

/// The interval in which the nearest float key of every sample of `view` lies; negative infinities
/// where nothing is.
pub fn nearest_intervals(
    tests: &SampleTests,
    triangles: &[OrientedTriangle],
    view: &View,
) -> Result<Vec<[f64; 2]>, Canceled> {
    let mut intervals = vec![[f64::NEG_INFINITY; 2]; view.pixels()];
    scatter(tests, triangles, view, &mut intervals, |triangle| {
        move |nearest: &mut [f64; 2], _, _, hit: Hit| {
            let interval = depth_interval(triangle, &hit);
            // Any triangle whose interval reaches farthest may be in front.
            *nearest = [0, 1].map(|end| nearest[end].max(interval[end]));
        }
    })?;
    Ok(intervals)
}

/// The depths between which a float renderer's depth of a hit lies.
pub fn depth_interval(triangle: &OrientedTriangle, hit: &Hit) -> [f64; 2] {
    if !hit.is_interpolated {
        return [hit.depth; 2];
    }
    let [low, high] = triangle.depth_range();
    let error = hit.depth.abs() * depth_bound(&triangle.corners);
    [(hit.depth - error).max(low), (hit.depth + error).min(high)]
}

#[cfg(test)]
mod tests {
    use super::BoundedSample;

    /// What a sample covered by triangles 4 and 7 with these depths allows of the claimed one.
    fn allows(claimed: u32, of_4: [f64; 2], of_7: [f64; 2]) -> bool {
        let mut sample = BoundedSample::EMPTY;
        for (id, interval) in [(4, of_4), (7, of_7)] {
            sample.add(id, (interval[0] + interval[1]) / 2.0, interval, claimed);
        }
        sample.allows(claimed)
    }

    #[test]
    fn a_tie_at_the_end_of_an_interval_goes_to_the_smaller_id() {
        assert!(
            allows(4, [1.0, 1.0], [1.0, 1.5]),
            "7 may round to 1, and 4 wins the tie"
        );
        assert!(!allows(7, [1.0, 1.5], [1.0, 1.0]), "4 wins at 1 too");
        assert!(
            !allows(7, [1.0, 1.0], [1.0, 1.0]),
            "an exact tie has one winner"
        );
        assert!(!allows(4, [0.5, 0.9], [1.0, 1.5]), "hidden for certain");
        assert!(allows(7, [1.0, 1.5], [0.9, 1.1]), "the intervals overlap");
    }
}
