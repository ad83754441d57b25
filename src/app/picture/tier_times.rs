//! What the accuracy tiers cost on the open picture: measured beside it while the window is at rest
//! and somebody looks at the slider. Times hold for one kernel, size and adapter, and those
//! of the last few pictures are kept.

use std::sync::Arc;

use super::{
    picture_thread::wait_for_frame,
    precision::REST_S,
    screen::Inputs,
    timings::{Sample, Summary, has_settled},
    verification::Verdict,
};
use crate::{
    app::{
        jobs::background::yield_processor,
        shell::{log::Level, state::State},
    },
    gpu::{CompileWatch, Gpu, RenderError, Renderer, device::AdapterChoice},
    plan::{MeasuredCosts, Plan, Tier, predict::Prediction},
    preset::AccuracyRequest,
    shader::key::KernelKey,
};

/// How far a picture was judged to be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Pixels with another triangle than the oracle draws from the same snapped corners.
    pub wrong: u64,
    /// And than the exact picture of the true positions; none where that is not reproducible.
    pub by_rounding: Option<u64>,
    /// Largest difference of a color channel, of 255.
    pub channel: u8,
}

/// What is known of a tier on the open picture.
#[derive(Clone, Debug, PartialEq)]
pub struct TierNumbers {
    /// Tiers with the same one draw the same picture.
    pub kernel: KernelKey,
    pub time: TierTime,
    pub judged: Option<Judged>,
    /// What its options may err by.
    pub bound: Prediction,
}

/// What a tier costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TierTime {
    NotYet,
    /// It was tried.
    Failed,
    /// Milliseconds of a frame.
    Ms(f64),
}

/// What draws the frames that are timed, kept from tier to tier.
#[derive(Default)]
pub struct TierDrawing {
    /// Of its own on a CPU adapter, so that the picture never waits for it.
    gpu: Option<Arc<Gpu>>,
    renderer: Option<Renderer>,
}

/// A tier that was timed.
pub struct Timed {
    pub picture: Inputs,
    pub kernel: KernelKey,
    /// Milliseconds; none if it was stopped.
    pub outcome: Result<Option<f64>, String>,
    pub drawing: TierDrawing,
}

/// A picture with what was measured and judged of it.
type Known = (
    Inputs,
    Vec<(KernelKey, Option<f64>)>,
    Vec<(KernelKey, Judged)>,
);

/// Most pictures of which that is kept: a panel that opens and closes changes the size of the picture.
const MOST_KNOWN: usize = 4;

/// The times of tiers on the open picture.
#[derive(Default)]
pub struct TierTimes {
    /// The picture in any tier, and since when it is requested, seconds.
    picture: Option<(Inputs, f64)>,
    /// Milliseconds by kernel; none where it could not be measured.
    times: Vec<(KernelKey, Option<f64>)>,
    judged: Vec<(KernelKey, Judged)>,
    /// What is known of the same picture in the sizes that it had before, newest last.
    others: Vec<Known>,
    running: Option<Arc<CompileWatch>>,
    drawing: TierDrawing,
    /// What the times have told about options on this adapter.
    costs: MeasuredCosts,
    /// Somebody looks at the slider in this frame of the window.
    pub is_looked_at: bool,
}

impl Drop for TierTimes {
    fn drop(&mut self) {
        self.stop();
    }
}

impl TierTimes {
    /// The request, with what options cost on this adapter where the planner may ask for that.
    pub fn informed(&self, request: AccuracyRequest) -> AccuracyRequest {
        let measured = if request.tolerance().wrong_ppm > 0.0 {
            self.costs
        } else {
            MeasuredCosts::default()
        };
        AccuracyRequest {
            measured,
            ..request
        }
    }

    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Stops the measurement under way, if there is one, before its next pipeline or frame.
    pub fn stop(&self) {
        self.running.iter().for_each(|watch| watch.stop());
    }

    /// Forgets what was measured, as the shaders have changed.
    pub fn forget(&mut self) {
        self.stop();
        (self.picture, self.drawing.renderer) = (None, None);
        self.times.clear();
        self.judged.clear();
        self.others.clear();
    }

