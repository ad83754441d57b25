//! The lab of a case: draws on every option and tuning, lets the oracle judge, counts, and can be stopped between pictures.

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
    /// The adapter lacks something.
    Skipped(String),
    /// Somebody stopped the run.
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

/// What a case has drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub pictures: u64,
    pub pixels: u64,
    pub triangles: u64,
}

/// What a case leaves behind.
pub(super) struct Left {
    pub refusal: Option<String>,
    pub seed: Option<u32>,
    pub notes: Vec<String>,
    pub counts: Counts,
}

/// Where a case works.
pub struct CaseContext<'a> {
    pub renderer: &'a mut Renderer,
    seed: u32,
    is_seeded: bool,
    keep_going: &'a dyn Fn(&str) -> bool,
    counts: Counts,
    notes: Vec<String>,
    refusal: Option<String>,
    /// The depth band may be of any size.
    allows_any_depth_band: bool,
    /// Pictures are drawn on the strict option, where there is one.
    strict: Option<Strict>,
}

/// What the pictures of a case come to on the strict option.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strict {
    pub pictures: u64,
    /// Pictures that hang on floats, and were drawn as usual.
    pub floats: u64,
    /// Hashes of all triangle ids and keys, one picture after another.
    pub adapter: u64,
    pub cpu: u64,
}

/// Largest share of pixels that may lie in the depth band, where two triangle ids are right; 16 pixels are always allowed.
pub const BAND_SHARE: f64 = 0.01;

/// Nothing exact is wrong, colours are within one step, and the band is small.
///
/// # Errors
/// A sentence for everything that is wrong.
pub fn exactness(errors: &Errors) -> Result<(), String> {
    errors.within(&Budget { max_depth_band_pixels: ((errors.pixels as f64 * BAND_SHARE) as u64).max(16), ..Budget::default() })
}

/// Ways to share out work that use every kernel: all but the tiniest triangles by a workgroup each, the usual limits of
/// a GPU, all by one invocation; with the resolve over all pixels or over listed tiles.
pub fn tunings() -> [Tuning; 4] {
    [(1, 1, false), (64, 32, true), (64, 32, false), (128 * 128, 128, true)].map(|(max_small_samples, max_small_side, listed_tiles)| {
        Tuning {
            max_small_samples,
            group_size: if max_small_samples == 64 { 256 } else { 64 },
            max_list_entries: if max_small_samples == 64 { 100 } else { u32::MAX },
            max_small_side,
            listed_tiles,
            early_load: listed_tiles,
            specialized: true,
        }
    })
}

/// The visibility options that lose nothing and that an adapter has.
pub fn options(caps: &Caps) -> Vec<Visibility> {
    Visibility::EXACT.into_iter().filter(|option| option.is_there(caps.int64_atomics)).collect()
}

/// The exact option that a CPU adapter is quickest on, for what takes long.
pub fn quick_option(caps: &Caps) -> Visibility {
    if caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 }
}

/// One option and no other.
pub fn pinned(visibility: Visibility) -> AccuracyRequest {
    AccuracyRequest { pins: PinnedOptions::of(visibility), ..AccuracyRequest::default() }
}

/// A stack of effects with their defaults.
///
/// # Panics
/// When an effect does not exist.
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
/// What the renderer or the device says.
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
        Some(error) => Err(format!("{name}: the device says {error}")),
        None => Ok(capture),
    }
}

