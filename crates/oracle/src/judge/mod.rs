//! Judges pictures: an adapter's frame is compared with the oracle stage by stage, each stage from
//! the adapter's own input, so that one error is counted once, where it happened
//! (`docs/exactness.md` §9).
//!
//! In the order in which [`picture::judge`] calls them:
//!
//! * `picture`: runs all stages, judges colors and counters, and makes the verdict
//! * `vertices`: vertex records, each from the matrix bits
//! * `clips`, `particles`, `deform`, `dots`, `sample_setups`, `shadow`: what else lies between the
//!   scene and coverage
//! * `freedom`: what an adapter may choose for itself at a sample
//! * `samples`: triangle ids, depth keys and layer counts, from the adapter's own geometry
//! * `glass`: the layers of glass on every sample, and their order
//! * `end_to_end`, `outline`: the whole picture against the oracle's own; only what snapped
//!   vertices explain may differ
//! * `error_map`: what is wrong at each pixel
//! * `passes`: the passes of image effects, from the adapter's picture before them
//!
//! The *claimed* triangle of a pixel is the one whose id the adapter stored there.

pub mod picture;
pub mod shadow;

mod clips;
mod deform;
mod dots;
mod end_to_end;
mod error_map;
mod freedom;
mod glass;
mod outline;
mod particles;
mod passes;
mod sample_setups;
mod samples;
mod vertices;
