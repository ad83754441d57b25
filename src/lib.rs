//! rasterlab: an effects lab around a triangle rasterizer written as compute shaders.
//!
//! Modules in dependency order; `tests/house/architecture.rs` holds the arrows.
//!
//! * [`work`]: watching and canceling long work
//! * [`math`], [`frame`]: snapping and exact comparisons, and the picture with its integer buffers
//! * [`accuracy`]: every axis on which speed is traded for accuracy, and its options
//! * [`measure`]: compares frames, summarizes timings
//! * [`scene`]: meshes as the file has them, cameras, what a scene requires
//! * [`params`](mod@params), [`effects`]: one table of parameters per effect, one list of effects, their f64 reference
//! * [`shader`], [`plan`]: choose and link the kernels
//! * [`evaluator`]: evaluates WGSL functions on the CPU
//! * [`effect_files`]: effects that anyone can write, one WGSL file each
//! * [`preset`]: the state of a picture, and its animation
//! * [`oracle`]: the exact CPU renderer that judges the kernels and makes the goldens
//! * [`gpu`]: runs the kernels
//! * [`host`]: what the core, which knows no files and no environment, is given of the machine
//! * [`preset_file`]: presets as sparse TOML files
//! * [`film`]: films of an animated preset, as frames, animated PNG or video
//! * [`stress`]: the table of extreme cases, each drawn and judged
//! * `app`: the window (feature `gui`)
//! * [`cli`]: every subcommand; opens no window except through `app`

// One place opts out, with its reason: the option `trusted` of src/gpu/pipelines.rs.
#![deny(unsafe_code)]

pub mod accuracy;
#[cfg(feature = "gui")]
pub mod app;
#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
pub mod effect_files;
pub mod effects;
pub mod evaluator;
pub mod film;
pub mod frame;
pub mod gpu;
pub mod host;
pub mod math;
pub mod measure;
pub mod oracle;
pub mod params;
pub mod plan;
pub mod preset;
pub mod preset_file;
pub mod scene;
pub mod shader;
pub mod stress;
pub mod work;

/// The arithmetic that the kernels and the oracle implement: the page `docs/exactness.md`, to which doc comments refer by section.
#[cfg(doc)]
#[allow(rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]
pub mod exactness {
    #![doc = include_str!("../docs/exactness.md")]
}
