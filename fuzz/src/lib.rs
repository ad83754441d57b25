//! Targets of fuzzing: each takes bytes of anyone and reads them as rasterlab would.
//!
//! [`TARGETS`] lists them. [`run::check`] runs one of them on one input within its
//! [`guard::Limit`]; [`mutate`] makes new input from that of the corpus, also inside of what is
//! packed ([`views`]). Two programs call them: `rasterlab-fuzz` with input mutated at random, for
//! some seconds in the continuous integration, and `rasterlab-fuzz-coverage` with libFuzzer, for
//! hours.

pub mod corpus;
pub mod guard;
pub mod mutate;
pub mod run;
pub mod targets;
pub mod views;

pub use targets::{TARGETS, Target};
