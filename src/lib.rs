//! rasterlab: an effects lab around a triangle rasterizer written as compute shaders.
//!
//! Modules in dependency order; `tests/architecture.rs` holds the arrows.
//!
//! * [`math`], [`frame`]: exact little tools, and the picture with its integers
//! * [`scene`]: meshes as the file has them, cameras, what a scene requires
//! * [`params`], [`effects`]: one table per effect, one list of effects, their f64 truth
//! * [`oracle`]: the exact CPU renderer that judges and blesses
//! * [`shader`], [`plan`], [`gpu`]: choose, link and run the kernels
//! * [`measure`]: frame against frame, samples of time
//! * [`session`], [`preset`]: the state of a look, and its file
//! * [`cli`], [`app`]: the two hands on it

pub mod effects;
pub mod frame;
pub mod math;
pub mod params;
pub mod scene;
pub mod session;
