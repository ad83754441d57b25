//! The planner: the cheapest kernel that scene, stack and tolerance allow on this adapter.

mod caps;
mod costs;
mod error;
mod explain;
mod key;
mod loops;
mod options;
pub mod predict;
mod traits;

use std::sync::Arc;

pub use crate::accuracy::{AccuracyRequest, MeasuredCosts, Tier, Tolerance};

pub use self::{
    caps::{Caps, GLASS_LAYER_BYTES, MOST_GLASS_LAYERS, MOST_SMALL_SAMPLES, Tuning},
    error::PlanError,
    loops::DEEPEST_GLASS_OF_CARDS as MOST_CARD_GLASS_LAYERS,
    traits::{InexactEffect, StackTraits},
};
use self::{
    options::{Cause, Choice, Inputs, choose},
    predict::Prediction,
};
use crate::{
    accuracy::AXES,
    effects::{
        Stack,
        hooks::{Layers, Shape},
    },
    scene::{needs::Needs, sizes::SizeClasses},
    shader::key::KernelKey,
};

/// One line of an explanation: a part of a plan or of a frame, and why it is there or not.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Note {
    pub name: String,
    pub why: String,
}

/// A kernel key, and what it is predicted to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub key: KernelKey,
    /// What scene, view and stack require.
    pub needs: Arc<Needs>,
    /// How far the options are predicted to be off the oracle's picture.
    pub prediction: Prediction,
    pub tolerance: Tolerance,
    /// How many triangles are predicted to take which path; none where effects move or reshape
    /// them.
    pub classes: Option<SizeClasses>,
    /// Why each axis is on its option.
    causes: [Cause; AXES.len()],
    measured: MeasuredCosts,
    caps: Caps,
    has_default_tuning: bool,
}

/// Chooses the kernel. Formats no text: [`Plan::reasons`] does, when asked.
pub fn plan(
    needs: &Arc<Needs>,
    stack: &StackTraits,
    caps: &Caps,
    tuning: &Tuning,
    request: &AccuracyRequest,
) -> Result<Plan, PlanError> {
    let f32_positions = needs.f32_positions;
    let needs = needs_of_stack(needs, stack, tuning);
    let mut layers = match stack.layers(needs.triangles) {
        None | Some(Layers::Glass) => {
            (needs.glass_draws > 0 && request.is_seen_through()).then_some(Layers::Glass)
        }
        other => other,
    };
    let Choice {
        options,
        causes,
        prediction,
    } = choose(&Inputs {
        needs: &needs,
        f32_positions,
        stack,
        layers,
        caps,
        request,
    })?;
    if let (Some(Layers::Xray { bits }), Some(_)) = (&mut layers, options.xray_sums.capacity()) {
        *bits = 8;
    }
    let key = key::key_of(options, layers, &needs, stack, (caps, tuning));
    let keeps_sizes = stack.shape == Shape::Triangles && stack.vertex_effect().is_none();
    let classes = || {
        needs.sizes.classes(
            key.paths.max_small_samples,
            key.paths.max_small_side,
            key::large_px(&options),
        )
    };
    Ok(Plan {
        classes: keeps_sizes.then(classes),
        key,
        needs,
        prediction,
        tolerance: request.tolerance(),
        causes,
        measured: request.measured,
        caps: *caps,
        has_default_tuning: *tuning == caps.tuning(),
    })
}

/// What the scene requires once this stack has moved or reshaped it.
fn needs_of_stack(needs: &Arc<Needs>, stack: &StackTraits, tuning: &Tuning) -> Arc<Needs> {
    let mut needs = needs.clone();
    if !tuning.specialized {
        needs = Arc::new(needs.everything());
    }
    if stack.vertex_effect().is_some() {
        // The scene's bounds do not hold where effects move it, nor its normals where they turn it.
        let needs = Arc::make_mut(&mut needs);
        (needs.clipping, needs.largest_px, needs.normals_agree) = (true, f64::INFINITY, false);
    }
    if stack.shape == Shape::Points {
        // Discs are small, and triangles that would be clipped show none.
        let needs = Arc::make_mut(&mut needs);
        (needs.clipping, needs.largest_px) = (false, 0.0);
    }
    needs
}

/// Plans pictures and keeps the latest plans, so that a picture whose structure has not changed is
/// not planned again: a slider changes uniform bytes alone.
#[derive(Debug, Default)]
pub struct Planner {
    /// Number of plans that were made.
    made: u64,
    latest: Vec<(PlanInputs, Arc<Plan>)>,
}

/// Everything that a plan depends on.
#[derive(Debug)]
struct PlanInputs {
    needs: Arc<Needs>,
    stack: StackTraits,
    caps: Caps,
    tuning: Tuning,
    request: AccuracyRequest,
}

impl Planner {
    /// Number of plans that it made; those that it had kept do not count.
    pub fn made(&self) -> u64 {
        self.made
    }

    /// Most plans that are kept: those of a picture and of its shadow map, on two grids each.
    const KEPT: usize = 4;

    /// The plan of a picture; the same [`Arc`] while nothing that it depends on has changed.
    pub fn plan(
        &mut self,
        needs: &Arc<Needs>,
        stack: &Stack,
        caps: &Caps,
        tuning: &Tuning,
        request: &AccuracyRequest,
    ) -> Result<Arc<Plan>, PlanError> {
        let stack = StackTraits::of(stack, request)?;
        let is_same = |(known, _): &(PlanInputs, Arc<Plan>)| {
            (&known.stack, &known.caps, &known.tuning, &known.request)
                == (&stack, caps, tuning, request)
                && (Arc::ptr_eq(&known.needs, needs) || known.needs == *needs)
        };
        if let Some(index) = self.latest.iter().position(is_same) {
            return Ok(self.latest[index].1.clone());
        }
        self.made += 1;
        let planned = Arc::new(plan(needs, &stack, caps, tuning, request)?);
        self.latest.truncate(Self::KEPT - 1);
        let inputs = PlanInputs {
            needs: needs.clone(),
            stack,
            caps: *caps,
            tuning: *tuning,
            request: *request,
        };
        self.latest.insert(0, (inputs, planned.clone()));
        Ok(planned)
    }
}
