//! The evaluator of rasterlab, alone.

#[path = "../../../src/evaluator/mod.rs"]
pub mod evaluator;
