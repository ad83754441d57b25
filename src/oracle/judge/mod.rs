//! Judges pictures: an adapter's frame is compared with the oracle stage by stage, each stage from the adapter's own input, so
//! that one error is counted once, where it happened (`docs/exactness.md` §9).

pub mod picture;
pub mod shadow;

mod deform;
mod dots;
mod end_to_end;
mod error_map;
mod freedom;
mod outline;
mod particles;
mod sample_setups;
mod samples;
mod vertices;
