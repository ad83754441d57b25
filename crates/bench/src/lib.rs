//! What the kernels cost and how wrong they are: [`stress`] holds the extreme cases, [`baselines`]
//! times our options beside two other rasterizers, [`trade`] times every combination of options.

pub mod baselines;
pub mod stress;
pub mod trade;

use rasterlab_gpu as gpu;
use rasterlab_kernels::{plan, shader};
use rasterlab_model::{accuracy, effects, frame, math, measure, params, preset, scene};
use rasterlab_oracle as oracle;
