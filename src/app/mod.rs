//! The lab's window: presets and scenes on the left, the picture in the middle, every parameter on
//! the right, the timeline and the log below. All of it edits one preset, and only that decides
//! what is drawn.
//!
//! A panel owns its own state, reads `state::State` and sends closures on `App`, which are run after
//! the panel was shown. Slow work runs in `jobs` and ends with such a closure; the window never waits
//! for a thread or a device.

mod editing;
mod files;
mod jobs;
mod palette;
mod panels;
mod picture;
mod settings;
mod shell;
mod trade;
mod widgets;

pub use files::recovery::{FIRST_PRESET, config_folder};
#[cfg(not(target_arch = "wasm32"))]
pub use shell::run::{DeviceLost, run};
pub use shell::{
    device::{Devices, Painter, adopt, wgpu_setup},
    window::{App, Options},
};
#[cfg(target_arch = "wasm32")]
pub use {
    jobs::worker::{answer, heed},
    shell::page::{open_given, refuse, reopen, start},
};
