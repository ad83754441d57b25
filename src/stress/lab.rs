//! The lab of a case: draws on every rung and tuning, lets the oracle judge, counts, and can be stopped between pictures.

use std::sync::Arc;

use super::scenes::Dice;
use crate::{
    effects::{Effect, Stack},
    gpu::{Capture, RenderError, Renderer},
    ladder::{Pins, Visibility},
    math::{fnv1a, hash},
    measure::{Accuracy as Errors, Budget, Verdict, compare},
    oracle,
    plan::{Accuracy, Caps, Tier, Tuning},
    scene::{Scene, builtin, camera::View, draw::DrawError},
    session::{SceneSource, Session},
};

/// Why a case ends early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Halt {
    Failed(String),
    /// The adapter lacks something.
    LeftOut(String),
    /// Somebody stopped the run.
    Stopped,
}

impl From<String> for Halt {
    fn from(why: String) -> Self {
        Self::Failed(why)
    }
}

impl From<RenderError> for Halt {
    fn from(error: RenderError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<DrawError> for Halt {
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
pub struct Lab<'a> {
    pub renderer: &'a mut Renderer,
    seed: u32,
    is_seeded: bool,
    go_on: &'a dyn Fn(&str) -> bool,
    counts: Counts,
    notes: Vec<String>,
    refusal: Option<String>,
    /// The depth band may be of any size.
    is_band_free: bool,
    /// Pictures are drawn on the strict rung, where there is one.
    strict: Option<Strict>,
}

/// What the pictures of a case come to on the strict rung.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strict {
    pub pictures: u64,
    /// Pictures that hang on floats, and were drawn as usual.
    pub floats: u64,
    /// Hashes of all owners and keys, one picture after another.
    pub adapter: u64,
    pub cpu: u64,
}

/// Largest share of pixels that may lie in the depth band, where two owners are right; 16 pixels are always allowed.
pub const BAND_SHARE: f64 = 0.01;

/// Nothing exact is wrong, colours are within one step, and the band is small.
///
/// # Errors
/// A sentence for everything that is wrong.
pub fn exactness(errors: &Errors) -> Result<(), String> {
    errors.within(&Budget { max_band_pixels: ((errors.pixels as f64 * BAND_SHARE) as u64).max(16), ..Budget::default() })
}

/// Ways to share out work that use every kernel: all but the tiniest triangles by a workgroup each, the usual limits of
/// a GPU, all by one invocation; with the resolve over all pixels or over listed tiles.
pub fn tunings() -> [Tuning; 4] {
    [(1, 1, false), (64, 32, true), (64, 32, false), (128 * 128, 128, true)].map(|(small_samples, small_side, listed_tiles)| Tuning {
        small_samples,
        list_group: if small_samples == 64 { 256 } else { 64 },
        list_walk: if small_samples == 64 { 100 } else { u32::MAX },
        small_side,
        listed_tiles,
        early_load: listed_tiles,
        specialized: true,
    })
}

/// The visibility rungs that lose nothing and that an adapter has.
pub fn rungs(caps: &Caps) -> Vec<Visibility> {
    Visibility::EXACT.into_iter().filter(|rung| rung.is_there(caps.int64_atomics)).collect()
}

/// The exact rung that a CPU adapter is quickest on, for what takes long.
pub fn quick_rung(caps: &Caps) -> Visibility {
    if caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 }
}

