//! What a picture is made of, as plain data: scenes, effects, presets, and the accuracy asked of
//! them. Nothing here draws, waits, or names a device.
//!
//! Modules in dependency order:
//!
//! * [`work`]: watching and canceling long work
//! * [`math`], [`frame`]: snapping and exact comparisons, and the picture with its integer buffers
//! * [`accuracy`]: every axis on which speed is traded for accuracy, its options, and what a preset
//!   asks of them
//! * [`measure`]: compares frames, summarizes timings
//! * [`scene`]: meshes as the file has them, cameras, what a scene requires
//! * [`shaders`]: the WGSL files
//! * [`params`](mod@params), [`effects`]: one table of parameters per effect, one list of effects,
//!   their f64 reference
//! * [`preset`]: the state of a picture, and its animation

pub mod accuracy;
pub mod effects;
pub mod frame;
mod legible;
pub mod math;
pub mod measure;
pub mod params;
pub mod preset;
pub mod scene;
pub mod shaders;
pub mod work;

use rasterlab_evaluator as evaluator;