/// Draws and judges.
///
/// # Errors
/// What the renderer, the device or the oracle says.
pub fn judged(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<(Capture, Verdict), String> {
    let capture = captured(renderer, scene, view, stack, accuracy)?;
    let (layers, previous) = (capture.layers.as_deref(), capture.previous.as_deref());
    let verdict = oracle::judge_after(scene, view, stack, &capture.frame, &capture.geometry, layers, previous)
        .map_err(|error| format!("{}: {error}", scene.name))?;
    Ok((capture, verdict))
}

/// Hits of each pixel.
pub(super) fn layers(capture: &Capture) -> &[u32] {
    capture.layers.as_deref().unwrap_or_default()
}

/// Fails unless every sample of the picture is covered exactly once.
pub(super) fn once(capture: &Capture, what: &str) -> Result<(), EarlyEnd> {
    match layers(capture).iter().enumerate().find(|(_, hits)| **hits != 1) {
        None if !layers(capture).is_empty() => Ok(()),
        None => Err(EarlyEnd::Failed(format!("{what}: nothing was counted"))),
        Some((pixel, hits)) => {
            let width = capture.frame.width.max(1) as usize;
            Err(EarlyEnd::Failed(format!("{what}: the sample of pixel {}, {} is covered {hits} times", pixel % width, pixel / width)))
        }
    }
}

/// Fails with both where they differ.
pub(super) fn equal<T: PartialEq + std::fmt::Debug>(found: &T, expected: &T, what: &str) -> Result<(), EarlyEnd> {
    if found == expected { Ok(()) } else { Err(EarlyEnd::Failed(format!("{what}: {found:?}, where {expected:?} is right"))) }
}

/// Fails where two pictures differ in an triangle id, a depth key or a number of hits.
pub(super) fn same(found: &Capture, expected: &Capture, what: &str) -> Result<(), EarlyEnd> {
    let images = [
        ("triangle_ids", compare::triangle_ids(&found.frame.triangle_id, &expected.frame.triangle_id)),
        ("depth keys", compare::triangle_ids(&found.frame.key, &expected.frame.key)),
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

    /// Leaves the renderer as it was found.
    pub(super) fn leave(self) -> Left {
        let default = self.renderer.gpu().caps.tuning();
        self.renderer.set_tuning(default);
        Left { refusal: self.refusal, seed: self.is_seeded.then_some(self.seed), notes: self.notes, counts: self.counts }
    }

    /// Chance for one purpose: another stream for every purpose, and another chance for every seed.
    pub(super) fn rng(&mut self, stream: u32) -> Rng {
        self.is_seeded = true;
        Rng(stream ^ hash(self.seed))
    }

    /// From now on any number of pixels may lie in the depth band, where two triangle ids are right: of a picture of a few pixels
    /// many do.
    pub(super) fn allow_any_depth_band(&mut self) {
        self.allows_any_depth_band = true;
    }

    /// For people who read the report; said once.
    pub(super) fn note(&mut self, sentence: String) {
        if !self.notes.contains(&sentence) {
            self.notes.push(sentence);
        }
    }

    /// What was refused, as it should be.
    pub(super) fn refused(&mut self, sentence: impl std::fmt::Display) {
        self.refusal = Some(sentence.to_string());
    }

    /// Before something that takes time: counts it, and ends the case when somebody wants that.
    pub(super) fn step(&mut self, scene: &Scene, view: &View, what: &str) -> Result<(), EarlyEnd> {
        self.counts.pictures += 1;
        self.counts.pixels += view.pixels() as u64;
        self.counts.triangles += scene.triangle_count();
        if (self.keep_going)(what) { Ok(()) } else { Err(EarlyEnd::Stopped) }
    }

    /// Runs a case on the strict option; what it remarks on it has remarked on before.
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

    /// The accuracy that a picture gets: the strict tier's while that is asked for and nothing hangs on floats.
    fn asked(&mut self, scene: &Arc<Scene>, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<AccuracyRequest, EarlyEnd> {
        let Some(strict) = &mut self.strict else { return Ok(*accuracy) };
        let wanted = AccuracyRequest { tier: Tier::Strict, ..*accuracy };
        self.renderer.set_scene(scene)?;
        match self.renderer.draw(view, stack, &wanted) {
            Err(RenderError::Plan(_)) => {
                strict.floats += 1;
                Ok(*accuracy)
            }
            _ => Ok(wanted),
        }
    }

    /// Holds a strict picture against the CPU's.
    fn hold_strict(&mut self, capture: &Capture, scene: &Scene, view: &View, stack: &Stack, what: &str) -> Result<(), EarlyEnd> {
        let Some(strict) = &mut self.strict else { return Ok(()) };
        let view = &View { is_relative: capture.geometry.is_relative, ..view.clone() };
        let (triangle_id, key) = oracle::strict_frame(scene, view, stack)?;
        let folded = |hash: u64, [a, b]: [&[u32]; 2]| fnv1a(&[&[hash as u32, (hash >> 32) as u32], a, b].concat());
        strict.pictures += 1;
        strict.adapter = folded(strict.adapter, [&capture.frame.triangle_id, &capture.frame.key]);
        strict.cpu = folded(strict.cpu, [&triangle_id, &key]);
        let different =
            [(&capture.frame.triangle_id, &triangle_id), (&capture.frame.key, &key)].map(|(a, b)| compare::triangle_ids(a, b).different);
        if different == [0, 0] {
            Ok(())
        } else {
            Err(EarlyEnd::Failed(format!("{what}: {different:?} triangle ids and keys are not the CPU's")))
        }
    }

    /// Is this a CPU adapter, to which a minute is what a second is to a card?
    pub(super) fn is_software(&self) -> bool {
        self.renderer.gpu().caps.software
    }

    /// Is it one that compiles slowly besides (SwiftShader)? It has two options that lose nothing.
    pub(super) fn is_slow(&self) -> bool {
        self.is_software() && !self.renderer.gpu().caps.int64_atomics
    }

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

    /// A builtin scene by its query.
    pub(super) fn scene(&self, query: &str) -> Result<Arc<Scene>, EarlyEnd> {
        builtin::build(query).map(Arc::new).map_err(|error| EarlyEnd::Failed(format!("{query}: {error}")))
    }

    /// A scene as a preset without a camera shows it.
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
        let accuracy = &self.asked(scene, view, stack, accuracy)?;
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
        let accuracy = &self.asked(scene, view, stack, accuracy)?;
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
        let judgement = if self.allows_any_depth_band { verdict.accuracy.within(&Budget::default()) } else { exactness(&verdict.accuracy) };
        match judgement {
            Ok(()) => Ok((capture, verdict)),
            Err(faults) => Err(EarlyEnd::Failed(format!("{what}: {faults}"))),
        }
    }

    /// Draws on every option with work shared out as on a graphics card, and on the last option as the adapter likes it and
    /// with a workgroup for all but the tiniest triangles. Each is exact, and all are the same; the first is handed over.
    pub(super) fn exact_on_all_with(&mut self, scene: &Arc<Scene>, view: &View, stack: &Stack, what: &str) -> Result<Capture, EarlyEnd> {
        if self.strict.is_some() {
            return Ok(self.exact(scene, view, stack, &pinned(self.quick_option()), what)?.0);
        }
        let default = self.renderer.gpu().caps.tuning();
        let [crowded, _, card, _] = tunings();
        let last = self.quick_option();
        let options = self.options();
        let ways: Vec<_> = if self.is_slow() {
            // Kernels take longer to compile than all their pictures to draw.
            self.note("each option and each way to share out work is drawn once, since this adapter is slow".into());
            options.into_iter().zip([crowded, card].into_iter().cycle()).collect()
        } else {
            options.into_iter().map(|option| (option, card)).chain([(last, crowded), (last, default)]).collect()
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
        first.ok_or_else(|| EarlyEnd::Failed(format!("{what}: this adapter has no option")))
    }

    pub(super) fn exact_on_all(&mut self, scene: &Arc<Scene>, view: &View, what: &str) -> Result<Capture, EarlyEnd> {
        self.exact_on_all_with(scene, view, &Stack::default(), what)
    }
}