/// One rung and no other.
pub fn pinned(visibility: Visibility) -> Accuracy {
    Accuracy { pins: Pins::of(visibility), ..Accuracy::default() }
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
pub fn captured(renderer: &mut Renderer, scene: &Arc<Scene>, view: &View, stack: &Stack, accuracy: &Accuracy) -> Result<Capture, String> {
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
    accuracy: &Accuracy,
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
pub(super) fn once(capture: &Capture, what: &str) -> Result<(), Halt> {
    match layers(capture).iter().enumerate().find(|(_, hits)| **hits != 1) {
        None if !layers(capture).is_empty() => Ok(()),
        None => Err(Halt::Failed(format!("{what}: nothing was counted"))),
        Some((pixel, hits)) => {
            let width = capture.frame.width.max(1) as usize;
            Err(Halt::Failed(format!("{what}: the sample of pixel {}, {} is covered {hits} times", pixel % width, pixel / width)))
        }
    }
}

/// Fails with both where they differ.
pub(super) fn equal<T: PartialEq + std::fmt::Debug>(found: &T, expected: &T, what: &str) -> Result<(), Halt> {
    if found == expected { Ok(()) } else { Err(Halt::Failed(format!("{what}: {found:?}, where {expected:?} is right"))) }
}

/// Fails where two pictures differ in an owner, a depth key or a number of hits.
pub(super) fn same(found: &Capture, expected: &Capture, what: &str) -> Result<(), Halt> {
    let images = [
        ("owners", compare::owners(&found.frame.owner, &expected.frame.owner)),
        ("depth keys", compare::owners(&found.frame.key, &expected.frame.key)),
        ("numbers of hits", compare::owners(layers(found), layers(expected))),
    ];
    match images.iter().find(|(_, delta)| delta.different > 0) {
        None => Ok(()),
        Some((which, delta)) => Err(Halt::Failed(format!("{what}: {} pixels have other {which}: {:?}", delta.different, delta.offenders))),
    }
}

impl<'a> Lab<'a> {
    pub(super) fn new(renderer: &'a mut Renderer, seed: u32, go_on: &'a dyn Fn(&str) -> bool) -> Self {
        let usual = renderer.gpu().caps.tuning();
        renderer.set_tuning(usual);
        Self {
            renderer,
            seed,
            is_seeded: false,
            go_on,
            counts: Counts::default(),
            notes: vec![],
            refusal: None,
            is_band_free: false,
            strict: None,
        }
    }

    /// Leaves the renderer as it was found.
    pub(super) fn leave(self) -> Left {
        let usual = self.renderer.gpu().caps.tuning();
        self.renderer.set_tuning(usual);
        Left { refusal: self.refusal, seed: self.is_seeded.then_some(self.seed), notes: self.notes, counts: self.counts }
    }

    /// Chance for one purpose: another stream for every purpose, and another chance for every seed.
    pub(super) fn dice(&mut self, stream: u32) -> Dice {
        self.is_seeded = true;
        Dice(stream ^ hash(self.seed))
    }

    /// From now on any number of pixels may lie in the depth band, where two owners are right: of a picture of a few pixels
    /// many do.
    pub(super) fn free_the_band(&mut self) {
        self.is_band_free = true;
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
    pub(super) fn step(&mut self, scene: &Scene, view: &View, what: &str) -> Result<(), Halt> {
        self.counts.pictures += 1;
        self.counts.pixels += view.pixels() as u64;
        self.counts.triangles += scene.triangle_count();
        if (self.go_on)(what) { Ok(()) } else { Err(Halt::Stopped) }
    }

    /// Runs a case on the strict rung; what it remarks on it has remarked on before.
    pub(super) fn strictly(&mut self, name: &str, run: fn(&mut Self) -> Result<(), Halt>) -> Result<Strict, Halt> {
        let remarks = self.notes.len();
        self.strict = Some(Strict::default());
        let outcome = run(self);
        let strict = self.strict.take().unwrap_or_default();
        self.notes.truncate(remarks);
        let usual = self.renderer.gpu().caps.tuning();
        self.renderer.set_tuning(usual);
        match outcome {
            Ok(()) | Err(Halt::LeftOut(_)) => Ok(strict),
            Err(Halt::Failed(why)) => Err(Halt::Failed(format!("{name}: {why}"))),
            Err(Halt::Stopped) => Err(Halt::Stopped),
        }
    }

    /// The accuracy that a picture gets: the strict tier's while that is asked for and nothing hangs on floats.
    fn asked(&mut self, scene: &Arc<Scene>, view: &View, stack: &Stack, accuracy: &Accuracy) -> Result<Accuracy, Halt> {
        let Some(strict) = &mut self.strict else { return Ok(*accuracy) };
        let wanted = Accuracy { tier: Tier::Strict, ..*accuracy };
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
    fn hold_strict(&mut self, capture: &Capture, scene: &Scene, view: &View, stack: &Stack, what: &str) -> Result<(), Halt> {
        let Some(strict) = &mut self.strict else { return Ok(()) };
        let view = &View { is_relative: capture.geometry.is_relative, ..view.clone() };
        let (owner, key) = oracle::strict_frame(scene, view, stack)?;
        let folded = |hash: u64, [a, b]: [&[u32]; 2]| fnv1a(&[&[hash as u32, (hash >> 32) as u32], a, b].concat());
        strict.pictures += 1;
        strict.adapter = folded(strict.adapter, [&capture.frame.owner, &capture.frame.key]);
        strict.cpu = folded(strict.cpu, [&owner, &key]);
        let different = [(&capture.frame.owner, &owner), (&capture.frame.key, &key)].map(|(a, b)| compare::owners(a, b).different);
        if different == [0, 0] { Ok(()) } else { Err(Halt::Failed(format!("{what}: {different:?} owners and keys are not the CPU's"))) }
    }

    /// Is this a CPU adapter, to which a minute is what a second is to a card?
    pub(super) fn is_software(&self) -> bool {
        self.renderer.gpu().caps.software
    }

    /// Is it one that compiles slowly besides (SwiftShader)? It has two rungs that lose nothing.
    pub(super) fn is_slow(&self) -> bool {
        self.is_software() && !self.renderer.gpu().caps.int64_atomics
    }

    pub(super) fn rungs(&self) -> Vec<Visibility> {
        if self.strict.is_some() {
            return vec![self.quick_rung()];
        }
        rungs(&self.renderer.gpu().caps)
    }

    /// The exact rung that a CPU adapter is quickest on.
    pub(super) fn quick_rung(&self) -> Visibility {
        quick_rung(&self.renderer.gpu().caps)
    }

    /// A builtin scene by its query.
    pub(super) fn scene(&self, query: &str) -> Result<Arc<Scene>, Halt> {
        builtin::build(query).map(Arc::new).map_err(|error| Halt::Failed(format!("{query}: {error}")))
    }

    /// A scene as a look without a camera shows it.
    pub(super) fn view(&self, scene: &Scene, size: [u32; 2]) -> View {
        Session { scene: SceneSource::Builtin(scene.name.clone()), ..Session::default() }.view(scene, size)
    }

    /// Draws without judging.
    pub(super) fn captured(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &Accuracy,
        what: &str,
    ) -> Result<Capture, Halt> {
        self.step(scene, view, what)?;
        let accuracy = &self.asked(scene, view, stack, accuracy)?;
        captured(self.renderer, scene, view, stack, accuracy).map_err(|error| Halt::Failed(format!("{what}: {error}")))
    }

    /// Draws and judges.
    pub(super) fn judged(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &Accuracy,
        what: &str,
    ) -> Result<(Capture, Verdict), Halt> {
        self.step(scene, view, what)?;
        let accuracy = &self.asked(scene, view, stack, accuracy)?;
        let judged = judged(self.renderer, scene, view, stack, accuracy).map_err(|error| Halt::Failed(format!("{what}: {error}")))?;
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
        accuracy: &Accuracy,
        what: &str,
    ) -> Result<(Capture, Verdict), Halt> {
        let (capture, verdict) = self.judged(scene, view, stack, accuracy, what)?;
        let judgement = if self.is_band_free { verdict.accuracy.within(&Budget::default()) } else { exactness(&verdict.accuracy) };
        match judgement {
            Ok(()) => Ok((capture, verdict)),
            Err(faults) => Err(Halt::Failed(format!("{what}: {faults}"))),
        }
    }

    /// Draws on every rung with work shared out as on a graphics card, and on the last rung as the adapter likes it and
    /// with a workgroup for all but the tiniest triangles. Each is exact, and all are the same; the first is handed over.
    pub(super) fn everywhere_with(&mut self, scene: &Arc<Scene>, view: &View, stack: &Stack, what: &str) -> Result<Capture, Halt> {
        if self.strict.is_some() {
            return Ok(self.exact(scene, view, stack, &pinned(self.quick_rung()), what)?.0);
        }
        let usual = self.renderer.gpu().caps.tuning();
        let [crowded, _, card, _] = tunings();
        let last = self.quick_rung();
        let rungs = self.rungs();
        let ways: Vec<_> = if self.is_slow() {
            // Kernels take longer to compile than all their pictures to draw.
            self.note("each rung and each way to share out work is drawn once, since this adapter is slow".into());
            rungs.into_iter().zip([crowded, card].into_iter().cycle()).collect()
        } else {
            rungs.into_iter().map(|rung| (rung, card)).chain([(last, crowded), (last, usual)]).collect()
        };
        let mut first: Option<Capture> = None;
        for (rung, tuning) in ways {
            self.renderer.set_tuning(tuning);
            let what = format!("{what}, {}, up to {} samples to an invocation", rung.name(), tuning.small_samples);
            let (capture, _) = self.exact(scene, view, stack, &pinned(rung), &what)?;
            match &first {
                None => first = Some(capture),
                Some(first) => same(&capture, first, &what)?,
            }
        }
        self.renderer.set_tuning(usual);
        first.ok_or_else(|| Halt::Failed(format!("{what}: this adapter has no rung")))
    }

    pub(super) fn everywhere(&mut self, scene: &Arc<Scene>, view: &View, what: &str) -> Result<Capture, Halt> {
        self.everywhere_with(scene, view, &Stack::default(), what)
    }
}