    /// Seconds for which the picture has not changed. What was measured of the last few others is kept.
    fn rest_s(&mut self, requested: &Inputs, now_s: f64) -> f64 {
        if let Some((_, since_s)) = self.picture.as_ref().filter(|_| self.is_of(requested)) {
            return now_s - since_s;
        }
        self.stop();
        self.drawing.renderer = None;
        let (times, judged) = (
            std::mem::take(&mut self.times),
            std::mem::take(&mut self.judged),
        );
        if let Some((before, _)) = self.picture.take()
            && !(times.is_empty() && judged.is_empty())
        {
            self.others.push((before, times, judged));
        }
        // Pictures of another scene would keep it in memory.
        self.others
            .retain(|(known, ..)| Arc::ptr_eq(&known.scene, &requested.scene));
        self.others
            .drain(..self.others.len().saturating_sub(MOST_KNOWN));
        let is_this = |(known, ..): &Known| known.is_same_but_for_tier(requested);
        if let Some(at) = self.others.iter().position(is_this) {
            (_, self.times, self.judged) = self.others.remove(at);
        }
        self.picture = Some((requested.clone(), now_s));
        0.0
    }

    /// Are these times of the same picture, perhaps in another tier?
    fn is_of(&self, inputs: &Inputs) -> bool {
        self.picture
            .as_ref()
            .is_some_and(|(picture, _)| picture.is_same_but_for_tier(inputs))
    }

    fn add(&mut self, kernel: KernelKey, ms: Option<f64>) {
        self.times.retain(|(known, _)| *known != kernel);
        self.times.push((kernel, ms));
        let frames: Vec<_> = self
            .times
            .iter()
            .filter_map(|(kernel, ms)| Some((kernel.options, (*ms).filter(|ms| *ms > 0.0)?)))
            .collect();
        self.costs.learn(&frames);
    }

    fn time(&self, kernel: &KernelKey) -> TierTime {
        match self.times.iter().find(|(known, _)| known == kernel) {
            None => TierTime::NotYet,
            Some((_, None)) => TierTime::Failed,
            Some((_, Some(ms))) => TierTime::Ms(*ms),
        }
    }
}

/// The plan of the open picture in `tier`, with the options that the preset pins; none before the
/// first picture, and where no kernel can draw it.
fn plan_in(state: &State, tier: Tier) -> Option<(Plan, AccuracyRequest)> {
    let (plan, drawn) = (state.picture.screen.plan()?, state.picture.screen.drawn()?);
    let request = state.picture.tier_times.informed(AccuracyRequest {
        tier,
        ..drawn.accuracy
    });
    Some((
        plan.under(
            &drawn.stack,
            &state.picture.screen.gpu.caps.tuning(),
            &request,
        )
        .ok()?,
        request,
    ))
}

/// What is known of `tier` on the open picture; none before the first picture, and where no kernel
/// can draw it.
pub fn numbers(state: &State, tier: Tier) -> Option<TierNumbers> {
    let (plan, _) = plan_in(state, tier)?;
    let times = &state.picture.tier_times;
    if !state
        .picture
        .screen
        .drawn()
        .is_some_and(|drawn| times.is_of(drawn))
    {
        return Some(TierNumbers {
            kernel: plan.key,
            time: TierTime::NotYet,
            judged: None,
            bound: plan.prediction,
        });
    }
    let judged = times
        .judged
        .iter()
        .find(|(kernel, _)| *kernel == plan.key)
        .map(|(_, judged)| *judged);
    Some(TierNumbers {
        time: times.time(&plan.key),
        kernel: plan.key,
        judged,
        bound: plan.prediction,
    })
}

/// Follows the picture: drops what was measured of another one, and times the next tier when
/// everything is at rest and the window not otherwise busy.
pub fn follow(ctx: &egui::Context, state: &mut State, is_busy: bool) {
    let is_looked_at = std::mem::take(&mut state.picture.tier_times.is_looked_at);
    let Some(requested) = state.picture.screen.requested() else {
        return;
    };
    let rest_s = state.picture.tier_times.rest_s(requested, state.now_s);
    let screen = &state.picture.screen;
    // What else runs would be measured, too.
    if cfg!(target_arch = "wasm32") // A page has one device and one thread for everything.
        || state.session.playback.playing
        || state.jobs.is_computing()
        || screen.is_waiting()
        || !screen.timings().is_settled()
    {
        return state.picture.tier_times.stop();
    }
    let Some(drawn) = screen
        .drawn()
        .filter(|drawn| Some(*drawn) == screen.requested())
    else {
        return;
    };
    let next = || {
        let of = |tier| {
            plan_in(state, tier)
                .filter(|(plan, _)| state.picture.tier_times.time(&plan.key) == TierTime::NotYet)
        };
        let (plan, accuracy) = Tier::ALL.into_iter().find_map(of)?;
        Some((
            plan.key,
            Inputs {
                accuracy,
                ..drawn.clone()
            },
        ))
    };
    if !is_looked_at || is_busy || state.picture.tier_times.is_running() {
        return;
    }
    let Some((kernel, inputs)) = next() else {
        state.picture.tier_times.drawing.renderer = None;
        return;
    };
    if rest_s < REST_S {
        return ctx.request_repaint_after_secs((REST_S - rest_s) as f32 + 0.01);
    }
    let gpu = screen.gpu.clone();
    let times = &mut state.picture.tier_times;
    let watch = Arc::new(CompileWatch::new(|| {}));
    times.running = Some(watch.clone());
    let drawing = std::mem::take(&mut times.drawing);
    if let Some(thread) = state.jobs.time_tier(gpu, inputs, kernel, drawing, watch) {
        state.picture.screen.wait_at_end(thread);
    }
}

