//! Milliseconds beside error: our options and two baselines, interleaved in one run on one adapter.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use pollster::FutureExt as _;

use crate::{
    accuracy::{PinnedOptions, Visibility},
    effects::Stack,
    frame::{Frame, NO_TRIANGLE},
    gpu::{
        Capture, Gpu, RenderError, Renderer,
        frame_stats::{Staged, StatSources},
        hardware::Hardware,
        naive::{Naive, Viewport},
        particles::Wait,
        timer::{Detail, Timer, Times},
        warm_up::{self, FRAMES_PER_SAMPLE},
    },
    measure::{ErrorStats, Verdict, compare, timing},
    plan::AccuracyRequest,
    preset::Preset,
    scene::{Scene, view::View},
};

/// What to measure.
#[derive(Clone, Copy, Debug)]
pub struct BenchOptions {
    pub size: [u32; 2],
    /// Whole-frame samples per row; a third as many frames more are timed pass by pass.
    pub samples: usize,
}

/// GPU time of one pass.
#[derive(Clone, Debug, serde::Serialize)]
pub struct PassTime {
    pub name: String,
    pub ms_p50: f64,
    pub ms_p95: f64,
}

/// One option on one scene.
#[derive(Clone, Debug, serde::Serialize)]
pub struct BenchRow {
    pub scene: String,
    pub triangles: u64,
    pub option: String,
    pub adapter: String,
    /// Whole frame, clears and resolve included; none without timestamps or where the row could
    /// not run.
    pub ms_p50: Option<f64>,
    pub ms_p95: Option<f64>,
    /// Valid samples.
    pub samples: usize,
    pub passes: Vec<PassTime>,
    pub error: ErrorStats,
    /// A option of ours, which promises exactness; a baseline promises nothing.
    pub is_promised: bool,
    /// What a reader must know of this row.
    pub note: Option<String>,
}

/// Judges a picture of ours against the oracle, and hands over the oracle's own; none where the
/// scene is more than the oracle can draw, whose rows have times alone.
pub type Judge<'a> = Option<&'a dyn Fn(&Stack, &Capture) -> Verdict>;

impl BenchRow {
    fn add_note(&mut self, text: &str) {
        self.note = Some(
            self.note
                .take()
                .map_or_else(|| text.into(), |note| format!("{note}; {text}")),
        );
    }
}

/// Rounds of warming up, at least and at most, and the longest time before no further one begins.
const MIN_WARM_UP_ROUNDS: usize = 3;
const MAX_WARM_UP_ROUNDS: usize = 400;
const MAX_WARM_UP: Duration = Duration::from_secs(3);
/// The medians of so many rounds, twice, may differ by this fraction.
const SETTLED_ROUNDS: usize = 12;
const SETTLED: f64 = 0.02;

/// The order of a round: forth and back in turn, so that a clock that drifts in one direction
/// favors nothing.
fn in_turn(entries: usize, round: usize) -> impl Iterator<Item = usize> {
    (0..entries).map(move |i| {
        if round.is_multiple_of(2) {
            i
        } else {
            entries - 1 - i
        }
    })
}

/// Something that draws the scene.
enum Contender {
    Ours(Visibility, Box<Renderer>),
    /// A stack of its own, on the planned option.
    Stacked(String, Box<(Stack, Renderer)>),
    Naive(Viewport, Box<Naive>),
    Hardware(Box<Hardware>),
}

impl Contender {
    fn option(&self) -> String {
        match self {
            Self::Ours(visibility, _) => visibility.name().into(),
            Self::Stacked(name, _) => name.clone(),
            Self::Naive(Viewport::AsWritten, _) => "naive".into(),
            Self::Naive(Viewport::Folded, _) => "naive, viewport mended".into(),
            Self::Hardware(_) => "hardware".into(),
        }
    }
}

