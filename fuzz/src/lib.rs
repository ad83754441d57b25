//! What developers run beyond the tests: targets of fuzzing, random presets and drawn cases.
//!
//! [`TARGETS`] lists the targets: each takes bytes of anyone and reads them as rasterlab would.
//! [`run::check`] runs one of them on one input within its [`guard::Limit`]. `rasterlab-fuzz
//! inputs` replays the corpus, and `rasterlab-fuzz-coverage` mutates it with libFuzzer, for hours,
//! also inside of what is packed ([`views`]).
//!
//! [`stress`] has scenes made by hand, random presets and the cases that need code; the tests draw
//! with them, too.

pub mod corpus;
pub mod guard;
pub mod presets;
pub mod run;
pub mod stress;
pub mod targets;
pub mod views;

pub use targets::{TARGETS, Target};

use rasterlab::{
    accuracy, effects, frame, gpu, math, measure, oracle, params, plan, preset, scene,
};