/// Takes in what a measurement has found; it counts if the picture is still the same and nothing
/// else ran.
pub fn take_times(
    state: &mut State,
    Timed {
        picture,
        kernel,
        outcome,
        drawing,
    }: Timed,
) {
    let times = &mut state.picture.tier_times;
    (times.running, times.drawing) = (None, drawing);
    if !times.is_of(&picture) {
        times.drawing.renderer = None;
        return;
    }
    match outcome {
        Ok(Some(ms)) if !state.jobs.is_computing() => times.add(kernel, Some(ms)),
        Ok(_) => {}
        Err(error) => {
            times.add(kernel, None);
            state.log.add(
                Level::Warning,
                format!(
                    "the tier {} was not measured: {error}",
                    picture.accuracy.tier.name()
                ),
            );
        }
    }
}

/// Keeps how far a picture was judged to be off, if it is the open one in some tier.
pub fn judge(state: &mut State, Verdict { of, findings }: &Verdict) {
    if !state.picture.tier_times.is_of(of) {
        return;
    }
    let Some((plan, _)) = plan_in(state, of.accuracy.tier) else {
        return;
    };
    let judged = Judged {
        wrong: findings.accuracy.wrong_triangles,
        by_rounding: findings.wrong_against_true(),
        channel: findings.accuracy.max_color_delta,
    };
    state
        .picture
        .tier_times
        .judged
        .retain(|(kernel, _)| *kernel != plan.key);
    state.picture.tier_times.judged.push((plan.key, judged));
}

/// Milliseconds of a frame of `inputs`, from a few frames, as the window measures its picture: on
/// `gpu` unless that is a CPU adapter's. None if `watch` stopped it.
///
/// # Errors
/// In a sentence for people.
pub async fn measure(
    gpu: &Arc<Gpu>,
    inputs: &Inputs,
    drawing: &mut TierDrawing,
    watch: &Arc<CompileWatch>,
) -> Result<Option<f64>, String> {
    yield_processor(); // Before a device is opened, whose threads are then as patient.
    let gpu = match &drawing.gpu {
        Some(known) => known.clone(),
        None if gpu.summary.software => Gpu::open(&AdapterChoice::Named(gpu.summary.name.clone()))
            .await
            .map_err(|error| error.to_string())?,
        None => gpu.clone(),
    };
    drawing.gpu = Some(gpu.clone());
    match frame_ms(gpu, inputs, drawing, watch).await {
        Ok(ms) => Ok(ms),
        Err(RenderError::Stopped) => Ok(None),
        Err(error) => Err(error.to_string()),
    }
}

async fn frame_ms(
    gpu: Arc<Gpu>,
    Inputs {
        scene,
        view,
        stack,
        accuracy,
    }: &Inputs,
    drawing: &mut TierDrawing,
    watch: &Arc<CompileWatch>,
) -> Result<Option<f64>, RenderError> {
    // A panic drops it.
    let mut renderer = drawing
        .renderer
        .take()
        .unwrap_or_else(|| Renderer::new(gpu));
    renderer.watch_compiling(watch.clone());
    renderer.set_scene(scene).await?;
    let mut samples = Vec::new();
    while !has_settled(&samples) {
        renderer.draw(view, stack, accuracy).await?;
        match wait_for_frame(&mut renderer, || !watch.is_stopped()).await? {
            None => break,
            Some(report) if report.redraw || report.simulation_pending => {}
            Some(report) => samples.push(Sample::of(&report).ok_or(RenderError::NoTimestamps)?),
        }
    }
    drawing.renderer = Some(renderer);
    Ok(Summary::settled(&samples)
        .filter(|_| has_settled(&samples))
        .map(|summary| summary.frame.median))
}