/// A contender with what has been measured of it.
struct Entry {
    contender: Contender,
    error: ErrorStats,
    whole: Vec<f64>,
    invalid: usize,
    passes: Vec<(String, Vec<f64>)>,
}

struct Lab<'a> {
    gpu: &'a Arc<Gpu>,
    preset: &'a Preset,
    view: View,
    timer: Option<Timer>,
}

/// Measures every option that the adapter has, and the baselines. Rows keep their order for all
/// figures.
pub fn bench(
    gpu: &Arc<Gpu>,
    preset: &Preset,
    scene: &Arc<Scene>,
    scene_name: &str,
    options: &BenchOptions,
    progress: &mut dyn FnMut(&str, usize, usize),
    judge: Judge,
) -> Result<Vec<BenchRow>, RenderError> {
    let mut lab = Lab::new(gpu, preset, scene, options);
    let (entries, missing) = lab.line_up(scene, judge)?;
    lab.measure(
        scene,
        scene_name,
        entries,
        missing,
        options.samples,
        progress,
    )
}

/// Measures stacks by name on one scene and camera, interleaved, each on the planned option.
pub fn bench_stacks(
    gpu: &Arc<Gpu>,
    preset: &Preset,
    scene: &Arc<Scene>,
    stacks: &[(String, Stack)],
    options: &BenchOptions,
    progress: &mut dyn FnMut(&str, usize, usize),
    judge: Judge,
) -> Result<Vec<BenchRow>, RenderError> {
    let mut lab = Lab::new(gpu, preset, scene, options);
    let mut entries = Vec::new();
    for (name, stack) in stacks {
        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_scene(scene).block_on()?;
        let request = AccuracyRequest::default();
        let verdict = lab.judged(&mut renderer, stack, &request, judge)?;
        let contender = Contender::Stacked(name.clone(), Box::new((stack.clone(), renderer)));
        entries.push(Entry::new(contender, error_of(verdict.as_ref())));
    }
    lab.measure(
        scene,
        &scene.name,
        entries,
        Vec::new(),
        options.samples,
        progress,
    )
}

impl<'a> Lab<'a> {
    fn new(gpu: &'a Arc<Gpu>, preset: &'a Preset, scene: &Scene, options: &BenchOptions) -> Self {
        Self {
            gpu,
            preset,
            view: preset.view(scene, options.size),
            timer: Timer::new(gpu),
        }
    }

    /// Draws all contenders in turn, round after round: whole frames first, then pass by pass.
    fn measure(
        &mut self,
        scene: &Scene,
        scene_name: &str,
        mut entries: Vec<Entry>,
        missing: Vec<(String, String)>,
        samples: usize,
        progress: &mut dyn FnMut(&str, usize, usize),
    ) -> Result<Vec<BenchRow>, RenderError> {
        let is_settled = self.warm_up(&mut entries)?;
        let rounds = samples + samples / 3;
        let all = rounds * entries.len();
        for round in 0..rounds {
            let detail = if round < samples {
                Detail::Whole
            } else {
                Detail::Passes
            };
            for (i, at) in in_turn(entries.len(), round).enumerate() {
                let entry = &mut entries[at];
                let times = self.sample(&mut entry.contender, detail, FRAMES_PER_SAMPLE)?;
                entry.keep(times, detail);
                progress(
                    &entry.contender.option(),
                    round * entries.len() + i + 1,
                    all,
                );
            }
        }
        let row = |option: String, error: ErrorStats, note: Option<String>| BenchRow {
            scene: scene_name.into(),
            triangles: scene.triangle_count()
                + self
                    .preset
                    .stack
                    .particle_settings()
                    .map_or(0, |particle_settings| particle_settings.count.into()),
            option,
            adapter: self.gpu.summary.name.clone(),
            ms_p50: None,
            ms_p95: None,
            samples: 0,
            passes: Vec::new(),
            error,
            is_promised: false,
            note,
        };
        let mut rows: Vec<BenchRow> = entries
            .into_iter()
            .map(|entry| entry.finish(&row))
            .collect();
        if !is_settled {
            rows.iter_mut().for_each(|row| {
                row.add_note("the times did not settle while warming up; compare ratios alone")
            });
        }
        rows.extend(missing.into_iter().map(|(option, why)| {
            row(
                option,
                ErrorStats::default(),
                Some(format!("{scene_name}: {why}")),
            )
        }));
        Ok(rows)
    }
}

