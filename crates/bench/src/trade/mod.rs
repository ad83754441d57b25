//! The trade: milliseconds beside error for every combination of options on chosen axes,
//! interleaved in one run on one adapter.

mod error;
mod watch;

use std::{collections::HashSet, sync::Arc};

use web_time::Instant;

pub use self::{
    error::{Judged, Reference, TradeError},
    watch::{Phase, Step, Watch},
};
use crate::{
    accuracy::{AXES, Axis, AxisOption, PinnedOptions, RenderScale},
    frame::{CullingStats, NO_TRIANGLE},
    gpu::{
        Gpu, RenderError, Renderer,
        particles::Wait,
        timer::Detail,
        warm_up::{self, FRAMES_PER_SAMPLE},
    },
    measure::{timing, timing::Spread},
    plan::AccuracyRequest,
    preset::Preset,
    scene::{Scene, view::View},
};

/// Whose clock tells the milliseconds of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The adapter's: timestamps of the last of two frames.
    Adapter,
    /// The processor's, over repeated frames, with what asking for them takes: a browser rounds
    /// timestamps.
    Processor,
}

/// By the processor's clock frames are repeated until they take so long together, since a browser
/// rounds it to 0.1 ms.
const MEASURED_MS: f64 = 20.0;
/// Most frames of such a sample.
const MOST_FRAMES: usize = 64;

/// Frames of a sample by the processor's clock where one takes `each_ms`.
fn frame_count(each_ms: f64) -> usize {
    (MEASURED_MS / each_ms)
        .ceil()
        .clamp(FRAMES_PER_SAMPLE as f64, MOST_FRAMES as f64) as usize
}

/// What to measure.
#[derive(Clone, Debug)]
pub struct TradeOptions {
    pub size: [u32; 2],
    /// Timed samples per combination.
    pub samples: usize,
    pub clock: Clock,
    /// Axes to walk; the others stay where the preset has them.
    pub axes: Vec<&'static Axis>,
    /// Every option alone beside the preset as it is planned, instead of every combination.
    pub is_one_option_at_a_time: bool,
}

/// One combination of options.
#[derive(Clone, Debug, serde::Serialize)]
pub struct TradeRow {
    pub scene: String,
    pub triangles: u64,
    pub adapter: String,
    pub size: [u32; 2],
    /// `coverage=fixed8 depth=log16`, the chosen axes alone.
    pub options: String,
    #[serde(skip)]
    pub pins: PinnedOptions,
    /// Whole frame by the chosen clock, with what the CPU chose before it; none where that is the
    /// adapter's and it has no timestamps, or where the combination cannot be drawn.
    pub ms_p5: Option<f64>,
    pub ms_p50: Option<f64>,
    pub ms_p95: Option<f64>,
    /// The same, with the interval of the median.
    #[serde(skip)]
    pub spread: Option<Spread>,
    /// What the CPU alone took of that, where it had to choose anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu_ms_p50: Option<f64>,
    /// Valid samples.
    pub samples: usize,
    /// Samples whose timestamps were impossible.
    pub invalid: usize,
    /// Samples far from the median (more than 5 MAD); they are kept.
    pub outliers: usize,
    pub error: Option<TradeError>,
    /// Buffers of the frame.
    pub bytes: u64,
    /// Another row is at least as right and quicker by more than the noise.
    pub is_dominated: bool,
    /// Meshlets that culling left and left out in the last picture.
    pub culled: Option<CullingStats>,
    /// Why it could not be drawn, what beats it, or what it spared.
    pub note: Option<String>,
}

/// How many pixels to a side of a shown one the combinations on these axes draw, one first.
pub fn factors(preset: &Preset, axes: &[&'static Axis]) -> Vec<f64> {
    let pinned = preset.accuracy.scale();
    let is_walked = axes.iter().any(|axis| axis.index() == RenderScale::AXIS);
    let drawn = RenderScale::ALL
        .iter()
        .filter(|option| **option != RenderScale::Full && (is_walked || **option == pinned));
    std::iter::once(1.0)
        .chain(drawn.map(|option| option.factor()))
        .collect()
}

/// Which samples a time belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    /// Drawn one after another, to warm up.
    Alone,
    /// In turn with the other combinations.
    Interleaved,
}

