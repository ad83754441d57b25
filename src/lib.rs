//! rasterlab: an effects lab around a triangle rasterizer written as compute shaders.
//!
//! Modules in dependency order; `tests/architecture.rs` holds the arrows.
//!
//! * [`math`], [`frame`]: exact little tools, and the picture with its integers
//! * [`ladder`]: every axis on which speed is traded for accuracy, and its rungs
//! * [`scene`]: meshes as the file has them, cameras, what a scene requires
//! * [`params`](mod@params), [`effects`]: one table per effect, one list of effects, their f64 truth
//! * [`shader`], [`plan`], [`gpu`]: choose, link and run the kernels
//! * [`measure`]: frame against frame, samples of time
//! * [`oracle`]: the exact CPU renderer that judges and blesses
//! * [`session`]: the state of a look, and what moves with its clock
//! * [`stress`]: the table of extreme cases, each drawn and judged
//! * [`preset`]: looks as files, sparse TOML
//! * [`cli`]: every subcommand; never opens a window of its own
//! * `app`: the window (feature `gui`)

// One place opts out, with its reason: the rung `trusted` of src/gpu/pipelines.rs.
#![deny(unsafe_code)]

#[cfg(feature = "gui")]
pub mod app;
pub mod cli;
pub mod effects;
pub mod frame;
pub mod gpu;
pub mod ladder;
pub mod math;
pub mod measure;
pub mod oracle;
pub mod params;
pub mod plan;
pub mod preset;
pub mod scene;
pub mod session;
pub mod shader;
pub mod stress;
