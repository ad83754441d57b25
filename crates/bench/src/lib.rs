//! What the kernels cost and how wrong they are: [`extremes`] draws the extreme cases, [`baselines`]
//! times our options beside two other rasterizers, [`trade`] times every combination of options.

pub mod baselines;
pub mod extremes;
pub mod trade;

use rasterlab_gpu as gpu;
use rasterlab_kernels::{plan, shader};
use rasterlab_model::{accuracy, effects, frame, measure, preset, scene};
use rasterlab_oracle as oracle;
