//! Timings: what pictures cost. The first time of a picture is not its cost: kernels and caches are
//! cold, and the processor is busy with what the user does. A few frames are drawn again at rest
//! until their times agree, and their median is shown.

use std::collections::VecDeque;

use crate::{gpu::Report, measure::timing::percentile};

/// Fewest and most frames that are measured at rest.
const FEWEST: usize = 5;
const MOST: usize = 15;

/// Frames that take this long together are enough, milliseconds, if they are three.
const LONG_MS: f64 = 1500.0;
const FEWEST_LONG: usize = 3;

/// The times have settled when the middle half of the last five spans at most this fraction of
/// their median.
const SETTLED_SPREAD: f64 = 0.1;

/// Frames whose median stands for a picture in motion.
const MOVING: usize = 9;
const FEWEST_MOVING: usize = 3;

/// Frames and latencies that are remembered.
const HISTORY: usize = 240;
const LATENCIES: usize = 60;

/// The time of one frame, milliseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    pub ms: f64,
    pub passes: Vec<(String, f64)>,
}

impl Sample {
    /// None where the adapter has no timer.
    pub fn of(report: &Report) -> Option<Self> {
        Some(Self {
            ms: report.gpu_ms?,
            passes: report.passes.clone(),
        })
    }

    /// What the frame took beyond its passes: clears between them, copies, and gaps.
    pub fn rest_ms(&self) -> f64 {
        self.ms - self.passes.iter().map(|(_, ms)| ms).sum::<f64>()
    }
}

/// How a frame was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occasion {
    /// Something was compiled for it.
    Compiled,
    /// Its inputs had changed.
    Changed,
    /// It was drawn again to be measured.
    Rest,
}

/// Median, 5th and 95th percentile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    pub median: f64,
    pub p5: f64,
    pub p95: f64,
}

impl Spread {
    /// None without values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let at = |p: f64| percentile(values, p);
        Some(Self {
            median: at(0.5)?,
            p5: at(0.05)?,
            p95: at(0.95)?,
        })
    }
}

/// The cost of a picture, measured at rest. Milliseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    pub frame: Spread,
    /// In the order in which they run.
    pub passes: Vec<(String, Spread)>,
    /// What the frames took beyond their passes.
    pub rest: Spread,
    pub frames: usize,
}

impl Summary {
    /// Of frames that were drawn one after another at rest until their times agreed; those before
    /// were still warming up. None without samples.
    pub fn settled(samples: &[Sample]) -> Option<Self> {
        Self::of(&samples[samples.len().saturating_sub(2 * FEWEST)..])
    }

    /// None without samples.
    pub fn of(samples: &[Sample]) -> Option<Self> {
        let of = |value: &dyn Fn(&Sample) -> Option<f64>| {
            Spread::of(&samples.iter().filter_map(value).collect::<Vec<_>>())
        };
        let mut labels: Vec<&str> = Vec::new();
        for (label, _) in samples.iter().flat_map(|sample| &sample.passes) {
            if !labels.contains(&label.as_str()) {
                labels.push(label);
            }
        }
        // A pass that runs several times has one row.
        let time = |sample: &Sample, label: &str| {
            let times: Vec<f64> = sample
                .passes
                .iter()
                .filter(|(other, _)| other == label)
                .map(|(_, ms)| *ms)
                .collect();
            (!times.is_empty()).then(|| times.iter().sum())
        };
        let pass = |label: &str| Some((label.to_owned(), of(&|sample| time(sample, label))?));
        Some(Self {
            frame: of(&|sample| Some(sample.ms))?,
            passes: labels.into_iter().filter_map(pass).collect(),
            rest: of(&|sample| Some(sample.rest_ms()))?,
            frames: samples.len(),
        })
    }
}

/// True if frames that were drawn one after another at rest tell the cost of their picture.
pub fn has_settled(samples: &[Sample]) -> bool {
    let total_ms: f64 = samples.iter().map(|sample| sample.ms).sum();
    if samples.len() >= MOST || samples.len() >= FEWEST_LONG && total_ms >= LONG_MS {
        return true;
    }
    let Some(last) = samples
        .len()
        .checked_sub(FEWEST)
        .map(|first| &samples[first..])
    else {
        return false;
    };
    let times: Vec<f64> = last.iter().map(|sample| sample.ms).collect();
    let at = |p: f64| percentile(&times, p).unwrap_or(0.0);
    at(0.75) - at(0.25) <= SETTLED_SPREAD * at(0.5)
}

/// What is known of the cost of the picture that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost<'a> {
    /// Nothing yet; it will be measured when the picture is at rest.
    Pending,
    /// The picture changes; the median of its newest frames, milliseconds.
    Moving(f64),
    Settled(&'a Summary),
    /// It could not be measured.
    Unknown,
}

/// Frames whose times can be compared: their size in pixels, and their kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    pub size: [u32; 2],
    pub kernel: String,
}