/// A combination with what has been measured of it.
struct Entry {
    pins: PinnedOptions,
    view: View,
    renderer: Renderer,
    error: TradeError,
    /// Triangles that own a pixel.
    triangle_ids: usize,
    bytes: u64,
    clock: Clock,
    /// Frames of a sample.
    frames: usize,
    /// Times while it warmed up. They count only if the measurement ends before its rounds.
    alone: Vec<f64>,
    ms: Vec<f64>,
    cpu_ms: Vec<f64>,
    invalid: usize,
}

/// Measures every combination of options on the chosen axes, held against `reference`. Ended early
/// by `watch`, it returns what has been timed so far.
/// Errors: when the device is lost or the scene does not fit. What a combination cannot draw
/// becomes its row's note.
pub async fn trade(
    gpu: &Arc<Gpu>,
    preset: &Preset,
    scene: &Arc<Scene>,
    scene_name: &str,
    options: &TradeOptions,
    reference: &Reference<'_>,
    watch: &mut impl Watch,
) -> Result<Vec<TradeRow>, RenderError> {
    let subject = (gpu, preset, scene);
    let SetUp {
        mut entries,
        lacking,
        mut is_wanted,
    } = set_up_entries(subject, options, reference, watch).await?;
    if is_wanted {
        warm_up::warm_up(
            gpu,
            warm_up::FROM_IDLE,
            entries.len(),
            async |at, frames| {
                entries[at].sample(preset, Kept::Alone, frames).await?;
                is_wanted = watch.is_wanted();
                Ok(is_wanted)
            },
        )
        .await?;
    }
    if is_wanted {
        sample_in_turn(&mut entries, preset, options, watch).await?;
    }
    let row = |pins: PinnedOptions| TradeRow {
        scene: scene_name.into(),
        triangles: scene.triangle_count(),
        adapter: gpu.summary.name.clone(),
        size: options.size,
        options: words(&pins, &options.axes),
        pins,
        ms_p5: None,
        ms_p50: None,
        ms_p95: None,
        spread: None,
        cpu_ms_p50: None,
        samples: 0,
        invalid: 0,
        outliers: 0,
        error: None,
        bytes: 0,
        is_dominated: false,
        culled: None,
        note: None,
    };
    let mut rows: Vec<TradeRow> = entries
        .into_iter()
        .map(|entry| entry.finish(&row))
        .collect();
    mark_dominated(&mut rows);
    rows.extend(lacking.into_iter().map(|(pins, why)| TradeRow {
        note: Some(why),
        ..row(pins)
    }));
    Ok(rows)
}

/// What is ready to be measured, what the adapter lacks and why, and whether to go on.
struct SetUp {
    entries: Vec<Entry>,
    lacking: Vec<(PinnedOptions, String)>,
    is_wanted: bool,
}

