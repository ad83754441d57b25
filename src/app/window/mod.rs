//! The window itself: its frame, its input, and how it begins and ends.

pub mod app;
pub mod escape;
pub mod fold;
pub mod input;
pub mod keep;
pub mod loss;
pub mod observed;
pub mod pointer_frames;
#[cfg(not(target_arch = "wasm32"))]
pub mod run;
pub mod typing;