/// The times of the frames of one picture in the window, and its cost.
#[derive(Clone, Debug, Default)]
pub struct Timings {
    /// The newest frames, oldest first.
    history: VecDeque<(Sample, Occasion)>,
    subject: Option<Subject>,
    /// The newest frames of the subject that compiled nothing, milliseconds.
    moving_ms: VecDeque<f64>,
    /// The picture was measured at rest; none inside if that told nothing.
    settled: Option<Option<Summary>>,
    /// From an input to the picture that shows it, milliseconds.
    latencies_ms: VecDeque<f64>,
}

impl Timings {
    /// The picture that was asked for has changed.
    pub fn change(&mut self) {
        self.settled = None;
    }

    /// A picture of another preset or size is shown: no time before counts for it. The history
    /// stays.
    pub fn reset(&mut self) {
        self.settled = None;
        self.moving_ms.clear();
        self.latencies_ms.clear();
    }

    /// A changed picture was drawn in `sample`, and shown `latency_ms` after the input.
    pub fn drawn(
        &mut self,
        subject: Subject,
        sample: Option<Sample>,
        is_compiled: bool,
        latency_ms: f64,
    ) {
        if self.subject.as_ref() != Some(&subject) {
            self.moving_ms.clear();
            self.subject = Some(subject);
        }
        self.settled = None;
        if !is_compiled {
            push(
                &mut self.moving_ms,
                sample.iter().map(|sample| sample.ms),
                MOVING,
            );
            push(&mut self.latencies_ms, [latency_ms], LATENCIES);
        }
        let occasion = if is_compiled {
            Occasion::Compiled
        } else {
            Occasion::Changed
        };
        push(
            &mut self.history,
            sample.map(|sample| (sample, occasion)),
            HISTORY,
        );
    }

    /// The picture was drawn again at rest.
    pub fn settle(&mut self, samples: Vec<Sample>) {
        self.settled = Some(Summary::settled(&samples));
        push(
            &mut self.history,
            samples.into_iter().map(|sample| (sample, Occasion::Rest)),
            HISTORY,
        );
    }

    pub fn cost(&self) -> Cost<'_> {
        match &self.settled {
            Some(Some(summary)) => Cost::Settled(summary),
            Some(None) => Cost::Unknown,
            None if self.moving_ms.len() >= FEWEST_MOVING => {
                let times: Vec<f64> = self.moving_ms.iter().copied().collect();
                percentile(&times, 0.5).map_or(Cost::Pending, Cost::Moving)
            }
            None => Cost::Pending,
        }
    }

    /// The cost of the picture that is shown, as far as it is known, milliseconds.
    pub fn cost_ms(&self) -> Option<f64> {
        match self.cost() {
            Cost::Settled(summary) => Some(summary.frame.median),
            Cost::Moving(ms) => Some(ms),
            Cost::Pending | Cost::Unknown => None,
        }
    }

    /// True if the picture was measured at rest since it last changed.
    pub fn is_settled(&self) -> bool {
        self.settled.is_some()
    }

    /// Time of the newest frame that compiled nothing, milliseconds.
    pub fn newest_ms(&self) -> Option<f64> {
        let warm = self
            .history
            .iter()
            .rev()
            .find(|(_, occasion)| *occasion != Occasion::Compiled);
        warm.map(|(sample, _)| sample.ms)
    }

    /// The newest frames, oldest first.
    pub fn history(&self) -> impl Iterator<Item = (&Sample, Occasion)> {
        self.history
            .iter()
            .map(|(sample, occasion)| (sample, *occasion))
    }

    /// From an input to the picture that shows it, over the newest pictures that compiled nothing;
    /// with their number.
    pub fn latency(&self) -> Option<(Spread, usize)> {
        let latencies: Vec<f64> = self.latencies_ms.iter().copied().collect();
        Some((Spread::of(&latencies)?, latencies.len()))
    }
}

/// Appends, and drops the oldest above `most`.
fn push<T>(list: &mut VecDeque<T>, new: impl IntoIterator<Item = T>, most: usize) {
    list.extend(new);
    list.drain(..list.len().saturating_sub(most));
}

/// What a measurement in the header is of: the preset, by its file, its scene, and the size of the
/// picture. When one of them changes, no milliseconds of before are shown, and no verdict unless only
/// the size did.
#[derive(Clone, Debug)]
pub struct Measurable<File>(Option<(File, [u32; 2])>);

impl<File> Default for Measurable<File> {
    fn default() -> Self {
        Self(None)
    }
}