impl Lab<'_> {
    /// Keeps the device busy, then draws all contenders in turn until the time of a round has
    /// settled. Returns false if it does not settle.
    fn warm_up(&mut self, entries: &mut [Entry]) -> Result<bool, RenderError> {
        warm_up::warm_up(
            self.gpu,
            warm_up::FROM_IDLE,
            entries.len(),
            async |at, frames| {
                self.sample(&mut entries[at].contender, Detail::Whole, frames)
                    .map(|_| true)
            },
        )
        .block_on()?;
        let begin = Instant::now();
        let mut rounds = Vec::new();
        while rounds.len() < MIN_WARM_UP_ROUNDS
            || rounds.len() < MAX_WARM_UP_ROUNDS && begin.elapsed() < MAX_WARM_UP
        {
            let mut round_ms = Some(0.0);
            for at in in_turn(entries.len(), rounds.len()) {
                let times =
                    self.sample(&mut entries[at].contender, Detail::Whole, FRAMES_PER_SAMPLE)?;
                round_ms = round_ms.zip(times.total_ms).map(|(sum, ms)| sum + ms);
            }
            // Without timestamps there is nothing to wait for.
            let Some(round_ms) = round_ms else {
                return Ok(true);
            };
            rounds.push(round_ms);
            if timing::is_settled(&rounds, SETTLED_ROUNDS, SETTLED) {
                return Ok(true);
            }
        }
        // On a software adapter a few rounds take longer than any clock needs.
        Ok(begin.elapsed() >= MAX_WARM_UP && rounds.len() < 2 * SETTLED_ROUNDS)
    }

    /// Sets up every contender and measures its error. Second: rows that cannot run, and why.
    #[allow(
        clippy::type_complexity,
        reason = "a pair of lists, named in the line above"
    )]
    fn line_up(
        &mut self,
        scene: &Arc<Scene>,
        judge: Judge,
    ) -> Result<(Vec<Entry>, Vec<(String, String)>), RenderError> {
        let (mut entries, mut missing) = (Vec::new(), Vec::new());
        let mut expected = None;
        for &visibility in Visibility::ALL {
            let mut renderer = Renderer::new(self.gpu.clone());
            renderer.set_scene(scene).block_on()?;
            if !visibility.is_supported(self.gpu.caps.int64_atomics) {
                missing.push((
                    visibility.name().into(),
                    "packed64 needs 64-bit atomics, which this adapter lacks".into(),
                ));
                continue;
            }
            let request = request_of(visibility);
            let verdict = match self.judged(&mut renderer, &self.preset.stack, &request, judge) {
                Err(error) if error.is_unsupported() => {
                    missing.push((visibility.name().into(), error.to_string()));
                    continue;
                }
                verdict => verdict?,
            };
            entries.push(Entry::new(
                Contender::Ours(visibility, Box::new(renderer)),
                error_of(verdict.as_ref()),
            ));
            expected = verdict.map(|verdict| verdict.expected);
        }
        let Some(key) = self.first_key(&entries) else {
            return Ok((entries, missing));
        };
        let error_of_picture = |picture: &[[u8; 4]]| {
            let compared = expected
                .as_ref()
                .map(|expected| picture_error(picture, expected));
            compared.unwrap_or_default()
        };
        if key.generated.has_particles {
            missing.extend(["naive", "hardware"].map(|name| {
                (
                    name.to_owned(),
                    "it draws what a file has, and no particles".to_owned(),
                )
            }));
            return Ok((entries, missing));
        }
        let viewports: &[Viewport] = match key.samples.has_points {
            true => {
                missing.push(("naive".into(), "it draws triangles alone".into()));
                &[]
            }
            false => &[Viewport::AsWritten, Viewport::Folded],
        };
        for &viewport in viewports {
            match Naive::new(self.gpu, scene, &self.view, &key, viewport).block_on() {
                Ok(naive) => {
                    let picture = naive.picture(self.gpu).block_on()?;
                    entries.push(Entry::new(
                        Contender::Naive(viewport, Box::new(naive)),
                        error_of_picture(&picture),
                    ));
                }
                Err(error) if error.is_unsupported() => {
                    missing.push(("naive".into(), error.to_string()))
                }
                Err(error) => return Err(error),
            }
        }
        match Hardware::new(self.gpu, scene, &self.view, &self.preset.stack, &key).block_on() {
            Ok(Ok(hardware)) => {
                let picture = hardware.picture(self.gpu).block_on()?;
                entries.push(Entry::new(
                    Contender::Hardware(Box::new(hardware)),
                    error_of_picture(&picture),
                ));
            }
            Ok(Err(why)) => missing.push(("hardware".into(), why)),
            Err(error) if error.is_unsupported() => {
                missing.push(("hardware".into(), error.to_string()))
            }
            Err(error) => return Err(error),
        }
        Ok((entries, missing))
    }

    /// What the judge says of a stack; without one it is drawn alone.
    fn judged(
        &self,
        renderer: &mut Renderer,
        stack: &Stack,
        request: &AccuracyRequest,
        judge: Judge,
    ) -> Result<Option<Verdict>, RenderError> {
        let Some(judge) = judge else {
            renderer
                .draw_complete(&self.view, stack, request)
                .block_on()?;
            return Ok(None);
        };
        let capture = renderer.capture(&self.view, stack, request).block_on()?;
        Ok(Some(judge(stack, &capture)))
    }

    fn first_key(&self, entries: &[Entry]) -> Option<crate::shader::KernelKey> {
        entries.iter().find_map(|entry| match &entry.contender {
            Contender::Ours(_, renderer) => renderer.key().cloned(),
            _ => None,
        })
    }

    /// Draws so many frames without a pause, waits, and times the last.
    fn sample(
        &mut self,
        contender: &mut Contender,
        detail: Detail,
        frames: usize,
    ) -> Result<Times, RenderError> {
        let ours = match contender {
            Contender::Ours(visibility, renderer) => Some((
                renderer.as_mut(),
                &self.preset.stack,
                request_of(*visibility),
            )),
            Contender::Stacked(_, own) => Some((&mut own.1, &own.0, AccuracyRequest::default())),
            _ => None,
        };
        if let Some((renderer, stack, accuracy)) = ours {
            for _ in 0..frames {
                renderer
                    .draw_timed(&self.view, stack, &accuracy, detail, Wait::Simulation)
                    .block_on()?;
            }
            let report = renderer.finish().block_on()?;
            return Ok(Times {
                total_ms: report.gpu_ms,
                passes: report.passes,
            });
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        for frame in 1..=frames {
            let mut timer = self.timer.as_mut().filter(|_| frame == frames);
            if let Some(timer) = &mut timer {
                timer.begin(&mut encoder, detail);
            }
            match contender {
                Contender::Naive(_, naive) => naive.record(&mut encoder, timer),
                Contender::Hardware(hardware) => hardware.record(&mut encoder, timer)?,
                Contender::Ours(..) | Contender::Stacked(..) => {}
            }
        }
        let staged = Staged::stage(
            self.gpu,
            &mut encoder,
            StatSources::default(),
            self.timer.as_ref(),
            None,
        );
        self.gpu.queue.submit([encoder.finish()]);
        let pending = staged.begin();
        pending.ready(self.gpu).block_on()?;
        pending
            .read(self.timer.as_ref())
            .map(|(_, times)| times)
            .ok_or(RenderError::Lost)
    }
}

