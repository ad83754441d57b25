//! Effects as texts: what a file of WGSL declares, and its functions evaluated in f64. Built-in
//! effects and those that anyone writes are read alike.

mod assembled;
pub mod attributes;
mod bounds;
mod built_in;
pub mod declaration;
pub mod error;
mod functions;
mod member;
pub mod parameters;
pub mod picture_twin;
pub mod tokens;
pub mod twin;
pub mod words;

pub use built_in::{built_in, for_kernels, reads_triangle};
