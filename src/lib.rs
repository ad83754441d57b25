//! rasterlab: an effects lab around a triangle rasterizer written as compute shaders.
//!
//! The program: [`cli`] has every subcommand, `app` is the window (feature `gui`). Both drive the
//! crates below, which are named here once more, so that one dependency gives a whole lab. Each
//! knows only those before it:
//!
//! * `rasterlab-model` ([`work`], [`math`], [`frame`], [`accuracy`], [`measure`], [`scene`],
//!   [`params`](mod@params), [`effects`], [`preset`]): what a picture is made of, as plain data
//! * `rasterlab-kernels` ([`shader`], [`plan`]): chooses and links the kernels
//! * `rasterlab-evaluator` ([`evaluator`]): evaluates WGSL functions on the CPU
//! * `rasterlab-oracle` ([`oracle`]): the exact CPU renderer that judges the kernels and makes the
//!   goldens
//! * `rasterlab-gpu` ([`gpu`]): runs the kernels
//! * `rasterlab-files` ([`host`], [`preset_file`], [`effect_files`], [`film`]): models, presets,
//!   effects and films on disk
//! * `rasterlab-bench` ([`extremes`], [`baselines`], [`trade`]): extreme cases, and speed beside
//!   error

#![deny(unsafe_code)]

#[cfg(feature = "gui")]
pub mod app;
#[cfg(not(target_arch = "wasm32"))]
pub mod cli;

#[cfg_attr(target_arch = "wasm32", allow(dead_code))]
mod contact_sheet;
#[cfg(not(target_arch = "wasm32"))]
pub mod golden;
pub mod link;

pub use rasterlab_bench::{baselines, extremes, trade};
pub use rasterlab_evaluator as evaluator;
pub use rasterlab_files::{archive, effect_files, film, host, preset_file};
pub use rasterlab_gpu as gpu;
pub use rasterlab_kernels::{plan, shader};
pub use rasterlab_model::{accuracy, effects, frame, math, measure, params, preset, scene, work};
pub use rasterlab_oracle as oracle;

/// The arithmetic that the kernels and the oracle implement: the page `docs/exactness.md`, to which
/// doc comments refer by section.
#[cfg(doc)]
#[allow(rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]
pub mod exactness {
    #![doc = include_str!("../docs/exactness.md")]
}