fn error_of(verdict: Option<&Verdict>) -> ErrorStats {
    verdict.map_or_else(ErrorStats::default, |verdict| (&verdict.report).into())
}

fn request_of(visibility: Visibility) -> AccuracyRequest {
    AccuracyRequest {
        pins: PinnedOptions::of(visibility),
        ..AccuracyRequest::default()
    }
}

/// Error of a picture that has no triangle ids: where it shows something it should not or the
/// reverse, and how far off it is.
fn picture_error(picture: &[[u8; 4]], expected: &Frame) -> ErrorStats {
    let is_drawn = |i: usize| picture[i][3] != 0;
    let is_owned = |i: usize| expected.triangle_id[i] != NO_TRIANGLE;
    let count =
        |wrong: &dyn Fn(usize) -> bool| (0..picture.len()).filter(|&i| wrong(i)).count() as u64;
    // Only pixels that both drew: a hole is counted as one, not as a color.
    let both: Vec<usize> = (0..picture.len())
        .filter(|&i| is_drawn(i) && is_owned(i))
        .collect();
    let opaque = |c: [u8; 4]| [c[0], c[1], c[2], 255];
    let ours: Vec<_> = both.iter().map(|&i| opaque(picture[i])).collect();
    let theirs: Vec<_> = both.iter().map(|&i| opaque(expected.color[i])).collect();
    let delta = compare::pictures(&ours, &theirs, 1);
    ErrorStats {
        holes: Some(count(&|i| is_owned(i) && !is_drawn(i))),
        extra: Some(count(&|i| is_drawn(i) && !is_owned(i))),
        max_color_delta: Some(delta.max_delta),
        rms_color_delta: Some(delta.rms),
        ..ErrorStats::default()
    }
}

