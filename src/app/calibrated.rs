//! Devices that plan with the calibration of their adapter.

use std::sync::Arc;

use crate::{gpu::Gpu, preset_file::CalibrationKey};

/// The device, whose pictures are planned with the calibration that was kept for its adapter, if there is one.
pub fn calibrated(gpu: Arc<Gpu>) -> Arc<Gpu> {
    let measured = CalibrationKey::of(&gpu.summary.name, &gpu.summary.driver, gpu.caps.software).kept_measured();
    gpu.with_measured(measured)
}
