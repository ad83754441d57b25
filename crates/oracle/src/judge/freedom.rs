//! What an adapter may choose for itself at a sample.

use super::super::{
    bounds::coverage::BoundedSample,
    render::{
        draw_order::{draw_limit, is_free},
        sample_rules::SampleTests,
        triangles::OrientedTriangle,
    },
    shot::Shot,
};
use crate::{frame::NO_TRIANGLE, work::Canceled};

/// The freedom that the effect stack leaves to the adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// None: the nearest triangle is shown.
    Exact,
    /// Layers race: any triangle that covers the sample may be shown.
    Racing,
    /// The scheduler chooses which samples are drawn: any may be missing, but this many are drawn.
    Scheduled { limit: u64 },
}

impl Freedom {
    /// Of a stack, given the tests without a draw limit and the triangles that are drawn.
    pub fn of(
        shot: &Shot,
        tests: &SampleTests,
        triangles: &[OrientedTriangle],
    ) -> Result<Self, Canceled> {
        let limit = if is_free(shot.stack) {
            draw_limit(shot.stack, tests, triangles, shot.view)?
        } else {
            None
        };
        Ok(match limit {
            Some(limit) => Self::Scheduled { limit: limit.limit },
            None if shot.stack.is_racing() => Self::Racing,
            None => Self::Exact,
        })
    }

    pub fn is_scheduled(self) -> bool {
        matches!(self, Self::Scheduled { .. })
    }

    /// Returns true if several triangles may win the sample because they race for it.
    pub fn is_contested(self, sample: &BoundedSample) -> bool {
        self == Self::Racing && sample.nearest.layers > 1 && sample.claimed.is_some()
    }

    /// Returns true if a triangle id is wrong.
    pub fn is_wrong(self, sample: &BoundedSample, triangle_id: u32) -> bool {
        if self.is_scheduled() {
            return triangle_id != NO_TRIANGLE && sample.claimed.is_none();
        }
        !self.is_contested(sample) && !sample.allows(triangle_id)
    }
}
