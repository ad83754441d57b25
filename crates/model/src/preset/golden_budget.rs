//! The budget of a preset's golden, and what a verdict says against it.

use crate::{
    frame::Frame,
    measure::{Budget, ErrorReport, Verdict, compare},
};

/// How far a picture may differ from the golden; a preset without it has no golden.
#[derive(Clone, Debug, PartialEq)]
pub struct GoldenTest {
    /// Largest difference of a color channel, of 255.
    pub max_channel: u8,
    /// Number of pixels that may differ by more.
    pub max_pixels: u32,
    /// Number of pixels that may show another triangle, where an option that is not exact is pinned.
    pub max_wrong_triangles: u32,
    /// Why a budget above the default is needed.
    pub why: String,
    /// Fewest and most pixels that show a triangle.
    pub covered: [f64; 2],
    /// Fewest and most samples that triangles cover, each triangle counted.
    pub hits: [f64; 2],
    /// Fewest and most triangles that are clipped.
    pub clipped: [f64; 2],
    /// Fewest and most triangles without area after the snap.
    pub degenerate: [f64; 2],
    /// Fewest and most triangles with a corner that is not finite or too far away.
    pub rejected: [f64; 2],
    /// The preset is refused with a sentence that has these words; empty: it is drawn.
    pub refused: String,
}

/// Any count.
const ANY: [f64; 2] = [0.0, 1e9];

impl Default for GoldenTest {
    fn default() -> Self {
        Self {
            max_channel: 1,
            max_pixels: 0,
            max_wrong_triangles: 0,
            why: String::new(),
            covered: ANY,
            hits: ANY,
            clipped: ANY,
            degenerate: ANY,
            rejected: ANY,
            refused: String::new(),
        }
    }
}

impl GoldenTest {
    /// How many pixels of a picture differ by more than the budget from what the oracle draws from
    /// the same vertices. Where wrong triangles are allowed, colors are compared only where the
    /// triangle is right.
    pub fn pixels_over_tolerance(&self, verdict: &Verdict, drawn: &Frame) -> u64 {
        let mut expected = verdict.expected.color.clone();
        if self.max_wrong_triangles > 0 {
            let ids = drawn.triangle_id.iter().zip(&verdict.expected.triangle_id);
            let wrong = ids.enumerate().filter(|(_, (a, b))| a != b);
            wrong.for_each(|(i, _)| expected[i] = drawn.color[i]);
        }
        compare::pictures(&drawn.color, &expected, self.max_channel).pixels_over_tolerance
    }

    /// The reasons why a picture is wrong, none if it is right: integers must be exact unless there is
    /// a budget for wrong triangles, and colors within the budget. With `allows_any_band` any number of
    /// pixels may have two right answers.
    pub fn faults(
        &self,
        report: &ErrorReport,
        pixels_over_tolerance: u64,
        allows_any_band: bool,
    ) -> Vec<String> {
        // After image passes a picture may look right although a color that they read or keep is wrong.
        // So only a preset that states a budget of pixels is forgiven a channel.
        let forgiven = self.max_pixels.max(self.max_wrong_triangles) > 0
            && pixels_over_tolerance <= u64::from(self.max_pixels);
        let max_color_delta = if forgiven { u8::MAX } else { self.max_channel };
        let mut budget = Budget {
            max_color_delta,
            max_wrong_triangles: self.max_wrong_triangles.into(),
            ..Budget::default()
        };
        if self.max_channel > 1 {
            budget.max_rounding_fraction = 1.0;
        }
        if allows_any_band {
            budget.max_step_band_fraction = f64::INFINITY;
        }
        let reasons = report.within(&budget).err();
        reasons.map_or_else(Vec::new, |reasons| {
            reasons.split("; ").map(str::to_owned).collect()
        })
    }

    /// Is this sentence the refusal that the test asks for?
    pub fn expects_refusal(&self, sentence: &str) -> bool {
        !self.refused.is_empty() && sentence.contains(&self.refused)
    }

    /// What the counts of a picture are that the test does not allow. Without `layers`, hits are
    /// not counted.
    pub fn count_faults(&self, drawn: &Frame, layers: Option<&[u32]>) -> Vec<String> {
        let counters = &drawn.counters;
        let hits = layers.map(|layers| layers.iter().map(|&hits| f64::from(hits)).sum());
        let rejected = counters.rejected_nonfinite + counters.rejected_range;
        [
            ("covered", Some(drawn.covered() as f64), self.covered),
            ("hits", hits, self.hits),
            ("clipped", Some(counters.clipped.into()), self.clipped),
            (
                "degenerate",
                Some(counters.degenerate.into()),
                self.degenerate,
            ),
            ("rejected", Some(rejected.into()), self.rejected),
        ]
        .into_iter()
        .filter_map(|(name, count, [least, most])| {
            let count = count.filter(|count| !(least..=most).contains(count))?;
            Some(format!(
                "test.{name} is {count}; allowed: {least} to {most}"
            ))
        })
        .collect()
    }
}