impl<File: PartialEq> Measurable<File> {
    /// Notes what is shown now. Returns whether milliseconds of before do not count for it, and
    /// whether it is of another file, whose verdict does not either.
    pub fn resets(&mut self, file: File, size: [u32; 2]) -> [bool; 2] {
        let before = self.0.replace((file, size));
        let Some(((before, size_before), (now, _))) = before.zip(self.0.as_ref()) else {
            return [false; 2];
        };
        let is_other = before != *now;
        [is_other || size_before != size, is_other]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(ms: f64) -> Sample {
        Sample {
            ms,
            passes: vec![
                ("clear".into(), 0.25 * ms),
                ("bin".into(), 0.25 * ms),
                ("bin".into(), 0.25 * ms),
            ],
        }
    }

    fn samples(times: &[f64]) -> Vec<Sample> {
        times.iter().map(|ms| sample(*ms)).collect()
    }

    fn subject(width: u32) -> Subject {
        Subject {
            size: [width, 10],
            kernel: "k".into(),
        }
    }

    #[test]
    fn times_settle_when_the_last_five_agree() {
        assert!(!has_settled(&samples(&[10.0; 4])), "four are too few");
        assert!(has_settled(&samples(&[10.0; 5])));
        assert!(
            !has_settled(&samples(&[300.0, 15.0, 15.0, 12.0, 10.0])),
            "still warming up"
        );
        assert!(has_settled(&samples(&[
            300.0, 40.0, 15.0, 15.1, 15.0, 14.9, 15.0
        ])));
        assert!(
            has_settled(&samples(&[10.0, 10.0, 90.0, 10.0, 10.0])),
            "one frame that was disturbed does not matter"
        );
        let unsteady: Vec<f64> = (0..15).map(|i| 10.0 + 5.0 * f64::from(i % 3)).collect();
        assert!(!has_settled(&samples(&unsteady[..14])));
        assert!(
            has_settled(&samples(&unsteady)),
            "times that never agree end the measurement too"
        );
        assert!(
            !has_settled(&samples(&[700.0, 700.0]))
                && has_settled(&samples(&[700.0, 700.0, 700.0])),
            "three long frames suffice"
        );
    }

    #[test]
    fn the_first_time_after_a_change_is_not_the_cost() {
        let mut timings = Timings::default();
        assert_eq!(timings.cost(), Cost::Pending);
        timings.drawn(subject(8), Some(sample(318.0)), true, 5000.0);
        assert_eq!(
            (timings.cost(), timings.newest_ms()),
            (Cost::Pending, None),
            "it compiled"
        );
        timings.drawn(subject(8), Some(sample(40.0)), false, 50.0);
        assert_eq!(
            (timings.cost(), timings.newest_ms()),
            (Cost::Pending, Some(40.0))
        );
        timings.settle(samples(&[300.0, 15.0, 15.0, 15.0, 15.0, 15.0]));
        let Cost::Settled(summary) = timings.cost() else {
            panic!("{:?}", timings.cost())
        };
        assert_eq!((summary.frame.median, summary.frames), (15.0, 6));
        timings.change();
        assert_eq!(
            timings.cost(),
            Cost::Pending,
            "a change makes it unknown again"
        );
        timings.settle(Vec::new());
        assert_eq!(timings.cost(), Cost::Unknown);
    }

    #[test]
    fn a_picture_in_motion_has_the_median_of_its_newest_frames() {
        let mut timings = Timings::default();
        for ms in [20.0, 90.0, 22.0] {
            timings.drawn(subject(8), Some(sample(ms)), false, 1.0);
        }
        assert_eq!(timings.cost(), Cost::Moving(22.0));
        timings.drawn(subject(16), Some(sample(50.0)), false, 1.0);
        assert_eq!(
            timings.cost(),
            Cost::Pending,
            "another size has other times"
        );
        for _ in 0..3 {
            timings.drawn(subject(16), Some(sample(50.0)), false, 1.0);
        }
        timings.reset();
        assert_eq!((timings.cost(), timings.latency()), (Cost::Pending, None));
        assert_eq!(timings.history().count(), 7, "the history stays");
    }

    #[test]
    fn passes_and_rest_add_up_to_the_frame() {
        let summary = Summary::of(&samples(&[8.0, 12.0, 16.0])).expect("a summary");
        let rows: Vec<_> = summary
            .passes
            .iter()
            .map(|(label, spread)| (label.as_str(), spread.median))
            .collect();
        assert_eq!(rows, [("clear", 3.0), ("bin", 6.0)]);
        assert_eq!((summary.rest.median, summary.frame.median), (3.0, 12.0));
        assert!(summary.frame.p5 < 12.0 && summary.frame.p95 > 12.0);
        assert_eq!(Summary::of(&[]), None);
    }

    #[test]
    fn another_preset_or_size_resets_what_was_measured() {
        let mut shown = Measurable::default();
        for (file, size, resets) in [
            ("hatch", [8, 8], [false, false]),
            ("hatch", [8, 8], [false, false]),
            ("hatch", [9, 8], [true, false]),
            ("hatch", [9, 8], [false, false]),
            ("toon", [9, 8], [true, true]),
        ] {
            assert_eq!(shown.resets(file, size), resets, "{file} {size:?}");
        }
    }

    #[test]
    fn latencies_are_those_of_pictures_that_compiled_nothing() {
        let mut timings = Timings::default();
        timings.drawn(subject(8), None, true, 9000.0);
        assert_eq!(timings.latency(), None);
        for latency_ms in [30.0, 40.0, 50.0] {
            timings.drawn(subject(8), None, false, latency_ms);
        }
        assert_eq!(
            timings
                .latency()
                .map(|(spread, count)| (spread.median, count)),
            Some((40.0, 3))
        );
    }
}
