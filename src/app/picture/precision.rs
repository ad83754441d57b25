//! The largest f32 error of the effects in the picture that is shown: measured by the oracle
//! while the picture is at rest.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use glam::DVec3;

use super::screen::Inputs;
use crate::{
    effect_files::{self, ErrorPlace, Quantity},
    effects::Effect,
    oracle,
    scene::view::View,
};

/// Most pixels of the picture that is measured: the evaluator is much slower than a kernel.
const MAX_PIXELS: f64 = 320.0 * 240.0;

/// The picture must not have changed for this long, seconds.
pub const REST_S: f64 = 0.5;

/// The largest error of one quantity of an effect.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Error {
    pub quantity: Quantity,
    pub error: f64,
    /// Where in the picture, as a fraction of its size; none outside.
    pub uv: Option<[f64; 2]>,
}

/// The errors of the effects in one picture; of those that it calls.
#[derive(Clone, Debug)]
pub struct Measured {
    pub of: Inputs,
    /// Size of the picture that was measured, pixels.
    pub size: [u32; 2],
    pub effects: Vec<(Arc<Effect>, Vec<Error>)>,
}

/// What is measured and what is being measured.
#[derive(Default)]
pub struct PrecisionState {
    measured: Option<Measured>,
    running: Option<(Inputs, Arc<AtomicBool>)>,
    /// The picture that could not be measured; it is not tried again.
    failed: Option<Inputs>,
    /// What was requested last, and since when, seconds.
    seen: Option<(Inputs, f64)>,
}

impl PrecisionState {
    /// The errors in the picture `requested`, if they are known.
    pub fn of(&self, requested: Option<&Inputs>) -> Option<&Measured> {
        self.measured
            .as_ref()
            .filter(|measured| requested == Some(&measured.of))
    }

    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    pub fn has_failed(&self, requested: Option<&Inputs>) -> bool {
        self.failed.is_some() && self.failed.as_ref() == requested
    }

    /// Seconds for which `requested` has not changed. A measurement of anything else is cancelled.
    pub fn rest_s(&mut self, requested: &Inputs, now_s: f64) -> f64 {
        if let Some((_, cancelled)) = self
            .running
            .as_ref()
            .filter(|(running, _)| running != requested)
        {
            cancelled.store(true, Ordering::Relaxed);
        }
        let seen = self
            .seen
            .take()
            .filter(|(seen, _)| seen == requested)
            .unwrap_or_else(|| (requested.clone(), now_s));
        let rest_s = now_s - seen.1;
        self.seen = Some(seen);
        rest_s
    }

    /// A measurement of `of` begins. Returns the flag that cancels it.
    pub fn start(&mut self, of: Inputs) -> Arc<AtomicBool> {
        let cancelled = Arc::new(AtomicBool::new(false));
        self.running = Some((of, cancelled.clone()));
        cancelled
    }

    /// A measurement has ended; none if it was cancelled. Returns an error that is to be logged.
    pub fn take_errors(
        &mut self,
        of: Inputs,
        measured: Result<Option<Box<Measured>>, String>,
    ) -> Option<String> {
        self.running = None;
        match measured {
            Ok(Some(measured)) => self.measured = Some(*measured),
            Ok(None) => {}
            Err(error) => {
                self.failed = Some(of);
                return Some(error);
            }
        }
        None
    }
}

/// Measures the effects in the picture of `of`, drawn by the oracle at no more than 76,800
/// pixels; none if it was cancelled.
///
/// # Errors
/// In a sentence for people.
pub fn measure(of: &Inputs, cancelled: &Arc<AtomicBool>) -> Result<Option<Measured>, String> {
    let factor = (MAX_PIXELS / (of.view.pixels() as f64).max(1.0))
        .sqrt()
        .min(1.0);
    let view = if factor < 1.0 {
        of.view.scaled(factor)
    } else {
        of.view.clone()
    };
    let mut drawn = Ok(());
    let found = effect_files::precision(&of.stack.scaled(factor), cancelled, |stack| {
        drawn = oracle::render(&of.scene, &view, stack)
            .map(drop)
            .map_err(|error| error.to_string());
    });
    let found = found.map_err(|error| error.to_string())?;
    drawn?;
    if cancelled.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let size = [view.width, view.height];
    let uv = |place: ErrorPlace| match place {
        ErrorPlace::Pixel([x, y]) => {
            Some([x / f64::from(size[0].max(1)), y / f64::from(size[1].max(1))])
        }
        ErrorPlace::World(at) => on_screen(&view, at),
    };
    let error = |found: effect_files::LargestError| Error {
        quantity: found.quantity,
        error: found.error,
        uv: uv(found.place),
    };
    let effects = found
        .into_iter()
        .map(|(effect, errors)| (effect, errors.into_iter().map(error).collect()))
        .collect();
    Ok(Some(Measured {
        of: of.clone(),
        size,
        effects,
    }))
}

/// Where a point of the world is in the picture; none outside of it.
fn on_screen(view: &View, at: DVec3) -> Option<[f64; 2]> {
    let clip = view.clip_from_world * at.extend(1.0);
    let ndc = clip.truncate() / clip.w;
    let uv = [0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y];
    (clip.w > 0.0 && uv.iter().all(|t| (0.0..=1.0).contains(t))).then_some(uv)
}
