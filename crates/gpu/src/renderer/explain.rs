//! Explanation: which passes and buffers the last picture has, which it does without, and why.

use std::sync::Arc;

use crate::{
    device::{Gpu, preparations::Preparation},
    layout::frame_layout::DotCounts,
    passes::{
        pass_purpose::pass_purpose, recording::Resources, shadow_pass::ShadowPass,
        view_resources::ViewResources,
    },
    plan::{Note, Plan, Tolerance, predict::Prediction},
    resources::buffers::BufferNote,
    scene::sizes::SizeClasses,
};

/// Which passes and buffers exist for the last picture, and why.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Explanation {
    pub key: String,
    pub passes: Vec<Note>,
    pub buffers: Vec<BufferNote>,
    pub reasons: Vec<Note>,
    pub omitted: Vec<Note>,
    /// Triangles by their size on the screen, and the paths that they take.
    pub sizes: Option<SizesNote>,
    /// What the options are predicted to err by, and what they may.
    pub prediction: Option<Prediction>,
    pub tolerance: Option<Tolerance>,
}

/// Triangles by their size on the screen, from a look at some, and what the frame then counted.
#[derive(Clone, Debug, serde::Serialize)]
pub struct SizesNote {
    pub triangles: u64,
    pub sampled: u32,
    /// Of those, whole ones that face the viewer and lie in the picture.
    pub seen: u32,
    /// Reach before the near plane.
    pub cut: u32,
    /// Upper end of a power of two in pixels, and how many of the seen ones lie in it.
    pub bins: Vec<(f64, u32)>,
    /// How many take which path; not where effects move or reshape triangles.
    pub predicted: Option<SizeClasses>,
    /// What the queues of the frame counted: medium and large triangles. Not while figures are
    /// still to come.
    pub counted: Option<[u32; 2]>,
    /// The prediction holds, where both are known.
    pub prediction_holds: Option<bool>,
}

impl SizesNote {
    fn new(plan: &Plan, counted: Option<[u32; 2]>) -> Self {
        let Plan {
            key,
            needs,
            classes,
            ..
        } = plan;
        let sizes = &needs.sizes;
        // What is cut comes back as pieces of any size, and what is hidden may never be queued.
        let is_told = |_: &[u32; 2]| {
            (!key.paths.has_clipping || sizes.near_clipped == 0) && !key.options.culling.occludes()
        };
        let is_near = |c: SizeClasses, [medium, large]: [u32; 2]| {
            let near = |predicted: f64, counted: u32| {
                (predicted - f64::from(counted)).abs()
                    <= c.error_bound + 0.02 * f64::from(counted) + 1.0
            };
            // Those that exceed the pass which was left out are drawn by the one before.
            (near(c.medium, medium) || !key.paths.has_medium)
                && (near(c.large, large) || !key.paths.has_large)
        };
        let prediction_holds = classes
            .zip(counted.filter(is_told))
            .map(|(classes, counted)| is_near(classes, counted));
        Self {
            triangles: sizes.triangles,
            sampled: sizes.sampled,
            seen: sizes.visible(),
            cut: sizes.near_clipped,
            bins: sizes.bins(),
            predicted: *classes,
            counted,
            prediction_holds,
        }
    }
}

impl Explanation {
    /// What exists for the last frame of `picture`. `others` are resources that it shares.
    pub fn new(
        picture: &ViewResources,
        others: &Resources<'_>,
        shadow: Option<&ShadowPass>,
    ) -> Self {
        let mut buffers: Vec<BufferNote> = others.with(&picture.buffers).notes();
        buffers.sort_by(|a, b| a.name.cmp(&b.name));
        buffers.extend(shadow.into_iter().flat_map(ShadowPass::notes));
        let Ok(frame) = picture.frame() else {
            return Self {
                key: "nothing drawn yet".into(),
                passes: Vec::new(),
                buffers,
                reasons: Vec::new(),
                omitted: Vec::new(),
                sizes: None,
                prediction: None,
                tolerance: None,
            };
        };
        let plan = &frame.plan;
        let own = plan.key.frame().into_iter().map(|pass| Note {
            name: pass.label(),
            why: pass_purpose(pass).into(),
        });
        let mut reasons = plan.reasons();
        if let Some(dots) = &picture.dots {
            let why = format!(
                "{} dots on {} lines, as far as the lines are long",
                dots.counts().dots,
                dots.line_count()
            );
            reasons.push(Note {
                name: "dots".into(),
                why,
            });
        }
        Self {
            key: plan.key.to_string(),
            passes: shadow
                .into_iter()
                .flat_map(ShadowPass::passes)
                .chain(own)
                .collect(),
            buffers,
            reasons,
            omitted: plan.omissions(),
            sizes: Some(SizesNote::new(plan, queue_counts(picture))),
            prediction: Some(plan.prediction),
            tolerance: Some(plan.tolerance),
        }
    }
}

/// Medium and large triangles that the queues of the newest finished picture counted.
fn queue_counts(picture: &ViewResources) -> Option<[u32; 2]> {
    picture.demand.map(|demand| [demand.medium, demand.large])
}

/// The newest explanation, and what it speaks of.
#[derive(Default)]
pub struct Explained(Option<(Subject, Arc<Explanation>)>);

/// What an explanation speaks of.
struct Subject {
    plan: Option<Arc<Plan>>,
    /// Of the picture's and the light's command list, which change with their buffers.
    commands: [Option<u64>; 2],
    dots: Option<(DotCounts, usize)>,
    counted: Option<[u32; 2]>,
}

impl Subject {
    fn is_same(&self, other: &Self) -> bool {
        let is_same_plan = match (&self.plan, &other.plan) {
            (Some(plan), Some(other)) => Arc::ptr_eq(plan, other),
            (plan, other) => plan.is_none() && other.is_none(),
        };
        is_same_plan
            && (self.commands, self.dots, self.counted)
                == (other.commands, other.dots, other.counted)
    }
}

impl Explained {
    /// [`Explanation::new`], or the same as before where nothing that it says has changed.
    pub fn of<'a>(
        &mut self,
        gpu: &Gpu,
        picture: &ViewResources,
        shadow: Option<&ShadowPass>,
        others: impl FnOnce() -> Resources<'a>,
    ) -> Arc<Explanation> {
        let subject = Subject {
            plan: picture.frame().ok().map(|frame| frame.plan.clone()),
            commands: [
                picture.commands_revision(),
                shadow.and_then(|shadow| shadow.resources.commands_revision()),
            ],
            dots: picture
                .dots
                .as_ref()
                .map(|dots| (dots.counts(), dots.line_count())),
            counted: queue_counts(picture),
        };
        if let Some((_, explanation)) = self.0.as_ref().filter(|(known, _)| known.is_same(&subject))
        {
            return explanation.clone();
        }
        gpu.prepared.count(Preparation::Explanation);
        let explanation = Arc::new(Explanation::new(picture, &others(), shadow));
        self.0 = Some((subject, explanation.clone()));
        explanation
    }
}
