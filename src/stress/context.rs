//! The context of a running case: draws with every option and work distribution, compares with the oracle, counts, and can
//! be stopped between pictures.

use std::sync::Arc;

use super::scenes::Rng;
use crate::{
    accuracy::{PinnedOptions, Visibility},
    effects::{Effect, Stack},
    gpu::{Capture, RenderError, Renderer},
    math::{fnv1a, hash},
    measure::{Budget, ErrorReport as Errors, Verdict, compare},
    oracle,
    plan::{AccuracyRequest, Caps, Tier, Tuning},
    preset::{Preset, SceneSource},
    scene::{Scene, builtin, draw::DrawError, view::View},
};

/// Why a case ends early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EarlyEnd {
    Failed(String),
    /// The adapter lacks what this sentence names.
    Skipped(String),
    /// The user stopped the run.
    Stopped,
}

impl From<String> for EarlyEnd {
    fn from(why: String) -> Self {
        Self::Failed(why)
    }
}

impl From<RenderError> for EarlyEnd {
    fn from(error: RenderError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<DrawError> for EarlyEnd {
    fn from(error: DrawError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Fails the case with a sentence unless the condition holds.
macro_rules! check {
    ($condition:expr, $($sentence:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err($crate::stress::EarlyEnd::Failed(format!($($sentence)+)));
        }
    };
}
pub(super) use check;

/// How much a case has drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub pictures: u64,
    pub pixels: u64,
    pub triangles: u64,
}

/// The result of a case besides its outcome.
pub(super) struct Left {
    pub refusal: Option<String>,
    pub seed: Option<u32>,
    pub notes: Vec<String>,
    pub counts: Counts,
}

/// What a case draws with.
pub struct CaseContext<'a> {
    pub renderer: &'a mut Renderer,
    seed: u32,
    is_seeded: bool,
    keep_going: &'a dyn Fn(&str) -> bool,
    counts: Counts,
    notes: Vec<String>,
    refusal: Option<String>,
    /// The number of depth-band pixels is not limited.
    allows_any_depth_band: bool,
    /// Pictures are drawn on the strict option, where there is one.
    strict: Option<Strict>,
}

/// Results of the pictures of a case drawn with strict accuracy.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strict {
    pub pictures: u64,
    /// Pictures that depend on float arithmetic and were drawn with default accuracy.
    pub floats: u64,
    /// Hashes of all triangle ids and keys, one picture after another.
    pub adapter: u64,
    pub cpu: u64,
}

/// Largest fraction of pixels in the depth band, where two triangle ids are correct. 16 pixels are always allowed.
pub const MAX_DEPTH_BAND_FRACTION: f64 = 0.01;

/// Checks that all integers are exact, colours are within one step, and the depth band is small.
///
/// # Errors
/// A sentence for each violation.
pub fn exactness(errors: &Errors) -> Result<(), String> {
    errors.within(&Budget { max_depth_band_pixels: ((errors.pixels as f64 * MAX_DEPTH_BAND_FRACTION) as u64).max(16), ..Budget::default() })
}

/// How triangles are distributed over invocations and workgroups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkDistribution {
    /// A workgroup for each triangle that is not tiny.
    WorkgroupEach,
    /// The limits of a graphics card, with a resolve over listed tiles.
    CardListedTiles,
    /// The limits of a graphics card, with a resolve over all pixels.
    Card,
    /// One invocation for each triangle.
    InvocationEach,
}

impl WorkDistribution {
    /// Together they use every kernel.
    pub const ALL: [Self; 4] = [Self::WorkgroupEach, Self::CardListedTiles, Self::Card, Self::InvocationEach];

    /// The tuning that distributes work in this way.
    pub fn tuning(self) -> Tuning {
        let is_card = matches!(self, Self::CardListedTiles | Self::Card);
        let [max_small_samples, max_small_side] = match self {
            Self::WorkgroupEach => [1, 1],
            Self::CardListedTiles | Self::Card => [64, 32],
            Self::InvocationEach => [128 * 128, 128],
        };
        let listed_tiles = matches!(self, Self::CardListedTiles | Self::InvocationEach);
        Tuning {
            max_small_samples,
            group_size: if is_card { 256 } else { 64 },
            max_list_entries: if is_card { 100 } else { u32::MAX },
            max_small_side,
            listed_tiles,
            early_load: listed_tiles,
            specialized: true,
        }
    }
}

/// The tunings of all work distributions.
pub fn tunings() -> [Tuning; 4] {
    WorkDistribution::ALL.map(WorkDistribution::tuning)
}

