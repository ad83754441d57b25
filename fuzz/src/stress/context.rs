//! The context of a running case: draws with every option and work distribution, compares with the
//! oracle, and counts.

use std::sync::Arc;

use pollster::FutureExt as _;

use super::{
    case::{Outcome, Report},
    checks::{EarlyEnd, same},
    drawing::{self, WorkDistribution, exactness, pinned},
    scenes::Rng,
};
use crate::{
    accuracy::Visibility,
    effects::Stack,
    frame::CullingStats,
    gpu::{Capture, RenderError, Renderer},
    math::{fnv1a, hash},
    measure::{Budget, Verdict, compare},
    oracle,
    plan::{AccuracyRequest, Tier},
    preset::Preset,
    scene::{Scene, builtin, view::View},
};

/// What a case draws with.
pub struct CaseContext<'a> {
    pub renderer: &'a mut Renderer,
    seed: u32,
    is_seeded: bool,
    pictures: u64,
    notes: Vec<String>,
    pub(super) refusal: Option<String>,
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

impl<'a> CaseContext<'a> {
    pub(super) fn new(renderer: &'a mut Renderer, seed: u32) -> Self {
        let default = renderer.gpu().caps.tuning();
        renderer.set_tuning(default);
        Self {
            renderer,
            seed,
            is_seeded: false,
            pictures: 0,
            notes: vec![],
            refusal: None,
            allows_any_depth_band: false,
            strict: None,
        }
    }

    /// Restores the renderer.
    pub(super) fn leave(self, outcome: Outcome) -> Report {
        let default = self.renderer.gpu().caps.tuning();
        self.renderer.set_tuning(default);
        Report {
            outcome,
            seed: self.is_seeded.then_some(self.seed),
            notes: self.notes,
            pictures: self.pictures,
        }
    }

    /// A random number generator; each stream and each seed gives other numbers.
    pub(super) fn rng(&mut self, stream: u32) -> Rng {
        self.is_seeded = true;
        Rng(stream ^ hash(self.seed))
    }

    /// From now on any number of pixels may be in the depth band. Needed for pictures of few
    /// pixels.
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

    /// Runs a case with strict accuracy. Its remarks are dropped, since it made them before.
    pub(super) fn strictly(
        &mut self,
        name: &str,
        run: fn(&mut Self) -> Result<(), EarlyEnd>,
    ) -> Result<Strict, EarlyEnd> {
        let remarks = self.notes.len();
        self.strict = Some(Strict::default());
        let outcome = run(self);
        let strict = self.strict.take().unwrap_or_default();
        self.notes.truncate(remarks);
        let default = self.renderer.gpu().caps.tuning();
        self.renderer.set_tuning(default);
        match outcome {
            Ok(()) | Err(EarlyEnd::Skipped(_)) => Ok(strict),
            Err(end) => Err(end.of(name)),
        }
    }

