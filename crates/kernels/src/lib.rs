//! Which compute kernels draw a picture, as text: [`plan`] chooses them from scene, stack, adapter
//! and tolerance, [`shader`] links them. Names no GPU.

pub mod plan;
pub mod shader;

use rasterlab_model::{accuracy, effects, frame, math, params, scene};