/// Compiles each combination of options and draws it until its times settle.
async fn set_up_entries(
    (gpu, preset, scene): (&Arc<Gpu>, &Preset, &Arc<Scene>),
    options: &TradeOptions,
    reference: &Reference<'_>,
    watch: &mut impl Watch,
) -> Result<SetUp, RenderError> {
    const WARM_UP: usize = 3;
    let pins = preset.accuracy.pins;
    let combinations = if options.is_one_option_at_a_time {
        each_alone(pins, &options.axes)
    } else {
        combinations(pins, &options.axes)
    };
    let (mut entries, mut lacking) = (Vec::new(), Vec::new());
    let mut is_wanted = true;
    for (i, &pins) in combinations.iter().enumerate() {
        let what = words(&pins, &options.axes);
        is_wanted = is_wanted
            && watch
                .goes_on(&Step {
                    what: &what,
                    phase: Phase::SetUp,
                    done: i,
                    all: combinations.len(),
                })
                .await;
        if !is_wanted {
            break;
        }
        // An option of the joints is settled with the pose that the view holds.
        let pinned = Preset {
            accuracy: AccuracyRequest {
                pins,
                ..preset.accuracy
            },
            ..preset.clone()
        };
        let view = pinned.view(scene, options.size);
        let entry = Entry::new(gpu, preset, scene, view, pins, options.clock, reference);
        match entry.await {
            Ok(Some(mut entry)) => {
                for _ in 0..WARM_UP {
                    entry.sample(preset, Kept::Alone, entry.frames).await?;
                    is_wanted = watch.is_wanted();
                    if !is_wanted {
                        break;
                    }
                }
                entries.push(entry);
            }
            Ok(None) => is_wanted = false,
            Err(error) if error.is_unsupported() => lacking.push((pins, error.to_string())),
            Err(error) => return Err(error),
        }
    }
    Ok(SetUp {
        entries,
        lacking,
        is_wanted,
    })
}

/// Times all entries in turn, so that what slows the machine for a while slows all of them.
async fn sample_in_turn(
    entries: &mut [Entry],
    preset: &Preset,
    options: &TradeOptions,
    watch: &mut impl Watch,
) -> Result<(), RenderError> {
    let steps = entries.len() * options.samples;
    for round in 0..options.samples {
        for at in 0..entries.len() {
            let what = words(&entries[at].pins, &options.axes);
            // A sample that was disturbed is taken again.
            loop {
                let step = Step {
                    what: &what,
                    phase: Phase::Time,
                    done: round * entries.len() + at,
                    all: steps,
                };
                if !watch.goes_on(&step).await {
                    return Ok(());
                }
                let before = entries[at].marks();
                let frames = entries[at].frames;
                entries[at]
                    .sample(preset, Kept::Interleaved, frames)
                    .await?;
                if watch.was_undisturbed() {
                    break;
                }
                entries[at].forget(before);
            }
        }
    }
    Ok(())
}

