//! A device: which there are, what one holds and compiled, and how long its work takes.

pub mod error;

pub mod compile_watch;
pub mod memory;
pub mod pipeline_store;
pub mod preparations;

mod adapter;

#[cfg(target_arch = "wasm32")]
pub mod canvas;
pub mod completion;
pub mod timer;

pub use adapter::{
    AdapterChoice, AdapterSummary, BACKENDS, Caps, Gpu, OpenError, choose, list, summary,
};
pub use memory as device_memory;
