//! Promise: the evaluator of WGSL computes what direct formulas, direct execution of random
//! programs and Rust's own arithmetic compute, and names what it cannot evaluate.
//! `tests/evaluator_peer` compares it with the evaluator of the WESL compiler. Needs no adapter.

mod builtins;
mod builtins_of_vectors;
pub mod common;
mod lattice;
mod limits;
mod noise;
mod pointers;
mod precision;
mod random_statements;
