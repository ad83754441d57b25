//! Promises about exactness: the oracle keeps the rules of rasterization, and every kernel draws
//! what the oracle draws.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod accuracy_axes;
mod backends;
mod backgrounds;
mod compiled_once;
mod culling;
mod device_lost;
mod device_memory;
mod draw_order;
mod evaluator_gpu;
mod evaluator_programs;
mod extremes;
mod grounds;
mod hardware;
mod instances;
mod judge_at_extremes;
mod oracle;
mod points;
mod probe;
#[path = "../common/rounds.rs"]
mod rounds;
mod specialization;
mod stacks;
mod strict;
