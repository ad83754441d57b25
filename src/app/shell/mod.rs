//! The window itself: its frame, its state, its commands, and how it begins and ends.

pub mod action;
pub mod apply;
pub mod command;
pub mod device;
pub mod ending;
pub mod escape;
pub mod fold;
pub mod input;
pub mod keep;
pub mod log;
pub mod loss;
pub mod observed;
#[cfg(target_arch = "wasm32")]
pub mod page;
pub mod pointer_frames;
#[cfg(not(target_arch = "wasm32"))]
pub mod run;
pub mod state;
pub mod typing;
pub mod ui_frames;
pub mod window;