impl Entry {
    fn new(contender: Contender, error: ErrorStats) -> Self {
        Self {
            contender,
            error,
            whole: Vec::new(),
            invalid: 0,
            passes: Vec::new(),
        }
    }

    fn keep(&mut self, times: Times, detail: Detail) {
        match (detail, times.total_ms) {
            (Detail::Whole, Some(ms)) => self.whole.push(ms),
            (Detail::Whole, None) => self.invalid += 1,
            (Detail::Passes, _) => {
                for (name, ms) in times.passes {
                    match self.passes.iter_mut().find(|(known, _)| *known == name) {
                        Some((_, samples)) => samples.push(ms),
                        None => self.passes.push((name, vec![ms])),
                    }
                }
            }
        }
    }

    fn finish(self, row: &dyn Fn(String, ErrorStats, Option<String>) -> BenchRow) -> BenchRow {
        let note = match self.contender {
            Contender::Naive(Viewport::AsWritten, _) => {
                Some("naive draws one quadrant of the view, as its author wrote it; holes are not comparable".into())
            }
            _ if self.invalid > 0 => Some(format!("{}: {} samples had no valid timestamps", self.contender.option(), self.invalid)),
            _ => None,
        };
        let percentile = |samples: &[f64], p| timing::percentile(samples, p);
        let pass = |(name, samples): (String, Vec<f64>)| {
            Some(PassTime {
                name,
                ms_p50: percentile(&samples, 0.5)?,
                ms_p95: percentile(&samples, 0.95)?,
            })
        };
        BenchRow {
            ms_p50: percentile(&self.whole, 0.5),
            ms_p95: percentile(&self.whole, 0.95),
            samples: self.whole.len(),
            is_promised: match &self.contender {
                Contender::Ours(visibility, _) => visibility.is_exact(),
                Contender::Stacked(..) => true,
                Contender::Naive(..) | Contender::Hardware(_) => false,
            },
            passes: self.passes.into_iter().filter_map(pass).collect(),
            ..row(self.contender.option(), self.error, note)
        }
    }
}