    /// The accuracy for a picture: strict where that is requested and the picture does not depend
    /// on floats.
    fn requested(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<AccuracyRequest, EarlyEnd> {
        let Some(strict) = &mut self.strict else {
            return Ok(*accuracy);
        };
        let expected = AccuracyRequest {
            tier: Tier::Strict,
            ..*accuracy
        };
        self.renderer.set_scene(scene).block_on()?;
        match self.renderer.draw(view, stack, &expected).block_on() {
            Err(RenderError::Plan(_)) => {
                strict.floats += 1;
                Ok(*accuracy)
            }
            _ => Ok(expected),
        }
    }

    /// Compares a strict picture with the CPU's, bit by bit.
    fn hold_strict(
        &mut self,
        capture: &Capture,
        scene: &Scene,
        view: &View,
        stack: &Stack,
        what: &str,
    ) -> Result<(), EarlyEnd> {
        let Some(strict) = &mut self.strict else {
            return Ok(());
        };
        let view = &view.with_grid(view.precision.subpixel_bits, capture.geometry.is_relative);
        let (triangle_id, key) = oracle::strict_frame(scene, view, stack)?;
        let folded = |hash: u64, [a, b]: [&[u32]; 2]| {
            fnv1a(&[&[hash as u32, (hash >> 32) as u32], a, b].concat())
        };
        strict.pictures += 1;
        strict.adapter = folded(
            strict.adapter,
            [&capture.frame.triangle_id, &capture.frame.depth_key],
        );
        strict.cpu = folded(strict.cpu, [&triangle_id, &key]);
        let different = [
            (&capture.frame.triangle_id, &triangle_id),
            (&capture.frame.depth_key, &key),
        ]
        .map(|(a, b)| compare::triangle_ids(a, b).different);
        if different == [0, 0] {
            Ok(())
        } else {
            Err(EarlyEnd::Failed(format!(
                "{what}: {different:?} triangle ids and keys are not the CPU's"
            )))
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
        drawing::options(&self.renderer.gpu().caps)
    }

    /// The exact option that a CPU adapter is quickest on.
    pub(super) fn quick_option(&self) -> Visibility {
        drawing::quick_option(&self.renderer.gpu().caps)
    }

    /// Builds a built-in scene.
    pub(super) fn scene(&self, query: &str) -> Result<Arc<Scene>, EarlyEnd> {
        builtin::build(query)
            .map(Arc::new)
            .map_err(|error| EarlyEnd::Failed(format!("{query}: {error}")))
    }

    /// The view of a scene within the picture ([`Preset::of_sphere`]).
    pub(super) fn view(&self, scene: &Scene, size: [u32; 2]) -> View {
        Preset::of_sphere(scene, size).view(scene, size)
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
        self.pictures += 1;
        let accuracy = &self.requested(scene, view, stack, accuracy)?;
        drawing::captured(self.renderer, scene, view, stack, accuracy).map_err(|end| end.of(what))
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
        self.pictures += 1;
        let accuracy = &self.requested(scene, view, stack, accuracy)?;
        let judged = drawing::judged(self.renderer, scene, view, stack, accuracy)
            .map_err(|end| end.of(what))?;
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
        let judgement = if self.allows_any_depth_band {
            verdict.report.within(&Budget::default())
        } else {
            exactness(&verdict.report)
        };
        match judgement {
            Ok(()) => Ok((capture, verdict)),
            Err(faults) => Err(EarlyEnd::Failed(format!("{what}: {faults}"))),
        }
    }

    /// Draws a picture that may use what the last one left, judges it and insists on [`exactness`];
    /// what was left out of it.
    pub(super) fn exact_next(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        what: &str,
    ) -> Result<CullingStats, EarlyEnd> {
        if self.strict.is_some() {
            return Err(EarlyEnd::Skipped(
                "pictures that follow others are drawn with default accuracy".into(),
            ));
        }
        self.pictures += 1;
        self.renderer.set_scene(scene).block_on()?;
        let capture = self
            .renderer
            .capture_next(view, stack, accuracy)
            .block_on()
            .map_err(|error| EarlyEnd::from(error).of(what))?;
        let verdict = oracle::judge(scene, view, stack, &capture.picture())?;
        exactness(&verdict.report).map_err(|faults| EarlyEnd::from(faults).of(what))?;
        Ok(self.renderer.culled().unwrap_or_default())
    }

    /// Draws with every exact option and the work distribution of a graphics card, and with the
    /// quickest option also with a workgroup for each triangle and with the adapter's default.
    /// Every picture must be exact and equal to the first, which is returned.
    pub(super) fn exact_on_all_with(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        what: &str,
    ) -> Result<Capture, EarlyEnd> {
        if self.strict.is_some() {
            return Ok(self
                .exact(scene, view, stack, &pinned(self.quick_option()), what)?
                .0);
        }
        let default = self.renderer.gpu().caps.tuning();
        let [workgroup_each, card] =
            [WorkDistribution::WorkgroupEach, WorkDistribution::Card].map(WorkDistribution::tuning);
        let last = self.quick_option();
        let options = self.options();
        let ways: Vec<_> = if self.is_slow() {
            // Compiling kernels takes longer than drawing all their pictures.
            self.note("each option and each way to share out work is drawn once, since this adapter is slow".into());
            options
                .into_iter()
                .zip([workgroup_each, card].into_iter().cycle())
                .collect()
        } else {
            options
                .into_iter()
                .map(|option| (option, card))
                .chain([(last, workgroup_each), (last, default)])
                .collect()
        };
        let mut first: Option<Capture> = None;
        for (option, tuning) in ways {
            self.renderer.set_tuning(tuning);
            let what = format!(
                "{what}, {}, up to {} samples to an invocation",
                option.name(),
                tuning.max_small_samples
            );
            let (capture, _) = self.exact(scene, view, stack, &pinned(option), &what)?;
            match &first {
                None => first = Some(capture),
                Some(first) => same(&capture, first, &what)?,
            }
        }
        self.renderer.set_tuning(default);
        first.ok_or_else(|| {
            EarlyEnd::Failed(format!(
                "{what}: this adapter has no exact visibility option"
            ))
        })
    }

    /// [`Self::exact_on_all_with`] without effects.
    pub(super) fn exact_on_all(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        what: &str,
    ) -> Result<Capture, EarlyEnd> {
        self.exact_on_all_with(scene, view, &Stack::default(), what)
    }
}