/// The visibility options that lose nothing and that an adapter has.
pub fn options(caps: &Caps) -> Vec<Visibility> {
    Visibility::EXACT.into_iter().filter(|option| option.is_supported(caps.int64_atomics)).collect()
}

/// The exact option that a CPU adapter is quickest on, for what takes long.
pub fn quick_option(caps: &Caps) -> Visibility {
    if caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 }
}

/// A request for one visibility option, all else planned.
pub fn pinned(visibility: Visibility) -> AccuracyRequest {
    AccuracyRequest { pins: PinnedOptions::of(visibility), ..AccuracyRequest::default() }
}

/// A stack of effects with default parameters.
///
/// # Panics
/// If an effect does not exist.
pub fn stack(names: &[&str]) -> Stack {
    let mut stack = Stack::default();
    for name in names {
        stack.enable(Effect::find(name).unwrap_or_else(|| panic!("no effect {name}")));
    }
    stack
}

/// Draws without judging.
///
/// # Errors
/// The error of the renderer or the device.
pub fn captured(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<Capture, String> {
    let name = &scene.name;
    renderer.set_scene(scene).map_err(|error| format!("{name}: {error}"))?;
    let capture = renderer.capture(view, stack, accuracy).map_err(|error| format!("{name}: {error}"))?;
    match renderer.gpu().take_error() {
        Some(error) => Err(format!("{name}: the device reports {error}")),
        None => Ok(capture),
    }
}

/// Draws and judges.
///
/// # Errors
/// The error of the renderer, the device or the oracle.
pub fn judged(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<(Capture, Verdict), String> {
    let capture = captured(renderer, scene, view, stack, accuracy)?;
    let verdict = oracle::judge(scene, view, stack, &capture.picture()).map_err(|error| format!("{}: {error}", scene.name))?;
    Ok((capture, verdict))
}

/// The number of triangles that cover each pixel.
pub(super) fn layers(capture: &Capture) -> &[u32] {
    capture.layers.as_deref().unwrap_or_default()
}

/// Fails unless every sample is covered exactly once.
pub(super) fn once(capture: &Capture, what: &str) -> Result<(), EarlyEnd> {
    match layers(capture).iter().enumerate().find(|(_, hits)| **hits != 1) {
        None if !layers(capture).is_empty() => Ok(()),
        None => Err(EarlyEnd::Failed(format!("{what}: no hits were counted"))),
        Some((pixel, hits)) => {
            let width = capture.frame.width.max(1) as usize;
            Err(EarlyEnd::Failed(format!("{what}: the sample of pixel {}, {} is covered {hits} times", pixel % width, pixel / width)))
        }
    }
}

/// Fails with both values if they differ.
pub(super) fn equal<T: PartialEq + std::fmt::Debug>(found: &T, expected: &T, what: &str) -> Result<(), EarlyEnd> {
    if found == expected { Ok(()) } else { Err(EarlyEnd::Failed(format!("{what}: found {found:?}, expected {expected:?}"))) }
}

/// Fails where two pictures differ in a triangle id, a depth key or a number of hits.
pub(super) fn same(found: &Capture, expected: &Capture, what: &str) -> Result<(), EarlyEnd> {
    let images = [
        ("triangle ids", compare::triangle_ids(&found.frame.triangle_id, &expected.frame.triangle_id)),
        ("depth keys", compare::triangle_ids(&found.frame.depth_key, &expected.frame.depth_key)),
        ("numbers of hits", compare::triangle_ids(layers(found), layers(expected))),
    ];
    match images.iter().find(|(_, delta)| delta.different > 0) {
        None => Ok(()),
        Some((which, delta)) => {
            Err(EarlyEnd::Failed(format!("{what}: {} pixels have other {which}: {:?}", delta.different, delta.mismatches)))
        }
    }
}

impl<'a> CaseContext<'a> {
    pub(super) fn new(renderer: &'a mut Renderer, seed: u32, keep_going: &'a dyn Fn(&str) -> bool) -> Self {
        let default = renderer.gpu().caps.tuning();
        renderer.set_tuning(default);
        Self {
            renderer,
            seed,
            is_seeded: false,
            keep_going,
            counts: Counts::default(),
            notes: vec![],
            refusal: None,
            allows_any_depth_band: false,
            strict: None,
        }
    }

    /// Restores the renderer.
    pub(super) fn leave(self) -> Left {
        let default = self.renderer.gpu().caps.tuning();
        self.renderer.set_tuning(default);
        Left { refusal: self.refusal, seed: self.is_seeded.then_some(self.seed), notes: self.notes, counts: self.counts }
    }

    /// A random number generator; each stream and each seed gives other numbers.
    pub(super) fn rng(&mut self, stream: u32) -> Rng {
        self.is_seeded = true;
        Rng(stream ^ hash(self.seed))
    }

    /// From now on any number of pixels may be in the depth band. Needed for pictures of few pixels.
    pub(super) fn allow_any_depth_band(&mut self) {
        self.allows_any_depth_band = true;
    }

    /// Adds a remark to the report, once.
    pub(super) fn note(&mut self, sentence: String) {
        if !self.notes.contains(&sentence) {
            self.notes.push(sentence);
        }
    }

    /// Records an expected refusal.
    pub(super) fn refused(&mut self, sentence: impl std::fmt::Display) {
        self.refusal = Some(sentence.to_string());
    }

    /// Counts a picture that is about to be drawn; ends the case if the user has stopped the run.
    pub(super) fn step(&mut self, scene: &Scene, view: &View, what: &str) -> Result<(), EarlyEnd> {
        self.counts.pictures += 1;
        self.counts.pixels += view.pixels() as u64;
        self.counts.triangles += scene.triangle_count();
        if (self.keep_going)(what) { Ok(()) } else { Err(EarlyEnd::Stopped) }
    }

    /// Runs a case with strict accuracy. Its remarks are dropped, since it made them before.
    pub(super) fn strictly(&mut self, name: &str, run: fn(&mut Self) -> Result<(), EarlyEnd>) -> Result<Strict, EarlyEnd> {
        let remarks = self.notes.len();
        self.strict = Some(Strict::default());
        let outcome = run(self);
        let strict = self.strict.take().unwrap_or_default();
        self.notes.truncate(remarks);
        let default = self.renderer.gpu().caps.tuning();
        self.renderer.set_tuning(default);
        match outcome {
            Ok(()) | Err(EarlyEnd::Skipped(_)) => Ok(strict),
            Err(EarlyEnd::Failed(why)) => Err(EarlyEnd::Failed(format!("{name}: {why}"))),
            Err(EarlyEnd::Stopped) => Err(EarlyEnd::Stopped),
        }
    }

    /// The accuracy for a picture: strict where that is requested and the picture does not depend on floats.
    fn requested(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<AccuracyRequest, EarlyEnd> {
        let Some(strict) = &mut self.strict else { return Ok(*accuracy) };
        let expected = AccuracyRequest { tier: Tier::Strict, ..*accuracy };
        self.renderer.set_scene(scene)?;
        match self.renderer.draw(view, stack, &expected) {
            Err(RenderError::Plan(_)) => {
                strict.floats += 1;
                Ok(*accuracy)
            }
            _ => Ok(expected),
        }
    }

    /// Compares a strict picture with the CPU's, bit by bit.
    fn hold_strict(&mut self, capture: &Capture, scene: &Scene, view: &View, stack: &Stack, what: &str) -> Result<(), EarlyEnd> {
        let Some(strict) = &mut self.strict else { return Ok(()) };
        let view = &view.with_grid(view.precision.subpixel_bits, capture.geometry.is_relative);
        let (triangle_id, key) = oracle::strict_frame(scene, view, stack)?;
        let folded = |hash: u64, [a, b]: [&[u32]; 2]| fnv1a(&[&[hash as u32, (hash >> 32) as u32], a, b].concat());
        strict.pictures += 1;
        strict.adapter = folded(strict.adapter, [&capture.frame.triangle_id, &capture.frame.depth_key]);
        strict.cpu = folded(strict.cpu, [&triangle_id, &key]);
        let different = [(&capture.frame.triangle_id, &triangle_id), (&capture.frame.depth_key, &key)]
            .map(|(a, b)| compare::triangle_ids(a, b).different);
        if different == [0, 0] {
            Ok(())
        } else {
            Err(EarlyEnd::Failed(format!("{what}: {different:?} triangle ids and keys are not the CPU's")))
        }
    }

    /// Returns true for a software adapter, which takes minutes where a GPU takes seconds.
    pub(super) fn is_software(&self) -> bool {
        self.renderer.gpu().caps.software
    }

    /// Returns true for a software adapter that also compiles slowly (SwiftShader).
    pub(super) fn is_slow(&self) -> bool {
        self.is_software() && !self.renderer.gpu().caps.int64_atomics
    }

    /// The exact visibility options of this adapter.
    pub(super) fn options(&self) -> Vec<Visibility> {
        if self.strict.is_some() {
            return vec![self.quick_option()];
        }
        options(&self.renderer.gpu().caps)
    }

    /// The exact option that a CPU adapter is quickest on.
    pub(super) fn quick_option(&self) -> Visibility {
        quick_option(&self.renderer.gpu().caps)
    }

    /// Builds a builtin scene.
    pub(super) fn scene(&self, query: &str) -> Result<Arc<Scene>, EarlyEnd> {
        builtin::build(query).map(Arc::new).map_err(|error| EarlyEnd::Failed(format!("{query}: {error}")))
    }

    /// The view of a scene with the default camera.
    pub(super) fn view(&self, scene: &Scene, size: [u32; 2]) -> View {
        Preset { scene: SceneSource::Builtin(scene.name.clone()), ..Preset::default() }.view(scene, size)
    }

    /// Draws without judging.
    pub(super) fn captured(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        what: &str,
    ) -> Result<Capture, EarlyEnd> {
        self.step(scene, view, what)?;
        let accuracy = &self.requested(scene, view, stack, accuracy)?;
        captured(self.renderer, scene, view, stack, accuracy).map_err(|error| EarlyEnd::Failed(format!("{what}: {error}")))
    }

    /// Draws and judges.
    pub(super) fn judged(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        what: &str,
    ) -> Result<(Capture, Verdict), EarlyEnd> {
        self.step(scene, view, what)?;
        let accuracy = &self.requested(scene, view, stack, accuracy)?;
        let judged = judged(self.renderer, scene, view, stack, accuracy).map_err(|error| EarlyEnd::Failed(format!("{what}: {error}")))?;
        if accuracy.tier == Tier::Strict && view.pixels() > 0 {
            self.hold_strict(&judged.0, scene, view, stack, what)?;
        }
        Ok(judged)
    }

    /// Draws, judges and insists on [`exactness`].
    pub(super) fn exact(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        what: &str,
    ) -> Result<(Capture, Verdict), EarlyEnd> {
        let (capture, verdict) = self.judged(scene, view, stack, accuracy, what)?;
        let judgement = if self.allows_any_depth_band { verdict.report.within(&Budget::default()) } else { exactness(&verdict.report) };
        match judgement {
            Ok(()) => Ok((capture, verdict)),
            Err(faults) => Err(EarlyEnd::Failed(format!("{what}: {faults}"))),
        }
    }

    /// Draws with every exact option and the work distribution of a graphics card, and with the quickest option also with a
    /// workgroup for each triangle and with the adapter's default. Every picture must be exact and equal to the first, which is
    /// returned.
    pub(super) fn exact_on_all_with(&mut self, scene: &Arc<Scene>, view: &View, stack: &Stack, what: &str) -> Result<Capture, EarlyEnd> {
        if self.strict.is_some() {
            return Ok(self.exact(scene, view, stack, &pinned(self.quick_option()), what)?.0);
        }
        let default = self.renderer.gpu().caps.tuning();
        let [workgroup_each, card] = [WorkDistribution::WorkgroupEach, WorkDistribution::Card].map(WorkDistribution::tuning);
        let last = self.quick_option();
        let options = self.options();
        let ways: Vec<_> = if self.is_slow() {
            // Compiling kernels takes longer than drawing all their pictures.
            self.note("each option and each way to share out work is drawn once, since this adapter is slow".into());
            options.into_iter().zip([workgroup_each, card].into_iter().cycle()).collect()
        } else {
            options.into_iter().map(|option| (option, card)).chain([(last, workgroup_each), (last, default)]).collect()
        };
        let mut first: Option<Capture> = None;
        for (option, tuning) in ways {
            self.renderer.set_tuning(tuning);
            let what = format!("{what}, {}, up to {} samples to an invocation", option.name(), tuning.max_small_samples);
            let (capture, _) = self.exact(scene, view, stack, &pinned(option), &what)?;
            match &first {
                None => first = Some(capture),
                Some(first) => same(&capture, first, &what)?,
            }
        }
        self.renderer.set_tuning(default);
        first.ok_or_else(|| EarlyEnd::Failed(format!("{what}: this adapter has no exact visibility option")))
    }

    /// [`Self::exact_on_all_with`] without effects.
    pub(super) fn exact_on_all(&mut self, scene: &Arc<Scene>, view: &View, what: &str) -> Result<Capture, EarlyEnd> {
        self.exact_on_all_with(scene, view, &Stack::default(), what)
    }
}