/// Every combination of options on `axes`, the first axis changing slowest.
fn combinations(pins: PinnedOptions, axes: &[&'static Axis]) -> Vec<PinnedOptions> {
    axes.iter().fold(vec![pins], |all, axis| {
        let with = |pins: &PinnedOptions, place: usize| {
            let mut pins = *pins;
            pins.set(axis, Some(place));
            pins
        };
        all.iter()
            .flat_map(|pins| (0..axis.words.len()).map(move |place| with(pins, place)))
            .collect()
    })
}

/// The preset as it is planned, then every option of every axis alone.
fn each_alone(pins: PinnedOptions, axes: &[&'static Axis]) -> Vec<PinnedOptions> {
    let options = axes.iter().flat_map(|axis| combinations(pins, &[*axis]));
    std::iter::once(pins).chain(options).collect()
}

/// What the combination for which nothing is pinned is called.
pub const AS_PLANNED: &str = "as planned";

/// The options of a combination on the chosen axes.
fn words(pins: &PinnedOptions, axes: &[&'static Axis]) -> String {
    let mut chosen = PinnedOptions::default();
    axes.iter()
        .for_each(|axis| chosen.set(axis, pins.get(axis)));
    if AXES.iter().all(|axis| chosen.get(axis).is_none()) {
        AS_PLANNED.into()
    } else {
        chosen.words()
    }
}

impl Entry {
    /// Draws twice and measures the error; none if the judge was canceled.
    async fn new(
        gpu: &Arc<Gpu>,
        preset: &Preset,
        scene: &Arc<Scene>,
        view: View,
        pins: PinnedOptions,
        clock: Clock,
        reference: &Reference<'_>,
    ) -> Result<Option<Self>, RenderError> {
        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_scene(scene).await?;
        let accuracy = AccuracyRequest {
            pins,
            ..preset.accuracy
        };
        let first = renderer.capture(&view, &preset.stack, &accuracy).await?;
        let second = renderer.capture(&view, &preset.stack, &accuracy).await?;
        let bytes = renderer
            .explain()
            .buffers
            .iter()
            .map(|buffer| buffer.bytes)
            .sum();
        let Some(judged) = (reference.judge)(&view, &preset.stack, &first) else {
            return Ok(None);
        };
        let error = TradeError::of(&first, &second.frame, &judged, reference);
        let triangle_ids = first
            .frame
            .triangle_id
            .iter()
            .filter(|triangle_id| **triangle_id != NO_TRIANGLE)
            .collect::<HashSet<_>>()
            .len();
        let (alone, ms, cpu_ms) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Some(Self {
            pins,
            view,
            renderer,
            error,
            triangle_ids,
            bytes,
            clock,
            frames: FRAMES_PER_SAMPLE,
            alone,
            ms,
            cpu_ms,
            invalid: 0,
        }))
    }

    /// Draws so many frames without a pause, waits, and times the last by the adapter's clock or
    /// all of them by the processor's.
    async fn sample(
        &mut self,
        preset: &Preset,
        kept: Kept,
        frames: usize,
    ) -> Result<(), RenderError> {
        let accuracy = AccuracyRequest {
            pins: self.pins,
            ..preset.accuracy
        };
        let begin = Instant::now();
        for _ in 0..frames {
            self.renderer
                .draw_timed(
                    &self.view,
                    &preset.stack,
                    &accuracy,
                    Detail::Whole,
                    Wait::Simulation,
                )
                .await?;
        }
        let report = self.renderer.finish().await?;
        let ms = match self.clock {
            Clock::Adapter => report.gpu_ms.map(|ms| ms + report.cpu_ms.unwrap_or(0.0)),
            Clock::Processor => Some(begin.elapsed().as_secs_f64() * 1e3 / frames as f64),
        };
        match (ms, kept) {
            (Some(ms), Kept::Alone) => {
                self.alone.push(ms);
                if self.clock == Clock::Processor {
                    self.frames = frame_count(ms);
                }
            }
            (None, Kept::Alone) => {}
            (Some(ms), Kept::Interleaved) => {
                self.ms.push(ms);
                self.cpu_ms.extend(report.cpu_ms);
            }
            (None, Kept::Interleaved) => self.invalid += 1,
        }
        Ok(())
    }

    /// How much has been measured.
    fn marks(&self) -> [usize; 3] {
        [self.ms.len(), self.cpu_ms.len(), self.invalid]
    }

    /// Forgets what was measured since then.
    fn forget(&mut self, [ms, cpu_ms, invalid]: [usize; 3]) {
        self.ms.truncate(ms);
        self.cpu_ms.truncate(cpu_ms);
        self.invalid = invalid;
    }

    /// What culling spared, and the work that it left in vain.
    fn wasted(&self, culled: &CullingStats) -> String {
        let (drawn, all, meshlet_visibility) = (culled.drawn, culled.all(), self.triangle_ids);
        format!(
            "{drawn} of {all} meshlets drawn ({}); {meshlet_visibility} triangles own a pixel",
            culled.reasons()
        )
    }

    fn finish(self, row: &dyn Fn(PinnedOptions) -> TradeRow) -> TradeRow {
        let is_alone = self.ms.is_empty() && !self.alone.is_empty();
        let ms = if is_alone { &self.alone } else { &self.ms };
        let spread = Spread::of(ms);
        let wasted = self.renderer.culled().map(|culled| self.wasted(&culled));
        let early = is_alone
            .then(|| "timed alone, since the measurement was ended before its rounds".to_owned());
        TradeRow {
            ms_p5: spread.map(|spread| spread.p5),
            ms_p50: spread.map(|spread| spread.p50),
            ms_p95: spread.map(|spread| spread.p95),
            spread,
            cpu_ms_p50: timing::percentile(&self.cpu_ms, 0.5),
            samples: ms.len(),
            invalid: self.invalid,
            outliers: timing::outliers(ms),
            error: Some(self.error),
            bytes: self.bytes,
            culled: self.renderer.culled(),
            note: wasted
                .into_iter()
                .chain(early)
                .reduce(|a, b| format!("{a}; {b}")),
            ..row(self.pins)
        }
    }
}

/// Marks rows that another row makes pointless: as right or better, and quicker by more than the
/// noise.
fn mark_dominated(rows: &mut [TradeRow]) {
    let beats = |a: &TradeRow, b: &TradeRow| {
        let (Some(ea), Some(eb), Some(ta), Some(tb)) = (a.error, b.error, a.spread, b.spread)
        else {
            return false;
        };
        ea.is_at_most(&eb) && ta.is_clearly_below(&tb)
    };
    let dominated: Vec<Option<String>> = rows
        .iter()
        .map(|row| {
            let better = rows.iter().filter(|other| beats(other, row));
            better
                .min_by(|a, b| {
                    a.ms_p50
                        .unwrap_or(f64::MAX)
                        .total_cmp(&b.ms_p50.unwrap_or(f64::MAX))
                })
                .map(|other| other.options.clone())
        })
        .collect();
    for (row, better) in rows.iter_mut().zip(dominated) {
        row.is_dominated = better.is_some();
        let dominated = better.map(|better| format!("no gain: {better} is as right and quicker"));
        row.note = [row.note.take(), dominated]
            .into_iter()
            .flatten()
            .reduce(|a, b| format!("{a}; {b}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::{Coverage, DepthFormat};

    #[test]
    fn combinations_are_the_product_and_keep_other_pins() {
        let axes = [&AXES[Coverage::AXIS], &AXES[DepthFormat::AXIS]];
        let all = combinations(
            PinnedOptions::of(crate::accuracy::Visibility::Split32),
            &axes,
        );
        assert_eq!(all.len(), Coverage::ALL.len() * DepthFormat::ALL.len());
        assert!(
            all.iter()
                .all(|pins| pins.option() == Some(crate::accuracy::Visibility::Split32))
        );
        assert_eq!(
            words(&all[0], &axes),
            format!(
                "coverage={} depth={}",
                Coverage::ALL[0].name(),
                DepthFormat::ALL[0].name()
            )
        );
    }

    #[test]
    fn quick_frames_are_repeated_until_the_clock_of_a_browser_can_tell() {
        let frames = [0.0, 0.01, 0.4, 1.5, 9.0, 800.0].map(frame_count);
        assert_eq!(frames, [64, 64, 50, 14, 3, 2]);
    }

    #[test]
    fn a_row_is_beaten_only_by_one_that_is_nowhere_worse() {
        let row = |ms: f64, wrong_ppm: f64| TradeRow {
            scene: String::new(),
            triangles: 0,
            adapter: String::new(),
            size: [1, 1],
            options: format!("{ms}"),
            pins: PinnedOptions::default(),
            ms_p5: Some(ms),
            ms_p50: Some(ms),
            ms_p95: Some(ms),
            spread: Spread::of(
                &(0..30)
                    .map(|i| ms + 0.01 * f64::from(i % 10))
                    .collect::<Vec<_>>(),
            ),
            cpu_ms_p50: None,
            samples: 30,
            invalid: 0,
            outliers: 0,
            error: Some(TradeError {
                wrong_ppm,
                ..TradeError::default()
            }),
            bytes: 0,
            is_dominated: false,
            culled: None,
            note: None,
        };
        let mut rows = [
            row(1.0, 5.0),
            row(2.0, 1.0),
            row(3.0, 1.0),
            row(3.0, 0.0),
            row(2.005, 1.0),
        ];
        mark_dominated(&mut rows);
        assert_eq!(
            rows.map(|row| row.is_dominated),
            [false, false, true, false, false],
            "the last is slower by chance"
        );
    }
}
