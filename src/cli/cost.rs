//! Predicted and measured milliseconds of a picture, and the calibration that predictions come from.

use super::{error::CliError, streams::Streams};
use crate::{
    effects::Stack,
    gpu::{
        Gpu, Renderer,
        calibration::paired,
        timed_picture::{FrameTimes, draw_until_ready, time},
    },
    oracle,
    plan::{
        AccuracyRequest,
        cost_model::{FrameWork, UnitCosts},
    },
    preset_file::{Calibration, CalibrationKey, Kept},
    scene::view::View,
};

/// What a pass or a frame is predicted to take and was measured to take, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Cost {
    /// None without a calibration.
    pub predicted_ms: Option<f64>,
    /// None where nothing was measured.
    pub measured_ms: Option<f64>,
    /// Predicted over measured.
    pub ratio: Option<f64>,
}

/// Costs of a picture.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PictureCost {
    pub frame: Cost,
    /// Every pass by its label, the clears first.
    pub passes: Vec<(String, Cost)>,
    /// What the prediction counts in each pass, in the same order.
    #[serde(skip)]
    pub work: FrameWork,
}

impl Cost {
    fn new(predicted_ms: Option<f64>, measured_ms: Option<f64>) -> Self {
        let ratio = predicted_ms.zip(measured_ms.filter(|ms| *ms > 0.0)).map(|(predicted, measured)| predicted / measured);
        Self { predicted_ms, measured_ms, ratio }
    }

    /// Its figures for a table.
    pub fn cells(&self) -> [String; 3] {
        let cell = |figure: Option<f64>, digits: usize| figure.map_or_else(|| "-".into(), |figure| format!("{figure:.digits$}"));
        [cell(self.predicted_ms, 4), cell(self.measured_ms, 4), cell(self.ratio, 2)]
    }
}

impl PictureCost {
    fn new(work: &FrameWork, costs: Option<&UnitCosts>, times: Option<&FrameTimes>) -> Self {
        let nothing = FrameTimes { whole_ms: 0.0, passes: Vec::new(), frames: 0 };
        let passes = paired(work, times.unwrap_or(&nothing)).into_iter().map(|(pass, measured)| {
            let predicted = costs.map(|costs| costs.lone_ms(pass));
            (pass.label.clone(), Cost::new(predicted, measured))
        });
        let measured = times.map(|times| times.whole_ms).filter(|ms| *ms > 0.0);
        Self { passes: passes.collect(), frame: Cost::new(costs.map(|costs| costs.ms(work)), measured), work: work.clone() }
    }

    /// Of the last picture of a renderer, which showed `stack`, without drawing anything.
    ///
    /// # Errors
    /// When nothing was drawn.
    pub fn predicted(renderer: &Renderer, stack: &Stack, costs: Option<&UnitCosts>) -> Result<Self, CliError> {
        Ok(Self::new(&renderer.work(stack, oracle::moved_sizes)?, costs, None))
    }

    /// Draws and times a picture.
    ///
    /// # Errors
    /// When the picture cannot be drawn, or the device is lost.
    pub fn measured(
        renderer: &mut Renderer,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        costs: Option<&UnitCosts>,
    ) -> Result<Self, CliError> {
        draw_until_ready(renderer, view, stack, accuracy)?;
        let work = renderer.work(stack, oracle::moved_sizes)?;
        Ok(Self::new(&work, costs, Some(&time(renderer, view, stack, accuracy)?)))
    }
}

/// What the calibration of an adapter is kept under.
pub fn calibration_key(gpu: &Gpu) -> CalibrationKey {
    CalibrationKey::of(&gpu.summary.name, &gpu.summary.driver, gpu.caps.software)
}

/// The calibration that was kept for an adapter, if there is one. A file that cannot be used is named on stderr.
pub fn kept_calibration(gpu: &Gpu, streams: &Streams) -> Option<Calibration> {
    match calibration_key(gpu).kept() {
        Kept::Found(found) => Some(*found),
        Kept::Nothing => None,
        Kept::Broken(why) => {
            streams.note(&format!("{why}; rasterlab calibrate makes another"));
            None
        }
    }
}
