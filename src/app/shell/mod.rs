//! What panels know of the window: its state, its messages, and the commands and actions that change
//! it.

pub mod action;
pub mod apply;
pub mod command;
pub mod device;
pub mod ending;
pub mod log;
#[cfg(target_arch = "wasm32")]
pub mod page;
pub mod state;
pub mod ui_frames;
